#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace slipstick::scene
{
  namespace
  {
    const std::vector<std::string> geometry = {"Center", "Radius", "Point", "Normal", "Points", "Height"};

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
          if (!(numbers >> x[0] >> x[1]) || numbers >> rest || !std::isfinite(x[0]) || !std::isfinite(x[1]))
            throw parameters.error(path, "'" + trim(item) + "' is no point", remedy);
          if (!points.empty() && points.back().distance(x) == 0)
            throw parameters.error(path, "has the point '" + trim(item) + "' twice in a row", "leave one away");
          points.push_back(x);
        }
      if (points.size() < 2)
        throw parameters.error(path, "has fewer than two points", remedy);
      return points;
    }
  } // namespace

  template <int dim>
  ObstacleSection<dim>::ObstacleSection(const std::string &own_name)
    : name(own_name)
  {
    normal[dim - 1] = 1;
  }

  template <int dim>
  void ObstacleSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Obstacle " + name);
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
    add_text(prm,
             "Points",
             points,
             "mm",
             "x y; x y; ...",
             "polyline: at least two points; ends go on straight unless the last point is the first; must be set");
    add_text(prm,
             "Height",
             height,
             "mm",
             "a number or a formula of x, t",
             "function: the obstacle is below y = height; must be set");
    for (const std::string &parameter : geometry)
      defaults[parameter] = prm.get(parameter);
    prm.leave_subsection();
  }

  template <int dim>
  Obstacle<dim> ObstacleSection<dim>::read(const Parameters &parameters) const
  {
    static_assert(dim == 2, "obstacles are curves");
    const std::string section = "Obstacle " + name;
    Obstacle<dim>     result  = obstacle;
    result.name               = name;
    std::vector<std::string> fitting;
    switch (obstacle.shape)
      {
        case ObstacleShape::circle:
        case ObstacleShape::hole:
          parameters.require(section + "/Center", "set it in mm, for example: set Center = 5, -20");
          parameters.require(section + "/Radius", "set it in mm, for example: set Radius = 20");
          fitting.insert(fitting.end(), {"Center", "Radius"});
          break;
        case ObstacleShape::half_plane:
          parameters.require(section + "/Point", "set a point of its border in mm, for example: set Point = 0, 0");
          if (!(normal.norm() > 0))
            throw parameters.error(section + "/Normal",
                                   "has no length",
                                   "give a direction, for example: set Normal = 0, 1");
          result.normal = normal / normal.norm();
          result.center = point;
          fitting.insert(fitting.end(), {"Point", "Normal"});
          break;
        case ObstacleShape::polyline:
          parameters.require(section + "/Points", "set its points in mm, for example: set Points = 0 0; 1 0; 2 1");
          result.points = read_points(points, section + "/Points", parameters);
          fitting.push_back("Points");
          break;
        case ObstacleShape::function:
          parameters.require(section + "/Height", "set it in mm, for example: set Height = 0.1*x^2");
          result.height = Field<dim>(height, parameters.locate(section + "/Height"));
          fitting.push_back("Height");
          break;
      }
    for (const std::string &other : geometry)
      // the default is harmless, and a .prm that the program printed sets everything
      if (const auto value = parameters.value(section + "/" + other);
          value && trim(*value) != defaults.at(other) &&
          std::find(fitting.begin(), fitting.end(), other) == fitting.end())
        throw parameters.error(section + "/" + other, "means nothing for this shape", "leave it away, or change Shape");
    return result;
  }

  template struct ObstacleSection<2>;
} // namespace slipstick::scene
