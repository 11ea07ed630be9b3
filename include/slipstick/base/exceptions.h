// Errors that a user sees: what is wrong, its value, what is allowed, and the remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace slipstick
{
  /// Exit status of the program, see doc/interface.md.
  enum class ExitStatus
  {
    converged      = 0,
    internal_error = 1,
    bad_input      = 2,
    not_converged  = 3,
    no_equilibrium = 4
  };

  /// An error with a remedy. `what()` is "PROBLEM\n  remedy: REMEDY".
  class Error : public std::runtime_error
  {
  public:
    Error(const std::string &problem, const std::string &remedy)
      : std::runtime_error(problem + "\n  remedy: " + remedy)
    {}

    /// A text that already carries its remedy, passed on from another rank.
    struct Ready
    {};
    Error(Ready, const std::string &text)
      : std::runtime_error(text)
    {}
  };

  /// The scene cannot be solved as given: file, parameter or mesh. Thrown on all ranks alike (see
  /// base/collective.h for how an error found by one rank is made so).
  class InputError : public Error
  {
  public:
    using Error::Error;
  };

  /// The loads cannot be balanced; the message names the body, the motion and what to add. Thrown on all ranks alike.
  class NoEquilibrium : public Error
  {
  public:
    using Error::Error;
  };

  /// No load acts along a motion that nothing holds: there is an equilibrium, but the position is not determined.
  class UndeterminedPosition : public NoEquilibrium
  {
  public:
    using NoEquilibrium::NoEquilibrium;
  };

  /// Numerics failed where the theory says that they cannot (a factorisation that breaks down, a kernel that is
  /// larger than the rigid motions).
  class NumericalError : public Error
  {
  public:
    using Error::Error;
  };
} // namespace slipstick
