#include <slipstick/base/disjoint_sets.h>
#include <slipstick/tfeti/dense.h>
#include <slipstick/tfeti/null_vectors.h>

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>

namespace slipstick::tfeti
{
  namespace
  {
    using Matrix = Eigen::SparseMatrix<double>;

    // Steps of the power method. Its start vector has components along all eigenvectors, whatever the symmetry of the
    // bodies.
    constexpr unsigned int power_steps = 30;

    /// Connected parts of the matrix: index sets that no entry couples.
    std::vector<std::vector<int>> connected_parts(const Matrix &matrix)
    {
      DisjointSets sets(matrix.cols());
      for (int j = 0; j < matrix.outerSize(); ++j)
        for (Matrix::InnerIterator entry(matrix, j); entry; ++entry)
          if (entry.value() != 0)
            sets.join(entry.row(), j);
      std::vector<std::vector<int>> parts(matrix.cols());
      for (unsigned int i = 0; i < parts.size(); ++i)
        parts[sets.root(i)].push_back(i);
      parts.erase(std::remove_if(parts.begin(), parts.end(), [](const auto &part) { return part.empty(); }),
                  parts.end());
      return parts;
    }

    /// Whether all eigenvalues are above the limit. A misjudged pivot near zero only costs a call of the dense solver.
    bool is_above(const Matrix &matrix, const double limit)
    {
      Matrix shifted = matrix;
      for (int i = 0; i < shifted.cols(); ++i)
        shifted.coeffRef(i, i) -= limit;
      const Eigen::SimplicialLDLT<Matrix> factor(shifted);
      return factor.info() == Eigen::Success && (factor.vectorD().array() > 0).all();
    }
  } // namespace

  double largest_eigenvalue(const Matrix &matrix)
  {
    if (matrix.nonZeros() == 0)
      return 0;
    Eigen::VectorXd v(matrix.cols());
    for (Eigen::Index i = 0; i < v.size(); ++i)
      v[i] = 1 + std::sin(i + 1.) / 2;
    double value = 0;
    for (unsigned int step = 0; step < power_steps; ++step)
      {
        const Eigen::VectorXd product = matrix * v.normalized();
        value                         = product.norm();
        if (!(value > 0))
          return 0;
        v = product;
      }
    return value;
  }

  std::vector<Eigen::VectorXd> null_vectors(const Matrix &matrix, const double limit)
  {
    std::vector<Eigen::VectorXd> result;
    if (is_above(matrix, limit))
      return result;
    std::vector<int> place(matrix.cols());
    for (const auto &part : connected_parts(matrix))
      {
        Eigen::MatrixXd block = Eigen::MatrixXd::Zero(part.size(), part.size());
        for (std::size_t i = 0; i < part.size(); ++i)
          place[part[i]] = i;
        for (const int j : part)
          for (Matrix::InnerIterator entry(matrix, j); entry; ++entry)
            if (entry.value() != 0)
              block(place[entry.row()], place[j]) = entry.value();
        const SymmetricEigen eigen(block);
        for (Eigen::Index i = 0; i < eigen.values.size() && eigen.values[i] <= limit; ++i)
          {
            result.push_back(Eigen::VectorXd::Zero(matrix.cols()));
            for (std::size_t k = 0; k < part.size(); ++k)
              result.back()[part[k]] = eigen.vectors(k, i);
          }
      }
    return result;
  }
} // namespace slipstick::tfeti
