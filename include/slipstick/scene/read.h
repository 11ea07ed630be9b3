// From a .prm file to a scene, and the list of all parameters.
#pragma once

#include <slipstick/scene/adaptivity.h>
#include <slipstick/scene/list_format.h>
#include <slipstick/scene/scene.h>

#include <iosfwd>

namespace slipstick::scene
{
  /// Reads and checks the scene that @p file describes, with @p overrides "Section/Sub/Name=value". Prints nothing,
  /// knows no MPI: every rank reads and comes to the same scene or error.
  /// @param adaptivity gets what the scene asks for beyond an answer on its mesh.
  /// @throws InputError for whatever is wrong with it.
  Scene<2> read_scene(const std::string              &file,
                      const std::vector<std::string> &overrides  = {},
                      AdaptivityOptions              *adaptivity = nullptr);

  /// Writes every parameter with default, unit, range and meaning, one named subsection of each kind as example. As
  /// prm it is a scene that runs.
  void list_parameters(std::ostream &out, const ListFormat format);
} // namespace slipstick::scene
