// The mesh of one whole body, before it is cut into subdomains.
#pragma once

#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/mesh_piece.h>

#include <set>

namespace slipstick::mesh
{
  /// Cells of a body with the names of its boundaries and points. Global vertices are numbered from 0.
  template <int dim>
  struct BodyMesh
  {
    MeshPiece<dim>                                                             piece;
    std::map<std::string, dealii::types::boundary_id>                          boundary_ids; // by name
    std::map<dealii::types::boundary_id, std::set<dealii::types::boundary_id>> combined_ids; // as in Mesh
    std::map<std::string, unsigned int>                                        points;       // by name: local vertex
    std::map<typename MeshPiece<dim>::Face, dealii::Point<dim>>
                        middles; // mid nodes in the file: of edges of the outline, in space of faces
    std::vector<Remark> remarks;
    std::string         about_names; // MeshFile::about_names

    // by name: why a boundary or point cannot be used (parts of it are not on the outline; it consists of several
    // points)
    std::map<std::string, std::string> incomplete_boundaries, ambiguous_points;
  };

  /// The cells of @p file that belong to the body (those of Body::part, or all), scaled, but not yet placed, refined or
  /// smoothed. Lines with physical names on the outline of the body are its boundaries; named lines elsewhere are
  /// reported.
  /// @throws InputError for a missing part; for a file without plane cells; for cells that are inverted (unless all
  /// are), degenerate, self-intersecting or overlapping; for edges of three cells; for nodes inside edges and
  /// coincident nodes (see conformity.h); for a body that is not connected.
  template <int dim>
  BodyMesh<dim> body_from_file(const scene::Body<dim> &body, const MeshFile &file);

  /// A remark for every file with cells that no body of the scene uses.
  template <int dim>
  std::vector<Remark> unused_parts(const scene::Scene<dim> &scene, const std::map<std::string, MeshFile> &files);

  /// The mesh of a body of built-in shape (see shapes.h), refined @p refinements times, not yet placed.
  template <int dim>
  BodyMesh<dim> body_from_shape(const scene::Scene<dim> &scene, const scene::Body<dim> &body);
} // namespace slipstick::mesh
