// Rigid body modes from coordinates: the kernels of the torn subdomains.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/mesh/kinematics.h>
#include <slipstick/tfeti/subdomain_matrices.h>

#include <Eigen/Dense>

namespace slipstick::mechanics
{
  /// Point about which the rotation of a body is measured, and the length that makes it dimensionless.
  template <int dim>
  struct Frame
  {
    dealii::Point<dim> center;
    double             length = 1; // [mm]
  };

  /// Centre and half diagonal of the bounding box of every body. Collective.
  template <int dim>
  std::vector<Frame<dim>> body_frames(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh);

  /// Fills kernel: columns (1,0), (0,1), (-(y - y_c), x - x_c) / L at every node, with centre and length of the
  /// subdomain; for bodies of revolution (0,1) only. Also fills body_modes, which transforms these into the motions
  /// about the body's frame; frame; and positions.
  template <int dim>
  void rigid_modes(const Element<dim>            &element,
                   const dealii::DoFHandler<dim> &dof_handler,
                   const Frame<dim>              &body,
                   const mesh::Kinematics<dim>   &kinematics,
                   tfeti::SubdomainMatrices      &system);
} // namespace slipstick::mechanics
