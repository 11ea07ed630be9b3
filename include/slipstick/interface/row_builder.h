// Local assembly of the rows of the nodes owned by one rank, before global numbering.
#pragma once

#include <slipstick/interface/echelon.h>
#include <slipstick/interface/interface_nodes.h>
#include <slipstick/interface/touches.h>

#include <set>

namespace slipstick::interface
{
  /// An entry of B, or of the interface unknowns, to be sent to the rank of its subdomain.
  struct RowEntry
  {
    std::uint64_t index; // row or interface unknown: first its owned, later its global number
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

  /// Builds the rows of interface nodes: contact, bonds, supports, foundations, gluing.
  ///
  /// Contact rows that are already implied by the supports of their nodes and the bonds (of all connected nodes) are
  /// omitted; of two dependent rows the tangential one is omitted first. So are redundant rows of bonds, e.g. where
  /// three bonded bodies meet in a point: those of the pair that comes last in the scene. A node that may touch several
  /// obstacles has one normal row for each (for parallel normals only for the nearest) and one tangential row, for the
  /// nearest obstacle. The same holds for a node at a corner of the slave boundary with the same master node on both
  /// its sides.
  template <int dim>
  class RowBuilder
  {
  public:
    /// @param nodes are all owned by this rank. @param contacts must outlive this.
    RowBuilder(const scene::Scene<dim>               &scene,
               const std::vector<InterfaceNode<dim>> &nodes,
               const BodyContacts<dim>               &contacts,
               const double                           t,
               tfeti::Constraints                    &constraints);

    /// Extent of every pair, from the slave nodes owned by this rank.
    std::vector<PairExtent> extents() const
    {
      return touches.extents();
    }

    /// Nodes of pair k with a gap above limits[k] get no rows (if ContactLaw::acts_where_closed_alone()); they are
    /// added to `pruned`.
    void limit_gaps(std::vector<double> limits);

    /// Fills kind, c, compliance, label, contact points, reactions and counts of the constraints.
    void build();

    std::vector<RowEntry> entries;
    tfeti::Constraints    pruned;         // kind and c of the normal rows of pruned nodes ...
    std::vector<RowEntry> pruned_entries; // ... and their entries
    tfeti::HeldContacts   held;           // the same for nodes whose gap is prescribed
    std::vector<RowEntry> held_entries;
    std::uint64_t         n_interface = 0;

  private:
    using Tensor   = dealii::Tensor<1, dim>;
    using Vector   = Echelon::Vector; // by dim * node + component
    using Tangents = std::array<Tensor, dim - 1>;

    void add(const unsigned int node);

    void add_contact(const unsigned int node);
    /// Without bonds and what they imply; candidates whose gap supports or bonds prescribe, in parts.
    std::vector<ContactCandidate<dim>> contacts_beside_bonds(std::vector<ContactCandidate<dim>> touching) const;
    void                               find_bonds();
    /// Of the jump along @p direction the part that supports do not prescribe, of each side relative to its size; that
    /// of the master counts by held_tangent / held_master.
    Vector free_sides(const ContactCandidate<dim> &touch, const Tensor &direction) const;
    /// If supports hold both sides along a tangent, it is the second one.
    Tangents tangents_of(const ContactCandidate<dim> &touch) const;
    bool     is_pruned(const ContactCandidate<dim> &touch) const;
    /// The part of the jump along a row that the displacements of supports prescribe at the load factor @p at [mm].
    double                 prescribed(const Vector &row, const double at) const;
    dealii::Tensor<1, dim> held_displacement(const unsigned int node, const double at) const;
    /// Whether supports move the two sides of a row relative to each other now, or did in an earlier load step.
    bool is_moved(const Vector &row) const;
    /// Rows along the tangents that supports, bonds and @p left, the free part of the normal row, do not hold, or along
    /// which supports move the node: it slides.
    std::vector<Vector> free_tangents(ContactCandidate<dim> &touch, const Vector &left) const;
    /// Whether supports hold the point open although its law acts only on closed contact.
    bool is_held_open(const tfeti::HeldContacts::Point &point) const;
    /// Appends the entries @p coefficients of row @p row to @p to.
    void fill(const unsigned int row, const Vector &coefficients, std::vector<RowEntry> &to) const;
    void add_pruned(const ContactCandidate<dim> &touch, const Vector &coefficients);
    void add_held(const unsigned int node, const ContactCandidate<dim> &touch, const Vector &coefficients);
    void add_bonds_to_obstacles(const unsigned int node);
    void add_held_rows(const unsigned int node);
    void add_reaction(const unsigned int               node,
                      const unsigned int               row,
                      const Tensor                    &direction,
                      const std::vector<unsigned int> &holders);

    /// Jump of the displacement along @p direction: slave minus master.
    Vector jump(const ContactCandidate<dim> &touch, const Tensor &direction) const;

    /// The part of a row that supports do not prescribe.
    Vector free_part(const Vector &row) const;

    unsigned int new_row(const tfeti::RowKind      kind,
                         const double              c,
                         const mechanics::NodeKey &key,
                         const std::uint64_t       which);
    void         fill(const unsigned int row, const Vector &coefficients);

    const scene::Scene<dim>               &scene;
    const std::vector<InterfaceNode<dim>> &nodes;
    const double                           t;
    const Touches<dim>                     touches;
    tfeti::Constraints                    &constraints;
    std::vector<double>                    limits;     // gaps, by pair [mm]
    Echelon                                bonds;      // free parts of the rows of bonds
    std::set<std::array<unsigned int, 4>>  kept_bonds; // node, pair, side, direction of independent ones
  };
} // namespace slipstick::interface
