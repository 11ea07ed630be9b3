#include <slipstick/scene/declare.h>
#include <slipstick/scene/material_library.h>
#include <slipstick/scene/sections.h>

namespace slipstick::scene
{
  MaterialSection::MaterialSection(const std::string &own_name)
    : name(own_name)
  {}

  void MaterialSection::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Material " + name);
    Choices<std::string> choices;
    choices.emplace_back("none", "none");
    for (const std::string &entry : library_names())
      choices.emplace_back(entry, entry);
    add_choice(
      prm,
      "Library",
      library,
      choices,
      "typical values at room temperature; values that the scene sets take precedence. A material in Materials "
      "that has such a name needs no subsection");
    add_number(prm,
               "Young modulus",
               material.young_modulus,
               "MPa",
               Interval::between(least_of_material, most_of_material),
               "Young's modulus E");
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
               Interval::between(0, most_of_material),
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
