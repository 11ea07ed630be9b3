// Spatial search for boundary edges.
#pragma once

#include <slipstick/mechanics/surface.h>

#include <boost/geometry/algorithms/distance.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>

namespace slipstick::interface
{
  /// Tree of the bounding boxes of edges; numbers are positions in the list that it was made from.
  class EdgeTree
  {
  public:
    using Place = boost::geometry::model::point<double, 2, boost::geometry::cs::cartesian>;
    using Box   = boost::geometry::model::box<Place>;

    explicit EdgeTree(const std::vector<mechanics::SurfaceEdge<2>> &edges);

    /// Edges whose boxes meet @p box, ascending.
    std::vector<unsigned int> near(const Box &box) const;

    /// Calls f(edge) in order of the distance of their boxes from @p x (equal ones ascending) until it returns false or
    /// the boxes are farther away than @p radius().
    template <class Radius, class F>
    void for_each_by_distance(const dealii::Point<2> &x, const Radius &radius, const F &f) const
    {
      // the nearest few, then more of them: much faster than an incremental query
      std::pair<double, unsigned int> last(-1., 0);
      for (std::size_t n = first_batch; !tree.empty(); n *= growth_of_batch)
        {
          const auto batch = nearest(x, n);
          for (const auto &next : batch)
            {
              // others may be as far as the last one, but for rounding
              if (batch.size() < tree.size() && next.first >= (1 - same_distance) * batch.back().first)
                break;
              if (next <= last)
                continue;
              if (next.first > radius() || !f(next.second))
                return;
              last = next;
            }
          if (batch.size() == tree.size() || batch.back().first > radius())
            return;
        }
    }

    /// Smallest box around points.
    static Box box_around(const std::vector<dealii::Point<2>> &points);

    /// Smallest box around an edge (curved ones lie in that of their Bezier points).
    static Box box_around(const mechanics::SurfaceEdge<2> &edge);

  private:
    static constexpr std::size_t first_batch = 4, growth_of_batch = 4;
    static constexpr double      same_distance = 1e-12; // relative

    static double distance(const dealii::Point<2> &x, const Box &box);

    /// Distances and numbers of the n nearest edges (all, if there are no more), sorted.
    std::vector<std::pair<double, unsigned int>> nearest(const dealii::Point<2> &x, const std::size_t n) const;

    boost::geometry::index::rtree<std::pair<Box, unsigned int>, boost::geometry::index::rstar<8>> tree;
  };

  /// The whole outline of a body, holes included; curved edges count as their chords.
  class ClosedOutline
  {
  public:
    /// @param edges are not copied.
    explicit ClosedOutline(const std::vector<mechanics::SurfaceEdge<2>> &edges);

    /// Is x inside? Crossings of the ray along +x are counted.
    bool contains(const dealii::Point<2> &x) const;

    const std::vector<mechanics::SurfaceEdge<2>> &edges;
    const EdgeTree                                tree;

  private:
    double right; // end
  };
} // namespace slipstick::interface
