#include <slipstick/contact/holding_forces.h>

#include <deal.II/base/mpi.h>

namespace slipstick::contact
{
  namespace
  {
    /// Columns are the nodes; a third component of zero is added in the plane.
    Eigen::Matrix3Xd by_node(const Eigen::VectorXd &vector, const unsigned int n_components)
    {
      const Eigen::Index n_nodes   = vector.size() / n_components;
      Eigen::Matrix3Xd   result    = Eigen::Matrix3Xd::Zero(3, n_nodes);
      result.topRows(n_components) = Eigen::Map<const Eigen::MatrixXd>(vector.data(), n_components, n_nodes);
      return result;
    }

    Eigen::Vector3d position(const tfeti::SubdomainSystem &system, const Eigen::Index unknown)
    {
      const auto x = system.position(unknown);
      return {x[0], x[1], x[2]};
    }

    template <class Matrix>
    void sum_over_ranks(Matrix &sum, const MPI_Comm comm)
    {
      MPI_Allreduce(MPI_IN_PLACE, sum.data(), sum.size(), MPI_DOUBLE, MPI_SUM, comm);
    }
  } // namespace

  std::vector<Eigen::VectorXd> holding_forces(const tfeti::DualProblem       &dual,
                                              const tfeti::DistributedVector &multipliers)
  {
    const auto              &constraints = dual.constraints();
    tfeti::DistributedVector outside     = multipliers;
    for (unsigned int r = 0; r < constraints.kind.size(); ++r)
      if (constraints.kind[r] == tfeti::RowKind::gluing)
        outside.local_element(r) = 0;
    auto forces = dual.dual_operator().forces(outside);
    for (auto &of_subdomain : forces)
      of_subdomain *= -1;
    return forces;
  }

  DisplacedMoments displaced_moments(const tfeti::DualProblem           &dual,
                                     const std::vector<Eigen::VectorXd> &u,
                                     const tfeti::DistributedVector     &multipliers,
                                     const unsigned int                  n_bodies)
  {
    const auto       holding = holding_forces(dual, multipliers);
    Eigen::Matrix3Xd left = Eigen::Matrix3Xd::Zero(3, n_bodies), mean = left;
    Eigen::VectorXd  sizes = Eigen::VectorXd::Zero(n_bodies), moments = sizes;
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        const auto            &system = *dual.subdomains()[p];
        const unsigned int     dim = n_components(system), b = system.body();
        const Eigen::Matrix3Xd moved = by_node(u[p], dim), held = by_node(holding[p], dim);
        const Eigen::Matrix3Xd force = held + by_node(system.load(), dim);
        for (Eigen::Index i = 0; i < moved.cols(); ++i)
          {
            left.col(b) += moved.col(i).cross(force.col(i));
            if (const double size = held.col(i).norm(); size > 0)
              {
                mean.col(b) += size * position(system, dim * i);
                sizes[b] += size;
              }
          }
      }
    sum_over_ranks(left, dual.communicator());
    sum_over_ranks(mean, dual.communicator());
    sum_over_ranks(sizes, dual.communicator());
    for (unsigned int b = 0; b < n_bodies; ++b)
      if (sizes[b] > 0)
        mean.col(b) /= sizes[b];
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        const auto            &system = *dual.subdomains()[p];
        const unsigned int     dim    = n_components(system);
        const Eigen::Matrix3Xd held   = by_node(holding[p], dim);
        for (Eigen::Index i = 0; i < held.cols(); ++i)
          if (!held.col(i).isZero(0))
            moments[system.body()] += (position(system, dim * i) - mean.col(system.body())).cross(held.col(i)).norm();
      }
    sum_over_ranks(moments, dual.communicator());
    return {left.colwise().norm().transpose(), moments, sizes};
  }
} // namespace slipstick::contact
