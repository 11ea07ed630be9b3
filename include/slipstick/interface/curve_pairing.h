// Pairing of points on two curves that face each other.
#pragma once

#include <slipstick/interface/corners.h>
#include <slipstick/interface/edge_tree.h>
#include <slipstick/interface/facing_distance.h>
#include <slipstick/interface/surface_nodes.h>

#include <optional>

namespace slipstick::interface
{
  /// Search distances of a slave for its master along its normal, outwards and (for overlaps) inwards [mm].
  struct Reach
  {
    double ahead = 0, behind = 0;
  };

  // Jumps of the gap within a slave edge or facet by more than this fraction of its size are steps of the master.
  constexpr double smallest_jump = 1e-6;
  // Parts of the master that rise or fall more steeply than this above the part nearest to a slave edge or facet do not
  // belong to the same level (45 degrees).
  constexpr double steepest_slope = 1;

  /// Pairs slave and master edges by rays from the slave along a continuous field of normals: at the nodes the mean of
  /// both sides' normals, at corners of one side the normal of the other, interpolated by the linear shape functions.
  /// Two equal bodies then touch along their plane of symmetry, whichever is the slave; with the slave's own normals,
  /// closing a gap between curved bodies would cause an apparent slip.
  class CurvePairing
  {
  public:
    using Edge   = mechanics::SurfaceEdge<2>;
    using Tensor = dealii::Tensor<1, 2>;

    /// Where a ray from a slave point meets a master edge.
    struct Hit
    {
      double s   = 0; // on the master edge
      double gap = 0; // along the ray [mm]
    };

    /// Part of a slave edge.
    struct Segment
    {
      double       from = 0, to = 0; // on the slave edge
      unsigned int master = 0;       // edge
    };

    /// The edges are kept by reference.
    CurvePairing(const std::vector<Edge>   &slave,
                 const std::vector<Edge>   &master,
                 const Reach               &reach,
                 const mesh::Kinematics<2> &kinematics = {},
                 const Corners             &corners    = {});

    const std::vector<SurfaceNode<2>> &nodes() const
    {
      return own.nodes;
    }

    /// The nodes of slave edge e (two or three numbers).
    const PartNodes<Edge> &nodes_of(const unsigned int e) const
    {
      return own.of_part[e];
    }

    /// The parts of slave edge e that are faced by one master edge within reach; the first crossing counts. Where the
    /// distance jumps, as at a step or a slot of the master that is narrower than the edge, only the nearest level
    /// counts: one linear gap cannot describe both.
    std::vector<Segment> segments(const unsigned int e) const;

    /// The intersection of the ray from slave edge e at s with master edge m.
    std::optional<Hit> hit(const unsigned int e, const double s, const unsigned int m) const;

    /// Unit vector along that ray.
    Tensor direction(const unsigned int e, const double s) const
    {
      const Tensor n = field(e, s);
      return n / n.norm();
    }

    /// A positive factor, the same for all y, times the signed distance of y from that ray (positive to the left).
    double side(const unsigned int e, const double s, const dealii::Point<2> &y) const;

  private:
    Tensor                      field(const unsigned int e, const double s) const;
    std::optional<unsigned int> partner(const unsigned int               e,
                                        const double                     s,
                                        const std::vector<unsigned int> &candidates) const;
    std::vector<unsigned int>   candidates(const unsigned int e) const;
    std::vector<Segment>        nearest_level(const unsigned int e, std::vector<Segment> parts) const;
    void                        average_normals(const Corners &corners);

    const std::vector<Edge> &slave, &master;
    const Reach              reach;
    const EdgeTree           tree; // of the master
    SurfaceNodes<2>          own;  // of the slave
  };
} // namespace slipstick::interface
