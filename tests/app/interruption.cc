// Signals while files that agree with each other are written.
#include <slipstick/app/interruption.h>

#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>

using namespace slipstick;

namespace
{
  TEST(Interruption, WaitsUntilFilesAreWritten)
  {
    for (const int signal : {SIGINT, SIGTERM})
      EXPECT_EXIT(
        {
          app::tell_when_interrupted("in load step 2");
          {
            const app::HeldInterruption all_or_none;
            raise(signal);
            std::fputs("written", stderr);
          }
          std::fputs("not reached", stderr);
        },
        testing::KilledBySignal(signal),
        "^written\nerror: interrupted in load step 2\n$");
  }

  TEST(Interruption, IsNotHeldAfterwards)
  {
    EXPECT_EXIT(
      {
        app::tell_when_interrupted("in load step 2");
        {
          const app::HeldInterruption all_or_none;
        }
        raise(SIGTERM);
      },
      testing::KilledBySignal(SIGTERM),
      "^\nerror: interrupted in load step 2\n$");
  }
} // namespace
