// The dual problem of the torn bodies: F, d, G, e, P.
#pragma once

#include <slipstick/tfeti/dual_operator.h>
#include <slipstick/tfeti/loose_bodies.h>
#include <slipstick/tfeti/preconditioner.h>
#include <slipstick/tfeti/projector.h>
#include <slipstick/tfeti/reduction.h>
#include <slipstick/tfeti/rigid_motions.h>
#include <slipstick/tfeti/row_metric.h>
#include <slipstick/tfeti/subdomains.h>

namespace slipstick::tfeti
{
  class Face;

  /// min 1/2 x'F x - x'd  s.t.  G x = e and bounds on x (handled by the contact layer). x: multipliers [N], one per row
  /// of B. Implements qp's Problem concept with F scaled by 1 / |P F P|, so that its norm is about 1 in any units.
  /// Related: face.h (restriction to the free rows), recovery.h (displacements), diagnosis.h (energy errors, ambiguous
  /// forces).
  ///
  /// A spring pulled towards a wall by 100 N (tests/install/consumer/bar.cc: with two subdomains and a QP solver):
  /// @code
  /// Eigen::Matrix2d lower; // triangle of the stiffness [N/mm]
  /// lower << 1e5, 0, -1e5, 1e5;
  /// std::vector<SubdomainMatrices> spring(1);
  /// spring[0].stiffness     = Eigen::SparseMatrix<double>(lower.sparseView());
  /// spring[0].load          = Eigen::Vector2d(0, 100);
  /// spring[0].kernel        = Eigen::MatrixXd::Ones(2, 1);
  /// spring[0].body_modes    = Eigen::MatrixXd::Ones(1, 1);
  /// spring[0].boundary_dofs = {0, 1};
  /// Constraints rows; // u_0 = 0 and u_1 <= 0.4e-3 mm
  /// rows.rows = rows.interface_dofs = std::make_shared<dealii::Utilities::MPI::Partitioner>(2);
  /// rows.kind                       = {RowKind::prescribed, RowKind::normal};
  /// rows.c                          = {0, 4e-4};
  /// rows.label                      = {0, 1};
  /// rows.blocks                     = {{{0, 0, 1.}, {1, 1, 1.}}};
  /// rows.interface_blocks           = {{{0, 0}, {1, 1}}};
  /// DualProblem dual(std::move(spring), rows, {}, {"spring"}, MPI_COMM_SELF);
  /// // both rows are closed: G x = e gives x_0 + x_1 = 100 N, the jumps give the rest
  /// DistributedVector x = dual.particular(); // x_0 = x_1 = 50 N
  /// x(0)                = 40;                // stretches the spring by 0.4e-3 mm
  /// x(1)                = 60;
  /// const auto solution = recover(dual, x, {true, true});
  /// assert(std::abs(solution.u[0][1] - 4e-4) < 1e-15);
  /// @endcode
  class DualProblem
  {
  public:
    /// Cost of the set-up.
    struct SetUp
    {
      unsigned long long multiplications       = 0; // by F, for |P F P|
      double             factorization_seconds = 0; // time of this rank for Cholesky factors
    };

    /// Factorises the subdomains and the coarse problem and estimates |P F P|. Collective.
    /// @throws NoEquilibrium naming body and motion when no row of B resists a rigid motion of a body; UnheldMotions
    /// if no load drives any such motion.
    /// @throws InputError when a subdomain cannot be factorised.
    DualProblem(std::vector<SubdomainMatrices>  matrices,
                Constraints                     constraints,
                const DualOptions              &options,
                const std::vector<std::string> &body_names,
                const MPI_Comm                  comm);

    /// As above, with @p subdomains taken over from a problem with other rows: only those whose touched unknowns differ
    /// are factorised again. No other problem may use them at the same time.
    /// @param resisting rows that tell which rigid motions nothing resists, if these are others.
    DualProblem(std::shared_ptr<Subdomains>     subdomains,
                Constraints                     constraints,
                const DualOptions              &options,
                const std::vector<std::string> &body_names,
                const MPI_Comm                  comm,
                const Constraints              *resisting = nullptr);

    /// Starts another load step: loads f_p of this rank's subdomains [N] and right-hand sides c of the owned rows [mm].
    /// K, B and everything that depends only on them are kept. Collective.
    void set_step(std::vector<Eigen::VectorXd> loads, std::vector<double> c);

    /// The gaps of the contact points in @p points, of the same rows, replace the present ones.
    void set_gaps(const std::vector<ContactPoint> &points);

    /// Changes only the right-hand sides c of the owned rows [mm]. Collective.
    void set_right_hand_side(std::vector<double> c);

    /// For an operator stored in single precision (F~): d := B K+ f - c - (F - F~) x, with F applied in double
    /// precision by sparse solves, so that a solution near x of the problem with F~ and this d solves the problem with
    /// F. The next load step starts from the uncorrected d. Collective; two multiplications.
    /// @return the change of P d in the units of multiply() (d over |P F P|) [N]; 0 in double precision.
    double refine(const DistributedVector &x);

    /// Whether F is stored in single precision.
    bool is_approximate() const
    {
      return is_single;
    }

    // qp's Problem concept
    void                multiply(const DistributedVector &x, DistributedVector &y) const;      // y = F x / |P F P|
    void                project_range(const DistributedVector &x, DistributedVector &y) const; // y = Q x
    const MpiReduction &reduction() const;

    /// Weights of the owned rows' residuals for solvers with a preconditioner: stiffnesses relative to the smallest, so
    /// that residuals are measured as forces and stiff and soft bodies are solved equally well. Empty without a
    /// preconditioner.
    const std::vector<double> &residual_weights() const
    {
      return row_metric.weights();
    }

    /// For the owned rows: 1 over the weight of rows that depend linearly on others (redundant supports, corners where
    /// several pairs meet), 0 for others. Null if there are none on any rank, and without a preconditioner.
    const std::vector<double> *dependent_compliances() const
    {
      return has_dependent_rows ? &of_dependent_rows : nullptr;
    }

    /// The largest change of a gap that was made because gaps contradicted each other where rows depend on each other,
    /// within the rounding of node positions [mm].
    double contradiction_of_gaps() const
    {
      return contradiction;
    }

    /// |P F P| times the stiffness of the row of weight 1, whose neighbours yield: a part of that with its neighbours
    /// held. 0 if unknown (without a preconditioner).
    double point_stiffness() const
    {
      constexpr double in_plane = 0.1, in_space = 0.02; // doc/decisions/0090, 0142
      return M ? (bodies->are_solids() ? in_space : in_plane) * norm_PFP * row_metric.least() : 0.;
    }

    /// The problem on the owned rows with `free`; the other rows are fixed, or tied to free ones. In space, rows of
    /// slipping nodes are turned. Collective.
    Face face(const std::vector<bool>     &free,
              const std::vector<qp::Tie>  &ties  = {},
              const std::vector<qp::Turn> &turns = {}) const;

    /// Chooses rows that hold the bodies which the free rows leave loose.
    const LooseBodies &loose_bodies() const
    {
      return *loose;
    }

    /// |P F P| [mm/N].
    double norm() const
    {
      return norm_PFP;
    }

    /// d = B K+ f - c, owned entries [mm].
    const DistributedVector &d() const
    {
      return dual_load;
    }

    /// e = R'f: resultants of the loads along the rigid motions of this rank's subdomains, one subdomain after another.
    const Eigen::VectorXd &e() const
    {
      return resultants;
    }

    /// The smallest x with G x = e [N].
    DistributedVector particular() const;

    /// A zero vector of multipliers, owned entries only.
    DistributedVector zero() const;

    // parts
    const Constraints &constraints() const
    {
      return rows;
    }
    const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains() const
    {
      return systems;
    }
    const BodyMotions &body_motions() const
    {
      return *bodies;
    }
    const DualOperator &dual_operator() const
    {
      return *F;
    }
    const Projector &projector() const
    {
      return *Q;
    }
    /// Null if there is no preconditioner.
    const RowPreconditioner *preconditioner() const
    {
      return M.get();
    }
    /// Without a preconditioner all rows have the same weight.
    const RowMetric &metric() const
    {
      return row_metric;
    }
    const SetUp &set_up() const
    {
      return cost;
    }
    MPI_Comm communicator() const
    {
      return comm;
    }

  private:
    double            lanczos(const DualOptions &options) const;
    void              apply_F(const DistributedVector &x, DistributedVector &y) const; // with the rows' compliance
    void              set_dependent_compliances();
    void              make_gaps_consistent();
    std::vector<bool> rigid_rows() const;
    void              set_dual_load(); // e too

    MPI_Comm                                             comm;
    MpiReduction                                         reduce;
    Constraints                                          rows;
    std::vector<LocalGluing>                             gluing;
    std::shared_ptr<Subdomains>                          parts;
    const std::vector<std::unique_ptr<SubdomainSystem>> &systems; // those of the subdomains
    std::unique_ptr<DualOperator>                        F;
    std::unique_ptr<BodyMotions>                         bodies;
    std::unique_ptr<LooseBodies>                         loose;
    std::unique_ptr<Projector>                           Q;
    std::unique_ptr<RowPreconditioner>                   M;
    RowMetric                                            row_metric;
    std::vector<double>                                  of_dependent_rows; // compliances
    bool                                                 has_dependent_rows = false;
    double                                               contradiction      = 0;
    DistributedVector                                    dual_load;
    Eigen::VectorXd                                      resultants;
    DistributedVector                                    correction; // (F - F~) x, subtracted from d
    bool                                                 is_single = false;
    double                                               norm_PFP  = 1;
    SetUp                                                cost;
  };
} // namespace slipstick::tfeti
