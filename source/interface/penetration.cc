#include <slipstick/base/gather.h>
#include <slipstick/interface/edge_tree.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/interface/obstacle_penetration.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/interface/penetration.h>
#include <slipstick/interface/self_penetration.h>
#include <slipstick/interface/solid_surface.h>

#include <deal.II/base/mpi.h>

#include <boost/geometry/algorithms/intersects.hpp>
#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    using Edge  = mechanics::SurfaceEdge<2>;
    using Edges = std::vector<Edge>;
    using Point = dealii::Point<2>;

    /// Displacements of nodes.
    template <int dim>
    using Moves = std::map<mechanics::NodeKey, dealii::Tensor<1, dim>>;

    /// Edges or faces.
    template <int dim>
    using Parts = std::vector<mechanics::BoundaryPart<dim>>;

    template <int dim>
    struct Move
    {
      mechanics::NodeKey      key{};
      std::array<double, dim> u{};

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &key &u;
      }
    };

    template <int dim>
    Moves<dim> moves_of_outlines(const mesh::Mesh<dim>              &mesh,
                                 const mechanics::Spaces<dim>       &spaces,
                                 const std::vector<Eigen::VectorXd> &u)
    {
      std::vector<Move<dim>> own;
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        spaces.for_each_outline_node(mesh,
                                     p,
                                     [&](const unsigned int        node,
                                         const mechanics::NodeKey &key,
                                         const dealii::Point<dim> &) {
                                       own.emplace_back();
                                       own.back().key = key;
                                       for (unsigned int d = 0; d < dim; ++d)
                                         own.back().u[d] = u[p][dim * node + d];
                                     });
      Moves<dim> all;
      for (const auto &list : all_gather(mesh.comm, own))
        for (const auto &move : list)
          for (unsigned int d = 0; d < dim; ++d)
            all[move.key][d] = move.u[d];
      return all;
    }

    template <int dim, class List>
    List moved(List parts, const Moves<dim> &moves)
    {
      for (auto &part : parts)
        for (unsigned int i = 0; i < part.n_nodes; ++i)
          for (unsigned int d = 0; d < dim; ++d)
            part.at[i][d] += moves.at(part.keys[i])[d];
      return parts;
    }

    template <int dim>
    bool is_watched(const scene::ContactPair<dim> &pair)
    {
      return !pair.law.is_bonded && !pair.gap;
    }

    /// Slave nodes that have no row within the Reach of the pair, but have one without this limit.
    template <int dim>
    void find_beyond_reach(const scene::ContactPair<dim> &pair,
                           const Parts<dim>              &slave,
                           const Parts<dim>              &master,
                           const Moves<dim>              &moves,
                           const double                   t,
                           std::optional<Penetration>    &deepest)
    {
      auto both = slave;
      both.insert(both.end(), master.begin(), master.end());
      const auto rows_within = [&](const double ahead) {
        return mortar_rows(slave, master, {ahead, *pair.reach}, scene::ContactDiscretization::mortar, pair.name);
      };
      std::set<std::pair<mechanics::NodeKey, unsigned int>> paired;
      for (const auto &row : rows_within(*pair.reach))
        paired.insert({row.slave, row.side});
      for (const auto &row : rows_within(extent(both)))
        if (paired.count({row.slave, row.side}) == 0)
          {
            dealii::Tensor<1, dim> closing;
            for (const auto &[key, weight] : row.slave_weights)
              closing += weight * moves.at(key);
            for (const auto &[key, weight] : row.master_weights)
              closing -= weight * moves.at(key);
            const double gap = row.gap + pair.offset.value(row.position, t);
            take_deeper(deepest,
                        closing * row.normal - gap,
                        row.position,
                        std::pow(row.full_length, 1. / (dim - 1)),
                        gap);
          }
    }

    template <int dim>
    void find_beyond_reach(const scene::Obstacle<dim>    &obstacle,
                           const scene::ContactPair<dim> &pair,
                           const Parts<dim>              &slave,
                           const Moves<dim>              &moves,
                           const double                   t,
                           std::optional<Penetration>    &deepest)
    {
      for (const auto &edge : slave)
        for (unsigned int i = 0; i < edge.n_nodes; ++i)
          {
            const auto   x       = edge.node(i);
            const auto   contact = contact_with(obstacle, x, t);
            const double gap     = contact.gap + pair.offset.value(x, t);
            if (gap > *pair.reach)
              take_deeper(deepest, contact.normal * moves.at(edge.keys[i]) - gap, x, edge.chord(), gap);
          }
    }

    /// One body before and after loading.
    struct Body
    {
      explicit Body(Edges before_, const Moves<2> &moves)
        : before(std::move(before_))
        , now(moved<2>(before, moves))
        , outline_before(before)
        , outline_now(now)
        , low(now[0].node(0))
        , high(low)
      {
        for (const auto &edge : now)
          for (unsigned int i = 0; i < edge.n_nodes; ++i)
            for (unsigned int d = 0; d < 2; ++d)
              {
                low[d]  = std::min(low[d], edge.at[i][d]);
                high[d] = std::max(high[d], edge.at[i][d]);
              }
        box = BoxTree<2>::box_around({low, high});
      }

      bool is_in_box(const Point &x) const
      {
        return low[0] < x[0] && x[0] < high[0] && low[1] < x[1] && x[1] < high[1];
      }

      const Edges         before, now;
      const ClosedOutline outline_before, outline_now;
      Point               low, high;
      BoxTree<2>::Box     box; // from low to high
    };

    /// Depth of the outline below the chord of an edge, the smaller of @p before and @p now: chords of concave sides
    /// cut into the bodies that they touch.
    double hollow(const Edge &before, const Edge &now, const double s)
    {
      const Point  on_chord = now.node(0) + s * (now.node(1) - now.node(0));
      const double bend     = (now.point(s) - on_chord) * now.normal(s);
      return std::max(0., -bend - before.rise(s, before.normal(s)));
    }

    /// Depth of the point at s on a body's outline inside another body, 0 if it is not inside.
    Penetration depth_in(const ClosedOutline &outline,
                         const Edges         &before,
                         const Edge          &edge_before,
                         const Edge          &edge,
                         const double         s)
    {
      const Point x = edge.point(s);
      if (!outline.contains(x))
        return {};
      const auto  there = outline.nearest(x);
      const auto &other = outline.edges[there.edge];
      // x is on the bent edge already; for a straight edge the true curve may lie farther inside its own body
      const double own   = std::max(0., -edge_before.rise(s, edge_before.normal(s)));
      const double depth = there.distance - hollow(before[there.edge], other, there.s) - own;
      return {std::max(0., depth), {}, other.chord(), 0.};
    }

    /// The same in space. Surfaces are created when needed: most bodies are far from each other.
    struct Solid
    {
      Solid(Parts<3> before_, const Moves<3> &moves)
        : before(std::move(before_))
        , now(moved<3>(before, moves))
      {
        std::vector<dealii::Point<3>> nodes;
        for (const auto &facet : now)
          {
            chord += facet.chord() / now.size();
            for (unsigned int i = 0; i < facet.n_nodes; ++i)
              nodes.push_back(facet.node(i));
          }
        box = BoxTree<3>::box_around(nodes);
      }

      const SolidSurface &surface_before() const
      {
        if (!made_before)
          made_before = std::make_unique<SolidSurface>(before);
        return *made_before;
      }

      const SolidSurface &surface_now() const
      {
        if (!made_now)
          made_now = std::make_unique<SolidSurface>(now);
        return *made_now;
      }

      const Parts<3>  before, now;
      double          chord = 0; // mean
      BoxTree<3>::Box box;

    private:
      mutable std::unique_ptr<SolidSurface> made_before, made_now;
    };

    /// Tests nodes and midpoints of the facets of a.
    void find_in_body(const Solid &a, const Solid &b, std::optional<Penetration> &deepest)
    {
      std::set<mechanics::NodeKey> seen;
      for (unsigned int e = 0; e < a.now.size(); ++e)
        for (unsigned int i = 0; i <= a.now[e].n_nodes; ++i)
          {
            const bool is_node = i < a.now[e].n_nodes;
            if (is_node && !seen.insert(a.now[e].keys[i]).second)
              continue;
            const auto x = is_node ? a.now[e].node(i) : a.now[e].middle();
            if (!boost::geometry::intersects(BoxTree<3>::box_around({x}), b.box))
              continue;
            if (const double depth = b.surface_now().depth(x); depth > 0)
              {
                const auto at = is_node ? a.before[e].node(i) : a.before[e].middle();
                take_deeper(deepest, depth - b.surface_before().depth(at), at, std::min(a.now[e].chord(), b.chord), 0.);
              }
          }
    }

    void find_in_body(const Body &a, const Body &b, std::optional<Penetration> &deepest)
    {
      for (unsigned int e = 0; e < a.now.size(); ++e)
        for (const double s : {0., 0.5})
          if (b.is_in_box(a.now[e].point(s)))
            if (const auto now = depth_in(b.outline_now, b.before, a.before[e], a.now[e], s); now.depth > 0)
              {
                const auto before = depth_in(b.outline_before, b.before, a.before[e], a.before[e], s);
                take_deeper(deepest,
                            now.depth - before.depth,
                            a.before[e].point(s),
                            std::min(a.now[e].chord(), now.edge),
                            0.);
              }
    }

    template <int dim, class SomeBody>
    void find_in_bodies(const scene::Scene<dim>                            &scene,
                        const std::vector<std::unique_ptr<const SomeBody>> &bodies,
                        const double                                        t,
                        Penetrations                                       &found)
    {
      std::set<std::pair<unsigned int, unsigned int>> not_watched;
      for (const auto &pair : scene.contacts)
        if (pair.master &&
            (!is_watched(pair) || !pair.offset.is_constant() || pair.offset.value(dealii::Point<dim>(), t) != 0))
          {
            not_watched.insert({pair.slave.body, pair.master->body});
            not_watched.insert({pair.master->body, pair.slave.body});
          }
      for (unsigned int a = 0; a < bodies.size(); ++a)
        for (unsigned int b = 0; b < bodies.size(); ++b)
          if (a != b && boost::geometry::intersects(bodies[a]->box, bodies[b]->box) && not_watched.count({a, b}) == 0)
            {
              std::optional<Penetration> deepest;
              find_in_body(*bodies[a], *bodies[b], deepest);
              if (deepest)
                found.of_bodies[{a, b}] = *deepest;
            }
    }

    template <int dim>
    void find_in_itself(const scene::Scene<dim> &scene,
                        const mesh::Mesh<dim>   &mesh,
                        const unsigned int       body,
                        const Parts<dim>        &before,
                        const Parts<dim>        &now,
                        Penetrations            &found)
    {
      std::set<unsigned int> exempt;
      for (const auto &pair : scene.contacts)
        if (pair.master && pair.master->body == body && pair.slave.body == body)
          for (const auto &side : {pair.slave, *pair.master})
            for (const auto &part : mechanics::parts_on(mesh, before, side))
              exempt.insert(std::lower_bound(before.begin(), before.end(), part) - before.begin());
      if (const auto deepest = self_penetration<dim>(before, now, exempt))
        found.in_itself[body] = *deepest;
    }
  } // namespace

  template <>
  Penetrations penetrations(const scene::Scene<2>              &scene,
                            const mesh::Mesh<2>                &mesh,
                            const mechanics::Spaces<2>         &spaces,
                            const std::vector<Eigen::VectorXd> &u,
                            const double                        t)
  {
    const auto         moves = moves_of_outlines(mesh, spaces, u);
    const auto         all   = mechanics::outlines(mesh, spaces, std::vector<bool>(scene.bodies.size(), true));
    std::vector<Edges> by_body(scene.bodies.size());
    for (const auto &edge : all)
      by_body[edge.body].push_back(edge);
    std::vector<std::unique_ptr<const Body>> bodies;
    for (auto &edges : by_body)
      bodies.push_back(std::make_unique<const Body>(std::move(edges), moves));

    Penetrations found;
    found.beyond_reach.resize(scene.contacts.size());
    found.in_obstacle.resize(scene.contacts.size());
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      {
        const auto &pair = scene.contacts[k];
        if (!is_watched(pair))
          continue;
        const auto slave = mechanics::edges_on(mesh, all, pair.slave);
        if (pair.master && pair.reach)
          find_beyond_reach<2>(pair,
                               slave,
                               mechanics::edges_on(mesh, all, *pair.master),
                               moves,
                               t,
                               found.beyond_reach[k]);
        if (!pair.master && pair.reach)
          find_beyond_reach<2>(scene.obstacles[pair.obstacle], pair, slave, moves, t, found.beyond_reach[k]);
        if (!pair.master)
          {
            find_in_obstacle<2>(scene, pair, slave, moved<2>(slave, moves), t, found.in_obstacle[k]);
            find_points_of_obstacle(scene, mesh, pair, bodies[pair.slave.body]->outline_now, t, found.in_obstacle[k]);
          }
      }
    find_in_bodies(scene, bodies, t, found);
    for (unsigned int b = 0; b < bodies.size(); ++b)
      find_in_itself<2>(scene, mesh, b, bodies[b]->before, bodies[b]->now, found);
    return found;
  }

  template <>
  Penetrations penetrations(const scene::Scene<3>              &scene,
                            const mesh::Mesh<3>                &mesh,
                            const mechanics::Spaces<3>         &spaces,
                            const std::vector<Eigen::VectorXd> &u,
                            const double                        t)
  {
    Penetrations found;
    found.beyond_reach.resize(scene.contacts.size());
    found.in_obstacle.resize(scene.contacts.size());
    const auto moves = moves_of_outlines(mesh, spaces, u);
    const auto all   = mechanics::outlines(mesh, spaces, std::vector<bool>(scene.bodies.size(), true));
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      if (const auto &pair = scene.contacts[k]; is_watched(pair))
        {
          const auto slave = mechanics::parts_on(mesh, all, pair.slave);
          if (pair.reach && pair.master)
            find_beyond_reach<3>(pair,
                                 slave,
                                 mechanics::parts_on(mesh, all, *pair.master),
                                 moves,
                                 t,
                                 found.beyond_reach[k]);
          else if (pair.reach)
            find_beyond_reach<3>(scene.obstacles[pair.obstacle], pair, slave, moves, t, found.beyond_reach[k]);
          if (!pair.master)
            {
              const auto now = moved<3>(slave, moves);
              find_in_obstacle<3>(scene, pair, slave, now, t, found.in_obstacle[k]);
              Parts<3> body;
              std::copy_if(all.begin(), all.end(), std::back_inserter(body), [&](const auto &facet) {
                return facet.body == pair.slave.body;
              });
              find_points_of_obstacle(scene, pair, moved<3>(body, moves), now, t, found.in_obstacle[k]);
            }
        }
    std::vector<Parts<3>> by_body(scene.bodies.size());
    for (const auto &facet : all)
      by_body[facet.body].push_back(facet);
    std::vector<std::unique_ptr<const Solid>> bodies;
    for (auto &facets : by_body)
      bodies.push_back(std::make_unique<const Solid>(std::move(facets), moves));
    find_in_bodies(scene, bodies, t, found);
    for (unsigned int b = 0; b < bodies.size(); ++b)
      find_in_itself<3>(scene, mesh, b, bodies[b]->before, bodies[b]->now, found);
    return found;
  }
} // namespace slipstick::interface
