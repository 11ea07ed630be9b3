#include <slipstick/base/box_tree.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/nearest.h>
#include <slipstick/mechanics/bond_ends.h>
#include <slipstick/mechanics/creases.h>
#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/points.h>
#include <slipstick/mechanics/singular_points.h>
#include <slipstick/mechanics/surface.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace slipstick::mechanics
{
  namespace
  {
    // Values that differ by less than this part are equal: symmetric places.
    constexpr double same_value = 1e-6;

    /// The displacements that supports hold on a boundary.
    template <int dim>
    std::array<bool, dim> held_on(const scene::Scene<dim> &scene,
                                  const mesh::Mesh<dim>   &mesh,
                                  const unsigned int       n_supports,
                                  const unsigned int       body,
                                  const unsigned int       boundary)
    {
      std::array<bool, dim> held{};
      for (unsigned int s = 0; s < n_supports; ++s)
        if (const auto &support = scene.supports[s];
            !support.point && support.where.body == body && mesh.on_boundary(support.where, boundary))
          for (unsigned int c = 0; c < dim; ++c)
            held[c] = held[c] || support.components[c];
      return held;
    }

    /// Kind of singularity where an outline turns (positive: where the body is convex) or supports change; empty if
    /// there is none.
    template <int dim>
    std::string what_is_at(const double                 turn,
                           const std::array<bool, dim> &held_in,
                           const std::array<bool, dim> &held_out)
    {
      const auto all = [](const std::array<bool, dim> &held) {
        return std::all_of(held.begin(), held.end(), [](const bool is_held) { return is_held; });
      };
      if (all(held_in) && all(held_out))
        return "";
      if (turn <= -least_turn)
        return dim == 2 ? "a re-entrant corner" : "a re-entrant edge";
      if (held_in == held_out)
        return "";
      return M_PI - turn >= (all(held_in) || all(held_out) ? least_angle_of_clamp : least_angle_of_roller)
               ? (dim == 2 ? "the end of a support" : "the edge of a support")
               : "";
    }

    template <int dim>
    struct Spot
    {
      double                  value = -1, size = 0;
      unsigned int            body = 0;
      std::array<double, dim> position{};

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &value &size &body &position;
      }

      bool comes_before(const Spot &other) const
      {
        if (std::abs(value - other.value) > same_value * std::max(value, other.value))
          return value > other.value;
        return std::tie(body, position) < std::tie(other.body, other.position);
      }

      void take(const double v, const double s, const unsigned int b, const dealii::Point<dim> &x)
      {
        Spot other;
        other.value = v;
        other.size  = s;
        other.body  = b;
        for (unsigned int d = 0; d < dim; ++d)
          other.position[d] = x[d];
        if (b == body && value >= 0 && other.position == position)
          size = std::max(size, s); // the same node, reached from another cell
        else if (other.comes_before(*this))
          *this = other;
      }

      Peak<dim> peak() const
      {
        Peak<dim> result;
        result.value = std::max(0., value);
        result.body  = body;
        for (unsigned int d = 0; d < dim; ++d)
          result.position[d] = position[d];
        return result;
      }
    };
  } // namespace

  template <int dim>
  double SingularPoint<dim>::distance(const dealii::Point<dim> &x) const
  {
    return (end ? nearest_on_segment(position, *end, x) : position).distance(x);
  }

  template <int dim>
  std::vector<SingularPoint<dim>> force_points(const scene::Scene<dim> &scene,
                                               const mesh::Mesh<dim>   &mesh,
                                               const Spaces<dim>       &spaces,
                                               const unsigned int       n_supports)
  {
    std::vector<SingularPoint<dim>>    result;
    std::vector<scene::PointName<dim>> points;
    std::vector<std::string>           names;
    const auto                         add = [&](const scene::PointName<dim> &where, const std::string &what) {
      points.push_back(where);
      names.push_back(what);
      result.push_back({where.body, {}, what});
    };
    for (unsigned int s = 0; s < n_supports; ++s)
      if (scene.supports[s].point)
        {
          add(*scene.supports[s].point, "the point support " + scene.supports[s].name);
          result.back().support = s;
        }
    for (unsigned int k = 0; k < scene.point_loads.size(); ++k)
      {
        add(scene.point_loads[k].where, "the point load " + scene.point_loads[k].name);
        result.back().load = k;
      }
    const auto nodes = nodes_at(scene, mesh, spaces, points, names);
    for (unsigned int k = 0; k < result.size(); ++k)
      result[k].position = nodes[k].position;
    return result;
  }

  template <int dim>
  std::vector<SingularPoint<dim>> singular_points(const scene::Scene<dim> &scene,
                                                  const mesh::Mesh<dim>   &mesh,
                                                  const Spaces<dim>       &spaces,
                                                  const unsigned int       n_supports)
  {
    auto       result  = force_points(scene, mesh, spaces, n_supports);
    const auto held_at = [&](const unsigned int body, const auto &side) {
      return held_on(scene, mesh, n_supports, body, side.boundary);
    };
    if constexpr (dim == 2)
      {
        const auto edges    = outlines(mesh, spaces, std::vector<bool>(scene.bodies.size(), true));
        const auto vertices = outline_vertices(edges);
        for (const auto &vertex : vertices)
          if (const auto what = what_is_at<dim>(vertex.turn(),
                                                held_at(vertex.in->body, *vertex.in),
                                                held_at(vertex.in->body, *vertex.out));
              !what.empty())
            result.push_back({vertex.in->body, vertex.position(), what});
        for (const auto &end : bond_ends(scene, mesh, vertices, n_supports))
          result.push_back({end.body, end.position, "an end of the bond " + scene.contacts[end.pair].name});
      }
    else
      {
        const auto edges  = creases(mesh, spaces, least_turn);
        const auto add_at = [&](const Crease &crease, const unsigned int body, const std::string &what) {
          result.push_back({body, crease.end(0), what});
          result.back().end = crease.end(1);
        };
        for (const auto &crease : edges)
          if (const auto what = what_is_at<dim>(crease.turn(),
                                                held_at(crease.body, crease.sides[0]),
                                                held_at(crease.body, crease.sides[1]));
              !what.empty())
            add_at(crease, crease.body, what);
        for (const auto &edge : bond_edges(scene, mesh, spaces, edges, n_supports))
          add_at(*edge.crease, edge.body, "an edge of the bond " + scene.contacts[edge.pair].name);
      }
    return result;
  }

  template <int dim>
  StressPlaces<dim> stress_places(const mesh::Mesh<dim>                &mesh,
                                  const Spaces<dim>                    &spaces,
                                  const StressResult                   &stress,
                                  const std::vector<Surroundings<dim>> &left_out)
  {
    const auto is_left_out = [&](const unsigned int body, const dealii::Point<dim> &x) {
      return std::any_of(left_out.begin(), left_out.end(), [&](const Surroundings<dim> &around) {
        return around.of.body == body && around.of.distance(x) <= around.radius;
      });
    };
    std::vector<Spot<dim>>                       spots(2); // stress, error
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<unsigned int>                    nodes;
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      {
        const auto        &element = spaces.of(p);
        const unsigned int body    = mesh.subdomains[p]->body;
        for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
          {
            spots[1].take(stress.subdomains[p].error[cell->active_cell_index()],
                          cell->diameter(),
                          body,
                          cell->center());
            element.nodes_of(cell, dofs, nodes);
            for (unsigned int i = 0; i < nodes.size(); ++i)
              {
                const auto   s     = stress.subdomains[p].nodal.row(nodes[i]);
                const double value = von_mises<dim>(s);
                if (value < spots[0].value * (1 - same_value))
                  continue;
                const auto x =
                  i < cell->n_vertices()
                    ? cell->vertex(i)
                    : element.mapping->transform_unit_to_real_cell(cell, element.scalar->unit_support_point(i));
                if (!is_left_out(body, x))
                  spots[0].take(value, cell->diameter(), body, x);
              }
          }
      }
    for (const auto &of_rank : all_gather(mesh.comm, spots))
      for (unsigned int k = 0; k < spots.size(); ++k)
        if (of_rank[k].comes_before(spots[k]))
          spots[k] = of_rank[k];
    return {spots[0].peak(), spots[0].size, spots[1].peak()};
  }

  template <int dim>
  std::vector<CellAtPlace> cells_at(const mesh::Mesh<dim>                &mesh,
                                    const Spaces<dim>                    &spaces,
                                    const StressResult                   &stress,
                                    const std::vector<Surroundings<dim>> &places)
  {
    // distance, size, minus the stress: of equally near cells the smallest, then the one with the largest stress
    using Entry = std::array<double, 3>;
    std::vector<Entry> nearest(places.size(), {{std::numeric_limits<double>::infinity(), 0, 0}});
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<unsigned int>                    nodes;
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      {
        if (std::none_of(places.begin(), places.end(), [&](const Surroundings<dim> &place) {
              return place.of.body == mesh.subdomains[p]->body;
            }))
          continue;
        std::vector<typename dealii::DoFHandler<dim>::active_cell_iterator> cells;
        std::vector<typename BoxTree<dim>::Box>                             centers;
        for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
          {
            cells.push_back(cell);
            centers.push_back(BoxTree<dim>::box_around({cell->center()}));
          }
        const BoxTree<dim> tree(centers);
        for (std::size_t k = 0; k < places.size(); ++k)
          if (places[k].of.body == mesh.subdomains[p]->body)
            tree.for_each_by_distance(
              places[k].of.middle(),
              [&] { return nearest[k][0]; },
              [&](const unsigned int i) {
                double edges = 0, largest = 0;
                for (const unsigned int l : cells[i]->line_indices())
                  edges += cells[i]->line(l)->diameter();
                spaces.of(p).nodes_of(cells[i], dofs, nodes);
                for (const unsigned int node : nodes)
                  largest = std::max(largest, von_mises<dim>(stress.subdomains[p].nodal.row(node)));
                nearest[k] = std::min(
                  nearest[k],
                  {{cells[i]->center().distance(places[k].of.middle()), edges / cells[i]->n_lines(), -largest}});
                return true;
              });
      }
    for (const auto &of_rank : all_gather(mesh.comm, nearest))
      for (std::size_t k = 0; k < places.size(); ++k)
        nearest[k] = std::min(nearest[k], of_rank[k]);
    std::vector<CellAtPlace> found;
    for (const auto &[distance, size, minus_stress] : nearest)
      found.push_back({size, -minus_stress});
    return found;
  }

  template struct SingularPoint<2>;
  template std::vector<SingularPoint<2>> force_points(const scene::Scene<2> &,
                                                      const mesh::Mesh<2> &,
                                                      const Spaces<2> &,
                                                      const unsigned int);
  template std::vector<SingularPoint<2>> singular_points(const scene::Scene<2> &,
                                                         const mesh::Mesh<2> &,
                                                         const Spaces<2> &,
                                                         const unsigned int);
  template StressPlaces<2>               stress_places(const mesh::Mesh<2> &,
                                                       const Spaces<2> &,
                                                       const StressResult &,
                                                       const std::vector<Surroundings<2>> &);
  template std::vector<CellAtPlace>      cells_at(const mesh::Mesh<2> &,
                                                  const Spaces<2> &,
                                                  const StressResult &,
                                                  const std::vector<Surroundings<2>> &);
  template struct SingularPoint<3>;
  template std::vector<SingularPoint<3>> force_points(const scene::Scene<3> &,
                                                      const mesh::Mesh<3> &,
                                                      const Spaces<3> &,
                                                      const unsigned int);
  template std::vector<SingularPoint<3>> singular_points(const scene::Scene<3> &,
                                                         const mesh::Mesh<3> &,
                                                         const Spaces<3> &,
                                                         const unsigned int);
  template StressPlaces<3>               stress_places(const mesh::Mesh<3> &,
                                                       const Spaces<3> &,
                                                       const StressResult &,
                                                       const std::vector<Surroundings<3>> &);
  template std::vector<CellAtPlace>      cells_at(const mesh::Mesh<3> &,
                                                  const Spaces<3> &,
                                                  const StressResult &,
                                                  const std::vector<Surroundings<3>> &);
} // namespace slipstick::mechanics
