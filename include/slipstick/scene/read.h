// Reads a scene from a .prm file; lists all parameters.
#pragma once

#include <slipstick/scene/adaptivity.h>
#include <slipstick/scene/list_format.h>
#include <slipstick/scene/scene.h>

#include <iosfwd>

namespace slipstick::scene
{
  /// Reads and checks the scene in @p file, with @p overrides "Section/Sub/Name=value". Prints nothing and does not use
  /// MPI: every rank reads the file and obtains the same scene or error.
  /// @param dim must be that of the scene, see read_dimension().
  /// @param adaptivity returns the requests beyond the solution on the given mesh.
  /// @throws InputError for any fault in the scene.
  template <int dim = 2>
  Scene<dim> read_scene(const std::string              &file,
                        const std::vector<std::string> &overrides  = {},
                        AdaptivityOptions              *adaptivity = nullptr);

  /// The Dimension set by an override or by @p file: 2 in the plane (the default), 3 in space.
  /// @throws InputError for other values, and as read_scene() for a file that cannot be read at all.
  unsigned int read_dimension(const std::string &file, const std::vector<std::string> &overrides = {});

  /// Writes every parameter with default, unit, range and meaning, and one named subsection of each kind as an example.
  /// In prm format the result is a scene that can be run.
  template <int dim = 2>
  void list_parameters(std::ostream &out, const ListFormat format);
} // namespace slipstick::scene
