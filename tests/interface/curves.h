// Hand-made curves as outlines of bodies.
#pragma once

#include <slipstick/interface/mortar.h>

#include <functional>

namespace slipstick::test
{
  using Edge = mechanics::SurfaceEdge<2>;

  /// n edges along s -> point(s), s in [0, 1], with nodes at f(k / n); the body lies to the left. Node keys start at
  /// @p first.
  inline std::vector<Edge> curve(const std::function<dealii::Point<2>(double)> &point,
                                 const unsigned int                             n,
                                 const unsigned int                             degree,
                                 const std::uint64_t                            first)
  {
    std::vector<Edge> edges;
    for (unsigned int k = 0; k < n; ++k)
      {
        Edge edge;
        edge.n_nodes = degree + 1;
        for (unsigned int i = 0; i < edge.n_nodes; ++i)
          {
            const std::uint64_t a = first + k, b = a + 1;
            const auto          x = point((k + Edge::node_coordinate(i)) / n);
            edge.keys[i]          = i == 0   ? mechanics::NodeKey{{a, a}}
                                    : i == 1 ? mechanics::NodeKey{{b, b}}
                                             : mechanics::NodeKey{{a, b}};
            edge.at[i]            = {{x[0], x[1]}};
          }
        edges.push_back(edge);
      }
    return edges;
  }

  inline std::vector<Edge> line(const dealii::Point<2> &from,
                                const dealii::Point<2> &to,
                                const unsigned int      n,
                                const unsigned int      degree,
                                const std::uint64_t     first)
  {
    return curve([=](const double s) { return from + s * (to - from); }, n, degree, first);
  }

  /// Circle arc from angle a to b (degrees); counterclockwise has the body inside.
  inline std::vector<Edge> arc(const double        radius,
                               const double        a,
                               const double        b,
                               const unsigned int  n,
                               const unsigned int  degree,
                               const std::uint64_t first)
  {
    return curve(
      [=](const double s) {
        const double angle = (a + s * (b - a)) * M_PI / 180;
        return dealii::Point<2>(radius * std::cos(angle), radius * std::sin(angle));
      },
      n,
      degree,
      first);
  }
} // namespace slipstick::test
