// Rows of mortar integrals in terms of nodes: weights, gaps, and node to node where meshes match. Internal to mortar_rows().
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
  /// Weights over their sum, without what is rounding; the largest makes the sum 1 exactly.
  Weights normalised(const std::map<mechanics::NodeKey, double> &raw, const double sum);

  /// Where the nodes of both sides are.
  template <int dim>
  struct NodePlaces
  {
    using Tensor = dealii::Tensor<1, dim>;

    std::map<mechanics::NodeKey, dealii::Point<dim>> slave, master; // [mm]

    /// Gap and mean master position of a row from its weights.
    void measure(MortarRow<dim> &row) const
    {
      dealii::Point<dim> x;
      row.master_position = {};
      for (const auto &[key, weight] : row.slave_weights)
        x += weight * Tensor(slave.at(key));
      for (const auto &[key, weight] : row.master_weights)
        row.master_position += weight * Tensor(master.at(key));
      row.gap = row.normal * (row.master_position - x);
    }

    /// The master node across a slave node, and how far off it is to the side [mm].
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

  // Edges, facets and nodes are left out if no more than this fraction of them is covered.
  constexpr double smallest_cover = 1e-10;

  /// What the integrals over all edges or facets give for a slave node.
  struct NodeIntegrals
  {
    double                               measure = 0;   // D_i
    double                               length  = 0;   // the same in the plane; in space an area
    std::map<mechanics::NodeKey, double> slave, master; // D_ik, M_ij
  };

  /// In the plane a node without a share of its edges (on the axis of revolution) has no row. A corner of triangles of degree 2 has
  /// one where some of them are covered in part.
  template <int dim>
  bool has_row(const SurfaceNode<dim> &node, const NodeIntegrals &sum)
  {
    return (dim == 3 || node.measure > 0) && sum.measure > smallest_cover * node.scale;
  }

  /// The row of a slave node, its gap that of the edges or facets.
  template <int dim>
  MortarRow<dim> row_of(const SurfaceNode<dim> &node, const NodeIntegrals &sum, const NodePlaces<dim> &places)
  {
    MortarRow<dim> row;
    row.slave          = node.key;
    row.side           = node.side;
    row.position       = node.position;
    row.normal         = node.normal;
    row.measure        = sum.measure;
    row.length         = sum.length;
    row.full_measure   = node.measure;
    row.full_length    = node.covered;
    row.slave_weights  = normalised(sum.slave, sum.measure);
    row.master_weights = normalised(sum.master, sum.measure);
    places.measure(row);
    return row;
  }

  /// Of @p node among @p weights, 0 where it is none of them.
  inline double weight_of(const mechanics::NodeKey &node, const Weights &weights)
  {
    for (const auto &[key, weight] : weights)
      if (key == node)
        return weight;
    return 0;
  }

  // Master nodes lie across slave nodes when they are off by no more than this part of the tributary length ...
  constexpr double across_automatic = 1e-6; // ... to be taken for matching meshes
  constexpr double across_asked_for = 0.1;  // ... when node to node is asked for
  // Matching nodes are not enough: an edge may face two or three, a quadrilateral two triangles. The integrals must say the same, with
  // no less than this weight of the node across.
  constexpr double least_weight_across = 0.99;

  /// Rows from node to node where the discretisation asks for them, or leaves it to the meshes and these match; else @p rows.
  /// @param rise how far the true surface is above a node along the normal of its row [mm].
  /// @throws InputError when node to node is asked for and the meshes do not match.
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
