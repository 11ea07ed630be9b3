#include <slipstick/contact/contact_iterate.h>
#include <slipstick/contact/linear.h>
#include <slipstick/qp/box.h>
#include <slipstick/qp/types.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;
  }

  ContactIterate::ContactIterate(const tfeti::DualProblem   &dual_,
                                 const SlipLaw              &law_,
                                 const scene::SolverOptions &options_,
                                 const ProgressObserver     &observer_,
                                 const AccuracyTest         &is_accurate_)
    : dual(dual_)
    , law(law_)
    , options(options_)
    , observer(observer_)
    , is_accurate(is_accurate_)
  {}

  void ContactIterate::set_scales(const Vector &loads, const DualSolution *start)
  {
    forces_before = start ? start->largest_forces : 0.;
    tractions.emplace(dual, options.tolerance, loads.linfty_norm(), start ? start->largest_traction : 0.);
  }

  void ContactIterate::set_bounds(std::vector<double> bounds)
  {
    solution.slip_bound = std::move(bounds);
    box                 = multiplier_box(dual, solution.slip_bound);
  }

  qp::Observer ContactIterate::counted(const unsigned int before_step) const
  {
    return [this, before_step](qp::OuterStep step) {
      step.hessian_multiplications += solution.counts.hessian_multiplications + before_step;
      step.outer += solution.counts.outer_iterations;
      if (observer)
        observer({step, solution.friction_iterations});
    };
  }

  double ContactIterate::change_of_bounds(const std::vector<double> &next, const Vector &x) const
  {
    std::array<double, 2>     s{{0, 0}};
    const std::vector<double> size = sizes(x);
    for (unsigned int r = 0; r < next.size(); ++r)
      {
        const bool   is_inside = size[r] < std::min(next[r], solution.slip_bound[r]);
        const double change    = is_inside ? 0. : next[r] - solution.slip_bound[r];
        s[0] += change * change;
        s[1] += next[r] * next[r];
      }
    s = dual.reduction().sum(s);
    return s[0] == 0 ? 0. : s[1] > 0 ? std::sqrt(s[0] / s[1]) : 1.;
  }

  std::vector<double> ContactIterate::sizes(const Vector &x) const
  {
    std::vector<double> result(x.locally_owned_size());
    for (unsigned int r = 0; r < result.size(); ++r)
      result[r] = std::abs(x.local_element(r));
    for (const auto &point : dual.constraints().contact_points)
      if (point.second_row != tfeti::invalid_row && point.tangential_row != tfeti::invalid_row)
        result[point.tangential_row] = result[point.second_row] =
          std::hypot(result[point.tangential_row], result[point.second_row]);
    return result;
  }

  bool ContactIterate::accepts(const Vector &x, const Vector &g)
  {
    DualSolution iterate;
    iterate.multipliers = x;
    iterate.slip_bound  = law.depends_on_pressure() ? law.bounds(x) : solution.slip_bound;
    iterate.free.resize(x.locally_owned_size());
    const Box at    = multiplier_box(dual, iterate.slip_bound);
    Vector    jumps = g;
    qp::project(at, iterate.multipliers);
    for (unsigned int r = 0; r < iterate.free.size(); ++r)
      {
        const double y = iterate.multipliers.local_element(r), l = at.lower.local_element(r),
                     u         = at.upper.local_element(r);
        iterate.free[r]        = y > l && y < u;
        jumps.local_element(r) = dual.norm() * qp::projected_gradient(y, g.local_element(r), l, u);
      }
    return is_accurate(iterate, residual_energy(dual, jumps));
  }

  qp::Acceptance<Vector> ContactIterate::acceptance()
  {
    if (!is_accurate)
      return {};
    return [this](const Vector &x, const Vector &g) { return accepts(x, g); };
  }

  DualSolution ContactIterate::finished()
  {
    unsigned long long n     = 0;
    const double       noise = qp::force_rounding * solution.multipliers.linfty_norm();
    const auto         size  = sizes(solution.multipliers);
    solution.free.resize(solution.multipliers.locally_owned_size());
    for (unsigned int r = 0; r < solution.free.size(); ++r)
      {
        const double x   = solution.multipliers.local_element(r);
        solution.free[r] = x - box.lower.local_element(r) > noise && box.upper.local_element(r) - x > noise;
        if (law.has_discs() && dual.constraints().kind[r] == tfeti::RowKind::tangential)
          solution.free[r] = solution.slip_bound[r] - size[r] > noise;
        n += !solution.free[r];
      }
    solution.active_constraints = dealii::Utilities::MPI::sum(n, dual.communicator());
    solution.largest_forces     = std::max(forces_before, solution.multipliers.l2_norm());
    solution.largest_traction   = tractions->largest(solution.multipliers);
    return std::move(solution);
  }
} // namespace slipstick::contact
