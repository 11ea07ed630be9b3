// A bar of two floating chains of springs, glued together, held on the left, pulled towards a wall on the right by more
// than the gap. slipstick::tfeti makes the dual problem of it, slipstick::qp solves it: no mesh, no scene.
#include <slipstick/qp/smalbe.h>
#include <slipstick/tfeti/dual_problem.h>
#include <slipstick/tfeti/process.h>
#include <slipstick/tfeti/recovery.h>

#include <cstdio>

using namespace slipstick;
using Vector = tfeti::DistributedVector;

namespace
{
  constexpr unsigned int n         = 10;                           // nodes of a chain
  constexpr double       stiffness = 9e4, force = 100, gap = 1e-3; // of a spring [N/mm], [N], [mm]

  tfeti::SubdomainMatrices chain(const unsigned int number)
  {
    tfeti::SubdomainMatrices part;
    part.subdomain = number;
    Eigen::SparseMatrix<double> K(n, n); // lower triangle
    for (unsigned int i = 0; i + 1 < n; ++i)
      {
        K.coeffRef(i, i) += stiffness;
        K.coeffRef(i + 1, i + 1) += stiffness;
        K.coeffRef(i + 1, i) -= stiffness;
      }
    K.makeCompressed();
    part.stiffness     = std::move(K);
    part.load          = Eigen::VectorXd::Zero(n);
    part.kernel        = Eigen::MatrixXd::Ones(n, 1);
    part.body_modes    = Eigen::MatrixXd::Ones(1, 1);
    part.boundary_dofs = {0, n - 1};
    if (number == 1)
      part.load[n - 1] = force;
    return part;
  }
} // namespace

int main()
{
  tfeti::Process     process;
  tfeti::Constraints rows; // u(0) = 0, u(9) - v(0) = 0, v(9) <= gap
  rows.rows             = std::make_shared<dealii::Utilities::MPI::Partitioner>(3);
  rows.kind             = {tfeti::RowKind::prescribed, tfeti::RowKind::gluing, tfeti::RowKind::normal};
  rows.c                = {0, 0, gap};
  rows.label            = {0, 1, 2};
  rows.blocks           = {{{0, 0, 1.}, {1, n - 1, 1.}}, {{1, 0, -1.}, {2, n - 1, 1.}}};
  rows.interface_dofs   = std::make_shared<dealii::Utilities::MPI::Partitioner>(3);
  rows.interface_blocks = {{{0, 0}, {n - 1, 1}}, {{0, 1}, {n - 1, 2}}};
  std::vector<tfeti::SubdomainMatrices> parts;
  parts.push_back(chain(0));
  parts.push_back(chain(1));
  tfeti::DualProblem dual(std::move(parts), rows, {}, {"bar"}, MPI_COMM_SELF);

  // x = start + z with G start = e; b = P (d - F start), scaled
  const Vector start = dual.particular();
  Vector       b = dual.zero(), q = dual.zero();
  dual.multiply(start, b);
  b.sadd(-1., 1. / dual.norm(), dual.d());
  dual.project_range(b, q);
  b -= q;
  qp::Box<Vector> box{dual.zero(), dual.zero()};
  box.lower         = -qp::infinity;
  box.upper         = qp::infinity;
  box.lower(2)      = -start(2);
  const auto result = qp::smalbe(dual, 1., b, box, {dual.zero()}, 1e-12);
  Vector     x      = start;
  x += result.x;
  const auto solution = tfeti::recover(dual, x, {true, true, x(2) > 0});
  std::printf("status %d, force on the wall %.9g, displacement of its end %.9g\n",
              static_cast<int>(result.status),
              x(2),
              solution.u[1][n - 1]);
}
