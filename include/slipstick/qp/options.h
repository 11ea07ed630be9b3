// Tunable numbers of the quadratic programming solvers, each with its source.
#pragma once

namespace slipstick::qp
{
  /// What MPGP does when a conjugate gradient step would leave the bounds.
  enum class Expansion
  {
    gradient_projection,     // step along the projected gradient, Dostal 2009, section 5.8
    boundary_then_projection, // to the boundary first, then along the free gradient, Dostal, Schoeberl 2005
    projected_cg             // project the full conjugate gradient step, Kruzik et al. 2020
  };

  struct MpgpOptions
  {
    Expansion    expansion      = Expansion::boundary_then_projection;
    double       proportioning  = 1.0;   // Gamma > 0, Dostal 2009, section 5.8
    double       step_length    = 2.0;   // alpha times |A|, in (0, 2]
    unsigned int max_iterations = 10000; // per call
  };

  struct SmalbeOptions
  {
    double       initial_balance      = 1.0; // M_0 > 0 (Hessian scaled to norm 1)
    double       balance_reduction    = 2.0; // beta > 1: M is divided by it; the paper's 10 buys inner precision too dearly
    double       regularization       = 1.0; // rho over |PFP|
    unsigned int max_outer_iterations = 400;
    MpgpOptions  inner;
  };

  struct PcpgOptions
  {
    unsigned int max_iterations = 1000;
  };
} // namespace slipstick::qp
