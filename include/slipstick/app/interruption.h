// Message to the user when Ctrl-C or SIGTERM ends a run.
#pragma once

#include <string>

namespace slipstick::app
{
  /// From the first call on, SIGINT and SIGTERM write "interrupted" and @p text to standard error before they end the
  /// process as usual. To be called on one rank only, the one that prints. Signals that are ignored stay ignored.
  void tell_when_interrupted(const std::string &text);

  /// From now on these signals end the process without a message again.
  void do_not_tell_when_interrupted();

  /// Holds an interruption back while it lives, as files that agree with each other are written. Not nested; without effect
  /// where tell_when_interrupted() is not in force.
  class HeldInterruption
  {
  public:
    HeldInterruption();
    ~HeldInterruption(); // interrupts now if a signal came in between
    HeldInterruption(const HeldInterruption &)            = delete;
    HeldInterruption &operator=(const HeldInterruption &) = delete;
  };
} // namespace slipstick::app
