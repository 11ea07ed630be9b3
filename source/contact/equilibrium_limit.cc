#include <slipstick/base/log.h>
#include <slipstick/contact/equilibrium_limit.h>
#include <slipstick/qp/types.h>
#include <slipstick/tfeti/rigid_motions.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::contact
{
  namespace
  {
    // Loads along a motion below this fraction of the largest force are rounding of zero.
    constexpr double rounding_of_drive = 1e-10;
    // Maximum number of decimals in messages.
    constexpr int most_decimals = 12;

    bool is_at_limit(const double held)
    {
      return std::abs(held - 1) < nearness_of_limit;
    }

    /// The number with enough digits to distinguish it from 1.
    std::string part_text(const double held)
    {
      if (!is_at_limit(held))
        return format("%.3g", held);
      const double distance = std::max(std::abs(held - 1), std::pow(10., -most_decimals));
      return format("%.*f", std::min(most_decimals, 1 - int(std::floor(std::log10(distance)))), held);
    }
  } // namespace

  std::optional<tfeti::Overload> weakest_motion(const tfeti::DualProblem       &dual,
                                                const SlipLaw                  &law,
                                                const tfeti::DistributedVector &x,
                                                const double                    below)
  {
    const double        largest = x.linfty_norm(), noise = qp::force_rounding * largest;
    const auto          bounds = law.bounds(x);
    std::vector<bool>   holds(x.locally_owned_size());
    std::vector<double> capacity(holds.size(), -1.);
    for (unsigned int r = 0; r < holds.size(); ++r)
      {
        const auto kind = dual.constraints().kind[r];
        holds[r]        = is_equality(kind) || (kind == tfeti::RowKind::normal && x.local_element(r) > noise);
        if (!holds[r])
          capacity[r] = kind == tfeti::RowKind::normal ? qp::infinity : bounds[r];
      }
    auto weakest = dual.loose_bodies().overload(holds, capacity, below);
    return weakest && weakest->load > rounding_of_drive * largest ? weakest : std::nullopt;
  }

  std::string describe(const tfeti::Overload &weakest, const std::vector<std::string> &body_names)
  {
    return format("at the normal forces found it bears %s of the load that moves %s",
                  part_text(weakest.held).c_str(),
                  tfeti::describe(weakest.motion, body_names).c_str());
  }

  std::string limit_warning(const tfeti::DualProblem &dual, const SlipLaw &law, const tfeti::DistributedVector &x)
  {
    const auto weakest = weakest_motion(dual, law, x, 1 + nearness_of_limit);
    if (!weakest || !is_at_limit(weakest->held))
      return "";
    return "friction is at the limit of equilibrium: " + describe(*weakest, dual.body_motions().names()) +
           "; a little less friction or more load moves it, and where it slips and by how much depends on the tolerance: "
           "raise the friction coefficient or the normal force, support the body against this motion, or lower the load";
  }
} // namespace slipstick::contact
