#include <slipstick/base/box_tree.h>
#include <slipstick/base/turned.h>
#include <slipstick/interface/gap_rotation.h>
#include <slipstick/tfeti/dense.h>

#include <algorithm>
#include <map>

namespace slipstick::interface
{
  namespace
  {
    // Points that are apart by less than this fraction of the adjacent cells touch. In space rows around a point where
    // several bodies meet depend on each other; rounded node positions must not make them nearly dependent.
    template <int dim>
    constexpr double touching_points = dim == 2 ? 1e-8 : 1e-4;
    // Parts of the distance below this fraction of the adjacent cells, and its components along a direction below this
    // fraction of it, are rounding.
    constexpr double rounding_of_points = 1e-8;
    // Radius of the nodes that rotate, relative to the gap or the adjacent cells.
    constexpr double radius_of_rotation = 2;
    // Gaps that are much larger than the cells count as this number of cells: rows stay short.
    template <int dim>
    constexpr double most_cells = dim == 2 ? 10 : 4;
    // Rotations that move the nodes by less than this part of the points of the row (squared) are not determined by them.
    constexpr double undetermined_rotation = 1e-6;

    /// Of the nodes with weights in a row.
    struct NodeExtent
    {
      double cells = 0; // size of the largest adjacent one [mm]
      double reach = 0; // largest distance from the point of the row, which may lie beyond its nodes [mm]
    };

    /// The nodes of one side.
    template <int dim>
    class SideNodes
    {
    public:
      explicit SideNodes(const std::vector<mechanics::BoundaryPart<dim>> &parts)
        : nodes(nodes_of(parts))
        , tree(boxes_of(nodes))
      {
        for (const auto &[key, node] : nodes)
          keys.push_back(key);
      }

      NodeExtent around(const dealii::Point<dim> &x, const Weights &weights) const
      {
        NodeExtent result;
        for (const auto &[key, weight] : weights)
          {
            const Node &node = nodes.at(key);
            result.cells     = std::max(result.cells, node.cells);
            result.reach     = std::max(result.reach, node.position.distance(x));
          }
        return result;
      }

      Weights weights_around(const dealii::Point<dim> &x, const double radius) const
      {
        Weights weights;
        for (const unsigned int i : tree.near(BoxTree<dim>::widened(BoxTree<dim>::box_around({x}), radius)))
          if (const double part = nodes.at(keys[i]).position.distance(x) / radius; part < 1)
            weights.emplace_back(keys[i], (1 - part * part) * (1 - part * part));
        std::sort(weights.begin(), weights.end());
        return weights;
      }

    private:
      struct Node
      {
        dealii::Point<dim> position;
        double             cells = 0; // size of the largest adjacent one [mm]
      };
      using Nodes = std::map<mechanics::NodeKey, Node>;

      static Nodes nodes_of(const std::vector<mechanics::BoundaryPart<dim>> &parts)
      {
        Nodes nodes;
        for (const auto &part : parts)
          for (unsigned int i = 0; i < part.n_nodes; ++i)
            {
              Node &node    = nodes[part.keys[i]];
              node.position = part.node(i);
              node.cells    = std::max(node.cells, part.chord());
            }
        return nodes;
      }

      static std::vector<typename BoxTree<dim>::Box> boxes_of(const Nodes &nodes)
      {
        std::vector<typename BoxTree<dim>::Box> boxes;
        for (const auto &[key, node] : nodes)
          boxes.push_back(BoxTree<dim>::box_around({node.position}));
        return boxes;
      }

      const Nodes                     nodes;
      const BoxTree<dim>              tree; // in the order of the nodes
      std::vector<mechanics::NodeKey> keys;
    };
  } // namespace

  template <int dim>
  void find_rotation_weights(const std::vector<mechanics::BoundaryPart<dim>> &slave,
                             const std::vector<mechanics::BoundaryPart<dim>> &master,
                             const bool                                       gaps_rotate,
                             std::vector<MortarRow<dim>>                     &rows)
  {
    const SideNodes<dim> of_slave(slave), of_master(master);
    for (auto &row : rows)
      {
        const auto       x_slave   = row.master_position + row.apart;
        const NodeExtent at_slave  = of_slave.around(x_slave, row.slave_weights),
                         at_master = of_master.around(row.master_position, row.master_weights);
        if (row.apart.norm() <= touching_points<dim> * std::max(at_slave.cells, at_master.cells))
          continue;
        const auto spans = spans_of_carriers<dim>(row.apart, row.normal);
        for (unsigned int k = 0; k < n_carriers; ++k)
          {
            const bool is_slave = k == 0;
            if (!gaps_rotate && k < 2)
              continue;
            const NodeExtent &at   = is_slave ? at_slave : at_master;
            const double      span = spans[k].norm();
            const double      radius =
              at.reach + radius_of_rotation * std::clamp(span, at.cells, most_cells<dim> * at.cells);
            if (span > rounding_of_points * at.cells)
              row.rotation_weights[k] = is_slave ? of_slave.weights_around(x_slave, radius)
                                                 : of_master.weights_around(row.master_position, radius);
          }
      }
  }

  template <int dim>
  std::vector<dealii::Tensor<1, dim>> rotation_coefficients(const std::vector<double>                 &weights,
                                                            const std::vector<dealii::Tensor<1, dim>> &positions,
                                                            const dealii::Tensor<1, dim>              &apart,
                                                            const dealii::Tensor<1, dim>              &direction)
  {
    const auto         of_apart = turned(apart);
    const unsigned int n        = of_apart.size();
    Eigen::VectorXd    of_row(n);
    for (unsigned int k = 0; k < n; ++k)
      of_row[k] = direction * of_apart[k];
    if (weights.empty() || of_row.norm() <= rounding_of_points * apart.norm())
      return {};
    dealii::Tensor<1, dim> center;
    double                 sum = 0;
    for (unsigned int j = 0; j < weights.size(); ++j)
      {
        center += weights[j] * positions[j];
        sum += weights[j];
      }
    center /= sum;
    Eigen::MatrixXd inertia = Eigen::MatrixXd::Zero(n, n);
    for (unsigned int j = 0; j < weights.size(); ++j)
      {
        const auto motion = turned(dealii::Tensor<1, dim>(positions[j] - center));
        for (unsigned int k = 0; k < n; ++k)
          for (unsigned int l = 0; l < n; ++l)
            inertia(k, l) += weights[j] * (motion[k] * motion[l]);
      }
    const tfeti::SymmetricEigen principal(inertia);
    const double                least   = undetermined_rotation * sum * apart.norm_square();
    Eigen::VectorXd             factors = Eigen::VectorXd::Zero(n);
    for (unsigned int k = 0; k < n; ++k)
      if (principal.values[k] > least)
        factors += principal.vectors.col(k).dot(of_row) / principal.values[k] * principal.vectors.col(k);
    std::vector<dealii::Tensor<1, dim>> result(weights.size());
    for (unsigned int j = 0; j < weights.size(); ++j)
      {
        const auto motion = turned(dealii::Tensor<1, dim>(positions[j] - center));
        for (unsigned int k = 0; k < n; ++k)
          result[j] += weights[j] * factors[k] * motion[k];
      }
    return result;
  }

  template void                              find_rotation_weights(const std::vector<mechanics::BoundaryPart<2>> &,
                                                                   const std::vector<mechanics::BoundaryPart<2>> &,
                                                                   const bool,
                                                                   std::vector<MortarRow<2>> &);
  template void                              find_rotation_weights(const std::vector<mechanics::BoundaryPart<3>> &,
                                                                   const std::vector<mechanics::BoundaryPart<3>> &,
                                                                   const bool,
                                                                   std::vector<MortarRow<3>> &);
  template std::vector<dealii::Tensor<1, 2>> rotation_coefficients(const std::vector<double> &,
                                                                   const std::vector<dealii::Tensor<1, 2>> &,
                                                                   const dealii::Tensor<1, 2> &,
                                                                   const dealii::Tensor<1, 2> &);
  template std::vector<dealii::Tensor<1, 3>> rotation_coefficients(const std::vector<double> &,
                                                                   const std::vector<dealii::Tensor<1, 3>> &,
                                                                   const dealii::Tensor<1, 3> &,
                                                                   const dealii::Tensor<1, 3> &);
} // namespace slipstick::interface
