// The tangential forces of nodes in space as parts of an active set: discs whose radii follow the normal forces, and the
// turns of the nodes that slip.
#pragma once

#include <slipstick/qp/box.h>
#include <slipstick/qp/pressure_bounds.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace slipstick::qp::detail
{
  /// For every owned entry: -1 at the lower bound, 1 at the upper bound, 0 free.
  using Sides = std::vector<signed char>;

  // If the compliance across a slipping force times the weight of its entry exceeds this (for |F| = 1), the entry is
  // held. Far beyond that of sliding bodies, which such entries alone may hold across their motion (doc/decisions/0136).
  constexpr double rigid_compliance = 1e8;

  /// Sets the bounds of the tangential entries of a node for a radius. Those of a disc are meant as turned: x_s is held
  /// at 0 if the radius is 0 or if it is at a bound, also of a node whose first entry was freed; otherwise it has no
  /// bounds.
  template <typename Vector>
  void set_radius(const PressureBound &bound, const double radius, const Sides &sides, Box<Vector> &box)
  {
    box.lower.begin()[bound.tangential] = -radius;
    box.upper.begin()[bound.tangential] = radius;
    if (!bound.is_disc())
      return;
    const bool is_held              = !(radius > 0) || sides[bound.second] != 0;
    box.lower.begin()[bound.second] = is_held ? 0. : -HUGE_VAL;
    box.upper.begin()[bound.second] = is_held ? 0. : HUGE_VAL;
  }

  /// The discs of a set, each with the direction of its force. The side of the first entry is 1 if the node slips, and 0
  /// if it sticks; the side of the second is 1 if x_s is held at 0.
  template <typename Vector>
  class FrictionDiscs
  {
  public:
    /// @param bounds_ intervals among them are ignored. @param weights_ of residuals (residual_weights()), kept by
    /// pointer. @param n_entries owned by this process
    FrictionDiscs(const std::vector<PressureBound> &bounds_, const double *weights_, const std::size_t n_entries)
      : weights(weights_)
      , in_disc(n_entries, false)
    {
      for (const PressureBound &bound : bounds_)
        if (bound.is_disc())
          {
            in_disc[bound.tangential] = in_disc[bound.second] = true;
            bounds.push_back(bound);
            all.push_back({bound.tangential, bound.second});
          }
    }

    bool contains(const std::size_t entry) const
    {
      return in_disc[entry];
    }

    /// The directions of the forces, of all discs.
    const std::vector<Turn> &directions() const
    {
      return all;
    }

    void restore(std::vector<Turn> directions)
    {
      all = std::move(directions);
    }

    /// The turns of the nodes that slip, as they were last found.
    const std::vector<Turn> &turns() const
    {
      return slipping;
    }

    /// x := nearest point within the discs.
    void project(const Box<Vector> &box, Vector &x) const
    {
      for (const Turn &disc : all)
        put_within(radius_of(disc, box), x.begin()[disc.first], x.begin()[disc.second]);
    }

    /// Adds the squares of the weighted |gP| and of the distance of x from its disc, or from the circle of a slipping
    /// node. What |gP| of entries at bounds may count is |F| times the diameter of the disc.
    void add_residuals(const Vector          &x,
                       const Vector          &g,
                       const Sides           &sides,
                       const Box<Vector>     &box,
                       const double           norm_of_F,
                       std::array<double, 2> &sum) const
    {
      for (const Turn &disc : all)
        {
          const double radius          = radius_of(disc, box);
          const auto [free, held, out] = residuals_on(disc, radius, x, g, sides);
          sum[0] += std::pow(weight(disc.first) * free, 2) +
                    std::pow(std::min(weight(disc.first) * held, norm_of_F * 2 * radius), 2);
          sum[1] += out * out;
        }
    }

    /// Projects the forces that have moved, and sets directions, sides and bounds to those of the projection.
    /// @param radius_at (bound) radius at the projected normal force
    template <typename RadiusAt>
    void place(const RadiusAt            &radius_at,
               const std::vector<double> &moved,
               std::vector<double>       &projected,
               Sides                     &sides,
               Box<Vector>               &box)
    {
      for (std::size_t k = 0; k < all.size(); ++k)
        {
          Turn        &disc   = all[k];
          const double radius = radius_at(bounds[k]);
          double &x1 = projected[disc.first] = moved[disc.first], &x2 = projected[disc.second] = moved[disc.second];
          const double size = std::hypot(x1, x2);
          if (size > 0)
            {
              disc.cosine = x1 / size;
              disc.sine   = x2 / size;
            }
          sides[disc.first]  = size >= radius ? 1 : 0;
          sides[disc.second] = radius > 0 ? 0 : 1;
          set_radius(bounds[k], radius, sides, box);
          put_within(radius, x1, x2);
        }
    }

    /// Distances beyond bounds of single entries := those beyond the circle; of x_s, if it is held.
    void merge_excess(const Box<Vector> &box, std::vector<double> &beyond) const
    {
      for (const Turn &disc : all)
        {
          const double excess = std::hypot(beyond[disc.first], beyond[disc.second]);
          beyond[disc.first]  = excess;
          beyond[disc.second] = radius_of(disc, box) > 0 ? 0. : excess;
        }
    }

    /// Determines the turns of the slipping nodes of a new set; g is the gradient with which it was predicted. A force
    /// that turns by more than 90 degrees becomes free first.
    /// @param sides_before, directions_before of the previous set
    void find_turns(const Sides             &sides_before,
                    const std::vector<Turn> &directions_before,
                    const Vector            &g,
                    Sides                   &sides,
                    Box<Vector>             &box)
    {
      slipping.clear();
      for (std::size_t k = 0; k < all.size(); ++k)
        {
          Turn        &disc   = all[k];
          const double radius = radius_of(disc, box);
          if (sides[disc.first] == 0 || !(radius > 0))
            continue;
          if (sides_before[disc.first] != 0 && sides_before[disc.second] == 0 &&
              disc.cosine * directions_before[k].cosine + disc.sine * directions_before[k].sine < 0)
            {
              sides[disc.first] = 0;
              continue;
            }
          disc.compliance =
            std::max(0., -(disc.cosine * g.begin()[disc.first] + disc.sine * g.begin()[disc.second])) / radius;
          if (disc.compliance * weight(disc.second) > rigid_compliance)
            sides[disc.second] = 1; // at 0
          slipping.push_back(disc);
          if (sides[disc.second] != 0)
            slipping.back().compliance = 0; // without effect on a held entry, except for its rounding errors
          set_radius(bounds[k], radius, sides, box);
        }
    }

    /// Drops the turns of nodes that stick after entries were freed.
    void drop_sticking(const Sides &sides)
    {
      slipping.erase(std::remove_if(slipping.begin(),
                                    slipping.end(),
                                    [&sides](const Turn &of) { return sides[of.first] == 0 && sides[of.second] == 0; }),
                     slipping.end());
    }

  private:
    double weight(const std::size_t i) const
    {
      return weights ? weights[i] : 1.;
    }

    static double radius_of(const Turn &disc, const Box<Vector> &box)
    {
      return box.upper.begin()[disc.first];
    }

    static void put_within(const double radius, double &x1, double &x2)
    {
      const double size = std::hypot(x1, x2);
      if (size <= radius)
        return;
      x1 *= radius / size;
      x2 *= radius / size;
    }

    // |gP| of free entries and of those at bounds, and the distance of x from where it should be.
    std::array<double, 3> residuals_on(const Turn   &disc,
                                       const double  radius,
                                       const Vector &x,
                                       const Vector &g,
                                       const Sides  &sides) const
    {
      const double x1 = x.begin()[disc.first], x2 = x.begin()[disc.second], g1 = g.begin()[disc.first],
                   g2 = g.begin()[disc.second], size = std::hypot(x1, x2);
      if (sides[disc.first] == 0 && sides[disc.second] == 0)
        return {{std::hypot(g1, g2), 0., std::max(0., size - radius)}};
      if (sides[disc.first] == 0) // was freed to hold a body
        return {{std::abs(g1), std::abs(g2), std::max(0., size - radius)}};
      if (!(radius > 0))
        return {{0., 0., size}};
      const double c = size > 0 ? x1 / size : disc.cosine, s = size > 0 ? x2 / size : disc.sine;
      const double across = (c * g2 - s * g1) * disc.softness(weight(disc.second));
      return {{0., std::hypot(std::max(0., c * g1 + s * g2), across), size - radius}};
    }

    const double *const        weights; // null: all 1
    std::vector<bool>          in_disc;
    std::vector<PressureBound> bounds;
    std::vector<Turn>          all;      // in the order of the bounds
    std::vector<Turn>          slipping; // those that slip
  };
} // namespace slipstick::qp::detail
