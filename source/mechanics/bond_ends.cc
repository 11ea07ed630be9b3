#include <slipstick/base/box_tree.h>
#include <slipstick/base/nearest.h>
#include <slipstick/mechanics/bond_ends.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace slipstick::mechanics
{
  namespace
  {
    // The other body is at the end of a bond if it is nearer than this fraction of an edge.
    constexpr double reached = 0.1;

    /// Whether a boundary is bonded or supported.
    template <int dim>
    bool is_held(const scene::Scene<dim> &scene,
                 const mesh::Mesh<dim>   &mesh,
                 const unsigned int       n_supports,
                 const unsigned int       body,
                 const unsigned int       boundary)
    {
      const auto on = [&](const scene::BoundaryName &where) {
        return where.body == body && mesh.on_boundary(where, boundary);
      };
      return std::any_of(scene.contacts.begin(),
                         scene.contacts.end(),
                         [&](const scene::ContactPair<dim> &pair) {
                           return pair.law.is_bonded && (on(pair.slave) || (pair.master && on(*pair.master)));
                         }) ||
             std::any_of(scene.supports.begin(), scene.supports.begin() + n_supports, [&](const auto &support) {
               return !support.point && on(support.where);
             });
    }

    template <int dim>
    double distance_from(const SurfaceEdge<dim> &edge, const dealii::Point<dim> &x)
    {
      const auto   along = edge.node(1) - edge.node(0);
      const double s     = std::clamp(((x - edge.node(0)) * along) / along.norm_square(), 0., 1.);
      return edge.point(s).distance(x);
    }

    /// Angle of the outline on a boundary at a point; nothing if the boundary does not reach the point.
    template <int dim>
    std::optional<double> angle_at(const mesh::Mesh<dim>                 &mesh,
                                   const std::vector<OutlineVertex<dim>> &vertices,
                                   const scene::BoundaryName             &where,
                                   const dealii::Point<dim>              &x)
    {
      std::optional<double> result;
      for (const auto &vertex : vertices)
        for (const auto *edge : {vertex.in, vertex.out})
          if (edge->body == where.body && mesh.on_boundary(where, edge->boundary) &&
              distance_from(*edge, x) <= reached * edge->chord())
            {
              if (vertex.position().distance(x) <= reached * edge->chord())
                return vertex.angle();
              result = M_PI;
            }
      return result;
    }

    /// For an edge at the end of a boundary: the one of its sides that is not on the boundary. Nothing for other edges.
    std::optional<unsigned int> side_beyond(const mesh::Mesh<3>       &mesh,
                                            const Crease              &crease,
                                            const scene::BoundaryName &where)
    {
      std::array<bool, 2> on{};
      for (const unsigned int i : {0, 1})
        on[i] = crease.body == where.body && mesh.on_boundary(where, crease.sides[i].boundary);
      if (on[0] == on[1])
        return {};
      return on[0] ? 1 : 0;
    }

    /// A bonded boundary of a solid, with its edges.
    class BondedSide
    {
    public:
      BondedSide(const mesh::Mesh<3>             &mesh,
                 const std::vector<SurfaceFacet> &surfaces,
                 const std::vector<Crease>       &creases,
                 const scene::BoundaryName       &where)
        : facets(parts_on(mesh, surfaces, where))
        , ends(ends_of(mesh, creases, where))
        , tree_of_facets(facet_tree(facets))
        , tree_of_ends(boxes_of(ends))
      {}

      /// Angle of the body at a place; nothing if it is farther away than @p close.
      std::optional<double> angle_at(const dealii::Point<3> &x, const double close) const
      {
        const auto box = BoxTree<3>::widened(BoxTree<3>::box_around({x}), close);
        for (const unsigned int i : tree_of_ends.near(box))
          if (nearest_on_segment(ends[i]->end(0), ends[i]->end(1), x).distance(x) <= close)
            return ends[i]->angle();
        for (const unsigned int i : tree_of_facets.near(box))
          if (facets[i].distance(x) <= close)
            return M_PI;
        return {};
      }

    private:
      static std::vector<const Crease *> ends_of(const mesh::Mesh<3>       &mesh,
                                                 const std::vector<Crease> &creases,
                                                 const scene::BoundaryName &where)
      {
        std::vector<const Crease *> result;
        for (const auto &crease : creases)
          if (side_beyond(mesh, crease, where))
            result.push_back(&crease);
        return result;
      }

      static std::vector<BoxTree<3>::Box> boxes_of(const std::vector<const Crease *> &ends)
      {
        std::vector<BoxTree<3>::Box> boxes;
        for (const auto *crease : ends)
          boxes.push_back(BoxTree<3>::box_around({crease->end(0), crease->end(1)}));
        return boxes;
      }

      const std::vector<SurfaceFacet>   facets;
      const std::vector<const Crease *> ends;
      const BoxTree<3>                  tree_of_facets, tree_of_ends;
    };
  } // namespace

  template <int dim>
  std::vector<BondEnd<dim>> bond_ends(const scene::Scene<dim>               &scene,
                                      const mesh::Mesh<dim>                 &mesh,
                                      const std::vector<OutlineVertex<dim>> &vertices,
                                      const unsigned int                     n_supports)
  {
    const auto on = [&](const SurfaceEdge<dim> &edge, const scene::BoundaryName &where) {
      return edge.body == where.body && mesh.on_boundary(where, edge.boundary);
    };
    std::vector<BondEnd<dim>> result;
    const auto add = [&](const unsigned int body, const unsigned int pair, const OutlineVertex<dim> &at) {
      const auto   x     = at.position();
      const double close = reached * std::min(at.in->chord(), at.out->chord());
      if (std::none_of(result.begin(), result.end(), [&](const BondEnd<dim> &other) {
            return other.body == body && other.position.distance(x) <= close; // the same, found on the other side
          }))
        result.push_back({body, pair, x});
    };
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      if (const auto &pair = scene.contacts[k]; pair.law.is_bonded)
        for (const bool is_slave : {true, false})
          {
            if (!is_slave && !pair.master)
              continue;
            const auto &side = is_slave ? pair.slave : *pair.master;
            for (const auto &vertex : vertices)
              {
                const bool before = on(*vertex.in, side), after = on(*vertex.out, side);
                if (before == after)
                  continue;
                if (const auto &other = before ? *vertex.out : *vertex.in;
                    is_held(scene, mesh, n_supports, other.body, other.boundary))
                  continue;
                if (!pair.master)
                  {
                    if (vertex.angle() >= least_angle_of_clamp)
                      add(side.body, k, vertex);
                    continue;
                  }
                const auto &partner = is_slave ? *pair.master : pair.slave;
                if (const auto angle = angle_at(mesh, vertices, partner, vertex.position());
                    angle && vertex.angle() + *angle >= M_PI + least_turn)
                  for (const unsigned int body : {side.body, partner.body})
                    add(body, k, vertex);
              }
          }
    return result;
  }

  std::vector<BondEdge> bond_edges(const scene::Scene<3>     &scene,
                                   const mesh::Mesh<3>       &mesh,
                                   const Spaces<3>           &spaces,
                                   const std::vector<Crease> &creases,
                                   const unsigned int         n_supports)
  {
    std::vector<bool> wanted(scene.bodies.size());
    for (const auto &pair : scene.contacts)
      if (pair.law.is_bonded && pair.master)
        wanted[pair.slave.body] = wanted[pair.master->body] = true;
    const auto            surfaces = outlines(mesh, spaces, wanted);
    std::vector<BondEdge> result;
    const auto            add = [&](const unsigned int               pair,
                         const scene::BoundaryName       &side,
                         const std::vector<unsigned int> &bodies,
                         const auto                      &is_singular) {
      for (const auto &crease : creases)
        if (const auto other = side_beyond(mesh, crease, side);
            other && !is_held(scene, mesh, n_supports, crease.body, crease.sides[*other].boundary) &&
            is_singular(crease))
          for (const unsigned int body : bodies)
            result.push_back({body, pair, &crease});
    };
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      if (const auto &pair = scene.contacts[k]; pair.law.is_bonded && !pair.master)
        add(k, pair.slave, {pair.slave.body}, [](const Crease &crease) {
          return crease.angle() >= least_angle_of_clamp;
        });
      else if (pair.law.is_bonded)
        for (const auto &[side, partner] :
             {std::make_pair(pair.slave, *pair.master), std::make_pair(*pair.master, pair.slave)})
          {
            const BondedSide opposite(mesh, surfaces, creases, partner);
            add(k, side, {side.body, partner.body}, [&](const Crease &crease) {
              const auto angle = opposite.angle_at(crease.middle(), reached * crease.length());
              return angle && crease.angle() + *angle >= M_PI + least_turn;
            });
          }
    return result;
  }

  template std::vector<BondEnd<2>> bond_ends(const scene::Scene<2> &,
                                             const mesh::Mesh<2> &,
                                             const std::vector<OutlineVertex<2>> &,
                                             const unsigned int);
} // namespace slipstick::mechanics
