#include <slipstick/contact/no_forces.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::contact
{
  namespace
  {
    // Overlaps below this fraction of the initial ones are rounding of zero.
    constexpr double negligible_overlap = 1e-10;

    double largest_of(const std::vector<double> &values, const MPI_Comm comm)
    {
      double largest = 0;
      for (const double value : values)
        largest = std::max(largest, std::abs(value));
      return dealii::Utilities::MPI::max(largest, comm);
    }

    /// Whether the bodies can be moved apart so that nothing overlaps.
    bool can_be_separated(const tfeti::DualProblem &dual, const Box &box)
    {
      const auto         &kind    = dual.constraints().kind;
      const auto         &weights = dual.residual_weights();
      std::vector<double> force(kind.size()), stiffness(kind.size(), 1 / dual.norm());
      for (unsigned int r = 0; r < kind.size(); ++r)
        {
          stiffness[r] *= weights.empty() ? 1. : weights[r];
          force[r] = kind[r] == tfeti::RowKind::normal ? stiffness[r] * dual.d().local_element(r) : 0.;
        }
      const double none = negligible_overlap * largest_of(force, dual.communicator());
      dual.loose_bodies().balance(stiffness, qp::AdmissibleSet<tfeti::DistributedVector>{box, {}}, 0., force);
      for (unsigned int r = 0; r < kind.size(); ++r)
        force[r] = kind[r] == tfeti::RowKind::normal ? std::max(force[r], 0.) : 0.;
      return largest_of(force, dual.communicator()) <= none;
    }
  } // namespace

  bool all_forces_vanish(const tfeti::DualProblem       &dual,
                         const tfeti::DistributedVector &feasible,
                         const Box                      &box,
                         const std::vector<double>      &slip_bound)
  {
    const auto         &kind = dual.constraints().kind;
    const auto         &c    = dual.constraints().c;
    std::vector<double> largest{feasible.linfty_norm(), 0., 0., 0.}; // loads; overlaps and slip; bounds; earlier slip
    for (unsigned int r = 0; r < kind.size(); ++r)
      {
        const double d = dual.d().local_element(r);
        if (is_equality(kind[r]))
          largest[0] = std::max(largest[0], std::abs(d));
        else
          largest[1] = std::max(largest[1], kind[r] == tfeti::RowKind::normal ? d : std::abs(d));
        largest[2] = std::max(largest[2], slip_bound[r]);
        if (kind[r] == tfeti::RowKind::tangential)
          largest[3] = std::max(largest[3], std::abs(c[r]));
      }
    dealii::Utilities::MPI::max(largest, dual.communicator(), largest);
    if (largest[0] > 0 || largest[3] > 0) // friction may lock forces in
      return false;
    return largest[1] == 0 || (largest[2] == 0 && can_be_separated(dual, box));
  }
} // namespace slipstick::contact
