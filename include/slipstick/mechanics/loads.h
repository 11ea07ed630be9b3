// Loads of the subdomains: tractions, pressure, body forces, point loads, thermal strain.
#pragma once

#include <slipstick/mechanics/load_resultant.h>
#include <slipstick/mechanics/spaces.h>

#include <Eigen/Dense>

#include <vector>

namespace slipstick::mechanics
{
  /// Resultants of the tractions, the body forces and the point loads of the scene, in this order, at load factor @p t.
  /// The same on all ranks. Collective.
  template <int dim>
  std::vector<LoadResultant> load_resultants(const scene::Scene<dim> &scene,
                                             const mesh::Mesh<dim>   &mesh,
                                             const Spaces<dim>       &spaces,
                                             const double             t);

  /// f_p [N] at load factor @p t, by subdomain of this rank. Forces per area and per volume act on the body's
  /// thickness, or on the whole circumference; pressure acts against the outward normal of the undeformed boundary; a
  /// point load acts, undivided, on one copy of the node nearest to it (no thickness, no circumference). Formulas of
  /// tractions are integrated by AdaptiveQuadrature and AdaptiveCubature, including jumps. Thermal strain enters as the
  /// force of the stress that would suppress it. Collective.
  /// @throws InputError on all ranks for a formula whose value is not a number and for a point load outside its body.
  template <int dim>
  std::vector<Eigen::VectorXd> assemble_loads(const scene::Scene<dim> &scene,
                                              const mesh::Mesh<dim>   &mesh,
                                              const Spaces<dim>       &spaces,
                                              const double             t);
} // namespace slipstick::mechanics
