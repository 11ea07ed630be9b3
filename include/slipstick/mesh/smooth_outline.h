// The smooth outline of a body from a mesh file.
#pragma once

#include <slipstick/mesh/body_mesh.h>

namespace slipstick::mesh
{
  /// Sets the curves of the boundary edges of an unrefined body from a mesh file, and adds a remark.
  ///
  /// With mid nodes off the chords (BodyMesh::middles) the curves are cubics through them with common tangents at the
  /// nodes, or parabolas where the cubic would be a different curve, as between corners. Otherwise they are
  /// reconstructed: cubics over the edges with common tangents at the nodes, those of the circle through a node and its
  /// two neighbours, which reproduces circles to 1e-6 of the sagitta with edges of 20 degrees. Corners, where curves
  /// end, are nodes where edges meet at Body::corner_angle or more, or at a much larger angle than at the neighbouring
  /// nodes, as where two straight sides meet. Edges in line with a neighbour stay straight and give their direction to
  /// an adjoining curve; edges with neither end inside a curve stay straight, too.
  ///
  /// If Body::has_smooth_outline is off, and on circles too coarse to be distinguished from a polygon, edges get no
  /// curve; only the neglected sagitta is stored (EdgeCurve::neglected_sagitta).
  template <int dim>
  void smooth_outline(const scene::Body<dim> &body, BodyMesh<dim> &mesh);

  /// Whether any body has an edge, in space a face, with a neglected sagitta. Collective.
  template <int dim>
  bool leaves_out_curves(const Mesh<dim> &mesh);
} // namespace slipstick::mesh
