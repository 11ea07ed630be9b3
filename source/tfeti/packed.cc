#include <slipstick/tfeti/packed.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cstring>

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

extern "C" void dtrmm_(const char   *side,
                       const char   *uplo,
                       const char   *trans,
                       const char   *diag,
                       const int    *m,
                       const int    *n,
                       const double *alpha,
                       const double *a,
                       const int    *lda,
                       double       *b,
                       const int    *ldb);

extern "C" void dtrtri_(const char *uplo, const char *diag, const int *n, double *a, const int *lda, int *info);

extern "C" void dlauum_(const char *uplo, const int *n, double *a, const int *lda, int *info);

// Function clones for the vector instructions of the processor, selected at run time where the compiler can. Not under
// AddressSanitizer: GCC 12 aligns stack frames to 64 bytes, but not those that AddressSanitizer allocates to detect use
// after return, and still stores to them with instructions that need 64-byte alignment (vmovapd of zmm registers, to an
// address of 32 modulo 64).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#  define SLIPSTICK_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2,fma", "default")))
#else
#  define SLIPSTICK_VECTOR_CLONES
#endif

// Functions called by a clone are compiled for its processor only if they are inlined.
#define SLIPSTICK_INLINE __attribute__((always_inline)) inline

namespace slipstick::tfeti
{
  namespace
  {
    // Number of columns of L per step of L L', and tile size for mirroring a triangle.
    constexpr int panel_width = 64;
    constexpr int tile_width  = 32;
    // Triangles up to this size are inverted by LAPACK.
    constexpr int small_triangle = 16;

    /// Inverts the lower triangle of n columns at L in place, recursively by halves: (A 0; B C)^-1 = (A^-1 0; -C^-1 B
    /// A^-1 C^-1). Nearly all operations are matrix products: 3.4 times as fast as dtrtri of OpenBLAS 0.3.21 for 200
    /// and for 400 columns.
    void invert_lower(double *L, const int n, const int stride)
    {
      if (n <= small_triangle)
        {
          int info = 0;
          dtrtri_("L", "N", &n, L, &stride, &info);
          AssertThrow(info == 0, dealii::ExcMessage("dtrtri failed"));
          return;
        }
      const int    n_A = n / 2, n_C = n - n_A;
      double      *B = L + n_A, *C = B + static_cast<std::ptrdiff_t>(n_A) * stride;
      const double one = 1, minus_one = -1;
      invert_lower(L, n_A, stride);
      invert_lower(C, n_C, stride);
      dtrmm_("R", "L", "N", "N", &n_C, &n_A, &one, L, &stride, B, &stride);
      dtrmm_("L", "L", "N", "N", &n_C, &n_A, &minus_one, C, &stride, B, &stride);
    }

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

    constexpr unsigned int n_lanes   = 8; // rows of a panel stored together
    constexpr unsigned int n_columns = 4; // columns of a panel
    using Doubles                    = double __attribute__((vector_size(n_lanes * sizeof(double))));
    using Floats                     = float __attribute__((vector_size(n_lanes * sizeof(float))));

    unsigned int padded(const unsigned int n)
    {
      return (n + n_lanes - 1) / n_lanes * n_lanes;
    }

    /// First stored row of the panel that starts with this column.
    unsigned int first_row(const unsigned int column)
    {
      return column / n_lanes * n_lanes;
    }

    /// Calls f(row, column, position) for all entries on and below the diagonal.
    template <class F>
    void for_each_entry(const unsigned int n, const F &f)
    {
      std::size_t begin = 0;
      for (unsigned int panel = 0; panel < n; panel += n_columns)
        {
          const unsigned int first = first_row(panel);
          for (unsigned int column = panel; column < std::min(panel + n_columns, n); ++column)
            for (unsigned int row = column; row < n; ++row)
              f(row,
                column,
                begin + (row - first) / n_lanes * n_lanes * n_columns + (column - panel) * n_lanes + row % n_lanes);
          begin += static_cast<std::size_t>(padded(n) - first) * n_columns;
        }
    }

    std::size_t n_stored(const unsigned int n)
    {
      std::size_t sum = 0;
      for (unsigned int panel = 0; panel < n; panel += n_columns)
        sum += static_cast<std::size_t>(padded(n) - first_row(panel)) * n_columns;
      return sum;
    }

    SLIPSTICK_INLINE Doubles load(const double *a)
    {
      Doubles values;
      std::memcpy(&values, a, sizeof(values));
      return values;
    }

    SLIPSTICK_INLINE Doubles load(const float *a)
    {
      Floats values;
      std::memcpy(&values, a, sizeof(values));
      return __builtin_convertvector(values, Doubles);
    }

    SLIPSTICK_INLINE double sum(const Doubles &values)
    {
      double result = 0;
      for (unsigned int l = 0; l < n_lanes; ++l)
        result += values[l];
      return result;
    }

    /// y += A x; x and y padded to m entries. The diagonal is stored halved, since each entry is added once by column
    /// and once by row.
    template <class Number>
    SLIPSTICK_INLINE void add_product_of(const Number *a, const unsigned int n, const double *x, double *y)
    {
      const unsigned int m = padded(n);
      for (unsigned int panel = 0; panel < n; panel += n_columns)
        {
          const double x0 = x[panel], x1 = x[panel + 1], x2 = x[panel + 2], x3 = x[panel + 3];
          Doubles      sum0 = {}, sum1 = {}, sum2 = {}, sum3 = {};
          for (unsigned int i = first_row(panel); i < m; i += n_lanes, a += n_lanes * n_columns)
            {
              const Doubles a0 = load(a), a1 = load(a + n_lanes), a2 = load(a + 2 * n_lanes),
                            a3 = load(a + 3 * n_lanes);
              const Doubles xi = load(x + i);
              const Doubles yi = load(y + i) + ((a0 * x0 + a1 * x1) + (a2 * x2 + a3 * x3));
              std::memcpy(y + i, &yi, sizeof(yi));
              sum0 += a0 * xi;
              sum1 += a1 * xi;
              sum2 += a2 * xi;
              sum3 += a3 * xi;
            }
          y[panel] += sum(sum0);
          y[panel + 1] += sum(sum1);
          y[panel + 2] += sum(sum2);
          y[panel + 3] += sum(sum3);
        }
    }

    SLIPSTICK_VECTOR_CLONES void add_product(const double *a, const unsigned int n, const double *x, double *y)
    {
      add_product_of(a, n, x, y);
    }

    SLIPSTICK_VECTOR_CLONES void add_product(const float *a, const unsigned int n, const double *x, double *y)
    {
      add_product_of(a, n, x, y);
    }
  } // namespace

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
    invert_lower(L.data(), n, n);
    if (n > 0)
      dlauum_("L", &n, L.data(), &n, &info);
    AssertThrow(info == 0, dealii::ExcMessage("dlauum failed"));
    mirror(L);
    return L;
  }

  PackedSymmetric::PackedSymmetric(const Eigen::MatrixXd           &matrix,
                                   const std::vector<unsigned int> &order,
                                   const Precision                  precision)
    : n(order.size())
  {
    const auto fill = [&](auto &stored) {
      stored.resize(n_stored(n)); // initialised to zero
      for_each_entry(n, [&](const unsigned int row, const unsigned int column, const std::size_t position) {
        stored[position] = matrix(order[row], order[column]) * (row == column ? 0.5 : 1.);
      });
    };
    if (precision == Precision::double_precision)
      fill(in_double);
    else
      fill(in_single);
  }

  void PackedSymmetric::multiply(const Eigen::VectorXd &x, Eigen::VectorXd &y) const
  {
    AssertDimension(x.size(), n);
    const unsigned int            m = padded(n);
    dealii::AlignedVector<double> both(2 * m); // x and y, zeros beyond n
    std::copy_n(x.data(), n, both.data());
    if (!in_double.empty())
      add_product(in_double.data(), n, both.data(), both.data() + m);
    else
      add_product(in_single.data(), n, both.data(), both.data() + m);
    y = Eigen::Map<const Eigen::VectorXd>(both.data() + m, n);
  }

  Eigen::MatrixXd PackedSymmetric::full() const
  {
    Eigen::MatrixXd matrix(n, n);
    for_each_entry(n, [&](const unsigned int row, const unsigned int column, const std::size_t position) {
      const double stored = in_double.empty() ? in_single[position] : in_double[position];
      matrix(row, column) = matrix(column, row) = stored * (row == column ? 2. : 1.);
    });
    return matrix;
  }
} // namespace slipstick::tfeti
