// A mesh of a text in one of the formats that slipstick reads, and the body made of it: what meshes.cc and parsers.cc share.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/mesh/body_mesh.h>

#include <array>
#include <string>

namespace slipstick::fuzz
{
  constexpr std::array<const char *, 5> mesh_formats{{".msh", ".inp", ".vtk", ".unv", ".ucd"}};

  inline mesh::MeshFile parse(const std::string &name, const std::string &format, const std::string &text)
  {
    if (format != ".msh" && text.find('\0') != std::string::npos)
      throw InputError("a byte that is 0", "read_mesh_file() refuses those");
    return format == ".msh"   ? mesh::parse_gmsh(name, text)
           : format == ".inp" ? mesh::parse_abaqus(name, text)
           : format == ".vtk" ? mesh::parse_vtk(name, text)
           : format == ".unv" ? mesh::parse_unv(name, text)
                              : mesh::parse_ucd(name, text);
  }

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
