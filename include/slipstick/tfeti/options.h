// Options of the dual problem.
#pragma once

namespace slipstick::tfeti
{
  enum class Preconditioner
  {
    automatic,
    none,
    lumped,
    dirichlet
  };

  enum class DualOperatorKind
  {
    automatic,
    explicit_blocks,
    implicit
  };

  /// Storage of dense blocks; products are accumulated in double precision either way.
  enum class Precision
  {
    double_precision,
    single_precision
  };

  struct DualOptions
  {
    DualOperatorKind dual_operator            = DualOperatorKind::automatic;
    Preconditioner   preconditioner           = Preconditioner::automatic;
    Precision        operator_precision       = Precision::double_precision; // single: see DualProblem::refine
    Precision        preconditioner_precision = Precision::single_precision;
    bool             keeps_factors            = true; // of an explicit operator: K+ is still applied a few times;
                                                      // false: factorise again for every recovery
    unsigned int max_norm_iterations = 40;            // of Lanczos' method for |PFP|
    double       norm_tolerance      = 1e-2;          // relative change at which it stops
  };
} // namespace slipstick::tfeti
