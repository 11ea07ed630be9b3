// Stiffness, loads and rigid motions of the subdomains.
#pragma once

#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/tfeti/subdomain_matrices.h>

namespace slipstick::mechanics
{
  /// K_p, f_p (at load factor @p t), R_p of the subdomains of this rank. Loads are forces on the whole thickness of the
  /// body, or on the whole circumference. With the nearly incompressible element K = sum of 2 mu eps : eps + lambda (P
  /// div)(P div), P: see DilatationProjection.
  /// Collective (rigid motions refer to the centre of the whole body).
  /// @throws InputError on all ranks for triangles of degree 1 with the nearly incompressible element, and as
  /// assemble_loads() does.
  template <int dim>
  std::vector<tfeti::SubdomainMatrices> assemble(const scene::Scene<dim> &scene,
                                                 const mesh::Mesh<dim>   &mesh,
                                                 const Spaces<dim>       &spaces,
                                                 const double             t);
} // namespace slipstick::mechanics
