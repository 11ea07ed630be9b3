#include <slipstick/interface/held_rotation.h>

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace slipstick::interface
{
  namespace
  {
    // A motion is free if supports resist it by less than this part of what they resist others (squares); a free motion
    // rotates if that is more than this part of it.
    constexpr double free_motion = 1e-9, rotating_part = 1e-4;

    /// Displacements at points along directions that vanish, in terms of the rigid motions about a centre.
    template <int dim>
    class HeldMotions
    {
    public:
      static constexpr unsigned int n_rotations = dim == 2 ? 1 : 3, n = dim + n_rotations;

      HeldMotions(const dealii::Point<dim> &center_, const double length_)
        : center(center_)
        , length(length_)
      {}

      void hold(const dealii::Point<dim> &x, const dealii::Tensor<1, dim> &direction)
      {
        const dealii::Tensor<1, dim> arm = (x - center) / length;
        Eigen::Matrix<double, n, 1>  row;
        for (unsigned int d = 0; d < dim; ++d)
          row[d] = direction[d];
        for (unsigned int k = 0; k < n_rotations; ++k)
          {
            const unsigned int a = dim == 2 ? 0 : (k + 1) % 3, b = dim == 2 ? 1 : (k + 2) % 3;
            row[dim + k] = arm[a] * direction[b] - arm[b] * direction[a];
          }
        gram += row * row.transpose();
      }

      bool hold_rotation() const
      {
        const Eigen::SelfAdjointEigenSolver<Gram> solver(gram);
        const double                              largest = solver.eigenvalues()[n - 1];
        if (!(largest > 0))
          return false;
        for (unsigned int k = 0; k < n; ++k)
          if (solver.eigenvalues()[k] <= free_motion * largest &&
              solver.eigenvectors().col(k).tail(n_rotations).norm() > rotating_part)
            return false;
        return true;
      }

    private:
      using Gram = Eigen::Matrix<double, n, n>;

      const dealii::Point<dim> center;
      const double             length;
      Gram                     gram = Gram::Zero();
    };
  } // namespace

  template <int dim>
  bool supports_hold_rotation(const scene::Scene<dim>                         &scene,
                              const mesh::Mesh<dim>                           &mesh,
                              const std::vector<mechanics::BoundaryPart<dim>> &all,
                              const unsigned int                               body)
  {
    dealii::Point<dim> low, high;
    bool               is_first = true;
    for (const auto &part : all)
      for (unsigned int i = 0; part.body == body && i < part.n_nodes; ++i, is_first = false)
        for (unsigned int d = 0; d < dim; ++d)
          {
            low[d]  = is_first ? part.node(i)[d] : std::min(low[d], part.node(i)[d]);
            high[d] = is_first ? part.node(i)[d] : std::max(high[d], part.node(i)[d]);
          }
    if (is_first)
      return false;
    HeldMotions<dim> motions(low + 0.5 * (high - low), 0.5 * low.distance(high));
    const auto       unit = [](const unsigned int c) {
      dealii::Tensor<1, dim> result;
      result[c] = 1;
      return result;
    };
    for (const auto &support : scene.supports)
      {
        if (support.point)
          {
            for (unsigned int c = 0; c < dim; ++c)
              if (support.point->body == body && support.point->coordinates && support.components[c])
                motions.hold(*support.point->coordinates, unit(c));
            continue;
          }
        if (support.where.body != body)
          continue;
        for (const auto &part : mechanics::parts_on(mesh, all, support.where))
          for (unsigned int i = 0; i < part.n_nodes; ++i)
            {
              for (unsigned int c = 0; c < dim; ++c)
                if (support.components[c])
                  motions.hold(part.node(i), unit(c));
              if (support.normal)
                motions.hold(part.node(i), part.outline_normal(i));
            }
      }
    return motions.hold_rotation();
  }

  template bool supports_hold_rotation<2>(const scene::Scene<2> &,
                                          const mesh::Mesh<2> &,
                                          const std::vector<mechanics::BoundaryPart<2>> &,
                                          const unsigned int);
  template bool supports_hold_rotation<3>(const scene::Scene<3> &,
                                          const mesh::Mesh<3> &,
                                          const std::vector<mechanics::BoundaryPart<3>> &,
                                          const unsigned int);
} // namespace slipstick::interface
