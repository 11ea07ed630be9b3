#include <slipstick/base/nearest_name.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

namespace slipstick::scene
{
  namespace
  {
    const unsigned int max_cells = 1000000; // per direction: products stay far from overflow
  }

  std::vector<std::string> boundary_names(const Shape shape)
  {
    switch (shape)
      {
        case Shape::rectangle:
          return {"left", "right", "bottom", "top"};
      }
    return {};
  }

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
               "Poisson's ratio nu; 0.5 (incompressible) is excluded");
    prm.leave_subsection();
  }

  Material MaterialSection::read() const
  {
    Material result = material;
    result.name     = name;
    return result;
  }

  template <int dim>
  BodySection<dim>::BodySection(const std::string &own_name)
    : name(own_name)
  {
    for (unsigned int d = 0; d < dim; ++d)
      body.size[d] = 1; // shown in the listing; a scene must set it
  }

  template <int dim>
  void BodySection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Body " + name);
    add_choice(prm,
               "Shape",
               body.shape,
               Choices<Shape>{{"rectangle", Shape::rectangle}},
               "geometry; a rectangle has the boundaries left, right, bottom, top");
    add_point(prm, "Origin", body.origin, "mm", Interval(), "lower left corner");
    add_point(prm, "Size", body.size, "mm", Interval::above(0), "edge lengths; must be set");
    add_counts_or_auto<dim>(prm,
                            "Cells",
                            body.cells,
                            max_cells,
                            "cells along the edges; auto: Blocks times Cells per block of the Decomposition");
    add_text(prm, "Material", material, "", "a name from Materials", "material of the body; must be set");
    add_number(prm, "Thickness", body.thickness, "mm", Interval::above(0), "thickness out of the plane");
    prm.leave_subsection();
  }

  template <int dim>
  Body<dim> BodySection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Body " + name;
    parameters.require(section + "/Size", "set its edge lengths in mm, for example: set Size = 10, 10");

    std::vector<std::string> materials;
    for (const Material &candidate : scene.materials)
      materials.push_back(candidate.name);
    parameters.require(section + "/Material", "set a name from Materials (" + join_names(materials) + ")");

    Body<dim> result = body;
    result.name      = name;
    for (result.material = 0; result.material < materials.size(); ++result.material)
      if (materials[result.material] == material)
        return result;
    throw parameters.error(section + "/Material", "there is no such material", suggest_name(material, materials));
  }

  template <int dim>
  ObstacleSection<dim>::ObstacleSection(const std::string &own_name)
    : name(own_name)
  {}

  template <int dim>
  void ObstacleSection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Obstacle " + name);
    add_choice(prm,
               "Shape",
               obstacle.shape,
               Choices<ObstacleShape>{{"circle", ObstacleShape::circle}},
               "geometry of the rigid obstacle; bodies are outside");
    add_point(prm, "Center", obstacle.center, "mm", Interval(), "centre; must be set");
    add_number(prm, "Radius", obstacle.radius, "mm", Interval::above(0), "radius; must be set");
    prm.leave_subsection();
  }

  template <int dim>
  Obstacle<dim> ObstacleSection<dim>::read(const Parameters &parameters) const
  {
    const std::string section = "Obstacle " + name;
    parameters.require(section + "/Center", "set it in mm, for example: set Center = 5, -20");
    parameters.require(section + "/Radius", "set it in mm, for example: set Radius = 20");
    Obstacle<dim> result = obstacle;
    result.name          = name;
    return result;
  }

  template struct BodySection<2>;
  template struct ObstacleSection<2>;
} // namespace slipstick::scene
