// Cost of the coarse problem of N x N square subdomains on one rank: benchmark_coarse N...
#include <slipstick/tfeti/coarse_solver.h>

#include <deal.II/base/mpi.h>

#include <sys/resource.h>

#include <cstdio>
#include <ctime>

using slipstick::tfeti::CoarseSolver;

namespace
{
  constexpr unsigned int n_motions = 3, nodes_of_edge = 11;

  double cpu_seconds()
  {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  }

  /// Rigid motions of a square of side 2 about (0, 0) at a point: 2 x 3.
  Eigen::Matrix<double, 2, n_motions> motions(const double x, const double y)
  {
    return (Eigen::Matrix<double, 2, n_motions>() << 1, 0, -y, 0, 1, x).finished();
  }

  struct Matrix
  {
    CoarseSolver::Entries entries;

    void add(const unsigned int a, const unsigned int b, const Eigen::Matrix3d &block)
    {
      for (unsigned int i = 0; i < n_motions; ++i)
        for (unsigned int j = 0; j < n_motions; ++j)
          if (n_motions * a + i >= n_motions * b + j)
            entries.push_back({n_motions * a + i, n_motions * b + j, block(i, j)});
    }

    /// Gluing along an edge of a, the first node at (x, y) with the others in direction (dx, dy), to the other side of b.
    void glue(const unsigned int a, const unsigned int b, const bool is_upper)
    {
      Eigen::Matrix3d aa = Eigen::Matrix3d::Zero(), bb = aa, ba = aa;
      for (unsigned int k = 0; k < nodes_of_edge; ++k)
        {
          const double s  = -1 + 2. * k / (nodes_of_edge - 1);
          const auto   of = [&](const double side) { return is_upper ? motions(s, side) : motions(side, s); };
          aa += of(1).transpose() * of(1);
          bb += of(-1).transpose() * of(-1);
          ba -= of(-1).transpose() * of(1);
        }
      add(a, a, aa);
      add(b, b, bb);
      add(b, a, ba);
    }
  };

  void measure(const unsigned int n)
  {
    Matrix            A, contact;
    std::vector<bool> changes(n_motions * n * n);
    for (unsigned int y = 0; y < n; ++y)
      for (unsigned int x = 0; x < n; ++x)
        {
          const unsigned int p = y * n + x;
          if (x + 1 < n)
            A.glue(p, p + 1, false);
          if (y + 1 < n)
            A.glue(p, p + n, true);
          if (y + 1 == n)
            A.add(p, p, motions(0, 1).transpose() * motions(0, 1));
          if (y > 0)
            continue;
          contact.add(p, p, motions(0, -1).row(1).transpose() * motions(0, -1).row(1));
          std::fill_n(changes.begin() + n_motions * p, n_motions, true);
        }
    const double       start   = cpu_seconds();
    const auto         staying = CoarseSolver::eliminate(A.entries, changes, MPI_COMM_WORLD);
    const double       shared  = cpu_seconds();
    const CoarseSolver face(staying, contact.entries);
    const double       faced    = cpu_seconds();
    const unsigned int n_solves = 10;
    Eigen::VectorXd    x        = Eigen::VectorXd::Ones(changes.size());
    for (unsigned int k = 0; k < n_solves; ++k)
      x = face.solve(x).normalized();
    const double solved = cpu_seconds();
    rusage       usage;
    getrusage(RUSAGE_SELF, &usage);
    std::printf("%10u %10u %12.4f %10.5f %10.5f %12.1f %12.2f %10.1f\n",
                n * n,
                n_motions * n * n,
                shared - start,
                faced - shared,
                (solved - faced) / n_solves,
                8e-6 * face.n_nonzeros(),
                face.n_nonzeros() / (n_motions * n * n * std::log2(n_motions * n * n)),
                usage.ru_maxrss / 1e3);
  }
} // namespace

int main(int argc, char **argv)
{
  const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  std::printf("subdomains   unknowns  set-up [s]   face [s]  solve [s]  factors [MB]  /(n log2 n)  peak [MB]\n");
  for (int k = 1; k < argc; ++k)
    measure(std::atoi(argv[k]));
}
