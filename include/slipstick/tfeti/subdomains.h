// The subdomains of this rank with everything derived from K_p: factors and dense blocks are kept when the rows of B
// change.
#pragma once

#include <slipstick/tfeti/dual_operator.h>
#include <slipstick/tfeti/options.h>

namespace slipstick::tfeti
{
  class Subdomains
  {
  public:
    explicit Subdomains(std::vector<SubdomainMatrices> matrices);

    /// Sets the loads f_p of another load step [N].
    void set_loads(std::vector<Eigen::VectorXd> loads);

    /// Factorises the subdomains whose touched unknowns differ from those of the last call (all of them in the first
    /// call), and computes the dense blocks and K+ f. The options must be those of the last call.
    /// @param touched unknowns touched by rows of B, sorted. @param explicit_blocks whether to compute blocks of K+.
    /// @throws InputError as SubdomainSystem does, on the affected rank only.
    void prepare(const std::vector<std::vector<unsigned int>> &touched,
                 const bool                                    explicit_blocks,
                 const DualOptions                            &options);

    unsigned int size() const
    {
      return systems.size();
    }

    std::vector<unsigned int> n_unknowns() const;

    /// Time spent on Cholesky factors so far [s], and their number.
    double factorization_seconds() const
    {
      return seconds;
    }
    unsigned int n_factorizations() const
    {
      return factorizations;
    }

    // of every subdomain, after prepare()
    std::vector<std::unique_ptr<SubdomainSystem>> systems;
    std::vector<PackedSymmetric>                  inverses;          // K+ at the touched unknowns
    std::vector<PackedSymmetric>                  schur_complements; // with the Dirichlet preconditioner; empty where
                                                                     // the systems apply them by factors

    /// K+ f of every subdomain, after prepare() [mm].
    const std::vector<Eigen::VectorXd> &unconstrained();

  private:
    void solve_load(const unsigned int p);

    std::vector<SubdomainMatrices> parts;     // until factorised
    std::vector<Eigen::VectorXd>   solutions; // K+ f; empty after a change of the load
    double                         seconds        = 0;
    unsigned int                   factorizations = 0;
  };
} // namespace slipstick::tfeti
