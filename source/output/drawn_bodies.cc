#include <slipstick/base/across.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/log.h>
#include <slipstick/output/drawn_bodies.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/numbers.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

namespace slipstick::output
{
  namespace
  {
    using Plane  = dealii::Point<2>;
    using Vector = dealii::Tensor<1, 3>;

    // Larger meshes would be drawn as a black area.
    constexpr unsigned int max_drawn_cells = 20000;
    // Number of segments of a height function, and of a circle in space.
    constexpr unsigned int pieces_of_function = 200, pieces_of_circle = 60;
    // Brightness of faces: of an unlit one, and the increment by light (255 is white).
    constexpr double dark = 175, light = 65;

    constexpr char obstacle_look[] = "class=\"obstacle\" fill=\"none\" stroke=\"#57606a\" stroke-width=\"3\"";

    struct Axes
    {
      Vector right, up, towards; // unit vectors; the last one points towards the viewer
    };

    const Axes &axes_in_space()
    {
      static const Axes axes = [] {
        Axes   made;
        Vector vertical;
        vertical[1]  = 1;
        made.towards = dealii::Point<3>(0.55, 0.45, 1); // as in scripts/results/solids.py
        made.towards /= made.towards.norm();
        made.right = dealii::cross_product_3d(vertical, made.towards);
        made.right /= made.right.norm();
        made.up = dealii::cross_product_3d(made.towards, made.right);
        return made;
      }();
      return axes;
    }

    /// Corners of the cells of all ranks on rank 0; empty if there are too many cells.
    std::vector<std::vector<Plane>> cells_of(const mesh::Mesh<2> &mesh)
    {
      std::vector<std::vector<Plane>> cells;
      if (mesh.n_cells > max_drawn_cells)
        return cells;
      std::vector<double> own; // number of corners, followed by the corners
      for (const auto &subdomain : mesh.subdomains)
        for (const auto &cell : subdomain->triangulation.active_cell_iterators())
          {
            constexpr std::array<unsigned int, 4> around = {{0, 1, 3, 2}};
            const unsigned int                    n      = cell->n_vertices();
            own.push_back(n);
            for (unsigned int k = 0; k < n; ++k)
              for (unsigned int d = 0; d < 2; ++d)
                own.push_back(cell->vertex(n == 4 ? around[k] : k)[d]);
          }
      for (const auto &of_rank : gather(mesh.comm, own))
        for (auto next = of_rank.begin(); next != of_rank.end();)
          {
            cells.emplace_back();
            for (double n = *next++; n > 0; --n, next += 2)
              cells.back().emplace_back(next[0], next[1]);
          }
      return cells;
    }

    std::string grey(const double brightness)
    {
      const int level = std::lround(brightness);
      return format("#%02x%02x%02x", level, level, level);
    }

    /// Circle (or ellipse) around a centre, spanned by two vectors.
    std::vector<Plane> circle(const dealii::Point<3> &centre, const Vector &first, const Vector &second)
    {
      std::vector<Plane> points;
      for (unsigned int k = 0; k <= pieces_of_circle; ++k)
        {
          const double angle = 2 * dealii::numbers::PI * k / pieces_of_circle;
          points.push_back(Projection<3>()(centre + std::cos(angle) * first + std::sin(angle) * second));
        }
      return points;
    }

    void write_path(std::ostream &out, const std::string &path)
    {
      out << "<path " << obstacle_look << " d=\"" << path << "\"/>\n";
    }

    void write_circle(std::ostream &out, const View &view, const Plane &centre, const double radius)
    {
      out << "<circle " << obstacle_look
          << format(" cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"/>\n", view.x(centre), view.y(centre), radius * view.scale);
    }
  } // namespace

  template <>
  Plane Projection<2>::operator()(const Plane &p) const
  {
    return p;
  }

  template <>
  Plane Projection<3>::operator()(const dealii::Point<3> &p) const
  {
    return Plane(p * axes_in_space().right, p * axes_in_space().up);
  }

  template <>
  dealii::Tensor<1, 2> Projection<2>::along(const dealii::Tensor<1, 2> &v) const
  {
    return v;
  }

  template <>
  dealii::Tensor<1, 2> Projection<3>::along(const Vector &v) const
  {
    return Plane(v * axes_in_space().right, v * axes_in_space().up);
  }

  template <>
  double Projection<3>::nearness(const dealii::Point<3> &p) const
  {
    return p * axes_in_space().towards;
  }

  std::vector<Plane> seen(const mechanics::SurfaceEdge<2> &edge)
  {
    if (edge.n_nodes == 3)
      return {edge.node(0), edge.node(2), edge.node(1)};
    return {edge.node(0), edge.node(1)};
  }

  std::vector<Plane> seen(const mechanics::SurfaceFacet &facet)
  {
    std::vector<Plane> corners;
    for (unsigned int i = 0; i < facet.n_corners(); ++i)
      corners.push_back(Projection<3>()(facet.node(i)));
    return corners;
  }

  DrawnBodies::DrawnBodies(const mesh::Mesh<2> &mesh, const std::vector<mechanics::SurfaceEdge<2>> &outlines)
    : cells(cells_of(mesh))
  {
    for (const auto &edge : outlines)
      edges.push_back(seen(edge));
  }

  DrawnBodies::DrawnBodies(const mesh::Mesh<3> &, const std::vector<mechanics::SurfaceFacet> &outlines)
  {
    const Axes                                                     &axes = axes_in_space();
    std::vector<std::pair<double, const mechanics::SurfaceFacet *>> shown;
    for (const auto &facet : outlines)
      if (mechanics::middle_normal(facet) * axes.towards > 0)
        shown.emplace_back(Projection<3>().nearness(facet.middle()), &facet);
    std::stable_sort(shown.begin(), shown.end(), [](const auto &a, const auto &b) { return a.first < b.first; });
    for (const auto &entry : shown)
      {
        const double lit = mechanics::middle_normal(*entry.second) * (axes.up + axes.towards) / std::sqrt(2.);
        faces.push_back({seen(*entry.second), grey(dark + light * std::max(0., lit))});
      }
  }

  void DrawnBodies::write(std::ostream &out, const View &view) const
  {
    if (!faces.empty())
      {
        out << "<g class=\"outline\" stroke=\"#57606a\" stroke-linejoin=\"round\" stroke-width=\""
            << (faces.size() > max_drawn_cells ? 0. : 0.4) << "\">\n";
        for (const Polygon &face : faces)
          out << "<path fill=\"" << face.colour << "\" d=\"" << view.path(face.corners) << "z\"/>\n";
        out << "</g>\n";
        return;
      }
    out << "<path class=\"mesh\" fill=\"#eaeef2\" stroke=\"#c0c8d0\" stroke-width=\"0.5\" d=\"";
    for (const auto &cell : cells)
      out << view.path(cell) << 'z';
    out << "\"/>\n<path class=\"outline\" fill=\"none\" stroke=\"#24292f\" stroke-width=\"1.5\" d=\"";
    for (const auto &edge : edges)
      out << view.path(edge);
    out << "\"/>\n";
  }

  bool draw_obstacle(std::ostream &out, const View &view, const scene::Obstacle<2> &obstacle, const double t)
  {
    std::string path;
    if (obstacle.shape == scene::ObstacleShape::circle || obstacle.shape == scene::ObstacleShape::hole)
      {
        write_circle(out, view, obstacle.center, obstacle.radius);
        return true;
      }
    if (obstacle.shape == scene::ObstacleShape::half_plane)
      {
        const dealii::Tensor<1, 2> along =
          view.low.distance(view.high) * Plane(-obstacle.normal[1], obstacle.normal[0]);
        path = view.path({obstacle.center - along, obstacle.center + along});
      }
    path += view.path(obstacle.points);
    if (obstacle.shape == scene::ObstacleShape::function)
      {
        std::vector<Plane> points;
        for (unsigned int k = 0; k <= pieces_of_function; ++k)
          {
            const double x = view.low[0] + (view.high[0] - view.low[0]) * k / pieces_of_function;
            points.emplace_back(x, obstacle.height.value(Plane(x, 0), t));
          }
        path += view.path(points);
      }
    write_path(out, path);
    return true;
  }

  bool draw_obstacle(std::ostream &out, const View &view, const scene::Obstacle<3> &obstacle, const double)
  {
    using scene::ObstacleShape;
    if (obstacle.shape == ObstacleShape::circle || obstacle.shape == ObstacleShape::hole)
      {
        write_circle(out, view, Projection<3>()(obstacle.center), obstacle.radius);
        return true;
      }
    const bool is_plane = obstacle.shape == ObstacleShape::half_plane;
    if (!is_plane && obstacle.shape != ObstacleShape::cylinder && obstacle.shape != ObstacleShape::bore)
      return false;
    // A disc in the plane, as large as the scene; or both ends of a piece of the cylinder.
    const double size   = view.low.distance(view.high) / 2;
    const double radius = is_plane ? size : obstacle.radius;
    const auto   sides  = across(obstacle.normal);
    const Vector first = radius * sides[0], second = radius * sides[1];
    if (is_plane)
      {
        write_path(out, view.path(circle(obstacle.center, first, second)));
        return true;
      }
    std::array<dealii::Point<3>, 2> ends = {
      {obstacle.center - size * obstacle.normal, obstacle.center + size * obstacle.normal}};
    std::string path;
    for (const auto &end : ends)
      path += view.path(circle(end, first, second));
    Vector silhouette = dealii::cross_product_3d(obstacle.normal, axes_in_space().towards);
    if (silhouette.norm() > 0)
      for (const double side : {-obstacle.radius, obstacle.radius})
        path += view.path({Projection<3>()(ends[0] + side / silhouette.norm() * silhouette),
                           Projection<3>()(ends[1] + side / silhouette.norm() * silhouette)});
    write_path(out, path);
    return true;
  }
} // namespace slipstick::output
