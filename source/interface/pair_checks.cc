#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/interface/edge_tree.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/interface/surface_pairing.h>
#include <slipstick/scene/triangulated_surface.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::interface
{
  template <int dim>
  std::string describe(const scene::Scene<dim> &scene, const scene::BoundaryName &where)
  {
    return scene.bodies[where.body].name + "/" + where.boundary;
  }

  namespace
  {
    // A master is behind its slave if it is deeper than this fraction of a mean slave edge.
    constexpr double deep = 0.1;
    // Sides touch if they are nearer than this fraction of their extent.
    constexpr double corner_on_corner = 1e-9;
    // Number of normals per side that are compared for a message.
    constexpr unsigned int n_compared = 500;
    // Number of divisions of an edge, or of a face along each direction, to find what faces it between its nodes.
    constexpr unsigned int n_between = 8;
    constexpr double       infinity  = std::numeric_limits<double>::infinity();

    /// Edges or faces.
    template <int dim>
    using Parts = std::vector<mechanics::BoundaryPart<dim>>;

    double degrees(const double cosine)
    {
      constexpr double resolution = 1e-3;
      const double     angle      = std::acos(std::min(1., std::max(-1., cosine))) * 180 / dealii::numbers::PI;
      return std::round(angle / resolution) * resolution;
    }

    /// Whether any point of a side is inside the body with the outline.
    template <class Part>
    bool any_inside(const std::vector<Part> &side, const std::vector<Part> &outline)
    {
      const ClosedSurface<Part> body(outline);
      for (const auto &part : side)
        for (const auto &x : mechanics::inner_points(part))
          if (body.contains(x))
            return true;
      return false;
    }

    /// Largest angle between outward normals of two sides [degrees].
    template <class Part>
    double largest_angle(const std::vector<Part> &a, const std::vector<Part> &b)
    {
      const unsigned int step_a = a.size() / n_compared + 1, step_b = b.size() / n_compared + 1;
      double             least = 1;
      for (unsigned int i = 0; i < a.size(); i += step_a)
        for (unsigned int j = 0; j < b.size(); j += step_b)
          least = std::min(least, mechanics::middle_normal(a[i]) * mechanics::middle_normal(b[j]));
      return degrees(least);
    }

    template <int dim>
    double least_gap(const std::vector<MortarRow<dim>> &rows)
    {
      double least = infinity;
      for (const auto &row : rows)
        least = std::min(least, std::abs(row.gap));
      return least;
    }

    template <int dim>
    std::string between(const scene::Scene<dim> &scene, const scene::ContactPair<dim> &pair)
    {
      return "Contact " + pair.name + ": " + describe(scene, pair.slave) + " and " + describe(scene, *pair.master);
    }

    template <int dim>
    [[noreturn]] void refuse_facing_away(const scene::Scene<dim>           &scene,
                                         const scene::ContactPair<dim>     &pair,
                                         const std::vector<MortarRow<dim>> &rows)
    {
      throw InputError(
        between(scene, pair) +
          format(
            " face away from each other: the slave finds the master only against its outward normal, through %g mm or more of its own "
            "body",
            least_gap(rows)),
        "choose the boundaries that lie between the two bodies, or move, mirror or rotate a body");
    }

    /// Largest displacement prescribed by a support at any load factor [mm].
    template <int dim>
    double largest_prescribed(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh, const Parts<dim> &all)
    {
      double largest = 0;
      for (const auto &support : scene.supports)
        {
          std::vector<dealii::Point<dim>> places;
          if (!support.point)
            for (const auto &edge : mechanics::parts_on(mesh, all, support.where))
              for (unsigned int i = 0; i < edge.n_nodes; ++i)
                places.push_back(edge.node(i));
          else if (support.point->coordinates)
            places.push_back(*support.point->coordinates);
          else
            places.push_back(mesh.points[support.point->body].at(support.point->point).position);
          for (const double t : scene.load_factors)
            for (const auto &x : places)
              {
                double squares = 0;
                for (const auto &component : support.components)
                  if (component)
                    squares += std::pow(component->value(x, t), 2);
                if (support.normal)
                  squares += std::pow(support.normal->value(x, t), 2);
                largest = std::max(largest, std::sqrt(squares));
              }
        }
      return largest;
    }

    /// @param size of the sides. @param gap smallest gap of all load steps.
    template <int dim>
    void check_automatic_reach(const scene::Scene<dim>       &scene,
                               const mesh::Mesh<dim>         &mesh,
                               const scene::ContactPair<dim> &pair,
                               const Parts<dim>              &all,
                               const std::string             &names,
                               const double                   size,
                               const double                   gap)
    {
      if (gap <= size) // the common case; avoids evaluating the supports
        return;
      const double prescribed = largest_prescribed<dim>(scene, mesh, all);
      if (gap > size + prescribed)
        throw InputError(names +
                           format(" are out of reach of each other: the smallest gap is %g mm, the automatic reach "
                                  "is %g mm (extent %g mm, prescribed displacements up to %g mm)",
                                  gap,
                                  size + prescribed,
                                  size,
                                  prescribed),
                         "move the bodies, or set " + reach_of(scene, pair) + " to more than that gap");
    }

    /// Sampling points between the nodes with their outward normals.
    std::vector<std::pair<dealii::Point<2>, dealii::Tensor<1, 2>>> places_with_normals(
      const mechanics::SurfaceEdge<2> &edge)
    {
      std::vector<std::pair<dealii::Point<2>, dealii::Tensor<1, 2>>> places;
      for (unsigned int i = 1; i < n_between; ++i)
        places.emplace_back(edge.point(double(i) / n_between), edge.normal(double(i) / n_between));
      return places;
    }

    std::vector<std::pair<dealii::Point<3>, dealii::Tensor<1, 3>>> places_with_normals(
      const mechanics::SurfaceFacet &facet)
    {
      std::vector<std::pair<dealii::Point<3>, dealii::Tensor<1, 3>>> places;
      for (unsigned int i = 1; i < n_between; ++i)
        for (unsigned int j = 1; j < n_between; ++j)
          {
            const double                         s = double(i) / n_between, t = double(j) / n_between;
            const mechanics::SurfaceFacet::Place place(facet.n_corners() == 3 ? s * (1 - t) : s, t);
            places.emplace_back(facet.point(place), facet.normal(place));
          }
      return places;
    }

    /// Largest scalar product of the outward normal with the direction into the obstacle between the nodes: the nodes
    /// may all miss an obstacle that is smaller than an edge.
    template <int dim>
    double cosine_between_nodes(const scene::Scene<dim>       &scene,
                                const scene::ContactPair<dim> &pair,
                                const Parts<dim>              &slave)
    {
      double cosine = -1;
      for (const double t : scene.load_factors)
        for (const auto &part : slave)
          for (const auto &[x, normal] : places_with_normals(part))
            cosine = std::max(cosine, contact_with(scene.obstacles[pair.obstacle], x, t).normal * normal);
      return cosine;
    }

    /// Outward normals and gaps at the nodes of a slave boundary against its obstacle.
    struct AgainstObstacle
    {
      double cosine = -1; // largest scalar product of the outward normal with the direction into the obstacle
      double gap    = infinity;
    };

    template <int dim>
    AgainstObstacle against_obstacle(const scene::Scene<dim>       &scene,
                                     const scene::ContactPair<dim> &pair,
                                     const Parts<dim>              &slave)
    {
      AgainstObstacle result;
      for (const double t : scene.load_factors)
        for (const auto &edge : slave)
          for (unsigned int i = 0; i < edge.n_nodes; ++i)
            {
              const auto   x       = edge.node(i);
              const auto   contact = contact_with(scene.obstacles[pair.obstacle], x, t);
              const double gap     = pair.gap ? pair.gap->value(x, t) : contact.gap;
              result.cosine        = std::max(result.cosine, contact.normal * edge.normal_at(i));
              result.gap           = std::min(result.gap, gap + pair.offset.value(x, t));
            }
      return result;
    }

    template <int dim>
    void check_obstacle_pair(const scene::Scene<dim>       &scene,
                             const mesh::Mesh<dim>         &mesh,
                             const scene::ContactPair<dim> &pair,
                             const Parts<dim>              &all)
    {
      const auto  slave    = mechanics::parts_on(mesh, all, pair.slave);
      const auto &obstacle = scene.obstacles[pair.obstacle];
      const auto names = "Contact " + pair.name + ": " + describe(scene, pair.slave) + " and obstacle " + obstacle.name;
      const auto found = against_obstacle<dim>(scene, pair, slave);
      if (found.cosine <= -facing_cosine && cosine_between_nodes<dim>(scene, pair, slave) <= -facing_cosine)
        throw InputError(names +
                           format(" face away from each other: the outward normals of the slave are %g degrees or "
                                  "more from the direction to the obstacle; less than %g is allowed",
                                  degrees(found.cosine),
                                  degrees(-facing_cosine)),
                         "choose the boundary on the side of the obstacle, move the body, or reverse the obstacle");
      if (pair.reach && found.gap > *pair.reach)
        throw InputError(names + format(" are out of reach of each other: the smallest gap is %g mm, Reach is %g mm",
                                        found.gap,
                                        *pair.reach),
                         "move the body or the obstacle, or set Contact " + pair.name + "/Reach to more than that gap");
      const bool is_round =
        obstacle.shape == scene::ObstacleShape::circle || obstacle.shape == scene::ObstacleShape::hole ||
        obstacle.shape == scene::ObstacleShape::cylinder || obstacle.shape == scene::ObstacleShape::bore;
      if (!pair.reach && !pair.gap)
        check_automatic_reach<dim>(scene,
                                   mesh,
                                   pair,
                                   all,
                                   names,
                                   std::max({extent(slave),
                                             is_round ? 2 * obstacle.radius : 0.,
                                             obstacle.surface ? obstacle.surface->extent() : 0.}),
                                   found.gap);
    }
  } // namespace

  template <int dim>
  bool lies_behind(const PairSides<dim> &sides, const std::vector<MortarRow<dim>> &rows)
  {
    double chords = 0;
    for (const auto &edge : sides.slave)
      chords += edge.chord();
    for (const auto &row : rows)
      if (row.gap > -deep * chords / sides.slave.size())
        return false;
    if (!rows.empty() && sides.slave.front().body == sides.master.front().body)
      return true; // both sides belong to one outline, which contains all their points
    return !rows.empty() && !any_inside(sides.slave, sides.master_outline) &&
           !any_inside(sides.master, sides.slave_outline);
  }

  template <int dim>
  void refuse_pair(const scene::Scene<dim>       &scene,
                   const scene::ContactPair<dim> &pair,
                   const PairSides<dim>          &sides,
                   const double                   reach)
  {
    const std::string normals_remedy = "choose boundaries whose outward normals oppose each other, or move the bodies";
    if (sides.slave.empty() || sides.master.empty())
      throw InputError(between(scene, pair) + " do not face each other anywhere", normals_remedy);
    const auto distance = facing_distance(sides.slave, sides.master);
    if (!distance)
      throw InputError(between(scene, pair) +
                         format(" do not face each other anywhere: the angle between their outward "
                                "normals is %g degrees or less; more than %g is needed",
                                largest_angle(sides.slave, sides.master),
                                degrees(facing_cosine)),
                       normals_remedy);
    auto both = sides.slave;
    both.insert(both.end(), sides.master.begin(), sides.master.end());
    const double any = extent(both);
    const auto   rows =
      mortar_rows(sides.slave, sides.master, {any, any}, scene::ContactDiscretization::mortar, pair.name);
    if (lies_behind(sides, rows))
      refuse_facing_away(scene, pair, rows);
    if (*distance <= corner_on_corner * any && rows.empty())
      throw InputError(between(scene, pair) +
                         " do not meet: they touch in single points, and no normal of the slave hits the master",
                       "move the bodies until the sides overlap, or exchange slave and master");
    if (*distance <= corner_on_corner * any)
      throw InputError(
        between(scene, pair) +
          format(" touch in single points, around which their gap grows beyond the reach of %g mm within "
                 "an element, so that no node has contact",
                 reach),
        "raise " + reach_of(scene, pair) + ", or refine the sides there");
    if (*distance <= reach)
      throw InputError(
        between(scene, pair) +
          format(" are only %g mm apart, but do not lie opposite each other: no normal of the slave hits "
                 "the master within the reach of %g mm",
                 *distance,
                 reach),
        "move the bodies until the sides overlap, or exchange slave and master");
    throw InputError(between(scene, pair) +
                       format(" do not meet within the reach of %g mm along the normals of the slave; "
                              "where they face each other they are %g mm apart",
                              reach,
                              *distance),
                     "raise " + reach_of(scene, pair) + ", move the bodies, or exchange slave and master");
  }

  template <int dim>
  void check_sides(const scene::Scene<dim>           &scene,
                   const mesh::Mesh<dim>             &mesh,
                   const scene::ContactPair<dim>     &pair,
                   const PairSides<dim>              &sides,
                   const Parts<dim>                  &all,
                   const std::vector<MortarRow<dim>> &rows)
  {
    if (lies_behind(sides, rows))
      refuse_facing_away(scene, pair, rows);
    if (pair.reach || pair.gap)
      return;
    double gap = infinity;
    for (const double t : scene.load_factors)
      for (const auto &row : rows)
        gap = std::min(gap, row.gap + pair.offset.value(row.position, t));
    check_automatic_reach(scene,
                          mesh,
                          pair,
                          all,
                          between(scene, pair),
                          std::max(extent(sides.slave), extent(sides.master)),
                          gap);
  }

  template <int dim>
  void check_obstacle_pairs(const scene::Scene<dim>      &scene,
                            const mesh::Mesh<dim>        &mesh,
                            const mechanics::Spaces<dim> &spaces)
  {
    const auto        is_checked = [](const auto &pair) { return !pair.master && !pair.law.is_bonded; };
    std::vector<bool> wanted(scene.bodies.size(), false);
    for (const auto &pair : scene.contacts)
      if (is_checked(pair))
        wanted[pair.slave.body] = true;
    if (std::find(wanted.begin(), wanted.end(), true) == wanted.end())
      return;
    const auto all = mechanics::outlines(mesh, spaces, wanted);
    for (const auto &pair : scene.contacts)
      if (is_checked(pair))
        check_obstacle_pair<dim>(scene, mesh, pair, all);
  }

  template std::string describe(const scene::Scene<2> &, const scene::BoundaryName &);
  template std::string describe(const scene::Scene<3> &, const scene::BoundaryName &);
  template bool        lies_behind(const PairSides<2> &, const std::vector<MortarRow<2>> &);
  template bool        lies_behind(const PairSides<3> &, const std::vector<MortarRow<3>> &);
  template void refuse_pair(const scene::Scene<2> &, const scene::ContactPair<2> &, const PairSides<2> &, const double);
  template void refuse_pair(const scene::Scene<3> &, const scene::ContactPair<3> &, const PairSides<3> &, const double);
  template void check_sides(const scene::Scene<2> &,
                            const mesh::Mesh<2> &,
                            const scene::ContactPair<2> &,
                            const PairSides<2> &,
                            const Parts<2> &,
                            const std::vector<MortarRow<2>> &);
  template void check_sides(const scene::Scene<3> &,
                            const mesh::Mesh<3> &,
                            const scene::ContactPair<3> &,
                            const PairSides<3> &,
                            const Parts<3> &,
                            const std::vector<MortarRow<3>> &);
  template void check_obstacle_pairs(const scene::Scene<2> &, const mesh::Mesh<2> &, const mechanics::Spaces<2> &);
  template void check_obstacle_pairs(const scene::Scene<3> &, const mesh::Mesh<3> &, const mechanics::Spaces<3> &);
} // namespace slipstick::interface
