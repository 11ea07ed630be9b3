// The discretised scene, and the checked solutions of its load steps.
#pragma once

#include <slipstick/app/step_problem.h>
#include <slipstick/app/step_state.h>
#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>
#include <slipstick/mechanics/stress.h>
#include <slipstick/output/convergence.h>
#include <slipstick/tfeti/recovery.h>

#include <memory>
#include <optional>
#include <vector>

namespace slipstick::app
{
  /// A recovered displacement, and what was found from it.
  struct StepAnswer
  {
    tfeti::Recovery                        recovery;
    std::optional<contact::CheckedContact> contact;
    std::optional<mechanics::StressResult> stress;
  };

  /// The solver of a scene: of the problem of every load step. Members are collective, except those that only return known values.
  template <int dim>
  class StepSolver
  {
  public:
    using Answer = StepAnswer;

    /// Makes the mesh, and finds the contact pairs that the scene leaves to a search.
    /// @param solves_adjoints are other problems to be solved with the same matrices afterwards?
    /// @param refinement of single cells, if any.
    /// @throws InputError for meshes and pairs that do not fit.
    StepSolver(const scene::Scene<dim> &scene,
               const Log               &log,
               StageClock              &clock,
               const MPI_Comm           comm,
               const bool               solves_adjoints = false,
               mesh::Refinement        *refinement      = nullptr);

    /// The dual problem of the first load step. @throws InputError, NoEquilibrium.
    void build();

    /// Solves the next load step, until the checks of its answer pass or cannot be improved any more.
    /// @param multiplications_before by F in the steps before.
    std::unique_ptr<Answer> solve(const unsigned int step, const std::uint64_t multiplications_before);

    /// In place of build(): as after load step @p step of an earlier run. @throws InputError where the state does not
    /// fit.
    void resume(const unsigned int step, const StepState &state);

    /// After a load step, for resume(). Not of the last step of a scene.
    StepState state() const;

    // see StepProblem
    const scene::Scene<dim> &discrete_scene() const
    {
      return problem.discrete_scene();
    }
    const mesh::Mesh<dim> &mesh() const
    {
      return problem.mesh();
    }
    const mechanics::Spaces<dim> &spaces() const
    {
      return problem.spaces();
    }
    const tfeti::DualProblem &dual() const
    {
      return problem.dual();
    }
    /// For problems with other loads on the same rows, after the last load step.
    tfeti::DualProblem &dual_for_adjoints()
    {
      return problem.dual();
    }
    const tfeti::HeldContacts &held_contacts() const
    {
      return problem.held_contacts();
    }
    unsigned int n_given_supports() const
    {
      return problem.n_given_supports();
    }
    const std::string &unheld() const
    {
      return problem.unheld();
    }
    double factorization_seconds() const
    {
      return problem.factorization_seconds();
    }
    std::vector<Eigen::VectorXd> elastic_part(const std::vector<Eigen::VectorXd> &u) const
    {
      return problem.elastic_part(u);
    }
    /// Of the step solved last.
    const contact::DualSolution &solution() const
    {
      return the_solution;
    }
    /// Forces and lengths of the bolts, after the step solved last.
    const mechanics::Tightening &tightening() const
    {
      return problem.tightening();
    }
    /// All steps so far.
    const std::vector<output::ConvergenceRow> &convergence() const
    {
      return rows;
    }

  private:
    /// Solves the step again, with bolts shortened by other amounts, until those that are tightened bear their forces.
    std::unique_ptr<Answer> tighten_bolts(const unsigned int      step,
                                          const std::uint64_t     multiplications_before,
                                          std::unique_ptr<Answer> answer);

    /// The displacement of the solution, whose status becomes stagnated where its rows do not hold the bodies though they may.
    /// @param bounds_follow the pressure?
    tfeti::Recovery recovered(bool bounds_follow);

    /// Computes checks and stresses of an answer that was recovered from @p from.
    void evaluate(Answer &answer, const contact::DualSolution &from, const double t) const;

    /// Is the algebraic error of an iterate a small part of its discretisation error, and does it pass the checks? The
    /// last estimate of the step, which errors of earlier iterates can only have made too large, is examined first; a
    /// displacement is recovered only if that does not decide.
    bool is_accurate(const contact::DualSolution &iterate, const double residual_energy, const double t);

    /// Solves the current step, adding rows for more contact nodes as long as pruned ones penetrate.
    /// @param goes_on from the solution of this step.
    std::unique_ptr<Answer> solve_step(const unsigned int  step,
                                       const std::uint64_t multiplications_before,
                                       const bool          goes_on);

    std::unique_ptr<Answer> checked(std::unique_ptr<Answer> answer, const double t) const;

    /// Continues from a solution whose checks fail, to smaller residuals: the tolerance is relative to |Pd|, which may
    /// be far above the corresponding part of the displacement (slender parts). Ends when this no longer helps.
    std::unique_ptr<Answer> tighten(const unsigned int      step,
                                    const std::uint64_t     multiplications_before,
                                    std::unique_ptr<Answer> answer);

    /// Corrects the displacement of an answer, on its set, until its checks are within the limit or stop decreasing.
    /// @return whether they are within the limit.
    bool close_gaps(Answer &answer, const unsigned int step, const double limit);

    const Log                          &log;
    StageClock                         &clock;
    const MPI_Comm                      comm;
    scene::SolverOptions                options;
    StepProblem<dim>                    problem;
    double                              discretization_error; // last estimate in the step [sqrt(N mm)]
    contact::DualSolution               the_solution;
    std::unique_ptr<Answer>             accepted; // by the test of accuracy, in the step
    std::vector<Eigen::VectorXd>        u;        // of the last step
    contact::History                    history;  // of the steps before
    std::vector<output::ConvergenceRow> rows;
  };
} // namespace slipstick::app
