#include <slipstick/base/gather.h>
#include <slipstick/qp/types.h>
#include <slipstick/tfeti/dense.h>
#include <slipstick/tfeti/least_violation.h>
#include <slipstick/tfeti/recovery.h>

#include <deal.II/base/mpi.h>

#include <cmath>

namespace slipstick::tfeti
{
  namespace
  {
    // Jumps of a row per unit motion below this are rounding.
    constexpr double least_jump = 1e-8;
    // Friction forces below this part of the largest force do not tell where a body slides: they come from rounding or
    // from the tolerance of the solver.
    constexpr double least_friction = 1e-8;

    /// Adds to the free rows those rows with friction forces that hold the loose motions. @return whether all are held.
    bool add_rows_with_friction(const DualProblem              &dual,
                                const std::vector<RigidMotion> &loose,
                                const DistributedVector        &x,
                                std::vector<bool>              &free)
    {
      const Constraints        &rows  = dual.constraints();
      const double              noise = least_friction * x.linfty_norm();
      const std::vector<double> equal(free.size(), 1.);
      std::vector<bool>         is_candidate(free.size());
      for (unsigned int r = 0; r < free.size(); ++r)
        is_candidate[r] = !free[r] && rows.kind[r] == RowKind::tangential && std::abs(x.local_element(r)) > noise;
      return dual.loose_bodies().hold_by(loose, is_candidate, equal, free);
    }

    /// The amplitudes of the part of u along loose motions, in the mean over the volume.
    Eigen::VectorXd amplitudes_in(const DualProblem                  &dual,
                                  const std::vector<RigidMotion>     &loose,
                                  const std::vector<Eigen::VectorXd> &u)
    {
      const auto       &systems = dual.subdomains();
      const std::size_t n       = loose.size();
      Eigen::MatrixXd   gram    = Eigen::MatrixXd::Zero(n, n + 1); // last column: products with u
      for (unsigned int p = 0; p < systems.size(); ++p)
        {
          Eigen::MatrixXd motions(u[p].size(), n);
          for (std::size_t m = 0; m < n; ++m)
            motions.col(m) = dual.body_motions().displacements(p, loose[m].amplitudes);
          const Eigen::MatrixXd weighted = systems[p]->volumes().asDiagonal() * motions;
          gram.leftCols(n) += weighted.transpose() * motions;
          gram.col(n) += weighted.transpose() * u[p];
        }
      MPI_Allreduce(MPI_IN_PLACE, gram.data(), gram.size(), MPI_DOUBLE, MPI_SUM, dual.communicator());
      const Eigen::VectorXd amount     = shortest_solution(gram.leftCols(n), gram.col(n));
      Eigen::VectorXd       amplitudes = Eigen::VectorXd::Zero(loose[0].amplitudes.size());
      for (std::size_t m = 0; m < n; ++m)
        amplitudes += amount[m] * loose[m].amplitudes;
      return amplitudes;
    }

    void subtract_motion(const DualProblem &dual, const Eigen::VectorXd &amplitudes, std::vector<Eigen::VectorXd> &u)
    {
      for (unsigned int p = 0; p < u.size(); ++p)
        u[p] -= dual.body_motions().displacements(p, amplitudes);
    }

    /// Conditions on the position of loose bodies at rows at a bound: jumps on the side given by the force and, at
    /// nodes that slip in space, no slip across the force. An equation counts as two conditions.
    class SlidingConditions
    {
    public:
      SlidingConditions(const DualProblem              &dual,
                        const std::vector<RigidMotion> &loose,
                        const std::vector<bool>        &free_,
                        const DistributedVector        &x_,
                        const DistributedVector        &jump_)
        : rows(dual.constraints())
        , free(free_)
        , x(x_)
        , jump(jump_)
        , noise(least_friction * x_.linfty_norm())
        , per_motion(dual.body_motions().jumps(loose).toDense())
      {
        per_motion = (per_motion.array().abs() < least_jump).select(0., per_motion); // rounding moves no row
        std::vector<bool> is_in_disc(free.size(), false);
        for (const ContactPoint &point : rows.contact_points)
          if (point.tangential_row != invalid_row && point.second_row != invalid_row)
            {
              is_in_disc[point.tangential_row] = is_in_disc[point.second_row] = true;
              add_disc(point.tangential_row, point.second_row);
            }
        for (unsigned int r = 0; r < free.size(); ++r)
          if (!free[r] && !is_equality(rows.kind[r]) && !is_in_disc[r])
            add_row(r);
      }

      /// Of the owned rows: a value, then its derivatives with respect to the amounts of the loose motions.
      std::vector<std::vector<double>> conditions;

    private:
      void add(const double value, const Eigen::RowVectorXd &derivatives)
      {
        conditions.push_back({value});
        conditions.back().insert(conditions.back().end(), derivatives.data(), derivatives.data() + derivatives.size());
      }

      double beyond(const unsigned int r) const
      {
        return jump.local_element(r) - rows.c[r];
      }

      void add_row(const unsigned int r)
      {
        const double force = x.local_element(r);
        if (rows.kind[r] == RowKind::tangential && !(std::abs(force) > noise))
          return;
        const double side = rows.kind[r] == RowKind::tangential && force > 0 ? 1. : -1.;
        add(side * beyond(r), side * per_motion.row(r));
      }

      void add_disc(const unsigned int first, const unsigned int second)
      {
        const double x1 = x.local_element(first), x2 = x.local_element(second), size = std::hypot(x1, x2);
        if (free[first] || free[second] || !(size > noise))
          return;
        const double c = x1 / size, s = x2 / size;
        add(c * beyond(first) + s * beyond(second), c * per_motion.row(first) + s * per_motion.row(second));
        for (const double side : {1., -1.})
          add(side * (c * beyond(second) - s * beyond(first)),
              side * (c * per_motion.row(second) - s * per_motion.row(first)));
      }

      const Constraints       &rows;
      const std::vector<bool> &free;
      const DistributedVector &x, &jump;
      const double             noise;
      Eigen::MatrixXd          per_motion; // owned rows x loose motions
    };

    /// Moves bodies along loose motions to minimise the sum of squares of the violations of the sliding conditions.
    void slide_apart(const DualProblem              &dual,
                     const std::vector<RigidMotion> &loose,
                     const std::vector<bool>        &free,
                     const DistributedVector        &x,
                     Recovery                       &at)
    {
      const auto                      &systems    = dual.subdomains();
      const DistributedVector          jump       = dual.dual_operator().jumps(at.u);
      const auto                       conditions = SlidingConditions(dual, loose, free, x, jump).conditions;
      std::vector<std::vector<double>> all;
      for (const auto &part : all_gather(dual.communicator(), conditions))
        all.insert(all.end(), part.begin(), part.end());
      Eigen::VectorXd values(all.size());
      Eigen::MatrixXd rates(all.size(), loose.size());
      for (std::size_t i = 0; i < all.size(); ++i)
        {
          values[i]    = all[i][0];
          rates.row(i) = Eigen::Map<const Eigen::RowVectorXd>(all[i].data() + 1, loose.size());
        }
      const Eigen::VectorXd amount     = least_violation(values, rates);
      Eigen::VectorXd       amplitudes = Eigen::VectorXd::Zero(loose[0].amplitudes.size());
      for (unsigned int m = 0; m < loose.size(); ++m)
        amplitudes += amount[m] * loose[m].amplitudes;
      for (unsigned int p = 0; p < systems.size(); ++p)
        at.u[p] += dual.body_motions().displacements(p, amplitudes);
    }

    /// The projector of displacements: restricted to the free rows, with the weights of residuals.
    Projector projector_of_displacements(const DualProblem &dual, const std::vector<bool> &free)
    {
      try
        {
          return Projector(dual.projector(),
                           free,
                           dual.communicator(),
                           std::vector<qp::Tie>(),
                           dual.residual_weights());
        }
      catch (const NumericalError &) // on all ranks: no motion is free, but the stiff rows hide the others
        {
          throw stiffnesses_too_far_apart();
        }
    }

    /// u += R a: a least squares fit to the free rows, to which the projector is restricted.
    void fit_motions(const DualProblem &dual, const Projector &on_free, const std::vector<bool> &free, Recovery &at)
    {
      const auto       &systems = dual.subdomains();
      DistributedVector missing = misfit(dual, at, free), range = dual.zero();
      Eigen::VectorXd   a = on_free.amplitudes(missing);
      on_free.project_range(missing, range);
      missing -= range;
      a += on_free.amplitudes(missing); // corrects the rounding of the first fit
      unsigned int next = 0;
      for (unsigned int p = 0; p < systems.size(); ++p)
        {
          const unsigned int k = systems[p]->kernel().cols();
          at.u[p] += systems[p]->kernel() * a.segment(next, k);
          next += k;
        }
    }
    /// The loose motions that the free rows leave, and the rows used to place the bodies.
    struct Placement
    {
      std::vector<RigidMotion> loose;
      std::vector<bool>        fixed;             // the free rows, and further ones if these leave loose motions
      bool                     has_forces = true; // whether all of these rows carry friction forces
    };

    Placement placed_by_forces(const DualProblem &dual, const DistributedVector &x, const std::vector<bool> &free)
    {
      Placement result{dual.body_motions().free(free), free};
      result.has_forces = result.loose.empty() || add_rows_with_friction(dual, result.loose, x, result.fixed);
      return result;
    }

    bool is_driven(const Placement &placement)
    {
      return !placement.has_forces && plainest(placement.loose).work > 0;
    }

    /// Uses any rows if not enough of them carry forces.
    void place_by_any_row(const DualProblem &dual, Placement &placement)
    {
      const std::vector<double> equal(placement.fixed.size(), 1.);
      std::vector<bool>         is_candidate(placement.fixed);
      is_candidate.flip();
      if (!dual.loose_bodies().hold_by(placement.loose, is_candidate, equal, placement.fixed))
        require_support(placement.loose, dual.body_motions().names());
    }

    Recovery recover_placed(const DualProblem       &dual,
                            const DistributedVector &x,
                            const std::vector<bool> &free,
                            Placement                placement)
    {
      if (!placement.has_forces)
        place_by_any_row(dual, placement);
      const auto       &systems = dual.subdomains();
      const Projector   on_free = projector_of_displacements(dual, placement.fixed);
      Recovery          result{{}, dual.zero(), {}};
      DistributedVector step{dual.zero()};
      result.multipliers = x;
      for (unsigned int pass = 0; pass < 2; ++pass) // the second pass corrects the rounding of the first
        {
          on_free.particular(dual.e() - dual.projector().multiply(result.multipliers), step);
          result.multipliers += step;
        }

      result.u = dual.dual_operator().forces(result.multipliers);
      auto &u  = result.u;
      for (unsigned int p = 0; p < systems.size(); ++p)
        {
          u[p] = systems[p]->load() - u[p];
          systems[p]->apply_pseudo_inverse(u[p]);
        }

      fit_motions(dual, on_free, placement.fixed, result);
      if (!placement.has_forces)
        {
          subtract_motion(dual, amplitudes_in(dual, placement.loose, result.u), result.u);
          result.unresisted = placement.loose;
        }
      if (!placement.loose.empty())
        slide_apart(dual, placement.loose, free, x, result);
      return result;
    }
  } // namespace

  bool remove_motions(DualProblem                    &dual,
                      const std::vector<RigidMotion> &motions,
                      const std::vector<bool>        &free,
                      const double                    tolerated,
                      std::vector<Eigen::VectorXd>   &u)
  {
    const Constraints      &rows   = dual.constraints();
    std::vector<double>     c      = rows.c;
    const RigidMotion       motion = {amplitudes_in(dual, motions, u), 0., motions.front().frames};
    const Eigen::VectorXd   moved  = dual.body_motions().jumps({motion}).toDense().col(0);
    const DistributedVector jumps  = dual.dual_operator().jumps(u);
    double                  worst  = 0;
    for (unsigned int r = 0; r < c.size(); ++r)
      if (rows.kind[r] == RowKind::prescribed)
        c[r] -= moved[r];
      else if (free[r] || rows.kind[r] != RowKind::normal)
        worst = std::max(worst, std::abs(moved[r]));
      else // closes a gap
        worst = std::max(worst, std::min(-moved[r], jumps.local_element(r) - moved[r] - c[r]));
    if (dealii::Utilities::MPI::max(worst, dual.communicator()) > tolerated)
      return false;
    subtract_motion(dual, motion.amplitudes, u);
    dual.set_right_hand_side(std::move(c));
    return true;
  }

  DistributedVector misfit(const DualProblem &dual, const Recovery &of, const std::vector<bool> &free)
  {
    const Constraints &rows    = dual.constraints();
    DistributedVector  missing = dual.dual_operator().jumps(of.u);
    for (unsigned int r = 0; r < rows.c.size(); ++r)
      missing.local_element(r) = free[r] ? rows.c[r] - missing.local_element(r) : 0.;
    for (unsigned int r = 0; r < rows.compliance.size(); ++r)
      missing.local_element(r) += free[r] ? rows.compliance[r] * of.multipliers.local_element(r) : 0.;
    return missing;
  }

  Recovery recover(const DualProblem       &dual,
                   const DistributedVector &x,
                   const std::vector<bool> &free,
                   const bool               keeps_still)
  {
    Placement placement = placed_by_forces(dual, x, free);
    if (!placement.has_forces && (!keeps_still || is_driven(placement)))
      require_support(placement.loose, dual.body_motions().names());
    return recover_placed(dual, x, free, std::move(placement));
  }

  std::optional<Recovery> recover_if_held(const DualProblem       &dual,
                                          const DistributedVector &x,
                                          const std::vector<bool> &free)
  {
    Placement placement = placed_by_forces(dual, x, free);
    if (is_driven(placement))
      return {};
    return recover_placed(dual, x, free, std::move(placement));
  }

  void correct(const DualProblem &dual, Recovery &at, const DistributedVector &step, const std::vector<bool> &free)
  {
    const auto &systems = dual.subdomains();
    auto        change  = dual.dual_operator().forces(step);
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        systems[p]->apply_pseudo_inverse(change[p]);
        at.u[p] -= change[p];
      }
    at.multipliers += step;
    fit_motions(dual, projector_of_displacements(dual, free), free, at);
  }
} // namespace slipstick::tfeti
