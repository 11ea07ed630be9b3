// Bounds of tangential entries that follow normal ones.
#pragma once

#include <slipstick/qp/node_set.h>

namespace slipstick::qp
{
  /// The entries of a vector that are the tangential and the normal force of a node, and what they may be. Both are owned by
  /// the same process.
  struct PressureBound
  {
    std::size_t tangential;
    std::size_t normal;
    NodeSet     forces;
  };

  /// An entry that a face holds at a bound which moves with a free one: its increments are factor times those of `to`.
  struct Tie
  {
    std::size_t tied;
    std::size_t to;
    double      factor;
  };
} // namespace slipstick::qp
