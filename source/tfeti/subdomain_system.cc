#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/tfeti/subdomain_system.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace slipstick::tfeti
{
  namespace
  {
    // Pivots below this mean that the touched unknowns do not hold the subdomain well (1 = perfectly).
    constexpr double smallest_good_pivot = 0.1;
    // Candidates whose squared pivots differ by less than this part are equivalent: rounding of coordinates must not
    // decide.
    constexpr double equal_pivots = 1e-8;
    // |K R| over |K| |R| above this means that R is not the kernel.
    constexpr double kernel_tolerance = 1e-8;

    // v'K v over |K| v'v below this, where v is the solution for random forces, is rounding: measured 1e-19 to 3e-17
    // with a hinge, more than 1e-15 without one up to a slenderness of 4000.
    constexpr double smallest_stiffness = 2e-16;
    // Below this single precision (6e-8 of the largest entries) loses the softest deformations. Measured: 9e-4, 4e-5,
    // 2e-6 for 10, 50 and 200 cells along an edge (not lost), 1e-9 and less for strips of cells of 1000 to 1 (lost).
    constexpr double smallest_single_stiffness = 2e-7;

    // Blocks at the touched unknowns pay off below this number of entries relative to that of K. In the plane they
    // always do; cubes of 8^3 cells in space have 8 times as many.
    constexpr double entries_of_blocks = 4;

    std::string name_of(const SubdomainMatrices &matrices)
    {
      return "subdomain " + std::to_string(matrices.subdomain);
    }

    void check_kernel(const SubdomainMatrices &matrices)
    {
      const Eigen::MatrixXd KR = matrices.stiffness.selfadjointView<Eigen::Lower>() * matrices.kernel;
      const double          relative =
        KR.cwiseAbs().maxCoeff() / (matrices.stiffness.diagonal().maxCoeff() * matrices.kernel.cwiseAbs().maxCoeff());
      if (!(relative < kernel_tolerance))
        throw InputError(name_of(matrices) + format(": a rigid motion strains it (|K R| = %g relative)", relative),
                         "look for inverted or degenerate cells in the mesh");
    }

    /// K may have a larger kernel than R: the factor of a matrix that is singular in exact arithmetic may exist, but
    /// its solutions then lie in the kernel.
    /// @return estimated stiffness against the softest deformation over the largest entry of K.
    double check_no_larger_kernel(const SubdomainMatrices &matrices, const Cholesky &cholesky)
    {
      std::minstd_rand                       random;
      std::uniform_real_distribution<double> uniform(-1, 1);
      Eigen::VectorXd                        v(matrices.load.size());
      for (double &force : v)
        force = uniform(random);
      cholesky.solve(v);
      v.normalize();
      const double stiffness =
        v.dot(matrices.stiffness.selfadjointView<Eigen::Lower>() * v) / matrices.stiffness.diagonal().maxCoeff();
      if (!(stiffness > smallest_stiffness))
        throw InputError(name_of(matrices) + format(": its stiffness matrix does not resist a motion that is not rigid "
                                                    "(energy %g relative)",
                                                    stiffness),
                         "look for degenerate cells, a hinge inside the subdomain, or extreme material parameters");
      return stiffness;
    }

    std::vector<unsigned int> choose_fixing(const SubdomainMatrices         &matrices,
                                            const std::vector<unsigned int> &touched,
                                            const bool                       from_touched)
    {
      if (from_touched && touched.size() >= static_cast<std::size_t>(matrices.kernel.cols()))
        {
          const auto [chosen, pivot] = fixing_unknowns(matrices.kernel, touched);
          if (pivot > smallest_good_pivot)
            return chosen;
        }
      return fixing_unknowns(matrices.kernel, matrices.boundary_dofs, equal_pivots).first;
    }

    Eigen::SparseMatrix<double> regularised(const Eigen::SparseMatrix<double> &stiffness,
                                            const std::vector<unsigned int>   &fixing,
                                            const double                       rho)
    {
      Eigen::SparseMatrix<double> sum = stiffness;
      for (const unsigned int i : fixing)
        sum.coeffRef(i, i) += rho;
      return sum;
    }

    std::vector<unsigned int> merged(const std::vector<unsigned int> &a, const std::vector<unsigned int> &b)
    {
      std::set<unsigned int> all(a.begin(), a.end());
      all.insert(b.begin(), b.end());
      return {all.begin(), all.end()};
    }
  } // namespace

  std::pair<std::vector<unsigned int>, double> fixing_unknowns(const Eigen::MatrixXd           &kernel,
                                                               const std::vector<unsigned int> &candidates,
                                                               const double                     equal)
  {
    Eigen::MatrixXd rows(candidates.size(), kernel.cols());
    for (unsigned int i = 0; i < candidates.size(); ++i)
      rows.row(i) = kernel.row(candidates[i]);

    std::vector<unsigned int> chosen;
    if (candidates.empty())
      return {chosen, 0.};
    double smallest = std::numeric_limits<double>::max();
    for (int k = 0; k < kernel.cols(); ++k)
      {
        const Eigen::VectorXd squares = rows.rowwise().squaredNorm();
        const double          largest = squares.maxCoeff();
        smallest                      = std::min(smallest, std::sqrt(largest));
        if (smallest == 0)
          break;
        const auto i = std::find_if(squares.begin(),
                                    squares.end(),
                                    [&](const double square) { return square >= (1 - equal) * largest; }) -
                       squares.begin();
        chosen.push_back(candidates[i]);
        const Eigen::RowVectorXd direction = rows.row(i).normalized();
        rows -= (rows * direction.transpose()) * direction;
      }
    return {chosen, smallest};
  }

  SubdomainSystem::SubdomainSystem(const std::shared_ptr<CholmodSession> &session,
                                   SubdomainMatrices                      given,
                                   std::vector<unsigned int>              touched,
                                   const bool                             with_trailing_block,
                                   const bool                             fixed_at_boundary)
    : session(session)
    , matrices((check_kernel(given), std::move(given)))
    , touched_unknowns(std::move(touched))
    , fixing_unknowns(choose_fixing(matrices, touched_unknowns, !fixed_at_boundary))
    , regularization(matrices.stiffness.diagonal().mean())
    , cholesky(
        factorised(with_trailing_block ? merged(touched_unknowns, fixing_unknowns) : std::vector<unsigned int>()))
  {
    is_soft = check_no_larger_kernel(matrices, *cholesky) < smallest_single_stiffness;
  }

  Cholesky SubdomainSystem::factorised(const std::vector<unsigned int> &last) const
  {
    return {session, regularised(matrices.stiffness, fixing_unknowns, regularization), last, name_of(matrices)};
  }

  void SubdomainSystem::apply_pseudo_inverse(Eigen::VectorXd &x) const
  {
    if (cholesky)
      cholesky->solve(x);
    else
      factorised({}).solve(x);
  }

  void SubdomainSystem::apply_pseudo_inverse(Eigen::MatrixXd &columns) const
  {
    if (cholesky)
      cholesky->solve(columns);
    else
      factorised({}).solve(columns);
  }

  Eigen::VectorXd SubdomainSystem::volumes() const
  {
    if (matrices.volumes.size() == 0)
      return Eigen::VectorXd::Ones(n_unknowns());
    const Eigen::Index dim = n_unknowns() / matrices.volumes.size();
    return matrices.volumes.transpose().replicate(dim, 1).reshaped();
  }

  std::array<double, 3> SubdomainSystem::position(const unsigned int unknown) const
  {
    std::array<double, 3> x{{0, 0, 0}};
    if (matrices.positions.size() > 0)
      for (Eigen::Index d = 0; d < matrices.positions.rows(); ++d)
        x[d] = matrices.positions(d, unknown / (n_unknowns() / matrices.positions.cols()));
    return x;
  }

  Eigen::VectorXd SubdomainSystem::apply_touched_stiffness(const Eigen::VectorXd &x) const
  {
    Eigen::VectorXd u   = Eigen::VectorXd::Zero(n_unknowns());
    u(touched_unknowns) = x;
    return apply_stiffness(u)(touched_unknowns);
  }

  PackedSymmetric SubdomainSystem::pseudo_inverse_block(const Precision precision) const
  {
    return {inverse_of_product(cholesky->trailing_block()), touched_in_last_order(), precision};
  }

  PackedSymmetric SubdomainSystem::schur_complement(const Precision precision) const
  {
    Eigen::MatrixXd schur = product_of_factor(cholesky->trailing_block());
    const auto     &order = cholesky->last_order();
    for (unsigned int k = 0; k < order.size(); ++k)
      if (std::find(fixing_unknowns.begin(), fixing_unknowns.end(), order[k]) != fixing_unknowns.end())
        schur(k, k) -= regularization;
    return {schur, touched_in_last_order(), is_soft ? Precision::double_precision : precision};
  }

  void SubdomainSystem::prepare_schur_complement(const std::shared_ptr<CholmodSession> &of_inner)
  {
    std::vector<bool>         is_touched(n_unknowns());
    std::vector<unsigned int> place(n_unknowns()); // among the touched unknowns or the inner ones
    for (const unsigned int i : touched_unknowns)
      is_touched[i] = true;
    std::array<unsigned int, 2> n{{0, 0}};
    for (unsigned int i = 0; i < n_unknowns(); ++i)
      place[i] = n[is_touched[i]]++;
    std::vector<Eigen::Triplet<double>> of_inner_ones, between, of_touched;
    for (Eigen::Index j = 0; j < matrices.stiffness.outerSize(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrices.stiffness, j); entry; ++entry)
        {
          const auto row = entry.row(), column = entry.col();
          if (is_touched[row] != is_touched[column])
            between.emplace_back(place[is_touched[row] ? column : row],
                                 place[is_touched[row] ? row : column],
                                 entry.value());
          else
            (is_touched[row] ? of_touched : of_inner_ones).emplace_back(place[row], place[column], entry.value());
        }
    const auto matrix = [](const unsigned int rows, const unsigned int columns, const auto &entries) {
      Eigen::SparseMatrix<double> result(rows, columns);
      result.setFromTriplets(entries.begin(), entries.end());
      return result;
    };
    inner_touched = matrix(n[0], n[1], between);
    touched_part  = matrix(n[1], n[1], of_touched);
    inner.emplace(of_inner, matrix(n[0], n[0], of_inner_ones), std::vector<unsigned int>(), name_of(matrices));
  }

  void SubdomainSystem::apply_schur_complements(const std::vector<const SubdomainSystem *> &subdomains,
                                                std::vector<Eigen::VectorXd>               &x)
  {
    Eigen::MatrixXd at_inner(subdomains.front()->inner_touched.rows(), subdomains.size());
    for (unsigned int k = 0; k < subdomains.size(); ++k)
      at_inner.col(k) = subdomains[k]->inner_touched * x[k];
    subdomains.front()->inner->solve(at_inner);
    for (unsigned int k = 0; k < subdomains.size(); ++k)
      x[k] = subdomains[k]->touched_part.selfadjointView<Eigen::Lower>() * x[k] -
             subdomains[k]->inner_touched.transpose() * at_inner.col(k);
  }

  bool SubdomainSystem::prefers_factors(const SubdomainMatrices &matrices, const std::size_t n_touched)
  {
    return is_solid(matrices.kernel.cols()) && n_touched < static_cast<std::size_t>(matrices.load.size()) &&
           n_touched * n_touched / 2 > entries_of_blocks * matrices.stiffness.nonZeros();
  }

  Eigen::VectorXd SubdomainSystem::touched_diagonal() const
  {
    Eigen::VectorXd diagonal(touched_unknowns.size());
    for (unsigned int k = 0; k < touched_unknowns.size(); ++k)
      diagonal[k] = matrices.stiffness.coeff(touched_unknowns[k], touched_unknowns[k]);
    return diagonal;
  }

  std::vector<unsigned int> SubdomainSystem::touched_in_last_order() const
  {
    std::vector<unsigned int> position(n_unknowns(), 0), touched;
    for (unsigned int k = 0; k < cholesky->last_order().size(); ++k)
      position[cholesky->last_order()[k]] = k;
    for (const unsigned int i : touched_unknowns)
      touched.push_back(position[i]);
    return touched;
  }
} // namespace slipstick::tfeti
