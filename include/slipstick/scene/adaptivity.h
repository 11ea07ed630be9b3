// Requests beyond the solution on the given mesh: error bars, an accuracy to be reached.
#pragma once

#include <slipstick/scene/scene.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace dealii
{
  class ParameterHandler;
}

namespace slipstick::scene
{
  /// Names of the stress components in quantities; the last two in space only.
  inline constexpr std::array<const char *, 6> stress_components = {{"xx", "yy", "xy", "zz", "xz", "yz"}};

  /// The parameter and the value that make presets refine meshes.
  inline const std::pair<std::string, std::string> adaptive_mesh = {"Mesh", "adaptive"};

  struct AdaptivityOptions
  {
    bool                     error_bars  = false;     // one more linear problem per quantity
    bool                     adapts_mesh = false;     // Mesh = adaptive: to the accuracy of the preset
    double                   accuracy    = 0;         // relative error to reach; 0: no refinement
    std::vector<std::string> goals;                   // quantities to which it applies; empty: energy norm
    bool                     skips_unknown = false;   // goals that cannot be estimated are reported and omitted
    unsigned int             max_meshes    = 12;      // maximum number of meshes solved
    unsigned int             max_unknowns  = 2000000; // of the finest mesh

    /// Whether meshes are refined until the accuracy is reached.
    bool refines() const
    {
      return accuracy > 0;
    }
  };

  /// Admissible goals: max_displacement, strain_energy, PAIR.max_pressure, SUPPORT.force_x, ... Pairs found by the
  /// contact search have no names yet.
  template <int dim>
  std::vector<std::string> quantity_names(const Scene<dim> &scene);

  /// Goals of a preset, as far as they can be estimated: max_displacement, strain_energy, and for every pair its normal
  /// force and largest pressure.
  template <int dim>
  std::vector<std::string> goals_of_presets(const Scene<dim> &scene);

  /// The relative error given as "1 %"; 0 if @p text is not a percentage above 0 and below 100.
  double accuracy_of(const std::string &text);

  /// The relative error of a preset.
  double accuracy_of(const Accuracy preset);

  /// Declares `Error bars`, `Mesh` and `Goal` at the top level.
  void declare_goals(dealii::ParameterHandler &prm, AdaptivityOptions &options);

  /// Declares the subsection `Adaptivity`.
  void declare(dealii::ParameterHandler &prm, AdaptivityOptions &options);
} // namespace slipstick::scene
