// Decides whether dense blocks of K_p+ pay off.
#pragma once

#include <slipstick/tfeti/constraints.h>
#include <slipstick/tfeti/options.h>

#include <cstddef>

namespace slipstick::tfeti
{
  /// Estimated cost and savings of the dense block of one subdomain, from measured rates (doc/decisions/0023).
  struct BlockEstimate
  {
    std::size_t bytes  = 0; // of F_p, and of S_p with the Dirichlet preconditioner
    double      setup  = 0; // [s]
    double      saving = 0; // per multiplication, compared with the sparse solves [s]
  };

  BlockEstimate estimate_block(const std::size_t n_unknowns, const std::size_t n_touched, const DualOptions &options);

  /// Whether F is stored in dense blocks: as prescribed by the options; if they leave the choice to the program, when
  /// the blocks of every rank fit into a part of its share of the free memory (limits of the run count) and the expected
  /// multiplications pay for them.
  /// Collective.
  /// @param n_unknowns of every subdomain.
  bool is_explicit(const DualOptions               &options,
                   const std::vector<unsigned int> &n_unknowns,
                   const Constraints               &constraints,
                   const MPI_Comm                   comm);
} // namespace slipstick::tfeti
