#include <slipstick/base/exceptions.h>
#include <slipstick/qp/kernels.h>
#include <slipstick/tfeti/face.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cmath>

namespace slipstick::tfeti
{
  namespace
  {
    // Stiffness of a turned entry, relative to that without its compliance, below which M does not couple it.
    constexpr double least_carried = 0.1;

    // G x is zero up to rounding if it is below this part of |x|. If the rows of the face hardly resist a motion, a
    // single correction leaves more.
    constexpr double       rounding         = 1e-14;
    constexpr unsigned int most_corrections = 3;
  } // namespace

  Face DualProblem::face(const std::vector<bool>     &free,
                         const std::vector<qp::Tie>  &ties,
                         const std::vector<qp::Turn> &turns) const
  {
    return Face(*this, free, ties, turns);
  }

  Face::Face(const DualProblem           &problem_,
             const std::vector<bool>     &free_,
             const std::vector<qp::Tie>  &ties_,
             const std::vector<qp::Turn> &turns_)
    : problem(problem_)
    , metric(problem_.metric())
    , free(free_)
    , ties(ties_)
    , turns(turns_)
  {
    if (!problem.body_motions().free(free, BodyMotions::rounding_of_resistance, turns).empty())
      return;
    try
      {
        make_projectors();
      }
    catch (const NumericalError &) // the free rows leave a motion open up to rounding; the same on every rank
      {
        projector.reset();
        tied.reset();
        return;
      }
    if (!problem.preconditioner())
      return;
    std::vector<bool> carried = free;
    for (std::size_t k = 0; k < turns.size(); ++k)
      if (stiffness[k] < least_carried)
        carried[turns[k].second] = false;
    weights = std::make_unique<RowWeights::Inverse>(problem.preconditioner()->weights(), carried, turns);
  }

  void Face::make_projectors()
  {
    const std::vector<double>  softened = softened_weights();
    const std::vector<double> &of_rows  = turns.empty() ? metric.weights() : softened;
    const MPI_Comm             comm     = problem.communicator();
    projector = std::make_unique<Projector>(problem.projector(), free, comm, std::vector<qp::Tie>(), of_rows, turns);
    if (dealii::Utilities::MPI::max(ties.empty() ? 0 : 1, comm) > 0)
      {
        std::vector<bool> moving = free;
        for (const auto &tie : ties)
          moving[tie.tied] = true;
        tied = std::make_unique<Projector>(problem.projector(), moving, comm, ties, of_rows, turns);
      }
  }

  // A row with stiffness k and an additional compliance kappa has the stiffness 1/(kappa + 1/k). Empty without turned
  // rows.
  std::vector<double> Face::softened_weights()
  {
    if (turns.empty())
      return {};
    std::vector<double> result = metric.weights();
    for (const qp::Turn &turn : turns)
      {
        double part = 1;
        if (!result.empty())
          {
            part = 1 / (1 + turn.compliance * problem.norm() * metric.least() * result[turn.second]);
            result[turn.second] *= part;
          }
        stiffness.push_back(part);
      }
    return result;
  }

  void Face::multiply(const DistributedVector &x, DistributedVector &y) const
  {
    problem.multiply(x, y);
  }

  const std::vector<double> &Face::residual_weights() const
  {
    return problem.residual_weights();
  }

  const std::vector<double> *Face::dependent_compliances() const
  {
    return problem.dependent_compliances();
  }

  const MpiReduction &Face::reduction() const
  {
    return problem.reduction();
  }

  // Projects turned rows; a second time if the rounding of the first projection is significant.
  void Face::projected(const Projection project, const DistributedVector &x, DistributedVector &y) const
  {
    (*projector.*project)(x, y);
    if (!metric.is_wide())
      return;
    DistributedVector left(x), rest = problem.zero();
    left -= y;
    (*projector.*project)(left, rest);
    y += rest;
  }

  void Face::project_range(const DistributedVector &x, DistributedVector &y) const
  {
    std::optional<DistributedVector> copy;
    const DistributedVector         &at = turned(x, copy);
    projected(&Projector::project_range, at, y);
    for (unsigned int r = 0; r < free.size(); ++r)
      if (!free[r])
        y.local_element(r) = at.local_element(r);
    qp::turn_back(turns, y);
  }

  void Face::balance(DistributedVector &x) const
  {
    DistributedVector step = problem.zero();
    for (unsigned int pass = 0; pass < most_corrections; ++pass)
      {
        const Eigen::VectorXd missing = problem.e() - problem.projector().multiply(x);
        if (pass > 0 && is_rounding(missing, x))
          return;
        balancing().particular(missing, step);
        qp::turn_back(turns, step);
        x += step;
      }
  }

  void Face::project_kernel(DistributedVector &p) const
  {
    qp::turn(turns, p);
    for (const qp::Tie &tie : ties)
      p.local_element(tie.tied) = tie.factor * p.local_element(tie.to);
    DistributedVector range = problem.zero();
    for (unsigned int pass = 0; pass < most_corrections; ++pass)
      {
        const Eigen::VectorXd left = balancing().multiply(p);
        if (is_rounding(left, p))
          break;
        balancing().particular(left, range);
        p -= range;
      }
    qp::turn_back(turns, p);
  }

  bool Face::is_rounding(const Eigen::VectorXd &a, const DistributedVector &x) const
  {
    std::array<double, 2> squares{{a.squaredNorm(), qp::local_dot(x, x)}};
    squares = reduction().sum(squares);
    return squares[0] <= rounding * rounding * squares[1];
  }

  void Face::clear_held(DistributedVector &p) const
  {
    std::vector<bool> moves = free;
    for (const qp::Tie &tie : ties)
      moves[tie.tied] = true;
    qp::turn(turns, p);
    for (unsigned int r = 0; r < moves.size(); ++r)
      if (!moves[r])
        p.local_element(r) = 0;
    qp::turn_back(turns, p);
  }

  void Face::multiplier_shift(const DistributedVector &v, DistributedVector &y) const
  {
    std::optional<DistributedVector> copy;
    projected(&Projector::extend_range, turned(v, copy), y);
    qp::turn_back(turns, y);
  }

  void Face::precondition(const DistributedVector &r, DistributedVector &z) const
  {
    if (!weights)
      {
        z.copy_locally_owned_data_from(r);
        return;
      }
    const RowPreconditioner   &M                  = *problem.preconditioner();
    const std::vector<double> &compliance_factors = metric.compliance_factors();
    if (turns.empty() && compliance_factors.empty())
      M.apply(*weights, r, z);
    else
      {
        DistributedVector at(r);
        soften(at);
        M.apply(*weights, at, z);
        soften(z);
      }
    for (std::size_t row = 0; row < compliance_factors.size(); ++row) // their own stiffness also carries smooth loads
      z.local_element(row) += (1 - compliance_factors[row] * compliance_factors[row]) * metric.weights()[row] *
                              metric.least() * r.local_element(row);
    if (!turns.empty() && !metric.weights().empty())
      add_soft_entries(r, z);
    z *= problem.norm();
  }

  // Entries across a slipping force that are much softer than the bodies are not carried by them: M has their own
  // compliance, and no coupling to other entries.
  void Face::add_soft_entries(const DistributedVector &r, DistributedVector &z) const
  {
    DistributedVector at(r);
    qp::turn(turns, at);
    qp::turn(turns, z);
    for (std::size_t k = 0; k < turns.size(); ++k)
      if (const unsigned int row = turns[k].second; stiffness[k] < least_carried && free[row])
        z.local_element(row) = stiffness[k] * metric.weights()[row] * metric.least() * at.local_element(row);
    qp::turn_back(turns, z);
  }

  // Returns x itself if no rows are turned.
  const DistributedVector &Face::turned(const DistributedVector &x, std::optional<DistributedVector> &copy) const
  {
    if (turns.empty())
      return x;
    copy.emplace(x);
    qp::turn(turns, *copy);
    return *copy;
  }

  // Applies the square root of the effect that the compliances of rows and of turned rows have on M.
  void Face::soften(DistributedVector &x) const
  {
    const std::vector<double> &compliance_factors = metric.compliance_factors();
    for (std::size_t r = 0; r < compliance_factors.size(); ++r)
      x.local_element(r) *= compliance_factors[r];
    qp::turn(turns, x);
    for (std::size_t k = 0; k < turns.size(); ++k)
      x.local_element(turns[k].second) *= std::sqrt(stiffness[k]);
    qp::turn_back(turns, x);
  }

  double weighted_norm(const DualProblem &problem, const DistributedVector &r)
  {
    const double square = qp::local_weighted_dot(qp::residual_weights(problem, 0), r, r);
    return std::sqrt(problem.reduction().sum(std::array<double, 1>{{square}})[0]);
  }

  double residual_norm(const DualProblem &problem, const DistributedVector &r)
  {
    const Face all(problem, std::vector<bool>(r.locally_owned_size(), true));
    if (!all.is_regular())
      throw stiffnesses_too_far_apart();
    DistributedVector part(r), range = problem.zero();
    all.project_range(r, range);
    part -= range;
    const double norm = weighted_norm(problem, part);
    return norm <= rounding_of_projection * weighted_norm(problem, r) ? 0. : norm;
  }
} // namespace slipstick::tfeti
