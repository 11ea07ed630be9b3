#include <slipstick/tfeti/dual_problem.h>

#include <deal.II/base/mpi.h>

namespace slipstick::tfeti
{
  DualProblem::Face DualProblem::face(const std::vector<bool> &free, const std::vector<qp::Tie> &ties) const
  {
    return Face(*this, free, ties);
  }

  DualProblem::Face::Face(const DualProblem          &problem_,
                          const std::vector<bool>    &free_,
                          const std::vector<qp::Tie> &ties_)
    : problem(problem_)
    , free(free_)
    , ties(ties_)
  {
    if (!problem.bodies->free(free).empty())
      return;
    projector =
      std::make_unique<Projector>(*problem.projector, free, problem.comm, std::vector<qp::Tie>(), problem.metric);
    if (dealii::Utilities::MPI::max(ties.empty() ? 0 : 1, problem.comm) > 0)
      {
        std::vector<bool> moving = free;
        for (const auto &tie : ties)
          moving[tie.tied] = true;
        tied = std::make_unique<Projector>(*problem.projector, moving, problem.comm, ties, problem.metric);
      }
    if (problem.preconditioner)
      weights = std::make_unique<RowWeights::Inverse>(problem.preconditioner->weights(), free);
  }

  void DualProblem::Face::multiply(const DistributedVector &x, DistributedVector &y) const
  {
    problem.multiply(x, y);
  }

  const std::vector<double> &DualProblem::Face::residual_weights() const
  {
    return problem.residual_weights();
  }

  const MpiReduction &DualProblem::Face::reduction() const
  {
    return problem.reduce;
  }

  // Twice where the rounding of the first shows.
  void DualProblem::Face::projected(const Projection project, const DistributedVector &x, DistributedVector &y) const
  {
    (*projector.*project)(x, y);
    if (!problem.projects_twice)
      return;
    DistributedVector left(x), rest = problem.zero();
    left -= y;
    (*projector.*project)(left, rest);
    y += rest;
  }

  void DualProblem::Face::project_range(const DistributedVector &x, DistributedVector &y) const
  {
    projected(&Projector::project_range, x, y);
    for (unsigned int r = 0; r < free.size(); ++r)
      if (!free[r])
        y.local_element(r) = x.local_element(r);
  }

  void DualProblem::Face::balance(DistributedVector &x) const
  {
    DistributedVector step = problem.zero();
    for (unsigned int pass = 0; pass < (problem.projects_twice ? 2 : 1); ++pass)
      {
        balancing().particular(problem.resultants - problem.projector->multiply(x), step);
        x += step;
      }
  }

  void DualProblem::Face::project_kernel(DistributedVector &p) const
  {
    for (const qp::Tie &tie : ties)
      p.local_element(tie.tied) = tie.factor * p.local_element(tie.to);
    DistributedVector range = problem.zero();
    balancing().excess(p, range);
    p -= range;
  }

  void DualProblem::Face::multiplier_shift(const DistributedVector &v, DistributedVector &y) const
  {
    projected(&Projector::extend_range, v, y);
  }

  void DualProblem::Face::precondition(const DistributedVector &r, DistributedVector &z) const
  {
    if (!weights)
      {
        z.copy_locally_owned_data_from(r);
        return;
      }
    problem.preconditioner->apply(*weights, r, z);
    z *= problem.norm();
  }
} // namespace slipstick::tfeti
