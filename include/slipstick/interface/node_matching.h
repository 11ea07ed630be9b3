// Rows of mortar integrals in terms of nodes: weights and gaps; node to node for matching meshes. Internal to
// mortar_rows().
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/interface/mortar_row.h>
#include <slipstick/interface/surface_nodes.h>

#include <cmath>
#include <map>

namespace slipstick::interface
{
  /// The weights divided by their sum, without rounding noise; the largest one is adjusted so that their sum is exactly
  /// 1.
  Weights normalised(const std::map<mechanics::NodeKey, double> &raw, const double sum);

  /// Positions of the nodes of both sides.
  template <int dim>
  struct NodePlaces
  {
    using Tensor = dealii::Tensor<1, dim>;

    std::map<mechanics::NodeKey, dealii::Point<dim>> slave, master; // [mm]

    /// Sets gap, mean master position and the vector from there to the slave point of a row from its weights.
    void measure(MortarRow<dim> &row) const
    {
      dealii::Point<dim> x;
      row.master_position = {};
      for (const auto &[key, weight] : row.slave_weights)
        x += weight * Tensor(slave.at(key));
      for (const auto &[key, weight] : row.master_weights)
        row.master_position += weight * Tensor(master.at(key));
      row.apart = x - row.master_position;
      row.gap   = -(row.normal * row.apart);
    }

    /// The master node opposite a slave node, and its lateral distance [mm].
    std::pair<mechanics::NodeKey, double> across(const MortarRow<dim> &row) const
    {
      std::pair<mechanics::NodeKey, double> best{{{0, 0}}, std::numeric_limits<double>::max()};
      for (const auto &[key, weight] : row.master_weights)
        {
          const Tensor between = master.at(key) - row.position;
          const double off     = (between - (between * row.normal) * row.normal).norm();
          if (off < best.second)
            best = {key, off};
        }
      return best;
    }
  };

  // Edges, facets and nodes are omitted if at most this fraction of them is covered.
  constexpr double smallest_cover = 1e-10;

  /// The integrals for one slave node, over one of its edges or facets or over all of them.
  template <int dim>
  struct NodeIntegrals
  {
    double                               measure = 0;           // D_i
    double                               length  = 0;           // the same in the plane; in space an area
    double                               whole   = 0;           // in space: D_i if the facets were fully covered
    std::map<mechanics::NodeKey, double> slave, master;         // D_ik, M_ij
    dealii::Tensor<1, dim>               rise;                  // <phi_i (rise of the master - rise of the slave) n>
    double                               neglected_sagitta = 0; // [mm]

    NodeIntegrals &operator+=(const NodeIntegrals &other)
    {
      measure += other.measure;
      length += other.length;
      whole += other.whole;
      rise += other.rise;
      neglected_sagitta = std::max(neglected_sagitta, other.neglected_sagitta);
      for (const auto &[key, value] : other.slave)
        slave[key] += value;
      for (const auto &[key, value] : other.master)
        master[key] += value;
      return *this;
    }

    /// As if the functions were multiplied by a factor.
    void scale(const double factor)
    {
      measure *= factor;
      length *= factor;
      rise *= factor;
      for (auto *side : {&slave, &master})
        for (auto &[key, value] : *side)
          value *= factor;
    }
  };

  // Edges or facets of a node see the same level of the master if their gaps there differ by at most this fraction of
  // their size.
  constexpr double same_level = 0.1;

  /// The sum over the edges or facets of a node that see the nearest level of the master: at a step, contact is on one
  /// side, and the mean of both gaps would be a clearance that does not exist.
  template <int dim>
  NodeIntegrals<dim> on_nearest_level(const std::vector<NodeIntegrals<dim>> &parts,
                                      const SurfaceNode<dim>                &node,
                                      const NodePlaces<dim>                 &places)
  {
    const auto is_judged = [&](const auto &part) { return part.measure > smallest_cover * node.scale; };
    const auto gap       = [&](const auto &part) {
      dealii::Tensor<1, dim> apart = part.rise / part.measure;
      for (const auto &[key, value] : part.master)
        apart += value / part.measure * dealii::Tensor<1, dim>(places.master.at(key));
      for (const auto &[key, value] : part.slave)
        apart -= value / part.measure * dealii::Tensor<1, dim>(places.slave.at(key));
      return node.normal * apart;
    };
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto &part : parts)
      if (is_judged(part) && std::abs(gap(part)) < std::abs(nearest))
        nearest = gap(part);
    NodeIntegrals<dim> sum;
    for (const auto &part : parts)
      if (!is_judged(part) || std::abs(gap(part) - nearest) <= same_level * node.size)
        sum += part;
    return sum;
  }

  /// Whether the node has a row. In the plane nodes with no share of their edges (on the axis of revolution) have none.
  /// Corners of triangles of degree 2 have one where some of the triangles are partly covered.
  template <int dim>
  bool has_row(const SurfaceNode<dim> &node, const NodeIntegrals<dim> &sum)
  {
    return (dim == 3 || node.measure > 0) && sum.measure > smallest_cover * node.scale;
  }

  /// The row of a slave node.
  template <int dim>
  MortarRow<dim> row_of(const SurfaceNode<dim> &node, const NodeIntegrals<dim> &sum, const NodePlaces<dim> &places)
  {
    MortarRow<dim> row;
    row.slave          = node.key;
    row.side           = node.side;
    row.position       = node.position;
    row.normal         = node.normal;
    row.measure        = sum.measure;
    row.length         = sum.length;
    row.full_measure   = std::max(node.measure, sum.whole); // corners of triangles of degree 2 have a measure of 0
    row.full_length    = std::max(node.covered, sum.whole);
    row.slave_weights  = normalised(sum.slave, sum.measure);
    row.master_weights = normalised(sum.master, sum.measure);
    places.measure(row);
    row.gap += row.normal * sum.rise / sum.measure;
    row.neglected_sagitta = sum.neglected_sagitta;
    return row;
  }

  /// The rows of all nodes from the integrals over their edges or facets.
  template <int dim>
  std::vector<MortarRow<dim>> rows_of_nodes(const std::vector<SurfaceNode<dim>>                &nodes,
                                            const std::vector<std::vector<NodeIntegrals<dim>>> &parts,
                                            const NodePlaces<dim>                              &places)
  {
    std::vector<MortarRow<dim>> rows;
    for (unsigned int i = 0; i < nodes.size(); ++i)
      if (const auto sum = on_nearest_level(parts[i], nodes[i], places); has_row(nodes[i], sum))
        rows.push_back(row_of(nodes[i], sum, places));
    return rows;
  }

  /// The weight of @p node in @p weights, 0 if it is not contained.
  inline double weight_of(const mechanics::NodeKey &node, const Weights &weights)
  {
    for (const auto &[key, weight] : weights)
      if (key == node)
        return weight;
    return 0;
  }

  // Master nodes are opposite slave nodes if their lateral distance is at most this fraction of the tributary length:
  constexpr double across_automatic = 1e-6; // ... for meshes to be recognised as matching
  constexpr double across_asked_for = 0.1;  // ... if node to node is required
  // Matching nodes are not sufficient: an edge may face two or three, a quadrilateral two triangles. The weight of the
  // opposite node in the integrals must also be at least this.
  constexpr double least_weight_across = 0.99;

  /// Node-to-node rows where the discretisation requires them, or leaves the choice open and the meshes match;
  /// otherwise @p rows.
  /// @param rise of the true surface above a node along the normal of its row [mm].
  /// @throws InputError when node to node is required and the meshes do not match.
  template <int dim, class Rise>
  std::vector<MortarRow<dim>> matched(std::vector<MortarRow<dim>>        rows,
                                      const NodePlaces<dim>             &places,
                                      const scene::ContactDiscretization discretization,
                                      const std::string                 &name,
                                      const Rise                        &rise)
  {
    if (discretization == scene::ContactDiscretization::mortar)
      return rows;
    const bool   is_asked_for = discretization == scene::ContactDiscretization::node_to_node;
    const double tolerance    = is_asked_for ? across_asked_for : across_automatic;
    auto         to_nodes     = rows;
    for (auto &row : to_nodes)
      {
        const auto [key, off] = places.across(row);
        if (!is_asked_for && weight_of(key, row.master_weights) < least_weight_across)
          return rows;
        if (off > tolerance * std::pow(row.length, 1. / (dim - 1)))
          {
            if (!is_asked_for)
              return rows;
            throw InputError(
              format("Contact %s: Discretization = node to node, but the meshes do not match: the master "
                     "node nearest to the slave node at %s is %g mm off to the side",
                     name.c_str(),
                     point_text(row.position, dim).c_str(),
                     off),
              "set Discretization = auto or mortar, or give both boundaries the same nodes");
          }
        row.slave_weights  = {{row.slave, 1.}};
        row.master_weights = {{key, 1.}};
        places.measure(row);
        row.gap += rise(row, key) - rise(row, row.slave);
      }
    return to_nodes;
  }
} // namespace slipstick::interface
