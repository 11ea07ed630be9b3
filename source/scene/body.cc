#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/sections.h>

#include <algorithm>

namespace slipstick::scene
{
  namespace
  {
    const unsigned int max_cells       = 1000000; // per direction: products are far from overflow
    const unsigned int max_refinements = 10;

    /// The shapes available in this dimension.
    template <int dim>
    const Choices<Shape> &shapes()
    {
      static const Choices<Shape> of_plane = {{"rectangle", Shape::rectangle},
                                              {"disc", Shape::disc},
                                              {"half disc", Shape::half_disc},
                                              {"quarter disc", Shape::quarter_disc},
                                              {"ring", Shape::ring},
                                              {"quarter ring", Shape::quarter_ring},
                                              {"mesh", Shape::mesh}},
                                  of_space = {{"cuboid", Shape::rectangle},
                                              {"ball", Shape::ball},
                                              {"half ball", Shape::half_ball},
                                              {"cylinder", Shape::cylinder},
                                              {"tube", Shape::tube},
                                              {"mesh", Shape::mesh}};
      return dim == 3 ? of_space : of_plane;
    }

    /// The parameters that apply to some shapes only.
    struct Fit
    {
      std::string        parameter;
      std::vector<Shape> shapes;
    };
    template <int dim>
    const std::vector<Fit> &fits()
    {
      static const std::vector<Fit>
        of_plane =
          {
            {"Origin", {Shape::rectangle}},
            {"Size", {Shape::rectangle}},
            {"Cells", {Shape::rectangle, Shape::ring, Shape::quarter_ring}},
            {"Center", {Shape::disc, Shape::half_disc, Shape::quarter_disc, Shape::ring, Shape::quarter_ring}},
            {"Radius", {Shape::disc, Shape::half_disc, Shape::quarter_disc, Shape::ring, Shape::quarter_ring}},
            {"Inner radius", {Shape::ring, Shape::quarter_ring}},
            {"Cells along arc", {Shape::disc, Shape::half_disc, Shape::quarter_disc}},
            {"File", {Shape::mesh}},
            {"Part", {Shape::mesh}},
            {"Scale", {Shape::mesh}},
            {"Corner angle", {Shape::mesh}},
          },
        of_space = {
          {"Origin", {Shape::rectangle}},
          {"Size", {Shape::rectangle}},
          {"Cells", {Shape::rectangle}},
          {"Center", {Shape::ball, Shape::half_ball, Shape::cylinder, Shape::tube}},
          {"Radius", {Shape::ball, Shape::half_ball, Shape::cylinder, Shape::tube}},
          {"Inner radius", {Shape::tube}},
          {"Length", {Shape::cylinder, Shape::tube}},
          {"Cells around", {Shape::ball, Shape::half_ball, Shape::cylinder, Shape::tube}},
          {"Cells along axis", {Shape::cylinder, Shape::tube}},
          {"File", {Shape::mesh}},
          {"Part", {Shape::mesh}},
          {"Scale", {Shape::mesh}},
        };
      return dim == 3 ? of_space : of_plane;
    }

    template <int dim>
    std::string name_of(const Shape shape)
    {
      for (const auto &[name, value] : shapes<dim>())
        if (value == shape)
          return name;
      return "";
    }

    bool contains(const std::vector<Shape> &list, const Shape shape)
    {
      return std::find(list.begin(), list.end(), shape) != list.end();
    }
  } // namespace

  std::vector<std::string> boundary_names(const Shape shape, const unsigned int dim)
  {
    switch (shape)
      {
        case Shape::rectangle:
          return dim == 3 ? std::vector<std::string>{"left", "right", "bottom", "top", "back", "front"}
                          : std::vector<std::string>{"left", "right", "bottom", "top"};
        case Shape::disc:
          return {"arc"};
        case Shape::half_disc:
          return {"arc", "flat"};
        case Shape::quarter_disc:
          return {"arc", "flat", "side"};
        case Shape::ring:
          return {"inner", "outer"};
        case Shape::quarter_ring:
          return {"inner", "outer", "start", "end"};
        case Shape::ball:
          return {"surface"};
        case Shape::half_ball:
          return {"surface", "flat"};
        case Shape::cylinder:
          return {"side", "back", "front"};
        case Shape::tube:
          return {"inner", "outer", "back", "front"};
        case Shape::mesh:
          return {};
      }
    return {};
  }

  template <int dim>
  BodySection<dim>::BodySection(const std::string &own_name)
    : name(own_name)
  {
    for (unsigned int d = 0; d < dim; ++d)
      body.size[d] = 1; // shown in the listing; a scene must set it
    rotation_axis[dim - 1] = 1;
  }

  template <int dim>
  void BodySection<dim>::declare_file(dealii::ParameterHandler &prm)
  {
    add_text(prm,
             "File",
             body.file,
             "",
             "a file: .msh (Gmsh 2.2, 4.1), .inp (Abaqus), .ucd, .unv, .vtk",
             "mesh: relative to the directory of the .prm, then to the working directory; must be set");
    add_text(prm,
             "Part",
             body.part,
             "",
             std::string("a physical name of ") + (dim == 3 ? "volumes" : "surfaces") + " in the file, or its number",
             "mesh: which cells make the body; empty: all");
    add_number(prm, "Scale", body.scale, "-", Interval::above(0), "mesh: factor on its coordinates, 1000 for metres");
  }

  template <>
  void BodySection<2>::declare_geometry(dealii::ParameterHandler &prm)
  {
    add_choice(
      prm,
      "Shape",
      body.shape,
      shapes<2>(),
      "geometry and names of the boundaries: rectangle: left, right, bottom, top; disc: arc; half disc (below "
      "its centre): arc, flat; quarter disc (below and to the right of its centre): arc, flat, side; ring: inner, outer; quarter ring: inner, outer, start (on the x axis), end (on "
      "the y axis); mesh: the physical names in the file; * is the whole outline of any body");
    add_point(prm, "Origin", body.origin, "mm", Interval(), "rectangle: lower left corner");
    add_point(prm, "Size", body.size, "mm", Interval::above(0), "rectangle: edge lengths; must be set");
    add_counts_or_auto<2>(prm,
                          "Cells",
                          body.cells,
                          max_cells,
                          "rectangle: cells along the edges; auto: Blocks times Cells per block of the "
                          "Decomposition; rings: cells around and across; auto: 64 for the whole circle, about square");
    add_point(prm, "Center", body.center, "mm", Interval(), "discs and rings: centre");
    add_number(prm, "Radius", body.radius, "mm", Interval::above(0), "discs and rings: outer radius; must be set");
    add_number(prm, "Inner radius", body.inner_radius, "mm", Interval::above(0), "rings: inner radius; must be set");
    add_count(
      prm,
      "Cells along arc",
      body.cells_along_arc,
      4,
      max_cells,
      "disc: edges on the whole circle, a multiple of 4 and at least 8; half disc: on its half, quarter disc: on its quarter, an even number");
    declare_file(prm);
    add_choice(prm,
               "Outline",
               body.has_smooth_outline,
               Choices<bool>{{"smooth", true}, {"polygon", false}},
               "shape of edges in gaps and normals of contact, for new nodes of refinement, and in cells of "
               "degree 2: smooth: arcs of built-in shapes; of meshes the curves through the mid nodes of the file, or "
               "splines through the nodes; polygon: straight edges, neglecting the sagitta");
    add_number(prm,
               "Corner angle",
               body.corner_angle,
               "degrees",
               Interval::inside(0, 90),
               "mesh: a smooth outline has corners where edges meet at this angle or a larger one");
  }

  template <>
  void BodySection<3>::declare_geometry(dealii::ParameterHandler &prm)
  {
    add_choice(prm,
               "Shape",
               body.shape,
               shapes<3>(),
               "geometry and names of the boundaries: cuboid: left, right (x), bottom, top (y), back, front (z); ball: "
               "surface; half ball (below its centre): surface, flat; cylinder (along z): side, back, front; tube: "
               "inner, outer, back, front; mesh: the physical names in the file; * is the whole surface of any body");
    add_point(prm, "Origin", body.origin, "mm", Interval(), "cuboid: left, bottom, back corner");
    add_point(prm, "Size", body.size, "mm", Interval::above(0), "cuboid: edge lengths; must be set");
    add_counts_or_auto<3>(prm,
                          "Cells",
                          body.cells,
                          max_cells,
                          "cuboid: cells along the edges; auto: Blocks times Cells per block of the Decomposition");
    add_point(prm,
              "Center",
              body.center,
              "mm",
              Interval(),
              "ball: centre; cylinder, tube: centre of the back end, from which they extend along z");
    add_number(prm, "Radius", body.radius, "mm", Interval::above(0), "ball, cylinder, tube: outer radius; must be set");
    add_number(prm, "Inner radius", body.inner_radius, "mm", Interval::above(0), "tube: inner radius; must be set");
    add_number(prm, "Length", body.length, "mm", Interval::above(0), "cylinder, tube: along z; must be set");
    add_count(prm,
              "Cells around",
              body.cells_along_arc,
              8,
              max_cells,
              "ball, cylinder, tube: edges on the whole circumference; ball: a multiple of 8, cylinder: of 4");
    add_count_or_auto(prm,
                      "Cells along axis",
                      body.cells_along_axis,
                      max_cells,
                      "cylinder, tube; auto: as long as those around");
    declare_file(prm);
    add_choice(
      prm,
      "Outline",
      body.has_smooth_outline,
      Choices<bool>{{"smooth", true}, {"polygon", false}},
      "shape of faces in gaps and normals of contact, and in cells of degree 2: smooth: balls and cylinders of "
      "built-in shapes, of meshes the surfaces through the mid nodes of the file; polygon: faces with straight "
      "edges, neglecting the sagitta");
  }

  template <int dim>
  void BodySection<dim>::declare_refinement(dealii::ParameterHandler &prm)
  {
    add_text(prm,
             "Refine towards",
             refined_boundaries,
             "",
             "names of boundaries of this body, separated by commas",
             "cells that touch these boundaries are refined further");
    add_count(prm,
              "Refine levels",
              body.boundary_refinements,
              0,
              max_refinements,
              dim == 3 ? "how many times: each divides edges of hexahedra by 3, of tetrahedra by 2"
                       : "how many times: each divides edges of quadrilaterals by 3, of triangles by 2");
  }

  template <int dim>
  void BodySection<dim>::declare(dealii::ParameterHandler &prm)
  {
    prm.enter_subsection("Body " + name);
    declare_geometry(prm);
    add_choice(prm,
               "Mirror",
               mirror,
               Choices<Mirror>{{"none", Mirror::none}, {"x", Mirror::x}, {"y", Mirror::y}},
               "first step of the placement: x turns x into -x, y turns y into -y");
    add_number(prm,
               "Rotation",
               body.placement.rotation,
               "degrees",
               Interval(),
               dim == 3
                 ? "second step of the placement: about an axis through the origin, counterclockwise seen against it"
                 : "second step of the placement: counterclockwise about the origin");
    if constexpr (dim == 3)
      add_point(prm, "Rotation axis", rotation_axis, "", Interval(), "direction of that axis, of any length");
    add_point(prm, "Translation", body.placement.translation, "mm", Interval(), "third step of the placement");
    add_count(prm,
              "Refinements",
              body.refinements,
              0,
              max_refinements,
              "uniform refinements of this body, on top of Discretization/Refinements");
    declare_refinement(prm);
    add_text(prm, "Material", material, "", "a name from Materials", "material of the body; must be set");
    if constexpr (dim == 2)
      add_number(prm,
                 "Thickness",
                 body.thickness,
                 "mm",
                 Interval::between(least_of_material, most_of_material),
                 "thickness out of the plane; bodies of revolution have none");
    for (const Fit &fit : fits<dim>())
      defaults[fit.parameter] = prm.get(fit.parameter);
    prm.leave_subsection();
  }

  template <int dim>
  void BodySection<dim>::check_parameters_fit(const Parameters &parameters) const
  {
    const std::string section = "Body " + name;
    for (const auto &[parameter, of_shapes] : fits<dim>())
      {
        // the default is harmless: a .prm printed by the program sets everything
        const auto value = parameters.value(section + "/" + parameter);
        if (contains(of_shapes, body.shape) || !value || trim(*value) == defaults.at(parameter))
          continue;
        std::vector<std::string> names;
        for (const Shape shape : of_shapes)
          names.push_back(name_of<dim>(shape));
        throw parameters.error(section + "/" + parameter,
                               "has no meaning for Shape = " + name_of<dim>(body.shape) + ", it belongs to " +
                                 join_names(names),
                               "remove it, or set Shape");
      }

    switch (body.shape)
      {
        case Shape::rectangle:
          return parameters.require(section + "/Size",
                                    std::string("set its edge lengths in mm, for example: set Size = 10, 10") +
                                      (dim == 3 ? ", 10" : ""));
        case Shape::mesh:
          return parameters.require(section + "/File", "set the mesh file, for example: set File = meshes/part.msh");
        case Shape::ring:
        case Shape::quarter_ring:
        case Shape::tube:
          parameters.require(section + "/Inner radius", "set it in mm, for example: set Inner radius = 5");
          [[fallthrough]];
        case Shape::disc:
        case Shape::half_disc:
        case Shape::quarter_disc:
        case Shape::ball:
        case Shape::half_ball:
        case Shape::cylinder:
          parameters.require(section + "/Radius", "set it in mm, for example: set Radius = 10");
      }
    if (body.shape == Shape::cylinder || body.shape == Shape::tube)
      parameters.require(section + "/Length", "set it in mm, for example: set Length = 10");
    if ((body.shape == Shape::ring || body.shape == Shape::quarter_ring || body.shape == Shape::tube) &&
        body.inner_radius >= body.radius)
      throw parameters.error(section + "/Inner radius",
                             "is not less than Radius = " + number_text(body.radius),
                             "give 0 < Inner radius < Radius");
    const bool is_ball = body.shape == Shape::ball || body.shape == Shape::half_ball;
    if (const unsigned int least = is_ball ? 8 : 4;
        (is_ball || body.shape == Shape::cylinder) && body.cells_along_arc % least != 0)
      throw parameters.error(section + "/Cells around",
                             "a " + name_of<dim>(body.shape) + " needs a multiple of " + std::to_string(least),
                             "give a multiple of " + std::to_string(least));
    if (body.shape == Shape::ring && body.cells && (*body.cells)[0] < 3)
      throw parameters.error(section + "/Cells",
                             "a ring needs at least 3 cells along its circumference",
                             "give 3 or more, then the cells across");
    if (body.shape == Shape::disc && (body.cells_along_arc % 4 != 0 || body.cells_along_arc < 8))
      throw parameters.error(section + "/Cells along arc",
                             "a disc is meshed in four quarters of at least 2 edges",
                             "give a multiple of 4, at least 8");
    if ((body.shape == Shape::half_disc || body.shape == Shape::quarter_disc) && body.cells_along_arc % 2 != 0)
      throw parameters.error(section + "/Cells along arc",
                             "a " + name_of<dim>(body.shape) + " needs an even number",
                             "give an even number");
  }

  template <int dim>
  Body<dim> BodySection<dim>::read(const Parameters &parameters, const Scene<dim> &scene) const
  {
    const std::string section = "Body " + name;
    check_parameters_fit(parameters);

    Body<dim> result          = body;
    result.name               = name;
    result.placement.mirror_x = mirror == Mirror::x;
    result.placement.mirror_y = mirror == Mirror::y;
    if constexpr (dim == 3)
      {
        if (!(rotation_axis.norm() > 0))
          throw parameters.error(section + "/Rotation axis", "has no length", "give a direction, for example: 0, 0, 1");
        result.placement.axis = rotation_axis;
      }
    result.refined_boundaries = split_list(refined_boundaries);
    const auto boundaries     = boundary_names(body.shape, dim);
    for (const std::string &boundary : result.refined_boundaries)
      if (body.shape != Shape::mesh && boundary != "*" &&
          std::find(boundaries.begin(), boundaries.end(), boundary) == boundaries.end())
        throw parameters.error(section + "/Refine towards",
                               "body '" + name + "' has no boundary '" + boundary + "'",
                               suggest_name(boundary, boundaries));
    if (!result.refined_boundaries.empty() && !parameters.is_set(section + "/Refine levels"))
      throw parameters.error(section + "/Refine towards",
                             "has no effect without Refine levels",
                             "set how many times, for example: set Refine levels = 1");
    if (result.refined_boundaries.empty() && body.boundary_refinements > 0)
      throw parameters.error(section + "/Refine levels",
                             "no boundary is named in Refine towards",
                             "name one, for example: set Refine towards = " +
                               (boundaries.empty() ? std::string("contact") : boundaries.front()));
    if (body.shape == Shape::mesh)
      {
        const auto found = parameters.find_file(body.file);
        if (!found)
          throw parameters.error(section + "/File",
                                 "there is no such file",
                                 "give a path from the directory of the .prm or from the working directory");
        result.file = *found;
      }

    std::vector<std::string> materials;
    for (const Material &candidate : scene.materials)
      materials.push_back(candidate.name);
    parameters.require(section + "/Material", "set a name from Materials (" + join_names(materials) + ")");
    result.material = std::find(materials.begin(), materials.end(), material) - materials.begin();
    if (result.material == materials.size())
      throw parameters.error(section + "/Material", "unknown material", suggest_name(material, materials));
    return result;
  }

  template struct BodySection<2>;
  template struct BodySection<3>;
} // namespace slipstick::scene
