// Curved faces of solids from second-order mesh files.
#pragma once

#include <slipstick/mesh/body_mesh.h>

namespace slipstick::mesh
{
  /// Sets the surfaces of the boundary faces of an unrefined solid from a mesh file to those through the mid nodes of
  /// the file (MeshPiece::line_middles, BodyMesh::middles), and adds a remark. Edges and faces with mid nodes at their
  /// straight positions stay straight. If Body::has_smooth_outline is off, all stay straight, and the neglected sagitta
  /// is stored with the faces; the same holds for first-order meshes, for which it is estimated from the angles between
  /// faces.
  void curve_faces(const scene::Body<3> &body, BodyMesh<3> &mesh);

  /// Largest distance of a surface from the midpoints of the straight edges of a face, corners in cyclic order [mm].
  double sagitta(const FaceSurface &surface, const std::vector<dealii::Point<3>> &corners);
} // namespace slipstick::mesh
