#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/dual_problem.h>
#include <slipstick/tfeti/operator_choice.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace slipstick::tfeti
{
  namespace
  {
    // Positions of nodes in files are rounded by up to this part of the size of bodies (seven digits).
    constexpr double rounding_of_positions = 1e-7;

    /// A number in (-1, 1) from a label, so that the start vector of Lanczos' method does not depend on the number of
    /// ranks.
    double random_number(std::uint64_t label)
    {
      label ^= label >> 33; // finaliser of MurmurHash3
      label *= 0xff51afd7ed558ccdull;
      label ^= label >> 33;
      label *= 0xc4ceb9fe1a85ec53ull;
      label ^= label >> 33;
      return static_cast<double>(label >> 11) / static_cast<double>(1ull << 52) - 1.;
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
                           const MPI_Comm                  comm,
                           const Constraints              *resisting)
    : comm(comm)
    , reduce(comm)
    , rows(std::move(constraints))
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
    cost.factorization_seconds = parts->factorization_seconds() - seconds_before;
    F      = std::make_unique<DualOperator>(systems, gluing, rows.rows, explicit_blocks ? &parts->inverses : nullptr);
    bodies = std::make_unique<BodyMotions>(systems, rows, body_names, comm);
    require_support(resisting ? BodyMotions(systems, *resisting, body_names, comm).free({}) : bodies->free({}),
                    body_names);
    loose = std::make_unique<LooseBodies>(*bodies, rows, comm);
    if (options.preconditioner == Preconditioner::lumped || options.preconditioner == Preconditioner::dirichlet)
      {
        const bool has_schur_complements = options.preconditioner == Preconditioner::dirichlet;
        M                                = std::make_unique<RowPreconditioner>(systems,
                                                gluing,
                                                *F,
                                                rows.rows,
                                                comm,
                                                has_schur_complements ? &parts->schur_complements : nullptr);
        row_metric                       = RowMetric(M->weights().stiffnesses(), rows, comm);
      }
    std::vector<bool> has_no_bounds;
    for (const RowKind kind : rows.kind)
      has_no_bounds.push_back(is_equality(kind));
    Q = std::make_unique<Projector>(systems, gluing, *F, rows.rows, has_no_bounds, comm);

    is_single = explicit_blocks && options.operator_precision == Precision::single_precision;
    set_dependent_compliances();
    make_gaps_consistent();
    set_dual_load();
    norm_PFP             = lanczos(options);
    cost.multiplications = F->n_applications();
  }

  // Rows without a compliance of their own; the forces of the others are determined by their compliance.
  std::vector<bool> DualProblem::rigid_rows() const
  {
    std::vector<bool> result(rows.kind.size(), true);
    for (unsigned int r = 0; r < rows.compliance.size(); ++r)
      result[r] = rows.compliance[r] == 0;
    return result;
  }

  // Rounded node positions may lead to gaps that contradict each other where bodies form a loop around a point: no
  // displacements close all of them, and forces without effect would grow without limit. The smallest change of these
  // gaps that makes them consistent is within that rounding.
  void DualProblem::make_gaps_consistent()
  {
    contradiction = 0;
    if (!has_dependent_rows)
      return;
    std::vector<RowChange> change;
    for (const RowKind kind : rows.kind)
      change.push_back(kind == RowKind::gluing ? RowChange::stays : RowChange::forbidden);
    for (const ContactPoint &point : rows.contact_points)
      for (const unsigned int row : {point.normal_row, point.tangential_row, point.second_row})
        if (row != invalid_row && point.is_measured)
          change[row] = RowChange::may_change;
    const auto is_rigid = rigid_rows();
    for (unsigned int r = 0; r < change.size(); ++r)
      if (!is_rigid[r])
        change[r] = RowChange::ignored;
    const auto correction_of_c =
      M->weights().least_correction(rows.c, change, rounding_of_positions * bodies->largest_length());
    for (unsigned int r = 0; r < rows.c.size(); ++r)
      {
        contradiction = std::max(contradiction, std::abs(correction_of_c[r]));
        rows.c[r] += correction_of_c[r];
      }
    contradiction = dealii::Utilities::MPI::max(contradiction, comm);
  }

  void DualProblem::set_dependent_compliances()
  {
    if (!M)
      return;
    const auto is_dependent = M->weights().ambiguous(rigid_rows());
    for (unsigned int r = 0; r < is_dependent.size(); ++r)
      of_dependent_rows.push_back(is_dependent[r] ? 1 / row_metric.weights()[r] : 0.);
    const bool is_here = std::find(is_dependent.begin(), is_dependent.end(), true) != is_dependent.end();
    has_dependent_rows = dealii::Utilities::MPI::max(is_here ? 1 : 0, comm) > 0;
  }

  void DualProblem::set_step(std::vector<Eigen::VectorXd> loads, std::vector<double> c)
  {
    parts->set_loads(std::move(loads));
    set_right_hand_side(std::move(c));
  }

  void DualProblem::set_gaps(const std::vector<ContactPoint> &points)
  {
    for (unsigned int k = 0; k < points.size(); ++k)
      rows.contact_points[k].gap = points[k].gap;
  }

  void DualProblem::set_right_hand_side(std::vector<double> c)
  {
    rows.c = std::move(c);
    make_gaps_consistent();
    set_dual_load();
  }

  // Computes d = B K+ f - c, and e.
  void DualProblem::set_dual_load()
  {
    dual_load = F->jumps(parts->unconstrained());
    for (unsigned int r = 0; r < rows.c.size(); ++r)
      dual_load.local_element(r) -= rows.c[r];
    correction = zero();
    resultants = bodies->loads_of_subdomains();
    loose->update_loads();
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
    Q->project_range(change, range);
    change -= range;
    return change.l2_norm() / norm_PFP;
  }

  void DualProblem::apply_F(const DistributedVector &x, DistributedVector &y) const
  {
    F->apply(x, y);
    for (unsigned int r = 0; r < rows.compliance.size(); ++r)
      y.local_element(r) += rows.compliance[r] * x.local_element(r);
  }

  // Largest Ritz value, a lower bound (Lanczos 1950).
  double DualProblem::lanczos(const DualOptions &options) const
  {
    DistributedVector x = zero(), y = zero(), q = zero(), before = zero();
    for (unsigned int r = 0; r < rows.label.size(); ++r)
      x.local_element(r) = random_number(rows.label[r]);
    Q->project_range(x, q);
    x -= q;
    double              norm = 0, coupling = x.l2_norm();
    std::vector<double> diagonal, off_diagonal;
    if (coupling == 0)
      return 1;
    x /= coupling;
    for (unsigned int k = 0; k < options.max_norm_iterations; ++k)
      {
        apply_F(x, y);
        Q->project_range(y, q);
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
    if (!std::isfinite(norm))
      throw NumericalError("the norm of the dual operator is not a finite number",
                           "look for extreme dimensions, material parameters or units");
    return norm > 0 ? norm : 1.;
  }

  void DualProblem::multiply(const DistributedVector &x, DistributedVector &y) const
  {
    apply_F(x, y);
    y /= norm_PFP;
  }

  void DualProblem::project_range(const DistributedVector &x, DistributedVector &y) const
  {
    Q->project_range(x, y);
  }

  const MpiReduction &DualProblem::reduction() const
  {
    return reduce;
  }

  DistributedVector DualProblem::zero() const
  {
    return F->zero();
  }

  DistributedVector DualProblem::particular() const
  {
    DistributedVector x = zero();
    Q->particular(resultants, x);
    return x;
  }
} // namespace slipstick::tfeti
