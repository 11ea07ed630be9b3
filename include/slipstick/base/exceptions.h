// Errors reported to the user: the fault, its value, the allowed values, and the remedy.
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

    /// A text that already contains its remedy, received from another rank.
    struct Ready
    {};
    Error(Ready, const std::string &text)
      : std::runtime_error(text)
    {}
  };

  /// The scene cannot be solved as given: file, parameter or mesh. Thrown on all ranks (base/collective.h distributes
  /// errors found on one rank).
  class InputError : public Error
  {
  public:
    using Error::Error;
  };

  /// The loads cannot be balanced; the message names the body, the motion and a remedy. Thrown on all ranks.
  class NoEquilibrium : public Error
  {
  public:
    using Error::Error;
  };

  /// No load acts along a motion that nothing resists: there is an equilibrium, but the position is not determined.
  class UndeterminedPosition : public NoEquilibrium
  {
  public:
    using NoEquilibrium::NoEquilibrium;
  };

  /// A numerical method failed in a way that theory excludes (e.g. a breakdown of the factorisation of the coarse matrix).
  class NumericalError : public Error
  {
  public:
    using Error::Error;
  };
} // namespace slipstick
