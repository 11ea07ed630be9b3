#include <slipstick/tfeti/dual_problem.h>

#include <deal.II/base/mpi.h>

namespace slipstick::tfeti
{
  DualProblem::Face DualProblem::face(const std::vector<bool> &free, const std::vector<qp::Tie> &ties) const
  {
    return Face(*this, free, ties);
  }

  double DualProblem::jump_energy(const DistributedVector &r, const std::vector<bool> &held) const
  {
    const std::unique_ptr<RowWeights> own_weights =
      weights ? nullptr : std::make_unique<RowWeights>(systems, gluing, rows.rows, comm);
    const RowWeights::Inverse inverse(weights ? *weights : *own_weights, held);
    DistributedVector         weighted = zero(), source = F->ghosted();
    inverse.apply(r, weighted);
    F->import(weighted, source);
    double          energy = 0;
    Eigen::VectorXd force;
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        const Eigen::VectorXd move = F->scatter(p, source).cwiseQuotient(systems[p]->touched_diagonal());
        if (preconditioner)
          {
            preconditioner->apply(p, move, force);
            energy += move.dot(force);
            continue;
          }
        const auto     &touched = systems[p]->touched();
        Eigen::VectorXd u       = Eigen::VectorXd::Zero(systems[p]->n_unknowns());
        for (unsigned int k = 0; k < touched.size(); ++k)
          u[touched[k]] = move[k];
        energy += u.dot(systems[p]->apply_stiffness(u));
      }
    return reduce.sum(std::array<double, 1>{{energy}})[0];
  }

  DualProblem::Face::Face(const DualProblem          &problem_,
                          const std::vector<bool>    &free_,
                          const std::vector<qp::Tie> &ties_)
    : problem(problem_)
    , free(free_)
    , ties(ties_)
    , source(problem.rows.rows)
    , target(problem.rows.rows)
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
    if (problem.weights)
      {
        weights = std::make_unique<RowWeights::Inverse>(*problem.weights, free);
        for (const auto &system : problem.systems)
          inverse_diagonals.push_back(system->touched_diagonal().cwiseInverse());
      }
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

  void DualProblem::Face::project_range(const DistributedVector &x, DistributedVector &y) const
  {
    projector->project_range(x, y);
    if (problem.projects_twice)
      {
        DistributedVector left(x), rest = problem.zero();
        left -= y;
        projector->project_range(left, rest);
        y += rest;
      }
    for (unsigned int r = 0; r < free.size(); ++r)
      if (!free[r])
        y.local_element(r) = x.local_element(r);
  }

  void DualProblem::Face::balance(DistributedVector &x) const
  {
    DistributedVector step = problem.zero();
    for (unsigned int pass = 0; pass < (problem.projects_twice ? 2 : 1); ++pass)
      {
        balancing().particular(problem.resultants() - problem.projector->multiply(x), step);
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
    projector->extend_range(v, y);
    if (problem.projects_twice)
      {
        DistributedVector left(v), rest = problem.zero();
        left -= y;
        projector->extend_range(left, rest);
        y += rest;
      }
  }

  void DualProblem::Face::precondition(const DistributedVector &r, DistributedVector &z) const
  {
    if (!weights)
      {
        z.copy_locally_owned_data_from(r);
        return;
      }
    DistributedVector weighted = problem.zero();
    weights->apply(r, weighted);
    problem.F->import(weighted, source);
    target.zero_out_ghost_values();
    target = 0;
    Eigen::VectorXd force;
    for (unsigned int p = 0; p < problem.systems.size(); ++p)
      {
        const Eigen::VectorXd jump = inverse_diagonals[p].cwiseProduct(problem.F->scatter(p, source));
        problem.preconditioner->apply(p, jump, force);
        problem.F->gather(p, inverse_diagonals[p].cwiseProduct(force), target);
      }
    target.compress(dealii::VectorOperation::add);
    weighted.copy_locally_owned_data_from(target);
    weights->apply(weighted, z);
    z *= problem.norm();
  }
} // namespace slipstick::tfeti
