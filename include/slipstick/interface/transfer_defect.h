// What the elements on both sides of a contact cannot represent of its tractions.
#pragma once

#include <slipstick/mechanics/surface.h>
#include <slipstick/mesh/mesh.h>
#include <slipstick/scene/scene.h>

#include <Eigen/Dense>

#include <vector>

namespace slipstick::interface
{
  /// An edge or facet with contact tractions on all or part of it. Its nodal forces are those of the projection of the
  /// tractions onto its shape functions; where the other side ends within it, or is finer, the rest acts on the body
  /// but not on its elements.
  template <int dim>
  struct TransferDefect
  {
    mechanics::BoundaryPart<dim> part;

    /// Nodes of the slave whose tractions act on the part.
    std::vector<mechanics::NodeKey> nodes;

    /// t_1' R t_2, for two fields of nodal tractions and each of their components: the sum of the products of their
    /// coefficients of the orthonormal polynomials of the first degree k that the elements do not contain, over k
    /// [mm^2; in the plane per thickness, mm]. Symmetric, positive semidefinite.
    Eigen::MatrixXd rest;
  };

  /// The defects on both sides of a pair of bodies that is coupled by mortar integrals; tractions are those of the
  /// slave's nodes, interpolated over the part of its edges or facets that the master covers. Parts without a defect
  /// are left out. The same on every rank. @param all outlines of the bodies.
  template <int dim>
  std::vector<TransferDefect<dim>> transfer_defects(const scene::Scene<dim>                         &scene,
                                                    const mesh::Mesh<dim>                           &mesh,
                                                    const scene::ContactPair<dim>                   &pair,
                                                    const std::vector<mechanics::BoundaryPart<dim>> &all);
} // namespace slipstick::interface
