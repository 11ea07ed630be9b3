// Result of the mortar integrals for one slave node.
//
// Notation: N_k shape functions of a slave edge, phi_i its test functions, y(x) the point of the master that the ray
// from x along the normal field of the pairing meets, <.> the integral over that part of the slave that has such a
// point, with the measure of the kinematics (of bodies of revolution the slave's circumference). A row states
// n_i . (sum_k d_ik u_k - sum_j m_ij u_j - sum_c omega_c x r_c) <= gap
// with d_ik = <phi_i N_k> / D_i, m_ij = <phi_i N_j(y)> / D_i, D_i = <phi_i>, sum_c r_c = sum_k d_ik x_k - sum_j m_ij y_j
// and the rotations omega_c of both sides around their points (gap_rotation.h).
#pragma once

#include <slipstick/mechanics/spaces.h>

namespace slipstick::interface
{
  using Weights = std::vector<std::pair<mechanics::NodeKey, double>>; // sorted by node, sum 1

  /// What carries a row across the distance of its points (gap_rotation.h): slave and master half of the gap each, the
  /// master also the lateral offset.
  constexpr unsigned int n_carriers = 3;

  /// Row of one slave node.
  template <int dim>
  struct MortarRow
  {
    mechanics::NodeKey              slave{};
    unsigned int                    side = 0;      // a node at a corner of the slave boundary has one row for each side
    dealii::Point<dim>              position;      // of the slave node [mm]
    dealii::Tensor<1, dim>          normal;        // outward, mean of both sides (CurvePairing)
    Weights                         slave_weights; // d_ik
    Weights                         master_weights;        // m_ij
    std::array<Weights, n_carriers> rotation_weights;      // of the nodes that tell the rotations, by carrier
    dealii::Point<dim>              master_position;       // sum_j m_ij y_j [mm]
    dealii::Tensor<1, dim>          apart;                 // sum_k d_ik x_k - sum_j m_ij y_j [mm]
    double                          gap               = 0; // along n_i [mm], negative when overlapping
    double                          measure           = 0; // D_i [mm], for bodies of revolution [mm^2]
    double                          length            = 0; // the same in the plane [mm]
    double                          neglected_sagitta = 0; // sagitta neglected by the edges, both sides [mm]
    double                          full_measure = 0, full_length = 0; // if the edges of this side were fully covered
  };
} // namespace slipstick::interface
