// Tightening of bolts, a part of the step solver.
#include <slipstick/app/step_solver.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/mechanics/loads.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace slipstick::app
{
  namespace
  {
    // Maximum number of solves of one step to reach the tensions of its bolts; about five are needed.
    constexpr unsigned int max_attempts = 40;
    // Relative error of tensions: the tolerance of the solver, but at most this.
    constexpr double largest_error = 1e-3;

    // Near convergence, where the error of the tension is less than the first multiple of the admissible one, an
    // attempt that does not reduce the error by the second factor was stopped too early by the solver: other loads are
    // larger than the bolt's, and the solver's tolerance is relative to these loads.
    constexpr double near_the_end = 100, much_nearer = 0.5;
    // Factor by which the tolerance of the solver is then reduced, and its lower limit.
    constexpr double sharper = 0.1, sharpest = 1e-13;

    // Loads and gaps are multiples of others up to this relative difference.
    constexpr double difference_of_multiples = 1e-8;

    /// Loads, gaps and supports, as they enter the dual problem.
    struct DualData
    {
      explicit DualData(const tfeti::DualProblem &dual)
        : d(dual.d())
        , e(dual.e())
      {}
      tfeti::DistributedVector d; // [mm]
      Eigen::VectorXd          e; // [N], [N mm], of this rank's subdomains
    };

    /// The factor by which @p before must be multiplied to give the data of @p dual, if there is one. Collective.
    std::optional<double> multiple(const DualData &before, const tfeti::DualProblem &dual)
    {
      const auto   sum = [&dual](const double part) { return dealii::Utilities::MPI::sum(part, dual.communicator()); };
      const double squares = before.d.norm_sqr();
      if (squares == 0)
        return {};
      const double factor = dual.d() * before.d / squares;
      auto         rest   = before.d;
      rest.sadd(-factor, 1., dual.d());
      double total = 0; // sum of the loads if they did not balance each other
      for (const auto &system : dual.subdomains())
        total += (system->kernel().cwiseAbs().transpose() * system->load().cwiseAbs()).squaredNorm();
      const bool fits =
        rest.l2_norm() <= difference_of_multiples * dual.d().l2_norm() &&
        sum((dual.e() - factor * before.e).squaredNorm()) <= std::pow(difference_of_multiples, 2) * sum(total);
      return fits ? std::optional<double>(factor) : std::nullopt;
    }
  } // namespace

  template <int dim>
  std::unique_ptr<StepSolution> StepSolver<dim>::tighten_bolts(const unsigned int            step,
                                                               const std::uint64_t           multiplications_before,
                                                               std::unique_ptr<StepSolution> answer)
  {
    const auto                  &scene     = discrete_scene();
    auto                        &so_far    = problem.tightening();
    const double                 t         = scene.load_factors[step];
    const double                 tolerance = std::min(scene.solver.tolerance, largest_error);
    double                       of_solver = scene.solver.tolerance, missed = std::numeric_limits<double>::max();
    std::vector<Eigen::VectorXd> thermal;
    if (!scene.temperatures.empty())
      {
        scene::Scene<dim> heat = scene;
        heat.tractions.clear();
        heat.body_forces.clear();
        heat.point_loads.clear();
        thermal = mechanics::assemble_loads(heat, mesh(), spaces(), t);
      }
    for (unsigned int attempt = 1;; ++attempt)
      {
        const auto  tensions = problem.bolts()->tensions(answer->recovery.u, so_far.shortening(), thermal);
        const bool  is_right = so_far.take(tensions, tolerance);
        std::string text;
        for (unsigned int k = 0; k < tensions.size(); ++k)
          text += format("%s%s %.6g N, shortened by %.6g mm",
                         k == 0 ? "" : "; ",
                         scene.pretensions[k].name.c_str(),
                         tensions[k],
                         so_far.shortening()[k]);
        log.line("bolts        " + text);
        if (is_right || dual_solution.status != qp::Status::converged)
          return answer;
        if (attempt == max_attempts)
          {
            log.warning("the bolts do not reach their prescribed forces");
            dual_solution.status = qp::Status::iteration_limit;
            return answer;
          }
        const double misses = so_far.miss();
        if (misses < near_the_end * tolerance && misses > much_nearer * missed)
          of_solver = std::max(sharpest, sharper * of_solver);
        missed = misses;
        if (const auto longest = so_far.move())
          throw NoEquilibrium(
            format(
              "Pretension %s: shortened by the length of the bolt, it carries %.3g N instead of the prescribed force",
              scene.pretensions[*longest].name.c_str(),
              tensions[*longest]),
            "let supports or contact hold both ends of the bolt against the clamped parts");
        if (so_far.are_vague())
          of_solver = std::max(sharpest, sharper * of_solver);
        const DualData before(dual());
        problem.reload(t);
        options.tolerance         = of_solver;
        dual_solution.multipliers = answer->recovery.multipliers;
        if (const auto factor = multiple(before, dual())) // only bolts load the bodies: the solution is a multiple, too
          {
            dual_solution.multipliers *= *factor;
            if (dual_solution.gradient)
              *dual_solution.gradient *= *factor;
          }
        answer = continue_to_smaller_residual(step,
                                              multiplications_before,
                                              checked(solve_step(step, multiplications_before, true), t));
      }
  }

  template std::unique_ptr<StepSolution> StepSolver<2>::tighten_bolts(const unsigned int,
                                                                      const std::uint64_t,
                                                                      std::unique_ptr<StepSolution>);
  template std::unique_ptr<StepSolution> StepSolver<3>::tighten_bolts(const unsigned int,
                                                                      const std::uint64_t,
                                                                      std::unique_ptr<StepSolution>);
} // namespace slipstick::app
