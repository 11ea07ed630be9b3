// Candidates for contact of a node of a slave boundary.
#pragma once

#include <slipstick/interface/interface_nodes.h>
#include <slipstick/tfeti/constraints.h>

#include <limits>

namespace slipstick::interface
{
  /// The nodes that tell the rotation of one side across a gap (gap_rotation.h).
  template <int dim>
  struct RotatingNodes
  {
    std::vector<unsigned int>           nodes;
    std::vector<double>                 weights;
    std::vector<dealii::Tensor<1, dim>> positions; // [mm]
  };

  /// One opposite side that a slave node may touch.
  template <int dim>
  struct ContactCandidate
  {
    unsigned int                                 pair = 0, side = 0;
    dealii::Tensor<1, dim>                       normal;
    std::vector<std::pair<unsigned int, double>> slave, master; // nodes and weights
    std::array<RotatingNodes<dim>, n_carriers>   rotating;      // by carrier
    dealii::Tensor<1, dim>                       apart;         // slave point minus master point [mm]
    tfeti::ContactPoint                          point;
    bool                                         has_tangent = false;
    bool                                         is_implied  = false; // by a bond with the same nodes
    std::vector<ContactCandidate>                parts; // of pairs that meet there; empty if there is one pair only
  };

  /// Smallest cosine of normals that face the same way: within 45 degrees.
  constexpr double same_way = 0.7;

  /// Whether both touch the same nodes with the same weights and face the same way.
  template <int dim>
  bool have_same_nodes(const ContactCandidate<dim> &a, const ContactCandidate<dim> &b);

  /// Of one contact pair: smallest gap, length of the slave boundary and number of its nodes.
  struct PairExtent
  {
    double        gap     = std::numeric_limits<double>::infinity(); // [mm]
    double        length  = 0;                                       // [mm]
    std::uint64_t n_nodes = 0;
  };

  /// Finds the opposite sides of the nodes owned by one rank. Of several obstacles in the same direction the nearest
  /// counts.
  template <int dim>
  class Touches
  {
  public:
    /// All arguments must outlive this. @param t time of the load step.
    Touches(const scene::Scene<dim>               &scene,
            const std::vector<InterfaceNode<dim>> &nodes,
            const BodyContacts<dim>               &contacts,
            double                                 t);

    /// Candidates of the node, including bonds between bodies but not bonds to obstacles. Contacts of two pairs with the
    /// same nodes on both sides, or with the same obstacle, are one candidate. Of others with the same nodes, only the
    /// nearest has a tangent (e.g. at a corner of the slave boundary with the same master node on both sides).
    std::vector<ContactCandidate<dim>> of(unsigned int node) const;

    /// Bonds of the node to obstacles.
    std::vector<ContactCandidate<dim>> bonds_to_obstacles(unsigned int node) const;

    /// Bonds between bodies: node and touch, by pair in the order of the scene, so that the result does not depend on
    /// the numbering of the nodes. The properties of the node itself are not set.
    std::vector<std::vector<std::pair<unsigned int, ContactCandidate<dim>>>> bonds_between_bodies() const;

    /// Extent of every pair, from the slave nodes owned by this rank.
    std::vector<PairExtent> extents() const;

  private:
    std::vector<ContactCandidate<dim>> candidates(unsigned int node) const;
    std::vector<ContactCandidate<dim>> merged(unsigned int node, std::vector<ContactCandidate<dim>> touches) const;
    std::vector<ContactCandidate<dim>> nearest(const std::vector<ContactCandidate<dim>> &touches) const;

    /// Sets gap, normal and area; false beyond the Reach, and for nodes without area on the axis of revolution.
    bool                  place_on_obstacle(unsigned int           node,
                                            unsigned int           pair,
                                            const Tributary       &area,
                                            ContactCandidate<dim> &touch) const;
    ContactCandidate<dim> touch_body(unsigned int node, unsigned int pair, const MortarRow<dim> &row) const;
    /// Sets the properties of the node itself, the same for each of its contacts.
    void complete(unsigned int node, ContactCandidate<dim> &touch) const;

    const scene::Scene<dim>                   &scene;
    const std::vector<InterfaceNode<dim>>     &nodes;
    const double                               t;
    std::map<mechanics::NodeKey, unsigned int> number;
    std::map<mechanics::NodeKey, std::vector<std::pair<unsigned int, const MortarRow<dim> *>>>
      pairs_of; // of slave nodes
  };
} // namespace slipstick::interface
