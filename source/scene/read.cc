#include <slipstick/base/nearest_name.h>
#include <slipstick/scene/accuracy.h>
#include <slipstick/scene/adaptivity.h>
#include <slipstick/scene/boundary_part.h>
#include <slipstick/scene/checks.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/listing.h>
#include <slipstick/scene/material_library.h>
#include <slipstick/scene/read.h>
#include <slipstick/scene/sections.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace slipstick::scene
{
  namespace
  {
    // The top-level lists, and the subsections whose names they declare.
    const std::string dimension_name = "Dimension";

    const NamedKind material_kind    = {"Material", "Materials", library_names()};
    const NamedKind body_kind        = {"Body", "Bodies"};
    const NamedKind obstacle_kind    = {"Obstacle", "Obstacles"};
    const NamedKind support_kind     = {"Support", "Supports"};
    const NamedKind foundation_kind  = {"Foundation", "Foundations"};
    const NamedKind traction_kind    = {"Traction", "Tractions"};
    const NamedKind body_force_kind  = {"Body force", "Body forces"};
    const NamedKind point_load_kind  = {"Point load", "Point loads"};
    const NamedKind temperature_kind = {"Temperature", "Temperatures"};
    const NamedKind pretension_kind  = {"Pretension", "Pretensions"};
    const NamedKind contact_kind     = {"Contact", "Contacts"};
    const NamedKind probe_kind       = {"Probe", "Probes"};

    const std::vector<NamedKind> named_kinds = {material_kind,
                                                body_kind,
                                                obstacle_kind,
                                                support_kind,
                                                foundation_kind,
                                                traction_kind,
                                                body_force_kind,
                                                point_load_kind,
                                                temperature_kind,
                                                pretension_kind,
                                                contact_kind,
                                                probe_kind};

    /// Names of each kind, by its list.
    using Names = std::map<std::string, std::vector<std::string>>;

    /// The whole .prm: declared at construction, read when the values are set.
    template <int dim>
    class SceneParameters
    {
    public:
      explicit SceneParameters(const Names &names);

      SceneParameters(const SceneParameters &) = delete;

      Scene<dim> read(const Parameters &parameters);

      dealii::ParameterHandler prm; // bound to the members below
      AdaptivityOptions        adaptivity;

    private:
      void declare_top_level(const Names &names);

      std::string                          variables;
      Scene<dim>                           options; // sections that do not refer to names
      std::vector<MaterialSection>         materials;
      std::vector<BodySection<dim>>        bodies;
      std::vector<ObstacleSection<dim>>    obstacles;
      std::vector<SupportSection<dim>>     supports;
      std::vector<FoundationSection<dim>>  foundations;
      std::vector<TractionSection<dim>>    tractions;
      std::vector<BodyForceSection<dim>>   body_forces;
      std::vector<PointLoadSection<dim>>   point_loads;
      std::vector<TemperatureSection<dim>> temperatures;
      std::vector<PretensionSection<dim>>  pretensions;
      std::vector<ContactSection<dim>>     contacts;
      std::vector<ProbeSection<dim>>       probes;
      ContactSearchSection<dim>            contact_search;
    };

    template <int dim>
    SceneParameters<dim>::SceneParameters(const Names &names)
      : materials(names.at(material_kind.list).begin(), names.at(material_kind.list).end())
      , bodies(names.at(body_kind.list).begin(), names.at(body_kind.list).end())
      , obstacles(names.at(obstacle_kind.list).begin(), names.at(obstacle_kind.list).end())
      , supports(names.at(support_kind.list).begin(), names.at(support_kind.list).end())
      , foundations(names.at(foundation_kind.list).begin(), names.at(foundation_kind.list).end())
      , tractions(names.at(traction_kind.list).begin(), names.at(traction_kind.list).end())
      , body_forces(names.at(body_force_kind.list).begin(), names.at(body_force_kind.list).end())
      , point_loads(names.at(point_load_kind.list).begin(), names.at(point_load_kind.list).end())
      , temperatures(names.at(temperature_kind.list).begin(), names.at(temperature_kind.list).end())
      , pretensions(names.at(pretension_kind.list).begin(), names.at(pretension_kind.list).end())
      , contacts(names.at(contact_kind.list).begin(), names.at(contact_kind.list).end())
      , probes(names.at(probe_kind.list).begin(), names.at(probe_kind.list).end())
    {
      options.decomposition.method = DecompositionMethod::automatic;
      if (dim == 3) // solids use its coefficients
        options.plane_state = PlaneState::plane_strain;
      declare_top_level(names);
      const auto declare_all = [this](auto &sections) {
        for (auto &section : sections)
          section.declare(prm);
      };
      declare_all(materials);
      declare_all(bodies);
      declare_all(obstacles);
      declare_all(supports);
      declare_all(foundations);
      declare_all(tractions);
      declare_all(body_forces);
      declare_all(point_loads);
      declare_all(temperatures);
      declare_all(pretensions);
      declare_all(contacts);
      declare_all(probes);
      contact_search.declare(prm);
      declare(prm, options.discretization);
      declare(prm, options.decomposition);
      declare_load_steps(prm, options.load_factors);
      declare(prm, options.friction);
      declare(prm, options.solver);
      declare(prm, options.output);
      declare(prm, adaptivity);
    }

    template <int dim>
    void SceneParameters<dim>::declare_top_level(const Names &names)
    {
      add_word(prm,
               dimension_name,
               dim == 3 ? "3" : "2",
               {"2", "3"},
               "2: bodies in the plane or of revolution; 3: solids",
               [](const std::string &) {});
      add_text(prm, "Title", options.title, "", "one line of text", "what the scene shows");
      add_text(prm,
               "Variables",
               variables,
               "",
               "NAME = NUMBER; NAME = NUMBER; ...",
               "numbers that other values use as {NAME} or {10 - NAME/2}; later ones may use earlier ones");
      if (dim == 2)
        add_choice(
          prm,
          "Plane state",
          options.plane_state,
          Choices<PlaneState>{{"plane stress", PlaneState::plane_stress},
                              {"plane strain", PlaneState::plane_strain},
                              {"axisymmetric", PlaneState::axisymmetric}},
          "meaning of the plane section, for all bodies; axisymmetric: half a section of bodies of revolution, x the "
          "radius, y the axis, all forces over the whole circumference");
      const auto presets = std::vector<std::pair<std::string, Accuracy>>{{"draft", Accuracy::draft},
                                                                         {"engineering", Accuracy::engineering},
                                                                         {"reference", Accuracy::reference}};
      add_entry(
        prm,
        "Accuracy",
        "engineering",
        "",
        "preset of Tolerance, Operator precision and Prune contact of the solver, Friction/Tolerance and "
        "Discretization/Degree (values that the scene sets take precedence); or the relative error to reach by refining "
        "meshes, in the energy norm or that of Goal",
        choice_prefix + "draft, engineering, reference, or a percentage such as 1 %",
        [presets](const std::string &text) {
          return accuracy_of(text) > 0 || std::any_of(presets.begin(), presets.end(), [&text](const auto &preset) {
                   return preset.first == text;
                 });
        },
        [this, presets](const std::string &text) {
          adaptivity.accuracy = accuracy_of(text);
          options.accuracy    = Accuracy::engineering;
          for (const auto &[word, accuracy] : presets)
            if (word == text)
              options.accuracy = accuracy;
        });
      declare_goals(prm, adaptivity);
      for (const NamedKind &kind : named_kinds)
        add_entry(
          prm,
          kind.list,
          "",
          "",
          "names, each described by a subsection " + kind.kind + " NAME",
          "names separated by commas",
          [](const std::string &) { return true; },
          [](const std::string &) {});
      for (const NamedKind &kind : named_kinds)
        prm.set(kind.list, join_names(names.at(kind.list))); // example: the lists are not read from a file
    }

    /// Resolves the method `auto` of the decomposition.
    template <int dim>
    DecompositionMethod automatic_method(const Scene<dim> &scene)
    {
      for (const Body<dim> &body : scene.bodies)
        if (body.shape != Shape::rectangle || body.cells ||
            (body.boundary_refinements > 0 && !body.refined_boundaries.empty()))
          return DecompositionMethod::metis;
      return has_boundary_parts(scene) ? DecompositionMethod::metis : DecompositionMethod::blocks;
    }

    template <int dim>
    Scene<dim> SceneParameters<dim>::read(const Parameters &parameters)
    {
      Scene<dim> scene = options;
      for (const auto &section : materials)
        scene.materials.push_back(section.read());
      for (const auto &section : bodies)
        scene.bodies.push_back(section.read(parameters, scene));
      for (const auto &section : obstacles)
        scene.obstacles.push_back(section.read(parameters));
      for (const auto &section : supports)
        scene.supports.push_back(section.read(parameters, scene));
      for (const auto &section : foundations)
        scene.foundations.push_back(section.read(parameters, scene));
      for (const auto &section : tractions)
        scene.tractions.push_back(section.read(parameters, scene));
      for (const auto &section : body_forces)
        scene.body_forces.push_back(section.read(parameters, scene));
      for (const auto &section : point_loads)
        scene.point_loads.push_back(section.read(parameters, scene));
      for (const auto &section : temperatures)
        scene.temperatures.push_back(section.read(parameters, scene));
      for (const auto &section : pretensions)
        scene.pretensions.push_back(section.read(parameters, scene));
      for (const auto &section : contacts)
        {
          scene.contacts.push_back(section.read(parameters, scene));
          for (const auto &warning : section.law.without_effect(parameters, "Contact " + section.name))
            scene.warnings.push_back(warning);
        }
      scene.contact_search = contact_search.read(parameters);
      for (const auto &section : probes)
        scene.probes.push_back(section.read(parameters, scene));
      if (scene.decomposition.method == DecompositionMethod::automatic)
        scene.decomposition.method = automatic_method(scene);
      for (const Body<dim> &body : scene.bodies)
        if (body.shape == Shape::mesh) // the path found, so that the printed .prm can be run from any directory
          set_value(prm, "Body " + body.name + "/File", body.file);
      for (const Obstacle<dim> &obstacle : scene.obstacles)
        if (obstacle.shape == ObstacleShape::stl)
          set_value(prm, "Obstacle " + obstacle.name + "/File", obstacle.file);
      scene.parameters = print_values(prm);
      return scene;
    }

    /// For Mesh = adaptive: sets the accuracy and the goals of the preset.
    template <int dim>
    void resolve_mesh(AdaptivityOptions &adaptivity, const Scene<dim> &scene)
    {
      if (adaptivity.adapts_mesh && !adaptivity.refines())
        {
          adaptivity.accuracy = accuracy_of(scene.accuracy);
          if (adaptivity.goals.empty())
            {
              adaptivity.goals         = goals_of_presets(scene);
              adaptivity.skips_unknown = true;
            }
        }
    }

    /// Warns of a limit of a refinement that does not take place. Max unknowns guards scenes of any kind.
    template <int dim>
    void check_limits(const AdaptivityOptions &adaptivity, const Parameters &parameters, Scene<dim> &scene)
    {
      if (const std::string path = "Adaptivity/Max meshes";
          parameters.is_set(path) && !adaptivity.refines() && adaptivity.max_meshes != AdaptivityOptions().max_meshes)
        scene.warnings.push_back(
          parameters.locate(path) + " = '" + std::to_string(adaptivity.max_meshes) +
          "' has no effect: no accuracy is requested, and the mesh is not refined; set Accuracy = 1 %, "
          "or Mesh = adaptive, or leave it out");
    }

    /// Checks that the goals are quantities of the scene.
    template <int dim>
    void check_goals(const AdaptivityOptions &adaptivity, const Scene<dim> &scene, const Parameters &parameters)
    {
      if (adaptivity.goals.empty())
        return;
      if (!adaptivity.refines())
        throw parameters.error("Goal",
                               "no accuracy is requested to which it would apply",
                               "set Accuracy = 1 %, or Mesh = adaptive, or leave the goal out");
      const auto names = quantity_names(scene);
      for (const std::string &goal : adaptivity.goals)
        if (std::find(names.begin(), names.end(), goal) == names.end())
          {
            const std::string last = goal.substr(goal.rfind('.') + 1);
            for (const char *size : {"contact_length", "stick_length", "contact_area", "stick_area"})
              if (last == size)
                throw parameters.error("Goal",
                                       "lengths and areas of contact, such as '" + goal + "', cannot be goals",
                                       "use a force, a largest pressure or a norm of the pair instead");
            throw parameters.error("Goal", "there is no quantity '" + goal + "'", suggest_name(goal, names));
          }
      const bool has_bolts = !scene.pretensions.empty(); // as in app::goal_errors
      if (std::find(adaptivity.goals.begin(), adaptivity.goals.end(), "strain_energy") != adaptivity.goals.end() &&
          !adaptivity.skips_unknown && (has_bolts || !scene.temperatures.empty()))
        throw parameters.error(
          "Goal",
          std::string("strain_energy has no estimate in scenes with ") +
            (has_bolts ? "bolts" : "changes of temperature"),
          "leave it out of the goals, or leave Goal out: Accuracy = 1 % then applies to the energy "
          "norm");
    }
  } // namespace

  template <int dim>
  Scene<dim> read_scene(const std::string              &file,
                        const std::vector<std::string> &overrides,
                        AdaptivityOptions              *adaptivity)
  {
    const Parameters parameters(file, overrides, named_kinds);
    Names            names;
    for (const NamedKind &kind : named_kinds)
      names[kind.list] = parameters.names(kind);

    SceneParameters<dim> declared(names);
    apply_accuracy(parameters, dim, declared.prm);
    apply_library(parameters, names.at(material_kind.list), declared.prm);
    try
      {
        parameters.apply(declared.prm);
      }
    catch (const InputError &)
      {
        constexpr int          other = dim == 2 ? 3 : 2;
        SceneParameters<other> there(names);
        parameters.refuse_foreign(declared.prm,
                                  there.prm,
                                  dim == 2 ? "space (Dimension = 3)" : "the plane (Dimension = 2)");
        throw;
      }
    Scene<dim> scene = declared.read(parameters);
    scene.name       = std::filesystem::path(file).stem().string();
    check_scene(scene, parameters);
    resolve_mesh(declared.adaptivity, scene);
    check_limits(declared.adaptivity, parameters, scene);
    check_goals(declared.adaptivity, scene, parameters);
    if (adaptivity)
      *adaptivity = declared.adaptivity;
    return scene;
  }

  unsigned int read_dimension(const std::string &file, const std::vector<std::string> &overrides)
  {
    const Parameters parameters(file, overrides, named_kinds);
    const auto       text = parameters.value(dimension_name);
    if (!text || *text == "2")
      return 2;
    if (*text != "3")
      throw parameters.error(dimension_name,
                             "is not available; available: 2 (plane), 3 (space)",
                             "choose one of these");
    return 3;
  }

  template <int dim>
  void list_parameters(std::ostream &out, const ListFormat format)
  {
    const std::string                                      z = dim == 3 ? ", 0" : "";
    SceneParameters<dim>                                   example({{material_kind.list, {"elastic"}},
                                                                    {body_kind.list, {"box"}},
                                                                    {obstacle_kind.list, {"disc"}},
                                                                    {support_kind.list, {"held"}},
                                                                    {foundation_kind.list, {"bed"}},
                                                                    {traction_kind.list, {"pressed"}},
                                                                    {body_force_kind.list, {"gravity"}},
                                                                    {point_load_kind.list, {"pull"}},
                                                                    {temperature_kind.list, {"warm"}},
                                                                    {pretension_kind.list, {"bolt"}},
                                                                    {contact_kind.list, {"circle"}},
                                                                    {probe_kind.list, {"tip"}}});
    const std::vector<std::pair<std::string, std::string>> must_be_set = {
      {"Body box/Size", dim == 3 ? "10, 10, 10" : "10, 10"},
      {"Body box/Material", "elastic"},
      {"Obstacle disc/Center", "5, -20" + z},
      {"Obstacle disc/Radius", "20"},
      {"Support held/Boundary", "box/left"},
      {"Support held/Displacement x", "0"},
      {"Support held/Displacement y", "0"},
      {"Foundation bed/Boundary", "box/bottom"},
      {"Foundation bed/Normal stiffness", "10"},
      {"Traction pressed/Boundary", "box/top"},
      {"Traction pressed/Traction y", "-250"},
      {"Body force gravity/Acceleration y", "-9810"},
      {"Point load pull/Body", "box"},
      {"Point load pull/Point", "10, 10" + z},
      {"Point load pull/Force x", "100"},
      {"Temperature warm/Change", "50"},
      {"Pretension bolt/Body", "box"},
      {"Pretension bolt/Point", "5, 5" + z},
      {"Pretension bolt/Direction", "0, 1" + z},
      {"Pretension bolt/Force", "1000"},
      {"Material elastic/Density", "7.85e-9"},
      {"Material elastic/Thermal expansion", "1.2e-5"},
      {"Contact circle/Slave", "box/bottom"},
      {"Contact circle/Master", "disc"},
      {"Probe tip/Body", "box"},
      {"Probe tip/Point", "10, 10" + z}};
    for (const auto &[path, value] : must_be_set)
      set_value(example.prm, path, value);
    if (dim == 3) // the default of 200^3 cells would be too many
      for (const auto &[path, value] : {std::pair("Decomposition/Blocks", "2"), {"Decomposition/Cells per block", "4"}})
        set_value(example.prm, path, value);
    write_parameters(out, example.prm, format);
  }

  template Scene<2> read_scene(const std::string &, const std::vector<std::string> &, AdaptivityOptions *);
  template Scene<3> read_scene(const std::string &, const std::vector<std::string> &, AdaptivityOptions *);
  template void     list_parameters<2>(std::ostream &, const ListFormat);
  template void     list_parameters<3>(std::ostream &, const ListFormat);
} // namespace slipstick::scene
