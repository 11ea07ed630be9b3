// Linear problems on the set of a solution: what is free stays free, what is at a bound stays there.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/qp/options.h>
#include <slipstick/tfeti/face.h>

#include <optional>

namespace slipstick::contact
{
  /// Displacements that answer loads and jumps on the rows which are free in a solution (closed, sticking, glued). Changes
  /// loads and right-hand side of the dual problem, which another load step has to set again. Members are collective.
  class Adjoint
  {
  public:
    Adjoint(tfeti::DualProblem &dual, const std::vector<bool> &free, const qp::PcpgOptions &options);

    /// Do the free rows hold all bodies? Else there is no answer.
    bool is_possible() const
    {
      return face.is_regular();
    }

    /// Displacements, and multipliers on the free rows.
    struct Answer
    {
      std::vector<Eigen::VectorXd> u;
      tfeti::DistributedVector     multipliers;
    };

    /// u with B u = @p jumps [mm] on the free rows under the loads [N] of this rank's subdomains, whose multipliers vanish on
    /// the other rows. For a figure g'x of the multipliers x: jumps g, no loads; for a figure of displacements: loads alone.
    /// Nothing where the solver fails. The energy product of its error with that of the solution is the error of the figure (Becker,
    /// Rannacher 2001), its multipliers are the derivatives of the figure by the right-hand sides of the rows.
    std::optional<Answer> solve(std::vector<Eigen::VectorXd> loads, std::vector<double> jumps);

    /// The same without loads.
    std::optional<Answer> solve(std::vector<double> jumps);

    /// Work of all solves.
    const qp::Counts &counts() const
    {
      return work;
    }

  private:
    tfeti::DualProblem     &dual;
    const std::vector<bool> free;
    const qp::PcpgOptions   options;
    tfeti::Face             face;
    qp::Counts              work;
  };
} // namespace slipstick::contact
