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
  /// @param dim must be that of the scene, see read_dimension().
  /// @param adaptivity gets what the scene asks for beyond an answer on its mesh.
  /// @throws InputError for whatever is wrong with it.
  template <int dim = 2>
  Scene<dim> read_scene(const std::string              &file,
                        const std::vector<std::string> &overrides  = {},
                        AdaptivityOptions              *adaptivity = nullptr);

  /// The Dimension that @p file, or else an override, sets: 2 in the plane (the default), 3 in space.
  /// @throws InputError for another one, and as read_scene() does for what cannot be read at all.
  unsigned int read_dimension(const std::string &file, const std::vector<std::string> &overrides = {});

  /// Writes every parameter with default, unit, range and meaning, one named subsection of each kind as example. As
  /// prm it is a scene that runs.
  template <int dim = 2>
  void list_parameters(std::ostream &out, const ListFormat format);
} // namespace slipstick::scene
