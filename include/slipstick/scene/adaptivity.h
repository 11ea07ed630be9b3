// What a run is asked for beyond the answer on the mesh as the scene has it: error bars, an accuracy to reach.
#pragma once

#include <slipstick/scene/scene.h>

#include <string>
#include <utility>
#include <vector>

namespace dealii
{
  class ParameterHandler;
}

namespace slipstick::scene
{
  /// The parameter, and its value, with which presets refine meshes.
  inline const std::pair<std::string, std::string> adaptive_mesh = {"Mesh", "adaptive"};

  struct AdaptivityOptions
  {
    bool                     error_bars  = false;     // one more linear problem a figure, for its error bar
    bool                     adapts_mesh = false;     // Mesh = adaptive: the accuracy is that which a preset means
    double                   accuracy    = 0;         // relative error to reach; 0: the mesh stays as it is
    std::vector<std::string> goals;                   // quantities that are to have it; empty: the energy norm
    bool                     skips_unknown = false;   // goals that cannot be estimated are left out, and said
    unsigned int             max_meshes    = 12;      // solved in all
    unsigned int             max_unknowns  = 2000000; // of the finest mesh

    /// Are meshes refined until the accuracy is reached?
    bool refines() const
    {
      return accuracy > 0;
    }
  };

  /// What can be a goal: max_displacement, strain_energy, PAIR.max_pressure, SUPPORT.force_x, ... Pairs that are found by
  /// search have no names yet.
  template <int dim>
  std::vector<std::string> quantity_names(const Scene<dim> &scene);

  /// What a preset promises, where it can be estimated: max_displacement, strain_energy, and of every pair its normal force
  /// and largest pressure.
  template <int dim>
  std::vector<std::string> goals_of_presets(const Scene<dim> &scene);

  /// The relative error that "1 %" spells; 0 if @p text is no percentage above 0 and below 100.
  double accuracy_of(const std::string &text);

  /// The relative error that a preset stands for.
  double accuracy_of(const Accuracy preset);

  /// `Error bars`, `Mesh` and `Goal`, at the top level.
  void declare_goals(dealii::ParameterHandler &prm, AdaptivityOptions &options);

  /// Subsection `Adaptivity`.
  void declare(dealii::ParameterHandler &prm, AdaptivityOptions &options);
} // namespace slipstick::scene
