#include <slipstick/app/functionals.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::app
{
  namespace
  {
    // Smaller components of directions are rounding errors.
    constexpr double along_axis = 1e-9;

    // Point forces below this fraction of the largest force are neglected: most point supports only hold rigid motions.
    constexpr double negligible_reaction = 1e-3;

    // A support moves a node if it prescribes this part of the square of its displacement.
    constexpr double most_of_square = 0.5;

    // Places that differ by less than this fraction of their coordinates are the same.
    constexpr double same_place = 1e-9;

    std::string component(const unsigned int d)
    {
      return {"xyz"[d]};
    }
  } // namespace

  bool RequestedBars::is_goal(const std::string &quantity) const
  {
    return std::find(goals.begin(), goals.end(), quantity) != goals.end();
  }

  bool RequestedBars::includes(const Functional &functional) const
  {
    return is_goal(functional.quantity) || (all && !functional.is_on_request);
  }

  bool RequestedBars::includes_some_of(const std::string &text) const
  {
    return all || std::any_of(goals.begin(), goals.end(), [&text](const std::string &goal) {
             return goal.rfind(text, 0) == 0;
           });
  }

  template <int dim>
  Functionals<dim>::Functionals(const StepSolver<dim>        &solver_,
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

  template <int dim>
  std::vector<Functional> Functionals<dim>::all() const
  {
    std::vector<Functional> list{displacement()};
    const auto             &scene = solver.discrete_scene();
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      {
        const std::string name = scene.contacts[k].name;
        list.push_back(normal_force(name + ".normal_force", k));
        list.push_back(tangential_force(name + ".tangential_force", k));
        list.push_back(pressure(name + ".max_pressure", k));
        list.push_back(pressure_norm(name + ".pressure_norm", k));
        list.push_back(traction_norm(name + ".traction_norm", k));
      }
    for (unsigned int s = 0; s < solver.n_given_supports(); ++s)
      for (unsigned int d = 0; d < dim; ++d)
        {
          list.push_back(reaction(scene.supports[s].name + ".force_" + component(d), s, d));
          if (holds(list.back()))
            continue;
          list.back().reason        = "the support holds nothing along " + component(d);
          list.back().is_infinite   = true;
          list.back().is_on_request = true;
        }
    for (unsigned int k = 0; k < scene.probes.size(); ++k)
      if (scene.probes[k].ends.size() == 1)
        for (unsigned int d = 0; d < dim; ++d)
          list.push_back(displacement_at(scene.probes[k].name + ".u_" + component(d), k, d));
    return list;
  }

  template <int dim>
  std::vector<mechanics::SingularPoint<dim>> Functionals<dim>::acting_points(const double t) const
  {
    const auto                                                   &scene = solver.discrete_scene();
    std::vector<std::pair<mechanics::SingularPoint<dim>, double>> acting; // with their forces
    double                                                        largest = 0;
    for (const auto &point : mechanics::force_points(scene, solver.mesh(), solver.spaces(), solver.n_given_supports()))
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

  template <int dim>
  bool Functionals<dim>::is_in_contact(const mechanics::SingularPoint<dim> &point) const
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

  template <int dim>
  std::string Functionals<dim>::infinite_at(const unsigned int body, const dealii::Point<dim> &place) const
  {
    for (const auto &point : points)
      if (point.body == body && point.position.distance(place) <= same_place * (place.norm() + point.position.norm()))
        return "it is infinite at " + point.what;
    return "";
  }

  template <int dim>
  dealii::Point<dim> Functionals<dim>::position_of(const unsigned int p, const unsigned int node) const
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

  template <int dim>
  Functional Functionals<dim>::displacement_at(const std::string &name,
                                               const unsigned int probe,
                                               const unsigned int d) const
  {
    Functional goal{name, "mm", 0, {}, probes.unit_force(probe, d), {}, false};
    double     own = 0;
    for (unsigned int p = 0; p < goal.loads.size(); ++p)
      own += goal.loads[p].dot(answer.recovery.u[p]);
    goal.value       = dealii::Utilities::MPI::sum(own, comm);
    goal.reason      = infinite_at(solver.discrete_scene().probes[probe].body, probes.positions()[probe][0].position);
    goal.is_infinite = !goal.reason.empty();
    return goal;
  }

  template <int dim>
  template <class F>
  void Functionals<dim>::for_points_of(const unsigned int pair, const F &f) const
  {
    for (const auto *points : {&rows.contact_points, &rows.bonded_points})
      for (const auto &point : *points)
        if (point.pair == pair)
          f(point);
    for (const auto &shared : rows.shared_points)
      if (shared.point.pair == pair)
        f(shared.point);
  }

  template <int dim>
  double Functionals<dim>::value_of(const std::vector<double> &g) const
  {
    double sum = 0;
    for (unsigned int r = 0; r < n_rows; ++r)
      sum += g[r] * x.local_element(r);
    return dealii::Utilities::MPI::sum(sum, comm);
  }

  template <int dim>
  Functional Functionals<dim>::normal_force(const std::string &name, const unsigned int pair) const
  {
    Functional goal{name, "N", 0, std::vector<double>(n_rows, 0.), {}, {}};
    for_points_of(pair, [&](const tfeti::ContactPoint &point) {
      if (point.normal_row != tfeti::invalid_row)
        goal.jumps[point.normal_row] = point.share;
    });
    goal.value = value_of(goal.jumps);
    return goal;
  }

  template <int dim>
  Functional Functionals<dim>::tangential_force(const std::string &name, const unsigned int pair) const
  {
    Functional goal{name, "N", 0, std::vector<double>(n_rows, 0.), {}, {}};
    for_points_of(pair, [&](const tfeti::ContactPoint &point) {
      const double size = tangential(point);
      for (const unsigned int row : {point.tangential_row, point.second_row})
        if (row != tfeti::invalid_row)
          goal.jumps[row] = point.tangential_share * (dim == 2 ? 1. : size > 0 ? x.local_element(row) / size : 0.);
    });
    goal.value = value_of(goal.jumps);
    return goal;
  }

  template <int dim>
  double Functionals<dim>::tangential(const tfeti::ContactPoint &point) const
  {
    const double along = point.tangential_row != tfeti::invalid_row ? x.local_element(point.tangential_row) : 0.;
    if (dim == 2)
      return along;
    return std::hypot(along, point.second_row != tfeti::invalid_row ? x.local_element(point.second_row) : 0.);
  }

  template <int dim>
  Functional Functionals<dim>::pressure(const std::string &name, const unsigned int pair) const
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

  template <int dim>
  Functional Functionals<dim>::pressure_norm(const std::string &name, const unsigned int pair) const
  {
    Functional square{name, "N/mm", 0, std::vector<double>(n_rows, 0.), {}, {}};
    for_points_of(pair, [&](const tfeti::ContactPoint &point) {
      if (point.normal_row != tfeti::invalid_row && point.traction_area > 0)
        square.jumps[point.normal_row] = point.share * x.local_element(point.normal_row) / point.traction_area;
    });
    square.value = value_of(square.jumps);
    return as_norm(std::move(square));
  }

  template <int dim>
  Functional Functionals<dim>::traction_norm(const std::string &name, const unsigned int pair) const
  {
    Functional square{name, "N/mm", 0, std::vector<double>(n_rows, 0.), {}, {}};
    for_points_of(pair, [&](const tfeti::ContactPoint &point) {
      const double part = point.tangential_share * point.tangential_share / point.share;
      for (const unsigned int row : {point.tangential_row, point.second_row})
        if (row != tfeti::invalid_row && point.traction_area > 0 && point.share > 0)
          square.jumps[row] = part * x.local_element(row) / point.traction_area;
    });
    square.value = value_of(square.jumps);
    return as_norm(std::move(square));
  }

  template <int dim>
  Functional Functionals<dim>::as_norm(Functional square) const
  {
    square.value = std::sqrt(square.value);
    if (square.value > 0)
      for (double &g : square.jumps)
        g /= square.value;
    return square;
  }

  template <int dim>
  Functional Functionals<dim>::reaction(const std::string &name, const unsigned int support, const unsigned int d) const
  {
    Functional goal{name, "N", 0, std::vector<double>(n_rows, 0.), {}, {}};
    // at nodes that several supports hold, each is given an equal share of the force, which may belong to either
    double shared = 0;
    for (const auto &reaction : rows.reactions)
      if (std::count(reaction.holders.begin(), reaction.holders.end(), support) > 0)
        {
          const double share = reaction.direction[d] / reaction.holders.size();
          goal.jumps[reaction.row] -= share;
          if (reaction.holders.size() > 1)
            shared += std::abs(share * x.local_element(reaction.row));
        }
    goal.value       = value_of(goal.jumps);
    goal.local_error = dealii::Utilities::MPI::sum(shared, comm);
    return goal;
  }

  template <int dim>
  bool Functionals<dim>::holds(const Functional &reaction) const
  {
    double largest = 0;
    for (const double g : reaction.jumps)
      largest = std::max(largest, std::abs(g));
    return dealii::Utilities::MPI::max(largest, comm) > along_axis;
  }

  template <int dim>
  std::vector<Eigen::VectorXd> Functionals<dim>::prescribed_squares() const
  {
    tfeti::DistributedVector given(rows.rows), shared(rows.interface_dofs);
    for (unsigned int r = 0; r < n_rows; ++r)
      given.local_element(r) = rows.kind[r] == tfeti::RowKind::prescribed ? rows.c[r] * rows.c[r] : 0.;
    given.update_ghost_values();
    const auto                  &u = answer.recovery.u;
    std::vector<Eigen::VectorXd> squares;
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        squares.push_back(Eigen::VectorXd::Zero(u[p].size() / dim));
        std::vector<unsigned int> interface_dof(u[p].size(), tfeti::invalid_row);
        for (const auto &entry : rows.interface_blocks[p])
          interface_dof[entry.dof] = entry.interface_dof;
        for (const auto &entry : rows.blocks[p])
          if (const double square = given.local_element(entry.row); square > 0)
            shared.local_element(interface_dof[entry.dof]) += entry.value * entry.value * square;
      }
    shared.compress(dealii::VectorOperation::add);
    shared.update_ghost_values();
    for (unsigned int p = 0; p < u.size(); ++p)
      for (const auto &entry : rows.interface_blocks[p])
        squares[p][entry.dof / dim] += shared.local_element(entry.interface_dof);
    return squares;
  }

  template <int dim>
  Functional Functionals<dim>::displacement() const
  {
    struct Place
    {
      double       size = 0;
      unsigned int p = 0, node = 0;
    };
    Functional  goal{"max_displacement", "mm", 0, {}, {}, {}, false};
    Place       all, free; // the largest of all nodes, and of those that no support moves
    const auto &u       = answer.recovery.u;
    const auto  squares = prescribed_squares();
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        goal.loads.push_back(Eigen::VectorXd::Zero(u[p].size()));
        for (unsigned int i = 0; i < u[p].size() / dim; ++i)
          {
            const double size = u[p].template segment<dim>(dim * i).norm();
            if (size > all.size)
              all = {size, p, i};
            if (size > free.size && squares[p][i] < most_of_square * size * size)
              free = {size, p, i};
          }
      }
    goal.value = dealii::Utilities::MPI::max(all.size, comm);
    if (!(goal.value > 0))
      {
        goal.reason = "nothing moves";
        return goal;
      }
    // a prescribed displacement has no error, but that of another node may exceed it
    const double       largest_free = dealii::Utilities::MPI::max(free.size, comm);
    const Place       &at           = largest_free > 0 ? free : all;
    const double       size         = largest_free > 0 ? largest_free : goal.value;
    const unsigned int rank         = dealii::Utilities::MPI::this_mpi_process(comm);
    const unsigned int best         = dealii::Utilities::MPI::min(at.size == size ? rank : tfeti::invalid_row, comm);
    goal.shortfall                  = goal.value - size;
    if (best == rank)
      {
        goal.loads[at.p].template segment<dim>(dim * at.node) = u[at.p].template segment<dim>(dim * at.node) / size;
        goal.reason = infinite_at(solver.mesh().subdomains[at.p]->body, position_of(at.p, at.node));
      }
    goal.reason = dealii::Utilities::MPI::broadcast(comm, goal.reason, best);
    return goal;
  }

  template class Functionals<2>;
  template class Functionals<3>;
} // namespace slipstick::app
