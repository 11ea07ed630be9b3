// The discretised scene, and the checked solutions of its load steps.
#pragma once

#include <slipstick/app/step_state.h>
#include <slipstick/base/log.h>
#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>
#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/bolts.h>
#include <slipstick/mechanics/stress.h>
#include <slipstick/mechanics/tightening.h>
#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/output/convergence.h>
#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/dual_problem.h>

#include <memory>
#include <optional>
#include <vector>

namespace slipstick::app
{
  /// A recovered displacement, and what was found from it.
  struct StepAnswer
  {
    tfeti::DualProblem::Recovery           recovery;
    std::optional<contact::CheckedContact> contact;
    std::optional<mechanics::StressResult> stress;
  };

  /// Mesh, dual problem and solver of a scene. Members are collective, except those that only return known values.
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

    /// With the contact pairs that were found.
    const scene::Scene<dim> &discrete_scene() const
    {
      return scene;
    }
    const mesh::Mesh<dim> &mesh() const
    {
      return *the_mesh;
    }
    const mechanics::Spaces<dim> &spaces() const
    {
      return *the_spaces;
    }
    const tfeti::DualProblem &dual() const
    {
      return *the_dual;
    }
    /// For problems with other loads on the same rows, after the last load step.
    tfeti::DualProblem &dual_for_adjoints()
    {
      return *the_dual;
    }
    /// Contact nodes of this rank whose gap supports prescribe.
    const tfeti::HeldContacts &held_contacts() const
    {
      return held;
    }
    /// Number of supports in the scene as given; supports after these hold motions that nothing else holds.
    unsigned int n_given_supports() const
    {
      return n_given;
    }
    /// Motions that nothing holds and no load drives, in words (empty: none); they are set to zero.
    const std::string &unheld() const
    {
      return unheld_motions;
    }
    /// Of the step solved last.
    const contact::DualSolution &solution() const
    {
      return the_solution;
    }
    /// Forces and lengths of the bolts, after the step solved last.
    const mechanics::Tightening &tightening() const
    {
      return bolts_so_far;
    }
    /// What of a displacement strains the bodies: all but what bolts are shortened by.
    std::vector<Eigen::VectorXd> elastic_part(const std::vector<Eigen::VectorXd> &u) const
    {
      return bolts ? bolts->elastic_part(u, bolts_so_far.shortening()) : u;
    }
    /// All steps so far.
    const std::vector<output::ConvergenceRow> &convergence() const
    {
      return rows;
    }
    /// Time of all factorisations [s].
    double factorization_seconds() const
    {
      return factorization;
    }

  private:
    /// K_p, B, F at load factor t, without the rows of pruned contact nodes unless a body is held by them.
    void build_dual(const double t);
    void make_dual(const double t);
    void make_dual_as_it_is(const double t);

    /// Of this rank's subdomains, bolts included, without rounding.
    std::vector<Eigen::VectorXd> loads_at(const double t);

    /// Solves the step again, with bolts shortened by other amounts, until those that are tightened bear their forces.
    std::unique_ptr<Answer> tighten_bolts(const unsigned int      step,
                                          const std::uint64_t     multiplications_before,
                                          std::unique_ptr<Answer> answer);

    /// The tensions that the scene gives at load factor t.
    std::vector<std::optional<double>> wanted_tensions(const double t) const;

    /// The loads of the present step once more, with bolts as they are now.
    void reload(const double t);

    /// Sets loads of this rank's subdomains to zero if they are only rounding compared with those of earlier steps.
    void drop_rounding(std::vector<Eigen::VectorXd> &loads);

    /// The contact rows at load factor t, except pruned ones.
    interface::ContactRows contact_rows(const double t);

    /// Loads and right-hand sides of a later step; slip starts where the previous step ended.
    /// @return whether the multipliers of the previous step fit the rows.
    bool advance(const double t);

    /// Slip is measured from the displacement at the end of the previous step.
    void start_slip_from_here();

    /// The displacement of the solution.
    tfeti::DualProblem::Recovery recovered() const;

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

    scene::Scene<dim>    scene;
    const Log           &log;
    StageClock          &clock;
    const MPI_Comm       comm;
    scene::SolverOptions options;

    // the same in all load steps
    std::optional<interface::BodyContacts<dim>> contacts;
    std::shared_ptr<tfeti::Subdomains>          subdomains;
    std::optional<mechanics::Bolts<dim>>        bolts; // if the scene has any

    std::unique_ptr<mesh::Mesh<dim>>        the_mesh;
    std::unique_ptr<mechanics::Spaces<dim>> the_spaces;
    std::unique_ptr<tfeti::DualProblem>     the_dual;
    tfeti::Constraints                      pruned;  // normal rows of the contact nodes without multipliers
    tfeti::HeldContacts                     held;    // contact nodes whose gap supports prescribe
    unsigned int                            n_given; // supports
    std::string                             unheld_motions;
    double                                  kept_part;
    double                                  largest_load  = 0;    // of the steps so far [N]
    double                                  factorization = 0;    // [s]
    double                                  discretization_error; // last estimate in the step [sqrt(N mm)]
    contact::DualSolution                   the_solution;
    std::unique_ptr<Answer>                 accepted; // by the test of accuracy, in the step
    std::vector<Eigen::VectorXd>            u;        // of the last step
    contact::History                        history;  // of the steps before
    mechanics::Tightening                   bolts_so_far;
    std::vector<output::ConvergenceRow>     rows;
  };
} // namespace slipstick::app
