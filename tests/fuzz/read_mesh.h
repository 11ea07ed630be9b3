// The body made of a mutated mesh file: what meshes.cc and parsers.cc share.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/mesh/body_mesh.h>

#include <string>

namespace slipstick::fuzz
{
  /// The body of all cells of the file.
  template <int dim>
  mesh::BodyMesh<dim> whole_body(const mesh::MeshFile &file)
  {
    scene::Body<dim> body;
    body.name  = "mutant";
    body.shape = scene::Shape::mesh;
    return mesh::body_from_file(body, file);
  }

  inline bool has_remedy(const InputError &error)
  {
    return std::string(error.what()).find("\n  remedy: ") != std::string::npos;
  }
} // namespace slipstick::fuzz
