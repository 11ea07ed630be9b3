#include <slipstick/base/collective.h>
#include <slipstick/tfeti/dense.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/qp/box.h>
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

    // Friction rows hold loose motions if the shares of a choice of them differ by no more than this factor.
    constexpr double least_hold = 1e-8;
    // Newton steps of the amounts by which loose bodies slide, and the change at which they end.
    constexpr unsigned int max_slide_steps = 100;
    constexpr double       slide_tolerance = 1e-14;

    // Residuals are projected twice when stiffnesses of rows differ by more than this factor.
    constexpr double large_stiffness_ratio = 1e3;

    void require_support(const std::vector<RigidMotion> &motions, const std::vector<std::string> &body_names)
    {
      if (motions.empty())
        return;
      const auto        motion = plainest(motions);
      const std::string text   = "nothing holds " + describe(motion, body_names);
      const std::string others = motions.size() > 1 ? format(" (one of %zu free motions)", motions.size()) : "";
      const std::string remedy = "add a support or a contact that acts against this motion";
      if (motion.work > 0)
        throw NoEquilibrium(text + ", where the loads push" + others, remedy);
      throw UnheldMotions(text + "; no load acts along it, but the position is not determined" + others,
                          remedy,
                          motions);
    }
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
    return std::sqrt(
      reduce.sum(std::array<double, 1>{{qp::local_weighted_dot(qp::residual_weights(*this, 0), part, part)}})[0]);
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

  bool DualProblem::hold_by(const std::vector<RigidMotion> &loose,
                            const std::vector<bool>        &is_candidate,
                            const std::vector<double>      &scale,
                            std::vector<bool>              &free) const
  {
    const Eigen::MatrixXd            own = bodies->jumps(loose).toDense();
    std::vector<std::vector<double>> candidates;
    std::vector<std::uint64_t>       labels;
    for (unsigned int r = 0; r < free.size(); ++r)
      if (is_candidate[r])
        {
          const Eigen::VectorXd share = scale[r] * own.row(r);
          candidates.emplace_back(share.data(), share.data() + share.size());
          labels.push_back(rows.label[r]);
        }
    const auto all = gathered_by_label(labels, candidates, comm);
    if (all.empty()) // Eigen's decomposition of a matrix without columns reads out of bounds
      return false;
    Eigen::MatrixXd shares(loose.size(), all.size());
    unsigned int    column = 0;
    for (const auto &candidate : all)
      shares.col(column++) = Eigen::Map<const Eigen::VectorXd>(candidate.second.data(), loose.size());
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> pivoted(shares);
    // of unit motions; shares that are only rounding hold nothing
    pivoted.setThreshold(least_hold * std::max(1., 1 / std::max(pivoted.maxPivot(), least_hold)));
    if (pivoted.rank() < static_cast<Eigen::Index>(loose.size()))
      return false;
    std::set<std::uint64_t> chosen;
    for (unsigned int i = 0; i < loose.size(); ++i)
      chosen.insert(std::next(all.begin(), pivoted.colsPermutation().indices()[i])->first);
    for (unsigned int r = 0; r < free.size(); ++r)
      free[r] = free[r] || (is_candidate[r] && chosen.count(rows.label[r]) > 0);
    return true;
  }

  bool DualProblem::rows_that_fix(const std::vector<RigidMotion> &loose,
                                  const DistributedVector        &x,
                                  const bool                      keeps_still,
                                  std::vector<bool>              &free) const
  {
    const double              noise = force_rounding * x.linfty_norm();
    const std::vector<double> equal(free.size(), 1.);
    std::vector<bool>         is_candidate(free.size());
    for (unsigned int r = 0; r < free.size(); ++r)
      is_candidate[r] = !free[r] && rows.kind[r] == RowKind::tangential && std::abs(x.local_element(r)) > noise;
    if (hold_by(loose, is_candidate, equal, free))
      return true;
    if (!keeps_still || plainest(loose).work > 0)
      require_support(loose, names_of_bodies);
    for (unsigned int r = 0; r < free.size(); ++r)
      is_candidate[r] = !free[r];
    if (!hold_by(loose, is_candidate, equal, free))
      require_support(loose, names_of_bodies);
    return false;
  }

  void DualProblem::remove_motions(const std::vector<RigidMotion> &loose, std::vector<Eigen::VectorXd> &u) const
  {
    const std::size_t n    = loose.size();
    Eigen::MatrixXd   gram = Eigen::MatrixXd::Zero(n, n + 1); // the last column: of u
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        Eigen::MatrixXd motions(u[p].size(), n);
        for (std::size_t m = 0; m < n; ++m)
          motions.col(m) = bodies->displacements(p, loose[m].amplitudes);
        gram.leftCols(n) += motions.transpose() * motions;
        gram.col(n) += motions.transpose() * u[p];
      }
    MPI_Allreduce(MPI_IN_PLACE, gram.data(), gram.size(), MPI_DOUBLE, MPI_SUM, comm);
    const Eigen::VectorXd amount     = shortest_solution(gram.leftCols(n), gram.col(n));
    Eigen::VectorXd       amplitudes = Eigen::VectorXd::Zero(loose[0].amplitudes.size());
    for (std::size_t m = 0; m < n; ++m)
      amplitudes += amount[m] * loose[m].amplitudes;
    for (unsigned int p = 0; p < systems.size(); ++p)
      u[p] -= bodies->displacements(p, amplitudes);
  }

  // Moves bodies along loose motions until no row at a bound is on the wrong side: least sum of squares of the violations.
  void DualProblem::slide_apart(const std::vector<RigidMotion> &loose,
                                const std::vector<bool>        &free,
                                const DistributedVector        &x,
                                Recovery                       &at) const
  {
    const Eigen::MatrixXd            own  = bodies->jumps(loose).toDense();
    const DistributedVector          jump = jumps(at.u);
    std::vector<std::vector<double>> conditions; // jump on the right side, then its derivatives
    for (unsigned int r = 0; r < free.size(); ++r)
      {
        const double force = x.local_element(r);
        const double side  = free[r] || is_equality(rows.kind[r]) || (rows.kind[r] == RowKind::tangential && force == 0)
                               ? 0.
                             : rows.kind[r] == RowKind::tangential && force > 0 ? 1.
                                                                                : -1.;
        if (side == 0)
          continue;
        conditions.push_back({side * (jump.local_element(r) - rows.c[r])});
        for (unsigned int m = 0; m < loose.size(); ++m)
          conditions.back().push_back(side * own(r, m));
      }
    std::vector<std::vector<double>> all;
    for (const auto &part : dealii::Utilities::MPI::all_gather(comm, conditions))
      all.insert(all.end(), part.begin(), part.end());
    Eigen::VectorXd amount = Eigen::VectorXd::Zero(loose.size());
    for (unsigned int step = 0; step < max_slide_steps; ++step)
      {
        std::vector<Eigen::VectorXd> violated;
        std::vector<double>          by;
        for (const auto &condition : all)
          {
            const Eigen::Map<const Eigen::VectorXd> slope(condition.data() + 1, loose.size());
            const double                            value = condition[0] + slope.dot(amount);
            if (value < 0)
              {
                violated.push_back(slope);
                by.push_back(-value);
              }
          }
        if (violated.empty())
          break;
        Eigen::MatrixXd slopes(violated.size(), loose.size());
        for (unsigned int i = 0; i < violated.size(); ++i)
          slopes.row(i) = violated[i];
        const Eigen::VectorXd change =
          shortest_solution(slopes, Eigen::Map<const Eigen::VectorXd>(by.data(), by.size()));
        amount += change;
        if (change.norm() <= slide_tolerance * amount.norm())
          break;
      }
    Eigen::VectorXd amplitudes = Eigen::VectorXd::Zero(loose[0].amplitudes.size());
    for (unsigned int m = 0; m < loose.size(); ++m)
      amplitudes += amount[m] * loose[m].amplitudes;
    for (unsigned int p = 0; p < systems.size(); ++p)
      at.u[p] += bodies->displacements(p, amplitudes);
  }

  DualProblem::Recovery DualProblem::recover(const DistributedVector &x,
                                             const std::vector<bool> &free,
                                             const bool               keeps_still) const
  {
    const auto        loose      = bodies->free(free);
    std::vector<bool> fixed      = free;
    const bool        is_at_rest = loose.empty() || rows_that_fix(loose, x, keeps_still, fixed);
    const Projector   on_free(*projector, fixed, comm, std::vector<qp::Tie>(), metric);
    Recovery          result{{}, zero(), {}};
    DistributedVector step{zero()};
    result.multipliers = x;
    for (unsigned int pass = 0; pass < 2; ++pass) // the second one for the rounding of the first
      {
        on_free.particular(resultants - projector->multiply(result.multipliers), step);
        result.multipliers += step;
      }

    result.u = forces(result.multipliers);
    auto &u  = result.u;
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        u[p] = systems[p]->load() - u[p];
        systems[p]->apply_pseudo_inverse(u[p]);
      }

    fit_motions(on_free, fixed, result);
    if (!is_at_rest)
      {
        remove_motions(loose, result.u);
        result.unresisted = loose;
      }
    if (!loose.empty())
      slide_apart(loose, free, x, result);
    return result;
  }

  DistributedVector DualProblem::misfit(const Recovery &of, const std::vector<bool> &free) const
  {
    DistributedVector missing = jumps(of.u);
    for (unsigned int r = 0; r < rows.c.size(); ++r)
      missing.local_element(r) = free[r] ? rows.c[r] - missing.local_element(r) : 0.;
    for (unsigned int r = 0; r < rows.compliance.size(); ++r)
      missing.local_element(r) += free[r] ? rows.compliance[r] * of.multipliers.local_element(r) : 0.;
    return missing;
  }

  void DualProblem::fit_motions(const Projector &on_free, const std::vector<bool> &free, Recovery &at) const
  {
    DistributedVector missing = misfit(at, free), range = zero();
    Eigen::VectorXd   a = on_free.amplitudes(missing);
    on_free.project_range(missing, range);
    missing -= range;
    a += on_free.amplitudes(missing); // for the rounding of the first
    unsigned int next = 0;
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        const unsigned int k = systems[p]->kernel().cols();
        at.u[p] += systems[p]->kernel() * a.segment(next, k);
        next += k;
      }
  }

  void DualProblem::correct(Recovery &at, const DistributedVector &step, const std::vector<bool> &free) const
  {
    auto change = forces(step);
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        systems[p]->apply_pseudo_inverse(change[p]);
        at.u[p] -= change[p];
      }
    at.multipliers += step;
    fit_motions(Projector(*projector, free, comm, std::vector<qp::Tie>(), metric), free, at);
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
