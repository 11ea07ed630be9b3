// Check whether a displacement is small: strains, rotations, motions of whole bodies.
#pragma once

#include <slipstick/mechanics/spaces.h>

#include <Eigen/Dense>

namespace slipstick::mechanics
{
  /// A maximum and its place.
  template <int dim>
  struct Peak
  {
    double             value = 0;
    unsigned int       body  = 0;
    dealii::Point<dim> position; // reference configuration: centre of the cell, node
  };

  /// Maxima over all cells, nodes and ranks.
  template <int dim>
  struct Deformation
  {
    Peak<dim> strain;   // largest principal strain, magnitude [-]
    Peak<dim> rotation; // in the middle of a cell [rad]
    Peak<dim> motion;   // nodal displacement over the diagonal of the body's bounding box [-]
  };

  /// Maxima for the displacements @p u of this rank's subdomains [mm], evaluated at the middle of every cell.
  /// Collective.
  template <int dim>
  Deformation<dim> largest_deformation(const scene::Scene<dim>            &scene,
                                       const mesh::Mesh<dim>              &mesh,
                                       const Spaces<dim>                  &spaces,
                                       const std::vector<Eigen::VectorXd> &u);
} // namespace slipstick::mechanics
