#include <slipstick/base/text.h>
#include <slipstick/scene/adaptivity.h>
#include <slipstick/scene/declare.h>

namespace slipstick::scene
{
  namespace
  {
    constexpr unsigned int most_meshes = 100, most_unknowns = 1000000000;
  }

  template <int dim>
  std::vector<std::string> quantity_names(const Scene<dim> &scene)
  {
    std::vector<std::string> names = {"max_displacement", "max_von_mises", "max_regular_von_mises", "strain_energy"};
    for (const auto &pair : scene.contacts)
      for (const char *what : {"normal_force", "tangential_force", "max_pressure", "pressure_norm", "traction_norm"})
        names.push_back(pair.name + "." + what);
    for (const auto &support : scene.supports)
      for (unsigned int d = 0; d < dim; ++d)
        names.push_back(support.name + ".force_" + "xyz"[d]);
    for (const auto &probe : scene.probes)
      if (probe.ends.size() == 1)
        {
          for (unsigned int d = 0; d < dim; ++d)
            names.push_back(probe.name + ".u_" + "xyz"[d]);
          for (unsigned int c = 0; c < 2 * dim; ++c)
            names.push_back(probe.name + ".stress_" + stress_components[c]);
          names.push_back(probe.name + ".von_mises");
        }
    return names;
  }

  template std::vector<std::string> quantity_names(const Scene<2> &);
  template std::vector<std::string> quantity_names(const Scene<3> &);

  template <int dim>
  std::vector<std::string> goals_of_presets(const Scene<dim> &scene)
  {
    std::vector<std::string> names = {"max_displacement", "strain_energy"};
    for (const auto &pair : scene.contacts)
      for (const char *what : {"normal_force", "max_pressure"})
        names.push_back(pair.name + "." + what);
    return names;
  }

  template std::vector<std::string> goals_of_presets(const Scene<2> &);
  template std::vector<std::string> goals_of_presets(const Scene<3> &);

  double accuracy_of(const Accuracy preset)
  {
    switch (preset)
      {
        case Accuracy::draft:
          return 0.1;
        case Accuracy::engineering:
          return 0.03;
        default:
          return 0.003;
      }
  }

  double accuracy_of(const std::string &text)
  {
    const auto sign = text.find_last_not_of(" \t");
    if (sign == std::string::npos || text[sign] != '%')
      return 0;
    const auto last    = sign == 0 ? std::string::npos : text.find_last_not_of(" \t", sign - 1);
    const auto percent = last == std::string::npos ? std::nullopt : parse_number(text.substr(0, last + 1));
    return percent && *percent > 0 && *percent < 100 ? *percent / 100 : 0.;
  }

  void declare_goals(dealii::ParameterHandler &prm, AdaptivityOptions &options)
  {
    add_flag(
      prm,
      "Error bars",
      options.error_bars,
      "estimate the discretisation errors of forces, pressures, lengths and displacements (one linear problem a figure: 15 "
      "to 100 % more time)");
    add_word(
      prm,
      adaptive_mesh.first,
      "fixed",
      {"fixed", adaptive_mesh.second},
      "fixed: as in the scene (it is still refined if Accuracy is a percentage); adaptive: refined until the quantities of "
      "Goal (default: displacement, energy, forces and pressures) have the accuracy of the preset: draft 10 %, "
      "engineering 3 %, reference 0.3 %",
      [&options](const std::string &word) { options.adapts_mesh = word == adaptive_mesh.second; });
    add_entry(
      prm,
      "Goal",
      "",
      "",
      "if meshes are refined: the quantities that must reach the accuracy, such as PAIR.max_pressure; empty: the energy "
      "norm, or with a preset the default described for Mesh",
      "names separated by commas",
      [](const std::string &) { return true; },
      [&options](const std::string &text) { options.goals = split_list(text); });
  }

  void declare(dealii::ParameterHandler &prm, AdaptivityOptions &options)
  {
    prm.enter_subsection("Adaptivity");
    add_count(prm, "Max meshes", options.max_meshes, 1, most_meshes, "maximum number of meshes");
    add_count(prm,
              "Max unknowns",
              options.max_unknowns,
              1,
              most_unknowns,
              "maximum number of unknowns of a mesh, summed over all subdomains");
    prm.leave_subsection();
  }
} // namespace slipstick::scene
