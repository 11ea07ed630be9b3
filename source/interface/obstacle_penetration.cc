#include <slipstick/base/exceptions.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/interface/obstacle_penetration.h>
#include <slipstick/interface/solid_surface.h>

#include <boost/geometry/algorithms/intersects.hpp>

#include <algorithm>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    // Number of sampling points on an edge, and along each direction of a face, from which the search for the deepest
    // point in an obstacle starts. The search finds it if depths increase towards it, as for balls, cylinders and
    // planes of any size, and corners of polylines and triangulated surfaces; for height functions, peaks that are not
    // much narrower than the spacing of these points.
    constexpr unsigned int n_places = 33, n_places_across = 9;
    // The same for height functions, which may have narrow peaks.
    constexpr unsigned int n_places_below_function = 257, n_places_across_function = 33;
    // The search ends at steps of this fraction of an edge.
    constexpr double least_step = 1e-6;
    // Points of surfaces coincide within this fraction of an edge.
    constexpr double same_place = 1e-3;

    /// Local coordinates of an edge, or of a face in the unit square (triangles are folded into it).
    template <int dim>
    using Place = std::array<double, dim - 1>;

    dealii::Point<2> at_place(const mechanics::SurfaceEdge<2> &edge, const Place<2> &place)
    {
      return edge.point(place[0]);
    }

    dealii::Point<3> at_place(const mechanics::SurfaceFacet &face, const Place<3> &place)
    {
      const auto &[s, t] = place;
      return face.n_corners() == 3 ? face.point({s * (1 - t), t}) : face.point({s, t});
    }

    template <int dim>
    struct DeepPlace
    {
      Place<dim> place{};
      double     depth = -std::numeric_limits<double>::infinity();

      template <class DepthAt>
      bool try_at(const Place<dim> &other, const DepthAt &depth_at)
      {
        const double at_other = depth_at(other);
        if (!(at_other > depth))
          return false;
        place = other;
        depth = at_other;
        return true;
      }
    };

    /// Deepest point of the lattice with n points along each direction.
    template <int dim, class DepthAt>
    DeepPlace<dim> deepest_of_lattice(const unsigned int n, const DepthAt &depth_at)
    {
      DeepPlace<dim> best;
      for (unsigned int i = 0; i < (dim == 2 ? n : n * n); ++i)
        {
          Place<dim> place;
          for (unsigned int d = 0, rest = i; d < dim - 1; ++d, rest /= n)
            place[d] = double(rest % n) / (n - 1);
          best.try_at(place, depth_at);
        }
      return best;
    }

    /// Pattern search for the deepest point with decreasing steps.
    template <int dim, class DepthAt>
    void climb(DeepPlace<dim> &best, double step, const DepthAt &depth_at)
    {
      while (step > least_step)
        {
          bool is_better = false;
          for (unsigned int way = 0; way < (dim == 2 ? 2 : 8); ++way)
            {
              const unsigned int k     = way < 4 ? way : way + 1; // 8 neighbours: of 9 the middle is omitted
              Place<dim>         other = best.place;
              if (dim == 2)
                other[0] += way == 0 ? -step : step;
              else
                for (unsigned int d = 0, rest = k; d < dim - 1; ++d, rest /= 3)
                  other[d] += (int(rest % 3) - 1) * step;
              for (double &coordinate : other)
                coordinate = std::min(1., std::max(0., coordinate));
              is_better = best.try_at(other, depth_at) || is_better;
            }
          if (!is_better)
            step /= 2;
        }
    }

    /// Depth in an obstacle; minus infinity where there is no normal (the centre of a circle). For a height function, a
    /// point is inside if it is below the height: the nearest point found on a narrow bump may be on its far side.
    template <int dim>
    double depth_in_obstacle(const scene::Obstacle<dim> &obstacle, const dealii::Point<dim> &x, const double t)
    {
      try
        {
          if (obstacle.shape != scene::ObstacleShape::function)
            return -contact_with(obstacle, x, t).gap;
          const double below = obstacle.height.value(x, t) - x[1];
          return below <= 0 ? below : std::min(below, std::abs(contact_with(obstacle, x, t).gap));
        }
      catch (const InputError &)
        {
          return -std::numeric_limits<double>::infinity();
        }
    }

    /// Points of an obstacle, each with a ball around it, that show whether an obstacle of any size lies entirely
    /// inside a body: centres, corners, and for a cylinder points on its axis near the slave boundary.
    template <int dim>
    struct PointsOfObstacle
    {
      std::vector<dealii::Point<dim>> points;
      double                          radius = 0;
    };

    PointsOfObstacle<2> points_of(const scene::Obstacle<2> &obstacle)
    {
      if (obstacle.shape == scene::ObstacleShape::circle)
        return {{obstacle.center}, obstacle.radius};
      return {obstacle.shape == scene::ObstacleShape::polyline ? obstacle.points : std::vector<dealii::Point<2>>(), 0.};
    }

    PointsOfObstacle<3> points_of(const scene::Obstacle<3> &obstacle, const std::vector<mechanics::SurfaceFacet> &slave)
    {
      if (obstacle.shape == scene::ObstacleShape::circle)
        return {{obstacle.center}, obstacle.radius};
      if (obstacle.shape == scene::ObstacleShape::stl)
        return {obstacle.surface->corners(), 0.};
      PointsOfObstacle<3> found;
      if (obstacle.shape == scene::ObstacleShape::cylinder)
        {
          found.radius = obstacle.radius;
          for (const auto &part : slave)
            found.points.push_back(obstacle.center +
                                   ((part.middle() - obstacle.center) * obstacle.normal) * obstacle.normal);
        }
      return found;
    }

    double distance_to(const mechanics::SurfaceFacet &facet, const dealii::Point<3> &x)
    {
      const auto nearness = [&](const Place<3> &place) { return -at_place(facet, place).distance(x); };
      auto       best     = deepest_of_lattice<3>(n_places_across, nearness);
      climb<3>(best, 1. / (n_places_across - 1), nearness);
      return -best.depth;
    }
  } // namespace

  template <int dim>
  void find_in_obstacle(const scene::Scene<dim>                         &scene,
                        const scene::ContactPair<dim>                   &pair,
                        const std::vector<mechanics::BoundaryPart<dim>> &slave,
                        const std::vector<mechanics::BoundaryPart<dim>> &now,
                        const double                                     t,
                        std::optional<Penetration>                      &deepest)
  {
    const auto        &obstacle    = scene.obstacles[pair.obstacle];
    const bool         is_function = obstacle.shape == scene::ObstacleShape::function;
    const unsigned int n           = dim == 2 ? (is_function ? n_places_below_function : n_places)
                                              : (is_function ? n_places_across_function : n_places_across);
    for (unsigned int e = 0; e < slave.size(); ++e)
      {
        const auto depth_at = [&](const Place<dim> &place) {
          return depth_in_obstacle(obstacle, at_place(now[e], place), t) -
                 pair.offset.value(at_place(slave[e], place), t);
        };
        auto         best = deepest_of_lattice<dim>(n, depth_at);
        const double step = 1. / (n - 1);
        if (is_function || best.depth > -2 * step * slave[e].chord()) // depths change by no more than the step
          climb<dim>(best, step, depth_at);
        take_deeper(deepest, best.depth, at_place(slave[e], best.place), slave[e].chord(), 0.);
      }
  }

  void find_points_of_obstacle(const scene::Scene<2>       &scene,
                               const mesh::Mesh<2>         &mesh,
                               const scene::ContactPair<2> &pair,
                               const ClosedOutline         &body,
                               const double                 t,
                               std::optional<Penetration>  &deepest)
  {
    const auto [points, radius] = points_of(scene.obstacles[pair.obstacle]);
    for (const auto &point : points)
      if (body.contains(point))
        {
          const auto  there = body.nearest(point);
          const auto &edge  = body.edges[there.edge];
          if (mesh.on_boundary(pair.slave, edge.boundary))
            take_deeper(deepest, there.distance + radius - pair.offset.value(point, t), point, edge.chord(), 0.);
        }
  }

  void find_points_of_obstacle(const scene::Scene<3>                      &scene,
                               const scene::ContactPair<3>                &pair,
                               const std::vector<mechanics::SurfaceFacet> &all,
                               const std::vector<mechanics::SurfaceFacet> &slave,
                               const double                                t,
                               std::optional<Penetration>                 &deepest)
  {
    const auto [points, radius] = points_of(scene.obstacles[pair.obstacle], slave);
    if (points.empty())
      return;
    std::vector<dealii::Point<3>> nodes;
    for (const auto &facet : all)
      for (unsigned int i = 0; i < facet.n_nodes; ++i)
        nodes.push_back(facet.node(i));
    const auto                    box = BoxTree<3>::box_around(nodes);
    std::unique_ptr<SolidSurface> body; // created when needed
    for (const auto &point : points)
      if (boost::geometry::intersects(BoxTree<3>::box_around({point}), box))
        {
          if (!body)
            body = std::make_unique<SolidSurface>(all);
          const double depth = body->depth(point), of_obstacle = depth + radius - pair.offset.value(point, t);
          if (!(depth > 0) || (deepest && of_obstacle <= deepest->depth))
            continue;
          for (const auto &facet : slave)
            if (facet.middle().distance(point) <= depth + 2 * facet.chord() &&
                distance_to(facet, point) <= depth + same_place * facet.chord())
              take_deeper(deepest, of_obstacle, point, facet.chord(), 0.);
        }
  }

  template void find_in_obstacle(const scene::Scene<2> &,
                                 const scene::ContactPair<2> &,
                                 const std::vector<mechanics::BoundaryPart<2>> &,
                                 const std::vector<mechanics::BoundaryPart<2>> &,
                                 const double,
                                 std::optional<Penetration> &);
  template void find_in_obstacle(const scene::Scene<3> &,
                                 const scene::ContactPair<3> &,
                                 const std::vector<mechanics::BoundaryPart<3>> &,
                                 const std::vector<mechanics::BoundaryPart<3>> &,
                                 const double,
                                 std::optional<Penetration> &);
} // namespace slipstick::interface
