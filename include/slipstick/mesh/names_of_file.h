// The names that a mesh file gives to parts of the outline of a body, and to points.
#pragma once

#include <slipstick/mesh/body_mesh.h>

#include <map>
#include <optional>
#include <set>
#include <string>

namespace slipstick::mesh
{
  /// Puts names from a file into a body: Gmsh's physical groups, Abaqus' sets and the like.
  template <int dim>
  class NamesOfFile
  {
  public:
    using Face = typename MeshPiece<dim>::Face;

    /// All must live as long as this. @param n_cells_at faces of the body with the number of their cells.
    NamesOfFile(const MeshFile                             &file,
                const std::map<unsigned int, unsigned int> &vertex_of_node,
                const std::map<Face, unsigned int>         &n_cells_at)
      : file(file)
      , vertex_of_node(vertex_of_node)
      , n_cells_at(n_cells_at)
    {}

    /// Lines (faces in space) of the file at the outline give it their names; the rest of the outline has none. What is
    /// not on the outline is listed in a remark about @p body, and the boundary is marked as incomplete, as it would
    /// lose its share of a load.
    void name_boundaries(BodyMesh<dim> &mesh, const std::string &body) const;

    /// Names of single nodes.
    void name_points(BodyMesh<dim> &mesh) const;

  private:
    using Element = MeshFile::Element;
    using Names   = std::map<Face, std::set<std::string>>; // of every face of the outline
    /// Lines that are no part of the outline: how many, and the first one, by name.
    using LeftOut = std::map<std::string, std::pair<unsigned int, std::string>>;

    std::optional<Face> face_of(const Element &element) const;
    std::string         place_of(const Element &element) const;
    Names               names_of_outline() const;
    void                number_boundaries(BodyMesh<dim> &mesh, const Names &names) const;
    LeftOut             left_out_lines(const Names &names) const;
    void                note_incomplete_sets(BodyMesh<dim> &mesh, const Names &names) const;

    const MeshFile                             &file;
    const std::map<unsigned int, unsigned int> &vertex_of_node;
    const std::map<Face, unsigned int>         &n_cells_at;
  };
} // namespace slipstick::mesh
