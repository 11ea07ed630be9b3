// The contact problem of a scene as plain matrices: all that the dense solver gets to see.
//
//   min 1/2 u'K u - f'u + sum_k bound_k |b_k u - c_k|   s.t.  normal rows b u <= c, bonds b u = c, held nodes
//
// of the bodies in one piece each. A Coulomb bound is mu times the multiplier of the normal row of its node.
#pragma once

#include <Eigen/Dense>

#include <array>
#include <string>
#include <vector>

namespace slipstick::random
{
  enum class RowKind
  {
    bond,
    normal,
    tangential
  };

  struct Row
  {
    RowKind                             kind = RowKind::normal;
    std::vector<std::pair<int, double>> b; // unknown, coefficient
    double                              c      = 0;
    double                              bound  = 0;  // tangential: Tresca bound [force]
    double                              mu     = -1; // tangential: Coulomb coefficient, else negative
    int                                 normal = -1; // tangential, Coulomb: the normal row of the node
  };

  /// A node with contact rows, as results name it.
  struct ContactNode
  {
    unsigned int          pair = 0;
    std::array<double, 2> position{{0, 0}};
    double                area       = 1; // traction times area is the force
    int                   normal     = -1;
    int                   tangential = -1; // rows
  };

  struct HeldDirection
  {
    int             node = 0;
    Eigen::Vector2d direction;
    double          value     = 0; // prescribed ...
    double          stiffness = 0; // ... or, when positive, a spring
  };

  struct Body
  {
    int             first = 0; // unknown
    Eigen::MatrixXd K;
  };

  struct Problem
  {
    std::vector<Eigen::Vector2d> positions; // of nodes; unknowns 2 i, 2 i + 1
    std::vector<Body>            bodies;
    Eigen::VectorXd              f;
    std::vector<HeldDirection>   held;
    std::vector<Row>             rows;
    std::vector<ContactNode>     nodes;
    double                       size           = 0;     // of the largest body
    bool                         is_held_inside = false; // a contact node in the other side, by supports alone
  };
} // namespace slipstick::random
