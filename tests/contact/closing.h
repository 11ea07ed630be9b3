// Closing of the gaps that a solution leaves open.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/contact/slip_law.h>

namespace slipstick::test
{
  /// A rough solution, the free multipliers off by some percent, is led to the accurate one: displacements, and slip
  /// forces that follow the pressures.
  /// @return number of entries that slip at bounds which follow a pressure, of all ranks.
  unsigned int expect_closing_leads_to(const contact::DualSolution &accurate,
                                       const tfeti::DualProblem    &dual,
                                       const contact::SlipLaw      &law);
} // namespace slipstick::test
