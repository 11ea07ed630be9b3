// Closing of the gaps that a solution leaves open.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/contact/slip_law.h>

namespace slipstick::test
{
  /// Expects that closing the gaps of a rough solution, whose free multipliers are off by a few per cent, gives the
  /// accurate one: displacements, and slip forces that follow the pressures.
  /// @return number of entries that slip at bounds which follow a pressure, over all ranks.
  unsigned int expect_closing_leads_to(const contact::DualSolution &accurate,
                                       const tfeti::DualProblem    &dual,
                                       const contact::SlipLaw      &law);
} // namespace slipstick::test
