// Semismooth Newton and SMALBE-M on the present iterate of a contact problem.
#pragma once

#include <slipstick/contact/contact_iterate.h>
#include <slipstick/qp/smalbe.h>

#include <optional>

namespace slipstick::contact
{
  /// Multiplications after which Newton's method and its fallback give up.
  constexpr unsigned int longest_fallback = 5000;

  /// Each fills status, counts and residuals of the iterate. All functions are collective.
  class ContactAlgorithms : protected ContactIterate
  {
  public:
    using ContactIterate::ContactIterate;

  protected:
    /// Where SMALBE-M came to with the same bounds and the same point that balances the loads.
    using Reached = std::optional<qp::SmalbeStart<Vector>>;

    /// Semismooth Newton, with bounds that follow the solution or (a Tresca problem) as they are. @return convergence.
    /// @param is_rough is the start far from the solution? @param most_steps at most, if given.
    bool newton(const Vector      &from,
                const bool         bounds_follow,
                const bool         is_rough   = false,
                const unsigned int most_steps = 0);

    /// Newton's method from the present point, which stays when that does not converge. @return convergence.
    bool try_newton();

    /// SMALBE-M (with discs SMALSE-M) from a point that balances the loads within the present bounds, or from where it came
    /// to; fills status and residuals.
    Vector smalbe(const Vector       &from,
                  const double        tolerance,
                  const qp::Observer &progress,
                  const bool          may_end_early = false,
                  Reached            *reached       = nullptr);

    /// A few steps, in space with squares around the discs: they tell the first set as well.
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
