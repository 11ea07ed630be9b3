// What the user is told when Ctrl-C or SIGTERM ends a run.
#pragma once

#include <string>

namespace slipstick::app
{
  /// From the first call on, SIGINT and SIGTERM write "interrupted" and @p text on standard error before they end the
  /// process as they always do. For one rank alone, which is to print. Signals that are ignored stay ignored.
  void tell_when_interrupted(const std::string &text);

  /// They end the process without a word again.
  void do_not_tell_when_interrupted();
} // namespace slipstick::app
