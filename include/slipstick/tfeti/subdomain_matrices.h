// Input of the dual problem for one subdomain: plain data, filled by the finite element layer.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <array>
#include <vector>

namespace slipstick::tfeti
{
  /// Point about which the rotation of a body is measured, and the length that makes it dimensionless.
  struct BodyFrame
  {
    std::array<double, 3> center{{0, 0, 0}}; // [mm]
    double                length = 1;        // [mm]
  };

  /// Eigen 3.4 copies a sparse matrix where a move is intended; K_p would be stored three times.
  class MovableSparseMatrix : public Eigen::SparseMatrix<double>
  {
  public:
    MovableSparseMatrix()                            = default;
    MovableSparseMatrix(const MovableSparseMatrix &) = default;
    MovableSparseMatrix(MovableSparseMatrix &&other) noexcept
    {
      swap(other);
    }
    MovableSparseMatrix(Eigen::SparseMatrix<double> &&other) noexcept
    {
      swap(other);
    }
    MovableSparseMatrix &operator=(MovableSparseMatrix other) noexcept
    {
      swap(other);
      return *this;
    }
  };

  /// Whether k is the number of rigid motions of a solid in space.
  constexpr bool is_solid(const unsigned int k)
  {
    return k == 6;
  }

  /// Number of translations among the k rigid motions of a body; they come first, followed by the rotations. Solids
  /// have six motions, plane sections three, bodies of revolution one (along the axis).
  constexpr unsigned int n_translations(const unsigned int k)
  {
    return is_solid(k) ? 3 : k == 3 ? 2 : k;
  }

  /// K_p, f_p, R_p of one floating subdomain with n unknowns and k rigid motions.
  struct SubdomainMatrices
  {
    unsigned int              subdomain = 0; // global number
    unsigned int              body      = 0;
    MovableSparseMatrix       stiffness;     // n x n [N/mm], lower triangle only, columns compressed and sorted
    Eigen::VectorXd           load;          // n [N]
    Eigen::MatrixXd           kernel;        // n x k: motions of unit size about the subdomain's centre
    Eigen::MatrixXd           body_modes;    // k x k: kernel * body_modes = rigid motions of the body on this subdomain
    Eigen::MatrixXd           positions;     // of the nodes, one per column [mm]; for messages
    Eigen::VectorXd           volumes;       // of the nodes, parts of their cells [mm^3]; empty: all the same
    BodyFrame                 frame;         // of the body's motions
    std::vector<unsigned int> boundary_dofs; // unknowns on the boundary of the subdomain, sorted
  };
} // namespace slipstick::tfeti
