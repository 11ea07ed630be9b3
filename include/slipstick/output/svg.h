// Elements of a picture of the scene (SVG): lines, arrows, labels, a legend.
#pragma once

#include <deal.II/base/point.h>

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace slipstick::output
{
  /// Line style of one kind of object.
  struct DrawingStyle
  {
    const char *kind, *colour; // colour: #rrggbb
    double      width;         // [pixels]
    const char *pattern;       // dashes
  };

  /// @param kind support, foundation, traction, point load, body force, temperature, pretension, probe,
  /// "contact, slave" or "contact, master".
  const DrawingStyle &drawing_style(const std::string &kind);

  /// Mapping from a plane [mm] to the picture [pixels], y downwards.
  struct View
  {
    dealii::Point<2> low, high; // bounding box of the drawing [mm]
    double           scale;     // [pixels/mm]

    View(const dealii::Point<2> &low, const dealii::Point<2> &high);

    double      x(const dealii::Point<2> &p) const;
    double      y(const dealii::Point<2> &p) const;
    std::string at(const dealii::Point<2> &p) const;                     // "X Y"
    std::string path(const std::vector<dealii::Point<2>> &points) const; // "MX YLX Y..."
    double      width() const;                                           // [pixels]
    double      height() const;
  };

  /// A load at a point of the picture.
  struct LoadArrow
  {
    dealii::Point<2>     place;
    dealii::Tensor<1, 2> load;                 // projected
    double               size         = 0;     // magnitude before projection
    bool                 begins_there = false; // the arrow starts at the point; otherwise it ends there
  };

  /// A picture, from its first line to finish(). Names are written as tooltips, and in the legend if in_legend() was
  /// called.
  class ScenePicture
  {
  public:
    /// @param n_names maximum number of names in the legend.
    ScenePicture(std::ostream &out, const View &view, const std::size_t n_names);

    /// Objects written between these two calls are clipped to the drawing area, without the legend.
    void begin_clipped() const;
    void end_clipped() const;

    void lines(const std::string &kind, const std::string &name, const std::string &path);
    void areas(const std::string &kind, const std::string &name, const std::string &path); // transparent
    void dot(const std::string      &kind,
             const std::string      &name,
             const dealii::Point<2> &point,
             const double            radius = 6); // [pixels]
    void label(const std::string      &kind,
               const std::string      &name,
               const dealii::Point<2> &point,
               const std::string      &text);

    /// An arrow around an axis perpendicular to the picture.
    void turning(const std::string &kind, const std::string &name, const dealii::Point<2> &axis);

    /// All arrows of one kind of load, drawn to the same scale.
    void arrows(const std::string &kind, const std::vector<LoadArrow> &all);

    void in_legend(const std::string &kind, const std::string &name);

    /// Writes the legend and the end of the file.
    void finish() const;

  private:
    std::ostream                                             &out;
    const View                                               &view;
    std::vector<std::pair<const DrawingStyle *, std::string>> legend;
  };
} // namespace slipstick::output
