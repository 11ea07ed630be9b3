#include <slipstick/base/log.h>
#include <slipstick/mechanics/points.h>
#include <slipstick/mechanics/surface.h>
#include <slipstick/output/scene_picture.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace slipstick::output
{
  namespace
  {
    using Point = dealii::Point<2>;

    // Of the drawing [pixels]: longer side, border, width of the legend and distance of its lines.
    constexpr double drawing_size = 900, border = 40, legend_width = 320, line_distance = 20;
    // Meshes with more cells would be drawn black.
    constexpr unsigned int max_drawn_cells = 20000;
    // Arrows a load, about, and the length of the longest one [pixels].
    constexpr unsigned int arrows_of_load = 12;
    constexpr double       arrow_length   = 45;
    // A height function is drawn by this many pieces.
    constexpr unsigned int pieces_of_function = 200;

    struct Style
    {
      const char *kind, *colour;
      double      width;   // [pixels]
      const char *pattern; // dashes
    };
    constexpr std::array<Style, 6> styles = {{{"support", "#1a7f37", 4, ""},
                                              {"foundation", "#0b7285", 4, "2 4"},
                                              {"traction", "#d1242f", 4, ""},
                                              {"point load", "#d1242f", 4, ""},
                                              {"contact, slave", "#bc6c00", 2.5, ""},
                                              {"contact, master", "#8250df", 6, ""}}};

    const Style &style_of(const std::string &kind)
    {
      return *std::find_if(styles.begin(), styles.end(), [&kind](const Style &style) { return kind == style.kind; });
    }

    std::string escaped(const std::string &text)
    {
      std::string result;
      for (const char c : text)
        result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
      return result;
    }

    /// From the scene [mm] to the picture [pixels], y downwards.
    struct View
    {
      Point  low, high;
      double scale;

      explicit View(const std::vector<mechanics::SurfaceEdge<2>> &outlines)
        : low(outlines.front().node(0))
        , high(low)
      {
        for (const auto &edge : outlines)
          for (unsigned int i = 0; i < edge.n_nodes; ++i)
            for (unsigned int d = 0; d < 2; ++d)
              {
                low[d]  = std::min(low[d], edge.at[i][d]);
                high[d] = std::max(high[d], edge.at[i][d]);
              }
        scale = drawing_size / std::max(high[0] - low[0], high[1] - low[1]);
      }

      double x(const Point &p) const
      {
        return border + (p[0] - low[0]) * scale;
      }
      double y(const Point &p) const
      {
        return border + (high[1] - p[1]) * scale;
      }
      std::string at(const Point &p) const
      {
        return format("%.2f %.2f", x(p), y(p));
      }
      double width() const
      {
        return 2 * border + (high[0] - low[0]) * scale;
      }
      double height() const
      {
        return 2 * border + (high[1] - low[1]) * scale;
      }
    };

    std::string path_of(const mechanics::SurfaceEdge<2> &edge, const View &view)
    {
      std::string text = "M" + view.at(edge.node(0));
      if (edge.n_nodes == 3)
        text += "L" + view.at(edge.node(2));
      return text + "L" + view.at(edge.node(1));
    }

    /// Corners of the cells of all ranks on rank 0; nothing where there are too many.
    std::vector<std::vector<Point>> cells_of(const mesh::Mesh<2> &mesh)
    {
      std::vector<std::vector<Point>> cells;
      if (mesh.n_cells > max_drawn_cells)
        return cells;
      std::vector<double> own; // number of corners, then these
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
      for (const auto &of_rank : dealii::Utilities::MPI::gather(mesh.comm, own))
        for (auto next = of_rank.begin(); next != of_rank.end();)
          {
            cells.emplace_back();
            for (double n = *next++; n > 0; --n, next += 2)
              cells.back().emplace_back(next[0], next[1]);
          }
      return cells;
    }

    /// A load at a place: where it is largest among the load steps.
    struct Arrow
    {
      Point                tip;
      dealii::Tensor<1, 2> load;
    };

    template <class LoadAt>
    dealii::Tensor<1, 2> largest(const std::vector<double> &load_factors, const LoadAt &load_at)
    {
      dealii::Tensor<1, 2> result;
      for (const double t : load_factors)
        if (const auto load = load_at(t); load.norm() > result.norm())
          result = load;
      return result;
    }

    class Picture
    {
    public:
      Picture(std::ostream &out_, const View &view_)
        : out(out_)
        , view(view_)
      {}

      void named(const std::string &kind, const std::string &name, const std::vector<mechanics::SurfaceEdge<2>> &edges)
      {
        const Style &style = style_of(kind);
        out << "<path class=\"" << kind << "\" fill=\"none\" stroke-linecap=\"round\" stroke=\"" << style.colour
            << "\" stroke-width=\"" << style.width << "\" stroke-dasharray=\"" << style.pattern << "\" d=\"";
        for (const auto &edge : edges)
          out << path_of(edge, view);
        out << "\"><title>" << escaped(kind + " " + name) << "</title></path>\n";
        legend.emplace_back(&style, kind + " " + name);
      }

      void named(const std::string &kind, const std::string &name, const Point &point)
      {
        const Style &style = style_of(kind);
        out << "<circle class=\"" << kind << "\" r=\"6\" fill=\"" << style.colour
            << format("\" cx=\"%.2f\" cy=\"%.2f\"", view.x(point), view.y(point)) << "><title>"
            << escaped(kind + " " + name) << "</title></circle>\n";
        legend.emplace_back(&style, kind + " " + name);
      }

      /// All of one kind of load, in proportion to each other.
      void arrows(const std::vector<Arrow> &all)
      {
        double longest = 0;
        for (const auto &arrow : all)
          longest = std::max(longest, arrow.load.norm());
        for (const auto &arrow : all)
          if (arrow.load.norm() > 0)
            {
              const auto   along = arrow_length / longest * arrow.load;
              const double x = view.x(arrow.tip), y = view.y(arrow.tip);
              out << format("<path class=\"arrow\" stroke=\"#d1242f\" stroke-width=\"1.5\" marker-end=\"url(#tip)\" "
                            "d=\"M%.2f %.2fL%.2f %.2f\"/>\n",
                            x - along[0],
                            y + along[1],
                            x,
                            y);
            }
      }

      void write_legend() const
      {
        double y = border;
        for (const auto &[style, text] : legend)
          {
            out << format("<path stroke=\"%s\" stroke-width=\"4\" stroke-dasharray=\"%s\" d=\"M%.2f %.2fh24\"/>",
                          style->colour,
                          style->pattern,
                          view.width(),
                          y)
                << format("<text x=\"%.2f\" y=\"%.2f\">", view.width() + 32, y + 5) << escaped(text) << "</text>\n";
            y += line_distance;
          }
      }

    private:
      std::ostream                                      &out;
      const View                                        &view;
      std::vector<std::pair<const Style *, std::string>> legend;
    };

    void draw(std::ostream &out, const View &view, const scene::Obstacle<2> &obstacle, const double t)
    {
      const std::string look = "class=\"obstacle\" fill=\"none\" stroke=\"#57606a\" stroke-width=\"3\"";
      std::string       path;
      if (obstacle.shape == scene::ObstacleShape::circle || obstacle.shape == scene::ObstacleShape::hole)
        {
          out << "<circle " << look
              << format(" cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"/>\n",
                        view.x(obstacle.center),
                        view.y(obstacle.center),
                        obstacle.radius * view.scale);
          return;
        }
      if (obstacle.shape == scene::ObstacleShape::half_plane)
        {
          const dealii::Tensor<1, 2> along =
            view.low.distance(view.high) * Point(-obstacle.normal[1], obstacle.normal[0]);
          path = "M" + view.at(obstacle.center - along) + "L" + view.at(obstacle.center + along);
        }
      for (const auto &point : obstacle.points)
        path += (path.empty() ? "M" : "L") + view.at(point);
      if (obstacle.shape == scene::ObstacleShape::function)
        for (unsigned int k = 0; k <= pieces_of_function; ++k)
          {
            const double x = view.low[0] + (view.high[0] - view.low[0]) * k / pieces_of_function;
            path += (k == 0 ? "M" : "L") + view.at(Point(x, obstacle.height.value(Point(x, 0), t)));
          }
      out << "<path " << look << " d=\"" << path << "\"/>\n";
    }
  } // namespace

  void write_scene_picture(const OutputDirectory      &directory,
                           const std::string          &file,
                           const scene::Scene<2>      &scene,
                           const mesh::Mesh<2>        &mesh,
                           const mechanics::Spaces<2> &spaces)
  {
    const auto outlines = mechanics::outlines(mesh, spaces, std::vector<bool>(scene.bodies.size(), true));
    const auto cells    = cells_of(mesh);

    std::vector<scene::PointName<2>> points;
    std::vector<std::string>         owners;
    for (const auto &support : scene.supports)
      if (support.point)
        {
          points.push_back(*support.point);
          owners.push_back("Support " + support.name);
        }
    for (const auto &load : scene.point_loads)
      {
        points.push_back(load.where);
        owners.push_back("Point load " + load.name);
      }
    const auto nodes = mechanics::nodes_at(scene, mesh, spaces, points, owners);

    directory.write_from_root(file, [&](std::ostream &out) {
      const View        view(outlines);
      const std::size_t n_lines = scene.supports.size() + scene.foundations.size() + scene.tractions.size() +
                                  scene.point_loads.size() + 2 * scene.contacts.size();
      const auto on = [&](const scene::BoundaryName &where) { return mechanics::edges_on(mesh, outlines, where); };
      out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
          << "font-family=\"sans-serif\" font-size=\"14\" "
          << format("width=\"%.0f\" height=\"%.0f\">\n",
                    view.width() + legend_width,
                    std::max(view.height(), 2 * border + line_distance * n_lines))
          << "<defs><marker id=\"tip\" orient=\"auto\" markerWidth=\"8\" markerHeight=\"8\" refX=\"7\" refY=\"4\">"
          << "<path d=\"M0 1L8 4L0 7z\" fill=\"#d1242f\"/></marker></defs>\n"
          << "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
          << "<path class=\"mesh\" fill=\"#eaeef2\" stroke=\"#c0c8d0\" stroke-width=\"0.5\" d=\"";
      for (const auto &cell : cells)
        {
          for (std::size_t k = 0; k < cell.size(); ++k)
            out << (k == 0 ? "M" : "L") << view.at(cell[k]);
          out << 'z';
        }
      out << "\"/>\n<path class=\"outline\" fill=\"none\" stroke=\"#24292f\" stroke-width=\"1.5\" d=\"";
      for (const auto &edge : outlines)
        out << path_of(edge, view);
      out << "\"/>\n";
      for (const auto &obstacle : scene.obstacles)
        draw(out, view, obstacle, scene.load_factors.front());

      Picture picture(out, view);
      for (const auto &pair : scene.contacts)
        {
          if (pair.master) // below: the two often coincide
            picture.named("contact, master", pair.name, on(*pair.master));
          picture.named("contact, slave", pair.name, on(pair.slave));
        }
      unsigned int next = 0;
      for (const auto &support : scene.supports)
        if (support.point)
          picture.named("support", support.name, nodes[next++].position);
        else
          picture.named("support", support.name, on(support.where));
      for (const auto &foundation : scene.foundations)
        picture.named("foundation", foundation.name, on(foundation.where));
      std::vector<Arrow> arrows;
      for (const auto &traction : scene.tractions)
        {
          const auto edges = on(traction.where);
          picture.named("traction", traction.name, edges);
          const std::size_t stride = 1 + edges.size() / arrows_of_load;
          for (std::size_t k = stride / 2; k < edges.size(); k += stride)
            {
              const auto place = edges[k].point(0.5);
              arrows.push_back({place, largest(scene.load_factors, [&](const double t) {
                                  return Point(traction.components[0].value(place, t),
                                               traction.components[1].value(place, t)) -
                                         traction.pressure.value(place, t) * edges[k].normal(0.5);
                                })});
            }
        }
      picture.arrows(arrows);
      arrows.clear();
      for (const auto &load : scene.point_loads)
        {
          const auto place = nodes[next++].position;
          picture.named("point load", load.name, place);
          arrows.push_back({place, largest(scene.load_factors, [&](const double t) {
                              return dealii::Tensor<1, 2>(
                                Point(load.force[0].value(place, t), load.force[1].value(place, t)));
                            })});
        }
      picture.arrows(arrows);
      picture.write_legend();
      out << "</svg>\n";
    });
  }
} // namespace slipstick::output
