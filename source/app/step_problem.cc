#include <slipstick/app/names.h>
#include <slipstick/app/report.h>
#include <slipstick/app/step_problem.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/turned.h>
#include <slipstick/interface/contact_search.h>
#include <slipstick/interface/held_contact.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/interface/shared_sides.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mechanics/auxiliary_supports.h>
#include <slipstick/mechanics/inertia_relief.h>
#include <slipstick/mechanics/loads.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/tfeti/dense.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>
#include <map>

namespace slipstick::app
{
  namespace
  {
    // Initially contact nodes get multipliers if their gap exceeds the smallest gap of the pair by less than this
    // fraction of the slave boundary's length ...
    constexpr double first_kept_part = 0.1;
    // ... the fraction grows by this factor if other nodes would penetrate ...
    constexpr double growth_of_kept_part = 4;
    // ... above this all nodes get multipliers.
    constexpr double largest_kept_part = 1;

    // Where the mesh cuts an outline unevenly, loads may do up to this part of their largest work along motions along
    // which those of the scene do none: half a circle of 16 edges refined, 8e-3.
    constexpr double work_of_discretization = 1e-2;

    // Of coefficients of rows, which are of the size of 1.
    constexpr double rounding_of_coefficients = 1e-9;

    constexpr double all_kept = std::numeric_limits<double>::infinity();

    template <int dim>
    std::vector<std::string> names_of(const std::vector<scene::Body<dim>> &bodies)
    {
      std::vector<std::string> names;
      for (const auto &body : bodies)
        names.push_back(body.name);
      return names;
    }

    /// Obstacles know the smallest body that may touch them.
    template <int dim>
    void set_extents_of_obstacles(const std::vector<double> &sizes, scene::Scene<dim> &scene)
    {
      std::map<unsigned int, double> extents; // by obstacle
      for (const auto &pair : scene.contacts)
        if (!pair.master)
          {
            double &extent = extents.emplace(pair.obstacle, sizes[pair.slave.body]).first->second;
            extent         = std::min(extent, sizes[pair.slave.body]);
          }
      for (const auto &[obstacle, extent] : extents)
        scene.obstacles[obstacle].extent = extent;
    }

    std::string in_words(const std::vector<tfeti::RigidMotion> &motions, const std::vector<std::string> &body_names)
    {
      std::string text;
      for (const auto &motion : tfeti::disentangled(motions))
        text += (text.empty() ? "" : ", nor ") + tfeti::describe(motion, body_names);
      return text;
    }
  } // namespace

  template <int dim>
  StepProblem<dim>::StepProblem(const scene::Scene<dim>    &scene_,
                                const Log                  &log_,
                                StageClock                 &clock_,
                                const MPI_Comm              comm_,
                                const scene::SolverOptions &options,
                                mesh::Refinement           *refinement)
    : scene(scene_)
    , log(log_)
    , clock(clock_)
    , comm(comm_)
    , prunes(options.prune_contact)
    , dual_options(options.dual)
    , n_given(scene_.supports.size())
    , kept_fraction(first_kept_part)
  {
    print_header(log, scene, comm);
    clock.enter("mesh");
    mesh_ptr   = std::make_unique<mesh::Mesh<dim>>(mesh::make_mesh(scene, comm, refinement));
    spaces_ptr = std::make_unique<mechanics::Spaces<dim>>(*mesh_ptr, scene.discretization.degree);
    print_mesh(log, scene, *mesh_ptr, *spaces_ptr);
    set_extents_of_obstacles(mesh_ptr->sizes, scene);
    for (auto &pair : interface::find_contacts(scene, *mesh_ptr, *spaces_ptr))
      {
        log.line("contact      found between " + pair.name);
        scene.contacts.push_back(std::move(pair));
      }
    interface::check_overlap(scene, *mesh_ptr, *spaces_ptr);
    interface::check_obstacle_pairs(scene, *mesh_ptr, *spaces_ptr);
    interface::check_shared_sides(scene, *mesh_ptr, *spaces_ptr);
  }

  template <int dim>
  void StepProblem<dim>::build(const double t)
  {
    if (prunes && kept_fraction < all_kept)
      try
        {
          make_dual(t);
          return;
        }
      catch (const NoEquilibrium &) // on all ranks
        {
          if (pruned.rows->size() == 0)
            throw;
          kept_fraction = all_kept;
        }
    kept_fraction = all_kept;
    make_dual(t);
  }

  // When a load history returns to zero, rounding errors of its formulas remain.
  template <int dim>
  void StepProblem<dim>::drop_rounding(std::vector<Eigen::VectorXd> &loads)
  {
    constexpr double rounding = 1e-12; // of the largest load so far
    double           square   = 0;
    for (const auto &load : loads)
      square += load.squaredNorm();
    const double size = std::sqrt(dealii::Utilities::MPI::sum(square, comm));
    if (size <= rounding * largest_load_so_far)
      for (auto &load : loads)
        load.setZero();
    largest_load_so_far = std::max(largest_load_so_far, size);
  }

  template <int dim>
  std::vector<Eigen::VectorXd> StepProblem<dim>::loads_at(const double t)
  {
    auto loads = mechanics::assemble_loads(scene, *mesh_ptr, *spaces_ptr, t);
    if (all_bolts)
      all_bolts->add_loads(bolts_so_far.shortening(), loads);
    drop_rounding(loads);
    if (!balanced.empty() || still_work.size() > 0)
      balance(still_work, loads);
    return loads;
  }

  // Repeated for every step if a motion is not held, since the loads of the step may drive it.
  template <int dim>
  void StepProblem<dim>::make_dual(const double t)
  {
    scene.supports.erase(scene.supports.begin() + n_given, scene.supports.end());
    held_still.clear();
    still_work.resize(0);
    balanced.clear();
    std::vector<tfeti::RigidMotion> unheld;
    try
      {
        make_dual_as_it_is(t);
        return;
      }
    catch (const tfeti::UnheldMotions &error) // on all ranks
      {
        if (pruned.rows->size() > 0) // perhaps held by pruned contact nodes
          throw;
        unheld = error.motions;
      }
    catch (const tfeti::DrivenMotions &error) // on all ranks
      {
        if (pruned.rows->size() > 0 || !is_undriven || error.work > work_of_discretization)
          throw;
        unheld = balanced = error.motions;
      }
    unheld_motions = in_words(unheld, names_of(scene.bodies));
    std::vector<Eigen::VectorXd> motions;
    for (const auto &motion : unheld)
      motions.push_back(motion.amplitudes);
    for (auto &support : mechanics::auxiliary_supports(*mesh_ptr, *spaces_ptr, motions, unheld.front().frames))
      scene.supports.push_back(std::move(support));
    make_dual_as_it_is(t);
    held_still = std::move(unheld);
  }

  template <int dim>
  void StepProblem<dim>::balance(Eigen::VectorXd work, std::vector<Eigen::VectorXd> &loads)
  {
    if (!inertia)
      inertia = mechanics::rigid_body_forces(scene, *mesh_ptr, *spaces_ptr);
    const Eigen::Index n        = work.size() > 0 ? work.size() : balanced.front().amplitudes.size();
    const Eigen::Index n_bodies = scene.bodies.size(), k = n / n_bodies;
    Eigen::MatrixXd    sums = Eigen::MatrixXd::Zero(n, k + 1); // of every body: work of body forces and loads
    for (unsigned int p = 0; p < loads.size(); ++p)
      {
        const auto           &system  = *subdomains->systems[p];
        const Eigen::MatrixXd motions = system.kernel() * system.body_modes();
        sums.block(system.body() * k, 0, k, k) += motions.transpose() * (*inertia)[p];
        sums.block(system.body() * k, k, k, 1) += motions.transpose() * loads[p];
      }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), sums.size(), MPI_DOUBLE, MPI_SUM, comm);
    if (work.size() == 0)
      work = Eigen::VectorXd::Zero(n);
    for (const auto &motion : balanced)
      work += motion.amplitudes.dot(sums.col(k)) * motion.amplitudes;
    for (unsigned int p = 0; p < loads.size(); ++p)
      {
        const Eigen::Index first = subdomains->systems[p]->body() * k;
        loads[p] -= (*inertia)[p] * tfeti::shortest_solution(sums.block(first, 0, k, k), work.segment(first, k));
      }
  }

  template <int dim>
  void StepProblem<dim>::make_dual_as_it_is(const double t)
  {
    clock.enter("assembly");
    if (subdomains)
      subdomains->set_loads(loads_at(t));
    else
      {
        auto matrices = mechanics::assemble(scene, *mesh_ptr, *spaces_ptr, t);
        if (!scene.pretensions.empty())
          {
            all_bolts.emplace(scene, matrices, comm);
            bolts_so_far = mechanics::Tightening(all_bolts->stiffnesses(), all_bolts->lengths());
          }
        std::vector<Eigen::VectorXd> loads;
        for (const auto &subdomain : matrices)
          loads.push_back(subdomain.load);
        drop_rounding(loads); // the first loads: the reference for later ones
        subdomains = std::make_shared<tfeti::Subdomains>(std::move(matrices));
      }
    auto rows           = contact_rows(t);
    load_factor_of_rows = t;
    pruned              = std::move(rows.pruned);
    held                = std::move(rows.held);
    interface::refuse_held_penetration(scene, held, comm);
    print_constraints(log, rows.active);
    const auto resisting = resisting_rows(t);

    clock.enter("dual setup");
    dual_ptr.reset();
    dual_ptr = std::make_unique<tfeti::DualProblem>(subdomains,
                                                    std::move(rows.active),
                                                    dual_options,
                                                    names_of(scene.bodies),
                                                    comm,
                                                    resisting ? &*resisting : nullptr);
    factorization += dual_ptr->set_up().factorization_seconds;
    print_dual(log, *dual_ptr);
  }

  template <int dim>
  interface::ContactRows StepProblem<dim>::contact_rows(const double t) {
    if (!contacts)
      contacts = interface::pair_bodies(scene, *mesh_ptr, *spaces_ptr);
    return interface::contact_rows(scene, *mesh_ptr, *spaces_ptr, *contacts, t, kept_fraction);
  }

  template <int dim>
  std::optional<tfeti::Constraints> StepProblem<dim>::resisting_rows(const double t) const
  {
    if (scene.supports.size() > n_given) // auxiliary supports hold what is free
      return std::nullopt;
    const auto rotating = interface::with_rotating_gaps(scene, *mesh_ptr, *spaces_ptr, *contacts);
    if (!rotating)
      return std::nullopt;
    return interface::contact_rows(scene, *mesh_ptr, *spaces_ptr, *rotating, t, kept_fraction).active;
  }

  template <int dim>
  typename StepProblem<dim>::Rows StepProblem<dim>::compare(const tfeti::Constraints &rows) const
  {
    const auto &present = dual_ptr->constraints();
    const bool  is_same = scene.supports.size() == n_given && rows.label == present.label &&
                         rows.contact_points.size() == present.contact_points.size();
    bool is_moved = !is_same || rows.blocks.size() != present.blocks.size();
    for (unsigned int p = 0; p < rows.blocks.size() && !is_moved; ++p)
      is_moved = !std::equal(rows.blocks[p].begin(),
                             rows.blocks[p].end(),
                             present.blocks[p].begin(),
                             present.blocks[p].end(),
                             [](const auto &a, const auto &b) {
                               return a.row == b.row && a.dof == b.dof &&
                                      std::abs(a.value - b.value) <= rounding_of_coefficients;
                             });
    const std::array<unsigned int, 2> own{{is_same ? 0u : 1u, is_moved ? 1u : 0u}};
    std::array<unsigned int, 2>       any{};
    dealii::Utilities::MPI::max(dealii::ArrayView<const unsigned int>(own.data(), own.size()),
                                comm,
                                dealii::ArrayView<unsigned int>(any.data(), any.size()));
    return any[0] > 0 ? Rows::others : any[1] > 0 ? Rows::moved : Rows::same;
  }

  template <int dim>
  typename StepProblem<dim>::Rows StepProblem<dim>::advance(const double t, const std::vector<Eigen::VectorXd> &u)
  {
    clock.enter("assembly");
    auto loads = loads_at(t);
    auto rows  = contact_rows(t);
    Rows which = compare(rows.active);
    if (which == Rows::same) // gaps that depend on the load factor may prune other nodes
      {
        pruned = std::move(rows.pruned);
        held   = std::move(rows.held);
        interface::refuse_held_penetration(scene, held, comm);
        clock.enter("dual setup");
        dual_ptr->set_gaps(rows.active.contact_points);
        dual_ptr->set_step(std::move(loads), std::move(rows.active.c));
      }
    else
      {
        build(t);
        if (compare(rows.active) == Rows::others) // with rows for pruned nodes
          which = Rows::others;
      }
    start_slip_from(u);
    return which;
  }

  template <int dim>
  void StepProblem<dim>::start_slip_from(const std::vector<Eigen::VectorXd> &u)
  {
    auto       c     = dual_ptr->constraints().c;
    const auto jumps = dual_ptr->dual_operator().jumps(u);
    for (unsigned int r = 0; r < c.size(); ++r)
      if (dual_ptr->constraints().kind[r] == tfeti::RowKind::tangential)
        c[r] = jumps.local_element(r);
    dual_ptr->set_right_hand_side(std::move(c));
  }

  template <int dim>
  void StepProblem<dim>::keep_more(const double t)
  {
    kept_fraction = kept_fraction < largest_kept_part ? growth_of_kept_part * kept_fraction : all_kept;
    build(t);
  }

  template <int dim>
  double StepProblem<dim>::penetration_of_pruned(const std::vector<Eigen::VectorXd> &u) const
  {
    return interface::largest_penetration(pruned, u, comm);
  }

  template <int dim>
  void StepProblem<dim>::reload(const double t)
  {
    clock.enter("assembly");
    dual_ptr->set_step(loads_at(t), dual_ptr->constraints().c);
  }

  template <int dim>
  bool StepProblem<dim>::spread_still_forces(const tfeti::DistributedVector &multipliers, const double largest_forces)
  {
    constexpr double rounding = 1e-8; // of all multipliers and nodal loads, also those of earlier steps
    if (held_still.empty())
      return false;
    const auto         &kind  = dual_ptr->constraints().kind;
    const auto          jumps = dual_ptr->body_motions().jumps(held_still);
    std::vector<double> work(held_still.size() + 1, 0.); // along the motions; squares of multipliers
    for (unsigned int r = 0; r < kind.size(); ++r)
      {
        const double x = multipliers.local_element(r);
        work.back() += x * x;
        for (decltype(jumps)::InnerIterator jump(jumps, r); jump && kind[r] == tfeti::RowKind::prescribed; ++jump)
          work[jump.col()] += jump.value() * x;
      }
    MPI_Allreduce(MPI_IN_PLACE, work.data(), work.size(), MPI_DOUBLE, MPI_SUM, comm);
    Eigen::VectorXd more = Eigen::VectorXd::Zero(held_still.front().amplitudes.size());
    for (unsigned int m = 0; m < held_still.size(); ++m)
      more += work[m] * held_still[m].amplitudes;
    if (more.norm() <= rounding * std::max({std::sqrt(work.back()), largest_forces, largest_load_so_far}))
      return false;
    still_work = still_work.size() > 0 ? Eigen::VectorXd(still_work + more) : more;
    return true;
  }

  template <int dim>
  Resultant StepProblem<dim>::still_forces() const
  {
    Resultant          sum;
    const unsigned int k = mesh::Kinematics<dim>(scene.plane_state).n_rigid_motions(); // of a body
    for (unsigned int b = 0; k * b < still_work.size(); ++b)
      {
        const auto &frame = held_still.front().frames[b];
        const auto  work  = still_work.segment(k * b, k);
        if (k == 1) // of revolution: along the axis
          {
            sum.force[1] -= work[0];
            continue;
          }
        std::array<double, dim> force;
        for (unsigned int d = 0; d < dim; ++d)
          force[d] = -work[d];
        sum.add<dim>(force, frame.center);
        for (unsigned int m = 0; m < n_rotations<dim>; ++m)
          sum.moment[dim == 2 ? 2 : m] -= frame.length * work[dim + m];
      }
    return sum;
  }

  template <int dim>
  void StepProblem<dim>::begin_bolts(const double t)
  {
    std::vector<std::optional<double>> wanted;
    for (const auto &bolt : scene.pretensions)
      {
        const double force = t <= bolt.tightened_until ? bolt.force.value(bolt.point, t) : 0.;
        wanted.push_back(force > 0 ? std::optional(force) : std::nullopt);
      }
    bolts_so_far.begin(wanted);
  }

  template class StepProblem<2>;
  template class StepProblem<3>;
} // namespace slipstick::app
