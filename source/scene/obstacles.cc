#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>
#include <slipstick/scene/stl_file.h>
#include <slipstick/scene/triangulated_surface.h>

#include <cmath>
#include <numeric>
#include <optional>
#include <sstream>

namespace slipstick::scene
{
  namespace
  {
    /// Whether the segments a-b and c-d have a point in common.
    bool meet(const dealii::Point<2> &a,
              const dealii::Point<2> &b,
              const dealii::Point<2> &c,
              const dealii::Point<2> &d)
    {
      const auto side = [](const dealii::Point<2> &p, const dealii::Point<2> &q, const dealii::Point<2> &x) {
        return (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0]);
      };
      for (unsigned int k = 0; k < 2; ++k) // disjoint bounding boxes, e.g. of segments on one line
        if (std::max(a[k], b[k]) < std::min(c[k], d[k]) || std::max(c[k], d[k]) < std::min(a[k], b[k]))
          return false;
      const double c_side = side(a, b, c), d_side = side(a, b, d), a_side = side(c, d, a), b_side = side(c, d, b);
      return !(c_side > 0 && d_side > 0) && !(c_side < 0 && d_side < 0) && !(a_side > 0 && b_side > 0) &&
             !(a_side < 0 && b_side < 0);
    }

    /// The first two edges of a polyline that intersect other than at the common end of neighbours.
    std::optional<std::pair<std::size_t, std::size_t>> first_crossing(const std::vector<dealii::Point<2>> &points)
    {
      const std::size_t        n         = points.size() - 1;
      const bool               is_closed = n > 2 && points.front().distance(points.back()) == 0;
      std::vector<std::size_t> by_left(n);
      std::iota(by_left.begin(), by_left.end(), std::size_t(0));
      const auto left  = [&](const std::size_t e) { return std::min(points[e][0], points[e + 1][0]); };
      const auto right = [&](const std::size_t e) { return std::max(points[e][0], points[e + 1][0]); };
      std::sort(by_left.begin(), by_left.end(), [&](const auto e, const auto f) { return left(e) < left(f); });
      for (std::size_t k = 0; k < n; ++k)
        for (std::size_t l = k + 1; l < n && left(by_left[l]) <= right(by_left[k]); ++l)
          {
            const std::size_t e = std::min(by_left[k], by_left[l]), f = std::max(by_left[k], by_left[l]);
            if (f == e + 1 || (is_closed && e == 0 && f == n - 1)) // neighbours: one may overlap the other
              {
                const auto into = f == e + 1 ? points[e + 1] - points[e] : points[f + 1] - points[f];
                const auto from = f == e + 1 ? points[f + 1] - points[f] : points[e + 1] - points[e];
                if (into[0] * from[1] - into[1] * from[0] == 0 && into * from < 0)
                  return std::make_pair(e, f);
              }
            else if (meet(points[e], points[e + 1], points[f], points[f + 1]))
              return std::make_pair(e, f);
          }
      return {};
    }

    /// The parameters that apply to some shapes only.
    template <int dim>
    std::vector<std::string> geometry()
    {
      std::vector<std::string> names = {"Center", "Radius", "Point", "Normal", "Height"};
      if (dim == 3)
        names.insert(names.end(), {"Axis", "File", "Scale", "Rotation", "Rotation axis", "Translation"});
      else
        names.push_back("Points");
      return names;
    }

    /// "x y; x y; ..." @throws InputError naming @p path.
    std::vector<dealii::Point<2>> read_points(const std::string &text,
                                              const std::string &path,
                                              const Parameters  &parameters)
    {
      const std::string             remedy = "write its points as x y, separated by semicolons: 0 0; 1 0; 2 1";
      std::vector<dealii::Point<2>> points;
      std::istringstream            list(text);
      for (std::string item; std::getline(list, item, ';');)
        {
          if (trim(item).empty())
            continue;
          for (char &c : item)
            if (c == ',')
              c = ' ';
          std::istringstream numbers(item);
          dealii::Point<2>   x;
          std::string        rest;
          if (!(numbers >> x[0] >> x[1]) || numbers >> rest || !is_usable(x[0]) || !is_usable(x[1]))
            throw parameters.error(path, "'" + trim(item) + "' is no point", remedy);
          if (!points.empty() && points.back().distance(x) == 0)
            throw parameters.error(path, "has the point '" + trim(item) + "' twice in a row", "leave one away");
          points.push_back(x);
        }
      if (points.size() < 2)
        throw parameters.error(path, "has fewer than two points", remedy);
      if (const auto crossing = first_crossing(points))
        throw parameters.error(
          path,
          "crosses or touches itself: edge " + std::to_string(crossing->first + 1) + " and edge " +
            std::to_string(crossing->second + 1),
          "give the points along a way that does not come back on itself; give each part its own obstacle");
      return points;
    }
  } // namespace

  template <int dim>
  ObstacleSection<dim>::ObstacleSection(const std::string &own_name)
    : name(own_name)
  {
    normal[1]              = 1;
    axis[dim - 1]          = 1;
    rotation_axis[dim - 1] = 1;
  }

  template <>
  void ObstacleSection<2>::declare_geometry(dealii::ParameterHandler &prm)
  {
    add_choice(prm,
               "Shape",
               obstacle.shape,
               Choices<ObstacleShape>{{"circle", ObstacleShape::circle},
                                      {"hole", ObstacleShape::hole},
                                      {"half plane", ObstacleShape::half_plane},
                                      {"polyline", ObstacleShape::polyline},
                                      {"function", ObstacleShape::function}},
               "geometry; bodies are outside a circle, inside a hole, above a function, to the left of the polyline's "
               "direction of travel, and where the normal of a half plane points");
    add_point(prm, "Center", obstacle.center, "mm", Interval(), "circle, hole: centre; must be set");
    add_number(prm, "Radius", obstacle.radius, "mm", Interval::above(0), "circle, hole: radius; must be set");
    add_point(prm, "Point", point, "mm", Interval(), "half plane: a point of its border; must be set");
    add_point(prm,
              "Normal",
              normal,
              "",
              Interval(),
              "half plane: normal of its border, towards the bodies, of any length");
    add_text(
      prm,
      "Points",
      points,
      "mm",
      "x y; x y; ...",
      "polyline: at least two points; its ends are extended straight unless the last point is the first; must be set");
    add_text(prm,
             "Height",
             height,
             "mm",
             "a number or a formula of x, t",
             "function: the obstacle is below y = height; must be set");
  }

  template <>
  void ObstacleSection<3>::declare_geometry(dealii::ParameterHandler &prm)
  {
    add_choice(prm,
               "Shape",
               obstacle.shape,
               Choices<ObstacleShape>{{"ball", ObstacleShape::circle},
                                      {"hollow ball", ObstacleShape::hole},
                                      {"half space", ObstacleShape::half_plane},
                                      {"cylinder", ObstacleShape::cylinder},
                                      {"bore", ObstacleShape::bore},
                                      {"function", ObstacleShape::function},
                                      {"stl", ObstacleShape::stl}},
               "geometry; bodies are outside a ball or an infinite cylinder, inside a hollow ball or a bore, above a "
               "function, and where the normal of a half space or those of the triangles of an stl point");
    add_point(prm,
              "Center",
              obstacle.center,
              "mm",
              Interval(),
              "ball, hollow ball: centre; cylinder, bore: a point of the axis; must be set");
    add_number(prm, "Radius", obstacle.radius, "mm", Interval::above(0), "balls, cylinder, bore: radius; must be set");
    add_point(prm, "Axis", axis, "", Interval(), "cylinder, bore: direction of the axis, of any length");
    add_point(prm, "Point", point, "mm", Interval(), "half space: a point of its border; must be set");
    add_point(prm,
              "Normal",
              normal,
              "",
              Interval(),
              "half space: normal of its border, towards the bodies, of any length");
    add_text(prm,
             "Height",
             height,
             "mm",
             "a number or a formula of x, z, t",
             "function: the obstacle is below y = height; must be set");
    declare_placement(prm);
  }

  template <int dim>
  void ObstacleSection<dim>::declare_placement(dealii::ParameterHandler &prm)
  {
    add_text(
      prm,
      "File",
      file,
      "",
      "a file: .stl (ASCII or binary)",
      "stl: a closed surface of triangles; relative to the directory of the .prm, then to the working directory; "
      "must be set");
    add_number(prm, "Scale", scale, "-", Interval::above(0), "stl: factor on its coordinates, 1000 for metres");
    add_number(prm,
               "Rotation",
               placement.rotation,
               "degrees",
               Interval(),
               "stl: about an axis through the origin, counterclockwise seen against it");
    add_point(prm, "Rotation axis", rotation_axis, "", Interval(), "stl: direction of that axis, of any length");
    add_point(prm, "Translation", placement.translation, "mm", Interval(), "stl: moves it after the rotation");
  }

  template <int dim>
  void ObstacleSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Obstacle " + name);
    declare_geometry(prm);
    for (const std::string &parameter : geometry<dim>())
      defaults[parameter] = prm.get(parameter);
    prm.leave_subsection();
  }

  template <int dim>
  Obstacle<dim> ObstacleSection<dim>::read(const Parameters &parameters) const
  {
    const std::string zero    = dim == 3 ? ", 0" : "";
    const std::string section = "Obstacle " + name;
    Obstacle<dim>     result  = obstacle;
    result.name               = name;
    std::vector<std::string> fitting;
    switch (obstacle.shape)
      {
        case ObstacleShape::cylinder:
        case ObstacleShape::bore:
          if (!(axis.norm() > 0))
            throw parameters.error(section + "/Axis", "has no length", "give a direction, for example: 0, 0, 1");
          result.normal = axis / axis.norm();
          fitting.push_back("Axis");
          [[fallthrough]];
        case ObstacleShape::circle:
        case ObstacleShape::hole:
          parameters.require(section + "/Center", "set it in mm, for example: set Center = 5, -20" + zero);
          parameters.require(section + "/Radius", "set it in mm, for example: set Radius = 20");
          fitting.insert(fitting.end(), {"Center", "Radius"});
          break;
        case ObstacleShape::half_plane:
          parameters.require(section + "/Point",
                             "set a point of its border in mm, for example: set Point = 0, 0" + zero);
          if (!(normal.norm() > 0))
            throw parameters.error(section + "/Normal",
                                   "has no length",
                                   "give a direction, for example: set Normal = 0, 1" + zero);
          result.normal = normal / normal.norm();
          result.center = point;
          fitting.insert(fitting.end(), {"Point", "Normal"});
          break;
        case ObstacleShape::polyline:
          parameters.require(section + "/Points", "set its points in mm, for example: set Points = 0 0; 1 0; 2 1");
          if constexpr (dim == 2)
            result.points = read_points(points, section + "/Points", parameters);
          fitting.push_back("Points");
          break;
        case ObstacleShape::function:
          parameters.require(section + "/Height", "set it in mm, for example: set Height = 0.1*x^2");
          result.height = Field<dim>(height, parameters.locate(section + "/Height"));
          fitting.push_back("Height");
          break;
        case ObstacleShape::stl:
          if constexpr (dim == 3)
            read_surface(parameters, result);
          fitting.insert(fitting.end(), {"File", "Scale", "Rotation", "Rotation axis", "Translation"});
          break;
      }
    for (const std::string &other : geometry<dim>())
      // the default is harmless: a .prm printed by the program sets everything
      if (const auto value = parameters.value(section + "/" + other);
          value && trim(*value) != defaults.at(other) &&
          std::find(fitting.begin(), fitting.end(), other) == fitting.end())
        throw parameters.error(section + "/" + other, "has no meaning for this shape", "remove it, or change Shape");
    return result;
  }

  template <>
  void ObstacleSection<3>::read_surface(const Parameters &parameters, Obstacle<3> &result) const
  {
    const std::string section = "Obstacle " + name;
    parameters.require(section + "/File", "set the file, for example: set File = meshes/part.stl");
    const auto found = parameters.find_file(file);
    if (!found)
      throw parameters.error(section + "/File",
                             "there is no such file",
                             "give a path from the directory of the .prm or from the working directory");
    if (!(rotation_axis.norm() > 0))
      throw parameters.error(section + "/Rotation axis", "has no length", "give a direction, for example: 0, 0, 1");
    Placement<3> there = placement;
    there.axis         = rotation_axis;
    const auto move    = there.motion();
    auto       corners = read_stl(*found);
    for (auto &x : corners)
      {
        x *= scale;
        move(x);
      }
    result.file    = *found;
    result.surface = std::make_shared<TriangulatedSurface>("STL file " + *found, corners);
  }

  template struct ObstacleSection<2>;
  template struct ObstacleSection<3>;
} // namespace slipstick::scene
