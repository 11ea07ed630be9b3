// Requests to end the program (SIGTERM) while METIS works.
#pragma once

#include <csignal>

namespace slipstick
{
  /// METIS mistakes a SIGTERM that arrives while it is running for an error of its own (gk_sigtrap in its sources).
  /// This function raises the signal again after METIS has @p failed without another reason, so that the program ends
  /// as it does at any other time.
  inline void raise_termination(const bool failed)
  {
    if (failed)
      std::raise(SIGTERM);
  }
} // namespace slipstick
