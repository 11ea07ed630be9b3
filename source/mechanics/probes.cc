#include <slipstick/base/exceptions.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/mechanics/nearest_in_cell.h>
#include <slipstick/mechanics/probes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::mechanics
{
  namespace
  {
    // Maximum distance of a point from its cell, as a fraction of the diameter: edges cut off part of the true curves.
    constexpr double reach_of_probe = 0.1;
  } // namespace

  template <int dim>
  Probes<dim>::Probes(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh_, const Spaces<dim> &spaces_)
    : mesh(mesh_)
    , spaces(spaces_)
    , points(scene.probes.size())
    , places(scene.probes.size())
  {
    std::vector<double>                      distances; // followed by the diameters
    std::vector<double>                      diameters;
    std::vector<std::array<unsigned int, 2>> which;
    for (unsigned int k = 0; k < scene.probes.size(); ++k)
      {
        const auto                     &probe = scene.probes[k];
        std::vector<dealii::Point<dim>> ends;
        for (const auto &end : probe.ends)
          ends.push_back(end.point.empty() ? *end.coordinates : mesh.points[end.body].at(end.point).position);
        const unsigned int n = ends.size() > 1 ? probe.n_points : 1;
        for (unsigned int i = 0; i < n; ++i)
          {
            const double    s = n > 1 ? static_cast<double>(i) / (n - 1) : 0.;
            ProbePoint<dim> point;
            point.position = ends.front() + s * (ends.back() - ends.front());
            point.distance = s * ends.front().distance(ends.back());
            Place place;
            const auto [distance, diameter] = find(probe.body, point.position, place);
            points[k].push_back(point);
            places[k].push_back(place);
            distances.push_back(distance);
            diameters.push_back(diameter);
            which.push_back({{k, i}});
          }
      }
    const unsigned int  rank     = dealii::Utilities::MPI::this_mpi_process(mesh.comm);
    const auto          of_ranks = all_gather(mesh.comm, distances);
    std::vector<double> all_diameters(diameters.size());
    dealii::Utilities::MPI::max(diameters, mesh.comm, all_diameters);
    for (unsigned int j = 0; j < which.size(); ++j)
      {
        unsigned int nearest = 0;
        for (unsigned int r = 1; r < of_ranks.size(); ++r)
          if (of_ranks[r][j] < of_ranks[nearest][j])
            nearest = r;
        const auto [k, i]   = which[j];
        places[k][i].is_own = nearest == rank;
        if (!(of_ranks[nearest][j] <= reach_of_probe * all_diameters[j]))
          throw InputError(format("Probe %s: the point %s is not on body '%s'",
                                  scene.probes[k].name.c_str(),
                                  point_text(points[k][i].position, dim).c_str(),
                                  scene.bodies[scene.probes[k].body].name.c_str()),
                           "give coordinates in or on the body, before loading, or name the body that they belong to");
      }
  }

  template <int dim>
  std::pair<double, double> Probes<dim>::find(const unsigned int body, const dealii::Point<dim> &x, Place &place) const
  {
    std::pair<double, double> best{std::numeric_limits<double>::max(), 0.};
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      if (mesh.subdomains[p]->body == body)
        for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
          if (const auto nearest = nearest_in_cell<dim>(spaces.of(p), cell, x);
              nearest && nearest->distance < best.first)
            {
              best       = {nearest->distance, cell->diameter()};
              place.p    = p;
              place.cell = cell;
              place.unit = nearest->unit;
            }
    return best;
  }

  template <int dim>
  std::vector<std::vector<ProbePoint<dim>>> Probes<dim>::values(const std::vector<Eigen::VectorXd> &u,
                                                                const StressResult                 &stress) const
  {
    constexpr unsigned int                       n_stress = 2 * dim, n = dim + n_stress;
    std::vector<double>                          own;
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<unsigned int>                    nodes;
    for (const auto &of_probe : places)
      for (const Place &place : of_probe)
        {
          own.resize(own.size() + n);
          if (!place.is_own)
            continue;
          double *const value   = own.data() + own.size() - n;
          const auto   &element = spaces.of(place.p);
          element.nodes_of(place.cell, dofs, nodes);
          for (unsigned int i = 0; i < nodes.size(); ++i)
            {
              const double N = element.scalar->shape_value(i, place.unit);
              for (unsigned int d = 0; d < dim; ++d)
                value[d] += N * u[place.p][dim * nodes[i] + d];
              for (unsigned int c = 0; c < n_stress; ++c)
                value[dim + c] += N * stress.subdomains[place.p].nodal(nodes[i], c);
            }
        }
    std::vector<double> all(own.size());
    dealii::Utilities::MPI::sum(own, mesh.comm, all);
    auto          result = points;
    const double *value  = all.data();
    for (auto &of_probe : result)
      for (auto &point : of_probe)
        {
          for (unsigned int d = 0; d < dim; ++d)
            point.displacement[d] = value[d];
          std::copy_n(value + dim, n_stress, point.stress.begin());
          value += n;
        }
    return result;
  }

  template <int dim>
  std::vector<Eigen::VectorXd> Probes<dim>::unit_force(const unsigned int k, const unsigned int d) const
  {
    std::vector<Eigen::VectorXd> loads;
    for (const auto &dof_handler : spaces.dof_handlers)
      loads.push_back(Eigen::VectorXd::Zero(dof_handler->n_dofs()));
    const Place &place = places[k].front();
    if (!place.is_own)
      return loads;
    const auto                                  &element = spaces.of(place.p);
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<unsigned int>                    nodes;
    element.nodes_of(place.cell, dofs, nodes);
    for (unsigned int i = 0; i < nodes.size(); ++i)
      loads[place.p][dim * nodes[i] + d] += element.scalar->shape_value(i, place.unit);
    return loads;
  }

  template class Probes<2>;
  template class Probes<3>;
} // namespace slipstick::mechanics
