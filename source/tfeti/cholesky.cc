#include <slipstick/base/exceptions.h>
#include <slipstick/base/termination.h>
#include <slipstick/tfeti/cholesky.h>

#include <deal.II/base/exceptions.h>

#include <Eigen/CholmodSupport>

#include <algorithm>
#include <camd.h>
#include <cmath>
#include <new>

namespace slipstick::tfeti
{
  namespace
  {
    // Below this estimate of 1 / condition number (square of the ratio of extreme pivots) the factor is only rounding
    // error.
    constexpr double smallest_reciprocal_condition = 1e-15;
    // Entries that differ by less than this part of the diagonal are equal up to rounding of coordinates. The error of
    // a factorisation is not smaller.
    constexpr double equal_entries = 1e-13;
    // Factors kept for matrices with the same pattern.
    constexpr std::size_t max_factors = 4;
    // Cached analyses: the blocks of a rectangle have about ten patterns; each METIS part has its own.
    constexpr std::size_t max_analyses = 32;

    /// Call it after every CHOLMOD function that allocates memory.
    /// @throws std::bad_alloc, which may be thrown on this rank only: main() ends the other ranks. InputError for more
    /// entries than indices can count: first in Subdomains::prepare, which throws it on all ranks.
    void check(const cholmod_common &common)
    {
      if (common.status == CHOLMOD_OUT_OF_MEMORY)
        throw std::bad_alloc();
      if (common.status == CHOLMOD_TOO_LARGE)
        throw InputError("the matrix of a subdomain or its factor is too large for indices of 32 bits",
                         "use more subdomains (Decomposition)");
    }

    /// For matrices with the same pattern.
    bool are_equal(const cholmod_sparse &A, const std::vector<double> &entries)
    {
      const auto         *columns = static_cast<const int *>(A.p), *rows = static_cast<const int *>(A.i);
      const auto         *values = static_cast<const double *>(A.x);
      std::vector<double> diagonal(A.ncol, 0.);
      for (std::size_t j = 0; j < A.ncol; ++j)
        for (int k = columns[j]; k < columns[j + 1]; ++k)
          if (rows[k] == static_cast<int>(j))
            diagonal[j] = std::abs(values[k]);
      for (std::size_t j = 0; j < A.ncol; ++j)
        for (int k = columns[j]; k < columns[j + 1]; ++k)
          if (!(std::abs(values[k] - entries[k]) <= equal_entries * std::sqrt(diagonal[j] * diagonal[rows[k]])))
            return false;
      return true;
    }

    /// Fill-reducing permutation (CAMD) that keeps the given unknowns last.
    std::vector<int> constrained_ordering(cholmod_sparse                  &A,
                                          const std::vector<unsigned int> &last,
                                          cholmod_common                  &common)
    {
      std::vector<int> constraint(A.nrow, 0), permutation(A.nrow);
      for (const unsigned int i : last)
        constraint[i] = 1;
      cholmod_sparse *pattern = cholmod_copy(&A, 0, 0, &common); // both triangles, no values
      check(common);
      const int result = camd_order(static_cast<int>(A.nrow),
                                    static_cast<int *>(pattern->p),
                                    static_cast<int *>(pattern->i),
                                    permutation.data(),
                                    nullptr,
                                    nullptr,
                                    constraint.data());
      cholmod_free_sparse(&pattern, &common);
      if (result == CAMD_OUT_OF_MEMORY)
        throw std::bad_alloc();
      AssertThrow(result >= CAMD_OK, dealii::ExcMessage("camd_order failed"));
      return permutation;
    }

    /// Nested dissection of all but the given unknowns, which come last; the columns of each separator are contiguous.
    std::vector<int> dissection(const cholmod_sparse &A, const std::vector<unsigned int> &last, cholmod_common &common)
    {
      std::vector<int> place(A.nrow, 0), others;
      for (const unsigned int i : last)
        place[i] = -1;
      for (unsigned int i = 0; i < A.nrow; ++i)
        if (place[i] == 0)
          {
            place[i] = static_cast<int>(others.size());
            others.push_back(static_cast<int>(i));
          }
      const auto      *columns = static_cast<const int *>(A.p), *rows = static_cast<const int *>(A.i);
      std::vector<int> part_columns = {0}, part_rows;
      for (const int j : others)
        {
          for (int k = columns[j]; k < columns[j + 1]; ++k)
            if (place[rows[k]] >= 0)
              part_rows.push_back(place[rows[k]]);
          part_columns.push_back(static_cast<int>(part_rows.size()));
        }
      cholmod_sparse pattern = A;
      pattern.nrow = pattern.ncol = others.size();
      pattern.nzmax               = part_rows.size();
      pattern.p                   = part_columns.data();
      pattern.i                   = part_rows.data();
      pattern.x                   = nullptr;
      pattern.xtype               = CHOLMOD_PATTERN;
      std::vector<int> permutation(others.size());
      if (!others.empty())
        {
          const bool success = cholmod_metis(&pattern, nullptr, 0, 1, permutation.data(), &common) != 0;
          check(common);
          raise_termination(!success);
          AssertThrow(success, dealii::ExcMessage("cholmod_metis failed"));
        }
      for (int &k : permutation)
        k = others[k];
      permutation.insert(permutation.end(), last.begin(), last.end());
      return permutation;
    }
  } // namespace

  const Cholesky::Failure Cholesky::of_stiffness = {
    ": its regularised stiffness matrix is not positive definite, so its kernel is larger than the rigid motions or its "
    "stiffness is zero to rounding",
    "look for degenerate cells, a hinge inside the subdomain, or extreme material parameters",
    true};

  CholmodSession::CholmodSession(const Ordering ordering)
    : ordering(ordering)
  {
    cholmod_start(&common);
    common.supernodal         = CHOLMOD_SUPERNODAL;
    common.final_ll           = 1;
    common.print              = 0;
    common.nmethods           = 1;
    common.method[0].ordering = CHOLMOD_AMD;
  }

  CholmodSession::~CholmodSession()
  {
    forget_analyses();
    for (cholmod_dense **workspace : {&X, &Y, &E})
      cholmod_free_dense(workspace, &common);
    cholmod_finish(&common);
  }

  void CholmodSession::forget_analyses()
  {
    for (Analysis &known : analyses)
      cholmod_free_factor(&known.factor, &common);
    analyses.clear();
  }

  std::vector<CholmodSession::Analysis>::const_iterator CholmodSession::find(
    const cholmod_sparse            &A,
    const std::vector<unsigned int> &last) const
  {
    const auto *columns = static_cast<const int *>(A.p), *rows = static_cast<const int *>(A.i);
    const auto  n = A.ncol, n_entries = static_cast<std::size_t>(columns[n]);
    return std::find_if(analyses.begin(), analyses.end(), [&](const Analysis &known) {
      return known.columns.size() == n + 1 && known.rows.size() == n_entries && known.last == last &&
             std::equal(known.columns.begin(), known.columns.end(), columns) &&
             std::equal(known.rows.begin(), known.rows.end(), rows);
    });
  }

  std::shared_ptr<cholmod_factor> CholmodSession::factor_of(const cholmod_sparse            &A,
                                                            const std::vector<unsigned int> &last) const
  {
    if (const auto of_pattern = find(A, last); of_pattern != analyses.end())
      for (const Factorised &known : of_pattern->factorised)
        if (auto factor = known.factor.lock(); factor && are_equal(A, known.entries))
          return factor;
    return nullptr;
  }

  void CholmodSession::keep(const cholmod_sparse                  &A,
                            const std::vector<unsigned int>       &last,
                            const std::shared_ptr<cholmod_factor> &factor)
  {
    for (Analysis &known : analyses) // entries of factors that are gone would only take memory
      known.factorised.erase(std::remove_if(known.factorised.begin(),
                                            known.factorised.end(),
                                            [](const Factorised &old) { return old.factor.expired(); }),
                             known.factorised.end());
    auto &factorised = analyses[find(A, last) - analyses.begin()].factorised;
    if (factorised.size() == max_factors)
      factorised.erase(factorised.begin());
    const auto *entries = static_cast<const double *>(A.x);
    factorised.push_back({{entries, entries + static_cast<const int *>(A.p)[A.ncol]}, factor});
  }

  const double *CholmodSession::solve(const int system, cholmod_factor &factor, cholmod_dense &B)
  {
    // it can only lack memory; on one rank, perhaps: see check()
    if (cholmod_solve2(system, &factor, &B, nullptr, &X, nullptr, &Y, &E, &common) == 0)
      throw std::bad_alloc();
    return static_cast<const double *>(X->x);
  }

  cholmod_factor *CholmodSession::analysis(cholmod_sparse &A, const std::vector<unsigned int> &last)
  {
    if (const auto found = find(A, last); found != analyses.end())
      return found->factor;

    cholmod_factor *factor = analyse(A, last);
    check(common);
    AssertThrow(factor != nullptr, dealii::ExcMessage("cholmod_analyze failed"));
    if (analyses.size() == max_analyses)
      {
        cholmod_free_factor(&analyses.front().factor, &common);
        analyses.erase(analyses.begin());
      }
    const auto *columns = static_cast<const int *>(A.p), *rows = static_cast<const int *>(A.i);
    analyses.push_back({{columns, columns + A.ncol + 1}, {rows, rows + columns[A.ncol]}, last, factor});
    return factor;
  }

  cholmod_factor *CholmodSession::analyse(cholmod_sparse &A, const std::vector<unsigned int> &last)
  {
    if (last.empty() && ordering == Ordering::minimum_degree)
      {
        common.method[0].ordering = CHOLMOD_AMD;
        common.postorder          = 1;
        return cholmod_analyze(&A, &common);
      }
    auto permutation =
      ordering == Ordering::minimum_degree ? constrained_ordering(A, last, common) : dissection(A, last, common);
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder          = 0; // done within the groups; a global postorder may mix them
    return cholmod_analyze_p(&A, permutation.data(), nullptr, 0, &common);
  }

  Cholesky::Cholesky(const std::shared_ptr<CholmodSession> &session,
                     const Eigen::SparseMatrix<double>     &lower,
                     const std::vector<unsigned int>       &last,
                     const std::string                     &name,
                     const Failure                         &failure)
    : session(session)
  {
    cholmod_common &common = session->common;
    cholmod_sparse  A      = Eigen::viewAsCholmod(lower.selfadjointView<Eigen::Lower>());
    if (last.empty() && (factor = session->factor_of(A, last)))
      return;
    // The session keeps a weak pointer, and the deleter lives as long as that: it must not own the session. Every user
    // of the factor does.
    factor = std::shared_ptr<cholmod_factor>(cholmod_copy_factor(session->analysis(A, last), &common),
                                             [owner = session.get()](cholmod_factor *unused) {
                                               cholmod_free_factor(&unused, &owner->common);
                                             });
    check(common);
    const auto *permutation = static_cast<const int *>(factor->Perm);
    trailing.assign(permutation + factor->n - last.size(), permutation + factor->n);
    cholmod_factorize(&A, factor.get(), &common);
    check(common);
    if (common.status != CHOLMOD_OK || factor->minor < factor->n ||
        cholmod_rcond(factor.get(), &common) < smallest_reciprocal_condition)
      {
        if (failure.is_of_input)
          throw InputError(name + failure.text, failure.remedy);
        throw NumericalError(name + failure.text, failure.remedy);
      }
    if (last.empty())
      session->keep(A, last, factor);
  }

  void Cholesky::solve(Eigen::VectorXd &x) const
  {
    solve(CHOLMOD_A, x.data(), 1);
  }

  void Cholesky::solve(Eigen::MatrixXd &columns) const
  {
    solve(CHOLMOD_A, columns.data(), columns.cols());
  }

  void Cholesky::solve_lower(Eigen::VectorXd &x) const
  {
    solve(CHOLMOD_P, x.data(), 1);
    solve(CHOLMOD_L, x.data(), 1);
  }

  void Cholesky::solve_upper(Eigen::VectorXd &x) const
  {
    solve(CHOLMOD_Lt, x.data(), 1);
    solve(CHOLMOD_Pt, x.data(), 1);
  }

  void Cholesky::solve(const int system, double *x, const std::size_t n_columns) const
  {
    cholmod_dense B{};
    B.nrow = B.d = factor->n;
    B.ncol       = n_columns;
    B.nzmax      = factor->n * n_columns;
    B.x          = x;
    B.xtype      = CHOLMOD_REAL;
    B.dtype      = CHOLMOD_DOUBLE;
    std::copy_n(session->solve(system, *factor, B), B.nzmax, x);
  }

  Eigen::MatrixXd Cholesky::trailing_block() const
  {
    // supernode s: columns super[s] .. super[s+1], dense, rows listed at s + pi[s], values at x + px[s]
    const auto  n      = static_cast<int>(factor->n);
    const int   first  = n - static_cast<int>(trailing.size());
    const auto *super  = static_cast<const int *>(factor->super);
    const auto *pi     = static_cast<const int *>(factor->pi);
    const auto *px     = static_cast<const int *>(factor->px);
    const auto *rows   = static_cast<const int *>(factor->s);
    const auto *values = static_cast<const double *>(factor->x);

    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(trailing.size(), trailing.size());
    for (int s = static_cast<int>(factor->nsuper) - 1; s >= 0 && super[s + 1] > first; --s)
      {
        const int n_rows = pi[s + 1] - pi[s];
        for (int column = std::max(super[s], first); column < super[s + 1]; ++column)
          for (int k = column - super[s]; k < n_rows; ++k)
            block(rows[pi[s] + k] - first, column - first) =
              values[px[s] + static_cast<std::ptrdiff_t>(column - super[s]) * n_rows + k];
      }
    return block;
  }

  std::size_t Cholesky::n_nonzeros() const
  {
    return factor->xsize;
  }
} // namespace slipstick::tfeti
