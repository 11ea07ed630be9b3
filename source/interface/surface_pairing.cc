#include <slipstick/interface/surface_pairing.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace slipstick::interface
{
  namespace
  {
    using Facet  = SurfacePairing::Facet;
    using Node   = SurfacePairing::Node;
    using Tensor = SurfacePairing::Tensor;
    using Nodes  = std::array<unsigned int, Facet::max_nodes>;

    // Points outside a facet by no more than this part of its size are on its edge.
    constexpr double on_edge = 1e-9;
    // Parts of a facet (of its area) that are smaller than this are left out.
    constexpr double smallest_part = 1e-12;
    // Search boxes are wider by this part of a facet: exact touching is on the border.
    constexpr double margin = 0.05;
    // Newton's method for a place on a quadrilateral: steps, and the last one.
    constexpr unsigned int max_steps = 50;
    constexpr double       last_step = 1e-14;

    /// The nodes of a surface with the means of its own normals. @return the nodes of every facet.
    std::vector<Nodes> find_nodes(const std::vector<Facet> &surface, std::vector<Node> &nodes)
    {
      std::map<mechanics::NodeKey, std::vector<std::pair<unsigned int, unsigned int>>> at; // facet, node of the facet
      for (unsigned int e = 0; e < surface.size(); ++e)
        for (unsigned int i = 0; i < surface[e].n_nodes; ++i)
          at[surface[e].keys[i]].emplace_back(e, i);
      std::vector<Nodes> node_of(surface.size());
      for (const auto &[key, places] : at)
        {
          std::vector<Tensor> normals, means;
          for (const auto &[e, i] : places)
            normals.push_back(surface[e].normal(surface[e].node_coordinate(i)));
          const auto         side  = mechanics::smooth_normals(normals, means);
          const unsigned int first = nodes.size();
          for (unsigned int g = 0; g < means.size(); ++g)
            nodes.push_back({key, g, surface[places[0].first].node(places[0].second), means[g]});
          for (unsigned int k = 0; k < places.size(); ++k)
            {
              const auto &[e, i] = places[k];
              node_of[e][i]      = first + side[k];
              auto &node         = nodes[first + side[k]];
              node.covered += surface[e].tributary_areas()[i];
              node.size = std::max(node.size, surface[e].chord());
            }
        }
      return node_of;
    }
  } // namespace

  Plane::Plane(const dealii::Point<3> &origin, const Tensor &n)
    : origin(origin)
    , normal(n / n.norm())
  {
    unsigned int axis = 0; // the one most across
    for (unsigned int d = 1; d < 3; ++d)
      if (std::abs(normal[d]) < std::abs(normal[axis]))
        axis = d;
    first[axis] = 1;
    first -= normal[axis] * normal;
    first /= first.norm();
    second = cross_product_3d(normal, first);
  }

  ConvexPolygon Plane::project(const mechanics::SurfaceFacet &facet) const
  {
    ConvexPolygon polygon;
    for (unsigned int i = 0; i < facet.n_corners(); ++i)
      polygon.push_back(project(facet.node(i)));
    if (area(polygon) < 0)
      std::reverse(polygon.begin(), polygon.end());
    return polygon;
  }

  dealii::Point<2> Plane::place_on(const mechanics::SurfaceFacet &facet, const dealii::Point<2> &x) const
  {
    std::array<dealii::Point<2>, Facet::max_nodes> corner;
    for (unsigned int i = 0; i < facet.n_corners(); ++i)
      corner[i] = project(facet.node(i));
    const bool           is_triangle = facet.n_corners() == 3;
    const auto           u = corner[1] - corner[0], v = corner[is_triangle ? 2 : 3] - corner[0];
    dealii::Tensor<1, 2> twist; // 0 for parallelograms
    if (!is_triangle)
      twist = (corner[2] - corner[0]) - u - v;
    dealii::Point<2> s = facet.middle_place();
    for (unsigned int i = 0; i < max_steps; ++i)
      {
        const auto                 off = corner[0] + s[0] * u + s[1] * v + s[0] * s[1] * twist - x;
        const auto                 a = u + s[1] * twist, b = v + s[0] * twist;
        const double               det = a[0] * b[1] - a[1] * b[0];
        const dealii::Tensor<1, 2> step({(off[0] * b[1] - off[1] * b[0]) / det, (a[0] * off[1] - a[1] * off[0]) / det});
        s -= step;
        if (!(step.norm() > last_step))
          break;
      }
    return s;
  }

  BoxTree<3> facet_tree(const std::vector<mechanics::SurfaceFacet> &facets)
  {
    std::vector<BoxTree<3>::Box> boxes;
    for (const auto &facet : facets)
      {
        std::vector<dealii::Point<3>> corners;
        for (unsigned int i = 0; i < facet.n_nodes; ++i)
          corners.push_back(facet.node(i));
        boxes.push_back(BoxTree<3>::box_around(corners));
      }
    return BoxTree<3>(boxes);
  }

  bool ClosedSurface<mechanics::SurfaceFacet>::contains(const dealii::Point<3> &x) const
  {
    double angle = 0;
    for (const auto &facet : facets)
      for (unsigned int k = 1; k + 1 < facet.n_corners(); ++k)
        {
          const Tensor a = facet.node(0) - x, b = facet.node(k) - x, c = facet.node(k + 1) - x;
          angle +=
            2 * std::atan2(a * cross_product_3d(b, c),
                           a.norm() * b.norm() * c.norm() + a * b * c.norm() + b * c * a.norm() + c * a * b.norm());
        }
    return angle > 2 * dealii::numbers::PI;
  }

  SurfacePairing::SurfacePairing(const std::vector<Facet> &slave_,
                                 const std::vector<Facet> &master_,
                                 const Reach              &reach_)
    : slave(slave_)
    , master(master_)
    , reach(reach_)
    , tree(facet_tree(master_))
    , node_of(find_nodes(slave_, all_nodes))
  {
    average_normals();
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

  std::optional<Tensor> SurfacePairing::facing_normal(const Node               &node,
                                                      const std::vector<Node>  &of_master,
                                                      const std::vector<Nodes> &nodes_of_master) const
  {
    const Plane           plane(node.position, node.normal);
    double                nearest = std::numeric_limits<double>::max();
    std::optional<Tensor> found;
    for (const unsigned int m : candidates({node.position}, node.normal, node.size))
      {
        const Facet &facet = master[m];
        if (facet.normal(facet.middle_place()) * node.normal >= facing_cosine ||
            !contains(plane.project(facet), {0, 0}, on_edge * facet.chord()))
          continue;
        const auto   place = plane.place_on(facet, {0, 0});
        const double gap   = (facet.point(place) - node.position) * node.normal;
        if (gap > reach.ahead || gap < -reach.behind || std::abs(gap) > nearest + on_edge * node.size)
          continue;
        const auto N = facet.shape(place);
        Tensor     n;
        for (unsigned int i = 0; i < facet.n_nodes; ++i)
          n += N[i] * of_master[nodes_of_master[m][i]].normal;
        n /= n.norm();
        // on an edge of the master the side that faces the slave most, however the facets are numbered
        if (!found || std::abs(gap) < nearest - on_edge * node.size || n * node.normal < *found * node.normal)
          found = n;
        nearest = std::min(nearest, std::abs(gap));
      }
    return found;
  }

  /// Replaces the slave's normals by the means of both sides wherever the slave's own normal meets a master that faces it.
  void SurfacePairing::average_normals()
  {
    std::vector<Node>   of_master;
    const auto          nodes_of_master = find_nodes(master, of_master);
    std::vector<Tensor> means;
    for (const Node &node : all_nodes)
      {
        const Tensor sum = node.normal - facing_normal(node, of_master, nodes_of_master).value_or(Tensor());
        means.push_back(sum / sum.norm());
      }
    for (unsigned int i = 0; i < all_nodes.size(); ++i)
      all_nodes[i].normal = means[i];
  }

  Plane SurfacePairing::plane(const unsigned int e) const
  {
    Tensor n;
    for (unsigned int i = 0; i < slave[e].n_nodes; ++i)
      n += all_nodes[node_of[e][i]].normal;
    return Plane(slave[e].point(slave[e].middle_place()), n);
  }

  double SurfacePairing::gap(const unsigned int      e,
                             const unsigned int      m,
                             const Plane            &plane,
                             const dealii::Point<2> &x) const
  {
    return (master[m].point(plane.place_on(master[m], x)) - slave[e].point(plane.place_on(slave[e], x))) * plane.normal;
  }

  std::vector<SurfacePairing::Part> SurfacePairing::parts(const unsigned int e) const
  {
    const Plane                   own     = plane(e);
    const ConvexPolygon           polygon = own.project(slave[e]);
    std::vector<dealii::Point<3>> corners;
    for (unsigned int i = 0; i < slave[e].n_nodes; ++i)
      corners.push_back(slave[e].node(i));
    std::vector<Part> result;
    for (const unsigned int m : candidates(corners, own.normal, slave[e].chord()))
      {
        if (master[m].normal(master[m].middle_place()) * own.normal >= facing_cosine)
          continue;
        Part part{m, intersection(polygon, own.project(master[m]))};
        if (area(part.polygon) <= smallest_part * area(polygon))
          continue;
        if (const double distance = gap(e, m, own, centroid(part.polygon));
            distance <= reach.ahead && distance >= -reach.behind)
          result.push_back(std::move(part));
      }
    return result;
  }
} // namespace slipstick::interface
