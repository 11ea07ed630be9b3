#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/boundary_part.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

#include <algorithm>

namespace slipstick::scene
{
  namespace
  {} // namespace

  template <int dim>
  BoundaryName read_boundary(const std::string            &text,
                             const std::string            &path,
                             const Parameters             &parameters,
                             const std::vector<Body<dim>> &bodies)
  {
    parameters.require(path, "set " + boundary_format);
    const auto slash = text.find('/');
    if (slash == std::string::npos)
      throw parameters.error(path, "names no boundary of a body", "write " + boundary_format);
    const std::string  name     = trim(text.substr(0, slash));
    const BoundaryPart part     = part_of_boundary(text.substr(slash + 1));
    const std::string &boundary = part.name;
    if (boundary.empty())
      throw parameters.error(path, "names no boundary of a body", "write " + boundary_format);

    const auto body = std::find_if(bodies.begin(), bodies.end(), [&name](const Body<dim> &candidate) {
      return candidate.name == name;
    });
    if (body == bodies.end())
      {
        std::vector<std::string> names;
        for (const Body<dim> &candidate : bodies)
          names.push_back(candidate.name);
        throw parameters.error(path, "there is no body '" + name + "'", suggest_name(name, names));
      }
    const auto boundaries = boundary_names(body->shape, dim);
    if (boundary != "*" && body->shape != Shape::mesh &&
        std::find(boundaries.begin(), boundaries.end(), boundary) == boundaries.end())
      throw parameters.error(path,
                             "body '" + name + "' has no boundary '" + boundary + "'",
                             suggest_name(boundary, boundaries));
    check_condition<dim>(part, path);
    return {static_cast<unsigned int>(body - bodies.begin()), to_string(part)};
  }

  template <int dim>
  SupportSection<dim>::SupportSection(const std::string &own_name)
    : name(own_name)
  {
    components.fill("free");
  }

  template <int dim>
  void SupportSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Support " + name);
    add_text(prm,
             "Boundary",
             boundary,
             "",
             boundary_format,
             "boundary that is held; this or Body and Point must be set");
    add_text(prm, "Body", body, "", "a name from Bodies", "body of which a point is held");
    add_text(prm,
             "Point",
             point,
             "mm",
             std::string("x, y, ") + (dim == 3 ? "z, " : "") + "or the name of a point in the mesh file",
             "point that is held");
    for (unsigned int d = 0; d < dim; ++d)
      add_text(prm,
               "Displacement " + axes[d],
               components[d],
               "mm",
               "free, " + field_format<dim>(),
               "prescribed displacement along " + axes[d]);
    add_text(
      prm,
      "Displacement normal",
      normal,
      "mm",
      "free, " + field_format<dim>(),
      "prescribed displacement along the outward normal of the boundary, which then slides freely along it; 0 is a "
      "roller or a plane of symmetry");
    prm.leave_subsection();
  }

  template <int dim>
  void SupportSection<dim>::read_place(const Parameters            &parameters,
                                       const Scene<dim>            &scene,
                                       PrescribedDisplacement<dim> &support) const
  {
    const std::string section  = "Support " + name;
    const bool        is_point = !point.empty() || !body.empty();
    if (!is_point)
      {
        support.where = read_boundary(boundary, section + "/Boundary", parameters, scene.bodies);
        return;
      }
    if (!boundary.empty())
      throw parameters.error(section + "/Boundary",
                             "is given in addition to a point",
                             "set either Boundary, or Body and Point, and remove the other");
    parameters.require(section + "/Body", "set the body that the point belongs to");
    parameters.require(section + "/Point", "set the point of the body, for example: set Point = 0, 0");
    support.where.body = read_body(body, section + "/Body", parameters, scene.bodies);
    support.point =
      read_point(point, section + "/Point", parameters, support.where.body, scene.bodies[support.where.body]);
  }

  template <int dim>
  PrescribedDisplacement<dim> SupportSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string           section = "Support " + name;
    PrescribedDisplacement<dim> support;
    support.name = name;
    read_place(parameters, scene, support);

    bool holds = false;
    for (unsigned int d = 0; d < dim; ++d)
      if (components[d] != "free")
        {
          support.components[d] = Field<dim>(components[d], parameters.locate(section + "/Displacement " + axes[d]));
          holds                 = true;
        }
    if (normal != "free")
      {
        if (holds)
          throw parameters.error(section + "/Displacement normal",
                                 "cannot be combined with a displacement along an axis",
                                 "set the others to free, or move them to a second support");
        if (support.point)
          throw parameters.error(section + "/Displacement normal",
                                 "needs a boundary, but this support is at a point",
                                 dim == 3 ? "set Displacement x, y or z, or a Boundary"
                                          : "set Displacement x or y, or a Boundary");
        support.normal = Field<dim>(normal, parameters.locate(section + "/Displacement normal"));
        holds          = true;
      }
    if (!holds)
      throw parameters.error(section,
                             "holds nothing: every component is free",
                             std::string("set Displacement x, y") + (dim == 3 ? ", z" : "") +
                               " or normal to a number or formula, or take '" + name +
                               "' out of the list Supports and remove its subsection");
    return support;
  }

  template <int dim>
  FoundationSection<dim>::FoundationSection(const std::string &own_name)
    : name(own_name)
  {}

  template <int dim>
  void FoundationSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Foundation " + name);
    add_text(prm, "Boundary", boundary, "", boundary_format, "boundary that rests on springs; must be set");
    const Interval not_negative = Interval::from(0);
    add_number(prm,
               "Normal stiffness",
               foundation.normal_stiffness,
               "MPa/mm",
               not_negative,
               "pressure per displacement along the normal, tension too");
    add_number(prm,
               "Tangential stiffness",
               foundation.tangential_stiffness,
               "MPa/mm",
               not_negative,
               "shear traction per displacement along the boundary");
    prm.leave_subsection();
  }

  template <int dim>
  Foundation<dim> FoundationSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Foundation " + name;
    Foundation<dim>   result  = foundation;
    result.name               = name;
    result.where              = read_boundary(boundary, section + "/Boundary", parameters, scene.bodies);
    if (result.normal_stiffness == 0 && result.tangential_stiffness == 0)
      throw parameters.error(section,
                             "holds nothing: both stiffnesses are 0",
                             "set Normal stiffness or Tangential stiffness, or take '" + name +
                               "' out of the list Foundations and remove its subsection");
    return result;
  }

  template BoundaryName read_boundary(const std::string &,
                                      const std::string &,
                                      const Parameters &,
                                      const std::vector<Body<2>> &);
  template struct SupportSection<2>;
  template struct FoundationSection<2>;
  template BoundaryName read_boundary(const std::string &,
                                      const std::string &,
                                      const Parameters &,
                                      const std::vector<Body<3>> &);
  template struct SupportSection<3>;
  template struct FoundationSection<3>;
} // namespace slipstick::scene
