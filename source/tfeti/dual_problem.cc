#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/qp/box.h>
#include <slipstick/tfeti/dense.h>
#include <slipstick/tfeti/dual_problem.h>
#include <slipstick/tfeti/gathered_by_label.h>
#include <slipstick/tfeti/operator_choice.h>
#include <slipstick/tfeti/rigid_motions.h>

#include <deal.II/base/mpi.h>

namespace slipstick::tfeti
{
  namespace
  {
    /// A number in (-1, 1) from a label: the start of Lanczos' method is the same for every number of ranks.
    double random_number(std::uint64_t label)
    {
      label ^= label >> 33; // finaliser of MurmurHash3
      label *= 0xff51afd7ed558ccdull;
      label ^= label >> 33;
      label *= 0xc4ceb9fe1a85ec53ull;
      label ^= label >> 33;
      return static_cast<double>(label >> 11) / static_cast<double>(1ull << 52) - 1.;
    }

    // Residuals are projected twice when stiffnesses of rows differ by more than this factor.
    constexpr double large_stiffness_ratio = 1e3;
    // What the projection leaves of a residual is rounding below this part of it: bodies that supports move without deforming them.
    constexpr double rounding_of_projection = 1e-14;
  } // namespace

  DualProblem::DualProblem(std::vector<SubdomainMatrices>  matrices,
                           Constraints                     constraints,
                           const DualOptions              &options,
                           const std::vector<std::string> &body_names,
                           const MPI_Comm                  comm)
    : DualProblem(std::make_shared<Subdomains>(std::move(matrices)), std::move(constraints), options, body_names, comm)
  {}

  DualProblem::DualProblem(std::shared_ptr<Subdomains>     subdomains,
                           Constraints                     constraints,
                           const DualOptions              &options,
                           const std::vector<std::string> &body_names,
                           const MPI_Comm                  comm)
    : comm(comm)
    , reduce(comm)
    , rows(std::move(constraints))
    , owned_rows(std::make_shared<dealii::Utilities::MPI::Partitioner>(rows.rows->locally_owned_range(), comm))
    , names_of_bodies(body_names)
    , parts(std::move(subdomains))
    , systems(parts->systems)
  {
    const bool   explicit_blocks = is_explicit(options, parts->n_unknowns(), rows, comm);
    const double seconds_before  = parts->factorization_seconds();
    collectively(comm, [&] {
      std::vector<std::vector<unsigned int>> touched;
      for (const auto &block : rows.blocks)
        {
          auto [local, unknowns] = LocalGluing::make(block);
          gluing.push_back(std::move(local));
          touched.push_back(std::move(unknowns));
        }
      parts->prepare(touched, explicit_blocks, options);
    });
    factorization_time = parts->factorization_seconds() - seconds_before;
    F      = std::make_unique<DualOperator>(systems, gluing, rows.rows, explicit_blocks ? &parts->inverses : nullptr);
    bodies = std::make_unique<BodyMotions>(systems, gluing, rows, body_names.size(), comm);
    require_support(bodies->free({}), body_names);
    held_by_contact = std::make_unique<BodyEquilibrium>(*bodies, rows, comm);
    if (options.preconditioner == Preconditioner::lumped || options.preconditioner == Preconditioner::dirichlet)
      {
        preconditioner = std::make_unique<RowPreconditioner>(systems,
                                                             gluing,
                                                             *F,
                                                             rows.rows,
                                                             comm,
                                                             options.preconditioner == Preconditioner::dirichlet
                                                               ? &parts->schur_complements
                                                               : nullptr);
        make_metric();
      }
    std::vector<bool> has_no_bounds;
    for (const RowKind kind : rows.kind)
      has_no_bounds.push_back(is_equality(kind));
    projector = std::make_unique<Projector>(systems, gluing, *F, rows.rows, has_no_bounds, comm);

    is_single = explicit_blocks && options.operator_precision == Precision::single_precision;
    set_dual_load();
    norm_PFP              = lanczos(options);
    setup_multiplications = F->n_applications();
  }

  // Stiffnesses of the rows, their own compliance included.
  void DualProblem::make_metric()
  {
    metric = preconditioner->weights().stiffnesses();
    if (dealii::Utilities::MPI::max(rows.compliance.empty() ? 0 : 1, comm) > 0)
      yielding.assign(metric.size(), 1.);
    for (unsigned int r = 0; r < rows.compliance.size(); ++r)
      {
        const double part = 1 / (1 + rows.compliance[r] * metric[r]);
        metric[r] *= part;
        yielding[r] = std::sqrt(part);
      }
    least_stiffness =
      dealii::Utilities::MPI::min(metric.empty() ? qp::infinity : *std::min_element(metric.begin(), metric.end()),
                                  comm);
    for (double &stiffness : metric)
      stiffness /= least_stiffness;
    for (const auto &point : rows.contact_points) // both tangents of a node alike: discs stay round
      if (point.tangential_row != invalid_row && point.second_row != invalid_row)
        metric[point.tangential_row] = metric[point.second_row] =
          std::sqrt(metric[point.tangential_row] * metric[point.second_row]);
    projects_twice = dealii::Utilities::MPI::max(metric.empty() ? 1. : *std::max_element(metric.begin(), metric.end()),
                                                 comm) > large_stiffness_ratio;
  }

  void DualProblem::set_step(std::vector<Eigen::VectorXd> loads, std::vector<double> c)
  {
    parts->set_loads(std::move(loads));
    set_right_hand_side(std::move(c));
  }

  void DualProblem::set_right_hand_side(std::vector<double> c)
  {
    rows.c = std::move(c);
    set_dual_load();
  }

  // d = B K+ f - c, and e
  void DualProblem::set_dual_load()
  {
    dual_load = jumps(parts->unconstrained());
    for (unsigned int r = 0; r < rows.c.size(); ++r)
      dual_load.local_element(r) -= rows.c[r];
    correction = zero();
    resultants.resize(0);
    for (const auto &system : systems)
      {
        const Eigen::VectorXd part = system->kernel().transpose() * system->load();
        resultants.conservativeResize(resultants.size() + part.size());
        resultants.tail(part.size()) = part;
      }
    if (!held_by_contact->empty())
      held_by_contact->set_loads(bodies->loads());
  }

  double DualProblem::refine(const DistributedVector &x)
  {
    if (!is_single)
      return 0;
    DistributedVector error = zero(), approximate = zero();
    F->apply_by_solves(x, error);
    F->apply(x, approximate);
    error -= approximate;
    DistributedVector change = error, range = zero();
    change -= correction;
    dual_load -= change;
    correction = error;
    projector->project_range(change, range);
    change -= range;
    return change.l2_norm() / norm_PFP;
  }

  void DualProblem::apply_F(const DistributedVector &x, DistributedVector &y) const
  {
    F->apply(x, y);
    for (unsigned int r = 0; r < rows.compliance.size(); ++r)
      y.local_element(r) += rows.compliance[r] * x.local_element(r);
  }

  // Lanczos 1950: the largest Ritz value, from below.
  double DualProblem::lanczos(const DualOptions &options) const
  {
    DistributedVector x = zero(), y = zero(), q = zero(), before = zero();
    for (unsigned int r = 0; r < rows.label.size(); ++r)
      x.local_element(r) = random_number(rows.label[r]);
    projector->project_range(x, q);
    x -= q;
    double              norm = 0, coupling = x.l2_norm();
    std::vector<double> diagonal, off_diagonal;
    if (coupling == 0)
      return 1;
    x /= coupling;
    for (unsigned int k = 0; k < options.max_norm_iterations; ++k)
      {
        apply_F(x, y);
        projector->project_range(y, q);
        y -= q;
        diagonal.push_back(x * y);
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> tridiagonal;
        tridiagonal.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), diagonal.size()),
                                           Eigen::Map<const Eigen::VectorXd>(off_diagonal.data(), off_diagonal.size()),
                                           Eigen::EigenvaluesOnly);
        const double previous = norm;
        norm                  = tridiagonal.eigenvalues().tail(1)[0];
        if (std::abs(norm - previous) <= options.norm_tolerance * norm)
          break;
        y.add(-diagonal.back(), x);
        if (k > 0)
          y.add(-coupling, before);
        coupling = y.l2_norm();
        if (coupling == 0)
          break;
        off_diagonal.push_back(coupling);
        y /= coupling;
        std::swap(before, x);
        std::swap(x, y);
      }
    return norm > 0 ? norm : 1.;
  }

  void DualProblem::multiply(const DistributedVector &x, DistributedVector &y) const
  {
    apply_F(x, y);
    y /= norm_PFP;
  }

  void DualProblem::project_range(const DistributedVector &x, DistributedVector &y) const
  {
    projector->project_range(x, y);
  }

  const MpiReduction &DualProblem::reduction() const
  {
    return reduce;
  }

  double DualProblem::residual_norm(const DistributedVector &r) const
  {
    const Face        all = face(std::vector<bool>(r.locally_owned_size(), true));
    DistributedVector part(r), range = zero();
    all.project_range(r, range);
    part -= range;
    const auto weights = qp::residual_weights(*this, 0);
    const auto squares = reduce.sum(
      std::array<double, 2>{{qp::local_weighted_dot(weights, part, part), qp::local_weighted_dot(weights, r, r)}});
    const double norm = std::sqrt(squares[0]);
    return norm <= rounding_of_projection * std::sqrt(squares[1]) ? 0. : norm;
  }

  DualProblem::JumpEnergies DualProblem::jump_energies(const DistributedVector &r, const std::vector<bool> &held) const
  {
    std::optional<RowPreconditioner> lumped;
    if (!preconditioner)
      lumped.emplace(systems, gluing, *F, rows.rows, comm, nullptr);
    const RowPreconditioner &M        = preconditioner ? *preconditioner : *lumped;
    const auto               energies = M.energies(RowWeights::Inverse(M.weights(), held), r);
    const std::size_t        n_bodies = names_of_bodies.size();
    JumpEnergies             result{Eigen::VectorXd::Zero(n_bodies), std::vector<JumpEnergies::Spot>(n_bodies)};
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        const unsigned int body = systems[p]->body();
        result.of_body[body] += energies[p].sum();
        Eigen::Index k;
        if (energies[p].size() > 0 && energies[p].maxCoeff(&k) > result.spots[body].energy)
          result.spots[body] = {energies[p][k], p, static_cast<unsigned int>(k)};
      }
    MPI_Allreduce(MPI_IN_PLACE, result.of_body.data(), result.of_body.size(), MPI_DOUBLE, MPI_SUM, comm);
    return result;
  }

  std::vector<bool> DualProblem::ambiguous(const std::vector<bool> &free) const
  {
    std::vector<bool> rigid = free; // rows that yield are determined by that
    for (unsigned int r = 0; r < rows.compliance.size(); ++r)
      rigid[r] = rigid[r] && rows.compliance[r] == 0;
    return (preconditioner ? preconditioner->weights() : RowWeights(systems, gluing, rows.rows, comm)).ambiguous(rigid);
  }

  DistributedVector DualProblem::zero() const
  {
    return DistributedVector(owned_rows);
  }

  DistributedVector DualProblem::particular() const
  {
    DistributedVector x = zero();
    projector->particular(resultants, x);
    return x;
  }

  DistributedVector DualProblem::jumps(const std::vector<Eigen::VectorXd> &u) const
  {
    DistributedVector sum = F->ghosted(), y = zero();
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        const auto     &touched = systems[p]->touched();
        Eigen::VectorXd v(touched.size());
        for (unsigned int k = 0; k < touched.size(); ++k)
          v[k] = u[p][touched[k]];
        F->gather(p, v, sum);
      }
    sum.compress(dealii::VectorOperation::add);
    y.copy_locally_owned_data_from(sum);
    return y;
  }

  DistributedVector DualProblem::column(const unsigned int subdomain, const unsigned int touched) const
  {
    DistributedVector sum = F->ghosted(), y = zero();
    if (subdomain < systems.size())
      F->gather(subdomain, Eigen::VectorXd::Unit(systems[subdomain]->touched().size(), touched), sum);
    sum.compress(dealii::VectorOperation::add);
    y.copy_locally_owned_data_from(sum);
    return y;
  }

  std::vector<Eigen::VectorXd> DualProblem::forces(const DistributedVector &x) const
  {
    DistributedVector ghosted = F->ghosted();
    F->import(x, ghosted);
    std::vector<Eigen::VectorXd> result;
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        const Eigen::VectorXd at_touched = F->scatter(p, ghosted);
        const auto           &touched    = systems[p]->touched();
        result.push_back(Eigen::VectorXd::Zero(systems[p]->n_unknowns()));
        for (unsigned int k = 0; k < touched.size(); ++k)
          result[p][touched[k]] = at_touched[k];
      }
    return result;
  }

  RigidMotion DualProblem::motion_behind(const DistributedVector &r) const
  {
    return body_motion(systems, projector->amplitudes(r), names_of_bodies.size(), comm);
  }
} // namespace slipstick::tfeti
