#include <slipstick/tfeti/subdomains.h>

#include <mpi.h>

#include <utility>

namespace slipstick::tfeti
{
  Subdomains::Subdomains(std::vector<SubdomainMatrices> matrices)
    : systems(matrices.size())
    , parts(std::move(matrices))
    , solutions(parts.size())
  {}

  void Subdomains::set_loads(std::vector<Eigen::VectorXd> loads)
  {
    for (unsigned int p = 0; p < size(); ++p)
      {
        if (systems[p])
          systems[p]->set_load(std::move(loads[p]));
        else
          parts[p].load = std::move(loads[p]);
        solutions[p].resize(0);
      }
  }

  void Subdomains::solve_load(const unsigned int p)
  {
    solutions[p] = systems[p]->load();
    systems[p]->apply_pseudo_inverse(solutions[p]);
  }

  const std::vector<Eigen::VectorXd> &Subdomains::unconstrained()
  {
    for (unsigned int p = 0; p < size(); ++p)
      if (solutions[p].size() == 0)
        solve_load(p);
    return solutions;
  }

  std::vector<unsigned int> Subdomains::n_unknowns() const
  {
    std::vector<unsigned int> result;
    for (unsigned int p = 0; p < size(); ++p)
      result.push_back(systems[p] ? systems[p]->n_unknowns() : parts[p].load.size());
    return result;
  }

  void Subdomains::prepare(const std::vector<std::vector<unsigned int>> &touched,
                           const bool                                    explicit_blocks,
                           const DualOptions                            &options)
  {
    const bool has_schur       = options.preconditioner == Preconditioner::dirichlet;
    const auto session         = std::make_shared<CholmodSession>();
    const auto dissecting      = std::make_shared<CholmodSession>(Ordering::nested_dissection);
    auto       inverses_before = std::exchange(inverses, {}), schur_before = std::exchange(schur_complements, {});
    for (unsigned int p = 0; p < size(); ++p)
      {
        const bool is_kept = systems[p] && systems[p]->touched() == touched[p] &&
                             (explicit_blocks ? !inverses_before.empty() : systems[p]->has_factor());
        if (!is_kept)
          {
            const double start = MPI_Wtime();
            if (systems[p])
              parts[p] = systems[p]->take_matrices();
            const bool by_factors =
              !explicit_blocks && has_schur && SubdomainSystem::prefers_factors(parts[p], touched[p].size());
            systems[p] = std::make_unique<SubdomainSystem>(by_factors ? dissecting : session,
                                                           std::move(parts[p]),
                                                           touched[p],
                                                           !by_factors && (explicit_blocks || has_schur),
                                                           by_factors);
            if (by_factors)
              systems[p]->prepare_schur_complement(dissecting);
            seconds += MPI_Wtime() - start;
            ++factorizations;
          }
        SubdomainSystem &system = *systems[p];
        if (explicit_blocks)
          inverses.push_back(is_kept ? std::move(inverses_before[p])
                                     : system.pseudo_inverse_block(options.operator_precision));
        if (has_schur)
          schur_complements.push_back(is_kept ? std::move(schur_before[p])
                                      : system.has_schur_complement()
                                        ? PackedSymmetric(Eigen::MatrixXd(), {}, options.preconditioner_precision)
                                        : system.schur_complement(options.preconditioner_precision));
        if (!is_kept || solutions[p].size() == 0)
          solve_load(p);
        if (explicit_blocks && !options.keeps_factors)
          system.release(); // keep one factor at a time
      }
    session->forget_analyses();
    dissecting->forget_analyses();
  }
} // namespace slipstick::tfeti
