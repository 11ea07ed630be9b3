// The active set, bounds that follow the solution, and the residuals of the optimality conditions. How the sets are
// used: semismooth_newton.h.
#pragma once

#include <slipstick/qp/admissible_set.h>
#include <slipstick/qp/friction_discs.h>
#include <slipstick/qp/kernels.h>
#include <slipstick/qp/optional_members.h>
#include <slipstick/qp/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace slipstick::qp
{
  namespace detail
  {
    // An imbalance below this part of all forces moves no body: the face problem determines the rest more accurately
    // than points on springs do (doc/decisions/0091). ...
    constexpr double tolerated_imbalance = 0.1;
    // ... Once no step lowered the residual, the limit is this part or, if that is less, this part of the natural
    // residual, which the force of a single node beyond its bound may be (doc/decisions/0159).
    constexpr double fine_imbalance = 0.01;

    /// The natural map x -> proj(x - s g) of an admissible set, and the active set that it determines. s is `step` over
    /// the norm of F, times the weight of the entry, so that s g is about the force that closes g: s is the stiffness
    /// of a point. A force beyond its bound and the gap that it closes then contribute equally to the residual.
    /// Bodies that are held by contact alone move until s g balances their loads. How far they move depends on s, which
    /// should then be the stiffness of the points in contact: the norm of F on these entries grows with their number,
    /// and where bodies are soft as a whole (a ring of revolution, a beam) even a single point is stiffer than that
    /// (doc/decisions/0142). If s is too stiff, bodies rest on few points. Therefore s is halved where no step lowers
    /// the residual, but never below the value for all entries.
    template <typename Vector, typename Problem>
    class ActiveSet
    {
    public:
      /// @param problem is kept by reference. @param norm |PFP|. @param noise gradients below it are ignored.
      ActiveSet(const Problem        &problem_,
                const double          norm_,
                AdmissibleSet<Vector> set_,
                const double          step_,
                const double          noise_ = 0)
        : problem(problem_)
        , norm(norm_)
        , noise(noise_)
        , balances(bodies_predict_active_sets(problem_, 0))
        , of_point(point_stiffness(problem_, 0))
        , step(balances ? 1 : std::max(step_, of_point))
        , set(std::move(set_))
        , weights(residual_weights(problem_, 0))
        , active(local_size(set.box.lower))
        , discs(set.pressure_bounds, weights, active.size())
        , beyond(active.size(), 0.)
        , to_cone(active.size(), 1.)
        , is_open(active.size(), false)
      {
        for (std::size_t i = 0; i < active.size(); ++i)
          bounded.push_back(set.box.lower.begin()[i] > -HUGE_VAL || set.box.upper.begin()[i] < HUGE_VAL);
        for (const PressureBound &bound : set.pressure_bounds)
          {
            const double mu = bound.normal == no_entry ? 0. : bound.forces.coefficient;
            for (const std::size_t i : {bound.tangential, bound.is_disc() ? bound.second : bound.tangential})
              {
                bounded[i] = true;
                to_cone[i] = 1 / std::hypot(1., mu);
              }
          }
        const bool jumps = std::any_of(set.pressure_bounds.begin(), set.pressure_bounds.end(), jumps_at_zero);
        has_jumps        = problem.reduction().min(jumps ? -1. : 0.) < 0;
      }

      /// s times the norm of F, for an entry of weight 1.
      double step_length() const
      {
        return step;
      }

      const Sides &sides() const
      {
        return active;
      }

      std::vector<bool> free() const
      {
        std::vector<bool> result(active.size());
        for (std::size_t i = 0; i < result.size(); ++i)
          result[i] = active[i] == 0;
        return result;
      }

      const Box<Vector> &box() const
      {
        return set.box;
      }

      /// The turns of slipping nodes in space on faces of the set; comments on single entries apply to turned ones.
      const std::vector<Turn> &turns() const
      {
        return discs.turns();
      }

      /// x := nearest point within the bounds, as they were last set.
      void project_on_bounds(Vector &x) const
      {
        for (std::size_t i = 0; i < active.size(); ++i)
          if (!discs.contains(i))
            x.begin()[i] = clip(x.begin()[i], set.box.lower.begin()[i], set.box.upper.begin()[i]);
        discs.project(set.box, x);
      }

      /// Clears the free entries of g, the gradient at x, after a face was solved: the remainder says nothing about the
      /// set. The component that turns the force of a slipping node is kept.
      void clear_solved(const Vector &x, Vector &g) const
      {
        turn(turns(), g);
        for (std::size_t i = 0; i < active.size(); ++i)
          g.begin()[i] = active[i] == 0 ? 0. : g.begin()[i];
        for (const Turn &of : turns())
          if (active[of.second] == 0)
            g.begin()[of.second] = -of.compliance * (of.cosine * x.begin()[of.second] - of.sine * x.begin()[of.first]);
        turn_back(turns(), g);
      }

      /// From now on, bodies move until their loads are balanced to the fine limit. @return whether this is a change.
      bool balance_finely()
      {
        if (!balances || is_fine)
          return false;
        is_fine = true;
        return true;
      }

      /// Halves s if bodies are balanced with it. @return whether s has changed.
      bool soften()
      {
        if (!balances || step <= 1)
          return false;
        softening /= 2;
        adapt_step();
        return true;
      }

      /// Reduces the fine limit near the solution, where the imbalance may decide which of a few small forces reach
      /// their bounds.
      /// @param residual the natural residual over that of zero forces
      void approach(const double residual)
      {
        finest_imbalance = std::min(finest_imbalance, fine_imbalance * residual);
      }

      /// Sets the active set to that of x - s g. @return whether it has changed on any process.
      bool predict(const Vector &x, const Vector &g)
      {
        const Sides             before            = active;
        const std::vector<Turn> directions_before = discs.directions();
        map(x, g, [this](const std::size_t i, const double, const double projected, const double moved) {
          beyond[i] = std::abs(moved - projected) * norm / (step * weight(i));
        });
        for (std::size_t i = 0; i < active.size(); ++i)
          if (active[i] * before[i] < 0 && set.box.lower.begin()[i] < set.box.upper.begin()[i])
            active[i] = 0; // an entry reaches the opposite bound only after being free: s g is cut to the width
        discs.merge_excess(set.box, beyond);
        discs.find_turns(before, directions_before, g, active, set.box);
        if (balances)
          adapt_step();
        return problem.reduction().min(active == before ? 1. : 0.) < 1;
      }

      /// Weighted norm of (x - proj(x - s g)) / s for entries with bounds and of g for the others, like residuals of
      /// faces. Of tangential entries the distance from the friction cone counts, not that from the bound at the present
      /// normal force, which a change smaller by the coefficient would move there (doc/decisions/0163).
      double natural_residual(const Vector &x, const Vector &g)
      {
        const Sides             before            = active;
        const std::vector<Turn> directions_before = discs.directions();
        const std::vector<bool> open_before       = is_open;
        double                  sum               = 0;
        for (std::size_t i = 0; i < active.size(); ++i)
          if (!bounded[i])
            {
              const double r = weight(i) * g.begin()[i];
              sum += r * r;
            }
        map(x, g, [&](const std::size_t i, const double xi, const double projected, const double) {
          const double r = to_cone[i] * norm * (xi - projected) / step;
          sum += r * r;
        });
        active  = before;
        is_open = open_before;
        discs.restore(directions_before);
        return std::sqrt(problem.reduction().sum(std::array<double, 1>{{sum}})[0]);
      }

      /// |gP| (weighted; at bounds at most |PFP| times the width, since no other force in between differs by more), and
      /// |PFP| times the distance of x from its bounds, or from the bound at which it is held:
      /// this limits the increase of |gP| when x is moved there.
      std::array<double, 2> residuals(const Vector &x, const Vector &g)
      {
        move_bounds(x);
        if (has_jumps)
          open_unpressed(x);
        std::array<double, 2> sum{{0, 0}};
        for (std::size_t i = 0; i < active.size(); ++i)
          {
            if (discs.contains(i))
              continue;
            const double l = set.box.lower.begin()[i], u = set.box.upper.begin()[i], xi = x.begin()[i],
                         gi = g.begin()[i];
            const double gp = active[i] == 0 ? gi : !(l < u) ? 0. : active[i] < 0 ? std::min(gi, 0.) : std::max(gi, 0.);
            const double out = xi - (active[i] < 0 ? l : active[i] > 0 ? u : clip(xi, l, u));
            const double r   = active[i] == 0 ? weight(i) * gp : std::min(weight(i) * std::abs(gp), norm * (u - l));
            sum[0] += r * r;
            sum[1] += out * out; // without weight: F out decreases as the weight increases
          }
        discs.add_residuals(x, g, active, set.box, norm, sum);
        if (has_jumps)
          sum[0] += squared_residual_of_pressed(x, g);
        sum = problem.reduction().sum(sum);
        return {{std::sqrt(sum[0]), norm * std::sqrt(sum[1])}};
      }

      /// Numbers of entries at their lower and upper bounds, over all processes.
      std::array<double, 2> count() const
      {
        std::array<double, 2> n{{0, 0}};
        for (std::size_t i = 0; i < active.size(); ++i)
          {
            n[0] += active[i] < 0;
            n[1] += active[i] > 0;
          }
        return problem.reduction().sum(n);
      }

      /// Slipping entries whose bound follows a free entry.
      std::vector<Tie> ties() const
      {
        std::vector<Tie> result;
        for (const PressureBound &bound : set.pressure_bounds)
          if (const double slope = bound.forces.slope(set.box.upper.begin()[bound.tangential]);
              active[bound.tangential] != 0 && bound.normal != no_entry && active[bound.normal] == 0 &&
              !is_open[bound.tangential] && slope > 0)
            result.push_back({bound.tangential, bound.normal, active[bound.tangential] * slope});
        return result;
      }

      /// Whether there are sets with ties. Collective.
      bool may_have_ties() const
      {
        const bool may = std::any_of(set.pressure_bounds.begin(),
                                     set.pressure_bounds.end(),
                                     [](const PressureBound &bound) { return bound.normal != no_entry; });
        return problem.reduction().min(may ? -1. : 0.) < 0;
      }

      /// The values that must vanish for a step p on the present face: entries at bounds and violations of ties.
      std::vector<double> conditions(const Vector &p, const std::vector<Tie> &ties) const
      {
        std::vector<double> result;
        if (ties.empty() && turns().empty())
          {
            for (std::size_t i = 0; i < active.size(); ++i)
              if (active[i] != 0)
                result.push_back(p.begin()[i]);
            return result;
          }
        std::vector<double> value(p.begin(), p.end());
        turn(turns(), value);
        for (const Tie &tie : ties)
          value[tie.tied] -= tie.factor * value[tie.to];
        for (std::size_t i = 0; i < active.size(); ++i)
          if (active[i] != 0)
            result.push_back(value[i]);
        return result;
      }

      /// Distances of the entries at bounds beyond these bounds in the last prediction, in units of g.
      const std::vector<double> &gaps() const
      {
        return beyond;
      }

      /// Frees the entries for which @p free is true.
      void release(const std::vector<bool> &free)
      {
        for (std::size_t i = 0; i < active.size(); ++i)
          if (free[i])
            active[i] = 0;
        discs.drop_sticking(active);
      }

      /// Moves x to the bounds of the set, which follow x.
      void put_on_bounds(Vector &x)
      {
        move_bounds(x);
        turn(turns(), x);
        for (std::size_t i = 0; i < active.size(); ++i)
          if (active[i] != 0)
            x.begin()[i] = active[i] < 0 ? set.box.lower.begin()[i] : set.box.upper.begin()[i];
        turn_back(turns(), x);
      }

    private:
      double weight(const std::size_t i) const
      {
        return weights ? weights[i] : 1.;
      }

      // Sets s from the ratio of all one-sided entries, those of contact, to those that are off their bounds.
      void adapt_step()
      {
        std::array<double, 2> n{{0, 0}}; // all; those off their bounds
        for (std::size_t i = 0; i < active.size(); ++i)
          if (set.box.lower.begin()[i] > -HUGE_VAL && set.box.upper.begin()[i] == HUGE_VAL)
            {
              n[0] += 1;
              n[1] += active[i] == 0;
            }
        n = problem.reduction().sum(n);
        if (n[1] > 0)
          step = std::max(1., softening * std::max(n[0] / n[1], of_point));
      }

      // Whether the bound jumps to 0 where the normal entry vanishes.
      static bool jumps_at_zero(const PressureBound &bound)
      {
        return bound.normal != no_entry && bound.forces.closed_radius(0) > 0;
      }

      // Largest normal force that is only rounding.
      double least_force(const Vector &x) const
      {
        double largest = 0;
        for (const double value : x)
          largest = std::max(largest, std::abs(value));
        return -force_rounding * problem.reduction().min(-largest);
      }

      // Updates the bounds that follow normal entries to those at x: 0 if the normal entry is at its bound, or if it was
      // released there and the bound jumps to 0; otherwise without that jump.
      void move_bounds(const Vector &x)
      {
        for (const PressureBound &bound : set.pressure_bounds)
          set_radius(bound,
                     bound.normal == no_entry ? bound.forces.closed_radius(0)
                     : active[bound.normal] == 0 && !is_open[bound.tangential]
                       ? bound.forces.closed_radius(x.begin()[bound.normal])
                       : 0.,
                     active,
                     set.box);
      }

      // The jump of bounds to 0 where no normal force is left at x.
      void open_unpressed(const Vector &x)
      {
        const double least = least_force(x);
        for (const PressureBound &bound : set.pressure_bounds)
          if (jumps_at_zero(bound) && !(x.begin()[bound.normal] > least))
            set_radius(bound, 0, active, set.box);
      }

      // Square of the residual of nodes that were predicted open and whose bounds jumped to 0, but that are pressed at
      // x: the normal entry was freed to hold a body. Their tangential forces are 0, so that they should stick.
      double squared_residual_of_pressed(const Vector &x, const Vector &g) const
      {
        const double least = least_force(x);
        double       sum   = 0;
        for (const PressureBound &bound : set.pressure_bounds)
          if (is_open[bound.tangential] && x.begin()[bound.normal] > least)
            {
              const double slip =
                             std::hypot(g.begin()[bound.tangential], bound.is_disc() ? g.begin()[bound.second] : 0.),
                           most = norm * 2 * bound.forces.closed_radius(x.begin()[bound.normal]);
              sum += std::pow(std::min(weight(bound.tangential) * slip, most), 2);
            }
        return sum;
      }

      // moved -= stiffness times the jumps of the body motions for which the projected forces balance the loads. An
      // entry at its bound that the gradient moves inwards counts with at most the value of the bound: its force is
      // determined by the face problem, and it must not push a body off the other entries that carry its loads. For the
      // same reason, motions close one-sided entries but open none, unless a fine balance is requested.
      void move_bodies(const Vector &x, const std::vector<double> &stiffness, std::vector<double> &moved) const
      {
        std::vector<double> forces(moved);
        for (std::size_t i = 0; i < forces.size(); ++i)
          if (bounded[i] && !discs.contains(i))
            {
              if (const double l = set.box.lower.begin()[i]; x.begin()[i] <= l)
                forces[i] = std::min(forces[i], l);
              if (const double u = set.box.upper.begin()[i]; x.begin()[i] >= u)
                forces[i] = std::max(forces[i], u);
            }
        const std::vector<double> before(forces);
        balance_bodies(problem, stiffness, set, is_fine ? finest_imbalance : tolerated_imbalance, forces, 0);
        for (std::size_t i = 0; i < moved.size(); ++i)
          {
            const double change = forces[i] - before[i];
            const bool   bears  = moved[i] > set.box.lower.begin()[i] && set.box.upper.begin()[i] == HUGE_VAL;
            if (is_fine || !bears || change > 0)
              moved[i] += change;
          }
      }

      // Determines the set and calls action(i, x_i, proj(x - s g)_i, (x - s g)_i) for all entries with bounds. Normal
      // entries come first, since bounds of others follow the projected ones.
      template <typename Action>
      void map(const Vector &x, const Vector &g, const Action &action)
      {
        std::vector<double> projected(active.size()), moved(active.size()), stiffness(active.size());
        for (std::size_t i = 0; i < active.size(); ++i)
          {
            stiffness[i] = step / norm * weight(i);
            moved[i]     = x.begin()[i] - (std::abs(g.begin()[i]) > noise ? stiffness[i] * g.begin()[i] : 0.);
          }
        if (balances)
          move_bodies(x, stiffness, moved);
        const auto place = [&](const std::size_t i) {
          const double l = set.box.lower.begin()[i], u = set.box.upper.begin()[i];
          active[i]    = moved[i] <= l ? -1 : moved[i] >= u ? 1 : 0;
          projected[i] = clip(moved[i], l, u);
        };
        for (std::size_t i = 0; i < active.size(); ++i)
          if (bounded[i] && !discs.contains(i))
            place(i);
        const double least = has_jumps ? least_force(x) : 0.;
        for (const PressureBound &bound : set.pressure_bounds)
          is_open[bound.tangential] = jumps_at_zero(bound) && !(projected[bound.normal] > least);
        const auto radius_at = [&](const PressureBound &bound) {
          return bound.normal == no_entry    ? bound.forces.closed_radius(0)
                 : is_open[bound.tangential] ? 0.
                                             : bound.forces.radius(projected[bound.normal]);
        };
        for (const PressureBound &bound : set.pressure_bounds)
          if (!bound.is_disc())
            {
              set_radius(bound, radius_at(bound), active, set.box);
              place(bound.tangential);
            }
        discs.place(radius_at, moved, projected, active, set.box);
        for (std::size_t i = 0; i < active.size(); ++i)
          if (bounded[i])
            action(i, x.begin()[i], projected[i], moved[i]);
      }

      const Problem        &problem;
      const double          norm, noise;
      const bool            balances;
      const double          of_point; // |F| times the stiffness of a single point of weight 1; 0: unknown
      double                step;
      double                softening        = 1;              // factor on s, <= 1
      double                finest_imbalance = fine_imbalance; // fine limit of imbalances that move no body, ...
      bool                  is_fine          = false;          // ... used once no step lowered the residual
      AdmissibleSet<Vector> set;
      const double         *weights;
      std::vector<bool>     bounded;
      Sides                 active;
      FrictionDiscs<Vector> discs;
      std::vector<double>   beyond;
      bool                  has_jumps = false; // on any process
      std::vector<double>   to_cone;           // distance of an entry from the friction cone over that from its bound
      std::vector<bool>     is_open;           // tangential entries whose bound jumped to 0 in the last prediction
    };
  } // namespace detail
} // namespace slipstick::qp
