// Names of settings and contact pairs in .prm files, in the log and in summary.json.
#pragma once

#include <slipstick/output/contact_line.h>
#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/options.h>

#include <string>

namespace slipstick::app
{
  std::string name_of(const scene::Accuracy accuracy);
  std::string name_of(const scene::PlaneState state);
  std::string name_of(const scene::DecompositionMethod method);
  std::string name_of(const scene::Algorithm algorithm);
  std::string name_of(const tfeti::Preconditioner preconditioner);

  /// Names of the contact pairs and of their slave bodies.
  template <int dim>
  output::ContactNames contact_names(const scene::Scene<dim> &scene);
} // namespace slipstick::app
