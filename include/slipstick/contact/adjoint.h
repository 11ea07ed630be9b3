// Linear problems on the active set of a solution: free rows stay free, rows at a bound stay at it.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/qp/direction_store.h>
#include <slipstick/tfeti/face.h>

#include <optional>

namespace slipstick::contact
{
  /// Solves for displacements due to loads and jumps on the rows that are free in a solution (closed, sticking, glued).
  /// Overwrites loads and right-hand side of the dual problem; a later load step must set them again. Members are
  /// collective.
  class Adjoint
  {
  public:
    using Store = qp::DirectionStore<tfeti::DistributedVector>;

    /// @param directions store of directions of earlier solves, which every solve uses and extends; null: a new store.
    Adjoint(tfeti::DualProblem &dual, const std::vector<bool> &free, std::shared_ptr<Store> directions = nullptr);

    /// Whether the free rows hold all bodies; otherwise there is no solution.
    bool is_possible() const
    {
      return face.is_regular();
    }

    /// Solution: displacements, and multipliers on the free rows.
    struct Answer
    {
      std::vector<Eigen::VectorXd> u;
      tfeti::DistributedVector     multipliers;
    };

    /// u with B u = @p jumps [mm] on the free rows under the loads [N] of this rank's subdomains; the multipliers of
    /// the other rows vanish. For a goal quantity g'x of the multipliers x: jumps g, no loads; for a goal quantity of
    /// displacements: loads only. Returns nothing if the solver fails. The energy product of the error of the adjoint
    /// solution with that of the primal solution is the error of the goal quantity (Becker, Rannacher 2001); the
    /// multipliers of the adjoint solution are its derivatives with respect to the right-hand sides of the rows.
    std::optional<Answer> solve(std::vector<Eigen::VectorXd> loads, std::vector<double> jumps);

    /// As above, without loads.
    std::optional<Answer> solve(std::vector<double> jumps);

    /// Counts of all solves together.
    const qp::Counts &counts() const
    {
      return work;
    }

  private:
    tfeti::DualProblem          &dual;
    const std::vector<bool>      free;
    const std::shared_ptr<Store> store;
    tfeti::Face                  face;
    qp::Counts                   work;
  };
} // namespace slipstick::contact
