#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

namespace slipstick::scene
{
  template <int dim>
  PretensionSection<dim>::PretensionSection(const std::string &own_name)
    : name(own_name)
  {}

  template <int dim>
  void PretensionSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Pretension " + name);
    add_text(prm, "Body", body, "", "a name from Bodies", "the bolt, a body of its own; must be set");
    add_point(prm, "Point", point, "mm", Interval(), "a point of the section across which it is tightened");
    add_point(prm,
              "Direction",
              direction,
              "",
              Interval(),
              "axis of the bolt, normal to that section, of any length; must be set");
    add_text(prm,
             "Force",
             force,
             "N",
             "a number or a formula of t",
             "tension across the section while it is tightened (where it is 0 the length is held), over the whole "
             "thickness or circumference; must be set");
    add_text(prm,
             "Tightened until",
             until,
             "",
             "a load factor, or auto: the first of Load steps/Factors",
             "last load factor at which the force is given; at later ones the length is held");
    prm.leave_subsection();
  }

  template <int dim>
  Pretension<dim> PretensionSection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Pretension " + name;
    parameters.require(section + "/Force", "set it in N");
    Pretension<dim> bolt;
    bolt.name      = name;
    bolt.body      = read_body(body, section + "/Body", parameters, scene.bodies);
    bolt.point     = point;
    bolt.direction = direction;
    if (!(bolt.direction.norm() > 0))
      throw parameters.error(section + "/Direction",
                             "has no length",
                             std::string("give the axis of the bolt, for example: 0, 1") + (dim == 3 ? ", 0" : ""));
    if (scene.plane_state == PlaneState::axisymmetric && direction[0] != 0)
      throw parameters.error(section + "/Direction",
                             "is not the axis of revolution",
                             "set Direction = 0, 1: bodies of revolution can be tightened along their axis alone");
    bolt.direction /= bolt.direction.norm();
    bolt.force           = Field<dim>(force, parameters.locate(section + "/Force"));
    bolt.tightened_until = scene.load_factors.front();
    if (until != "auto")
      bolt.tightened_until =
        Field<dim>(until, parameters.locate(section + "/Tightened until")).value(dealii::Point<dim>(), 1);
    for (const double t : scene.load_factors)
      if (t <= bolt.tightened_until && !(bolt.force.value(bolt.point, t) >= 0))
        throw parameters.error(section + "/Force",
                               "is negative at t = " + number_text(t),
                               "give a tension of 0 or more; with 0 the bolt keeps its length");
    if (!(bolt.tightened_until >= scene.load_factors.front()))
      throw parameters.error(section + "/Tightened until",
                             "lies before the first of Load steps/Factors, so that the bolt is never tightened",
                             "set it to the last load factor at which the force is given");
    return bolt;
  }

  template struct PretensionSection<2>;
  template struct PretensionSection<3>;
} // namespace slipstick::scene
