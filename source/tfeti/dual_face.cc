#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/dual_problem.h>

#include <deal.II/base/mpi.h>

namespace slipstick::tfeti
{
  DualProblem::Face DualProblem::face(const std::vector<bool>     &free,
                                      const std::vector<qp::Tie>  &ties,
                                      const std::vector<qp::Turn> &turns) const
  {
    return Face(*this, free, ties, turns);
  }

  DualProblem::Face::Face(const DualProblem           &problem_,
                          const std::vector<bool>     &free_,
                          const std::vector<qp::Tie>  &ties_,
                          const std::vector<qp::Turn> &turns_)
    : problem(problem_)
    , free(free_)
    , ties(ties_)
    , turns(turns_)
  {
    if (!problem.bodies->free(free, BodyMotions::rounding_of_resistance, turns).empty())
      return;
    try
      {
        make_projectors();
      }
    catch (const NumericalError &) // to rounding the free rows leave a motion open; the same on every rank
      {
        projector.reset();
        tied.reset();
        return;
      }
    if (problem.preconditioner)
      weights = std::make_unique<RowWeights::Inverse>(problem.preconditioner->weights(), free, turns);
  }

  void DualProblem::Face::make_projectors()
  {
    const std::vector<double>  softened = softened_metric();
    const std::vector<double> &metric   = turns.empty() ? problem.metric : softened;
    projector =
      std::make_unique<Projector>(*problem.projector, free, problem.comm, std::vector<qp::Tie>(), metric, turns);
    if (dealii::Utilities::MPI::max(ties.empty() ? 0 : 1, problem.comm) > 0)
      {
        std::vector<bool> moving = free;
        for (const auto &tie : ties)
          moving[tie.tied] = true;
        tied = std::make_unique<Projector>(*problem.projector, moving, problem.comm, ties, metric, turns);
      }
  }

  // A row that yields by kappa on top of 1/k has the stiffness 1/(kappa + 1/k). Empty without turned rows.
  std::vector<double> DualProblem::Face::softened_metric()
  {
    if (turns.empty())
      return {};
    std::vector<double> result = problem.metric;
    for (const qp::Turn &turn : turns)
      {
        double part = 1;
        if (!result.empty())
          {
            part = 1 / (1 + turn.compliance * problem.norm() * problem.least_stiffness * result[turn.second]);
            result[turn.second] *= part;
          }
        stiffness.push_back(part);
      }
    return result;
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

  // Twice where the rounding of the first shows. Of turned rows.
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
    std::optional<DistributedVector> copy;
    const DistributedVector         &at = turned(x, copy);
    projected(&Projector::project_range, at, y);
    for (unsigned int r = 0; r < free.size(); ++r)
      if (!free[r])
        y.local_element(r) = at.local_element(r);
    qp::turn_back(turns, y);
  }

  void DualProblem::Face::balance(DistributedVector &x) const
  {
    DistributedVector step = problem.zero();
    for (unsigned int pass = 0; pass < (problem.projects_twice ? 2 : 1); ++pass)
      {
        balancing().particular(problem.resultants - problem.projector->multiply(x), step);
        qp::turn_back(turns, step);
        x += step;
      }
  }

  void DualProblem::Face::project_kernel(DistributedVector &p) const
  {
    qp::turn(turns, p);
    for (const qp::Tie &tie : ties)
      p.local_element(tie.tied) = tie.factor * p.local_element(tie.to);
    DistributedVector range = problem.zero();
    balancing().excess(p, range);
    p -= range;
    qp::turn_back(turns, p);
  }

  void DualProblem::Face::multiplier_shift(const DistributedVector &v, DistributedVector &y) const
  {
    std::optional<DistributedVector> copy;
    projected(&Projector::extend_range, turned(v, copy), y);
    qp::turn_back(turns, y);
  }

  void DualProblem::Face::precondition(const DistributedVector &r, DistributedVector &z) const
  {
    if (!weights)
      {
        z.copy_locally_owned_data_from(r);
        return;
      }
    if (turns.empty() && problem.yielding.empty())
      problem.preconditioner->apply(*weights, r, z);
    else
      {
        DistributedVector at(r);
        soften(at);
        problem.preconditioner->apply(*weights, at, z);
        soften(z);
      }
    for (std::size_t row = 0; row < problem.yielding.size(); ++row) // their own stiffness bears what is smooth, too
      z.local_element(row) += (1 - problem.yielding[row] * problem.yielding[row]) * problem.metric[row] *
                              problem.least_stiffness * r.local_element(row);
    z *= problem.norm();
  }

  // x itself where no rows are turned.
  const DistributedVector &DualProblem::Face::turned(const DistributedVector          &x,
                                                     std::optional<DistributedVector> &copy) const
  {
    if (turns.empty())
      return x;
    copy.emplace(x);
    qp::turn(turns, *copy);
    return *copy;
  }

  // Half of what the compliance of rows and of turned ones does to M.
  void DualProblem::Face::soften(DistributedVector &x) const
  {
    for (std::size_t r = 0; r < problem.yielding.size(); ++r)
      x.local_element(r) *= problem.yielding[r];
    qp::turn(turns, x);
    for (std::size_t k = 0; k < turns.size(); ++k)
      x.local_element(turns[k].second) *= std::sqrt(stiffness[k]);
    qp::turn_back(turns, x);
  }
} // namespace slipstick::tfeti
