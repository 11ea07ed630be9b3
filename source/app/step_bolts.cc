// The part of the step solver that tightens bolts.
#include <slipstick/app/step_solver.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/mechanics/loads.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::app
{
  namespace
  {
    // Solves of one step for the tensions of its bolts; some five are needed.
    constexpr unsigned int max_attempts = 40;
    // Tensions are as accurate as the solver is asked to be, but never less than this.
    constexpr double largest_error = 1e-3;

    // Near the end, where the tension misses the wanted one by less than this many times what it may, an attempt that does not bring
    // it much nearer was ended by the solver too early: other loads are larger than the bolt's, and errors are measured by these.
    constexpr double near_the_end = 100, much_nearer = 0.5;
    // By how much the solver's tolerance falls then, down to the least one.
    constexpr double sharper = 0.1, sharpest = 1e-13;

    /// Part of the largest tension that is wanted.
    double miss(const std::vector<std::optional<double>> &wanted, const std::vector<double> &tensions)
    {
      double largest = 0, missing = 0;
      for (unsigned int k = 0; k < wanted.size(); ++k)
        if (wanted[k])
          {
            largest = std::max(largest, *wanted[k]);
            missing = std::max(missing, std::abs(*wanted[k] - tensions[k]));
          }
      return missing / largest;
    }

    std::string list_of(const std::vector<std::string> &names)
    {
      std::string text;
      for (const std::string &name : names)
        text += (text.empty() ? "" : "; ") + name;
      return text;
    }
  } // namespace

  template <int dim>
  std::vector<std::optional<double>> StepSolver<dim>::wanted_tensions(const double t) const
  {
    std::vector<std::optional<double>> wanted;
    for (const auto &bolt : scene.pretensions)
      {
        const double force = t <= bolt.tightened_until ? bolt.force.value(bolt.point, t) : 0.;
        wanted.push_back(force > 0 ? std::optional(force) : std::nullopt);
      }
    return wanted;
  }

  template <int dim>
  void StepSolver<dim>::reload(const double t)
  {
    clock.enter("assembly");
    the_dual->set_step(loads_at(t), the_dual->constraints().c);
  }

  template <int dim>
  std::unique_ptr<StepAnswer> StepSolver<dim>::tighten_bolts(const unsigned int      step,
                                                             const std::uint64_t     multiplications_before,
                                                             std::unique_ptr<Answer> answer)
  {
    const double                 t         = scene.load_factors[step];
    const double                 tolerance = std::min(scene.solver.tolerance, largest_error);
    const auto                   wanted    = wanted_tensions(t);
    double                       of_solver = scene.solver.tolerance, missed = std::numeric_limits<double>::max();
    std::vector<Eigen::VectorXd> thermal;
    if (!scene.temperatures.empty())
      {
        scene::Scene<dim> heat = scene;
        heat.tractions.clear();
        heat.body_forces.clear();
        heat.point_loads.clear();
        thermal = mechanics::assemble_loads(heat, *the_mesh, *the_spaces, t);
      }
    for (unsigned int attempt = 1;; ++attempt)
      {
        const auto               tensions = bolts->tensions(answer->recovery.u, bolts_so_far.shortening(), thermal);
        const bool               is_right = bolts_so_far.take(tensions, tolerance);
        std::vector<std::string> texts;
        for (unsigned int k = 0; k < tensions.size(); ++k)
          texts.push_back(format("%s %.6g N, shortened by %.6g mm",
                                 scene.pretensions[k].name.c_str(),
                                 tensions[k],
                                 bolts_so_far.shortening()[k]));
        log.line("bolts        " + list_of(texts));
        if (is_right || the_solution.status != qp::Status::converged)
          return answer;
        if (attempt == max_attempts)
          {
            log.warning("the bolts do not come to their forces");
            the_solution.status = qp::Status::iteration_limit;
            return answer;
          }
        const double misses = miss(wanted, tensions);
        if (misses < near_the_end * tolerance && misses > much_nearer * missed)
          of_solver = std::max(sharpest, sharper * of_solver);
        missed = misses;
        if (const auto longest = bolts_so_far.move())
          throw NoEquilibrium(
            format(
              "Pretension %s: shortened by the length of the bolt, it bears %.3g N in place of the force that is given",
              scene.pretensions[*longest].name.c_str(),
              tensions[*longest]),
            "let supports or contact hold both ends of the bolt against what it is to clamp");
        reload(t);
        options.tolerance        = of_solver;
        the_solution.multipliers = answer->recovery.multipliers;
        answer = tighten(step, multiplications_before, checked(solve_step(step, multiplications_before, true), t));
      }
  }

  template std::vector<std::optional<double>> StepSolver<2>::wanted_tensions(const double) const;
  template std::vector<std::optional<double>> StepSolver<3>::wanted_tensions(const double) const;
  template void                               StepSolver<2>::reload(const double);
  template void                               StepSolver<3>::reload(const double);
  template std::unique_ptr<StepAnswer>        StepSolver<2>::tighten_bolts(const unsigned int,
                                                                    const std::uint64_t,
                                                                    std::unique_ptr<StepAnswer>);
  template std::unique_ptr<StepAnswer>        StepSolver<3>::tighten_bolts(const unsigned int,
                                                                    const std::uint64_t,
                                                                    std::unique_ptr<StepAnswer>);
} // namespace slipstick::app
