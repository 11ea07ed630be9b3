// Names from a mesh file for parts of the outline of a body, and for points.
#pragma once

#include <slipstick/mesh/body_mesh.h>

#include <map>
#include <optional>
#include <set>
#include <string>

namespace slipstick::mesh
{
  /// Transfers names from a file to a body: Gmsh's physical groups, Abaqus' sets, etc.
  template <int dim>
  class NamesOfFile
  {
  public:
    using Face = typename MeshPiece<dim>::Face;

    /// All arguments must outlive this. @param n_cells_at faces of the body with the number of their cells.
    NamesOfFile(const MeshFile                             &file,
                const std::map<unsigned int, unsigned int> &vertex_of_node,
                const std::map<Face, unsigned int>         &n_cells_at)
      : file(file)
      , vertex_of_node(vertex_of_node)
      , n_cells_at(n_cells_at)
    {}

    /// Assigns the names of the lines (faces in space) of the file on the outline; the rest of the outline has no name.
    /// Lines that are not on the outline are listed in a remark about @p body, and the boundary is marked as
    /// incomplete, since loads on it would be incomplete.
    void name_boundaries(BodyMesh<dim> &mesh, const std::string &body) const;

    /// Assigns the names of single nodes.
    void name_points(BodyMesh<dim> &mesh) const;

  private:
    using Element = MeshFile::Element;
    using Names   = std::map<Face, std::set<std::string>>; // of every face of the outline
    /// Lines that are not on the outline: their number, and the first one, by name.
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
