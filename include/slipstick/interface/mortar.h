// The mortar integrals between two curves or surfaces; notation: mortar_row.h.
#pragma once

#include <slipstick/interface/curve_pairing.h>
#include <slipstick/interface/mortar_row.h>

namespace slipstick::interface
{
  /// The rows of the slave nodes that have a master within @p reach along the normal, on either side, in the order of
  /// the nodes. Sides must face each other: the first crossing of the ray counts.
  ///
  /// Mortar: phi_i are the functions biorthogonal to N_k on the covered part of the edge (D_i is then the integral of
  /// N_i), so that fully covered edges give d_ik = 1 for i = k and 0 otherwise (Wohlmuth 2000; at overhangs Cichosz,
  /// Bischoff 2011). On curved or quadratic edges that are covered in part phi_i are those of the linear shape
  /// functions: their midside nodes have no row. Equal pressures at all nodes then mean a uniform pressure on both
  /// sides, the weights add up to 1 and forces balance; moments balance where the gap is closed, otherwise up to the
  /// square of the mesh size. The gap is n_i . (sum_j m_ij y_j - sum_k d_ik x_k), that of the edges, plus the rise of
  /// the true curves (SurfaceEdge::curve) above the edges: n_i . <phi_i (rise of the master - rise of the slave) n> /
  /// D_i. The gap is thus that of the curves, while the weights, and with them the forces, are those of the edges. The
  /// end node of a quadratic edge on the axis of revolution has D_i = 0 and no row: equal pressure exerts no force on
  /// it. Node to node: m is 1 at the opposite master node, d is 1 at the slave node. `automatic` chooses it if every
  /// slave node has an exactly opposite master node.
  /// @param corners of both sides, at which the normal is that of the other side (corners_of()).
  /// @throws InputError, with @p name of the pair, when node to node is required and the meshes do not match.
  template <int dim>
  std::vector<MortarRow<dim>> mortar_rows(const std::vector<mechanics::SurfaceEdge<dim>> &slave,
                                          const std::vector<mechanics::SurfaceEdge<dim>> &master,
                                          const Reach                                    &reach,
                                          const scene::ContactDiscretization              discretization,
                                          const std::string                              &name,
                                          const mesh::Kinematics<dim>                    &kinematics = {},
                                          const Corners                                  &corners    = {});

  /// The same in space, with areas instead of lengths. Every slave facet is paired in the plane through its centre
  /// normal to the mean normal of its nodes: both sides are projected onto it, and the overlap polygons are clipped and
  /// integrated (Puso, Laursen 2004; Popp, Gitterle, Gee, Wall 2010). If several master facets lie one behind the
  /// other, the nearest counts. If the covered part of a facet is so small that its biorthogonal functions would be
  /// nearly dependent, phi_i are the shape functions themselves.
  std::vector<MortarRow<3>> mortar_rows(const std::vector<mechanics::SurfaceFacet> &slave,
                                        const std::vector<mechanics::SurfaceFacet> &master,
                                        const Reach                                &reach,
                                        const scene::ContactDiscretization          discretization,
                                        const std::string                          &name,
                                        const mesh::Kinematics<3>                  &kinematics = {},
                                        const Corners                              &corners    = {});
} // namespace slipstick::interface
