#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

#include <algorithm>

namespace slipstick::scene
{
  namespace
  {
    const std::array<std::string, 3> axes = {{"x", "y", "z"}};

    const std::string boundary_format = "BODY/BOUNDARY, such as box/left";
    const std::string field_format    = "a number or a formula of x, y, t";
  } // namespace

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
    const std::string name = trim(text.substr(0, slash)), boundary = trim(text.substr(slash + 1));
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
    const auto boundaries = boundary_names(body->shape);
    if (boundary != "*" && body->shape != Shape::mesh &&
        std::find(boundaries.begin(), boundaries.end(), boundary) == boundaries.end())
      throw parameters.error(path,
                             "body '" + name + "' has no boundary '" + boundary + "'",
                             suggest_name(boundary, boundaries));
    return {static_cast<unsigned int>(body - bodies.begin()), boundary};
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
    add_text(prm, "Boundary", boundary, "", boundary_format, "boundary that is held; must be set");
    for (unsigned int d = 0; d < dim; ++d)
      add_text(prm,
               "Displacement " + axes[d],
               components[d],
               "mm",
               "free, " + field_format,
               "prescribed displacement along " + axes[d]);
    prm.leave_subsection();
  }

  template <int dim>
  PrescribedDisplacement<dim> SupportSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string           section = "Support " + name;
    PrescribedDisplacement<dim> support;
    support.name  = name;
    support.where = read_boundary(boundary, section + "/Boundary", parameters, scene.bodies);

    bool holds = false;
    for (unsigned int d = 0; d < dim; ++d)
      if (components[d] != "free")
        {
          support.components[d] = Field<dim>(components[d], parameters.locate(section + "/Displacement " + axes[d]));
          holds                 = true;
        }
    if (!holds)
      throw parameters.error(section,
                             "holds nothing, every component is free",
                             "set Displacement x or y to a number or formula, or take '" + name +
                               "' out of the list Supports and leave its subsection away");
    return support;
  }

  template <int dim>
  ContactSection<dim>::ContactSection(const std::string &own_name)
    : name(own_name)
  {}

  template <int dim>
  void ContactSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Contact " + name);
    add_text(prm, "Slave", slave, "", boundary_format, "boundary that may touch the master; must be set");
    add_text(prm, "Master", master, "", "a name from Obstacles", "rigid obstacle that it may touch; must be set");
    add_choice(prm,
               "Law",
               law,
               Choices<ContactLaw>{{"frictionless", ContactLaw::frictionless}, {"Tresca", ContactLaw::tresca}},
               "frictionless, or Tresca friction with a given slip bound");
    add_text(prm,
             "Slip bound",
             slip_bound,
             "MPa",
             field_format + ", >= 0",
             "Tresca: largest tangential traction, on the whole slave boundary, open nodes included; must be set");
    prm.leave_subsection();
  }

  template <int dim>
  ContactPair<dim> ContactSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Contact " + name;
    ContactPair<dim>  pair;
    pair.name  = name;
    pair.law   = law;
    pair.slave = read_boundary(slave, section + "/Slave", parameters, scene.bodies);

    std::vector<std::string> obstacles;
    for (const Obstacle<dim> &obstacle : scene.obstacles)
      obstacles.push_back(obstacle.name);
    parameters.require(section + "/Master", "set a name from Obstacles (" + join_names(obstacles) + ")");
    pair.obstacle = std::find(obstacles.begin(), obstacles.end(), master) - obstacles.begin();
    if (pair.obstacle == obstacles.size())
      throw parameters.error(section + "/Master", "there is no such obstacle", suggest_name(master, obstacles));

    if (law == ContactLaw::tresca)
      parameters.require(section + "/Slip bound", "set it in MPa, or set Law = frictionless");
    pair.slip_bound = Field<dim>(slip_bound, parameters.locate(section + "/Slip bound"));
    if (pair.slip_bound.is_constant() && pair.slip_bound.value(dealii::Point<dim>(), 1) < 0)
      throw parameters.error(section + "/Slip bound", "is negative", "give a slip bound >= 0 [MPa]");
    return pair;
  }

  template BoundaryName read_boundary(const std::string &,
                                      const std::string &,
                                      const Parameters &,
                                      const std::vector<Body<2>> &);
  template struct SupportSection<2>;
  template struct ContactSection<2>;
} // namespace slipstick::scene
