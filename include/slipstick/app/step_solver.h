// The discretised scene, and the checked solutions of its load steps.
#pragma once

#include <slipstick/app/step_problem.h>
#include <slipstick/app/step_state.h>
#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>
#include <slipstick/contact/other_mesh.h>
#include <slipstick/mechanics/stress.h>
#include <slipstick/output/convergence.h>
#include <slipstick/tfeti/recovery.h>

#include <memory>
#include <optional>
#include <vector>

namespace slipstick::app
{
  /// A recovered displacement with the results computed from it.
  struct StepSolution
  {
    tfeti::Recovery                        recovery;
    std::optional<contact::CheckedContact> contact;
    std::optional<mechanics::StressResult> stress;
  };

  /// Solves the load steps of a scene. Members are collective, except those that only return known values.
  template <int dim>
  class StepSolver
  {
  public:
    /// Generates the mesh, and finds the contact pairs if the scene requests an automatic search.
    /// @param solves_adjoints whether other problems will be solved with the same matrices afterwards.
    /// @param refinement local refinement, if any.
    /// @throws InputError for inconsistent meshes and pairs.
    StepSolver(const scene::Scene<dim> &scene,
               const Log               &log,
               StageClock              &clock,
               const MPI_Comm           comm,
               const bool               solves_adjoints = false,
               mesh::Refinement        *refinement      = nullptr);

    /// Builds the dual problem of the first load step. @throws InputError, NoEquilibrium.
    void build();

    void assume_undriven() // see StepProblem
    {
      problem.assume_undriven();
    }

    /// The first load step will begin from the contact on another mesh.
    void start_from(contact::ContactOfMesh other);

    /// Solves the next load step, until the checks of its solution pass or cannot be improved any further.
    /// @param multiplications_before multiplications by F in the previous steps.
    std::unique_ptr<StepSolution> solve(const unsigned int step, const std::uint64_t multiplications_before);

    /// Replaces build(): restores the state after a load step of an earlier run. @throws InputError if the state
    /// does not fit.
    void resume(const StepState &state);

    /// The state after a load step, for resume(). Not available for the last step of a scene.
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
    /// The dual problem, for other loads on the same rows after the last load step.
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
    /// What holds these motions: resultant, and size [N].
    Resultant still_forces() const
    {
      return problem.still_forces();
    }
    double still_load() const
    {
      return problem.still_load();
    }
    double factorization_seconds() const
    {
      return problem.factorization_seconds();
    }
    std::vector<Eigen::VectorXd> elastic_part(const std::vector<Eigen::VectorXd> &u) const
    {
      return problem.elastic_part(u);
    }
    /// Solution of the last step.
    const contact::DualSolution &solution() const
    {
      return dual_solution;
    }
    /// Forces and shortenings of the bolts after the last step.
    const mechanics::Tightening &tightening() const
    {
      return problem.tightening();
    }
    /// Rows of all steps so far.
    const std::vector<output::ConvergenceRow> &convergence() const
    {
      return rows;
    }

  private:
    /// Repeats the step with different shortenings of the bolts until the prescribed bolt forces are reached.
    std::unique_ptr<StepSolution> tighten_bolts(const unsigned int            step,
                                                const std::uint64_t           multiplications_before,
                                                std::unique_ptr<StepSolution> answer);

    /// Repeats the step until auxiliary supports bear nothing.
    std::unique_ptr<StepSolution> balance_still_motions(const unsigned int            step,
                                                        const std::uint64_t           multiplications_before,
                                                        std::unique_ptr<StepSolution> answer);

    /// Recovers the displacement of the solution. Its status becomes `stagnated` if its rows do not hold the bodies
    /// although others may.
    /// @param bounds_follow whether bounds follow the pressure.
    tfeti::Recovery recovered(bool bounds_follow);
    void            take_out_still_motions(StepSolution &answer, const double t);

    /// Displacements and forces from which the next load step starts. With friction they are corrected on the active
    /// set of the solution: nodes that neither stick firmly nor slip, as after a reversal of the load, would otherwise
    /// begin the next step with slips that are only the error of this one (decision 0134).
    void keep_for_next_step(const tfeti::Recovery &recovery, const double t);

    /// Computes checks and stresses of a solution recovered from @p from.
    void evaluate(StepSolution &answer, const contact::DualSolution &from, const double t) const;

    /// Whether the algebraic error of an iterate is a small part of its discretisation error, and the iterate passes
    /// the checks. The last estimate of the step, which errors of earlier iterates can only have increased, is tested
    /// first; a displacement is recovered only if this test is inconclusive.
    bool is_accurate(const contact::DualSolution &iterate, const double residual_energy, const double t);

    /// Takes the problem to the next load step. @return whether the multipliers of the last one are a start.
    bool advance(const double t);

    /// Solves the current step, adding rows for more contact nodes as long as pruned ones penetrate.
    /// @param continues whether to start from the present solution of this step.
    std::unique_ptr<StepSolution> solve_step(const unsigned int  step,
                                             const std::uint64_t multiplications_before,
                                             const bool          continues);

    std::unique_ptr<StepSolution> checked(std::unique_ptr<StepSolution> answer, const double t) const;

    /// Continues to smaller residuals from a solution whose checks fail (the tolerance is relative to |Pd|, which may be
    /// far above the corresponding part of the displacement of slender parts), or whose tractions have a large estimated
    /// error (small forces may decide what sticks and slips). Ends when this no longer helps.
    std::unique_ptr<StepSolution> continue_to_smaller_residual(const unsigned int            step,
                                                               const std::uint64_t           multiplications_before,
                                                               std::unique_ptr<StepSolution> answer);

    /// Corrects the displacement of a solution, with its active set, until its checks are within the limit or stop
    /// decreasing.
    /// @return whether they are within the limit.
    bool close_gaps(StepSolution &answer, const unsigned int step, const double limit);

    const Log                          &log;
    StageClock                         &clock;
    const MPI_Comm                      comm;
    scene::SolverOptions                options;
    StepProblem<dim>                    problem;
    double                              discretization_error; // last estimate in this step [sqrt(N mm)]
    contact::DualSolution               dual_solution;
    contact::ContactOfMesh              other_mesh; // without nodes: none
    std::unique_ptr<StepSolution>       accepted;   // by the accuracy test in this step
    std::vector<Eigen::VectorXd>        u;          // of the last step
    contact::History                    history;    // of the previous steps
    std::vector<output::ConvergenceRow> rows;
  };
} // namespace slipstick::app
