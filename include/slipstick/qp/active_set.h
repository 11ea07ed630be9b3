// The active set of semismooth Newton: which entries are at their bounds, and with bounds that follow the solution, where
// these are. How the sets are used: semismooth_newton.h.
#pragma once

#include <slipstick/qp/box.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/pcpg.h>
#include <slipstick/qp/pressure_bounds.h>

#include <cmath>
#include <optional>
#include <vector>

namespace slipstick::qp
{
  /// Bounds that the method differentiates itself; all processes together have some or none of them.
  struct CoupledBounds
  {
    std::vector<PressureBound> bounds; // of owned entries
    bool                       are_coupled = false;
  };

  namespace detail
  {
    // Entries as far beyond their bounds as the farthest, up to rounding, change with it.
    constexpr double same_distance = 1 - 1e-9;
    // The distance beyond which so many entries change is bisected so often, after steps by this factor.
    constexpr unsigned int bisections      = 20;
    constexpr double       first_reduction = 0.1;

    /// Of every owned entry: -1 at the lower bound, 1 at the upper, 0 free.
    using Sides = std::vector<signed char>;

    template <typename Vector, typename Problem>
    class ActiveSet
    {
    public:
      /// All are referred to.
      ActiveSet(const Problem       &problem_,
                const double         norm_,
                const Box<Vector>   &box_,
                const NewtonOptions &options_,
                const CoupledBounds &coupled_)
        : problem(problem_)
        , norm(norm_)
        , given_box(box_)
        , options(options_)
        , coupled(coupled_)
        , moving_box(coupled_.are_coupled ? std::make_optional(box_) : std::nullopt)
      {}

      const Sides &sides() const
      {
        return active;
      }

      void become(Sides next)
      {
        active = std::move(next);
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
        return moving_box ? *moving_box : given_box;
      }

      // -1 at the lower bound, 1 at the upper, 0 free: of x - g / |PFP|. Entries with l = u are never free.
      Sides next(const Vector &x, const Vector &g)
      {
        Sides         set(local_size(x));
        const auto    xi = x.begin(), gi = g.begin();
        const double *weights = residual_weights(problem, 0);
        const auto    place   = [&](const std::size_t i) {
          const double t = xi[i] - options.set_step * (weights ? weights[i] : 1.) * gi[i] / norm;
          set[i]         = t <= box().lower.begin()[i] ? -1 : t >= box().upper.begin()[i] ? 1 : 0;
        };
        for (std::size_t i = 0; i < set.size(); ++i)
          place(i);
        move_bounds(x, g, set, options.set_step / norm);
        for (const PressureBound &bound : coupled.bounds)
          place(bound.tangential);
        return set;
      }

      // Of the changes to the next set those farthest beyond their bounds, at most `most` (and what rounding takes for as far
      // as the farthest). Sets that change as a whole may cycle; one by one they do not for a given face's strictly convex
      // problem but for ties (Murty 1988; Judice, Pires 1994), and the cycles seen end.
      void keep_largest_changes(const Vector &x, const Vector &g, const double most, Sides &next) const
      {
        const auto          l = box().lower.begin(), u = box().upper.begin();
        const auto          xi = x.begin(), gi = g.begin();
        const double       *weights = residual_weights(problem, 0);
        std::vector<double> beyond(next.size(), 0.);
        double              largest = 0;
        for (std::size_t i = 0; i < next.size(); ++i)
          if (next[i] != active[i])
            {
              const double t     = xi[i] - options.set_step * (weights ? weights[i] : 1.) * gi[i] / norm;
              const double bound = (active[i] == 0 ? next[i] : active[i]) < 0 ? l[i] : u[i];
              beyond[i]          = std::abs(t - bound);
              largest            = std::max(largest, beyond[i]);
            }
        largest             = -problem.reduction().min(-largest);
        const auto n_beyond = [&](const double distance) {
          double n = 0;
          for (std::size_t i = 0; i < next.size(); ++i)
            n += next[i] != active[i] && beyond[i] >= distance;
          return problem.reduction().sum(std::array<double, 1>{{n}})[0];
        };
        double below = 0, least = same_distance * largest; // bisected in the logarithm, to within some changes
        if (most > 1)
          for (unsigned int k = 0; k < bisections && n_beyond(least) < most; ++k)
            {
              const double middle = below > 0 ? std::sqrt(below * least) : first_reduction * least;
              if (n_beyond(middle) <= most)
                least = middle;
              else
                below = middle;
            }
        for (std::size_t i = 0; i < next.size(); ++i)
          if (beyond[i] < least)
            next[i] = active[i];
      }

      bool same_free(const Sides &next) const
      {
        bool same = true;
        for (std::size_t i = 0; i < next.size(); ++i)
          same = same && (next[i] == 0) == (active[i] == 0);
        return problem.reduction().min(same ? 1. : 0.) > 0;
      }

      // How many entries change; counts the present set besides.
      double count_changes(const Sides &next)
      {
        const auto            l = box().lower.begin(), u = box().upper.begin();
        std::array<double, 4> s{{0, 0, 0, 0}};
        for (std::size_t i = 0; i < next.size(); ++i)
          {
            s[0] += next[i] != active[i] && l[i] < u[i];
            s[1] += l[i] > -HUGE_VAL || u[i] < HUGE_VAL;
            s[2] += active[i] < 0;
            s[3] += active[i] > 0;
          }
        s            = problem.reduction().sum(s);
        inequalities = s[1];
        lower        = s[2];
        upper        = s[3];
        return s[0];
      }

      // Over all processes, when changes were counted last.
      double n_inequalities() const
      {
        return inequalities;
      }
      double n_lower() const
      {
        return lower;
      }
      double n_upper() const
      {
        return upper;
      }

      // Slipping entries whose bound moves with a free one.
      std::vector<Tie> ties() const
      {
        std::vector<Tie> result;
        for (const PressureBound &bound : coupled.bounds)
          if (active[bound.tangential] != 0 && active[bound.normal] == 0 && bound.coefficient > 0)
            result.push_back({bound.tangential, bound.normal, active[bound.tangential] * bound.coefficient});
        return result;
      }

      bool all_stick() const
      {
        return problem.reduction().min(ties().empty() ? 1. : 0.) > 0;
      }

      void free_two_sided()
      {
        const auto l = box().lower.begin(), u = box().upper.begin();
        for (std::size_t i = 0; i < active.size(); ++i)
          if (l[i] < u[i] && l[i] > -HUGE_VAL && u[i] < HUGE_VAL)
            active[i] = 0;
      }

      // Also in the coupled law: nothing is tied while all entries are free.
      void free_all()
      {
        const auto l = box().lower.begin(), u = box().upper.begin();
        for (std::size_t i = 0; i < active.size(); ++i)
          if (l[i] < u[i])
            active[i] = 0;
      }

      void put_on_bounds(Vector &x)
      {
        move_bounds(x);
        const auto l = box().lower.begin(), u = box().upper.begin();
        const auto xi = x.begin();
        for (std::size_t i = 0; i < active.size(); ++i)
          if (active[i] < 0)
            xi[i] = l[i];
          else if (active[i] > 0)
            xi[i] = u[i];
      }

      // Bounds that follow the normal entries, to those of x.
      void move_bounds(const Vector &x)
      {
        move_bounds(x, x, active, 0.);
      }

    private:
      // Bounds that follow the normal entries: of x, or of the point from which the next set is read; 0 where the set is
      // open.
      void move_bounds(const Vector &x, const Vector &g, const Sides &set, const double gradient_part)
      {
        const auto xi = x.begin(), gi = g.begin();
        for (const PressureBound &bound : coupled.bounds)
          {
            const double pressure = std::max(xi[bound.normal] - gradient_part * gi[bound.normal], 0.);
            const double radius   = set[bound.normal] == 0 ? bound.fixed + bound.coefficient * pressure : 0.;
            moving_box->lower.begin()[bound.tangential] = -radius;
            moving_box->upper.begin()[bound.tangential] = radius;
          }
      }

      const Problem             &problem;
      const double               norm;
      const Box<Vector>         &given_box;
      const NewtonOptions       &options;
      const CoupledBounds       &coupled;
      std::optional<Box<Vector>> moving_box; // with coupled bounds
      Sides                      active;
      double                     inequalities = 0, lower = 0, upper = 0;
    };
  } // namespace detail
} // namespace slipstick::qp
