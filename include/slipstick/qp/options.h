// Parameters of the quadratic programming solvers, each with its source.
#pragma once

#include <limits>

namespace slipstick::qp
{
  /// What MPGP does when a conjugate gradient step would leave the bounds.
  enum class Expansion
  {
    gradient_projection,      // step along the projected gradient, Dostal 2009, section 5.8
    boundary_then_projection, // to the boundary first, then along the free gradient, Dostal, Schoeberl 2005
    projected_cg              // project the full conjugate gradient step, Kruzik et al. 2020
  };

  struct MpgpOptions
  {
    Expansion    expansion      = Expansion::boundary_then_projection;
    double       proportioning  = 1.0;   // Gamma > 0, Dostal 2009, section 5.8
    double       step_length    = 1.5;   // alpha times |A|, in (0, 2]; see doc/decisions/0005
    unsigned int max_iterations = 10000; // per call

    double sufficient_decrease = 0.01;   // projected steps below this part of the best decrease are cut (own choice)
    double norm_growth         = 1.1;    // >= 1: |A| becomes this times a Rayleigh quotient found above it (own choice)
    double rounding           = 2.2e-16; // a gradient below this times (|A||x| + |b|) is noise; unit roundoff of double
    double smallest_curvature = 1e-15;   // A is singular along p if p'Ap <= this times |A| p'p; a few roundoffs

    unsigned int stagnation_window   = 1000; // iterations in which the least |gP| so far must fall ... (own choice)
    double       stagnation_progress = 0.99; // ... below this times its old value (own choice)
  };

  struct SmalbeOptions
  {
    double initial_balance   = 1.0; // M_0 > 0 (Hessian scaled to norm 1)
    double balance_reduction = 1.5; // beta > 1: M is divided by it; with the paper's 10, inner solves are too accurate
    double regularization    = 1.0; // rho over |PFP|
    unsigned int max_outer_iterations = 400;
    unsigned int max_multiplications  = std::numeric_limits<unsigned int>::max(); // by the Hessian, per solve
    MpgpOptions  inner;

    unsigned int penalty_window   = 15;   // outer steps in which the least |Gx| so far must fall ... (own choice)
    double       penalty_progress = 0.5;  // ... below this times its old value, else rho grows ... (own choice)
    double       penalty_growth   = 10.0; // ... by this factor (own choice)

    double       certificate_radius  = 100;  // a certificate must exclude all points up to this times |x| (own choice)
    unsigned int stagnation_window   = 100;  // outer steps in which the least residual must fall ... (own choice)
    double       stagnation_progress = 0.99; // ... below this times its old value (own choice)
  };

  /// The previous directions to which PCPG makes a new one F-orthogonal.
  enum class Reorthogonalization
  {
    automatic, // full with a preconditioner, otherwise none: Farhat, Crivelli, Roux 1994
    full,      // all previous ones; two vectors are stored for each
    none       // only the last one
  };

  struct PcpgOptions
  {
    unsigned int        max_iterations      = 1000;
    Reorthogonalization reorthogonalization = Reorthogonalization::automatic;

    double rounding           = 2.2e-16; // a residual below this times (|Fx| + |b|) is noise; unit roundoff of double
    double smallest_curvature = 1e-15;   // F counts as singular if p'Fp / p'p is below this part of its maximum so far

    unsigned int stagnation_window   = 200;  // iterations in which the least residual so far must fall ... (own choice)
    double       stagnation_progress = 0.99; // ... below this times its old value (own choice)
  };

  /// Options of the linear problems of faces (own choice).
  struct FaceSolverOptions
  {
    unsigned int max_iterations = 300;
    double smallest_curvature   = 1e-15; // F counts as singular if p'Fp / p'p is below this part of its maximum so far
    double rounding             = 1e-14; // a direction reduced to less than this part by orthogonalisation is dependent
    double exhausted            = 1e-6;  // if less than this part of a direction is new, and it bears less than ...
    double least_part           = 0.05;  // ... this part of the residual, there are no others
    double trusted_change = 1e-10; // if cancellation moves a direction by more than this part, F is multiplied again
    double progress       = 0.999; // if a step leaves more than this part of the residual ...
    unsigned int patience = 10;    // ... this many times in a row, the solve ends
    double       accuracy = 0.3;   // products are trusted if their rounding error is below this part of the target
    double       violation_weight =
      1; // weight of violated conditions of a turned face in the residual; |F| is 1, local stiffnesses are larger
  };

  /// Options of the semismooth Newton method (own choice; doc/method.md).
  struct NewtonOptions
  {
    double       start_tolerance       = 0.3; // tolerance of the SMALBE steps that predict the first active set, ...
    unsigned int start_multiplications = 20;  // ... their largest number of multiplications (no preconditioner) ...
    unsigned int start_multiplications_with_friction = 100; // ... and the same where bounds follow the pressure
    double       set_step         = 3;    // lower bound of s in the natural residual, times |PFP| / weight
    double       forcing          = 0.1;  // residual to which faces are solved, over the natural residual, ...
    double       singular_forcing = 0.03; // ... and the same where F may be singular
    double       last_forcing     = 0.6;  // lower bound of this residual, over the tolerance
    double       tightening  = 0.1;  // next tolerance over the residual, if the goal is met but x is not accurate ...
    double       least_part  = 1e-5; // ... down to this part of the goal
    double divergence_factor = 1e3; // or if natural residuals grow by this factor after faces that meet the goal, twice
    double sharpening = 0.01; // target over the residual of an earlier face with the same set but others in between ...
    unsigned int n_remembered_sets = 10; // ... among this number of the latest faces, if F may be singular, ...
    double wide_stiffnesses = 1e6; // ... or stiffnesses of rows differ by more than this (with ties: newton_faces.h)
    double largest_regularization = 1e-4; // over the diagonal of F
    double gaps_over_forces       = 10;   // largest |gP| over tolerance times |PFP| times the forces
    double sufficient_decrease    = 1e-2; // a step must lower the natural residual by this part times its length;
    double backtracking           = 0.5;  // ... otherwise the length is multiplied by this, ...
    double shortest_step          = 1e-3; // ... down to this; then other sets are tried
    unsigned int      max_outer_iterations = 100;
    unsigned int      n_directions         = 200; // number of directions stored with their products
    FaceSolverOptions face;
  };

  /// Options of the search for the point nearest to zero within the bounds and the equalities (own choice).
  struct FeasiblePointOptions
  {
    double tolerance = 1e-12; // of |Q(x - x_e)| over the reference length max(|Q x_e|, |projection of 0|); ...
    double rounding  = 1e-15; // ... proximal points go on until it settles or is below this, or this times |y|, ...
    double largest_rounding           = 1e-10; // ... which may be at most this times the reference length
    unsigned int max_plain_steps      = 100;   // Newton steps before the proximal points
    unsigned int max_newton_steps     = 300;   // Newton steps for all proximal points
    double       first_regularization = 1e-3;  // eps of the first proximal point (the norm of Q is 1), ...
    double       reduction            = 0.1; // ... multiplied by this for the next point while the residual falls, ...
    double       least_regularization = 1e-10; // ... but not below this
    bool         seeks_proof = false; // whether eps is reduced further where the residual stagnates, which may give a
                                      // certificate, ...
    double       small_rounding    = 1e-6; // ... as long as rounding * |y| is at most this times |Q(x - x_e)|
    double       maximum_tolerance = 1e-3; // gradient over |Q(x - x_e)| of proximal points, less once that settles, ...
    double       least_gradient    = 1e-13;       // ... or gradient over the reference length
    double       progress          = 0.5;         // a residual above this part of the one before has settled
    unsigned int newton_steps_per_maximum = 20;   // if more are needed, eps is too small
    unsigned int max_cg_iterations        = 200;  // per Newton step
    double       cg_tolerance             = 1e-2; // largest residual of the Newton equation over its right-hand side
    double       least_cg_tolerance    = 1e-6; // smallest one; in between it is the gradient over the reference length
    unsigned int max_line_search_steps = 40;
    double       line_search_slope     = 0.1; // accepted slope of the dual function over the slope at the start
    double       line_search_growth    = 4.0; // > 1: factor on the step length while the dual function increases
    double       longest_step          = 1e4; // over the Newton step

    double certificate_radius = 1e4;  // a certificate excludes all points up to this times the reference length
    double certificate_margin = 1e-9; // ... with this margin relative to the summed terms

    unsigned int stagnation_window   = 20; // steps or proximal points in which the least residual so far must fall ...
    double       stagnation_progress = 0.99; // ... below this times its old value
  };
} // namespace slipstick::qp
