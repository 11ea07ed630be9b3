#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/triangulated_surface.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace slipstick::scene
{
  namespace
  {
    using Point    = dealii::Point<3>;
    using Tensor   = dealii::Tensor<1, 3>;
    using Triangle = TriangulatedSurface::Triangle;

    // Points nearer than this fraction of the extent count as on the surface, at an edge or at a vertex: the direction
    // to the foot and the choice of the nearest triangle are then dominated by rounding.
    constexpr double on_surface = 1e-10;

    Tensor unit_or_zero(const Tensor &v)
    {
      const double length = v.norm();
      return length > 0 ? v / length : Tensor();
    }

    /// Merges equal corners into vertices. @return the triangles with three different vertices.
    std::vector<Triangle> merge(const std::vector<Point> &corners, std::vector<Point> &vertices)
    {
      std::vector<unsigned int> order(corners.size()), number(corners.size());
      for (unsigned int k = 0; k < order.size(); ++k)
        order[k] = k;
      const auto key = [&](const unsigned int k) { return std::tie(corners[k][0], corners[k][1], corners[k][2]); };
      std::sort(order.begin(), order.end(), [&](const auto a, const auto b) { return key(a) < key(b); });
      for (unsigned int k = 0; k < order.size(); ++k)
        {
          if (k == 0 || key(order[k - 1]) != key(order[k]))
            vertices.push_back(corners[order[k]]);
          number[order[k]] = vertices.size() - 1;
        }
      std::vector<Triangle> triangles;
      for (unsigned int k = 0; k + 2 < corners.size(); k += 3)
        if (const Triangle t = {{number[k], number[k + 1], number[k + 2]}};
            t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
          triangles.push_back(t);
      return triangles;
    }

    BoxTree<3> tree_of(const std::vector<Triangle> &triangles, const std::vector<Point> &vertices)
    {
      std::vector<BoxTree<3>::Box> boxes;
      for (const Triangle &t : triangles)
        boxes.push_back(BoxTree<3>::box_around({vertices[t[0]], vertices[t[1]], vertices[t[2]]}));
      return BoxTree<3>(boxes);
    }

    /// An edge of a triangle, from its vertex k to the next.
    struct Side
    {
      unsigned int low, high; // vertices
      unsigned int triangle, k;
      bool         rises; // from low to high
    };
  } // namespace

  /// The nearest point of a triangle.
  struct TriangulatedSurface::Foot
  {
    double squared = std::numeric_limits<double>::max(); // distance
    Point  at;
    Tensor normal; // at the foot: of the triangle, the two at an edge, or all at a vertex

    unsigned int triangle = 0;
  };

  TriangulatedSurface::TriangulatedSurface(const std::string &name, const std::vector<Point> &corners)
    : triangles(merge(corners, vertices))
    , tree(tree_of(triangles, vertices))
  {
    if (triangles.size() < 4)
      throw InputError(name + " has " + std::to_string(triangles.size()) +
                         " triangles with three different corners, a closed surface has at least 4",
                       "export the surface of the whole obstacle");
    const auto box = BoxTree<3>::box_around(vertices);
    size           = Point(box.min_corner().get<0>(), box.min_corner().get<1>(), box.min_corner().get<2>())
             .distance(Point(box.max_corner().get<0>(), box.max_corner().get<1>(), box.max_corner().get<2>()));
    check_closed(name);
    find_normals();
  }

  void TriangulatedSurface::check_closed(const std::string &name)
  {
    std::vector<Side> sides;
    for (unsigned int t = 0; t < triangles.size(); ++t)
      for (unsigned int k = 0; k < 3; ++k)
        {
          const unsigned int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
          sides.push_back({std::min(a, b), std::max(a, b), t, k, a < b});
        }
    const auto key = [](const Side &side) { return std::tie(side.low, side.high); };
    std::sort(sides.begin(), sides.end(), [&](const Side &a, const Side &b) {
      return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    neighbours.resize(triangles.size());
    const Side  *wrong      = nullptr; // the first
    std::size_t  n_wrong    = 0;
    unsigned int n_of_wrong = 0;
    for (std::size_t first = 0, last; first < sides.size(); first = last)
      {
        for (last = first + 1; last < sides.size() && key(sides[last]) == key(sides[first]);)
          ++last;
        const auto &a = sides[first];
        if (last - first == 2 && sides[first + 1].rises != a.rises)
          {
            const auto &b               = sides[first + 1];
            neighbours[a.triangle][a.k] = b.triangle;
            neighbours[b.triangle][b.k] = a.triangle;
            continue;
          }
        if (n_wrong++ == 0)
          {
            wrong      = &a;
            n_of_wrong = last - first;
          }
      }
    if (n_wrong == 0)
      return;
    const std::string where =
      "the edge from " + point_text(vertices[wrong->low], 3) + " to " + point_text(vertices[wrong->high], 3);
    const std::string more = n_wrong > 1 ? ", and " + std::to_string(n_wrong - 1) + " other edges are wrong, too" : "";
    if (n_of_wrong == 2)
      throw InputError(name + " is not oriented: the two triangles at " + where + " have opposite orientations" + more,
                       "make the normals consistent in the program that exported it");
    throw InputError(name + " is not closed: " + where + " belongs to " + std::to_string(n_of_wrong) +
                       (n_of_wrong == 1 ? " triangle" : " triangles") + ", not to two" + more,
                     "close its holes, merge its vertices and remove inner walls in the program that exported it, or "
                     "export it again with more digits");
  }

  void TriangulatedSurface::find_normals()
  {
    normals_of_vertices.resize(vertices.size());
    for (unsigned int t = 0; t < triangles.size(); ++t)
      {
        const Point  a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
        const Tensor n = unit_or_zero(cross_product_3d(b - a, c - a));
        normals_of_triangles.push_back(n);
        for (unsigned int k = 0; k < 3; ++k)
          {
            const Tensor u = corner(t, (k + 1) % 3) - corner(t, k), v = corner(t, (k + 2) % 3) - corner(t, k);
            normals_of_vertices[triangles[t][k]] += std::atan2(cross_product_3d(u, v).norm(), u * v) * n;
          }
      }
    for (Tensor &n : normals_of_vertices)
      n = unit_or_zero(n);
  }

  Point TriangulatedSurface::corner(const unsigned int triangle, const unsigned int k) const
  {
    return vertices[triangles[triangle][k]];
  }

  TriangulatedSurface::Foot TriangulatedSurface::foot_on(const unsigned int t, const Point &x) const
  {
    const Tensor &n = normals_of_triangles[t];
    Foot          foot;
    bool          is_above = n.norm() > 0; // x projects into the interior of the triangle
    for (unsigned int k = 0; k < 3; ++k)
      {
        const Point  a     = corner(t, k);
        const Tensor along = corner(t, (k + 1) % 3) - a;
        is_above           = is_above && cross_product_3d(n, along) * (x - a) > 0;
        const double s     = std::min(1., std::max(0., (x - a) * along / along.norm_square()));
        const Point  at    = a + s * along;
        if (const double squared = (x - at).norm_square(); squared < foot.squared)
          {
            foot = {squared, at, {}, t};
            if (s == 0 || s == 1)
              foot.normal = normals_of_vertices[triangles[t][s == 0 ? k : (k + 1) % 3]];
            else
              foot.normal = n + normals_of_triangles[neighbours[t][k]];
          }
      }
    if (is_above)
      {
        const double height = (x - corner(t, 0)) * n;
        foot                = {height * height, x - height * n, n, t};
      }
    return foot;
  }

  Tensor TriangulatedSurface::normal_around(const Foot &foot, const double distance) const
  {
    const unsigned int t = foot.triangle;
    for (unsigned int k = 0; k < 3; ++k)
      if (foot.at.distance(corner(t, k)) <= distance)
        return normals_of_vertices[triangles[t][k]];
    for (unsigned int k = 0; k < 3; ++k)
      {
        const Tensor along = corner(t, (k + 1) % 3) - corner(t, k);
        if (cross_product_3d(foot.at - corner(t, k), along).norm() <= distance * along.norm())
          return normals_of_triangles[t] + normals_of_triangles[neighbours[t][k]];
      }
    return foot.normal;
  }

  TriangulatedSurface::Nearest TriangulatedSurface::nearest(const Point &x) const
  {
    Foot best;
    tree.for_each_by_distance(
      x,
      [&] { return std::sqrt(best.squared); },
      [&](const unsigned int t) {
        if (const Foot foot = foot_on(t, x); foot.squared < best.squared)
          best = foot;
        return true;
      });
    const Tensor away     = x - best.at;
    const double distance = away.norm();
    if (!(distance > on_surface * size))
      {
        const Tensor n = unit_or_zero(normal_around(best, on_surface * size));
        return {n, away * n};
      }
    const double side = away * best.normal >= 0 ? 1. : -1.;
    return {side / distance * away, side * distance};
  }
} // namespace slipstick::scene
