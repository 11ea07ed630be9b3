#include <slipstick/contact/adjoint.h>
#include <slipstick/qp/face_solver.h>
#include <slipstick/tfeti/recovery.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    // Tolerance relative to the initial residual: with 1e-4 error bars differ by only about 1 % (decision 0124).
    constexpr double tolerance = 1e-2;
    // Residuals below this fraction of the numbers that are summed are rounding: the loads alone determine the forces.
    constexpr double rounding = 1e-12;
    // ... and so are residuals below this fraction that no step reduces.
    constexpr double rounding_that_stays = 1e-11;
    // The ties are satisfied to this fraction of what the solution without ties misses.
    constexpr double tolerance_of_ties = 0.03;
    // Steps of GMRES on the ties. Usually two to five suffice.
    constexpr unsigned int most_steps = 20;

    void add(std::vector<Eigen::VectorXd> &sum, const double factor, const std::vector<Eigen::VectorXd> &u)
    {
      for (std::size_t p = 0; p < sum.size(); ++p)
        sum[p] += factor * u[p];
    }

    std::vector<double> values(const Vector &of)
    {
      return {of.begin(), of.begin() + of.locally_owned_size()};
    }
  } // namespace

  std::vector<qp::Tie> following_friction(const SlipLaw &law, const DualSolution &solution)
  {
    std::vector<qp::Tie> ties;
    const auto          &x = solution.multipliers;
    for (const auto &[node, bound, slope] : law.slipping_nodes(x, solution.free))
      for (const std::size_t row : {node.tangential, node.second})
        if (row != qp::no_entry)
          ties.push_back({row, node.normal, slope * x.local_element(row) / bound});
    return ties;
  }

  Adjoint::Adjoint(tfeti::DualProblem      &dual_,
                   const std::vector<bool> &free_,
                   std::vector<qp::Tie>     ties_,
                   std::shared_ptr<Store>   directions)
    : dual(dual_)
    , free(free_)
    , ties(std::move(ties_))
    , has_ties(dealii::Utilities::MPI::max(ties.empty() ? 0 : 1, dual.communicator()) > 0)
    , store(directions ? std::move(directions) : std::make_shared<Store>(qp::NewtonOptions().n_directions))
    , face(dual.face(free))
  {}

  std::optional<Adjoint::Answer> Adjoint::solve(std::vector<Eigen::VectorXd> loads, const std::vector<double> &jumps)
  {
    auto answer = solve_untied(std::move(loads), jumps);
    if (!answer || !has_ties)
      return answer;
    // y, the changes of jumps on the rows with ties, satisfies (I + T) y = b: b is what the solution without ties
    // misses, T v what that of the jumps v has on the tied rows. GMRES, with one problem without ties a step.
    const Vector b    = of_ties(jumps, answer->u);
    const double size = b.l2_norm();
    if (!(size > 0))
      return answer;
    const std::vector<double> none(jumps.size(), 0.);
    std::vector<Vector>       basis{b};
    std::vector<Answer>       answers;
    Eigen::MatrixXd           products = Eigen::MatrixXd::Zero(most_steps + 1, most_steps);
    basis[0] /= size;
    for (unsigned int k = 0; k < most_steps; ++k)
      {
        auto of_step = solve_untied(no_loads(), values(basis[k]));
        if (!of_step)
          return {};
        Vector next = of_ties(none, of_step->u);
        next *= -1;
        next += basis[k];
        answers.push_back(std::move(*of_step));
        for (unsigned int pass = 0; pass < 2; ++pass)
          for (unsigned int i = 0; i <= k; ++i)
            {
              const double part = basis[i] * next;
              products(i, k) += part;
              next.add(-part, basis[i]);
            }
        products(k + 1, k)           = next.l2_norm();
        const Eigen::MatrixXd part   = products.topLeftCorner(k + 2, k + 1);
        const Eigen::VectorXd wanted = size * Eigen::VectorXd::Unit(k + 2, 0);
        const Eigen::VectorXd y      = part.colPivHouseholderQr().solve(wanted);
        if ((part * y - wanted).norm() <= tolerance_of_ties * size)
          {
            for (unsigned int i = 0; i <= k; ++i)
              {
                add(answer->u, y[i], answers[i].u);
                answer->multipliers.add(y[i], answers[i].multipliers);
              }
            return answer;
          }
        if (!(products(k + 1, k) > rounding))
          break;
        next /= products(k + 1, k);
        basis.push_back(std::move(next));
      }
    return {};
  }

  Vector Adjoint::of_ties(const std::vector<double> &jumps, const std::vector<Eigen::VectorXd> &u) const
  {
    const auto jump   = dual.dual_operator().jumps(u);
    auto       result = dual.zero();
    for (const auto &tie : ties)
      result.local_element(tie.to) += tie.factor * (jumps[tie.tied] - jump.local_element(tie.tied));
    return result;
  }

  std::vector<Eigen::VectorXd> Adjoint::no_loads() const
  {
    std::vector<Eigen::VectorXd> loads;
    for (const auto &system : dual.subdomains())
      loads.push_back(Eigen::VectorXd::Zero(system->n_unknowns()));
    return loads;
  }

  std::optional<Adjoint::Answer> Adjoint::solve_untied(std::vector<Eigen::VectorXd> loads, std::vector<double> jumps)
  {
    auto of_jumps = dual.zero();
    for (std::size_t r = 0; r < jumps.size(); ++r)
      of_jumps.local_element(r) = jumps[r] / dual.norm();
    dual.set_step(std::move(loads), std::move(jumps));
    auto x = dual.zero(), product = dual.zero(), d = dual.d();
    d /= dual.norm();
    face.balance(x);
    dual.multiply(x, product);
    const auto held = [this](const Vector &p) { // directions of other faces may move rows that are held in this one
      std::vector<double> moved;
      for (std::size_t r = 0; r < free.size(); ++r)
        if (!free[r])
          moved.push_back(p.local_element(r));
      return moved;
    };
    const qp::FaceSolverOptions         options;
    qp::FaceSolver<Vector, tfeti::Face> solver(face, d, *store, held, options);
    const double                        summed   = of_jumps.l2_norm() + d.l2_norm() + product.l2_norm();
    const double                        residual = solver.start(std::move(x), std::move(product));
    auto result = solver.solve_symmetric(std::max(tolerance * residual, rounding * summed));
    work += result.counts;
    ++work.hessian_multiplications;
    if (result.status != qp::Status::converged && !(result.residual <= rounding_that_stays * summed))
      return {};
    auto recovery = tfeti::recover(dual, result.x, free);
    return Answer{std::move(recovery.u), std::move(recovery.multipliers)};
  }

  std::optional<Adjoint::Answer> Adjoint::solve(const std::vector<double> &jumps)
  {
    return solve(no_loads(), jumps);
  }
} // namespace slipstick::contact
