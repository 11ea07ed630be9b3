// How well a mesh resolves the tractions of a contact pair: differences between neighbouring nodes.
#pragma once

#include <slipstick/base/box_tree.h>
#include <slipstick/contact/result.h>
#include <slipstick/mechanics/singular_points.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace slipstick::app
{
  /// The nodes of pair @p pair.
  std::vector<contact::ContactNode> nodes_of_pair(const std::vector<contact::ContactNode> &nodes,
                                                  const unsigned int                       pair);

  /// A zone of connected contact nodes.
  struct ContactZone
  {
    std::array<double, 3> position{{0, 0, 0}}; // of one of its nodes
    unsigned int          n_nodes  = 0;
    double                force    = 0;  // normal force [N]
    double                distance = 0.; // to the nearest node next to that node [mm]
  };

  /// Contact nodes along a line of the plane.
  class ContactLine
  {
  public:
    static constexpr const char *measure = "length", *unit = "mm";

    explicit ContactLine(std::vector<contact::ContactNode> nodes);

    /// Total length of the nodes for which @p is_in holds, and half the length of the elements between one of these
    /// nodes and another node.
    template <class IsIn>
    std::pair<double, double> size(const IsIn &is_in) const
    {
      std::pair<double, double> result{0, 0};
      for (std::size_t i = 0; i < line.size(); ++i)
        {
          result.first += is_in(line[i]) ? line[i].length : 0.;
          if (i > 0 && is_in(line[i - 1]) != is_in(line[i]))
            result.second += (line[i].arc_length - line[i - 1].arc_length) / 2;
        }
      return result;
    }

    /// Resolution error of the largest pressure [MPa]; nothing if the nodes do not resolve it.
    std::optional<double> resolution() const;

    /// Relative error of the L2 norm of a traction that is not constant between the nodes.
    template <class Traction>
    double norm_resolution(const Traction &traction) const
    {
      // between two nodes the integral of the square exceeds that of their means by a sixth of the squared difference
      constexpr double part        = 1. / 6;
      double           differences = 0, all = 0;
      for (std::size_t i = 0; i < line.size(); ++i)
        {
          all += line[i].length * std::pow(traction(line[i]), 2);
          if (i > 0)
            differences += part * (line[i].arc_length - line[i - 1].arc_length) *
                           std::pow(traction(line[i]) - traction(line[i - 1]), 2);
        }
      return all > 0 ? differences / (2 * all) : 0.;
    }

    /// Nodes with an unresolved local maximum of the pressure, except maxima far below the largest pressure of the
    /// pair.
    std::vector<contact::ContactNode> unresolved_peaks() const;

    /// Zones in which every node is next to an open one. Zones with a node at an end of the line, i.e. of a corner that
    /// touches, are left out, except an end on the axis of revolution.
    /// @param may_cross_axis whether x is a radius.
    std::vector<ContactZone> unresolved_zones(const bool may_cross_axis) const;

  private:
    /// As resolution(), for the pressure of node @p i.
    std::optional<double> resolution_at(std::size_t i) const;

    std::vector<contact::ContactNode> line;
  };

  /// Contact nodes on a surface; nodes near each other count as adjacent.
  class ContactSurface
  {
  public:
    static constexpr const char *measure = "area", *unit = "mm^2";

    explicit ContactSurface(std::vector<contact::ContactNode> nodes);

    /// Total area of the nodes for which @p is_in holds, and half the area of those that are adjacent to a node for
    /// which it does not.
    template <class IsIn>
    std::pair<double, double> size(const IsIn &is_in) const
    {
      std::pair<double, double> result{0, 0};
      for (const auto &node : nodes)
        if (is_in(node))
          {
            result.first += node.length;
            for (const unsigned int k : beside(node))
              if (!is_in(nodes[k]))
                {
                  result.second += node.length / 2;
                  break;
                }
          }
      return result;
    }

    /// As of ContactLine.
    std::optional<double> resolution() const;

    /// As of ContactLine.
    template <class Traction>
    double norm_resolution(const Traction &traction) const
    {
      constexpr double part        = 1. / 3; // of the mean squared difference from the nodes around
      double           differences = 0, all = 0;
      for (const auto &node : nodes)
        {
          all += node.length * std::pow(traction(node), 2);
          const auto around = beside(node);
          for (const unsigned int k : around)
            differences += part * node.length * std::pow(traction(node) - traction(nodes[k]), 2) / around.size();
        }
      return all > 0 ? differences / (2 * all) : 0.;
    }

    /// As for ContactLine; a node at the edge of the surface is compared only with nodes that are not at the edge,
    /// since the pressure may be large all along the edge.
    std::vector<contact::ContactNode> unresolved_peaks() const;

    /// As of ContactLine; zones of which a third of the nodes or more are at the edge of the surface are left out.
    std::vector<ContactZone> unresolved_zones() const;

  private:
    std::optional<double> resolution_at(const contact::ContactNode &node) const;

    std::vector<unsigned int> nearest(const contact::ContactNode &node, const unsigned int n) const;

    /// Nodes that count as adjacent.
    std::vector<unsigned int> beside(const contact::ContactNode &node) const;

    bool is_at_edge(const contact::ContactNode &node) const;

    const std::vector<contact::ContactNode> nodes;
    const BoxTree<3>                        tree;
  };

  template <int dim>
  using ContactProfile = std::conditional_t<dim == 2, ContactLine, ContactSurface>;

  struct UnresolvedContacts
  {
    std::vector<unsigned int> pairs;
    std::string               warning; // empty: none
  };

  /// Pairs whose contact the mesh does not resolve: most of the normal force acts on nodes next to open ones. Only the
  /// nodes of rank 0 are used; the result is the same on all ranks.
  /// @param largest_force of loads, supports and pairs, in all load steps so far [N]; on rank 0.
  /// @param is_of_revolution whether the scene is axisymmetric. Collective.
  template <int dim>
  UnresolvedContacts unresolved_contacts(const std::vector<contact::ContactNode>    &nodes,
                                         const std::vector<scene::ContactPair<dim>> &pairs,
                                         const double                                largest_force,
                                         const bool                                  is_of_revolution,
                                         const MPI_Comm                              comm);

  /// Pressure peaks of every pair that its nodes do not resolve, on both bodies, with a radius of a tenth of the size
  /// of the contact: stresses there grow with every refinement, or require a finer mesh. Only the nodes of rank 0 are
  /// used; the result is the same on all ranks. Collective.
  template <int dim>
  std::vector<mechanics::Surroundings<dim>> pressure_peaks(const std::vector<contact::ContactNode>    &nodes,
                                                           const std::vector<scene::ContactPair<dim>> &pairs,
                                                           const MPI_Comm                              comm);
} // namespace slipstick::app
