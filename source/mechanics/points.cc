#include <slipstick/base/exceptions.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/log.h>
#include <slipstick/mechanics/points.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <cmath>
#include <limits>
#include <tuple>

namespace slipstick::mechanics
{
  namespace
  {
    // Maximum distance of a node from its point, relative to the diameter of the largest cell around it. The point of
    // an equilateral triangle farthest from its vertices has 1 / sqrt(3).
    constexpr double reach_of_point = 0.6;

    // Nodes whose distances differ by less than this fraction of a cell's diameter are equally near.
    constexpr double same_distance = 1e-9;

    template <int dim>
    struct NearCell
    {
      double                  distance = std::numeric_limits<double>::max();
      double                  size     = 0; // diameter of the largest cell of the subdomain around the node
      std::array<double, dim> position{};
      unsigned int            subdomain = 0, node = 0;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &distance &size &position &subdomain &node;
      }

      bool comes_before(const NearCell &other) const
      {
        if (std::abs(distance - other.distance) > same_distance * std::max(size, other.size))
          return distance < other.distance;
        for (unsigned int d = 0; d < dim; ++d)
          if (std::abs(position[d] - other.position[d]) > same_distance * std::max(size, other.size))
            return position[d] < other.position[d];
        return std::tie(subdomain, node) < std::tie(other.subdomain, other.node);
      }
    };

    template <int dim>
    void find_in_subdomain(const Spaces<dim>        &spaces,
                           const mesh::Mesh<dim>    &mesh,
                           const unsigned int        p,
                           const dealii::Point<dim> &x,
                           NearCell<dim>            &best)
    {
      const auto                                  &element = spaces.of(p);
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;
      for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
        {
          const double size = cell->diameter();
          if (x.distance(cell->center()) > best.distance + 2 * size)
            continue;
          element.nodes_of(cell, dofs, nodes);
          for (unsigned int i = 0; i < nodes.size(); ++i)
            {
              const auto at = element.mapping->transform_unit_to_real_cell(cell, element.scalar->unit_support_point(i));
              NearCell<dim> candidate;
              candidate.distance  = x.distance(at);
              candidate.size      = size;
              candidate.subdomain = mesh.subdomains[p]->subdomain;
              candidate.node      = nodes[i];
              for (unsigned int d = 0; d < dim; ++d)
                candidate.position[d] = at[d];
              if (candidate.subdomain == best.subdomain && candidate.node == best.node && best.size > 0)
                best.size = std::max(best.size, size);
              else if (best.size == 0 || candidate.comes_before(best))
                best = candidate;
            }
        }
    }
  } // namespace

  template <int dim>
  std::vector<PointNode<dim>> nodes_at(const scene::Scene<dim>                  &scene,
                                       const mesh::Mesh<dim>                    &mesh,
                                       const Spaces<dim>                        &spaces,
                                       const std::vector<scene::PointName<dim>> &points,
                                       const std::vector<std::string>           &owners)
  {
    if (points.empty())
      return {};
    std::vector<dealii::Point<dim>> at;
    for (const auto &point : points)
      at.push_back(point.point.empty() ? *point.coordinates : mesh.points[point.body].at(point.point).position);
    std::vector<NearCell<dim>> best(points.size());
    for (unsigned int k = 0; k < points.size(); ++k)
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        if (mesh.subdomains[p]->body == points[k].body)
          {
            find_in_subdomain(spaces, mesh, p, at[k], best[k]);
          }
    for (const auto &others : all_gather(mesh.comm, best))
      for (unsigned int k = 0; k < points.size(); ++k)
        if (others[k].size > 0 && (best[k].size == 0 || others[k].comes_before(best[k])))
          best[k] = others[k];

    std::vector<PointNode<dim>> found(points.size());
    for (unsigned int k = 0; k < points.size(); ++k)
      {
        for (unsigned int d = 0; d < dim; ++d)
          found[k].position[d] = best[k].position[d];
        found[k].subdomain = best[k].subdomain;
        found[k].node      = best[k].node;
        if (best[k].size == 0 || best[k].distance > reach_of_point * best[k].size)
          throw InputError(
            format("%s: the point (%g, %g) is not on body '%s': the nearest node, (%g, %g), is %g mm away, "
                   "more than half a cell",
                   owners[k].c_str(),
                   at[k][0],
                   at[k][1],
                   scene.bodies[points[k].body].name.c_str(),
                   found[k].position[0],
                   found[k].position[1],
                   best[k].distance),
            "give coordinates in or on the body, or name the body that they belong to");
      }
    return found;
  }

  template struct PointNode<2>;
  template std::vector<PointNode<2>> nodes_at(const scene::Scene<2> &,
                                              const mesh::Mesh<2> &,
                                              const Spaces<2> &,
                                              const std::vector<scene::PointName<2>> &,
                                              const std::vector<std::string> &);
  template struct PointNode<3>;
  template std::vector<PointNode<3>> nodes_at(const scene::Scene<3> &,
                                              const mesh::Mesh<3> &,
                                              const Spaces<3> &,
                                              const std::vector<scene::PointName<3>> &,
                                              const std::vector<std::string> &);
} // namespace slipstick::mechanics
