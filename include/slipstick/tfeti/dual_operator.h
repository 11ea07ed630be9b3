// F = B K+ B', the Hessian of the dual problem, and products with B and B'.
#pragma once

#include <slipstick/tfeti/constraints.h>
#include <slipstick/tfeti/options.h>
#include <slipstick/tfeti/packed.h>
#include <slipstick/tfeti/subdomain_system.h>

namespace slipstick::tfeti
{
  /// B_p of one subdomain, with the unknowns numbered as in SubdomainSystem::touched().
  struct LocalGluing
  {
    struct Entry
    {
      unsigned int row;     // local dual number, ghosts included
      unsigned int touched; // index into SubdomainSystem::touched()
      double       value;
    };
    std::vector<Entry> entries;

    /// The touched unknowns of a block and its entries in their numbering.
    static std::pair<LocalGluing, std::vector<unsigned int>> make(const std::vector<Constraints::Entry> &block);
  };

  /// The owning rank of every ghost of a partitioner, in the order of the ghosts.
  std::vector<unsigned int> owners_of_ghosts(const Partitioner &rows);

  /// y = F x, F = B K+ B' (symmetric positive semidefinite): either by sparse solves with every K_p (implicit), or with
  /// the dense block of K_p+ at the touched unknowns (explicit).
  class DualOperator
  {
  public:
    /// @p blocks of K+ at the touched unknowns of every subdomain, which must live as long as this; null: implicit.
    DualOperator(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                 const std::vector<LocalGluing>                      &gluing,
                 const Partitioner                                   &rows,
                 const std::vector<PackedSymmetric>                  *blocks);

    /// y = F x; x: multipliers [N], y: displacement jumps [mm], owned entries. Collective. Farhat, Roux 1991.
    void apply(const DistributedVector &x, DistributedVector &y) const;

    /// As apply(), by sparse solves even if dense blocks exist. Collective.
    void apply_by_solves(const DistributedVector &x, DistributedVector &y) const;

    /// B' x on subdomain p of this rank: forces at the touched unknowns; x needs its ghosts.
    Eigen::VectorXd scatter(const unsigned int p, const DistributedVector &x) const;

    /// Adds B_p v to y (ghosts included; compress afterwards).
    void gather(const unsigned int p, const Eigen::VectorXd &v, DistributedVector &y) const;

    /// B u of displacements of this rank's subdomains, owned rows [mm]. Collective.
    DistributedVector jumps(const std::vector<Eigen::VectorXd> &u) const;

    /// The column of B (owned rows) that belongs to a touched unknown of a subdomain of one rank. Collective.
    /// @param subdomain its number on the rank that has it; the other ranks pass the number of their subdomains.
    /// @param touched index into SubdomainSystem::touched().
    DistributedVector column(const unsigned int subdomain, const unsigned int touched) const;

    /// B_p'x of this rank's subdomains, all unknowns [N]: the forces of the multipliers (owned entries). Collective.
    std::vector<Eigen::VectorXd> forces(const DistributedVector &x) const;

    /// Zero vectors: with ghosts; with owned entries only.
    DistributedVector ghosted() const;
    DistributedVector zero() const;

    /// Copies the owned entries of x and fetches the ghosts.
    void import(const DistributedVector &x, DistributedVector &with_ghosts) const;

    const std::vector<LocalGluing> &gluing() const
    {
      return of_subdomains;
    }

    unsigned long long n_applications() const
    {
      return applications;
    }

    bool is_explicit() const
    {
      return blocks != nullptr;
    }

    /// Memory of the dense blocks on this rank [bytes].
    std::size_t block_bytes() const;

  private:
    template <class Products>
    void apply(const DistributedVector &x, DistributedVector &y, const Products &add_products) const;
    void add_solutions(const std::vector<unsigned int> &batch) const;

    const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains;
    const std::vector<LocalGluing>                      &of_subdomains;    // B_p
    Partitioner                                          rows, owned_rows; // with and without ghosts
    const std::vector<PackedSymmetric>                  *blocks;           // null: implicit
    mutable DistributedVector                            source, target;
    mutable unsigned long long                           applications = 0;
  };
} // namespace slipstick::tfeti
