// Vertices of the outlines of plane bodies, and the angles at which stresses there are infinite.
#pragma once

#include <slipstick/mechanics/surface.h>

#include <cmath>
#include <map>

namespace slipstick::mechanics
{
  // An outline is re-entrant where its direction turns by this angle or more; it is also the default corner angle.
  constexpr double least_turn = 35 * M_PI / 180;
  // Smallest angles with infinite stress at the end of a support. Both displacements held: from 63 (nu = 0) to 51
  // degrees (nu = 0.5), plane strain (Williams 1952); one displacement held: above a right angle.
  constexpr double least_angle_of_clamp = 63 * M_PI / 180, least_angle_of_roller = 95 * M_PI / 180;

  /// Where one edge of an outline ends and the next begins.
  template <int dim>
  struct OutlineVertex
  {
    const SurfaceEdge<dim> *in, *out;

    dealii::Point<dim> position() const
    {
      return in->node(1);
    }

    /// Change of direction of the true outline, positive to the left, the side of the body.
    double turn() const
    {
      const auto n = in->outline_normal(1), m = out->outline_normal(0);
      return std::atan2(cross(n, m), n * m);
    }

    /// Angle inside the body.
    double angle() const
    {
      return M_PI - turn();
    }
  };

  /// The vertices between @p edges, which must outlive them.
  template <int dim>
  std::vector<OutlineVertex<dim>> outline_vertices(const std::vector<SurfaceEdge<dim>> &edges)
  {
    std::map<std::pair<unsigned int, NodeKey>, const SurfaceEdge<dim> *> from;
    for (const auto &edge : edges)
      from.emplace(std::make_pair(edge.body, edge.keys[0]), &edge);
    std::vector<OutlineVertex<dim>> result;
    for (const auto &in : edges)
      if (const auto out = from.find({in.body, in.keys[1]}); out != from.end())
        result.push_back({&in, out->second});
    return result;
  }
} // namespace slipstick::mechanics
