#include <slipstick/contact/linear.h>
#include <slipstick/contact/traction_error.h>
#include <slipstick/qp/pcpg.h>
#include <slipstick/tfeti/diagnosis.h>
#include <slipstick/tfeti/face.h>

#include <cmath>
#include <optional>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    // With an accuracy test, linear problems are solved in stages, each to this fraction of the previous residual ...
    constexpr double part_of_residual = 0.3;
    // ... starting with this residual.
    constexpr double first_asked = 0.1;
  } // namespace

  tfeti::DistributedVector homogenised_load(const tfeti::DualProblem &dual, const tfeti::DistributedVector &start)
  {
    Vector b = dual.zero(), q = dual.zero();
    dual.multiply(start, b);
    const double of_forces = tfeti::weighted_norm(dual, b);
    b.sadd(-1., 1. / dual.norm(), dual.d());
    const double all = std::hypot(of_forces, tfeti::weighted_norm(dual, b));
    dual.project_range(b, q);
    b -= q;
    if (tfeti::weighted_norm(dual, b) <= tfeti::rounding_of_projection * all)
      b = 0.;
    return b;
  }

  double residual_energy(const tfeti::DualProblem &dual, const Vector &r)
  {
    std::vector<bool> held(r.locally_owned_size());
    for (unsigned int i = 0; i < held.size(); ++i)
      held[i] = tfeti::is_equality(dual.constraints().kind[i]) || r.local_element(i) != 0;
    return std::sqrt(tfeti::jump_energies(dual, r, held).of_body.sum());
  }

  namespace
  {
    /// With an accuracy test or tractions to judge, the problem is solved in stages, each with the directions of the
    /// earlier ones.
    class LinearSolver
    {
    public:
      LinearSolver(const tfeti::DualProblem   &dual_,
                   const scene::SolverOptions &options_,
                   const ProgressObserver     &observer_,
                   const DualSolution         *previous_,
                   const AccuracyTest         &is_accurate_)
        : dual(dual_)
        , options(options_)
        , observer(observer_)
        , previous(previous_)
        , is_accurate(is_accurate_)
        , face(dual_.face(std::vector<bool>(dual_.zero().locally_owned_size(), true)))
        , is_preconditioned(dual_.preconditioner() != nullptr)
        , pcpg(options_.pcpg)
        , reorthogonalizes(is_preconditioned)
        , start(dual_.particular())
        , from{dual_.zero()}
      {}

      DualSolution operator()()
      {
        solution.free             = std::vector<bool>(start.locally_owned_size(), true);
        solution.slip_bound       = std::vector<double>(start.locally_owned_size(), 0.);
        solution.algorithm        = scene::Algorithm::pcg;
        solution.largest_traction = previous ? previous->largest_traction : 0.;
        b                         = homogenised_load(dual, start);
        ++solution.counts.hessian_multiplications;
        reference = tfeti::residual_norm(dual, b);
        if (reference > 0)
          solve();
        else // no deformation
          {
            solution.multipliers = start;
            solution.status      = qp::Status::converged;
          }
        return std::move(solution);
      }

    private:
      void solve()
      {
        if (previous) // continue from the true residual instead of the recursion of an earlier solve
          {
            start = previous->multipliers;
            face.balance(start);
            b = homogenised_load(dual, start);
            ++solution.counts.hessian_multiplications;
          }
        tractions.emplace(dual, options.tolerance, start.linfty_norm(), solution.largest_traction);
        if (is_accurate || tractions->has_pairs())
          from.history = std::make_shared<qp::DirectionHistory<Vector>>(is_preconditioned);
        bool has_met_goal = false;
        for (double tolerance = is_accurate ? std::max(first_asked, options.tolerance) : options.tolerance;;
             tolerance        = std::max(has_met_goal ? 0. : options.tolerance, part_of_residual * tolerance))
          {
                   auto result = stage(tolerance);
                   if (has_met_goal &&
                result.status != qp::Status::converged) // the point that met the goal is at rounding level
              break;
                   solution.status             = result.status;
                   solution.projected_gradient = result.relative_residual;
                   solution.multipliers        = start;
                   solution.multipliers += result.x;
                   if (result.status == qp::Status::stagnated && !reorthogonalizes)
              { // rounding has destroyed the conjugacy of the directions
                reorthogonalizes         = true;
                pcpg.reorthogonalization = qp::Reorthogonalization::full;
                from                     = {std::move(result.x)};
                tolerance /= part_of_residual; // repeat the stage
                continue;
              }
            if (result.status != qp::Status::converged)
              break;
            has_met_goal = tolerance <= options.tolerance;
                   if (has_met_goal ? is_right(result.residual, tolerance) : is_accurate_enough(result.residual))
              break;
            from.x       = std::move(result.x);
                   from.product = std::move(result.product);
          }
        solution.counts.outer_iterations = 1;
        solution.largest_traction        = tractions->largest(solution.multipliers);
      }

      qp::PcpgResult<Vector> stage(const double tolerance)
      {
        const auto         before  = solution.counts;
        const qp::Observer counted = [&](qp::OuterStep step) {
          step.hessian_multiplications += before.hessian_multiplications;
          step.outer += before.cg_steps;
          if (observer)
            observer({step, 0});
        };
        const auto     precondition = [this](const Vector &r, Vector &z) { face.precondition(r, z); };
        const qp::Goal goal(tolerance, reference);
        auto           result = is_preconditioned ? qp::pcpg(face, b, from, goal, pcpg, precondition, counted)
                                                  : qp::pcpg(face, b, from, goal, pcpg, qp::NoPreconditioner(), counted);
        solution.counts += result.counts;
        return result;
      }

      /// Whether tractions are accurate where the tolerance is met, or cannot become so.
      bool is_right(const Vector &residual, const double tolerance)
      {
        if (!tractions->has_pairs() || tolerance <= options.newton.least_part * options.tolerance)
          return true;
        Vector error = dual.zero();
        face.precondition(residual, error);
        ++solution.counts.preconditioner_applications;
        face.project_kernel(error);
        return tractions->accepts(solution.multipliers, error);
      }

      bool is_accurate_enough(Vector &residual) const
      {
        residual *= dual.norm();
        return is_accurate(solution, residual_energy(dual, residual));
      }

      const tfeti::DualProblem   &dual;
      const scene::SolverOptions &options;
      const ProgressObserver     &observer;
      const DualSolution         *previous;
      const AccuracyTest         &is_accurate;
      const tfeti::Face           face;
      const bool                  is_preconditioned;
      qp::PcpgOptions             pcpg;
      bool                        reorthogonalizes;
      Vector                      start, b;
      double                      reference = 0;
      qp::PcpgStart<Vector>       from;
      std::optional<TractionTest> tractions;
      DualSolution                solution;
    };
  } // namespace

  DualSolution solve_linear(const tfeti::DualProblem   &dual,
                            const scene::SolverOptions &options,
                            const ProgressObserver     &observer,
                            const DualSolution         *previous,
                            const AccuracyTest         &is_accurate)
  {
    return LinearSolver(dual, options, observer, previous, is_accurate)();
  }
} // namespace slipstick::contact
