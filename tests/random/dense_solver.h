// Contact problems of a few hundred unknowns solved without slipstick: Eigen and this file alone.
//
// Held directions are eliminated, each body is condensed to its contact rows: with u = u_f - H+ C'x + N a, H the stiffness of
// what supports leave free, N its kernel (an orthonormal basis of the rigid motions), H+ = (H + rho N N')^-1, C the
// rows, x their forces, the jumps are
//
//   j = C u = d - W x + T a,  W = C H+ C',  T = C N,     and  T'x = e = N'f  is equilibrium.
//
// Convex laws (given bounds): a primal-dual interior point method on W, T, then the active set it ends with, solved
// directly and corrected until all conditions hold to rounding. W, d and the residuals of that last solution are in extended
// precision. Coulomb: these with the bounds followed from x until the set
// of open, sticking and sliding nodes, sliding ones tied x_T = +-mu x_N, solves the whole law to rounding.
#pragma once

#include "problem.h"

namespace slipstick::random
{
  enum class Outcome
  {
    solved,
    infeasible, // no admissible forces balance the loads: certificate found
    loose,      // rows and supports leave a motion free
    unsolved    // Coulomb: admissible forces exist, no solution was found
  };

  struct DenseSolution
  {
    Outcome         outcome = Outcome::unsolved;
    Eigen::VectorXd x;                   // force of every row
    Eigen::VectorXd u;                   // unknowns
    double          residual        = 0; // of all conditions, relative
    bool            position_unique = true;
    bool            forces_unique   = true;
    Eigen::MatrixXd free_motions;         // unknowns x motions that the solution leaves undetermined
    unsigned int    bound_iterations = 0; // Coulomb
    double          margin           = 0; // infeasible: loads that nothing balances, relative
  };

  /// How well forces and displacements from elsewhere keep the conditions.
  struct Violation
  {
    double equilibrium  = 0; // resultants on what may move, relative
    double law          = 0; // worst row: |x - its projection on the law's bounds when moved along the jump|, relative
    double displacement = 0; // |u - displacement that belongs to x|, relative
    double worst() const
    {
      return std::max({equilibrium, law, displacement});
    }
  };

  class DenseSolver
  {
  public:
    /// @param displacement if given, motions that rows resist only because they join points that a gap sets apart (decision
    ///        0070) are held as they are there.
    explicit DenseSolver(const Problem &problem, const Eigen::VectorXd *displacement = nullptr);

    DenseSolution solve() const;

    /// Checks x and u by themselves; the rigid part of u is taken from u.
    Violation check(const Eigen::VectorXd &x, const Eigen::VectorXd &u) const;

    /// Forces of the rows on the nodes, C'x: unique even where x is not.
    Eigen::VectorXd nodal_forces(const Eigen::VectorXd &x) const;

    /// Strain energy u'K u / 2.
    double energy(const Eigen::VectorXd &u) const;

    bool has_coulomb() const
    {
      return is_coulomb;
    }

    unsigned int n_rows() const
    {
      return W.rows();
    }

  private:
    enum class State : char
    {
      free,  // bonds; normal: pressed; tangential: sticking
      zero,  // normal: open; tangential: no bound
      upper, // tangential: at + bound
      lower
    };
    using States = std::vector<State>;

    struct Point
    {
      Eigen::VectorXd x, a;
    };

    // W and d, and residuals with them, in extended precision: rows that nearly depend on each other would show the
    // rounding of H+.
    using Precise       = long double;
    using PreciseMatrix = Eigen::Matrix<Precise, Eigen::Dynamic, Eigen::Dynamic>;
    using PreciseVector = Eigen::Matrix<Precise, Eigen::Dynamic, 1>;

    void            condense(const Eigen::VectorXd *displacement);
    void            hold_free_motions(const Eigen::VectorXd &displacement);
    Eigen::VectorXd amplitudes(const Eigen::VectorXd &displacement) const;
    PreciseMatrix   solve_stiffness(const unsigned int body, const Eigen::MatrixXd &right) const;
    Eigen::VectorXd bounds(const Eigen::VectorXd &x) const;
    Eigen::VectorXd jumps(const Point &at) const;
    double          scale(const Eigen::VectorXd &x) const;
    double          residual(const Point &at) const;
    double          residual(const Point &at, const Eigen::VectorXd &bound) const;
    bool            feasible(Eigen::VectorXd &x, double &missing) const;
    bool            interior_point(const Eigen::VectorXd &bound, Point &at) const;
    States          states(const Point &at, const Eigen::VectorXd &bound, const double step) const;
    bool            solve_set(const States &set, const Eigen::VectorXd *bound, Point &at) const;
    bool            follow_sets(const Eigen::VectorXd *bound, Point &at) const;
    void            examine(const Point &at, DenseSolution &solution) const;
    Eigen::VectorXd displacements(const Point &at) const;
    Eigen::MatrixXd displacements_under(const Eigen::MatrixXd &scaled) const;

    const Problem                           &problem;
    std::vector<Eigen::MatrixXd>             Z; // per body: unknowns x free ones
    std::vector<Eigen::MatrixXd>             H; // per body: stiffness of the free unknowns, motions held
    std::vector<Eigen::LLT<Eigen::MatrixXd>> factor;
    std::vector<Eigen::MatrixXd>             C; // per body: rows x free unknowns, scaled
    std::vector<Eigen::MatrixXd>             N; // per body: free unknowns x motions
    std::vector<int>                         first_motion;
    Eigen::VectorXd                          u0; // prescribed
    Eigen::VectorXd  row_scale, motion_scale;    // x = row_scale x^, a = given + motions motion_scale a^
    Eigen::VectorXd  given;
    Eigen::MatrixXd  motions; // orthonormal: those that are free
    Eigen::MatrixXd  W, T;    // scaled: unit diagonal
    Eigen::VectorXd  d, e;    // scaled; d less c
    PreciseMatrix    precise_W;
    PreciseVector    precise_d;
    Eigen::VectorXd  fixed_bound, mu; // scaled, by row
    std::vector<int> normal_of;
    double           size_of_e  = 0;
    bool             is_coulomb = false;
  };
} // namespace slipstick::random
