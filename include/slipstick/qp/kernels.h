// Vector kernels: local loops over the owned entries; each function with a Reduction does one global reduction.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace slipstick::qp
{
  /// Number of entries owned by this process.
  template <typename Vector>
  std::size_t local_size(const Vector &x)
  {
    return static_cast<std::size_t>(x.end() - x.begin());
  }

  template <typename Vector>
  void set_zero(Vector &x)
  {
    std::fill(x.begin(), x.end(), 0.0);
  }

  template <typename Vector>
  Vector zero_like(const Vector &x)
  {
    Vector y(x);
    set_zero(y);
    return y;
  }

  /// y = a x + b y
  template <typename Vector>
  void combine(const double a, const Vector &x, const double b, Vector &y)
  {
    const auto        xi = x.begin();
    const auto        yi = y.begin();
    const std::size_t n  = local_size(y);
    for (std::size_t i = 0; i < n; ++i)
      yi[i] = a * xi[i] + b * yi[i];
  }

  /// y += a x
  template <typename Vector>
  void add(const double a, const Vector &x, Vector &y)
  {
    combine(a, x, 1.0, y);
  }

  /// x'y of the owned entries, to be summed over the processes.
  template <typename Vector>
  double local_dot(const Vector &x, const Vector &y)
  {
    const auto        xi  = x.begin();
    const auto        yi  = y.begin();
    const std::size_t n   = local_size(x);
    double            sum = 0;
    for (std::size_t i = 0; i < n; ++i)
      sum += xi[i] * yi[i];
    return sum;
  }

  /// Weights of the entries of a residual in its norm, for the owned entries: `residual_weights()` of the problem;
  /// null, all 1, if the problem has none or they are empty.
  template <typename Problem>
  auto residual_weights(const Problem &problem, int) -> decltype(problem.residual_weights(), (const double *)nullptr)
  {
    return problem.residual_weights().empty() ? nullptr : problem.residual_weights().data();
  }
  template <typename Problem>
  const double *residual_weights(const Problem &, long)
  {
    return nullptr;
  }

  /// (w x)'(w y) of the owned entries.
  template <typename Vector>
  double local_weighted_dot(const double *w, const Vector &x, const Vector &y)
  {
    if (!w)
      return local_dot(x, y);
    const auto        xi  = x.begin();
    const auto        yi  = y.begin();
    const std::size_t n   = local_size(x);
    double            sum = 0;
    for (std::size_t i = 0; i < n; ++i)
      sum += w[i] * w[i] * xi[i] * yi[i];
    return sum;
  }

  /// Compliances D of the entries that F does not determine, for the owned entries: `dependent_compliances()` of the
  /// problem. They are close to the diagonal of F, and 0 for entries that F determines. Null if the problem has none on
  /// any process.
  template <typename Problem>
  auto dependent_compliances(const Problem &problem, int)
    -> decltype(problem.dependent_compliances(), (const std::vector<double> *)nullptr)
  {
    return problem.dependent_compliances();
  }
  template <typename Problem>
  const std::vector<double> *dependent_compliances(const Problem &, long)
  {
    return nullptr;
  }

  /// y += factor D x
  template <typename Vector>
  void add_diagonal(const double factor, const std::vector<double> &D, const Vector &x, Vector &y)
  {
    const auto xi = x.begin();
    const auto yi = y.begin();
    for (std::size_t i = 0; i < D.size(); ++i)
      yi[i] += factor * D[i] * xi[i];
  }

  /// This process' part of x'D y.
  template <typename Vector>
  double local_diagonal_dot(const std::vector<double> &D, const Vector &x, const Vector &y)
  {
    const auto xi  = x.begin();
    const auto yi  = y.begin();
    double     sum = 0;
    for (std::size_t i = 0; i < D.size(); ++i)
      sum += D[i] * xi[i] * yi[i];
    return sum;
  }

  /// p := the nearest point with G p = 0, by `project_kernel(p)` if the problem has it, otherwise p - Q p. w: work
  /// vector.
  template <typename Problem, typename Vector>
  auto project_kernel(const Problem &problem, Vector &p, Vector &, int) -> decltype(problem.project_kernel(p))
  {
    problem.project_kernel(p);
  }
  template <typename Problem, typename Vector>
  void project_kernel(const Problem &problem, Vector &p, Vector &w, long)
  {
    problem.project_range(p, w);
    add(-1.0, w, p);
  }

  template <typename Vector, typename Reduction>
  double dot(const Vector &x, const Vector &y, const Reduction &reduction)
  {
    return reduction.sum(std::array<double, 1>{{local_dot(x, y)}})[0];
  }

  template <typename Vector, typename Reduction>
  double norm(const Vector &x, const Reduction &reduction)
  {
    return std::sqrt(dot(x, x, reduction));
  }

  /// Sums any number of values over all processes, `batch` per reduction.
  template <typename Reduction>
  void sum_all(std::vector<double> &values, const Reduction &reduction)
  {
    constexpr std::size_t batch = 32; // compromise between latency and message length
    for (std::size_t first = 0; first < values.size(); first += batch)
      {
        const std::size_t         n = std::min(batch, values.size() - first);
        std::array<double, batch> part{};
        std::copy_n(values.begin() + first, n, part.begin());
        part = reduction.sum(part);
        std::copy_n(part.begin(), n, values.begin() + first);
      }
  }
} // namespace slipstick::qp
