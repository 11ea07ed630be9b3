// What drawings of a scene are made of (SVG): lines, arrows, labels, a legend.
#pragma once

#include <deal.II/base/point.h>

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace slipstick::output
{
  /// How one kind of thing is drawn.
  struct DrawingStyle
  {
    const char *kind, *colour; // colour: #rrggbb
    double      width;         // [pixels]
    const char *pattern;       // dashes
  };

  /// @param kind support, foundation, traction, point load, body force, temperature, pretension, probe,
  /// "contact, slave" or "contact, master".
  const DrawingStyle &drawing_style(const std::string &kind);

  /// From a plane [mm] to the picture [pixels], y downwards.
  struct View
  {
    dealii::Point<2> low, high; // of what is drawn [mm]
    double           scale;     // [pixels/mm]

    View(const dealii::Point<2> &low, const dealii::Point<2> &high);

    double      x(const dealii::Point<2> &p) const;
    double      y(const dealii::Point<2> &p) const;
    std::string at(const dealii::Point<2> &p) const;                     // "X Y"
    std::string path(const std::vector<dealii::Point<2>> &points) const; // "MX YLX Y..."
    double      width() const;                                           // [pixels]
    double      height() const;
  };

  /// A load at a place of the picture.
  struct LoadArrow
  {
    dealii::Point<2>     place;
    dealii::Tensor<1, 2> load;                 // as seen
    double               size         = 0;     // its length before it was seen from one side
    bool                 begins_there = false; // else it ends there
  };

  /// A picture under way, from its first line to finish(). Names stand as tooltips, and in the legend if in_legend() was called.
  class ScenePicture
  {
  public:
    /// @param n_names in the legend, at most.
    ScenePicture(std::ostream &out, const View &view, const std::size_t n_names);

    /// What is written between the two ends at the edge of the drawing, before the legend.
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

    /// An arrow around an axis that is seen as a point.
    void turning(const std::string &kind, const std::string &name, const dealii::Point<2> &axis);

    /// All of one kind of load, in proportion to each other.
    void arrows(const std::string &kind, const std::vector<LoadArrow> &all);

    void in_legend(const std::string &kind, const std::string &name);

    /// The legend and the end of the file.
    void finish() const;

  private:
    std::ostream                                             &out;
    const View                                               &view;
    std::vector<std::pair<const DrawingStyle *, std::string>> legend;
  };
} // namespace slipstick::output
