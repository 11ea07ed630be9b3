// Whether a displacement is small: strains, rotations, motions of whole bodies.
#pragma once

#include <slipstick/mechanics/spaces.h>

#include <Eigen/Dense>

namespace slipstick::mechanics
{
  /// A largest value and where it is.
  template <int dim>
  struct Peak
  {
    double             value = 0;
    unsigned int       body  = 0;
    dealii::Point<dim> position; // reference configuration: centre of the cell, node
  };

  /// Largest values over all cells, nodes and ranks.
  template <int dim>
  struct Deformation
  {
    Peak<dim> strain;   // largest principal strain, magnitude [-]
    Peak<dim> rotation; // of the cell's middle [rad]
    Peak<dim> motion;   // displacement of a node over the diagonal of the box around its body [-]
  };

  /// Of the displacements @p u of this rank's subdomains [mm], at the middle of every cell. Collective.
  template <int dim>
  Deformation<dim> largest_deformation(const scene::Scene<dim>            &scene,
                                       const mesh::Mesh<dim>              &mesh,
                                       const Spaces<dim>                  &spaces,
                                       const std::vector<Eigen::VectorXd> &u);
} // namespace slipstick::mechanics
