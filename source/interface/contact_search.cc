#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/interface/contact_search.h>
#include <slipstick/interface/edge_tree.h>
#include <slipstick/interface/facing_distance.h>

#include <algorithm>
#include <limits>
#include <set>

namespace slipstick::interface
{
  namespace
  {
    // Outlines that touch may be apart by rounding: fraction of an edge.
    constexpr double touching = 1e-6;
    // Depth from which on bodies overlap: fraction of an edge.
    constexpr double overlap = 0.1;
    // Edges are equally fine if they differ by less than this fraction.
    constexpr double same_size = 1e-6;

    using Edges = std::vector<mechanics::SurfaceEdge<2>>;

    std::vector<Edges> outline_of_every_body(const scene::Scene<2>      &scene,
                                             const mesh::Mesh<2>        &mesh,
                                             const mechanics::Spaces<2> &spaces)
    {
      std::vector<Edges> by_body(scene.bodies.size());
      for (const auto &edge : mechanics::outlines(mesh, spaces, std::vector<bool>(scene.bodies.size(), true)))
        by_body[edge.body].push_back(edge);
      return by_body;
    }

    std::set<std::pair<unsigned int, unsigned int>> declared_pairs(const scene::Scene<2> &scene)
    {
      std::set<std::pair<unsigned int, unsigned int>> pairs;
      for (const auto &pair : scene.contacts)
        if (pair.master)
          pairs.insert(std::minmax(pair.slave.body, pair.master->body));
      return pairs;
    }

    /// Mean chord of those edges of a whose boxes are within @p reach of edges of b.
    double size_near(const Edges &a, const Edges &b, const double reach)
    {
      const EdgeTree tree(b);
      double         sum = 0;
      unsigned int   n   = 0;
      for (const auto &edge : a)
        {
          auto box         = EdgeTree::box_around(edge);
          box.min_corner() = {box.min_corner().get<0>() - reach, box.min_corner().get<1>() - reach};
          box.max_corner() = {box.max_corner().get<0>() + reach, box.max_corner().get<1>() + reach};
          if (!tree.near(box).empty())
            {
              sum += edge.chord();
              ++n;
            }
        }
      return n > 0 ? sum / n : std::numeric_limits<double>::max();
    }

    double smallest_chord(const Edges &edges)
    {
      double smallest = std::numeric_limits<double>::max();
      for (const auto &edge : edges)
        smallest = std::min(smallest, edge.chord());
      return smallest;
    }

    /// Distance to the nearest chord over its length.
    double relative_depth(const ClosedOutline &outline, const dealii::Point<2> &x)
    {
      double best = std::numeric_limits<double>::max(), relative = 0;
      outline.tree.for_each_by_distance(
        x,
        [&] { return best; },
        [&](const unsigned int e) {
          const auto   a = outline.edges[e].node(0), b = outline.edges[e].node(1);
          const double s        = std::min(1., std::max(0., (x - a) * (b - a) / (b - a).norm_square()));
          const double distance = x.distance(a + s * (b - a));
          if (distance < best)
            {
              best     = distance;
              relative = distance / outline.edges[e].chord();
            }
          return true;
        });
      return relative;
    }

    void check_pair(const scene::Scene<2> &scene,
                    const unsigned int     a,
                    const Edges           &of_a,
                    const unsigned int     b,
                    const Edges           &of_b)
    {
      const ClosedOutline outline(of_b);
      for (const auto &edge : of_a)
        if (const auto x = edge.node(0); outline.contains(x) && relative_depth(outline, x) > overlap)
          throw InputError(format("bodies '%s' and '%s' overlap: the point (%g, %g) of %s is inside %s",
                                  scene.bodies[a].name.c_str(),
                                  scene.bodies[b].name.c_str(),
                                  x[0],
                                  x[1],
                                  scene.bodies[a].name.c_str(),
                                  scene.bodies[b].name.c_str()),
                           "move one of them, or declare a contact pair of the two (a press fit)");
    }
  } // namespace

  template <>
  std::vector<scene::ContactPair<2>> find_contacts(const scene::Scene<2>      &scene,
                                                   const mesh::Mesh<2>        &mesh,
                                                   const mechanics::Spaces<2> &spaces)
  {
    std::vector<scene::ContactPair<2>> found;
    if (!scene.contact_search.automatic)
      return found;
    const auto by_body  = outline_of_every_body(scene, mesh, spaces);
    const auto declared = declared_pairs(scene);
    for (unsigned int a = 0; a < by_body.size(); ++a)
      for (unsigned int b = a + 1; b < by_body.size(); ++b)
        {
          if (declared.count({a, b}) != 0)
            continue;
          const double reach = std::max(scene.contact_search.reach,
                                        touching * std::min(smallest_chord(by_body[a]), smallest_chord(by_body[b])));
          if (!facing_distance(by_body[a], by_body[b], reach))
            continue;
          const double size_a   = size_near(by_body[a], by_body[b], reach),
                       size_b   = size_near(by_body[b], by_body[a], reach);
          const bool b_is_finer = size_b < size_a * (1 - same_size);
          auto       pair       = scene.contact_search.pair;
          pair.name             = scene.bodies[a].name + "-" + scene.bodies[b].name;
          pair.slave            = {b_is_finer ? b : a, "*"};
          pair.master           = scene::BoundaryName{b_is_finer ? a : b, "*"};
          pair.reach            = reach;
          found.push_back(pair);
        }
    return found;
  }

  template <>
  void check_overlap(const scene::Scene<2> &scene, const mesh::Mesh<2> &mesh, const mechanics::Spaces<2> &spaces)
  {
    const auto by_body  = outline_of_every_body(scene, mesh, spaces);
    const auto declared = declared_pairs(scene);
    for (unsigned int a = 0; a < by_body.size(); ++a)
      for (unsigned int b = 0; b < by_body.size(); ++b)
        if (a != b && declared.count(std::minmax(a, b)) == 0)
          check_pair(scene, a, by_body[a], b, by_body[b]);
  }

  // The scene knows no search in space.
  template <>
  std::vector<scene::ContactPair<3>> find_contacts(const scene::Scene<3> &,
                                                   const mesh::Mesh<3> &,
                                                   const mechanics::Spaces<3> &)
  {
    return {};
  }

  template <>
  void check_overlap(const scene::Scene<3> &, const mesh::Mesh<3> &, const mechanics::Spaces<3> &)
  {}
} // namespace slipstick::interface
