#include <slipstick/base/log.h>
#include <slipstick/output/svg.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

namespace slipstick::output
{
  namespace
  {
    // Dimensions of the drawing [pixels]: longer side, border, width of the legend and line spacing.
    constexpr double drawing_size = 900, border = 40, legend_width = 320, line_distance = 20;
    // Length of the longest arrow of a load, and radius of an arrow around an axis [pixels].
    constexpr double arrow_length = 45, turning_radius = 24;

    // Offset of a label, above and to the right of its point [pixels].
    constexpr double label_distance = 10;
    // Objects behind remain visible.
    constexpr double fill_opacity = 0.3;

    constexpr std::array<DrawingStyle, 10> styles = {{{"support", "#1a7f37", 4, ""},
                                                      {"foundation", "#0b7285", 4, "2 4"},
                                                      {"traction", "#d1242f", 4, ""},
                                                      {"point load", "#d1242f", 4, ""},
                                                      {"body force", "#d1242f", 2, "6 3"},
                                                      {"temperature", "#e8590c", 4, ""},
                                                      {"pretension", "#bf3989", 2, "10 3 2 3"},
                                                      {"contact, slave", "#bc6c00", 2.5, ""},
                                                      {"contact, master", "#8250df", 6, ""},
                                                      {"probe", "#24292f", 1.5, "2 3"}}};

    std::string escaped(const std::string &text)
    {
      std::string result;
      for (const char c : text)
        result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
      return result;
    }

    std::string title(const std::string &kind, const std::string &name)
    {
      return "<title>" + escaped(kind + " " + name) + "</title>";
    }
  } // namespace

  const DrawingStyle &drawing_style(const std::string &kind)
  {
    return *std::find_if(styles.begin(), styles.end(), [&kind](const auto &style) { return kind == style.kind; });
  }

  View::View(const dealii::Point<2> &low_, const dealii::Point<2> &high_)
    : low(low_)
    , high(high_)
    , scale(drawing_size / std::max(high[0] - low[0], high[1] - low[1]))
  {}

  double View::x(const dealii::Point<2> &p) const
  {
    return border + (p[0] - low[0]) * scale;
  }

  double View::y(const dealii::Point<2> &p) const
  {
    return border + (high[1] - p[1]) * scale;
  }

  std::string View::at(const dealii::Point<2> &p) const
  {
    return format("%.2f %.2f", x(p), y(p));
  }

  std::string View::path(const std::vector<dealii::Point<2>> &points) const
  {
    std::string text;
    for (const auto &point : points)
      text += (text.empty() ? "M" : "L") + at(point);
    return text;
  }

  double View::width() const
  {
    return 2 * border + (high[0] - low[0]) * scale;
  }

  double View::height() const
  {
    return 2 * border + (high[1] - low[1]) * scale;
  }

  ScenePicture::ScenePicture(std::ostream &out_, const View &view_, const std::size_t n_names)
    : out(out_)
    , view(view_)
  {
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
        << "font-family=\"sans-serif\" font-size=\"14\" "
        << format("width=\"%.0f\" height=\"%.0f\">\n<defs>",
                  view.width() + legend_width,
                  std::max(view.height(), 2 * border + line_distance * n_names));
    for (const char *kind : {"traction", "pretension"})
      out << "<marker id=\"tip-" << drawing_style(kind).colour + 1
          << "\" orient=\"auto\" markerWidth=\"8\" markerHeight=\"8\" refX=\"7\" refY=\"4\">"
          << "<path d=\"M0 1L8 4L0 7z\" fill=\"" << drawing_style(kind).colour << "\"/></marker>";
    out << format("<clipPath id=\"drawing\"><rect width=\"%.2f\" height=\"100%%\"/></clipPath>",
                  view.width() - border / 4)
        << "</defs>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  }

  void ScenePicture::begin_clipped() const
  {
    out << "<g clip-path=\"url(#drawing)\">\n";
  }

  void ScenePicture::end_clipped() const
  {
    out << "</g>\n";
  }

  void ScenePicture::lines(const std::string &kind, const std::string &name, const std::string &path)
  {
    const DrawingStyle &style = drawing_style(kind);
    out << "<path class=\"" << kind << "\" fill=\"none\" stroke-linecap=\"round\" stroke=\"" << style.colour
        << "\" stroke-width=\"" << style.width << "\" stroke-dasharray=\"" << style.pattern << "\" d=\"" << path
        << "\">" << title(kind, name) << "</path>\n";
  }

  void ScenePicture::areas(const std::string &kind, const std::string &name, const std::string &path)
  {
    const char *colour = drawing_style(kind).colour;
    out << "<path class=\"" << kind << "\" stroke-linejoin=\"round\" stroke-width=\"0.6\" stroke=\"" << colour
        << "\" fill=\"" << colour << "\" fill-opacity=\"" << fill_opacity << "\" d=\"" << path << "\">"
        << title(kind, name) << "</path>\n";
  }

  void ScenePicture::dot(const std::string      &kind,
                         const std::string      &name,
                         const dealii::Point<2> &point,
                         const double            radius)
  {
    out << "<circle class=\"" << kind
        << format("\" r=\"%g\" fill=\"%s\" cx=\"%.2f\" cy=\"%.2f\">",
                  radius,
                  drawing_style(kind).colour,
                  view.x(point),
                  view.y(point))
        << title(kind, name) << "</circle>\n";
  }

  void ScenePicture::label(const std::string      &kind,
                           const std::string      &name,
                           const dealii::Point<2> &point,
                           const std::string      &text)
  {
    out << format("<g class=\"%s\" stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\" fill=\"%s\">",
                  kind.c_str(),
                  drawing_style(kind).colour)
        << title(kind, name)
        << format("<text class=\"label\" font-weight=\"bold\" x=\"%.2f\" y=\"%.2f\">",
                  view.x(point) + label_distance,
                  view.y(point) - label_distance)
        << escaped(text) << "</text></g>\n";
  }

  void ScenePicture::turning(const std::string &kind, const std::string &name, const dealii::Point<2> &axis)
  {
    const double x = view.x(axis), y = view.y(axis), r = turning_radius, half = r * std::sqrt(0.5);
    out
      << format("<path class=\"turning\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" marker-end=\"url(#tip-%s)\" "
                "d=\"M%.2f %.2fh10m-5 -5v10M%.2f %.2fA%g %g 0 1 0 %.2f %.2f\">",
                drawing_style(kind).colour,
                drawing_style(kind).colour + 1,
                x - 5,
                y,
                x + half,
                y + half,
                r,
                r,
                x - half,
                y + half)
      << title(kind, name) << "</path>\n";
  }

  void ScenePicture::arrows(const std::string &kind, const std::vector<LoadArrow> &all)
  {
    double longest = 0;
    for (const auto &arrow : all)
      longest = std::max(longest, arrow.size);
    for (const auto &arrow : all)
      if (arrow.size > 0)
        {
          const auto   along = arrow_length / longest * arrow.load;
          const double x     = view.x(arrow.place) + (arrow.begins_there ? along[0] : 0);
          const double y     = view.y(arrow.place) - (arrow.begins_there ? along[1] : 0);
          out << format("<path class=\"arrow\" stroke=\"%s\" stroke-width=\"1.5\" marker-end=\"url(#tip-%s)\" "
                        "d=\"M%.2f %.2fL%.2f %.2f\"/>\n",
                        drawing_style(kind).colour,
                        drawing_style(kind).colour + 1,
                        x - along[0],
                        y + along[1],
                        x,
                        y);
        }
  }

  void ScenePicture::in_legend(const std::string &kind, const std::string &name)
  {
    const std::pair<const DrawingStyle *, std::string> entry(&drawing_style(kind), kind + " " + name);
    if (std::find(legend.begin(), legend.end(), entry) == legend.end())
      legend.push_back(entry);
  }

  void ScenePicture::finish() const
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
    out << "</svg>\n";
  }
} // namespace slipstick::output
