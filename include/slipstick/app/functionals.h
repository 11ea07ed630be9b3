// The results that may have error bars, as linear functionals of multipliers or displacements.
#pragma once

#include <slipstick/app/step_solver.h>
#include <slipstick/mechanics/probes.h>
#include <slipstick/mechanics/singular_points.h>

#include <string>
#include <vector>

namespace slipstick::app
{
  /// Data of the adjoint problem of one quantity: jumps or loads, on this rank.
  struct Functional
  {
    std::string                  quantity, unit;
    double                       value = 0; // the same on all ranks
    std::vector<double>          jumps;     // of the owned rows, for a quantity of multipliers
    std::vector<Eigen::VectorXd> loads;     // for a quantity of displacements
    std::string                  reason;    // why there is no estimate; empty: there is one
    bool                         is_of_multipliers = true;
    double                       local_error       = 0;     // in addition to that of the adjoint problem, not negative
    double                       shortfall         = 0;     // of a place with an error, if the value itself has none
    bool                         is_resolvable     = false; // finer cells remove the reason
    bool                         is_infinite       = false; // the reason: no mesh has an estimate
    bool                         is_singular   = false; // the reason: a singular point, where stresses may be infinite
    bool                         is_on_request = false; // of interest only as a goal
    std::string                  note          = "";    // what the quantity covers, if its name does not say it
  };

  /// The quantities that get error bars.
  struct RequestedBars
  {
    bool                     all = false; // all that the scene has, except those of interest only as goals
    std::vector<std::string> goals;       // these in any case

    bool is_goal(const std::string &quantity) const;

    bool includes(const Functional &functional) const;

    /// Whether names of requested quantities may begin with @p text.
    bool includes_some_of(const std::string &text) const;
  };

  /// The quantities of a scene, from multipliers and displacements of the last load step. Members are collective.
  template <int dim>
  class Functionals
  {
  public:
    /// Keeps references to all arguments except @p t, the load factor of @p answer.
    Functionals(const StepSolver<dim>        &solver,
                const mechanics::Probes<dim> &probes,
                const StepSolution           &answer,
                const double                  t);

    /// Points at which forces act; the energy and the displacement are infinite there.
    const std::vector<mechanics::SingularPoint<dim>> &point_forces() const
    {
      return points;
    }

    /// All quantities except stresses, the strain energy and lengths of contact.
    std::vector<Functional> all() const;

  private:
    /// The point supports and point loads whose force is not negligible.
    std::vector<mechanics::SingularPoint<dim>> acting_points(const double t) const;

    /// Whether the point is a contact node or adjacent to one; the support then bears a nodal share of the pressure.
    bool is_in_contact(const mechanics::SingularPoint<dim> &point) const;

    /// Why the displacement at this place has no estimate; empty: it has one.
    std::string infinite_at(const unsigned int body, const dealii::Point<dim> &place) const;

    /// Position of a node of subdomain @p p of this rank.
    dealii::Point<dim> position_of(const unsigned int p, const unsigned int node) const;

    Functional displacement_at(const std::string &name, const unsigned int probe, const unsigned int d) const;

    template <class F>
    void for_points_of(const unsigned int pair, const F &f) const;

    double value_of(const std::vector<double> &g) const;

    Functional normal_force(const std::string &name, const unsigned int pair) const;

    /// Sum of the nodal forces along the tangent; in space, sum of their magnitudes.
    Functional tangential_force(const std::string &name, const unsigned int pair) const;

    /// Magnitude of the tangential force on a node in space [N].
    double tangential(const tfeti::ContactPoint &point) const;

    Functional pressure(const std::string &name, const unsigned int pair) const;

    /// L2 norms of the pressure and of the tangential traction over the contact; in the plane and for bodies of
    /// revolution over the true area.
    Functional pressure_norm(const std::string &name, const unsigned int pair) const;
    Functional traction_norm(const std::string &name, const unsigned int pair) const;

    /// Turns the functional of the squared norm into that of the norm.
    Functional as_norm(Functional square) const;

    Functional reaction(const std::string &name, const unsigned int support, const unsigned int d) const;

    /// Whether the support holds anything along this axis.
    bool holds(const Functional &reaction) const;

    /// Sum of the squares of the prescribed components, of the nodes of each subdomain of this rank [mm^2].
    std::vector<Eigen::VectorXd> prescribed_squares() const;

    /// The largest displacement; errors are those of the largest one at a node that no support moves, along its
    /// direction.
    Functional displacement() const;

    const StepSolver<dim>          &solver;
    const mechanics::Probes<dim>   &probes;
    const StepSolution             &answer;
    const tfeti::Constraints       &rows;
    const tfeti::DistributedVector &x;
    const MPI_Comm                  comm;
    const std::size_t               n_rows;

    const std::vector<mechanics::SingularPoint<dim>> points;
  };
} // namespace slipstick::app
