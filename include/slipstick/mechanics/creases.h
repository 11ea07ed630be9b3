// Edges of solids: where two faces of a surface meet at an angle, or two boundaries meet.
#pragma once

#include <slipstick/mechanics/surface_facet.h>

#include <cmath>

namespace slipstick::mechanics
{
  /// An edge of the mesh between two facets of a surface.
  struct Crease
  {
    struct Side
    {
      unsigned int         boundary = 0; // boundary id
      dealii::Tensor<1, 3> normal;       // outward unit normal of the true surface at the middle of the edge
      dealii::Tensor<1, 3> along;        // the edge, the facet on its left as seen from outside [mm]

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &boundary &normal &along;
      }
    };

    unsigned int                         body = 0;
    std::array<std::array<double, 3>, 2> at{}; // ends, that with the smaller key first [mm]
    std::array<Side, 2>                  sides;

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &body &at &sides;
    }

    dealii::Point<3> end(const unsigned int i) const
    {
      return {at[i][0], at[i][1], at[i][2]};
    }

    dealii::Point<3> middle() const
    {
      return end(0) + (end(1) - end(0)) / 2;
    }

    double length() const // [mm]
    {
      return end(0).distance(end(1));
    }

    /// Angle between the facets, positive where the body is convex.
    double turn() const;

    /// Angle inside the body.
    double angle() const
    {
      return M_PI - turn();
    }
  };

  /// The edges at which the two sides are on different boundaries, or the surface is re-entrant by @p least_turn or
  /// more. Sorted, the same on every rank. Collective.
  std::vector<Crease> creases(const mesh::Mesh<3> &mesh, const Spaces<3> &spaces, const double least_turn);
} // namespace slipstick::mechanics
