// Bounds of tangential entries that follow normal ones; in space, discs for pairs of tangential entries.
#pragma once

#include <slipstick/qp/node_set.h>

#include <limits>
#include <vector>

namespace slipstick::qp
{
  constexpr std::size_t no_entry = std::numeric_limits<std::size_t>::max();

  /// The entries of a vector that are the tangential and the normal force of a node, and their admissible values. All
  /// are owned by the same process. In space there are two tangential entries, along orthogonal directions, and their
  /// residuals have equal weights, so that the nearest point of the disc is the same with and without weights.
  struct PressureBound
  {
    std::size_t tangential;
    std::size_t normal; // no_entry: none, the radius is that at zero normal force (discs only)
    NodeSet     forces;
    std::size_t second = no_entry; // the other tangential entry

    bool is_disc() const
    {
      return second != no_entry;
    }
  };

  /// An entry at a bound that follows a free entry: in a face problem its increments are factor times those of `to`.
  struct Tie
  {
    std::size_t tied;
    std::size_t to;
    double      factor;
  };

  /// A slipping node in space: in a face problem its tangential entries are turned; x_r = c x_1 + s x_2 along the force
  /// replaces the first, x_s = c x_2 - s x_1 across it replaces the second. x_r is at its bound. x_s is free with a
  /// compliance: the force turns on its circle by x_s over the radius, which acts as a gradient of compliance times x_s
  /// (Newton's method on the circle; compliance = -(gradient along the force) over the radius).
  struct Turn
  {
    std::size_t first;
    std::size_t second;
    double      cosine     = 1;
    double      sine       = 0;
    double      compliance = 0; // >= 0

    /// Factor of the residual of x_s, about the force that it changes over that without the compliance.
    /// @param weight of the residual of the entry (for |F| = 1)
    double softness(const double weight) const
    {
      return 1 / (1 + compliance * weight);
    }
  };

  /// Turns the entries of x.
  template <typename Vector>
  void turn(const std::vector<Turn> &turns, Vector &x)
  {
    for (const Turn &of : turns)
      {
        double      &x1 = x.begin()[of.first], &x2 = x.begin()[of.second];
        const double along = of.cosine * x1 + of.sine * x2;
        x2                 = of.cosine * x2 - of.sine * x1;
        x1                 = along;
      }
  }

  /// The inverse of turn().
  template <typename Vector>
  void turn_back(const std::vector<Turn> &turns, Vector &x)
  {
    for (const Turn &of : turns)
      {
        double      &x1 = x.begin()[of.first], &x2 = x.begin()[of.second];
        const double first = of.cosine * x1 - of.sine * x2;
        x2                 = of.sine * x1 + of.cosine * x2;
        x1                 = first;
      }
  }

  /// y += C x, C the compliances of the turned entries; x and y are not turned.
  template <typename Vector>
  void add_compliance(const std::vector<Turn> &turns, const Vector &x, Vector &y)
  {
    for (const Turn &of : turns)
      {
        const double gradient = of.compliance * (of.cosine * x.begin()[of.second] - of.sine * x.begin()[of.first]);
        y.begin()[of.first] -= of.sine * gradient;
        y.begin()[of.second] += of.cosine * gradient;
      }
  }
} // namespace slipstick::qp
