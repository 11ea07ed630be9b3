#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

namespace slipstick::scene
{
  MaterialSection::MaterialSection(const std::string &own_name)
    : name(own_name)
  {}

  void MaterialSection::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Material " + name);
    add_number(prm, "Young modulus", material.young_modulus, "MPa", Interval::above(0), "Young's modulus E");
    add_number(prm,
               "Poisson ratio",
               material.poisson_ratio,
               "-",
               Interval::inside(-1, 0.5),
               "Poisson's ratio nu; 0.5 (incompressible) is excluded; plane strain above 0.495: set "
               "Discretization/Element");
    add_number(prm,
               "Density",
               material.density,
               "t/mm^3",
               Interval{0},
               "mass per volume, for accelerations and rotation");
    add_number(prm,
               "Thermal expansion",
               material.expansion,
               "1/K",
               Interval(),
               "coefficient of linear expansion alpha");
    prm.leave_subsection();
  }

  Material MaterialSection::read() const
  {
    Material result = material;
    result.name     = name;
    return result;
  }
} // namespace slipstick::scene
