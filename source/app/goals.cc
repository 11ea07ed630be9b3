#include <slipstick/app/goals.h>
#include <slipstick/base/collective.h>
#include <slipstick/contact/adjoint.h>
#include <slipstick/interface/gap_defect.h>
#include <slipstick/mechanics/singular_points.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>

namespace slipstick::app
{
  namespace
  {
    // Components of directions below this are rounding.
    constexpr double along_axis = 1e-9;

    // A pair slides as a whole if sticking nodes carry no more than this part of its friction.
    constexpr double sticking_part = 0.1;

    // Forces at points below this part of the largest force count as none: most point supports only hold rigid motions.
    constexpr double negligible_reaction = 1e-3;

    // Places that differ by less than this part of their coordinates are the same.
    constexpr double same_place = 1e-9;

    using Fields = std::vector<Eigen::VectorXd>;

    /// Data of the adjoint problem of one quantity: jumps or loads, on this rank.
    struct Functional
    {
      std::string         quantity, unit;
      double              value = 0; // the same on all ranks
      std::vector<double> jumps;     // of the owned rows, for a quantity of multipliers
      Fields              loads;     // for a quantity of displacements
      std::string         reason;    // why there is no estimate; empty: there is one
      bool                is_of_multipliers = true;
    };

    std::string component(const unsigned int d)
    {
      return {"xyz"[d]};
    }

    /// The quantities of a scene, from multipliers and displacements.
    template <int dim>
    class Functionals
    {
    public:
      /// @param t load factor of @p answer_.
      Functionals(const StepSolver<dim>        &solver_,
                  const mechanics::Probes<dim> &probes_,
                  const StepSolution           &answer_,
                  const double                  t)
        : solver(solver_)
        , probes(probes_)
        , answer(answer_)
        , rows(solver.dual().constraints())
        , x(answer.recovery.multipliers)
        , comm(solver.dual().communicator())
        , n_rows(rows.kind.size())
        , points(acting_points(t))
      {}

      /// Points at which forces act: the energy and the displacement there are infinite.
      const std::vector<mechanics::SingularPoint<dim>> &point_forces() const
      {
        return points;
      }

      std::vector<Functional> all() const
      {
        std::vector<Functional> list{displacement()};
        const auto             &scene = solver.discrete_scene();
        for (unsigned int k = 0; k < scene.contacts.size(); ++k)
          {
            const std::string name = scene.contacts[k].name;
            list.push_back(normal_force(name + ".normal_force", k));
            list.push_back(tangential_force(name + ".tangential_force", k));
            list.push_back(pressure(name + ".max_pressure", k));
          }
        for (unsigned int s = 0; s < solver.n_given_supports(); ++s)
          for (unsigned int d = 0; d < dim; ++d)
            {
              auto goal = reaction(scene.supports[s].name + ".force_" + component(d), s, d);
              if (holds(goal))
                list.push_back(std::move(goal));
            }
        for (unsigned int k = 0; k < scene.probes.size(); ++k)
          if (scene.probes[k].ends.size() == 1)
            for (unsigned int d = 0; d < dim; ++d)
              list.push_back(displacement_at(scene.probes[k].name + ".u_" + component(d), k, d));
        return list;
      }

    private:
      /// Of point supports and point loads those that bear something.
      std::vector<mechanics::SingularPoint<dim>> acting_points(const double t) const
      {
        const auto                                                   &scene = solver.discrete_scene();
        std::vector<std::pair<mechanics::SingularPoint<dim>, double>> acting; // with their forces
        double                                                        largest = 0;
        for (const auto &point :
             mechanics::force_points(scene, solver.mesh(), solver.spaces(), solver.n_given_supports()))
          if (point.load || !is_in_contact(point))
            {
              dealii::Tensor<1, dim> force;
              for (unsigned int d = 0; d < dim; ++d)
                force[d] = point.load ? scene.point_loads[*point.load].force[d].value(point.position, t)
                                      : reaction("", *point.support, d).value;
              acting.emplace_back(point, force.norm());
              largest = std::max(largest, force.norm());
            }
        if (acting.empty())
          return {};
        for (unsigned int s = 0; s < solver.n_given_supports(); ++s)
          for (unsigned int d = 0; d < dim; ++d)
            largest = std::max(largest, std::abs(reaction("", s, d).value));
        for (unsigned int k = 0; k < scene.contacts.size(); ++k)
          largest = std::max(largest, std::abs(normal_force("", k).value));
        std::vector<mechanics::SingularPoint<dim>> result;
        for (const auto &[point, force] : acting)
          if (force > negligible_reaction * largest)
            result.push_back(point);
        return result;
      }

      /// Is it a node of a contact zone or beside one? Then the support bears the share of a node of the pressure.
      bool is_in_contact(const mechanics::SingularPoint<dim> &point) const
      {
        bool is_near = false;
        for (const auto *nodes : {&rows.contact_points, &rows.bonded_points})
          for (const auto &node : *nodes)
            {
              const double reach = node.is_in_space() ? std::sqrt(node.area) : node.length;
              for (const auto &[body, place] : {std::make_pair(node.slave_body, node.slave_position),
                                                std::make_pair(node.master_body, node.master_position)})
                {
                  double square = 0;
                  for (unsigned int d = 0; d < dim; ++d)
                    square += (place[d] - point.position[d]) * (place[d] - point.position[d]);
                  is_near = is_near || (body == point.body && square <= reach * reach);
                }
            }
        return dealii::Utilities::MPI::max(is_near ? 1 : 0, comm) == 1;
      }

      /// Why a displacement there has no estimate; empty: it has.
      std::string infinite_at(const unsigned int body, const dealii::Point<dim> &place) const
      {
        for (const auto &point : points)
          if (point.body == body &&
              point.position.distance(place) <= same_place * (place.norm() + point.position.norm()))
            return "it is infinite at " + point.what;
        return "";
      }

      /// Of a node of a subdomain of this rank.
      dealii::Point<dim> position_of(const unsigned int p, const unsigned int node) const
      {
        const auto                                  &element = solver.spaces().of(p);
        std::vector<dealii::types::global_dof_index> dofs;
        std::vector<unsigned int>                    nodes;
        for (const auto &cell : solver.spaces().dof_handlers[p]->active_cell_iterators())
          {
            element.nodes_of(cell, dofs, nodes);
            for (unsigned int i = 0; i < nodes.size(); ++i)
              if (nodes[i] == node)
                return i < cell->n_vertices()
                         ? cell->vertex(i)
                         : element.mapping->transform_unit_to_real_cell(cell, element.scalar->unit_support_point(i));
          }
        return {};
      }

      Functional displacement_at(const std::string &name, const unsigned int probe, const unsigned int d) const
      {
        Functional goal{name, "mm", 0, {}, probes.unit_force(probe, d), {}, false};
        double     own = 0;
        for (unsigned int p = 0; p < goal.loads.size(); ++p)
          own += goal.loads[p].dot(answer.recovery.u[p]);
        goal.value  = dealii::Utilities::MPI::sum(own, comm);
        goal.reason = infinite_at(solver.discrete_scene().probes[probe].body, probes.positions()[probe][0].position);
        return goal;
      }

      template <class F>
      void for_points_of(const unsigned int pair, const F &f) const
      {
        for (const auto *points : {&rows.contact_points, &rows.bonded_points})
          for (const auto &point : *points)
            if (point.pair == pair)
              f(point);
      }

      double value_of(const std::vector<double> &g) const
      {
        double sum = 0;
        for (unsigned int r = 0; r < n_rows; ++r)
          sum += g[r] * x.local_element(r);
        return dealii::Utilities::MPI::sum(sum, comm);
      }

      Functional normal_force(const std::string &name, const unsigned int pair) const
      {
        Functional goal{name, "N", 0, std::vector<double>(n_rows, 0.), {}, {}};
        for_points_of(pair, [&](const tfeti::ContactPoint &point) {
          if (point.normal_row != tfeti::invalid_row)
            goal.jumps[point.normal_row] = 1;
        });
        goal.value = value_of(goal.jumps);
        return goal;
      }

      /// Sum of the nodal forces along the tangent, in space of their magnitudes.
      Functional tangential_force(const std::string &name, const unsigned int pair) const
      {
        Functional goal{name, "N", 0, std::vector<double>(n_rows, 0.), {}, {}};
        for_points_of(pair, [&](const tfeti::ContactPoint &point) {
          const double size = tangential(point);
          for (const unsigned int row : {point.tangential_row, point.second_row})
            if (row != tfeti::invalid_row)
              goal.jumps[row] = dim == 2 ? 1. : size > 0 ? x.local_element(row) / size : 0.;
        });
        goal.value = value_of(goal.jumps);
        if (slides(pair)) // as a whole: friction follows the pressure
          for_points_of(pair, [&](const tfeti::ContactPoint &point) {
            if (point.normal_row != tfeti::invalid_row && point.tangential_row != tfeti::invalid_row &&
                !solver.solution().free[point.tangential_row] && x.local_element(point.normal_row) > 0)
              goal.jumps[point.normal_row] = tangential(point) / x.local_element(point.normal_row);
          });
        return goal;
      }

      /// Magnitude of the tangential force on a node in space [N].
      double tangential(const tfeti::ContactPoint &point) const
      {
        const double along = point.tangential_row != tfeti::invalid_row ? x.local_element(point.tangential_row) : 0.;
        if (dim == 2)
          return along;
        return std::hypot(along, point.second_row != tfeti::invalid_row ? x.local_element(point.second_row) : 0.);
      }

      /// Whether slipping nodes whose bound follows the pressure carry nearly all of the pair's friction. Otherwise
      /// equilibrium with the forces of the other nodes determines the friction more than the pressure does.
      bool slides(const unsigned int pair) const
      {
        if (!solver.discrete_scene().contacts[pair].law.coefficient)
          return false;
        double sticks = 0, all = 0;
        for_points_of(pair, [&](const tfeti::ContactPoint &point) {
          if (point.tangential_row == tfeti::invalid_row)
            return;
          const double force = std::abs(tangential(point));
          all += force;
          sticks += solver.solution().free[point.tangential_row] ? force : 0.;
        });
        return dealii::Utilities::MPI::sum(sticks, comm) <= sticking_part * dealii::Utilities::MPI::sum(all, comm);
      }

      Functional pressure(const std::string &name, const unsigned int pair) const
      {
        Functional   goal{name, "MPa", 0, std::vector<double>(n_rows, 0.), {}, {}};
        double       largest = 0;
        unsigned int at      = tfeti::invalid_row;
        double       area    = 1;
        for_points_of(pair, [&](const tfeti::ContactPoint &point) {
          if (point.normal_row == tfeti::invalid_row || !(point.traction_area > 0))
            return;
          const double p = x.local_element(point.normal_row) / point.traction_area;
          if (p > largest)
            {
              largest = p;
              at      = point.normal_row;
              area    = point.traction_area;
            }
        });
        goal.value              = dealii::Utilities::MPI::max(largest, comm);
        const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(comm);
        const bool         has  = at != tfeti::invalid_row && largest == goal.value;
        const unsigned int best = dealii::Utilities::MPI::min(has ? rank : tfeti::invalid_row, comm);
        if (best == tfeti::invalid_row)
          goal.reason = "there is no contact";
        else if (best == rank)
          goal.jumps[at] = 1 / area;
        return goal;
      }

      Functional reaction(const std::string &name, const unsigned int support, const unsigned int d) const
      {
        Functional goal{name, "N", 0, std::vector<double>(n_rows, 0.), {}, {}};
        for (const auto &reaction : rows.reactions)
          if (std::count(reaction.holders.begin(), reaction.holders.end(), support) > 0)
            goal.jumps[reaction.row] -= reaction.direction[d] / reaction.holders.size();
        goal.value = value_of(goal.jumps);
        return goal;
      }

      /// Whether the support holds anything along this axis.
      bool holds(const Functional &reaction) const
      {
        double largest = 0;
        for (const double g : reaction.jumps)
          largest = std::max(largest, std::abs(g));
        return dealii::Utilities::MPI::max(largest, comm) > along_axis;
      }

      /// Displacement in the direction of the largest displacement, at its node.
      Functional displacement() const
      {
        Functional   goal{"max_displacement", "mm", 0, {}, {}, {}, false};
        double       largest = -1;
        unsigned int at_p = 0, at_node = 0;
        const auto  &u = answer.recovery.u;
        for (unsigned int p = 0; p < u.size(); ++p)
          {
            goal.loads.push_back(Eigen::VectorXd::Zero(u[p].size()));
            for (unsigned int i = 0; i < u[p].size() / dim; ++i)
              if (const double size = u[p].template segment<dim>(dim * i).norm(); size > largest)
                {
                  largest = size;
                  at_p    = p;
                  at_node = i;
                }
          }
        goal.value              = dealii::Utilities::MPI::max(largest, comm);
        const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(comm);
        const unsigned int best = dealii::Utilities::MPI::min(largest == goal.value ? rank : tfeti::invalid_row, comm);
        if (!(goal.value > 0))
          {
            goal.reason = "nothing moves";
            return goal;
          }
        if (best == rank)
          {
            goal.loads[at_p].template segment<dim>(dim * at_node) =
              u[at_p].template segment<dim>(dim * at_node) / largest;
            goal.reason = infinite_at(solver.mesh().subdomains[at_p]->body, position_of(at_p, at_node));
          }
        goal.reason = dealii::Utilities::MPI::broadcast(comm, goal.reason, best);
        return goal;
      }

      const StepSolver<dim>          &solver;
      const mechanics::Probes<dim>   &probes;
      const StepSolution             &answer;
      const tfeti::Constraints       &rows;
      const tfeti::DistributedVector &x;
      const MPI_Comm                  comm;
      const std::size_t               n_rows;

      const std::vector<mechanics::SingularPoint<dim>> points;
    };

    /// Energy products of the errors of the solution with those of other displacements.
    template <int dim>
    class ErrorProducts
    {
    public:
      ErrorProducts(const StepSolver<dim> &solver_, const StepSolution &answer_, const double t_)
        : solver(solver_)
        , answer(answer_)
        , t(t_)
      {}

      /// By subdomain and cell. Uses a(e, z) = (|e + z|^2 - |e - z|^2) / 4 with z scaled to the size of the solution.
      Fields with(const Fields &z) const
      {
        const double scale = largest(answer.recovery.u) / largest(z);
        Fields       sum = solver.elastic_part(answer.recovery.u), difference = sum, product;
        for (unsigned int p = 0; p < z.size(); ++p)
          {
            sum[p] += scale * z[p];
            difference[p] -= scale * z[p];
          }
        const auto of_sum = stress(sum), of_difference = stress(difference);
        for (unsigned int p = 0; p < z.size(); ++p)
          product.push_back(
            (of_sum.subdomains[p].error.array().square() - of_difference.subdomains[p].error.array().square()) /
            (4 * scale));
        return product;
      }

      double largest(const Fields &u) const
      {
        double size = 0;
        for (const auto &part : u)
          size = std::max(size, part.size() > 0 ? part.lpNorm<Eigen::Infinity>() : 0.);
        return dealii::Utilities::MPI::max(size, solver.mesh().comm);
      }

      /// Sums over the cells.
      void add_up(GoalError &goal) const
      {
        double own = 0, magnitudes = 0;
        for (const auto &part : goal.cells)
          {
            own += part.sum();
            magnitudes += part.cwiseAbs().sum();
          }
        goal.signed_  = dealii::Utilities::MPI::sum(own, solver.mesh().comm);
        goal.absolute = dealii::Utilities::MPI::sum(magnitudes, solver.mesh().comm);
        goal.is_known = std::isfinite(goal.absolute);
      }

    private:
      mechanics::StressResult stress(const Fields &u) const
      {
        return mechanics::recover_stress(solver.discrete_scene(),
                                         solver.mesh(),
                                         solver.spaces(),
                                         solver.dual().constraints(),
                                         u,
                                         t);
      }

      const StepSolver<dim> &solver;
      const StepSolution    &answer;
      const double           t;
    };

    /// Effect of evaluating gaps at nodes only: derivative of the quantity with respect to the gap of a node times the
    /// gap defect there, attributed to the cells at the node.
    template <int dim>
    class GapErrors
    {
    public:
      GapErrors(const StepSolver<dim> &solver_, const double t)
        : solver(solver_)
        , defects(interface::gap_defects(solver.discrete_scene(), solver.mesh(), solver.spaces(), t))
      {}

      /// @param y derivatives of the quantity with respect to the right-hand sides of the rows. Collective.
      void add(const tfeti::DistributedVector &y, const double factor, GoalError &goal) const
      {
        const auto        &contacts = solver.discrete_scene().contacts;
        std::vector<Share> own;
        for (const auto &point : solver.dual().constraints().contact_points)
          if (const auto found = defects.of_pairs[point.pair].find(point.key);
              point.normal_row != tfeti::invalid_row && found != defects.of_pairs[point.pair].end())
            if (const double part = -factor * found->second * y.local_element(point.normal_row); part != 0)
              own.push_back({{point.pair, point.key}, part / defects.n_parts[point.pair].at(point.key)});
        std::map<std::pair<unsigned int, mechanics::NodeKey>, double> parts;
        for (const auto &list : dealii::Utilities::MPI::all_gather(solver.mesh().comm, own))
          for (const auto &[of, part] : list)
            parts[of] += part;
        if (parts.empty())
          return;
        for (unsigned int p = 0; p < goal.cells.size(); ++p)
          for_boundary_faces(p, [&](const unsigned int cell, const auto &face) {
            for (unsigned int k = 0; k < contacts.size(); ++k)
              if (contacts[k].slave.body == face.body && solver.mesh().on_boundary(contacts[k].slave, face.boundary))
                for (unsigned int i = 0; i < face.n_nodes; ++i)
                  if (const auto found = parts.find({k, face.keys[i]}); found != parts.end())
                    goal.cells[p][cell] += found->second;
          });
      }

    private:
      using Share = std::pair<std::pair<unsigned int, mechanics::NodeKey>, double>;

      template <class F>
      void for_boundary_faces(const unsigned int p, const F &f) const
      {
        const auto &subdomain = *solver.mesh().subdomains[p];
        for (const auto &cell : solver.spaces().dof_handlers[p]->active_cell_iterators())
          for (const unsigned int face : cell->face_indices())
            if (cell->face(face)->at_boundary() && cell->face(face)->boundary_id() != mesh::cut_id)
              f(cell->active_cell_index(), mechanics::surface_part(subdomain, solver.spaces(), cell, face));
      }

      const StepSolver<dim>           &solver;
      const interface::GapDefects<dim> defects;
    };

    /// Estimate from the adjoint displacement @p z, if it exists.
    template <int dim>
    void complete(const StepSolution                            &answer,
                  const ErrorProducts<dim>                      &products,
                  const GapErrors<dim>                          &gaps,
                  const std::optional<contact::Adjoint::Answer> &z,
                  GoalError                                     &goal)
    {
      if (!z)
        {
          goal.reason = "its linear problem was not solved";
          return;
        }
      if (products.largest(z->u) > 0)
        goal.cells = products.with(z->u);
      else // determined by the prescribed forces alone
        for (const auto &part : answer.stress->subdomains)
          goal.cells.push_back(Eigen::VectorXd::Zero(part.error.size()));
      gaps.add(z->multipliers, 1, goal);
      products.add_up(goal);
    }

    /// With w, the displacement due to the gaps of the bodies without loads: |e|^2 / 2 - a(e, w).
    template <int dim>
    GoalError energy_error(const StepSolver<dim>                            &solver,
                           const StepSolution                               &answer,
                           const std::vector<double>                        &gaps,
                           const ErrorProducts<dim>                         &products,
                           const GapErrors<dim>                             &gap_errors,
                           contact::Adjoint                                 &adjoint,
                           const std::vector<mechanics::SingularPoint<dim>> &point_forces)
    {
      const MPI_Comm comm = solver.mesh().comm;
      GoalError      goal;
      goal.quantity = "strain_energy";
      goal.unit     = "N mm";
      goal.value    = answer.contact->checks.energy / 2;
      if (!point_forces.empty())
        {
          goal.reason = "it is infinite, with " + point_forces.front().what;
          return goal;
        }
      const bool has_bolts = !solver.discrete_scene().pretensions.empty();
      if (has_bolts || !solver.discrete_scene().temperatures.empty())
        {
          goal.reason = std::string("not estimated with ") + (has_bolts ? "bolts" : "changes of temperature");
          return goal;
        }
      for (const auto &part : answer.stress->subdomains)
        goal.cells.push_back(part.error.array().square() / 2);
      const double largest_gap =
        gaps.empty() ? 0. : std::abs(*std::max_element(gaps.begin(), gaps.end(), [](const double a, const double b) {
          return std::abs(a) < std::abs(b);
        }));
      if (dealii::Utilities::MPI::max(largest_gap, comm) > 0)
        {
          const auto w = adjoint.solve(gaps);
          if (!w)
            {
              goal.reason = "its linear problem was not solved";
              return goal;
            }
          if (products.largest(w->u) > 0)
            {
              const auto product = products.with(w->u);
              for (unsigned int p = 0; p < product.size(); ++p)
                goal.cells[p] -= product[p];
            }
          gap_errors.add(w->multipliers, -1, goal);
        }
      products.add_up(goal);
      return goal;
    }
  } // namespace

  template <int dim>
  std::vector<GoalError> goal_errors(StepSolver<dim>                &solver,
                                     const mechanics::Probes<dim>   &probes,
                                     const StepSolution             &answer,
                                     const double                    t,
                                     const std::vector<std::string> &quantities)
  {
    const auto wanted = [&](const std::string &name) {
      return quantities.empty() || std::find(quantities.begin(), quantities.end(), name) != quantities.end();
    };
    const auto               gaps = solver.dual().constraints().c; // overwritten by the adjoint problems
    const Functionals<dim>   of_scene(solver, probes, answer, t);
    const auto               functionals = of_scene.all();
    const ErrorProducts<dim> products(solver, answer, t);
    const GapErrors<dim>     gap_errors(solver, t);
    contact::Adjoint         adjoint(solver.dual_for_adjoints(), solver.solution().free, scene::SolverOptions().pcpg);
    const std::string        loose = "bodies slide on all of their contacts";
    std::vector<GoalError>   errors;
    for (const auto &functional : functionals)
      if (wanted(functional.quantity))
        {
          GoalError error;
          error.quantity = functional.quantity;
          error.unit     = functional.unit;
          error.value    = functional.value;
          error.reason   = adjoint.is_possible() ? functional.reason : loose;
          if (error.reason.empty())
            {
              const auto z = functional.is_of_multipliers
                               ? adjoint.solve(functional.jumps)
                               : adjoint.solve(functional.loads, std::vector<double>(gaps.size(), 0.));
              complete(answer, products, gap_errors, z, error);
            }
          errors.push_back(std::move(error));
        }
    if (wanted("strain_energy"))
      {
        if (adjoint.is_possible())
          errors.push_back(energy_error(solver, answer, gaps, products, gap_errors, adjoint, of_scene.point_forces()));
        else
          {
            GoalError error;
            error.quantity = "strain_energy";
            error.unit     = "N mm";
            error.value    = answer.contact->checks.energy / 2;
            error.reason   = loose;
            errors.push_back(std::move(error));
          }
      }
    return errors;
  }

  template std::vector<GoalError> goal_errors(StepSolver<2> &,
                                              const mechanics::Probes<2> &,
                                              const StepSolution &,
                                              const double,
                                              const std::vector<std::string> &);
  template std::vector<GoalError> goal_errors(StepSolver<3> &,
                                              const mechanics::Probes<3> &,
                                              const StepSolution &,
                                              const double,
                                              const std::vector<std::string> &);
} // namespace slipstick::app
