#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/interface/nodal_conditions.h>
#include <slipstick/mechanics/surface.h>
#include <slipstick/tfeti/dense.h>

#include <algorithm>
#include <cmath>

namespace slipstick::interface
{
  namespace
  {
    // Two supports agree if their values differ by less than this fraction of the larger.
    constexpr double same_value_tolerance = 1e-12;
    // Spring stiffnesses below this fraction of the larger principal one are rounding.
    constexpr double smallest_stiffness = 1e-12;

    template <int dim>
    dealii::Tensor<1, dim> tensor(const std::array<double, dim> &v)
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = v[d];
      return result;
    }

    template <int dim>
    std::string name_of(const dealii::Tensor<1, dim> &direction, const unsigned int which)
    {
      if (which < dim)
        return format("displacement %c", "xyz"[which]);
      if (dim == 3)
        return format("displacement along (%.3g, %.3g, %.3g)", direction[0], direction[1], direction[dim - 1]);
      return format("displacement along (%.3g, %.3g)", direction[0], direction[1]);
    }

    /// Held directions as columns; their values.
    template <int dim>
    Eigen::Matrix<double, dim, Eigen::Dynamic> directions_of(const InterfaceNode<dim> &node)
    {
      Eigen::Matrix<double, dim, Eigen::Dynamic> result(dim, node.held.size());
      for (unsigned int k = 0; k < node.held.size(); ++k)
        result.col(k) = Eigen::Map<const Eigen::Matrix<double, dim, 1>>(node.held[k].direction.data());
      return result;
    }
    template <int dim>
    Eigen::VectorXd values_of(const InterfaceNode<dim> &node)
    {
      Eigen::VectorXd result(node.held.size());
      for (unsigned int k = 0; k < node.held.size(); ++k)
        result[k] = node.held[k].value;
      return result;
    }

    template <int dim>
    Eigen::Matrix<double, dim, 1> vector(const dealii::Tensor<1, dim> &v)
    {
      return Eigen::Map<const Eigen::Matrix<double, dim, 1>>(v.begin_raw());
    }

    template <int dim>
    dealii::Tensor<1, dim> tensor(const Eigen::Matrix<double, dim, 1> &v)
    {
      dealii::Tensor<1, dim> result;
      std::copy(v.data(), v.data() + dim, result.begin_raw());
      return result;
    }

    /// Adds the entries that are not contained yet.
    void share(std::vector<unsigned int> &all, const std::vector<unsigned int> &more)
    {
      for (const unsigned int one : more)
        if (std::find(all.begin(), all.end(), one) == all.end())
          all.push_back(one);
    }

    /// Supports along normals: the normals of edges with equal values are averaged where there is no corner.
    template <int dim>
    void hold_along_normals(InterfaceNode<dim> &node, const scene::Scene<dim> &scene, const double t)
    {
      struct Normals
      {
        std::vector<dealii::Tensor<1, dim>> all;
        std::vector<unsigned int>           by;
      };
      std::map<double, Normals> normals; // by value
      for (const auto &side : node.sides)
        if (side.condition < scene.supports.size())
          {
            auto &list = normals[scene.supports[side.condition].normal->value(node.point(), t)];
            list.all.push_back(tensor<dim>(side.normal));
            list.by.push_back(side.condition);
          }
      unsigned int which = dim;
      for (const auto &[value, list] : normals)
        {
          std::vector<dealii::Tensor<1, dim>> means;
          const auto                          group = mechanics::smooth_normals(list.all, means);
          for (unsigned int g = 0; g < means.size(); ++g)
            {
              std::vector<unsigned int> by;
              for (unsigned int i = 0; i < group.size(); ++i)
                if (group[i] == g)
                  share(by, {list.by[i]});
              hold(node, means[g], value, which++, by);
            }
        }
    }

    /// Normals of the edges are averaged where there is no corner, as for supports: otherwise a curved boundary on
    /// springs along its normal would also have very soft springs along the tangent, which would impair the scaling of
    /// F.
    template <int dim>
    void add_springs(InterfaceNode<dim> &node, const scene::Scene<dim> &scene)
    {
      std::vector<typename InterfaceNode<dim>::Side> sides;
      std::vector<dealii::Tensor<1, dim>>            normals, means;
      for (const auto &side : node.sides)
        if (side.condition >= scene.supports.size())
          {
            sides.push_back(side);
            normals.push_back(tensor<dim>(side.normal));
          }
      const auto                      group     = mechanics::smooth_normals(normals, means);
      Eigen::Matrix<double, dim, dim> stiffness = Eigen::Matrix<double, dim, dim>::Zero();
      for (unsigned int i = 0; i < sides.size(); ++i)
        {
          const auto &foundation = scene.foundations[sides[i].condition - scene.supports.size()];
          const Eigen::Map<const Eigen::Matrix<double, dim, 1>> n(means[group[i]].begin_raw());
          const Eigen::Matrix<double, dim, dim>                 nn = n * n.transpose();
          stiffness +=
            sides[i].area * (foundation.normal_stiffness * nn +
                             foundation.tangential_stiffness * (Eigen::Matrix<double, dim, dim>::Identity() - nn));
        }
      const tfeti::SymmetricEigen principal(stiffness);
      for (unsigned int k = 0; k < dim; ++k)
        if (principal.values[k] > smallest_stiffness * principal.values[dim - 1])
          {
            typename InterfaceNode<dim>::Spring spring;
            spring.stiffness = principal.values[k];
            for (unsigned int d = 0; d < dim; ++d)
              spring.direction[d] = principal.vectors(d, k);
            if (node.free_part(spring.direction).norm() > held_direction_tolerance)
              node.springs.push_back(spring);
          }
    }
  } // namespace

  template <int dim>
  dealii::Tensor<1, dim> InterfaceNode<dim>::free_part(const dealii::Tensor<1, dim> &direction) const
  {
    if (held.size() >= dim)
      return {};
    if (held.empty())
      return direction;
    const Eigen::MatrixXd D = directions_of(*this);
    const Eigen::VectorXd v = vector(direction);
    return tensor<dim>(Eigen::VectorXd(v - D * tfeti::basic_solution(D, v)));
  }

  template <int dim>
  dealii::Tensor<1, dim> InterfaceNode<dim>::held_displacement() const
  {
    if (held.empty())
      return {};
    return tensor<dim>(tfeti::shortest_solution(directions_of(*this).transpose(), values_of(*this)));
  }

  template <int dim>
  void hold(InterfaceNode<dim>              &node,
            const dealii::Tensor<1, dim>    &direction,
            const double                     value,
            const unsigned int               which,
            const std::vector<unsigned int> &by)
  {
    if (node.free_part(direction).norm() > held_direction_tolerance)
      {
        typename InterfaceNode<dim>::Held held;
        for (unsigned int d = 0; d < dim; ++d)
          held.direction[d] = direction[d];
        held.value = value;
        held.which = which;
        held.by    = by;
        node.held.push_back(held);
        return;
      }
    const auto nearest = std::max_element(node.held.begin(), node.held.end(), [&](const auto &a, const auto &b) {
      return std::abs(tensor<dim>(a.direction) * direction) < std::abs(tensor<dim>(b.direction) * direction);
    });
    share(nearest->by, by);
    // the implied value: sum of w_k value_k with direction = sum of w_k direction_k
    const Eigen::VectorXd shares = tfeti::basic_solution(directions_of(node), vector(direction));
    const double          there  = shares.dot(values_of(node));
    const double          size   = std::max(std::abs(value), shares.cwiseAbs().dot(values_of(node).cwiseAbs()));
    if (std::abs(there - value) > same_value_tolerance * size)
      throw InputError(format("supports prescribe both %g and %g for %s at (%g, %g%s)",
                              there,
                              value,
                              name_of(direction, which).c_str(),
                              node.position[0],
                              node.position[1],
                              dim == 3 ? format(", %g", node.position[dim - 1]).c_str() : ""),
                       "free that component in one of the supports, or make the values agree where boundaries meet");
  }

  template <int dim>
  void resolve_sides(InterfaceNode<dim> &node, const scene::Scene<dim> &scene, const double t)
  {
    std::sort(node.sides.begin(), node.sides.end());
    hold_along_normals(node, scene, t);
    add_springs(node, scene);
    std::sort(node.held.begin(), node.held.end(), [](const auto &a, const auto &b) { return a.which < b.which; });
  }

  template struct InterfaceNode<2>;
  template void hold(InterfaceNode<2> &,
                     const dealii::Tensor<1, 2> &,
                     const double,
                     const unsigned int,
                     const std::vector<unsigned int> &);
  template void resolve_sides(InterfaceNode<2> &, const scene::Scene<2> &, const double);
  template struct InterfaceNode<3>;
  template void hold(InterfaceNode<3> &,
                     const dealii::Tensor<1, 3> &,
                     const double,
                     const unsigned int,
                     const std::vector<unsigned int> &);
  template void resolve_sides(InterfaceNode<3> &, const scene::Scene<3> &, const double);
} // namespace slipstick::interface
