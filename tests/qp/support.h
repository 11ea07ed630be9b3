// Dense problems, known answers and checks for the tests of the qp layer.
#pragma once

#include <slipstick/qp/box.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/types.h>

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <vector>

namespace slipstick::qp::test
{
  using Vector = std::vector<double>;

  constexpr Expansion all_expansions[] = {Expansion::gradient_projection,
                                          Expansion::boundary_then_projection,
                                          Expansion::projected_cg};

  inline double inner(const Vector &x, const Vector &y)
  {
    return local_dot(x, y);
  }
  inline double length(const Vector &x)
  {
    return std::sqrt(inner(x, x));
  }

  inline Vector minus(Vector x, const Vector &y)
  {
    add(-1.0, y, x);
    return x;
  }

  inline double distance(const Vector &x, const Vector &y)
  {
    return length(minus(x, y));
  }

  /// Dense matrix, by rows.
  struct Matrix
  {
    Matrix(const std::size_t m_, const std::size_t n_)
      : m(m_)
      , n(n_)
      , entries(m_ * n_, 0.0)
    {}

    double &operator()(const std::size_t i, const std::size_t j)
    {
      return entries[i * n + j];
    }
    double operator()(const std::size_t i, const std::size_t j) const
    {
      return entries[i * n + j];
    }

    Vector operator*(const Vector &x) const
    {
      Vector y(m, 0.0);
      for (std::size_t i = 0; i < m; ++i)
        for (std::size_t j = 0; j < n; ++j)
          y[i] += (*this)(i, j) * x[j];
      return y;
    }

    std::size_t m, n;
    Vector      entries;
  };

  inline Matrix diagonal(const Vector &d)
  {
    Matrix A(d.size(), d.size());
    for (std::size_t i = 0; i < d.size(); ++i)
      A(i, i) = d[i];
    return A;
  }

  /// Solution of A x = b, nothing if A is singular up to rounding.
  inline std::optional<Vector> solve(Matrix A, Vector b)
  {
    const std::size_t n = A.n;
    for (std::size_t k = 0; k < n; ++k)
      {
        std::size_t pivot = k;
        for (std::size_t i = k; i < n; ++i)
          if (std::abs(A(i, k)) > std::abs(A(pivot, k)))
            pivot = i;
        if (std::abs(A(pivot, k)) < 1e-11)
          return {};
        for (std::size_t j = 0; j < n; ++j)
          std::swap(A(k, j), A(pivot, j));
        std::swap(b[k], b[pivot]);
        for (std::size_t i = k + 1; i < n; ++i)
          {
            const double factor = A(i, k) / A(k, k);
            for (std::size_t j = k; j < n; ++j)
              A(i, j) -= factor * A(k, j);
            b[i] -= factor * b[k];
          }
      }
    for (std::size_t k = n; k-- > 0;)
      {
        for (std::size_t j = k + 1; j < n; ++j)
          b[k] -= A(k, j) * b[j];
        b[k] /= A(k, k);
      }
    return b;
  }

  /// The Problem concept on dense F and G with orthonormal rows; counts its calls.
  struct DenseProblem
  {
    explicit DenseProblem(const Matrix &F_, const Matrix &G_ = Matrix(0, 0))
      : F(F_)
      , G(G_)
    {}

    void multiply(const Vector &x, Vector &y) const
    {
      ++n_multiplications;
      y = F * x;
    }

    void project_range(const Vector &x, Vector &y) const
    {
      ++n_projections;
      Vector z(x.size(), 0.0);
      for (std::size_t k = 0; k < G.m; ++k)
        {
          double s = 0;
          for (std::size_t j = 0; j < G.n; ++j)
            s += G(k, j) * x[j];
          for (std::size_t j = 0; j < G.n; ++j)
            z[j] += s * G(k, j);
        }
      y = z;
    }

    const SerialReduction &reduction() const
    {
      return serial;
    }

    Vector range(const Vector &x) const
    {
      Vector y(x);
      project_range(x, y);
      return y;
    }

    Vector kernel(const Vector &x) const
    {
      return minus(x, range(x));
    }

    Matrix               F, G;
    SerialReduction      serial;
    mutable unsigned int n_multiplications = 0, n_projections = 0;
  };

  /// The rows of G, orthonormalized by Gram-Schmidt.
  inline Matrix orthonormalized(Matrix G)
  {
    for (std::size_t k = 0; k < G.m; ++k)
      {
        for (int twice = 0; twice < 2; ++twice)
          for (std::size_t i = 0; i < k; ++i)
            {
              double s = 0;
              for (std::size_t j = 0; j < G.n; ++j)
                s += G(i, j) * G(k, j);
              for (std::size_t j = 0; j < G.n; ++j)
                G(k, j) -= s * G(i, j);
            }
        double square = 0;
        for (std::size_t j = 0; j < G.n; ++j)
          square += G(k, j) * G(k, j);
        for (std::size_t j = 0; j < G.n; ++j)
          G(k, j) /= std::sqrt(square);
      }
    return G;
  }

  class Random
  {
  public:
    explicit Random(const unsigned int seed)
      : engine(seed)
    {}

    double uniform(const double a, const double b)
    {
      return std::uniform_real_distribution<double>(a, b)(engine);
    }

    Vector vector(const std::size_t n, const double size = 1.0)
    {
      Vector x(n);
      for (double &xi : x)
        xi = uniform(-size, size);
      return x;
    }

    /// B'B + shift I with B: rank x n
    Matrix semidefinite(const std::size_t n, const std::size_t rank, const double shift)
    {
      Matrix B(rank, n), A(n, n);
      B.entries = vector(rank * n);
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          {
            A(i, j) = i == j ? shift : 0.0;
            for (std::size_t k = 0; k < rank; ++k)
              A(i, j) += B(k, i) * B(k, j);
          }
      return A;
    }

    /// m x n with orthonormal rows
    Matrix orthonormal(const std::size_t m, const std::size_t n)
    {
      Matrix G(m, n);
      G.entries = vector(m * n);
      return orthonormalized(std::move(G));
    }

    /// Two-sided bounds, on request around 0.
    Box<Vector> box(const std::size_t n, const bool around_zero, const double size = 1.0)
    {
      Box<Vector> box{Vector(n), Vector(n)};
      for (std::size_t i = 0; i < n; ++i)
        {
          const double a = around_zero ? uniform(-size, 0) : uniform(-size, size);
          const double b = around_zero ? uniform(0, size) : uniform(-size, size);
          box.lower[i]   = std::min(a, b);
          box.upper[i]   = std::max(a, b);
        }
      return box;
    }

    std::mt19937 engine;
  };

  /// |A| of a symmetric positive semidefinite matrix, by many power iterations.
  inline double spectral_norm(const Matrix &A)
  {
    Random random(1);
    Vector x    = random.vector(A.n);
    double norm = 0;
    for (int k = 0; k < 2000; ++k)
      {
        const double size = length(x);
        for (double &xi : x)
          xi /= size;
        x    = A * x;
        norm = length(x);
      }
    return norm;
  }

  inline Vector gradient(const Matrix &A, const Vector &x, const Vector &b)
  {
    return minus(A * x, b);
  }

  /// |gP|
  inline double projected_gradient_norm(const Box<Vector> &box, const Vector &x, const Vector &g)
  {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      {
        const double gp = projected_gradient(x[i], g[i], box.lower[i], box.upper[i]);
        sum += gp * gp;
      }
    return std::sqrt(sum);
  }

  /// |gP|, from a recomputed gradient.
  inline double kkt_residual(const Matrix &A, const Vector &x, const Vector &b, const Box<Vector> &box)
  {
    return projected_gradient_norm(box, x, gradient(A, x, b));
  }

  inline bool is_within(const Box<Vector> &box, const Vector &x)
  {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!(box.lower[i] <= x[i] && x[i] <= box.upper[i]))
        return false;
    return true;
  }

  /// The solution of min 1/2 x'Fx - x'b, Gx = e, x in the box, by trying all 3^n active sets; nothing if none fits.
  std::optional<Vector> enumerate(const Matrix      &F,
                                  const Vector      &b,
                                  const Matrix      &G,
                                  const Vector      &e,
                                  const Box<Vector> &box,
                                  double             tolerance = 1e-9);
} // namespace slipstick::qp::test
