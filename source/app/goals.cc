#include <slipstick/app/goals.h>
#include <slipstick/app/stress_functionals.h>
#include <slipstick/base/collective.h>
#include <slipstick/base/gather.h>
#include <slipstick/contact/adjoint.h>
#include <slipstick/interface/gap_defect.h>
#include <slipstick/interface/transfer_defect.h>

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
    using Fields = std::vector<Eigen::VectorXd>;

    // Where tractions jump, coefficients of orthonormal polynomials decrease as 1 / k and energies as 1 / k^3: all
    // degrees together have 1.6 (degree 1) or 2.1 (degree 2) times the energy of the first beyond that of the elements.
    constexpr double all_degrees = 2;

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
        goal.correction = dealii::Utilities::MPI::sum(own, solver.mesh().comm);
        goal.absolute   = dealii::Utilities::MPI::sum(magnitudes, solver.mesh().comm);
        goal.is_known   = std::isfinite(goal.absolute);
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

    /// Calls f(cell, edge or facet) for the outline of a subdomain.
    template <int dim, class F>
    void for_boundary_faces(const StepSolver<dim> &solver, const unsigned int p, const F &f)
    {
      const auto &subdomain = *solver.mesh().subdomains[p];
      for (const auto &cell : solver.spaces().dof_handlers[p]->active_cell_iterators())
        for (const unsigned int face : cell->face_indices())
          if (mesh::is_on_outline(cell->face(face)))
            f(cell->active_cell_index(), mechanics::surface_part(subdomain, solver.spaces(), cell, face));
    }

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
        for (const auto &list : all_gather(solver.mesh().comm, own))
          for (const auto &[of, part] : list)
            parts[of] += part;
        if (parts.empty())
          return;
        for (unsigned int p = 0; p < goal.cells.size(); ++p)
          for_boundary_faces(solver, p, [&](const unsigned int cell, const auto &face) {
            for (unsigned int k = 0; k < contacts.size(); ++k)
              if (contacts[k].slave.body == face.body && solver.mesh().on_boundary(contacts[k].slave, face.boundary))
                for (unsigned int i = 0; i < face.n_nodes; ++i)
                  if (const auto found = parts.find({k, face.keys[i]}); found != parts.end())
                    goal.cells[p][cell] += found->second;
          });
      }

    private:
      using Share = std::pair<std::pair<unsigned int, mechanics::NodeKey>, double>;

      const StepSolver<dim>           &solver;
      const interface::GapDefects<dim> defects;
    };

    /// Energy products of displacements due to what the elements do not represent of contact tractions
    /// (interface::TransferDefect): a polynomial of degree k on a part of length h has about the wave number pi k / h.
    /// On a half space, tractions of wave number w cause displacements of 2 (1 - nu^2) / (E w) times themselves.
    template <int dim>
    class TransferErrors
    {
    public:
      /// Collective.
      explicit TransferErrors(const StepSolver<dim> &solver_)
        : solver(solver_)
      {
        const auto &scene     = solver.discrete_scene();
        const bool  has_pairs = std::any_of(scene.contacts.begin(), scene.contacts.end(), [](const auto &pair) {
          return pair.master.has_value();
        });
        if (!has_pairs)
          return;
        const auto all =
          mechanics::outlines(solver.mesh(), solver.spaces(), std::vector<bool>(scene.bodies.size(), true));
        std::multimap<std::vector<mechanics::NodeKey>, Loaded> loaded; // by the nodes of the part
        for (unsigned int k = 0; k < scene.contacts.size(); ++k)
          if (scene.contacts[k].master)
            for (auto &defect : interface::transfer_defects(scene, solver.mesh(), scene.contacts[k], all))
              loaded.emplace(nodes_of(defect.part), Loaded{k, std::move(defect)});
        is_needed = !loaded.empty();
        for (unsigned int p = 0; is_needed && p < solver.mesh().subdomains.size(); ++p)
          for_boundary_faces(solver, p, [&](const unsigned int cell, const auto &face) {
            const auto [first, last] = loaded.equal_range(nodes_of(face));
            for (auto part = first; part != last; ++part)
              {
                own.push_back(part->second);
                own.back().p    = p;
                own.back().cell = cell;
              }
          });
        if (is_needed)
          of_solution = tractions(solver.solution().multipliers);
      }

      /// Adds factor times the product of the solution with other multipliers, attributed to the cells. Collective.
      void add(const tfeti::DistributedVector &y, const double factor, GoalError &goal) const
      {
        if (!is_needed)
          return;
        const Tractions of_y = tractions(y);
        for (const Loaded &part : own)
          {
            double product = 0;
            for (unsigned int d = 0; d < 3; ++d)
              product += component(of_solution, part, d).dot(part.defect.rest * component(of_y, part, d));
            goal.cells[part.p][part.cell] += factor * displacement_of_first_degree(part.defect.part) * product;
          }
      }

    private:
      using Place     = std::pair<unsigned int, mechanics::NodeKey>; // pair, node
      using Tractions = std::map<Place, std::array<double, 3>>;

      struct Loaded
      {
        unsigned int                   pair;
        interface::TransferDefect<dim> defect;
        unsigned int                   p = 0, cell = 0; // subdomain of this rank
      };

      static std::vector<mechanics::NodeKey> nodes_of(const mechanics::BoundaryPart<dim> &part)
      {
        std::vector<mechanics::NodeKey> nodes(part.keys.begin(), part.keys.begin() + part.n_nodes);
        std::sort(nodes.begin(), nodes.end());
        return nodes;
      }

      static Eigen::VectorXd component(const Tractions &tractions, const Loaded &part, const unsigned int d)
      {
        Eigen::VectorXd result = Eigen::VectorXd::Zero(part.defect.nodes.size());
        for (unsigned int i = 0; i < part.defect.nodes.size(); ++i)
          if (const auto found = tractions.find({part.pair, part.defect.nodes[i]}); found != tractions.end())
            result[i] = found->second[d];
        return result;
      }

      /// Displacement over traction for a polynomial of degree 1, times the share of all degrees (doc/decisions/0150).
      double displacement_of_first_degree(const mechanics::BoundaryPart<dim> &part) const
      {
        const auto  &scene    = solver.discrete_scene();
        const auto  &body     = scene.bodies[part.body];
        const auto  &material = scene.materials[body.material];
        const double modulus  = material.young_modulus / (1 - material.poisson_ratio * material.poisson_ratio);
        return all_degrees * 2 * part.chord() / (dealii::numbers::PI * modulus) * body.thickness;
      }

      /// Tractions at the slave nodes, on all ranks.
      Tractions tractions(const tfeti::DistributedVector &x) const
      {
        std::vector<std::pair<Place, std::array<double, 3>>> own;
        const auto                                          &rows = solver.dual().constraints();
        for (const auto *points : {&rows.contact_points, &rows.bonded_points})
          for (const auto &point : *points)
            if (point.traction_area > 0)
              own.push_back({{point.pair, point.key}, traction_at(point, x)});
        for (const auto &shared : rows.shared_points)
          if (shared.point.traction_area > 0)
            own.push_back({{shared.point.pair, shared.point.key}, traction_at(shared.point, x)});
        Tractions result;
        for (const auto &list : all_gather(solver.mesh().comm, own))
          result.insert(list.begin(), list.end());
        return result;
      }

      static std::array<double, 3> traction_at(const tfeti::ContactPoint &point, const tfeti::DistributedVector &x)
      {
        std::array<double, 3> traction{{0, 0, 0}};
        const auto            add = [&](const unsigned int row, const std::array<double, 3> &direction) {
          if (row != tfeti::invalid_row)
            for (unsigned int d = 0; d < 3; ++d)
              traction[d] += x.local_element(row) / point.traction_area * direction[d];
        };
        const auto &n = point.normal;
        add(point.normal_row, n);
        add(point.tangential_row, point.is_in_space() ? point.tangents[0] : std::array<double, 3>{{-n[1], n[0], 0}});
        add(point.second_row, point.tangents[1]);
        return traction;
      }

      const StepSolver<dim> &solver;
      bool                   is_needed = false; // on any rank
      std::vector<Loaded>    own;               // of the cells of this rank
      Tractions              of_solution;
    };

    /// Estimate from the adjoint displacement @p z, if it exists.
    template <int dim>
    void complete(const StepSolution                            &answer,
                  const ErrorProducts<dim>                      &products,
                  const GapErrors<dim>                          &gaps,
                  const TransferErrors<dim>                     &transfer,
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
      transfer.add(z->multipliers, 1, goal);
      products.add_up(goal);
    }

    /// With w, the displacement due to the gaps and slips of the bodies without loads: |e|^2 / 2 - a(e, w).
    /// @param gaps right-hand sides of the rows; on rows tied to others, their jumps in the solution.
    template <int dim>
    GoalError energy_error(const StepSolver<dim>                            &solver,
                           const StepSolution                               &answer,
                           const std::vector<double>                        &gaps,
                           const ErrorProducts<dim>                         &products,
                           const GapErrors<dim>                             &gap_errors,
                           const TransferErrors<dim>                        &transfer,
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
          goal.reason      = "it is infinite, with " + point_forces.front().what;
          goal.is_infinite = true;
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
      transfer.add(solver.solution().multipliers, 0.5, goal);
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
          transfer.add(w->multipliers, -1, goal);
        }
      products.add_up(goal);
      return goal;
    }
  } // namespace

  template <int dim>
  std::vector<GoalError> goal_errors(StepSolver<dim>                                 &solver,
                                     const mechanics::Probes<dim>                    &probes,
                                     const StepSolution                              &answer,
                                     const double                                     t,
                                     const std::vector<mechanics::Surroundings<dim>> &peaks,
                                     const RequestedBars                             &requested)
  {
    auto                   gaps = solver.dual().constraints().c; // overwritten by the adjoint problems
    const Functionals<dim> of_scene(solver, probes, answer, t);
    auto                   functionals = of_scene.all();
    for (auto &functional : stress_functionals(solver, probes, answer, of_scene.point_forces(), peaks, t, requested))
      functionals.push_back(std::move(functional));
    const ErrorProducts<dim>  products(solver, answer, t);
    const GapErrors<dim>      gap_errors(solver, t);
    const TransferErrors<dim> transfer(solver);
    const auto                ties =
      contact::following_friction(contact::SlipLaw(solver.discrete_scene(), solver.dual(), t), solver.solution());
    const auto jumps = solver.dual().dual_operator().jumps(answer.recovery.u);
    for (const auto &tie : ties)
      gaps[tie.tied] = jumps.local_element(tie.tied);
    contact::Adjoint  adjoint(solver.dual_for_adjoints(), solver.solution().free, ties, solver.solution().directions);
    const std::string loose = "bodies slide on all of their contacts";
    std::vector<GoalError> errors;
    for (const auto &functional : functionals)
      if (requested.includes(functional))
        {
          GoalError error;
          error.quantity      = functional.quantity;
          error.unit          = functional.unit;
          error.value         = functional.value;
          error.local         = functional.local_error;
          error.shortfall     = functional.shortfall;
          error.note          = functional.note;
          error.reason        = adjoint.is_possible() ? functional.reason : loose;
          error.is_resolvable = adjoint.is_possible() && functional.is_resolvable;
          error.is_infinite   = functional.is_infinite;
          error.is_singular   = adjoint.is_possible() && functional.is_singular;
          if (error.reason.empty())
            {
              const auto z = functional.is_of_multipliers
                               ? adjoint.solve(functional.jumps)
                               : adjoint.solve(functional.loads, std::vector<double>(gaps.size(), 0.));
              complete(answer, products, gap_errors, transfer, z, error);
            }
          errors.push_back(std::move(error));
        }
    if (requested.includes_some_of("strain_energy"))
      {
        if (adjoint.is_possible())
          errors.push_back(
            energy_error(solver, answer, gaps, products, gap_errors, transfer, adjoint, of_scene.point_forces()));
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
                                              const std::vector<mechanics::Surroundings<2>> &,
                                              const RequestedBars &);
  template std::vector<GoalError> goal_errors(StepSolver<3> &,
                                              const mechanics::Probes<3> &,
                                              const StepSolution &,
                                              const double,
                                              const std::vector<mechanics::Surroundings<3>> &,
                                              const RequestedBars &);
} // namespace slipstick::app
