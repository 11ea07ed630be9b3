#include <slipstick/contact/adjoint.h>
#include <slipstick/qp/pcpg.h>
#include <slipstick/tfeti/recovery.h>

namespace slipstick::contact
{
  namespace
  {
    // Residual over the right-hand side; error estimates need two digits.
    constexpr double tolerance = 1e-4;
  } // namespace

  Adjoint::Adjoint(tfeti::DualProblem &dual_, const std::vector<bool> &free_, const qp::PcpgOptions &options_)
    : dual(dual_)
    , free(free_)
    , options(options_)
    , face(dual.face(free))
  {}

  std::optional<Adjoint::Answer> Adjoint::solve(std::vector<Eigen::VectorXd> loads, std::vector<double> jumps)
  {
    dual.set_step(std::move(loads), std::move(jumps));
    auto x = dual.zero(), b = dual.zero(), range = dual.zero();
    face.balance(x);
    dual.multiply(x, b);
    b.sadd(-1., 1. / dual.norm(), dual.d());
    face.project_range(b, range);
    b -= range;
    const auto result = qp::pcpg(face,
                                 b,
                                 qp::PcpgStart<tfeti::DistributedVector>{dual.zero()},
                                 qp::Goal(tolerance, tfeti::residual_norm(dual, b)),
                                 options,
                                 [this](const auto &r, auto &z) { face.precondition(r, z); });
    if (result.status != qp::Status::converged)
      return {};
    work += result.counts;
    ++work.hessian_multiplications;
    x += result.x;
    auto recovery = tfeti::recover(dual, x, free);
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
