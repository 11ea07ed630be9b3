#include <slipstick/base/memory.h>
#include <slipstick/tfeti/operator_choice.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace slipstick::tfeti
{
  namespace
  {
    // Measured rates of one core (benchmarks/cholesky.cc, bandwidth.cc): dense inverse of a factor, reading a factor or
    // block.
    constexpr double operations_per_second = 40e9;
    constexpr double bytes_per_second      = 15e9;
    // Number of entries of the Cholesky factor with the touched unknowns last over n log2 n, plane meshes (4.5e5 to
    // 6.4e5 at n = 5202), and seconds per factorisation over n^1.5 (2.9 ms there).
    constexpr double factor_growth = 8;
    constexpr double factor_time   = 8e-9;
    // Minimum number of multiplications with F in a run: norm estimate and solution.
    constexpr double expected_multiplications = 40;
    // Part of a process's memory share that the dense blocks may take.
    constexpr double memory_part  = 0.5;
    constexpr double bytes_per_mb = 1048576;

    std::size_t n_touched(const std::vector<Constraints::Entry> &block)
    {
      std::set<unsigned int> dofs;
      for (const auto &entry : block)
        dofs.insert(entry.dof);
      return dofs.size();
    }
  } // namespace

  BlockEstimate estimate_block(const std::size_t n_unknowns, const std::size_t n_touched, const DualOptions &options)
  {
    const double      n = n_unknowns, t = n_touched, factor = factor_growth * n * std::log2(std::max(n, 2.));
    const std::size_t packed = n_touched * (n_touched + 1) / 2;
    const auto        size   = [](const Precision precision) {
      return precision == Precision::single_precision ? sizeof(float) : sizeof(double);
    };
    BlockEstimate estimate;
    estimate.bytes = packed * size(options.operator_precision);
    if (options.preconditioner == Preconditioner::dirichlet)
      estimate.bytes += packed * size(options.preconditioner_precision);
    estimate.setup = 2. / 3. * t * t * t / operations_per_second;
    if (!options.keeps_factors)
      estimate.setup += factor_time * std::pow(n, 1.5); // factorisation for the recovery
    estimate.saving = (2 * sizeof(double) * factor - packed * size(options.operator_precision)) / bytes_per_second;
    return estimate;
  }

  bool is_explicit(const DualOptions               &options,
                   const std::vector<unsigned int> &n_unknowns,
                   const Constraints               &constraints,
                   const MPI_Comm                   comm)
  {
    if (options.dual_operator != DualOperatorKind::automatic)
      return options.dual_operator == DualOperatorKind::explicit_blocks;
    std::size_t bytes = 0;
    double      gain  = 0;
    for (unsigned int p = 0; p < n_unknowns.size(); ++p)
      {
        const auto estimate = estimate_block(n_unknowns[p], n_touched(constraints.blocks[p]), options);
        bytes += estimate.bytes;
        gain += expected_multiplications * estimate.saving - estimate.setup;
      }
    const bool fits = bytes <= memory_part * share_of_free_memory_mb(comm) * bytes_per_mb;
    return dealii::Utilities::MPI::min(fits ? 1 : 0, comm) > 0 && dealii::Utilities::MPI::sum(gain, comm) >= 0;
  }
} // namespace slipstick::tfeti
