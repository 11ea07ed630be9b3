// The Hessian of the augmented Lagrangian.
#pragma once

#include <slipstick/qp/kernels.h>

namespace slipstick::qp
{
  namespace detail
  {
    /// A = P F P + rho Q. As a Tracker it updates Q x in the steps of MPGP, which saves one projection each.
    template <typename Vector, typename Problem>
    class AugmentedOperator
    {
    public:
      AugmentedOperator(const Problem &problem_, const double rho_, const Vector &layout)
        : problem(problem_)
        , rho(rho_)
        , Qx(zero_like(layout))
        , Qv(Qx)
        , w(Qx)
      {}

      void operator()(const Vector &v, Vector &Av)
      {
        problem.project_range(v, Qv);
        std::copy(v.begin(), v.end(), w.begin());
        add(-1.0, Qv, w);
        problem.multiply(w, Av);
        problem.project_range(Av, w);
        const auto        a = Av.begin();
        const auto        q = Qv.begin(), wi = w.begin();
        const std::size_t n = local_size(v);
        for (std::size_t i = 0; i < n; ++i)
          a[i] += rho * q[i] - wi[i];
      }

      void stepped(const double a)
      {
        add(-a, Qv, Qx);
      }
      void moved_towards(const double fraction)
      {
        combine(fraction, Qv, 1 - fraction, Qx);
      }

      void set_penalty(const double penalty)
      {
        rho = penalty;
      }

      /// Q x as updated by the steps.
      const Vector &range_part() const
      {
        return Qx;
      }

      /// Recomputes Q x.
      const Vector &range_part(const Vector &x)
      {
        problem.project_range(x, Qx);
        return Qx;
      }

    private:
      const Problem &problem;
      double         rho;
      Vector         Qx, Qv, w;
    };
  } // namespace detail
} // namespace slipstick::qp
