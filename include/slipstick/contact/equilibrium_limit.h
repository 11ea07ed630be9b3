// Limit of equilibrium: the rigid motion that friction resists least, compared with the load along it.
#pragma once

#include <slipstick/contact/slip_law.h>

#include <optional>
#include <string>
#include <vector>

namespace slipstick::contact
{
  /// If friction or the admissible forces fall short of or exceed the loads by less than this fraction of them, the
  /// solution is at the limit of equilibrium: whether equilibrium exists may then depend on the tolerance.
  constexpr double nearness_of_limit = 1e-3;

  /// Among the motions that nothing but friction resists, the one that friction, at the normal forces of x, resists
  /// least, if friction bears less than @p below of the load along it. Nothing if that load is at rounding level.
  /// Collective.
  std::optional<tfeti::Overload> weakest_motion(const tfeti::DualProblem       &dual,
                                                const SlipLaw                  &law,
                                                const tfeti::DistributedVector &x,
                                                const double                    below);

  /// "at the normal forces found it bears 0.93 of the load that moves body a: ...", with enough digits to distinguish
  /// it from 1.
  std::string describe(const tfeti::Overload &weakest, const std::vector<std::string> &body_names);

  /// A warning for a solution at the limit of equilibrium; empty for others. Collective.
  std::string limit_warning(const tfeti::DualProblem &dual, const SlipLaw &law, const tfeti::DistributedVector &x);
} // namespace slipstick::contact
