#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/accuracy.h>
#include <slipstick/scene/adaptivity.h>

#include <algorithm>

namespace slipstick::scene
{
  namespace
  {
    using Knobs = std::vector<std::pair<std::string, std::string>>;

    const std::string name = "Accuracy", degree = "Discretization/Degree";

    // The accuracy of each preset, measured on problems with known solutions, is given in doc/accuracy.md.
    // `engineering` equals the defaults. The precision of the preconditioner is not included, since it does not affect
    // the solution.
    const std::vector<std::pair<std::string, Knobs>> presets = {{"draft",
                                                                 {{"Solver/Tolerance", "auto"},
                                                                  {"Solver/Operator precision", "single"},
                                                                  {"Solver/Prune contact", "true"},
                                                                  {"Friction/Tolerance", "1e-3"},
                                                                  {degree, "1"}}},
                                                                {"engineering",
                                                                 {{"Solver/Tolerance", "0.0001"},
                                                                  {"Solver/Operator precision", "double"},
                                                                  {"Solver/Prune contact", "true"},
                                                                  {"Friction/Tolerance", "1e-06"},
                                                                  {degree, "1"}}},
                                                                {"reference",
                                                                 {{"Solver/Tolerance", "1e-8"},
                                                                  {"Solver/Operator precision", "double"},
                                                                  {"Solver/Prune contact", "false"},
                                                                  {"Friction/Tolerance", "1e-8"},
                                                                  {degree, "2"}}}};

    // For a percentage: the algebraic error must be negligible in differences between meshes.
    const Knobs of_percentage = {{"Solver/Tolerance", "1e-06"},
                                 {"Solver/Operator precision", "double"},
                                 {"Solver/Prune contact", "true"},
                                 {"Friction/Tolerance", "1e-06"},
                                 {degree, "1"}};
  } // namespace

  std::vector<std::string> accuracy_names()
  {
    std::vector<std::string> names;
    for (const auto &preset : presets)
      names.push_back(preset.first);
    return names;
  }

  Knobs knobs_of_accuracy(const std::string &preset)
  {
    for (const auto &[word, knobs] : presets)
      if (word == preset)
        return knobs;
    return accuracy_of(preset) > 0 ? of_percentage : Knobs();
  }

  void apply_accuracy(const Parameters &parameters, const unsigned int dim, dealii::ParameterHandler &prm)
  {
    const auto preset = parameters.value(name), mesh = parameters.value(adaptive_mesh.first);
    if (preset) // a word that is not a preset is rejected by apply()
      for (const auto &[path, value] : knobs_of_accuracy(*preset))
        set_value(prm, path, value);
    if (mesh && *mesh == adaptive_mesh.second)
      for (const auto &[path, value] : of_percentage)
        if (path != degree)
          set_value(prm, path, value);
    // solids are refined as tetrahedra, which are too stiff with degree 1
    const bool refines = (preset && accuracy_of(*preset) > 0) || (mesh && *mesh == adaptive_mesh.second);
    if (dim == 3 && refines)
      set_value(prm, degree, "2");
  }
} // namespace slipstick::scene
