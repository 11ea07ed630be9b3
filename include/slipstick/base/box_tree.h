// Spatial search among boxes.
#pragma once

#include <deal.II/base/point.h>

#include <boost/geometry/algorithms/distance.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>

#include <vector>

namespace slipstick
{
  /// Tree of bounding boxes; numbers are positions in the list from which it was constructed.
  template <int dim>
  class BoxTree
  {
  public:
    using Place = boost::geometry::model::point<double, dim, boost::geometry::cs::cartesian>;
    using Box   = boost::geometry::model::box<Place>;

    explicit BoxTree(const std::vector<Box> &boxes);

    /// Boxes that intersect @p box, ascending.
    std::vector<unsigned int> near(const Box &box) const;

    /// Calls f(number) in order of the distance of the boxes from @p x (equal ones ascending) until it returns false or
    /// the boxes are farther away than @p radius().
    template <class Radius, class F>
    void for_each_by_distance(const dealii::Point<dim> &x, const Radius &radius, const F &f) const
    {
      // query the nearest few, then more: much faster than an incremental query
      std::pair<double, unsigned int> last(-1., 0);
      for (std::size_t n = first_batch; !tree.empty(); n *= growth_of_batch)
        {
          const auto batch = nearest(x, n);
          for (const auto &next : batch)
            {
              // further boxes may be at the same distance up to rounding
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

    /// Bounding box of points.
    static Box box_around(const std::vector<dealii::Point<dim>> &points);

    /// @p box enlarged by @p more on all sides.
    static Box widened(const Box &box, const double more);

  private:
    static constexpr std::size_t first_batch = 4, growth_of_batch = 4;
    static constexpr double      same_distance = 1e-12; // relative

    /// Distances and numbers of the n nearest boxes (all, if there are no more), sorted.
    std::vector<std::pair<double, unsigned int>> nearest(const dealii::Point<dim> &x, const std::size_t n) const;

    boost::geometry::index::rtree<std::pair<Box, unsigned int>, boost::geometry::index::rstar<8>> tree;
  };
} // namespace slipstick
