// Stiffness, loads and rigid motions of the subdomains.
#pragma once

#include <slipstick/fem/spaces.h>
#include <slipstick/tfeti/subdomain_matrices.h>

namespace slipstick::fem
{
  /// Lame coefficients that make sigma = lambda tr(eps) I + 2 mu eps hold in the plane [MPa]. In plane stress lambda is
  /// the condensed one, 2 lambda mu / (lambda + 2 mu).
  struct LameCoefficients
  {
    double lambda, mu;
  };
  LameCoefficients lame_coefficients(const scene::Material &material, const scene::PlaneState state);

  /// K_p, f_p (at load factor @p t), R_p of the subdomains of this rank. Loads are forces of the body's thickness.
  /// Collective (rigid motions refer to the centre of the whole body).
  template <int dim>
  std::vector<tfeti::SubdomainMatrices> assemble(const scene::Scene<dim> &scene,
                                                 const Mesh<dim>         &mesh,
                                                 const Spaces<dim>       &spaces,
                                                 const double             t);
} // namespace slipstick::fem
