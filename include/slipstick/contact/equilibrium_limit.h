// How near friction is to what it can bear: the motion of bodies that it resists least.
#pragma once

#include <slipstick/contact/slip_law.h>

#include <optional>
#include <string>
#include <vector>

namespace slipstick::contact
{
  /// Friction or admissible forces that miss or exceed the loads by less than this part of them are at the limit of
  /// equilibrium: which side of it they are on may depend on the tolerance.
  constexpr double nearness_of_limit = 1e-3;

  /// The motion that friction, at the normal forces of x, resists least among those that nothing else resists, if it
  /// bears less than @p below of the load along it. None where that load is rounding. Collective.
  std::optional<tfeti::Overload> weakest_motion(const tfeti::DualProblem       &dual,
                                                const SlipLaw                  &law,
                                                const tfeti::DistributedVector &x,
                                                const double                    below);

  /// "at the normal forces found it bears 0.93 of the load that moves body a: ...", with the digits that tell it from 1.
  std::string describe(const tfeti::Overload &weakest, const std::vector<std::string> &body_names);

  /// A warning for a solution that is at the limit; empty for others. Collective.
  std::string limit_warning(const tfeti::DualProblem &dual, const SlipLaw &law, const tfeti::DistributedVector &x);
} // namespace slipstick::contact
