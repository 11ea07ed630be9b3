// Requests to end the program (SIGTERM) while METIS works.
#pragma once

#include <csignal>

namespace slipstick
{
  /// METIS takes a SIGTERM that arrives while it works for an error of its own (gk_sigtrap in its sources). The program
  /// repeats the signal after METIS has @p failed without another reason, so that it ends as at any other time.
  inline void raise_termination(const bool failed)
  {
    if (failed)
      std::raise(SIGTERM);
  }
} // namespace slipstick
