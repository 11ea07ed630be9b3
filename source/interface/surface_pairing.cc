#include <slipstick/base/across.h>
#include <slipstick/base/cross.h>
#include <slipstick/interface/surface_pairing.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    // Points outside a facet by at most this fraction of its size are on its edge.
    constexpr double on_edge = 1e-9;
    // Parts of a facet smaller than this (relative to its area) are ignored.
    constexpr double smallest_part = 1e-12;
    // Search boxes are enlarged by this fraction of a facet: touching parts are on the border.
    constexpr double margin = 0.05;
    // Newton's method for a place on a quadrilateral: maximum number of steps, and length of the last one.
    constexpr unsigned int max_steps = 50;
    constexpr double       last_step = 1e-14;
  } // namespace

  Plane::Plane(const dealii::Point<3> &origin, const dealii::Tensor<1, 3> &n)
    : origin(origin)
    , normal(n / n.norm())
  {
    const auto tangents = across(normal);
    first               = tangents[0];
    second              = tangents[1];
  }

  ProjectedFacet::ProjectedFacet(const Facet &facet, const Plane &plane)
    : n_nodes(facet.n_nodes)
    , is_bent(facet.is_bent())
    , facet(&facet)
  {
    for (unsigned int i = 0; i < n_nodes; ++i)
      {
        nodes[i]   = plane.project(facet.node(i));
        heights[i] = (facet.node(i) - plane.origin) * plane.normal;
      }
    const bool is_triangle = facet.n_corners() == 3;
    u                      = nodes[1] - nodes[0];
    v                      = nodes[is_triangle ? 2 : 3] - nodes[0];
    if (!is_triangle)
      twist = (nodes[2] - nodes[0]) - u - v; // 0 for parallelograms
  }

  std::vector<ConvexPolygon> ProjectedFacet::outline() const
  {
    const unsigned int n       = facet->n_corners();
    const auto         counted = [](ConvexPolygon polygon) {
      if (area(polygon) < 0)
        std::reverse(polygon.begin(), polygon.end());
      return polygon;
    };
    if (!is_bent)
      return {counted(ConvexPolygon(nodes.begin(), nodes.begin() + n))};
    ConvexPolygon around;
    for (unsigned int i = 0; i < n; ++i)
      around.insert(around.end(), {nodes[i], nodes[n + i]});
    around = counted(around);
    if (is_convex(around))
      return {around};
    std::vector<ConvexPolygon> parts;
    for (unsigned int i = 0; i < n; ++i) // at the corners
      {
        parts.push_back({nodes[i], nodes[n + i]});
        if (n == 4)
          parts.back().push_back(nodes[8]);
        parts.back().push_back(nodes[n + (i + n - 1) % n]);
        parts.back() = counted(parts.back());
      }
    if (n == 3)
      parts.push_back(counted({nodes[3], nodes[4], nodes[5]}));
    return parts;
  }

  std::array<dealii::Tensor<1, 2>, 3> ProjectedFacet::linearised(const Facet::Place &s, const dealii::Point<2> &x) const
  {
    if (!is_bent)
      return {{nodes[0] + s[0] * u + s[1] * v + s[0] * s[1] * twist - x, u + s[1] * twist, v + s[0] * twist}};
    const auto           N  = facet->shape(s);
    const auto           dN = mesh::FacetShapes::quadratic_derivatives(facet->n_corners(), s);
    dealii::Tensor<1, 2> off(-1. * x), a, b;
    for (unsigned int i = 0; i < n_nodes; ++i)
      {
        off += N[i] * dealii::Tensor<1, 2>(nodes[i]);
        a += dN[i][0] * dealii::Tensor<1, 2>(nodes[i]);
        b += dN[i][1] * dealii::Tensor<1, 2>(nodes[i]);
      }
    return {{off, a, b}};
  }

  ProjectedFacet::Facet::Place ProjectedFacet::place_at(const dealii::Point<2> &x) const
  {
    Facet::Place s = facet->middle_place();
    for (unsigned int i = 0; i < max_steps; ++i)
      {
        const auto [off, a, b] = linearised(s, x);
        const dealii::Tensor<1, 2> step({cross(off, b) / cross(a, b), cross(a, off) / cross(a, b)});
        s -= step;
        if (!(step.norm() > last_step))
          break;
      }
    return s;
  }

  double ProjectedFacet::height_at(const dealii::Point<2> &x) const
  {
    const auto N   = facet->shape(place_at(x));
    double     sum = 0;
    for (unsigned int i = 0; i < n_nodes; ++i)
      sum += N[i] * heights[i];
    return sum;
  }

  SurfacePairing::SurfacePairing(const std::vector<Facet> &slave_,
                                 const std::vector<Facet> &master_,
                                 const Reach              &reach_,
                                 const Corners            &corners)
    : slave(slave_)
    , master(master_)
    , reach(reach_)
    , tree(facet_tree(master_))
    , own(slave_)
  {
    average_normals(corners);
  }

  std::vector<unsigned int> SurfacePairing::candidates(const std::vector<dealii::Point<3>> &points,
                                                       const Tensor                        &n,
                                                       const double                         size) const
  {
    std::vector<dealii::Point<3>> around;
    for (const auto &x : points)
      for (const double way : {-reach.behind, reach.ahead})
        around.push_back(x + way * n);
    return tree.near(BoxTree<3>::widened(BoxTree<3>::box_around(around), margin * size));
  }

  std::optional<SurfacePairing::Facing> SurfacePairing::facing_normal(const SurfaceNode<3>  &node,
                                                                      const SurfaceNodes<3> &of_master,
                                                                      const Corners         &corners) const
  {
    const Plane           plane(node.position, node.normal);
    double                nearest = std::numeric_limits<double>::max();
    std::optional<Facing> found;
    for (const unsigned int m : candidates({node.position}, node.normal, node.size))
      {
        if (middle_normal(master[m]) * node.normal >= facing_cosine)
          continue;
        const ProjectedFacet facet(master[m], plane);
        const auto           outline = facet.outline();
        if (std::none_of(outline.begin(), outline.end(), [&](const ConvexPolygon &polygon) {
              return contains(polygon, {0, 0}, on_edge * master[m].chord());
            }))
          continue;
        const double gap = facet.height_at({0, 0});
        if (gap > reach.ahead || gap < -reach.behind || std::abs(gap) > nearest + on_edge * node.size)
          continue;
        const auto N = master[m].shape(facet.place_at({0, 0}));
        Tensor     n = of_master.normal(m, master[m].n_nodes, N);
        n /= n.norm();
        // on an edge of the master take the side that is most opposed to the slave, independent of the numbering of
        // facets
        if (!found || std::abs(gap) < nearest - on_edge * node.size || n * node.normal < found->normal * node.normal)
          found = {n, is_at_corner(master[m], N, corners)};
        nearest = std::min(nearest, std::abs(gap));
      }
    return found;
  }

  /// Replaces the slave's normals by the means of both sides wherever the slave's own normal hits a master that faces
  /// it, and by that of one side at a corner or an edge of the other.
  void SurfacePairing::average_normals(const Corners &corners)
  {
    const SurfaceNodes<3> of_master(master);
    for (auto &node : own.nodes)
      {
        const Facing facing = facing_normal(node, of_master, corners).value_or(Facing());
        node.normal         = mean_normal(node, facing.normal, facing.is_at_corner, corners);
      }
  }

  namespace
  {
    /// Whether the gap does not jump between two parts: at the corner of either that is nearest to the other it differs
    /// by no more than the distance between them.
    bool are_level(const SurfacePairing::View &view,
                   const SurfacePairing::Part &a,
                   const SurfacePairing::Part &b,
                   const double                rounding)
    {
      double           nearest = std::numeric_limits<double>::max();
      dealii::Point<2> at;
      for (const auto &[from, to] : {std::pair(&a, &b), std::pair(&b, &a)})
        for (const auto &x : from->polygon)
          if (const double apart = distance(to->polygon, x); apart < nearest)
            {
              nearest = apart;
              at      = x;
            }
      return std::abs(view.gap(a, at) - view.gap(b, at)) <= nearest + rounding;
    }

    /// Gradient of the gap of a part.
    dealii::Tensor<1, 2> slope_of_gap(const SurfacePairing::View &view, const SurfacePairing::Part &part)
    {
      const auto           middle = centroid(part.polygon);
      const double         step   = 0.5 * std::sqrt(area(part.polygon));
      dealii::Tensor<1, 2> result;
      for (unsigned int d = 0; d < 2; ++d)
        {
          dealii::Tensor<1, 2> off;
          off[d]    = step;
          result[d] = (view.gap(part, middle + off) - view.gap(part, middle - off)) / (2 * step);
        }
      return result;
    }

    void keep_nearest_level(SurfacePairing::View &view, const double size)
    {
      const auto distance_to = [&](const SurfacePairing::Part &part) {
        double least = std::abs(view.gap(part, centroid(part.polygon)));
        for (const auto &x : part.polygon)
          least = std::min(least, std::abs(view.gap(part, x)));
        return least;
      };
      if (view.parts.size() < 2)
        return;
      std::vector<std::pair<bool, double>> order; // a steep part is a flank between two levels, unless all are steep
      for (const SurfacePairing::Part &part : view.parts)
        order.emplace_back(slope_of_gap(view, part).norm() > steepest_slope, distance_to(part));
      const std::size_t        n = order.size();
      std::vector<std::size_t> level{
        static_cast<std::size_t>(std::min_element(order.begin(), order.end()) - order.begin())};
      std::vector<bool> is_kept(n, false);
      is_kept[level[0]]   = true;
      const auto of_first = slope_of_gap(view, view.parts[level[0]]);
      for (std::size_t next = 0; next < level.size(); ++next)
        for (std::size_t k = 0; k < n; ++k)
          if (!is_kept[k] && (slope_of_gap(view, view.parts[k]) - of_first).norm() <= steepest_slope &&
              are_level(view, view.parts[level[next]], view.parts[k], smallest_jump * size))
            {
              is_kept[k] = true;
              level.push_back(k);
            }
      std::vector<SurfacePairing::Part> kept;
      for (std::size_t k = 0; k < n; ++k)
        if (is_kept[k])
          kept.push_back(std::move(view.parts[k]));
      view.parts = std::move(kept);
    }
  } // namespace

  SurfacePairing::View SurfacePairing::view(const unsigned int e) const
  {
    const Facet                  &facet  = slave[e];
    const auto                    middle = facet.middle_place();
    const Plane                   plane(facet.point(middle), own.normal(e, facet.n_nodes, facet.shape(middle)));
    View                          view{plane, ProjectedFacet(facet, plane), {}};
    const auto                    outline = view.slave.outline();
    const double                  least   = smallest_part * area(outline);
    std::vector<dealii::Point<3>> corners;
    for (unsigned int i = 0; i < facet.n_nodes; ++i)
      corners.push_back(facet.node(i));
    for (const unsigned int m : candidates(corners, plane.normal, facet.chord()))
      {
        if (middle_normal(master[m]) * plane.normal >= facing_cosine)
          continue;
        const ProjectedFacet to(master[m], plane);
        const auto           of_master = to.outline();
        for (const auto &polygon : outline)
          for (const auto &other : of_master)
            {
              Part part{m, to, intersection(polygon, other)};
              if (area(part.polygon) <= least)
                continue;
              if (const double distance = view.gap(part, centroid(part.polygon));
                  distance <= reach.ahead && distance >= -reach.behind)
                view.parts.push_back(std::move(part));
            }
      }
    keep_nearest_level(view, facet.chord());
    return view;
  }

  bool SurfacePairing::View::is_hidden(const Part &part, const dealii::Point<2> &x) const
  {
    const double distance = std::abs(gap(part, x));
    for (const Part &other : parts)
      if (&other != &part && contains(other.polygon, x))
        if (const double to = std::abs(gap(other, x)); to < distance || (to == distance && other.master < part.master))
          return true;
    return false;
  }
} // namespace slipstick::interface
