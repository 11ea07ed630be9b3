#include <slipstick/tfeti/packed.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cmath>
#include <cstring>

extern "C" void dspmv_(const char   *uplo,
                       const int    *n,
                       const double *alpha,
                       const double *ap,
                       const double *x,
                       const int    *incx,
                       const double *beta,
                       double       *y,
                       const int    *incy);

extern "C" void dsyrk_(const char   *uplo,
                       const char   *trans,
                       const int    *n,
                       const int    *k,
                       const double *alpha,
                       const double *a,
                       const int    *lda,
                       const double *beta,
                       double       *c,
                       const int    *ldc);

extern "C" void dpotri_(const char *uplo, const int *n, double *a, const int *lda, int *info);

// Vector instructions of the processor at hand where the compiler can choose at run time. Not under AddressSanitizer: GCC
// 12 aligns a frame to 64 bytes on the stack, but not where AddressSanitizer puts it to detect use after return, and stores
// to it by instructions that need 64 (vmovapd of zmm registers, to an address of 32 modulo 64).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#  define SLIPSTICK_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2,fma", "default")))
#else
#  define SLIPSTICK_VECTOR_CLONES
#endif

namespace slipstick::tfeti
{
  namespace
  {
    // Columns of L that L L' takes at a time, and tiles in which a triangle is mirrored.
    constexpr int panel_width = 64;
    constexpr int tile_width  = 32;

    /// Copies the lower triangle to the upper one.
    void mirror(Eigen::MatrixXd &matrix)
    {
      const int n = matrix.cols();
      for (int column = 0; column < n; column += tile_width)
        for (int row = column; row < n; row += tile_width)
          for (int j = column; j < std::min(column + tile_width, n); ++j)
            for (int i = std::max(row, j + 1); i < std::min(row + tile_width, n); ++i)
              matrix(j, i) = matrix(i, j);
    }

    constexpr int n_lanes = 8;
    using Doubles         = double __attribute__((vector_size(n_lanes * sizeof(double))));
    using Floats          = float __attribute__((vector_size(n_lanes * sizeof(float))));

    /// y += A x, y and x in double. Two columns at a time, so that y and x are passed through half as often.
    SLIPSTICK_VECTOR_CLONES void add_product(const float *a, const int n, const double *x, double *y)
    {
      int j = 0;
      for (; j + 1 < n; j += 2)
        {
          const float *b  = a + (n - j); // column j + 1 from its diagonal; a: column j
          const double x0 = x[j], x1 = x[j + 1];
          double       s0 = a[0] * x0 + a[1] * x1, s1 = a[1] * x0 + b[0] * x1;
          Doubles      sums0 = {}, sums1 = {};
          int          i = j + 2;
          a += 2;
          b += 1;
          for (; i + n_lanes <= n; i += n_lanes, a += n_lanes, b += n_lanes)
            {
              Floats  fa, fb;
              Doubles xi, yi;
              std::memcpy(&fa, a, sizeof(fa));
              std::memcpy(&fb, b, sizeof(fb));
              std::memcpy(&xi, x + i, sizeof(xi));
              std::memcpy(&yi, y + i, sizeof(yi));
              const Doubles da = __builtin_convertvector(fa, Doubles), db = __builtin_convertvector(fb, Doubles);
              yi += da * x0 + db * x1;
              sums0 += da * xi;
              sums1 += db * xi;
              std::memcpy(y + i, &yi, sizeof(yi));
            }
          for (; i < n; ++i, ++a, ++b)
            {
              y[i] += *a * x0 + *b * x1;
              s0 += *a * x[i];
              s1 += *b * x[i];
            }
          for (int l = 0; l < n_lanes; ++l)
            {
              s0 += sums0[l];
              s1 += sums1[l];
            }
          y[j] += s0;
          y[j + 1] += s1;
          a = b;
        }
      if (j < n)
        y[j] += a[0] * x[j];
    }

    unsigned int rows_of(const std::size_t n_packed)
    {
      const auto n = static_cast<unsigned int>(std::lround((std::sqrt(8. * n_packed + 1) - 1) / 2));
      AssertThrow(static_cast<std::size_t>(n) * (n + 1) / 2 == n_packed, dealii::ExcInternalError());
      return n;
    }
  } // namespace

  std::vector<double> packed_lower(const Eigen::MatrixXd &matrix)
  {
    std::vector<double> packed;
    packed.reserve(matrix.rows() * (matrix.rows() + 1) / 2);
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      packed.insert(packed.end(), matrix.col(j).data() + j, matrix.col(j).data() + matrix.rows());
    return packed;
  }

  std::vector<double> packed_lower(const Eigen::MatrixXd &matrix, const std::vector<unsigned int> &order)
  {
    std::vector<double> packed(order.size() * (order.size() + 1) / 2);
    double             *next = packed.data();
    for (unsigned int j = 0; j < order.size(); ++j)
      {
        const double *column = matrix.col(order[j]).data();
        for (unsigned int i = j; i < order.size(); ++i)
          *next++ = column[order[i]];
      }
    return packed;
  }

  Eigen::MatrixXd unpacked(const std::vector<double> &lower)
  {
    const unsigned int n = rows_of(lower.size());
    Eigen::MatrixXd    matrix(n, n);
    const double      *next = lower.data();
    for (unsigned int j = 0; j < n; ++j)
      for (unsigned int i = j; i < n; ++i)
        matrix(i, j) = matrix(j, i) = *next++;
    return matrix;
  }

  Eigen::MatrixXd product_of_factor(const Eigen::MatrixXd &L)
  {
    const int       n       = L.rows();
    Eigen::MatrixXd product = Eigen::MatrixXd::Zero(n, n);
    const double    one     = 1;
    for (int first = 0; first < n; first += panel_width) // row i of L ends at column i: a third of the operations
      {
        const int rows = n - first, width = std::min(panel_width, rows);
        dsyrk_("L", "N", &rows, &width, &one, &L(first, first), &n, &one, &product(first, first), &n);
      }
    mirror(product);
    return product;
  }

  Eigen::MatrixXd inverse_of_product(Eigen::MatrixXd L)
  {
    const int n    = L.rows();
    int       info = 0;
    if (n > 0)
      dpotri_("L", &n, L.data(), &n, &info);
    AssertThrow(info == 0, dealii::ExcMessage("dpotri failed"));
    mirror(L);
    return L;
  }

  PackedSymmetric::PackedSymmetric(std::vector<double> lower, const Precision precision)
  {
    if (precision == Precision::double_precision)
      in_double = std::move(lower);
    else
      in_single.assign(lower.begin(), lower.end());
  }

  void PackedSymmetric::multiply(const Eigen::VectorXd &x, Eigen::VectorXd &y) const
  {
    const int    n = x.size(), one = 1;
    const double alpha = 1, beta = 0;
    AssertDimension(in_double.size() + in_single.size(), static_cast<std::size_t>(n) * (n + 1) / 2);
    y.resize(n);
    if (!in_double.empty())
      dspmv_("L", &n, &alpha, in_double.data(), x.data(), &one, &beta, y.data(), &one);
    else
      {
        y.setZero();
        add_product(in_single.data(), n, x.data(), y.data());
      }
  }
} // namespace slipstick::tfeti
