// Linear problems on the active set of a solution: free rows stay free, rows at a bound stay at it.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/contact/slip_law.h>
#include <slipstick/qp/direction_store.h>
#include <slipstick/qp/pressure_bounds.h>
#include <slipstick/tfeti/face.h>

#include <optional>

namespace slipstick::contact
{
  /// The tangential rows of slipping nodes whose friction follows the normal force: tied to the normal row by the
  /// derivative of the friction force. In space the direction of slip is that of the solution.
  std::vector<qp::Tie> following_friction(const SlipLaw &law, const DualSolution &solution);

  /// Adjoint problems: linear problems on the rows that are free in a solution (closed, sticking, glued). Friction at
  /// slipping nodes follows the normal force; with F the Hessian of the dual problem, f its free rows and C the matrix
  /// of the ties, forces change by x = (E_f + C) y, and a quantity g'x has the adjoint solution z of
  /// (E_f + C)'F E_f z = (E_f + C)'g. Overwrites loads and right-hand side of the dual problem; a later load step must
  /// set them again. Members are collective.
  class Adjoint
  {
  public:
    using Store = qp::DirectionStore<tfeti::DistributedVector>;

    /// @param ties of following_friction(). @param directions store of directions of earlier solves, which every solve
    /// uses and extends; null: a new store.
    Adjoint(tfeti::DualProblem      &dual,
            const std::vector<bool> &free,
            std::vector<qp::Tie>     ties       = {},
            std::shared_ptr<Store>   directions = nullptr);

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
    /// the other rows vanish. On a row to which others are tied, B u - jumps plus the factors times the same of the
    /// tied rows vanishes instead. For a goal quantity g'x of the multipliers x: jumps g, no loads; for a goal quantity
    /// of displacements: loads only. Returns nothing if the solver fails. The energy product of the error of the
    /// adjoint solution with that of the primal solution is the error of the goal quantity (Becker, Rannacher 2001);
    /// the multipliers of the adjoint solution are its derivatives with respect to the right-hand sides of the rows.
    std::optional<Answer> solve(std::vector<Eigen::VectorXd> loads, const std::vector<double> &jumps);

    /// As above, without loads.
    std::optional<Answer> solve(const std::vector<double> &jumps);

    /// Counts of all solves together.
    const qp::Counts &counts() const
    {
      return work;
    }

  private:
    /// The same without ties.
    std::optional<Answer> solve_untied(std::vector<Eigen::VectorXd> loads, std::vector<double> jumps);

    /// The factors times (@p jumps - B u) of the tied rows, on the rows to which they are tied.
    tfeti::DistributedVector of_ties(const std::vector<double> &jumps, const std::vector<Eigen::VectorXd> &u) const;

    std::vector<Eigen::VectorXd> no_loads() const;

    tfeti::DualProblem          &dual;
    const std::vector<bool>      free;
    const std::vector<qp::Tie>   ties;
    const bool                   has_ties; // on any rank
    const std::shared_ptr<Store> store;
    tfeti::Face                  face;
    qp::Counts                   work;
  };
} // namespace slipstick::contact
