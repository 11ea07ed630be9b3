// Loads: tractions, body forces, point loads, temperatures.
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/boundary_part.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

#include <algorithm>
#include <cmath>

namespace slipstick::scene
{
  namespace
  {

    const std::string bodies_format = "all, or names from Bodies separated by commas";

    template <int dim>
    std::string point_format()
    {
      return std::string("coordinates such as 2.5, 10") + (dim == 3 ? ", 0" : "") +
             " or the name of a point in the mesh file";
    }

    /// One field per component: "NAME x", "NAME y".
    template <int dim>
    void add_components(dealii::ParameterHandler     &prm,
                        const std::string            &name,
                        std::array<std::string, dim> &components,
                        const std::string            &unit,
                        const std::string            &meaning)
    {
      for (unsigned int d = 0; d < dim; ++d)
        add_text(prm, name + " " + axes[d], components[d], unit, field_format<dim>(), meaning + " along " + axes[d]);
    }

    template <int dim>
    Field<dim> read_field(const std::string &text, const std::string &path, const Parameters &parameters)
    {
      return Field<dim>(text, parameters.locate(path));
    }

    template <int dim>
    std::array<Field<dim>, dim> read_components(const std::array<std::string, dim> &components,
                                                const std::string                  &path,
                                                const Parameters                   &parameters)
    {
      std::array<Field<dim>, dim> fields;
      for (unsigned int d = 0; d < dim; ++d)
        fields[d] = read_field<dim>(components[d], path + " " + axes[d], parameters);
      return fields;
    }

    template <int dim>
    std::vector<std::string> names_of(const std::vector<Body<dim>> &bodies)
    {
      std::vector<std::string> names;
      for (const Body<dim> &body : bodies)
        names.push_back(body.name);
      return names;
    }

    bool is_zero(const std::string &text)
    {
      const auto number = parse_number(text);
      return number && *number == 0;
    }

    template <std::size_t n>
    bool all_zero(const std::array<std::string, n> &texts)
    {
      return std::all_of(texts.begin(), texts.end(), is_zero);
    }

    /// A load whose values are all zero is probably a mistake, e.g. a misspelt name or a lost value.
    void require_load(const bool         is_none,
                      const std::string &section,
                      const std::string &what,
                      const std::string &list,
                      const std::string &name,
                      const Parameters  &parameters)
    {
      if (is_none)
        throw parameters.error(section,
                               "is no load: all its values are 0",
                               "set " + what + ", or take '" + name + "' out of the list " + list +
                                 " and remove its subsection");
    }
  } // namespace

  template <int dim>
  unsigned int read_body(const std::string            &text,
                         const std::string            &path,
                         const Parameters             &parameters,
                         const std::vector<Body<dim>> &bodies)
  {
    const auto names = names_of(bodies);
    parameters.require(path, "set a name from Bodies (" + join_names(names) + ")");
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end())
      throw parameters.error(path, "there is no body '" + text + "'", suggest_name(text, names));
    return found - names.begin();
  }

  template <int dim>
  std::vector<unsigned int> read_bodies(const std::string            &text,
                                        const std::string            &path,
                                        const Parameters             &parameters,
                                        const std::vector<Body<dim>> &bodies)
  {
    std::vector<unsigned int> indices;
    const auto                names = names_of(bodies);
    for (const std::string &name : trim(text) == "all" ? names : split_list(text))
      {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
          throw parameters.error(path, "there is no body '" + name + "'", suggest_name(name, names));
        indices.push_back(found - names.begin());
        if (std::count(indices.begin(), indices.end(), indices.back()) > 1)
          throw parameters.error(path, "names body '" + name + "' twice", "name it once");
      }
    if (indices.empty())
      throw parameters.error(path, "names no body", "set " + bodies_format);
    return indices;
  }

  template <int dim>
  PointName<dim> read_point(const std::string &text,
                            const std::string &path,
                            const Parameters  &parameters,
                            const unsigned int body,
                            const Body<dim>   &of)
  {
    parameters.require(path, "set " + point_format<dim>());
    PointName<dim>     point;
    dealii::Point<dim> x;
    const auto         parts     = split_list(text);
    unsigned int       n_numbers = 0;
    for (const std::string &part : parts)
      if (const auto number = parse_number(part))
        {
          if (n_numbers < dim)
            x[n_numbers] = *number;
          n_numbers += std::isfinite(*number);
        }
    point.body = body;
    if (parts.size() == dim && n_numbers == dim)
      point.coordinates = x;
    else if (parts.size() == 1 && n_numbers == 0 && of.shape == Shape::mesh)
      point.point = parts[0];
    else if (parts.size() == 1 && n_numbers == 0)
      throw parameters.error(path,
                             "body '" + of.name + "' is not from a mesh file and has no named points",
                             "give coordinates: " + std::to_string(dim) + " numbers separated by a comma");
    else
      throw parameters.error(path, "is no point", "set " + point_format<dim>());
    return point;
  }

  template <int dim>
  TractionSection<dim>::TractionSection(const std::string &own_name)
    : name(own_name)
  {
    components.fill("0");
  }

  template <int dim>
  void TractionSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Traction " + name);
    add_text(prm, "Boundary", boundary, "", boundary_format, "boundary that is loaded; must be set");
    add_components<dim>(prm, "Traction", components, "MPa", "force per undeformed area");
    add_text(prm,
             "Pressure",
             pressure,
             "MPa",
             field_format<dim>(),
             "against the outward normal of the undeformed boundary; positive presses on the body");
    prm.leave_subsection();
  }

  template <int dim>
  Traction<dim> TractionSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Traction " + name;
    bool              is_load = parameters.is_set(section + "/Pressure");
    for (unsigned int d = 0; d < dim; ++d)
      is_load = is_load || parameters.is_set(section + "/Traction " + axes[d]);
    require_load(!is_load, // 0 is allowed if it is set: a study may begin with it
                 section,
                 std::string("Pressure, Traction x") + (dim == 3 ? ", y or z" : " or Traction y"),
                 "Tractions",
                 name,
                 parameters);
    Traction<dim> traction;
    traction.name       = name;
    traction.where      = read_boundary(boundary, section + "/Boundary", parameters, scene.bodies);
    traction.components = read_components<dim>(components, section + "/Traction", parameters);
    traction.pressure   = read_field<dim>(pressure, section + "/Pressure", parameters);
    return traction;
  }

  template <int dim>
  BodyForceSection<dim>::BodyForceSection(const std::string &own_name)
    : name(own_name)
  {
    force.fill("0");
    acceleration.fill("0");
    axis_direction[dim - 1] = 1;
  }

  template <int dim>
  void BodyForceSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Body force " + name);
    add_text(prm, "Bodies", bodies, "", bodies_format, "bodies that it acts on");
    add_components<dim>(prm, "Force", force, "N/mm^3", "force per volume");
    add_components<dim>(prm,
                        "Acceleration",
                        acceleration,
                        "mm/s^2",
                        "the density of the material times this is a force per volume (gravity: 9810 downwards),");
    add_text(
      prm,
      "Angular velocity",
      angular_velocity,
      "1/s",
      field_format<dim>(),
      dim == 3
        ? "omega of the centrifugal force, density omega^2 times the distance from the axis"
        : "omega of the centrifugal force, density omega^2 (x - axis); axisymmetric: about the axis of revolution");
    add_point(prm,
              "Axis",
              axis,
              "mm",
              Interval(),
              dim == 3 ? "a point of the axis of rotation" : "centre of the rotation");
    if constexpr (dim == 3)
      add_point(prm,
                "Axis direction",
                axis_direction,
                "",
                Interval(),
                "direction of the axis of rotation, of any length");
    prm.leave_subsection();
  }

  template <int dim>
  BodyForce<dim> BodyForceSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Body force " + name;
    const bool        inertia = !all_zero(acceleration) || !is_zero(angular_velocity);
    require_load(all_zero(force) && !inertia,
                 section,
                 "Force, Acceleration or Angular velocity",
                 "Body forces",
                 name,
                 parameters);
    BodyForce<dim> load;
    load.name             = name;
    load.bodies           = read_bodies(bodies, section + "/Bodies", parameters, scene.bodies);
    load.force            = read_components<dim>(force, section + "/Force", parameters);
    load.acceleration     = read_components<dim>(acceleration, section + "/Acceleration", parameters);
    load.angular_velocity = read_field<dim>(angular_velocity, section + "/Angular velocity", parameters);
    load.axis             = axis;
    if constexpr (dim == 3)
      {
        if (!(axis_direction.norm() > 0))
          throw parameters.error(section + "/Axis direction",
                                 "has no length",
                                 "give a direction, for example: 0, 0, 1");
        load.axis_direction = axis_direction;
      }
    if (inertia)
      for (const unsigned int body : load.bodies)
        {
          const Material &material = scene.materials[scene.bodies[body].material];
          if (material.density == 0)
            throw parameters.error(section,
                                   "acts on the mass of body '" + scene.bodies[body].name + "', but Material " +
                                     material.name + "/Density is 0",
                                   "set Density (steel: 7.85e-9 t/mm^3), or leave the body out of Bodies");
        }
    return load;
  }

  template <int dim>
  PointLoadSection<dim>::PointLoadSection(const std::string &own_name)
    : name(own_name)
  {
    force.fill("0");
  }

  template <int dim>
  void PointLoadSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Point load " + name);
    add_text(prm, "Body", body, "", "a name from Bodies", "body that is loaded; must be set");
    add_text(prm,
             "Point",
             point,
             "mm",
             point_format<dim>(),
             "where: the mesh node nearest to it, at most half a cell away; must be set");
    add_components<dim>(prm,
                        "Force",
                        force,
                        "N",
                        dim == 3 ? "force" : "force, over the whole thickness or circumference,");
    prm.leave_subsection();
  }

  template <int dim>
  PointLoad<dim> PointLoadSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Point load " + name;
    require_load(all_zero(force),
                 section,
                 dim == 3 ? "Force x, y or z" : "Force x or Force y",
                 "Point loads",
                 name,
                 parameters);
    PointLoad<dim> load;
    load.name                = name;
    const unsigned int where = read_body(body, section + "/Body", parameters, scene.bodies);
    load.where               = read_point(point, section + "/Point", parameters, where, scene.bodies[where]);
    load.force               = read_components<dim>(force, section + "/Force", parameters);
    return load;
  }

  template <int dim>
  TemperatureSection<dim>::TemperatureSection(const std::string &own_name)
    : name(own_name)
  {}

  template <int dim>
  void TemperatureSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Temperature " + name);
    add_text(prm, "Bodies", bodies, "", bodies_format, "bodies whose temperature changes");
    add_text(prm, "Change", change, "K", field_format<dim>(), "change from the stress-free state; must be set");
    prm.leave_subsection();
  }

  template <int dim>
  Temperature<dim> TemperatureSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Temperature " + name;
    parameters.require(section + "/Change", "set it in K");
    Temperature<dim> temperature;
    temperature.name   = name;
    temperature.bodies = read_bodies(bodies, section + "/Bodies", parameters, scene.bodies);
    temperature.change = read_field<dim>(change, section + "/Change", parameters);
    const bool expands = std::any_of(temperature.bodies.begin(), temperature.bodies.end(), [&](const unsigned int b) {
      return scene.materials[scene.bodies[b].material].expansion != 0;
    });
    if (!expands)
      throw parameters.error(section,
                             "has no effect: Thermal expansion is 0 in the material of every body that it names",
                             "set Thermal expansion (steel: 1.2e-5 1/K) in their materials");
    return temperature;
  }

  template unsigned int              read_body(const std::string &,
                                               const std::string &,
                                               const Parameters &,
                                               const std::vector<Body<2>> &);
  template std::vector<unsigned int> read_bodies(const std::string &,
                                                 const std::string &,
                                                 const Parameters &,
                                                 const std::vector<Body<2>> &);
  template PointName<2>              read_point(const std::string &,
                                                const std::string &,
                                                const Parameters &,
                                                const unsigned int,
                                                const Body<2> &);
  template struct TractionSection<2>;
  template struct BodyForceSection<2>;
  template struct PointLoadSection<2>;
  template struct TemperatureSection<2>;
  template unsigned int              read_body(const std::string &,
                                               const std::string &,
                                               const Parameters &,
                                               const std::vector<Body<3>> &);
  template std::vector<unsigned int> read_bodies(const std::string &,
                                                 const std::string &,
                                                 const Parameters &,
                                                 const std::vector<Body<3>> &);
  template PointName<3>              read_point(const std::string &,
                                                const std::string &,
                                                const Parameters &,
                                                const unsigned int,
                                                const Body<3> &);
  template struct TractionSection<3>;
  template struct BodyForceSection<3>;
  template struct PointLoadSection<3>;
  template struct TemperatureSection<3>;
} // namespace slipstick::scene
