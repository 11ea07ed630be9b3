// The curved faces of solids from mesh files of second order.
#pragma once

#include <slipstick/mesh/body_mesh.h>

namespace slipstick::mesh
{
  /// Gives the boundary faces of an unrefined solid from a mesh file the surfaces through the mid nodes of the file
  /// (MeshPiece::line_middles, BodyMesh::middles), and adds a remark. Edges and faces whose mid nodes are where those of straight
  /// ones are stay straight. Where Body::has_smooth_outline is off, all do, and faces know the sagitta that they leave out; so do
  /// those of meshes of first order, by the angles between them.
  void curve_faces(const scene::Body<3> &body, BodyMesh<3> &mesh);

  /// Largest distance of a surface from the middles of the straight edges of a face, corners around [mm].
  double sagitta(const FaceSurface &surface, const std::vector<dealii::Point<3>> &corners);
} // namespace slipstick::mesh
