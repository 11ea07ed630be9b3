// The dual problem of the torn bodies: F, d, G, e, P, and the recovery of displacements.
#pragma once

#include <slipstick/tfeti/body_equilibrium.h>
#include <slipstick/tfeti/dual_operator.h>
#include <slipstick/tfeti/preconditioner.h>
#include <slipstick/tfeti/projector.h>
#include <slipstick/tfeti/reduction.h>
#include <slipstick/tfeti/rigid_motions.h>
#include <slipstick/tfeti/subdomains.h>

#include <optional>

namespace slipstick::tfeti
{
  /// Forces below this fraction of the largest one count as rounding of zero and hold nothing.
  constexpr double force_rounding = 1e-13;

  /// min 1/2 x'F x - x'd  s.t.  G x = e and bounds on x (which the contact layer knows). x: multipliers [N], one a row
  /// of B. Serves qp's Problem concept with F scaled by |P F P|, so that its norm is about 1 in any units.
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
  /// rows.interface_held             = {true, true};
  /// DualProblem dual(std::move(spring), rows, {}, {"spring"}, MPI_COMM_SELF);
  /// // both rows bear: G x = e gives x_0 + x_1 = 100 N, the jumps the rest
  /// DistributedVector x = dual.particular(); // x_0 = x_1 = 50 N
  /// x(0)                = 40;                // what stretches the spring by 0.4e-3 mm
  /// x(1)                = 60;
  /// const auto solution = dual.recover(x, {true, true});
  /// assert(std::abs(solution.u[0][1] - 4e-4) < 1e-15);
  /// @endcode
  class DualProblem
  {
  public:
    class Face;

    /// The primal solution and the multipliers that belong to it.
    struct Recovery
    {
      std::vector<Eigen::VectorXd> u;           // of this rank's subdomains [mm]
      DistributedVector            multipliers; // [N]
      std::vector<RigidMotion>     unresisted;  // motions that nothing resists and no load drives: they are set to zero
    };

    /// Energies of displacements that close jumps.
    struct JumpEnergies
    {
      /// Where the energy of this rank's subdomains of a body is largest.
      struct Spot
      {
        double       energy    = -1; // none of its subdomains here
        unsigned int subdomain = 0;  // of this rank
        unsigned int touched   = 0;  // the unknown: its number among the touched ones
      };
      Eigen::VectorXd   of_body; // on all ranks [N mm]
      std::vector<Spot> spots;   // by body
    };

    /// Factorises the subdomains and the coarse problem and estimates |P F P|. Collective.
    /// @throws NoEquilibrium naming body and motion when the rows of B leave a rigid motion of a body free; if loads
    /// drive none of them, UnheldMotions.
    /// @throws NumericalError when a subdomain cannot be factorised.
    DualProblem(std::vector<SubdomainMatrices>  matrices,
                Constraints                     constraints,
                const DualOptions              &options,
                const std::vector<std::string> &body_names,
                const MPI_Comm                  comm);

    /// The same with @p subdomains from a problem with other rows: only those touched at other unknowns are factorised.
    /// No other problem may use them at the same time.
    DualProblem(std::shared_ptr<Subdomains>     subdomains,
                Constraints                     constraints,
                const DualOptions              &options,
                const std::vector<std::string> &body_names,
                const MPI_Comm                  comm);

    /// Another load step: loads f_p of this rank's subdomains [N] and right-hand sides c of the owned rows [mm]. K, B
    /// and everything that depends only on them stay. Collective.
    void set_step(std::vector<Eigen::VectorXd> loads, std::vector<double> c);

    /// Changes only the right-hand sides c of the owned rows [mm]. Collective.
    void set_right_hand_side(std::vector<double> c);

    /// With an operator stored in single precision (F~): d := B K+ f - c - (F - F~) x, F in double by sparse solves, so
    /// that a point that solves the problem with F~ and this d near x solves the one with F. Another load step starts
    /// from d again. Collective; two multiplications.
    /// @return by how much this changed P d, in the units of multiply() (d over |P F P|) [N]; 0 in double precision.
    double refine(const DistributedVector &x);

    /// Is F stored in single precision?
    bool is_approximate() const
    {
      return is_single;
    }

    // qp's Problem concept
    void                multiply(const DistributedVector &x, DistributedVector &y) const;      // y = F x / |P F P|
    void                project_range(const DistributedVector &x, DistributedVector &y) const; // y = Q x
    const MpiReduction &reduction() const;

    /// Weights of the owned rows' residuals for solvers with a preconditioner: stiffnesses relative to the smallest, so
    /// that residuals count as forces and all bodies are solved equally well. Empty without a preconditioner.
    const std::vector<double> &residual_weights() const
    {
      return metric;
    }

    /// |P F P| times the stiffness of the row of weight 1, its neighbours held; 0 where it is not known (without a
    /// preconditioner) or tells sets no better (solids; doc/decisions/0090).
    double point_stiffness() const
    {
      return preconditioner && !bodies->are_solids() ? norm_PFP * least_stiffness : 0.;
    }

    /// Norm of the part of a residual (such as d - F x over norm()) that multipliers can change, with its
    /// weights; 0 where that is rounding.
    double residual_norm(const DistributedVector &r) const;

    /// Nearly the squared energy norm of the smallest displacements that close jumps r (owned rows) [mm], where rows
    /// without a jump are held if @p held says so: r'M r [N mm], M the preconditioner or, without one, the lumped
    /// preconditioner (which gives more). With r = B u - c of displacements u = K+(f - B'x) + R a it is an upper bound
    /// of the squared energy norm of their error, up to the quality of the scaling of M, both in total and for each
    /// body with its own part. Collective.
    JumpEnergies jump_energies(const DistributedVector &r, const std::vector<bool> &held) const;

    /// For every owned row, whether its multiplier is undetermined because the free rows are linearly dependent (bodies
    /// that hold each other in more ways than one). This does not affect u. Collective.
    std::vector<bool> ambiguous(const std::vector<bool> &free) const;

    /// The problem on the free rows (owned ones), the others held, or tied to free ones; rows of slipping nodes in space are
    /// turned ones. Collective.
    Face face(const std::vector<bool>     &free,
              const std::vector<qp::Tie>  &ties  = {},
              const std::vector<qp::Turn> &turns = {}) const;

    /// The motion of bodies that friction at the current bounds resists least.
    struct Overload
    {
      RigidMotion motion;
      double      held = 0; // of the load along it friction bears this part: no equilibrium below 1
      double      load = 0; // along the motion, of unit length [N]
    };

    /// @param free rows that hold: gluing, supports, closed contact. @param capacity the bound of a row between two
    ///        bounds [N]; negative: the row bears nothing; infinity: a row with one bound. @param below motions of which
    ///        friction bears this part or more do not count. None where so many bodies are loose that the search would take
    ///        longer than the solve. Collective.
    std::optional<Overload> overload(const std::vector<bool>   &free,
                                     const std::vector<double> &capacity,
                                     const double               below = 1) const;

    /// The free rows and as many of the others as are needed to hold the bodies that the free rows leave loose,
    /// preferring the smallest gaps [of any unit]. Only the free rows if nothing is loose, or nothing can hold it.
    /// @param well bodies that free rows hardly hold are held, too. @param turns rows that count as turned. Collective.
    std::vector<bool> hold(const std::vector<bool>     &free,
                           const std::vector<double>   &gaps,
                           const bool                   well,
                           const std::vector<qp::Turn> &turns = {}) const;

    /// moved -= stiffness times the jumps of the motion of bodies held by contact alone, after which the forces
    /// `moved`, clipped to their bounds, balance the loads of these bodies, up to the part `tolerated` of all forces. Owned
    /// rows. Collective.
    void balance_bodies(const std::vector<double>                  &stiffness,
                        const qp::AdmissibleSet<DistributedVector> &bounds,
                        const double                                tolerated,
                        std::vector<double>                        &moved) const;

    /// Are there bodies held by contact alone, whose motion tells which points touch? In the plane: in space sets are told
    /// better without (doc/decisions/0089).
    bool has_loose_bodies() const;

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

    /// The smallest x with G x = e [N].
    DistributedVector particular() const;

    /// A zero vector of multipliers, owned entries only.
    DistributedVector zero() const;

    /// Displacements u = K+(f - B'x) + R a. First x is corrected, only on the rows with `free`, until G x = e holds to
    /// rounding, so that u is in equilibrium with it; then the amplitudes a of the rigid motions fit those rows (which
    /// hold with equality) in the sense of least squares. Bodies that slide on all their contacts are placed such that
    /// every slip follows its force and no gap is negative, as close as possible to where they just stop sticking.
    /// Collective.
    /// @throws NoEquilibrium naming the body when neither free rows nor rows with friction forces fix a.
    /// @param keeps_still motions that nothing resists and no load drives stay at zero; otherwise they are an error.
    Recovery recover(const DistributedVector &x, const std::vector<bool> &free, const bool keeps_still = false) const;

    /// u += -K+ B'step + R a, x += step, with the a that fits the free rows in the sense of least squares. G step = 0
    /// is assumed. The present u is kept, so that rounding of x, under which a slender subdomain bends far more than u,
    /// does not enter again, as it would with recover(). Collective.
    void correct(Recovery &at, const DistributedVector &step, const std::vector<bool> &free) const;

    /// c + compliance x - B u on the free rows, 0 on the others [mm]. Collective.
    DistributedVector misfit(const Recovery &of, const std::vector<bool> &free) const;

    /// B u of displacements of this rank's subdomains, owned rows [mm]. Collective.
    DistributedVector jumps(const std::vector<Eigen::VectorXd> &u) const;

    /// The column of B, owned rows, of a touched unknown (its number among them) of a subdomain of one rank.
    /// Collective.
    /// @param subdomain on the other ranks: subdomains().size()
    DistributedVector column(const unsigned int subdomain, const unsigned int touched) const;

    /// B_p'x of this rank's subdomains, all unknowns [N]: the forces of the multipliers (owned entries). Collective.
    std::vector<Eigen::VectorXd> forces(const DistributedVector &x) const;

    /// The rigid motion of the bodies behind a dual vector r = G'a. Collective.
    RigidMotion motion_behind(const DistributedVector &r) const;

    const Constraints &constraints() const
    {
      return rows;
    }
    const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains() const
    {
      return systems;
    }
    const std::vector<std::string> &body_names() const
    {
      return names_of_bodies;
    }
    const DualOperator &dual_operator() const
    {
      return *F;
    }
    unsigned long long kernel_dimension() const
    {
      return projector->dimension();
    }
    bool is_preconditioned() const
    {
      return preconditioner != nullptr;
    }
    unsigned long long n_setup_multiplications() const
    {
      return setup_multiplications;
    }
    /// Time that this rank spent on Cholesky factors in the constructor [s].
    double factorization_seconds() const
    {
      return factorization_time;
    }
    MPI_Comm communicator() const
    {
      return comm;
    }

  private:
    /// Removes the loose motions from u.
    void remove_motions(const std::vector<RigidMotion> &loose, std::vector<Eigen::VectorXd> &u) const;

    /// Adds as many candidates to the free rows as are needed to hold the loose motions: those whose shares, times
    /// their scale, are largest. @return whether they hold them.
    bool hold_by(const std::vector<RigidMotion> &loose,
                 const std::vector<bool>        &is_candidate,
                 const std::vector<double>      &scale,
                 std::vector<bool>              &free,
                 const std::vector<qp::Turn>    &turns = {}) const;
    /// The free rows and those rows with friction forces that hold the loose motions or, if nothing drives these, some
    /// of all rows. @return whether they are rows with forces.
    bool rows_that_fix(const std::vector<RigidMotion> &loose,
                       const DistributedVector        &x,
                       const bool                      keeps_still,
                       std::vector<bool>              &free) const;
    void slide_apart(const std::vector<RigidMotion> &loose,
                     const std::vector<bool>        &free,
                     const DistributedVector        &x,
                     Recovery                       &at) const;

    /// u += R a: a least squares fit of the free rows, to which the projector is restricted.
    void fit_motions(const Projector &on_free, const std::vector<bool> &free, Recovery &at) const;

    double lanczos(const DualOptions &options) const;
    void   make_metric();
    void   apply_F(const DistributedVector &x, DistributedVector &y) const; // with the rows' compliance
    void   set_dual_load();                                                 // e too

    MPI_Comm                                             comm;
    MpiReduction                                         reduce;
    Constraints                                          rows;
    Partitioner                                          owned_rows; // without ghosts
    std::vector<std::string>                             names_of_bodies;
    std::vector<LocalGluing>                             gluing;
    std::shared_ptr<Subdomains>                          parts;
    const std::vector<std::unique_ptr<SubdomainSystem>> &systems; // theirs
    std::unique_ptr<DualOperator>                        F;
    std::unique_ptr<BodyMotions>                         bodies;
    std::unique_ptr<BodyEquilibrium>                     held_by_contact; // bodies that nothing else holds
    std::unique_ptr<Projector>                           projector;
    std::unique_ptr<RowPreconditioner>                   preconditioner;
    std::vector<double>                                  metric; // stiffnesses of the owned rows over the least one ...
    double                                               least_stiffness = 1; // ... which this is [N/mm]
    std::vector<double> yielding; // of the owned rows: root of that with their compliance over that without; empty: 1
    bool                projects_twice = false; // rounding of one projection would show in the stiffest rows
    DistributedVector   dual_load;
    Eigen::VectorXd     resultants; // e of this rank's subdomains in turn
    DistributedVector   correction; // (F - F~) x, taken off the dual load
    bool                is_single             = false;
    double              norm_PFP              = 1;
    unsigned long long  setup_multiplications = 0;
    double              factorization_time    = 0;
  };

  /// The dual problem on its free rows, as qp's semismooth Newton and PCPG ask for it.
  class DualProblem::Face
  {
  public:
    Face(const DualProblem           &problem,
         const std::vector<bool>     &free,
         const std::vector<qp::Tie>  &ties,
         const std::vector<qp::Turn> &turns);

    void                       multiply(const DistributedVector &x, DistributedVector &y) const; // y = F x / |P F P|
    const MpiReduction        &reduction() const;
    const std::vector<double> &residual_weights() const;

    /// y = Q_f x on the free rows, y = x on the others.
    void project_range(const DistributedVector &x, DistributedVector &y) const;

    /// Changes the free rows of x, and those tied to them, by the smallest amount that makes G x = e.
    void balance(DistributedVector &x) const;

    /// Changes the free rows of p by the smallest amount that makes G p = 0, once the tied rows are factor times
    /// theirs.
    void project_kernel(DistributedVector &p) const;

    /// y = G'a on all rows, with the a that minimises v - G'a on the free ones.
    void multiplier_shift(const DistributedVector &v, DistributedVector &y) const;

    /// z = M r on the free rows, 0 on the others; a copy without a preconditioner.
    void precondition(const DistributedVector &r, DistributedVector &z) const;

    /// Do the free rows hold all bodies?
    bool is_regular() const
    {
      return projector != nullptr;
    }

  private:
    using Projection = void (Projector::*)(const DistributedVector &, DistributedVector &) const;
    void                projected(const Projection project, const DistributedVector &x, DistributedVector &y) const;
    void                make_projectors();
    std::vector<double> softened_metric();
    const DistributedVector &turned(const DistributedVector &x, std::optional<DistributedVector> &copy) const;
    void                     soften(DistributedVector &x) const;

    const Projector &balancing() const
    {
      return tied ? *tied : *projector;
    }

    const DualProblem         &problem;
    std::vector<bool>          free;
    std::vector<qp::Tie>       ties;
    std::vector<qp::Turn>      turns;
    std::vector<double>        stiffness; // by turns: of the row across the force, over that without compliance
    std::unique_ptr<Projector> projector; // none if the free rows do not hold the bodies
    std::unique_ptr<Projector> tied;      // of free and tied rows, if some rank has ties
    std::unique_ptr<RowWeights::Inverse> weights;
  };
} // namespace slipstick::tfeti
