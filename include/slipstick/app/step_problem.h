// The mesh of a scene and the dual problem of a load step: data that change with the step, and data computed once.
#pragma once

#include <slipstick/base/log.h>
#include <slipstick/base/resultant.h>
#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/bolts.h>
#include <slipstick/mechanics/tightening.h>
#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/dual_problem.h>

#include <memory>
#include <optional>
#include <vector>

namespace slipstick::app
{
  /// K_p, B and F of successive load steps, with rows for the potential contact nodes: initially for those with a small
  /// gap, later for more if others would penetrate. Motions that nothing resists and no load drives are suppressed if
  /// the scene has no support for them. Members are collective, except those that only return known values.
  template <int dim>
  class StepProblem
  {
  public:
    /// What the rows of a load step have in common with those of the step before.
    enum class Rows
    {
      same,  // all but gaps and prescribed displacements
      moved, // the same nodes, whose multipliers fit, but other normals: obstacles move
      others
    };

    /// Generates the mesh, and finds the contact pairs if the scene requests an automatic search.
    /// @param refinement local refinement, if any.
    /// @throws InputError for inconsistent meshes and pairs.
    StepProblem(const scene::Scene<dim>    &scene,
                const Log                  &log,
                StageClock                 &clock,
                const MPI_Comm              comm,
                const scene::SolverOptions &options,
                mesh::Refinement           *refinement);

    /// Small loads along motions that nothing resists are those of an outline that the mesh cuts unevenly: on another
    /// mesh of this scene there are none.
    void assume_undriven()
    {
      is_undriven = true;
    }

    /// Builds the problem at load factor t, with the rows of all contact nodes if pruned ones are needed to hold a body.
    /// @throws InputError, NoEquilibrium.
    void build(const double t);

    /// Sets loads and right-hand sides of a later step; slip is measured from @p u, the end of the previous step.
    /// Rows are built again if they have changed: obstacles may move.
    Rows advance(const double t, const std::vector<Eigen::VectorXd> &u);

    /// The load factor at which the present rows were built.
    double built_at() const
    {
      return load_factor_of_rows;
    }

    /// Adds rows for more contact nodes, because others penetrate or the bodies are not held without them.
    void keep_more(const double t);

    /// Sets the displacement @p u from which slip is measured.
    void start_slip_from(const std::vector<Eigen::VectorXd> &u);

    /// Sets the loads of the current step again, with the current shortening of the bolts.
    void reload(const double t);

    /// Sets the tensions prescribed by the scene at load factor t.
    void begin_bolts(const double t);

    /// Penetration of contact nodes that have no rows [mm].
    double penetration_of_pruned(const std::vector<Eigen::VectorXd> &u) const;

    /// Whether contact nodes have been omitted.
    bool is_pruned() const
    {
      return pruned.rows->size() > 0;
    }

    /// Continues from a run that ended with these values of kept_part() and largest_load().
    void restore(const double part, const double load)
    {
      kept_fraction       = part;
      largest_load_so_far = load;
    }

    /// Contact nodes get rows if their gap exceeds the smallest gap of the pair by less than this fraction of the slave
    /// boundary's length.
    double kept_part() const
    {
      return kept_fraction;
    }
    /// Largest load of the steps so far [N].
    double largest_load() const
    {
      return largest_load_so_far;
    }
    /// The scene with the contact pairs found by the search.
    const scene::Scene<dim> &discrete_scene() const
    {
      return scene;
    }
    const mesh::Mesh<dim> &mesh() const
    {
      return *mesh_ptr;
    }
    const mechanics::Spaces<dim> &spaces() const
    {
      return *spaces_ptr;
    }
    tfeti::DualProblem &dual()
    {
      return *dual_ptr;
    }
    const tfeti::DualProblem &dual() const
    {
      return *dual_ptr;
    }
    /// Contact nodes of this rank whose gap supports prescribe.
    const tfeti::HeldContacts &held_contacts() const
    {
      return held;
    }
    /// Number of supports in the scene as given; additional supports hold motions that nothing else holds.
    unsigned int n_given_supports() const
    {
      return n_given;
    }
    /// Description of the motions that nothing resists and no load drives (empty: none); they are set to zero.
    const std::string &unheld() const
    {
      return unheld_motions;
    }
    /// These motions, held by additional supports in the present step.
    const std::vector<tfeti::RigidMotion> &still_motions() const
    {
      return held_still;
    }
    /// Spreads what the auxiliary supports bear in this solution over the bodies, as inertia does, so that the choice of
    /// these supports does not matter: friction across gaps may do work along the motions (at each side it acts at
    /// undeformed points). The loads must then be set again. Collective.
    /// @param largest_forces norm of the multipliers, the largest of all steps so far [N].
    /// @return whether it was more than rounding.
    bool spread_still_forces(const tfeti::DistributedVector &multipliers, const double largest_forces);

    /// The resultant of these fields.
    Resultant still_forces() const;
    /// Their size [N].
    double still_load() const
    {
      return still_work.size() > 0 ? still_work.norm() : 0.;
    }

    /// Null if the scene has none.
    const mechanics::Bolts<dim> *bolts() const
    {
      return all_bolts ? &*all_bolts : nullptr;
    }
    mechanics::Tightening &tightening()
    {
      return bolts_so_far;
    }
    const mechanics::Tightening &tightening() const
    {
      return bolts_so_far;
    }
    /// The part of a displacement that strains the bodies: without the shortening of bolts.
    std::vector<Eigen::VectorXd> elastic_part(const std::vector<Eigen::VectorXd> &u) const
    {
      return all_bolts ? all_bolts->elastic_part(u, bolts_so_far.shortening()) : u;
    }
    /// Total of all load steps so far [s].
    double factorization_seconds() const
    {
      return factorization;
    }

  private:
    /// Builds the dual problem without the rows of pruned contact nodes; with auxiliary supports if nothing else holds
    /// a body. @throws NoEquilibrium if pruned nodes may hold it.
    void make_dual(const double t);
    void make_dual_as_it_is(const double t);

    /// Subtracts body forces equal to rigid motions from the loads: with this work along the motions of all
    /// bodies and, along `balanced`, all work that the loads do there.
    void balance(Eigen::VectorXd work, std::vector<Eigen::VectorXd> &loads);

    /// Loads of this rank's subdomains, including bolts, with rounding set to zero.
    std::vector<Eigen::VectorXd> loads_at(const double t);

    /// Sets loads of this rank's subdomains to zero if they are only rounding compared with those of earlier steps.
    void drop_rounding(std::vector<Eigen::VectorXd> &loads);

    /// Compares rows with the present ones. Collective.
    Rows compare(const tfeti::Constraints &rows) const;

    /// The contact rows at load factor t, except pruned ones.
    interface::ContactRows contact_rows(const double t);

    /// Rows that tell which motions nothing resists, if others than these: friction across a gap resists rotations of
    /// both bodies as a whole by the gap. Collective.
    std::optional<tfeti::Constraints> resisting_rows(const double t) const;

    scene::Scene<dim>        scene;
    const Log               &log;
    StageClock              &clock;
    const MPI_Comm           comm;
    const bool               prunes;
    const tfeti::DualOptions dual_options;

    // the same in all load steps
    std::unique_ptr<mesh::Mesh<dim>>            mesh_ptr;
    std::unique_ptr<mechanics::Spaces<dim>>     spaces_ptr;
    std::optional<interface::BodyContacts<dim>> contacts;
    std::shared_ptr<tfeti::Subdomains>          subdomains;
    std::optional<std::vector<Eigen::MatrixXd>> inertia; // mechanics::rigid_body_forces(), once they are needed
    std::optional<mechanics::Bolts<dim>>        all_bolts;

    std::unique_ptr<tfeti::DualProblem> dual_ptr;
    tfeti::Constraints                  pruned;  // normal rows of the contact nodes without multipliers
    tfeti::HeldContacts                 held;    // contact nodes whose gap supports prescribe
    unsigned int                        n_given; // number of supports
    std::string                         unheld_motions;
    std::vector<tfeti::RigidMotion>     held_still;
    Eigen::VectorXd                 still_work; // of what is spread over the bodies, along the motions of all bodies
    bool                            is_undriven = false;
    std::vector<tfeti::RigidMotion> balanced; // motions along which the loads of the scene do no work
    mechanics::Tightening           bolts_so_far;
    double                          kept_fraction;
    double                          largest_load_so_far = 0; // [N]
    double                          load_factor_of_rows = 0;
    double                          factorization       = 0; // [s]
  };
} // namespace slipstick::app
