#include <slipstick/contact/adjoint.h>
#include <slipstick/qp/face_solver.h>
#include <slipstick/tfeti/recovery.h>

#include <algorithm>

namespace slipstick::contact
{
  namespace
  {
    // Tolerance relative to the initial residual: with 1e-4 error bars differ by only about 1 % (decision 0124).
    constexpr double tolerance = 1e-2;
    // Residuals below this fraction of the numbers that are summed are rounding: the loads alone determine the forces.
    constexpr double rounding = 1e-12;
  } // namespace

  Adjoint::Adjoint(tfeti::DualProblem &dual_, const std::vector<bool> &free_, std::shared_ptr<Store> directions)
    : dual(dual_)
    , free(free_)
    , store(directions ? std::move(directions) : std::make_shared<Store>(qp::NewtonOptions().n_directions))
    , face(dual.face(free))
  {}

  std::optional<Adjoint::Answer> Adjoint::solve(std::vector<Eigen::VectorXd> loads, std::vector<double> jumps)
  {
    using Vector  = tfeti::DistributedVector;
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
    if (result.status != qp::Status::converged)
      return {};
    work += result.counts;
    ++work.hessian_multiplications;
    auto recovery = tfeti::recover(dual, result.x, free);
    return Answer{std::move(recovery.u), std::move(recovery.multipliers)};
  }

  std::optional<Adjoint::Answer> Adjoint::solve(std::vector<double> jumps)
  {
    std::vector<Eigen::VectorXd> loads;
    for (const auto &system : dual.subdomains())
      loads.push_back(Eigen::VectorXd::Zero(system->n_unknowns()));
    return solve(std::move(loads), std::move(jumps));
  }
} // namespace slipstick::contact
