// The rows of the nodes that one rank owns, before they are numbered over the ranks.
#pragma once

#include <slipstick/interface/echelon.h>
#include <slipstick/interface/interface_nodes.h>
#include <slipstick/interface/touches.h>

#include <set>

namespace slipstick::interface
{
  /// An entry of B, or one of an interface unknown, for the rank of its subdomain.
  struct RowEntry
  {
    std::uint64_t index; // row or interface unknown: owned number, then global
    unsigned int  subdomain;
    unsigned int  dof;
    double        value;
    bool          is_row;

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &index &subdomain &dof &value &is_row;
    }
  };

  /// Makes the rows of interface nodes: contact, bonds, supports, foundations, gluing.
  ///
  /// Rows of contact that the supports of their nodes and the bonds (of all connected nodes) already imply are left
  /// out; the tangential row goes before the normal one. So are redundant rows of bonds, as where three bonded bodies
  /// meet in a point: those of the pair that comes last in the scene are dropped. A node that may touch several
  /// obstacles has a normal row for each (for parallel normals the nearer obstacle only) and one tangential row, that
  /// of the nearest obstacle. The same holds for a node at a corner of the slave boundary with the same master node on
  /// both its sides.
  template <int dim>
  class RowBuilder
  {
  public:
    /// All nodes are owned by this rank; @p contacts must live as long as this.
    RowBuilder(const scene::Scene<dim>               &scene,
               const std::vector<InterfaceNode<dim>> &nodes,
               const BodyContacts<dim>               &contacts,
               const double                           t,
               tfeti::Constraints                    &constraints);

    /// Of every pair, as far as this rank owns its slave nodes.
    std::vector<PairExtent> extents() const
    {
      return touches.extents();
    }

    /// Nodes of pair k with a gap above limits[k] get no rows (where ContactLaw::acts_where_closed_alone()); they go to
    /// `pruned`.
    void limit_gaps(std::vector<double> limits);

    /// Fills kind, c, compliance, label, contact points, reactions, interface_held and counts of the constraints.
    void build();

    std::vector<RowEntry> entries;
    tfeti::Constraints    pruned;         // kind and c of the normal rows of pruned nodes ...
    std::vector<RowEntry> pruned_entries; // ... and their entries
    tfeti::HeldContacts   held;           // the same of nodes whose gap is prescribed
    std::vector<RowEntry> held_entries;
    std::uint64_t         n_interface = 0;

  private:
    using Tensor = dealii::Tensor<1, dim>;
    using Vector = Echelon::Vector; // by dim * node + component

    void add(const unsigned int node);

    void add_contact(const unsigned int node);
    void find_bonds();
    /// Row of a bond along the normal (0) or the tangent (1).
    Vector bond(const Touch<dim> &touch, const unsigned int direction) const;
    bool   is_pruned(const Touch<dim> &touch) const;
    /// Rows along the tangents that supports, bonds and @p left, what they leave of the normal row, do not hold.
    std::vector<Vector> free_tangents(Touch<dim> &touch, const Vector &left) const;
    /// Do supports hold it apart, and does its law act where contact is closed alone?
    bool is_held_open(const tfeti::HeldContacts::Point &point) const;
    /// Adds @p coefficients to @p to as row @p row.
    void fill(const unsigned int row, const Vector &coefficients, std::vector<RowEntry> &to) const;
    void add_pruned(const Touch<dim> &touch, const Vector &coefficients);
    void add_held(const unsigned int node, const Touch<dim> &touch, const Vector &coefficients);
    void add_bonds_to_obstacles(const unsigned int node);
    void add_held_rows(const unsigned int node);
    void add_reaction(const unsigned int               node,
                      const unsigned int               row,
                      const Tensor                    &direction,
                      const std::vector<unsigned int> &holders);

    /// Jump of the displacement along @p direction, slave less master.
    Vector jump(const Touch<dim> &touch, const Tensor &direction) const;

    /// The part of a row that supports leave free.
    Vector free_part(const Vector &row) const;

    unsigned int new_row(const tfeti::RowKind      kind,
                         const double              c,
                         const mechanics::NodeKey &key,
                         const std::uint64_t       which);
    void         fill(const unsigned int row, const Vector &coefficients);

    const scene::Scene<dim>               &scene;
    const std::vector<InterfaceNode<dim>> &nodes;
    const Touches<dim>                     touches;
    tfeti::Constraints                    &constraints;
    std::vector<double>                    limits;     // gaps, by pair [mm]
    Echelon                                bonds;      // their free parts
    std::set<std::array<unsigned int, 4>>  kept_bonds; // node, pair, side, direction of those that no others imply
  };
} // namespace slipstick::interface
