// Nodes of degree 2 of solids with a curved boundary, and a manifold defined by them.
#pragma once

#include <slipstick/mesh/edge_middles.h>
#include <slipstick/mesh/mesh_piece.h>

#include <deal.II/grid/manifold.h>

namespace slipstick::mesh
{
  /// Midpoint of two points.
  inline dealii::Point<3> between(const dealii::Point<3> &a, const dealii::Point<3> &b)
  {
    return a + 0.5 * (b - a);
  }

  /// Midpoints of edges, faces and cells of a piece: on the curved boundary, elsewhere on the Coons patch of their
  /// boundary.
  class SolidMiddles
  {
  public:
    using Piece = MeshPiece<3>;
    using Point = dealii::Point<3>;

    /// @param boundary boundary_by_vertices() of the piece. Both are kept by reference.
    SolidMiddles(const Piece &piece, const std::map<Piece::Face, Piece::BoundaryFace> &boundary);

    bool  is_curved(const unsigned int a, const unsigned int b) const;
    bool  is_curved(const Piece::Cell &cell) const;
    Point on_line(const unsigned int a, const unsigned int b) const;

    /// Centre of a quadrilateral whose vertices are in lexicographic order.
    Point on_face(const Piece::Face &rows) const;
    Point in_hexahedron(const Piece::Cell &cell) const;

    /// Whether the mapping of degree 2 of a cell keeps its orientation, with volumes no less than a given fraction of
    /// those with straight edges.
    bool keeps_its_shape(const Piece::Cell &cell) const;

  private:
    /// Jacobian of the mapping of degree 2 of a tetrahedron, at barycentric coordinates.
    double jacobian(const Piece::Cell &cell, const std::array<double, 4> &L) const;

    const Piece                                      &piece;
    const std::map<Piece::Face, Piece::BoundaryFace> &boundary;
  };

  /// Sets the midpoints of the edges of faces on balls and cylinders (BoundaryFace::curve).
  void bend_lines(MeshPiece<3> &piece);

  /// Point on the parabola through both ends and the midpoint of an edge, @p s from 0 to 1.
  dealii::Point<3> on_parabola(const dealii::Point<3> &from,
                               const dealii::Point<3> &middle,
                               const dealii::Point<3> &to,
                               const double            s);

  /// The part of a patch with these corners, in cyclic order.
  FaceSurface part_of(const FaceSurface &patch, const std::vector<FaceSurface::Place> &corners);

  /// The surface of the part @p face (vertices of @p finer, which halve edges) of a face.
  FaceSurface part_of(const MeshPiece<3>::BoundaryFace &whole,
                      const MeshPiece<3>::Face         &face,
                      const MeshPiece<3>               &finer);

  /// Vertices that divide edges, and their position: from 0 at the end with the lower number to 1, sorted.
  using VerticesOnLines = std::map<MeshPiece<3>::Line, std::vector<std::pair<double, unsigned int>>>;

  /// Sets the midpoints of the edges of a refined piece that are on its curved faces and edges. @param dividing the
  /// curved edges of @p coarse.
  void refine_middles(const MeshPiece<3> &coarse, const VerticesOnLines &dividing, MeshPiece<3> &finer);

  /// Removes the midpoints from edges of cells that a mapping of degree 2 would invert or flatten, and marks the faces
  /// there (BoundaryFace::bends_cell). @return number of these cells.
  unsigned int keep_good_middles(MeshPiece<3> &piece);

  /// Manifold with given midpoints of edges and faces, flat for all others. Mappings of degree 2 need nothing else.
  class SolidManifold : public dealii::FlatManifold<3>
  {
  public:
    static constexpr dealii::types::manifold_id id = 1;

    using Lines = std::map<MeshPiece<3>::Line, dealii::Point<3>>;
    using Faces = std::map<MeshPiece<3>::Face, dealii::Point<3>>; // vertices in ascending order

    SolidManifold(Lines lines, Faces faces);

    std::unique_ptr<dealii::Manifold<3>> clone() const override;

    dealii::Point<3> get_new_point_on_line(const dealii::Triangulation<3>::line_iterator &line) const override;
    dealii::Point<3> get_new_point_on_quad(const dealii::Triangulation<3>::quad_iterator &face) const override;

  private:
    const Lines lines;
    const Faces faces;
  };

  /// Attaches the manifold of the curved edges of a piece to its triangulation.
  void follow_middles(const MeshPiece<3>                                             &piece,
                      const std::map<MeshPiece<3>::Face, MeshPiece<3>::BoundaryFace> &boundary,
                      dealii::Triangulation<3>                                       &triangulation);
} // namespace slipstick::mesh
