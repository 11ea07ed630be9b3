#include <slipstick/base/box_tree.h>

#include <algorithm>
#include <cmath>

namespace slipstick
{
  namespace
  {
    template <int dim>
    using Entry = std::pair<typename BoxTree<dim>::Box, unsigned int>;

    template <int dim>
    std::vector<Entry<dim>> entries(const std::vector<typename BoxTree<dim>::Box> &boxes)
    {
      std::vector<Entry<dim>> all;
      for (unsigned int e = 0; e < boxes.size(); ++e)
        all.emplace_back(boxes[e], e);
      return all;
    }

    template <class Place>
    Place place(const dealii::Point<2> &x)
    {
      return {x[0], x[1]};
    }
    template <class Place>
    Place place(const dealii::Point<3> &x)
    {
      return {x[0], x[1], x[2]};
    }

    template <int dim, class Place>
    dealii::Point<dim> point(const Place &at)
    {
      dealii::Point<dim> x;
      x[0] = at.template get<0>();
      x[1] = at.template get<1>();
      if constexpr (dim == 3)
        x[2] = at.template get<2>();
      return x;
    }

    template <int dim>
    double distance(const dealii::Point<dim> &x, const typename BoxTree<dim>::Box &box)
    {
      const auto             low = point<dim>(box.min_corner()), high = point<dim>(box.max_corner());
      dealii::Tensor<1, dim> apart;
      for (unsigned int d = 0; d < dim; ++d)
        apart[d] = std::max({low[d] - x[d], x[d] - high[d], 0.});
      double length = 0;
      for (unsigned int d = 0; d < dim; ++d)
        length = std::hypot(length, apart[d]);
      return length;
    }
  } // namespace

  template <int dim>
  BoxTree<dim>::BoxTree(const std::vector<Box> &boxes)
    : tree(entries<dim>(boxes))
  {}

  template <int dim>
  std::vector<unsigned int> BoxTree<dim>::near(const Box &box) const
  {
    std::vector<unsigned int> found;
    for (auto at = tree.qbegin(boost::geometry::index::intersects(box)); at != tree.qend(); ++at)
      found.push_back(at->second);
    std::sort(found.begin(), found.end());
    return found;
  }

  template <int dim>
  std::vector<std::pair<double, unsigned int>> BoxTree<dim>::nearest(const dealii::Point<dim> &x,
                                                                     const std::size_t         n) const
  {
    std::vector<Entry<dim>> found;
    tree.query(boost::geometry::index::nearest(place<Place>(x), n), std::back_inserter(found));
    std::vector<std::pair<double, unsigned int>> sorted;
    for (const auto &[box, number] : found)
      sorted.emplace_back(distance<dim>(x, box), number);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }

  template <int dim>
  typename BoxTree<dim>::Box BoxTree<dim>::box_around(const std::vector<dealii::Point<dim>> &points)
  {
    dealii::Point<dim> low = points[0], high = points[0];
    for (const auto &x : points)
      for (unsigned int d = 0; d < dim; ++d)
        {
          low[d]  = std::min(low[d], x[d]);
          high[d] = std::max(high[d], x[d]);
        }
    return {place<Place>(low), place<Place>(high)};
  }

  template <int dim>
  typename BoxTree<dim>::Box BoxTree<dim>::widened(const Box &box, const double more)
  {
    auto low = point<dim>(box.min_corner()), high = point<dim>(box.max_corner());
    for (unsigned int d = 0; d < dim; ++d)
      {
        low[d] -= more;
        high[d] += more;
      }
    return {place<Place>(low), place<Place>(high)};
  }

  template class BoxTree<2>;
  template class BoxTree<3>;
} // namespace slipstick
