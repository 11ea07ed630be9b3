// When dense blocks of K_p+ pay off.
#pragma once

#include <slipstick/tfeti/constraints.h>
#include <slipstick/tfeti/options.h>

#include <cstddef>

namespace slipstick::tfeti
{
  /// Cost and savings of the dense block of one subdomain, from measured rates (doc/decisions/0023).
  struct BlockEstimate
  {
    std::size_t bytes  = 0; // of F_p, and S_p with the Dirichlet preconditioner
    double      setup  = 0; // [s]
    double      saving = 0; // per multiplication, against the sparse solves [s]
  };

  BlockEstimate estimate_block(const std::size_t n_unknowns, const std::size_t n_touched, const DualOptions &options);

  /// Memory that this process may still take: its share of what the machine has free [bytes]. Collective.
  std::size_t memory_share(const MPI_Comm comm);

  /// Should F be stored in dense blocks? As the options say; if they leave the choice to us, when the blocks of every
  /// rank take no more than a part of its memory share and the expected multiplications pay for them. Collective.
  /// @param n_unknowns of every subdomain.
  bool is_explicit(const DualOptions               &options,
                   const std::vector<unsigned int> &n_unknowns,
                   const Constraints               &constraints,
                   const MPI_Comm                   comm);
} // namespace slipstick::tfeti
