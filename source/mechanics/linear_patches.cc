#include <slipstick/mechanics/linear_patches.h>

#include <deal.II/dofs/dof_accessor.h>

namespace slipstick::mechanics
{
  namespace
  {
    // Faces of a vertex are on the same side of the body if their normals differ by less than about 35 degrees:
    // tan^2(35 / 2) = 0.1.
    constexpr double same_side = 0.1;

    template <int dim>
    using Slopes = Eigen::Matrix<double, dim, Eigen::Dynamic, 0, dim, 2 * dim>;

    /// Unit normal vector of a face, of any sign.
    template <int dim, class Face>
    Eigen::Matrix<double, dim, 1> normal_of(const Face &face)
    {
      Eigen::Matrix<double, dim, 1> result;
      if constexpr (dim == 2)
        {
          const auto along = distance<dim>(face->vertex(1), face->vertex(0));
          result << along[1], -along[0];
        }
      else
        { // diagonals of a quadrilateral, whose vertices are in lexicographic order; edges of a triangle
          const bool is_triangle = face->n_vertices() == 3;
          result                 = distance<dim>(face->vertex(is_triangle ? 1 : 3), face->vertex(0))
                     .cross(distance<dim>(face->vertex(2), face->vertex(is_triangle ? 0 : 1)));
        }
      return result.normalized();
    }

    /// Solution of covariance x = right; zero in directions in which the points have no extent.
    template <int dim>
    Slopes<dim> solved(const PointMoments<dim> &moments, const Slopes<dim> &right)
    {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, dim, dim>> axes(moments.covariance);
      Eigen::Matrix<double, dim, 1>                                        inverses = axes.eigenvalues();
      const double least = moments.least_variance(inverses[dim - 1]);
      for (double &value : inverses)
        value = value > least ? 1 / value : 0;
      return axes.eigenvectors() * (inverses.asDiagonal() * (axes.eigenvectors().transpose() * right));
    }
  } // namespace

  template <int dim>
  LinearPatches<dim>::LinearPatches(const dealii::DoFHandler<dim>   &dof_handler_,
                                    const Element<dim>              &element_,
                                    const unsigned int               n_components_,
                                    const std::vector<unsigned int> &shared)
    : sums(dof_handler_, shared)
    , dof_handler(dof_handler_)
    , element(element_)
    , n_components(n_components_)
  {}

  template <int dim>
  void LinearPatches<dim>::start_fit(const StressSamples<dim> &samples)
  {
    using Moments                     = PointMoments<dim>;
    constexpr unsigned int at_normals = Moments::n_columns, at_simplices = at_normals + Moments::n_squares,
                           at_stresses = at_simplices + 1;
    const unsigned int at_products     = at_stresses + n_components;
    const unsigned int n_vertices      = dof_handler.get_triangulation().n_vertices();
    values.resize(n_vertices, n_components);
    slopes.resize(n_vertices, dim * n_components);
    n_sides.resize(n_vertices);
    has_simplices.resize(n_vertices);
    has_taken.resize(n_vertices);

    sums.start(
      at_products + dim * n_components,
      [&](typename PatchSums<dim>::Sums &sum) {
        unsigned int first = 0;
        for (const auto &cell : dof_handler.active_cell_iterators())
          {
            for (const unsigned int v : cell->vertex_indices())
              {
                auto row = sum.row(cell->vertex_index(v));
                row[at_simplices] += element.cell.is_simplex();
                for (unsigned int q = first; q < first + element.stress.size(); ++q)
                  {
                    const Vector x = distance<dim>(samples.points[q], cell->vertex(v));
                    Moments::add(x, row);
                    for (unsigned int c = 0; c < n_components; ++c)
                      {
                        row[at_stresses + c] += samples.stresses(q, c);
                        for (unsigned int d = 0; d < dim; ++d)
                          row[at_products + dim * c + d] += x[d] * samples.stresses(q, c);
                      }
                  }
              }
            for (const auto &face : cell->face_iterators())
              if (mesh::is_on_outline(face))
                for (const unsigned int v : face->vertex_indices())
                  Moments::add_square(normal_of<dim>(face), sum.row(face->vertex_index(v)), at_normals);
            first += element.stress.size();
          }
      },
      [=](const unsigned int v, const typename PatchSums<dim>::Row &row) {
        const Moments                                                              moments(row);
        const Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 2 *dim> mean =
          row.segment(at_stresses, n_components) / moments.n;
        Slopes products(dim, n_components);
        for (unsigned int c = 0; c < n_components; ++c)
          products.col(c) = row.template segment<dim>(at_products + dim * c).transpose() / moments.n;
        set_slopes(v, solved<dim>(moments, products - moments.mean * mean));
        values.row(v)      = mean - moments.mean.transpose() * slopes_of(v);
        has_simplices[v]   = row[at_simplices] > 0;
        const auto normals = Moments::symmetric(row, at_normals);
        if (normals.trace() > 0)
          {
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, dim, dim>> axes(normals, Eigen::EigenvaluesOnly);
            n_sides[v]    = (axes.eigenvalues().array() > same_side * axes.eigenvalues()[dim - 1]).count();
            mean_place[v] = moments.mean;
          }
      });
  }

  template <int dim>
  void LinearPatches<dim>::start_taking(const unsigned int sides)
  {
    sums.start((dim + 1) * n_components + 1,
               [&](typename PatchSums<dim>::Sums &sum) {
                 for (const auto &cell : dof_handler.active_cell_iterators())
                   for (const unsigned int v : cell->vertex_indices())
                     if (const unsigned int to = cell->vertex_index(v); n_sides[to] > sides && !has_taken[to])
                       for (const unsigned int w : cell->vertex_indices())
                         if (const unsigned int from = cell->vertex_index(w); n_sides[from] == sides)
                           {
                             const Vector x   = distance<dim>(cell->vertex(v), cell->vertex(w));
                             auto         row = sum.row(to);
                             row.head(dim * n_components) += slopes.row(from);
                             row.segment(dim * n_components, n_components) +=
                               values.row(from) + x.transpose() * slopes_of(from);
                             row[(dim + 1) * n_components] += 1;
                           }
               },
               [=](const unsigned int v, const typename PatchSums<dim>::Row &row) {
                 const double n = row[(dim + 1) * n_components];
                 if (n == 0)
                   return;
                 const Slopes own = slopes_of(v);
                 slopes.row(v)    = row.head(dim * n_components) / n;
                 if (has_simplices[v])
                   values.row(v) = row.segment(dim * n_components, n_components) / n;
                 else
                   values.row(v) += mean_place.at(v).transpose() * (own - slopes_of(v));
                 has_taken[v] = true;
               });
  }

  template <int dim>
  Eigen::MatrixXd LinearPatches<dim>::nodal() const
  {
    Eigen::MatrixXd result(dof_handler.n_dofs() / dim, n_components);
    for (const auto &cell : dof_handler.active_cell_iterators())
      for (const unsigned int v : cell->vertex_indices())
        result.row(cell->vertex_dof_index(v, 0) / dim) = values.row(cell->vertex_index(v));
    return result;
  }

  template <int dim>
  typename LinearPatches<dim>::Slopes LinearPatches<dim>::slopes_of(const unsigned int vertex) const
  {
    Slopes result(dim, n_components);
    for (unsigned int c = 0; c < n_components; ++c)
      result.col(c) = slopes.row(vertex).template segment<dim>(dim * c).transpose();
    return result;
  }

  template <int dim>
  void LinearPatches<dim>::set_slopes(const unsigned int vertex, const Slopes &of_vertex)
  {
    for (unsigned int c = 0; c < n_components; ++c)
      slopes.row(vertex).template segment<dim>(dim * c) = of_vertex.col(c).transpose();
  }

  template class LinearPatches<2>;
  template class LinearPatches<3>;
} // namespace slipstick::mechanics
