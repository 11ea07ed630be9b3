#include <slipstick/base/gather.h>
#include <slipstick/mechanics/cell_stress.h>
#include <slipstick/mechanics/nearest_in_cell.h>
#include <slipstick/mechanics/stress_point.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/polynomial.h>
#include <deal.II/base/polynomial_space.h>

#include <algorithm>
#include <limits>

namespace slipstick::mechanics
{
  namespace
  {
    // A cell contains the point if it is no farther from it than from the nearest cell, up to this fraction of its
    // diameter.
    constexpr double same_place = 1e-6;
    // Centres of cells are half a cell inside the end of their layer; half of that is a margin for distortion.
    constexpr double margin_of_layers = 0.25;
    // The points determine a polynomial if no pivot of the least squares problem is below this fraction of the largest.
    constexpr double independent = 1e-3;
    // Step for the derivatives of the mapping at the middle of a reference cell.
    constexpr double step_in_cell = 0.1;
  } // namespace

  template <int dim>
  StressPoint<dim>::StressPoint(const scene::Scene<dim>  &scene_,
                                const mesh::Mesh<dim>    &mesh_,
                                const Spaces<dim>        &spaces_,
                                const unsigned int        body_,
                                const dealii::Point<dim> &x_,
                                const double              t_)
    : scene(scene_)
    , mesh(mesh_)
    , spaces(spaces_)
    , t(t_)
    , body(body_)
    , x(x_)
    , n_components(mesh::Kinematics<dim>(scene.plane_state).n_stress_components())
  {
    std::vector<std::pair<double, Place>> near;
    double                                least = std::numeric_limits<double>::max();
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      if (mesh.subdomains[p]->body == body)
        for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
          if (const auto nearest = nearest_in_cell<dim>(spaces.of(p), cell, x))
            {
              near.push_back({nearest->distance, {p, cell, nearest->unit}});
              least = std::min(least, nearest->distance);
            }
    least = dealii::Utilities::MPI::min(least, mesh.comm);
    for (const auto &[distance, place] : near)
      if (distance <= least + same_place * place.cell->diameter())
        {
          places.push_back(place);
          CellValues<dim> values(*spaces.of(place.p).mapping, *spaces.of(place.p).scalar, spaces.of(place.p).stiffness);
          values.reinit(place.cell);
          for (unsigned int q = 0; q < spaces.of(place.p).stiffness.size(); ++q)
            measure += (*values).JxW(q);
        }
    n_all   = dealii::Utilities::MPI::sum(double(places.size()), mesh.comm);
    measure = dealii::Utilities::MPI::sum(measure, mesh.comm);
  }

  template <int dim>
  Stress<dim> StressPoint<dim>::recovered(const StressResult &stress) const
  {
    std::vector<double>                          sums(2 * dim);
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<unsigned int>                    nodes;
    for (const auto &[p, cell, unit] : places)
      {
        spaces.of(p).nodes_of(cell, dofs, nodes);
        for (unsigned int i = 0; i < nodes.size(); ++i)
          for (unsigned int c = 0; c < sums.size(); ++c)
            sums[c] += spaces.of(p).scalar->shape_value(i, unit) * stress.subdomains[p].nodal(nodes[i], c) / n_all;
      }
    dealii::Utilities::MPI::sum(sums, mesh.comm, sums);
    return Eigen::Map<const Stress<dim>>(sums.data());
  }

  template <int dim>
  std::vector<std::pair<dealii::Point<dim>, Stress<dim>>> StressPoint<dim>::nodes_around(
    const StressResult &stress) const
  {
    std::vector<std::pair<dealii::Point<dim>, Stress<dim>>> result;
    std::vector<dealii::types::global_dof_index>            dofs;
    std::vector<unsigned int>                               nodes;
    for (const auto &[p, cell, unit] : places)
      {
        const auto &element = spaces.of(p);
        element.nodes_of(cell, dofs, nodes);
        for (unsigned int i = 0; i < nodes.size(); ++i)
          result.emplace_back(element.mapping->transform_unit_to_real_cell(cell, element.scalar->unit_support_point(i)),
                              Stress<dim>(stress.subdomains[p].nodal.row(nodes[i]).transpose().array()));
      }
    return result;
  }

  template <int dim>
  std::optional<Stress<dim>> StressPoint<dim>::fitted(const std::vector<Eigen::VectorXd> &u) const
  {
    std::vector<double> all;
    for (const auto &of_rank : all_gather(mesh.comm, samples(u)))
      all.insert(all.end(), of_rank.begin(), of_rank.end());
    const unsigned int n = dim + n_components;
    using Rows           = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Rows> points(all.data(), all.size() / n, n);

    const dealii::PolynomialSpace<dim> polynomials( // complete polynomials; the first is the constant
      dealii::Polynomials::Monomial<double>::generate_complete_basis(spaces.degree + 1));
    const unsigned int                 n_monomials = polynomials.n();
    if (points.rows() < n_monomials)
      return {};
    Eigen::MatrixXd monomials(points.rows(), n_monomials), values = points.rightCols(n_components);
    for (unsigned int r = 0; r < points.rows(); ++r)
      {
        dealii::Point<dim> place;
        for (unsigned int d = 0; d < dim; ++d)
          place[d] = points(r, d);
        const double weight = 1 / (1 + place.square()); // nearer points count more
        for (unsigned int k = 0; k < n_monomials; ++k)
          monomials(r, k) = weight * polynomials.compute_value(k, place);
        values.row(r) *= weight;
      }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors;
    factors.setThreshold(independent);
    factors.compute(monomials);
    if (factors.rank() < n_monomials)
      return {};
    Stress<dim> result        = Stress<dim>::Zero();
    result.head(n_components) = factors.solve(values).row(0).transpose().array();
    if (n_components < 2 * dim)
      result[n_components] = ElasticLaw(scene.materials[scene.bodies[body].material], state_of(scene))
                               .zz(result[0], result[1], TemperatureOfBody<dim>(scene, body, t)(x));
    return result;
  }

  template <int dim>
  std::vector<double> StressPoint<dim>::samples(const std::vector<Eigen::VectorXd> &u) const
  {
    const Eigen::Matrix<double, dim, dim> to_edges = shape_of_cells().inverse();
    const auto                            relative = [&](const dealii::Point<dim> &y) {
      Eigen::Matrix<double, dim, 1> difference;
      for (unsigned int d = 0; d < dim; ++d)
        difference[d] = y[d] - x[d];
      return Eigen::Matrix<double, dim, 1>(to_edges * difference);
    };
    const double                                 layers = 3;
    std::vector<double>                          result;
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<unsigned int>                    nodes;
    for (unsigned int p = 0; p < u.size(); ++p)
      if (mesh.subdomains[p]->body == body)
        {
          const StressModel<dim> on(scene, mesh, spaces, p, t);
          CellStress<dim>        stress(on, on.element.stress);
          for (const auto &cell : on.dof_handler.active_cell_iterators())
            {
              if (relative(cell->center()).template lpNorm<Eigen::Infinity>() > layers - margin_of_layers)
                continue;
              on.element.nodes_of(cell, dofs, nodes);
              const auto &at_points = stress.reinit(cell, displacement_at<dim>(nodes, u[p]));
              for (unsigned int q = 0; q < at_points.rows(); ++q)
                {
                  const auto place =
                    relative(on.element.mapping->transform_unit_to_real_cell(cell, on.element.stress.point(q)));
                  result.insert(result.end(), place.data(), place.data() + dim);
                  for (unsigned int c = 0; c < n_components; ++c)
                    result.push_back(at_points(q, c));
                }
            }
        }
    return result;
  }

  template <int dim>
  Eigen::Matrix<double, dim, dim> StressPoint<dim>::shape_of_cells() const
  {
    std::vector<double> best; // centre, then the columns
    for (const auto &[p, cell, unit] : places)
      {
        const auto         &mapping = *spaces.of(p).mapping;
        const auto          middle  = spaces.of(p).cell.template barycenter<dim>();
        const auto          centre  = mapping.transform_unit_to_real_cell(cell, middle);
        std::vector<double> shape(centre.begin_raw(), centre.end_raw());
        for (unsigned int d = 0; d < dim; ++d)
          {
            auto low = middle, high = middle;
            low[d] -= step_in_cell;
            high[d] += step_in_cell;
            const auto edge =
              (mapping.transform_unit_to_real_cell(cell, high) - mapping.transform_unit_to_real_cell(cell, low)) /
              (2 * step_in_cell);
            shape.insert(shape.end(), edge.begin_raw(), edge.end_raw());
          }
        if (best.empty() || shape < best)
          best = shape;
      }
    for (const auto &of_rank : all_gather(mesh.comm, best))
      if (best.empty() || (!of_rank.empty() && of_rank < best))
        best = of_rank;
    return Eigen::Map<const Eigen::Matrix<double, dim, dim>>(best.data() + dim);
  }

  template <int dim>
  std::vector<Eigen::VectorXd> StressPoint<dim>::loads(const Stress<dim> &weights) const
  {
    std::vector<Eigen::VectorXd> result;
    for (const auto &dof_handler : spaces.dof_handlers)
      result.push_back(Eigen::VectorXd::Zero(dof_handler->n_dofs()));
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<unsigned int>                    nodes;
    for (const auto &[p, cell, unit] : places)
      {
        const StressModel<dim> on(scene, mesh, spaces, p, t);
        const auto            &element       = on.element;
        const auto             points        = element.stiffness_rule(on.kinematics);
        Stress<dim>            of_components = weights;
        if (dim == 2 && !on.kinematics.is_revolution()) // zz follows from xx and yy
          of_components.template head<2>() += on.law.out_of_plane * weights[on.n_components];
        CellStress<dim>       stress(on, points);
        const Eigen::MatrixXd without = // thermal stress
          stress.reinit(cell, Eigen::MatrixXd::Zero(dim, element.n_nodes()));
        element.nodes_of(cell, dofs, nodes);
        for (unsigned int i = 0; i < nodes.size(); ++i)
          for (unsigned int c = 0; c < dim; ++c)
            {
              Eigen::MatrixXd u   = Eigen::MatrixXd::Zero(dim, nodes.size());
              u(c, i)             = 1;
              const auto &with    = stress.reinit(cell, u);
              double      of_unit = 0;
              for (unsigned int q = 0; q < points.size(); ++q)
                of_unit +=
                  stress.JxW(q) * (with.row(q) - without.row(q)).dot(of_components.head(on.n_components).matrix());
              result[p][dim * nodes[i] + c] += of_unit / measure;
            }
      }
    return result;
  }

  template <int dim>
  Stress<dim> von_mises_derivatives(const Stress<dim> &s)
  {
    const double size = von_mises<dim>(s);
    if (size == 0)
      return Stress<dim>::Zero();
    const double mean = (s[0] + s[1] + s[3]) / 3;
    Stress<dim>  d    = 3 * s / size;
    for (const unsigned int normal : {0, 1, 3})
      d[normal] = 1.5 * (s[normal] - mean) / size;
    return d;
  }

  template class StressPoint<2>;
  template class StressPoint<3>;
  template Stress<2> von_mises_derivatives<2>(const Stress<2> &);
  template Stress<3> von_mises_derivatives<3>(const Stress<3> &);
} // namespace slipstick::mechanics
