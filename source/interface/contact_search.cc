#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/interface/contact_search.h>
#include <slipstick/interface/edge_tree.h>
#include <slipstick/interface/facing_distance.h>
#include <slipstick/interface/mortar.h>
#include <slipstick/interface/solid_surface.h>

#include <boost/geometry/algorithms/intersects.hpp>

#include <algorithm>
#include <limits>
#include <set>

namespace slipstick::interface
{
  namespace
  {
    // Touching outlines may differ by rounding: fraction of an edge.
    constexpr double touching = 1e-6;
    // Bodies overlap from this depth on: fraction of an edge.
    constexpr double overlap = 0.1;
    // Edges are equally fine if they differ by less than this fraction.
    constexpr double same_size = 1e-6;

    /// Edges or facets.
    template <int dim>
    using Parts = std::vector<mechanics::BoundaryPart<dim>>;

    template <int dim>
    std::vector<Parts<dim>> outline_of_every_body(const scene::Scene<dim>      &scene,
                                                  const mesh::Mesh<dim>        &mesh,
                                                  const mechanics::Spaces<dim> &spaces)
    {
      std::vector<Parts<dim>> by_body(scene.bodies.size());
      for (const auto &part : mechanics::outlines(mesh, spaces, std::vector<bool>(scene.bodies.size(), true)))
        by_body[part.body].push_back(part);
      return by_body;
    }

    template <int dim>
    std::set<std::pair<unsigned int, unsigned int>> declared_pairs(const scene::Scene<dim> &scene)
    {
      std::set<std::pair<unsigned int, unsigned int>> pairs;
      for (const auto &pair : scene.contacts)
        if (pair.master)
          pairs.insert(std::minmax(pair.slave.body, pair.master->body));
      return pairs;
    }

    BoxTree<2>::Box box_of(const mechanics::SurfaceEdge<2> &edge)
    {
      return EdgeTree::box_around(edge);
    }

    BoxTree<3>::Box box_of(const mechanics::SurfaceFacet &facet)
    {
      std::vector<dealii::Point<3>> nodes;
      for (unsigned int i = 0; i < facet.n_nodes; ++i)
        nodes.push_back(facet.node(i));
      return BoxTree<3>::box_around(nodes);
    }

    template <int dim>
    BoxTree<dim> tree_of(const Parts<dim> &parts)
    {
      std::vector<typename BoxTree<dim>::Box> boxes;
      for (const auto &part : parts)
        boxes.push_back(box_of(part));
      return BoxTree<dim>(boxes);
    }

    /// Mean chord of those parts of a whose boxes are within @p reach of parts of b.
    template <int dim>
    double size_near(const Parts<dim> &a, const Parts<dim> &b, const double reach)
    {
      const auto   tree = tree_of<dim>(b);
      double       sum  = 0;
      unsigned int n    = 0;
      for (const auto &part : a)
        if (!tree.near(BoxTree<dim>::widened(box_of(part), reach)).empty())
          {
            sum += part.chord();
            ++n;
          }
      return n > 0 ? sum / n : std::numeric_limits<double>::max();
    }

    template <int dim>
    double smallest_chord(const Parts<dim> &parts)
    {
      double smallest = std::numeric_limits<double>::max();
      for (const auto &part : parts)
        smallest = std::min(smallest, part.chord());
      return smallest;
    }

    /// Distance to the nearest chord divided by its length.
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

    /// Whether the two sides have a common part within the reach of the pair.
    template <int dim>
    bool meet(const Parts<dim> &slave, const Parts<dim> &master, const scene::ContactPair<dim> &pair)
    {
      return !mortar_rows(slave, master, {*pair.reach, *pair.reach}, scene::ContactDiscretization::mortar, pair.name)
                .empty();
    }

    /// Test for points inside the outline of a body.
    class Inside
    {
    public:
      explicit Inside(const Parts<2> &outline)
        : outline(outline)
      {}

      bool deeper_than_overlap(const dealii::Point<2> &x) const
      {
        return outline.contains(x) && relative_depth(outline, x) > overlap;
      }

    private:
      const ClosedOutline outline;
    };

    /// The same in space, with the mean chord of the facets.
    class InsideSolid
    {
    public:
      explicit InsideSolid(const Parts<3> &facets)
        : surface(facets)
      {
        for (const auto &facet : facets)
          chord += facet.chord() / facets.size();
      }

      bool deeper_than_overlap(const dealii::Point<3> &x) const
      {
        return surface.depth(x) > overlap * chord;
      }

    private:
      const SolidSurface surface;
      double             chord = 0;
    };

    /// Box around the nodes of all parts.
    template <int dim>
    typename BoxTree<dim>::Box box_of_all(const Parts<dim> &parts)
    {
      std::vector<dealii::Point<dim>> nodes;
      for (const auto &part : parts)
        for (unsigned int i = 0; i < part.n_nodes; ++i)
          nodes.push_back(part.node(i));
      return BoxTree<dim>::box_around(nodes);
    }

    template <int dim>
    void check_pair(const scene::Scene<dim> &scene,
                    const unsigned int       a,
                    const Parts<dim>        &of_a,
                    const unsigned int       b,
                    const Parts<dim>        &of_b)
    {
      const std::conditional_t<dim == 2, Inside, InsideSolid> body(of_b);
      for (const auto &part : of_a)
        for (unsigned int i = 0; i < (dim == 2 ? 1 : part.n_nodes); ++i) // edges: the other end begins the next one
          if (const auto x = part.node(i); body.deeper_than_overlap(x))
            throw InputError("bodies '" + scene.bodies[a].name + "' and '" + scene.bodies[b].name +
                               "' overlap: the point " + point_text(x, dim) + " of " + scene.bodies[a].name +
                               " is inside " + scene.bodies[b].name,
                             "move one of them, or declare a contact pair of the two (a press fit)");
    }
  } // namespace

  // In space contact along an edge or in a point does not count: diagonal neighbours in a wall of blocks.
  template <int dim>
  std::vector<scene::ContactPair<dim>> find_contacts(const scene::Scene<dim>      &scene,
                                                     const mesh::Mesh<dim>        &mesh,
                                                     const mechanics::Spaces<dim> &spaces)
  {
    std::vector<scene::ContactPair<dim>> found;
    if (!scene.contact_search.automatic)
      return found;
    const auto by_body  = outline_of_every_body(scene, mesh, spaces);
    const auto declared = declared_pairs(scene);
    for (unsigned int a = 0; a < by_body.size(); ++a)
      for (unsigned int b = a + 1; b < by_body.size(); ++b)
        {
          if (declared.count({a, b}) != 0)
            continue;
          const double reach =
            std::max(scene.contact_search.reach,
                     touching * std::min(smallest_chord<dim>(by_body[a]), smallest_chord<dim>(by_body[b])));
          if (!facing_distance(by_body[a], by_body[b], reach))
            continue;
          const double size_a   = size_near<dim>(by_body[a], by_body[b], reach),
                       size_b   = size_near<dim>(by_body[b], by_body[a], reach);
          const bool b_is_finer = size_b < size_a * (1 - same_size);
          auto       pair       = scene.contact_search.pair;
          pair.name             = scene.bodies[a].name + "-" + scene.bodies[b].name;
          pair.slave            = {b_is_finer ? b : a, "*"};
          pair.master           = scene::BoundaryName{b_is_finer ? a : b, "*"};
          pair.reach            = reach;
          if (dim == 2 || meet<dim>(by_body[pair.slave.body], by_body[pair.master->body], pair))
            found.push_back(pair);
        }
    return found;
  }

  template <int dim>
  void check_overlap(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh, const mechanics::Spaces<dim> &spaces)
  {
    if (dim == 3 && scene.bodies.size() < 2)
      return;
    const auto                              by_body  = outline_of_every_body(scene, mesh, spaces);
    const auto                              declared = declared_pairs(scene);
    std::vector<typename BoxTree<dim>::Box> boxes;
    for (const auto &parts : by_body)
      boxes.push_back(box_of_all<dim>(parts));
    for (unsigned int a = 0; a < by_body.size(); ++a)
      for (unsigned int b = 0; b < by_body.size(); ++b)
        if (a != b && declared.count(std::minmax(a, b)) == 0 && boost::geometry::intersects(boxes[a], boxes[b]))
          check_pair<dim>(scene, a, by_body[a], b, by_body[b]);
  }

  template std::vector<scene::ContactPair<2>> find_contacts(const scene::Scene<2> &,
                                                            const mesh::Mesh<2> &,
                                                            const mechanics::Spaces<2> &);
  template std::vector<scene::ContactPair<3>> find_contacts(const scene::Scene<3> &,
                                                            const mesh::Mesh<3> &,
                                                            const mechanics::Spaces<3> &);
  template void check_overlap(const scene::Scene<2> &, const mesh::Mesh<2> &, const mechanics::Spaces<2> &);
  template void check_overlap(const scene::Scene<3> &, const mesh::Mesh<3> &, const mechanics::Spaces<3> &);
} // namespace slipstick::interface
