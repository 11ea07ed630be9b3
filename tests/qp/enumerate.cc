// The brute-force oracle: every entry free, at its lower or at its upper bound.
#include "support.h"

namespace slipstick::qp::test
{
  namespace
  {
    enum State
    {
      free,
      lower,
      upper
    };

    // Stationary point of the free entries under G x = e, the others held: (x, mu).
    std::optional<Vector> stationary_point(const Matrix             &F,
                                           const Vector             &b,
                                           const Matrix             &G,
                                           const Vector             &e,
                                           const Box<Vector>        &box,
                                           const std::vector<State> &state)
    {
      const std::size_t n = F.n, m = G.m;
      Matrix            K(n + m, n + m);
      Vector            rhs(n + m);
      for (std::size_t i = 0; i < n; ++i)
        if (state[i] == free)
          {
            for (std::size_t j = 0; j < n; ++j)
              K(i, j) = F(i, j);
            for (std::size_t k = 0; k < m; ++k)
              K(i, n + k) = G(k, i);
            rhs[i] = b[i];
          }
        else
          {
            K(i, i) = 1;
            rhs[i]  = state[i] == lower ? box.lower[i] : box.upper[i];
            if (!std::isfinite(rhs[i]))
              return {};
          }
      for (std::size_t k = 0; k < m; ++k)
        {
          for (std::size_t j = 0; j < n; ++j)
            K(n + k, j) = G(k, j);
          rhs[n + k] = e[k];
        }
      return solve(K, rhs);
    }

    bool is_optimal(const Matrix             &F,
                    const Vector             &b,
                    const Matrix             &G,
                    const Box<Vector>        &box,
                    const std::vector<State> &state,
                    const Vector             &x_mu,
                    const double              tolerance)
    {
      const std::size_t n = F.n;
      for (std::size_t i = 0; i < n; ++i)
        {
          double g = -b[i];
          for (std::size_t j = 0; j < n; ++j)
            g += F(i, j) * x_mu[j];
          for (std::size_t k = 0; k < G.m; ++k)
            g += G(k, i) * x_mu[n + k];
          const bool is_inside = box.lower[i] - tolerance <= x_mu[i] && x_mu[i] <= box.upper[i] + tolerance;
          const bool fits      = state[i] == free ? is_inside : state[i] == lower ? g >= -tolerance : g <= tolerance;
          if (!fits)
            return false;
        }
      return true;
    }
  } // namespace

  std::optional<Vector> enumerate(const Matrix      &F,
                                  const Vector      &b,
                                  const Matrix      &G,
                                  const Vector      &e,
                                  const Box<Vector> &box,
                                  const double       tolerance)
  {
    const std::size_t n = F.n;
    for (std::vector<State> state(n, free);;)
      {
        if (const auto x_mu = stationary_point(F, b, G, e, box, state))
          if (is_optimal(F, b, G, box, state, *x_mu, tolerance))
            return Vector(x_mu->begin(), x_mu->begin() + static_cast<std::ptrdiff_t>(n));
        std::size_t i = 0;
        while (i < n && state[i] == upper)
          state[i++] = free;
        if (i == n)
          return {};
        state[i] = state[i] == free ? lower : upper;
      }
  }
} // namespace slipstick::qp::test
