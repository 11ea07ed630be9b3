#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/cholesky.h>

#include <deal.II/base/exceptions.h>

#include <Eigen/CholmodSupport>

#include <algorithm>
#include <camd.h>

namespace slipstick::tfeti
{
  namespace
  {
    // Below this estimate of 1 / condition number (square of the ratio of extreme pivots) the factor is noise.
    constexpr double smallest_reciprocal_condition = 1e-15;
    // Analyses that are kept: blocks of a rectangle have some ten patterns, METIS parts one each.
    constexpr std::size_t max_analyses = 32;

    /// Fill-reducing permutation (CAMD) that keeps the given unknowns last.
    std::vector<int> constrained_ordering(cholmod_sparse                  &A,
                                          const std::vector<unsigned int> &last,
                                          cholmod_common                  &common)
    {
      std::vector<int> constraint(A.nrow, 0), permutation(A.nrow);
      for (const unsigned int i : last)
        constraint[i] = 1;
      cholmod_sparse *pattern = cholmod_copy(&A, 0, 0, &common); // both triangles, no values
      const bool      success = camd_order(static_cast<int>(A.nrow),
                                      static_cast<int *>(pattern->p),
                                      static_cast<int *>(pattern->i),
                                      permutation.data(),
                                      nullptr,
                                      nullptr,
                                      constraint.data()) >= CAMD_OK;
      cholmod_free_sparse(&pattern, &common);
      AssertThrow(success, dealii::ExcMessage("camd_order failed"));
      return permutation;
    }
  } // namespace

  CholmodSession::CholmodSession()
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
    cholmod_finish(&common);
  }

  void CholmodSession::forget_analyses()
  {
    for (Analysis &known : analyses)
      cholmod_free_factor(&known.factor, &common);
    analyses.clear();
  }

  cholmod_factor *CholmodSession::analysis(cholmod_sparse &A, const std::vector<unsigned int> &last)
  {
    const auto *columns = static_cast<const int *>(A.p), *rows = static_cast<const int *>(A.i);
    const auto  n = A.ncol, n_entries = static_cast<std::size_t>(columns[n]);
    const auto  is_same = [&](const Analysis &known) {
      return known.columns.size() == n + 1 && known.rows.size() == n_entries && known.last == last &&
             std::equal(known.columns.begin(), known.columns.end(), columns) &&
             std::equal(known.rows.begin(), known.rows.end(), rows);
    };
    const auto found = std::find_if(analyses.begin(), analyses.end(), is_same);
    if (found != analyses.end())
      return found->factor;

    cholmod_factor *factor;
    if (last.empty())
      {
        common.method[0].ordering = CHOLMOD_AMD;
        common.postorder          = 1;
        factor                    = cholmod_analyze(&A, &common);
      }
    else
      {
        auto permutation          = constrained_ordering(A, last, common);
        common.method[0].ordering = CHOLMOD_GIVEN;
        common.postorder          = 0; // CAMD has done so within its constraints; another one may mix the groups
        factor                    = cholmod_analyze_p(&A, permutation.data(), nullptr, 0, &common);
      }
    if (factor == nullptr)
      throw NumericalError("not enough memory for the analysis of a stiffness matrix",
                           "use more or smaller subdomains (Decomposition), or more ranks on more machines");
    if (analyses.size() == max_analyses)
      {
        cholmod_free_factor(&analyses.front().factor, &common);
        analyses.erase(analyses.begin());
      }
    analyses.push_back({{columns, columns + n + 1}, {rows, rows + n_entries}, last, factor});
    return factor;
  }

  void Cholesky::FactorDeleter::operator()(cholmod_factor *factor) const
  {
    cholmod_free_factor(&factor, &session->common);
  }

  void Cholesky::DenseDeleter::operator()(cholmod_dense *dense) const
  {
    cholmod_free_dense(&dense, &session->common);
  }

  Cholesky::Cholesky(const std::shared_ptr<CholmodSession> &session,
                     const Eigen::SparseMatrix<double>     &lower,
                     const std::vector<unsigned int>       &last,
                     const std::string                     &name)
    : session(session)
    , factor(nullptr, FactorDeleter{session})
  {
    cholmod_common &common = session->common;
    cholmod_sparse  A      = Eigen::viewAsCholmod(lower.selfadjointView<Eigen::Lower>());
    factor.reset(cholmod_copy_factor(session->analysis(A, last), &common));
    const auto *permutation = static_cast<const int *>(factor->Perm);
    trailing.assign(permutation + factor->n - last.size(), permutation + factor->n);
    cholmod_factorize(&A, factor.get(), &common);
    if (common.status == CHOLMOD_OUT_OF_MEMORY)
      throw NumericalError(name + ": not enough memory for the Cholesky factor",
                           "use more or smaller subdomains (Decomposition), or more ranks on more machines");
    if (common.status != CHOLMOD_OK || factor->minor < factor->n ||
        cholmod_rcond(factor.get(), &common) < smallest_reciprocal_condition)
      throw NumericalError(name +
                             ": its regularised stiffness matrix is not positive definite, so its kernel is larger "
                             "than the rigid motions or its stiffness is zero to rounding",
                           "look for degenerate cells, a hinge inside the subdomain, or extreme material parameters");
  }

  void Cholesky::solve(Eigen::VectorXd &x) const
  {
    cholmod_dense b{};
    b.nrow = b.d = b.nzmax = x.size();
    b.ncol                 = 1;
    b.x                    = x.data();
    b.xtype                = CHOLMOD_REAL;
    b.dtype                = CHOLMOD_DOUBLE;
    const std::unique_ptr<cholmod_dense, DenseDeleter> solution(
      cholmod_solve(CHOLMOD_A, factor.get(), &b, &session->common),
      DenseDeleter{session});
    std::copy_n(static_cast<const double *>(solution->x), x.size(), x.data());
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
