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

  /// Defers interruptions during its lifetime, while files that must be consistent with each other are written. Must
  /// not be nested; has no effect unless tell_when_interrupted() has been called.
  class HeldInterruption
  {
  public:
    HeldInterruption();
    ~HeldInterruption(); // raises a signal that arrived in the meantime
    HeldInterruption(const HeldInterruption &)            = delete;
    HeldInterruption &operator=(const HeldInterruption &) = delete;
  };
} // namespace slipstick::app
