// The subdomains of this rank with everything derived from K_p: factors and dense blocks stay when the rows of B
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

    /// Loads f_p of another load step [N].
    void set_loads(std::vector<Eigen::VectorXd> loads);

    /// Factorises the subdomains whose touched unknowns differ from those of the last call, all of them the first time,
    /// and computes the dense blocks and K+ f. The options must be those of the last call.
    /// @param touched unknowns that rows of B touch, sorted. @param explicit_blocks with blocks of K+.
    /// @throws NumericalError as SubdomainSystem does, on this rank alone.
    void prepare(const std::vector<std::vector<unsigned int>> &touched,
                 const bool                                    explicit_blocks,
                 const DualOptions                            &options);

    unsigned int size() const
    {
      return systems.size();
    }

    std::vector<unsigned int> n_unknowns() const;

    /// Time spent on Cholesky factors so far [s], and how many were made.
    double factorization_seconds() const
    {
      return seconds;
    }
    unsigned int n_factorizations() const
    {
      return factorizations;
    }

    // of every subdomain, once prepared
    std::vector<std::unique_ptr<SubdomainSystem>> systems;
    std::vector<PackedSymmetric>                  inverses;          // K+ at the touched unknowns
    std::vector<PackedSymmetric>                  schur_complements; // with the Dirichlet preconditioner; empty where
                                                                     // systems apply them by factors

    /// K+ f of every subdomain once prepared [mm].
    const std::vector<Eigen::VectorXd> &unconstrained();

  private:
    void solve_load(const unsigned int p);

    std::vector<SubdomainMatrices> parts;     // until they are factorised
    std::vector<Eigen::VectorXd>   solutions; // K+ f, empty where the load is another one
    double                         seconds        = 0;
    unsigned int                   factorizations = 0;
  };
} // namespace slipstick::tfeti
