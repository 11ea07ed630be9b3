// The iterate of MPGP: point, gradient, direction, and operations on them. The algorithm: mpgp.h.
#pragma once

#include <slipstick/qp/disc_box.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/types.h>

#include <optional>
#include <utility>

namespace slipstick::qp
{
  /// Start of MPGP. The gradient A x - b, if known, saves a multiplication; it is used only if x is in the set.
  template <typename Vector>
  struct MpgpStart
  {
    Vector                x;
    std::optional<Vector> gradient = std::nullopt;
  };

  /// Callbacks for the steps of MPGP, to update a linear function of x; this class does nothing. v is the vector last
  /// multiplied by A.
  struct NoTracker
  {
    void stepped(double) {}       // x := x - a v
    void moved_towards(double) {} // x := x + a (v - x)
  };

  namespace detail
  {
    /// Set: Box or DiscBox.
    template <typename Vector, typename Set, typename Operator, typename Reduction, typename Tracker>
    class MpgpIterate
    {
    public:
      /// p'g, p'Ap, p'p
      struct Curvature
      {
        double pg, pAp, pp;
      };

      /// Effect of a step to `trial`: its length and the change of the objective; the fraction of the step, in [0, 1],
      /// that minimises the objective, and the change there.
      struct Trial
      {
        double distance, change, best_fraction, best_change;
      };

      /// Squares of |phi|, |beta|, |x|; phi~'phi.
      struct Sums
      {
        double free = 0, chopped = 0, reduced = 0, x = 0;
      };

      MpgpIterate(Operator          &A_,
                  const double       norm_A_,
                  const Vector      &b_,
                  const Set         &set_,
                  MpgpStart<Vector>  start,
                  const MpgpOptions &options_,
                  const Reduction   &reduction_,
                  Tracker           &tracker_)
        : A(A_)
        , b(b_)
        , set(set_)
        , options(options_)
        , reduction(reduction_)
        , tracker(tracker_)
        , norm_A(norm_A_)
        , x(std::move(start.x))
        , gradient_is_known(start.gradient.has_value())
        , g(gradient_is_known ? std::move(*start.gradient) : b)
        , p(x)
        , Ap(x)
        , trial(x)
        , trial_g(x)
      {}

      double norm() const
      {
        return norm_A;
      }
      double gradient_norm() const
      {
        return std::sqrt(sums.free + sums.chopped);
      }
      double step_length() const
      {
        return options.step_length / norm_A;
      }
      double noise() const
      {
        return options.rounding * (norm_A * std::sqrt(sums.x) + norm_b);
      }
      /// Rounding of the change of the objective along arcs: distance of their points from the circle times the force
      /// normal to it.
      double noise_of_change() const
      {
        return is_curved(set) ? noise() * std::sqrt(sums.x) : 0.;
      }
      double longest_step() const
      {
        return qp::longest_step(set, x, p, reduction);
      }
      const Sums &split() const
      {
        return sums;
      }
      const Vector &point() const
      {
        return x;
      }
      Vector take_point()
      {
        return std::move(x);
      }
      Vector take_gradient()
      {
        return std::move(g);
      }
      unsigned int n_multiplications() const
      {
        return multiplications;
      }

      /// Projects x onto the set and computes the gradient. Returns false if some lower > upper, or a bound is not a
      /// number.
      bool prepare()
      {
        std::copy(x.begin(), x.end(), p.begin());
        project(set, x);
        const auto            bi = b.begin();
        const auto            xi = x.begin(), old = p.begin();
        const std::size_t     n = local_size(x);
        std::array<double, 4> s{{n_contradictions(set), 0, 0, 0}}; // contradictions, moved entries, |b|^2, |x|^2
        for (std::size_t i = 0; i < n; ++i)
          {
            s[1] += xi[i] != old[i];
            s[2] += bi[i] * bi[i];
            s[3] += xi[i] * xi[i];
          }
        s      = reduction.sum(s);
        norm_b = std::sqrt(s[2]);
        if (s[0] > 0)
          return false;
        if (!gradient_is_known || s[1] > 0)
          {
            set_zero(g); // A 0 = 0
            if (s[3] > 0)
              {
                multiply(x, g);
                tracker.moved_towards(1.0);
              }
            add(-1.0, b, g);
          }
        restart();
        return true;
      }

      /// Splits the gradient at x and restarts the conjugate gradients: p = phi.
      void restart()
      {
        const Sums s     = own_sums(x, g);
        const auto total = reduction.sum(std::array<double, 4>{{s.free, s.chopped, s.reduced, s.x}});
        sums             = {total[0], total[1], total[2], total[3]};
        set_direction<&GradientParts::free>();
      }

      /// p = a part of the gradient. The part is a template argument since g++ 14.2 at -O2 reads a member through a
      /// pointer known at run time before the temporary that contains it has been written (doc/decisions/0095).
      template <double GradientParts::*part>
      void set_direction()
      {
        const auto pi = p.begin();
        for_each_part(set, x, g, step_length(), [&](const std::size_t i, const GradientParts &parts) {
          pi[i] = parts.*part;
        });
      }

      /// Multiplies A p.
      Curvature curvature()
      {
        multiply(p, Ap);
        const auto s = reduction.sum(std::array<double, 3>{{local_dot(p, g), local_dot(p, Ap), local_dot(p, p)}});
        note_curvature(s[1], s[2]);
        return {s[0], s[1], s[2]};
      }

      /// x := x - a p and the next conjugate direction, unless the step leaves the set: then returns false and changes
      /// nothing. Ending on a bound counts as leaving, since p must vanish on the active entries.
      bool conjugate_step(const double a, const double pAp)
      {
        std::copy(x.begin(), x.end(), trial.begin());
        std::copy(g.begin(), g.end(), trial_g.begin());
        add(-a, p, trial);
        add(-a, Ap, trial_g);
        const auto Api    = Ap.begin();
        double     phi_Ap = 0;
        Sums       s;
        for_each_part(set, trial, trial_g, step_length(), [&](const std::size_t i, const GradientParts &parts) {
          phi_Ap += parts.free * Api[i];
          add_entry(s, trial.begin()[i], parts);
        });
        const double leaving = n_leaving(set, p, trial);
        const auto   total = reduction.sum(std::array<double, 6>{{leaving, phi_Ap, s.free, s.chopped, s.reduced, s.x}});
        if (total[0] > 0)
          return false;

        using std::swap;
        swap(x, trial);
        swap(g, trial_g);
        const auto pi = p.begin();
        for_each_part(set, x, g, step_length(), [&](const std::size_t i, const GradientParts &parts) {
          pi[i] = parts.free - total[1] / pAp * pi[i];
        });
        tracker.stepped(a);
        sums = {total[2], total[3], total[4], total[5]};
        return true;
      }

      /// x := x - a p with a at most the longest step; A p is known. Must be followed by restart() or a trial.
      void step(const double a)
      {
        step_within(set, a, p, x);
        add(-a, Ap, g);
        tracker.stepped(a);
      }

      /// trial = projection of x - a p: computes its gradient and the change of the objective.
      Trial evaluate_trial(const double a)
      {
        std::copy(x.begin(), x.end(), trial.begin());
        add(-a, p, trial);
        project(set, trial);
        multiply(trial, trial_g);
        add(-1., b, trial_g);
        const auto        xi = x.begin(), gi = g.begin(), yi = trial.begin(), gyi = trial_g.begin();
        const std::size_t n  = local_size(x);
        double            ss = 0, sAs = 0, sg = 0; // s = trial - x
        for (std::size_t i = 0; i < n; ++i)
          {
            const double s = yi[i] - xi[i];
            ss += s * s;
            sAs += s * (gyi[i] - gi[i]);
            sg += s * gi[i];
          }
        const Sums t     = own_sums(trial, trial_g);
        const auto total = reduction.sum(std::array<double, 7>{{ss, sAs, sg, t.free, t.chopped, t.reduced, t.x}});
        trial_sums       = {total[3], total[4], total[5], total[6]};
        note_curvature(total[1], total[0]);
        // change of the objective on the way: fraction sg + fraction^2 / 2 sAs
        const double best = total[1] > 0 ? clip(-total[2] / total[1], 0, 1) : total[2] < 0 ? 1.0 : 0.0;
        return {std::sqrt(total[0]), total[2] + 0.5 * total[1], best, best * (total[2] + 0.5 * best * total[1])};
      }

      /// x := trial, p = phi.
      void accept_trial()
      {
        using std::swap;
        swap(x, trial);
        swap(g, trial_g);
        tracker.moved_towards(1.0);
        sums = trial_sums;
        set_direction<&GradientParts::free>();
      }

      /// x := x + fraction (trial - x). Must be followed by restart().
      void move_towards_trial(const double fraction)
      {
        combine(fraction, trial, 1 - fraction, x);
        combine(fraction, trial_g, 1 - fraction, g);
        project(set, x);
        tracker.moved_towards(fraction);
      }

    private:
      void multiply(const Vector &v, Vector &Av)
      {
        A(v, Av);
        ++multiplications;
      }

      // Splits the gradient g_y at y.
      Sums own_sums(const Vector &y, const Vector &gy) const
      {
        Sums s;
        for_each_part(set, y, gy, step_length(), [&](const std::size_t i, const GradientParts &parts) {
          add_entry(s, y.begin()[i], parts);
        });
        return s;
      }

      static void add_entry(Sums &s, const double y, const GradientParts &parts)
      {
        s.free += parts.free * parts.free;
        s.chopped += parts.chopped * parts.chopped;
        s.reduced += parts.free * parts.reduced;
        s.x += y * y;
      }

      // Increases |A| if s'As shows that it is larger than assumed.
      void note_curvature(const double sAs, const double ss)
      {
        if (sAs - norm_A * ss > noise() * std::sqrt(ss))
          norm_A = options.norm_growth * sAs / ss;
      }

      Operator          &A;
      const Vector      &b;
      const Set         &set;
      const MpgpOptions &options;
      const Reduction   &reduction;
      Tracker           &tracker;

      double       norm_A, norm_b = 0;
      Vector       x;
      bool         gradient_is_known;
      Vector       g, p, Ap, trial, trial_g;
      Sums         sums, trial_sums;
      unsigned int multiplications = 0;
    };
  } // namespace detail
} // namespace slipstick::qp
