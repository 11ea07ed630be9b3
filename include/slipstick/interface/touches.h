// What a node of a slave boundary may touch.
#pragma once

#include <slipstick/interface/interface_nodes.h>
#include <slipstick/tfeti/constraints.h>

#include <limits>

namespace slipstick::interface
{
  /// One other side that a slave node may touch.
  template <int dim>
  struct Touch
  {
    unsigned int                                 pair = 0, side = 0;
    dealii::Tensor<1, dim>                       normal;
    std::vector<std::pair<unsigned int, double>> slave, master; // nodes and weights
    tfeti::ContactPoint                          point;
    bool                                         has_tangent = false;
  };

  /// Of one contact pair: smallest gap, length of the slave boundary and number of its nodes.
  struct PairExtent
  {
    double        gap     = std::numeric_limits<double>::infinity(); // [mm]
    double        length  = 0;                                       // [mm]
    std::uint64_t n_nodes = 0;
  };

  /// Finds the other sides of the nodes that one rank owns. Of several obstacles in the same direction the nearest counts.
  template <int dim>
  class Touches
  {
  public:
    /// All arguments must live as long as this. @param t time of the load step.
    Touches(const scene::Scene<dim>               &scene,
            const std::vector<InterfaceNode<dim>> &nodes,
            const BodyContacts<dim>               &contacts,
            double                                 t);

    /// Of the node, those of bonds between bodies included, of bonds to obstacles not. One of those with the same nodes has a
    /// tangent (the nearest), as at a corner of the slave boundary with the same master node on both sides.
    std::vector<Touch<dim>> of(unsigned int node) const;

    /// Where the node is bonded to obstacles.
    std::vector<Touch<dim>> bonds_to_obstacles(unsigned int node) const;

    /// Bonds between bodies: node and touch, by pair in the order of the scene, so that what is made of them does not depend on the
    /// numbers of the nodes. The points have no properties of the node.
    std::vector<std::vector<std::pair<unsigned int, Touch<dim>>>> bonds_between_bodies() const;

    /// Of every pair, as far as this rank owns its slave nodes.
    std::vector<PairExtent> extents() const;

  private:
    std::vector<Touch<dim>> nearest_of(unsigned int node) const;
    /// Gap, normal and area; false beyond the Reach, and on the axis of revolution for nodes without area.
    bool       place_on_obstacle(unsigned int node, unsigned int pair, const Tributary &area, Touch<dim> &touch) const;
    Touch<dim> touch_body(unsigned int node, unsigned int pair, const MortarRow<dim> &row) const;
    /// Properties of the node itself, the same for each of its contacts.
    void complete(unsigned int node, Touch<dim> &touch) const;

    const scene::Scene<dim>                   &scene;
    const std::vector<InterfaceNode<dim>>     &nodes;
    const double                               t;
    std::map<mechanics::NodeKey, unsigned int> number;
    std::map<mechanics::NodeKey, std::vector<std::pair<unsigned int, const MortarRow<dim> *>>>
      pairs_of; // of slave nodes
  };
} // namespace slipstick::interface
