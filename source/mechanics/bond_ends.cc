#include <slipstick/mechanics/bond_ends.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace slipstick::mechanics
{
  namespace
  {
    // The other body is at the end of a bond if it is nearer than this part of an edge.
    constexpr double reached = 0.1;

    template <int dim>
    double distance_from(const SurfaceEdge<dim> &edge, const dealii::Point<dim> &x)
    {
      const auto   along = edge.node(1) - edge.node(0);
      const double s     = std::clamp(((x - edge.node(0)) * along) / along.norm_square(), 0., 1.);
      return edge.point(s).distance(x);
    }

    /// Angle of the outline on a boundary at a point; nothing if it does not reach it.
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
    const auto is_bonded = [&](const SurfaceEdge<dim> &edge) {
      return std::any_of(scene.contacts.begin(), scene.contacts.end(), [&](const scene::ContactPair<dim> &pair) {
        return pair.law.is_bonded && (on(edge, pair.slave) || (pair.master && on(edge, *pair.master)));
      });
    };
    const auto is_supported = [&](const SurfaceEdge<dim> &edge) {
      return std::any_of(scene.supports.begin(), scene.supports.begin() + n_supports, [&](const auto &support) {
        return !support.point && on(edge, support.where);
      });
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
                if (const auto &other = before ? *vertex.out : *vertex.in; is_bonded(other) || is_supported(other))
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

  template std::vector<BondEnd<2>> bond_ends(const scene::Scene<2> &,
                                             const mesh::Mesh<2> &,
                                             const std::vector<OutlineVertex<2>> &,
                                             const unsigned int);
} // namespace slipstick::mechanics
