// Semismooth Newton and SMALBE-M on the present iterate of a contact problem.
#pragma once

#include <slipstick/contact/contact_iterate.h>
#include <slipstick/qp/smalbe.h>

#include <optional>

namespace slipstick::contact
{
  /// Number of multiplications by F after which Newton's method with its fallback gives up.
  constexpr unsigned int longest_fallback = 5000;

  /// Every algorithm sets status, counts and residuals of the iterate. All functions are collective.
  class ContactAlgorithms : protected ContactIterate
  {
  public:
    using ContactIterate::ContactIterate;

  protected:
    /// State that SMALBE-M reached earlier with the same bounds and the same point that balances the loads.
    using Reached = std::optional<qp::SmalbeStart<Vector>>;

    /// Semismooth Newton method. @return convergence.
    /// @param bounds_follow whether the bounds follow the solution; otherwise they are fixed (a Tresca problem).
    /// @param is_rough whether the start is far from the solution. @param most_steps maximum number; 0: default.
    bool newton(const Vector      &from,
                const bool         bounds_follow,
                const bool         is_rough   = false,
                const unsigned int most_steps = 0);

    /// Newton's method from the present iterate, which is restored if the method does not converge. @return
    /// convergence.
    bool try_newton();

    /// SMALBE-M (with discs SMALSE-M) from a point that balances the loads within the present bounds, or from the state
    /// @p reached earlier; sets status and residuals.
    Vector smalbe(const Vector       &from,
                  const double        tolerance,
                  const qp::Observer &progress,
                  const bool          may_end_early = false,
                  Reached            *reached       = nullptr);

    /// A few steps of SMALBE-M, from which Newton's method predicts its first set. In space the discs are replaced by
    /// the squares around them, which serve this purpose as well.
    Vector start_by_smalbe(const Vector &feasible);

  private:
    template <typename Set>
    Vector smalbe_on(const Set          &set,
                     const Vector       &from,
                     const double        tolerance,
                     const qp::Observer &progress,
                     const bool          may_end_early,
                     Reached            *reached,
                     const unsigned int  most_multiplications);
  };
} // namespace slipstick::contact
