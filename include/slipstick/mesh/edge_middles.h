// Curved edges of cells of degree 2: a manifold defined by the midpoints of edges.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <deal.II/grid/manifold.h>

namespace slipstick::mesh
{
  /// Lower limit of the Jacobian of a cell with curved edges, relative to that with straight edges.
  constexpr double smallest_jacobian = 0.2;

  /// By the vertices of edges, ascending.
  template <int dim>
  using Middles = std::map<typename MeshPiece<dim>::Line, dealii::Point<dim>>;

  /// Manifold with given midpoints on some edges, flat for all others. Mappings of degree 2 need nothing else.
  template <int dim>
  class EdgeMiddles : public dealii::FlatManifold<dim>
  {
  public:
    static constexpr dealii::types::manifold_id id = 1;

    explicit EdgeMiddles(Middles<dim> middles);

    std::unique_ptr<dealii::Manifold<dim>> clone() const override;

    dealii::Point<dim> get_new_point_on_line(
      const typename dealii::Triangulation<dim>::line_iterator &line) const override;

  private:
    const Middles<dim> middles;
  };

  /// Sets the midpoints of edges (MeshPiece::line_middles): of boundary edges those of their curves and, where a cell
  /// is thin compared with the rise of its curved edge above the chord, of further edges inside the body, whose rise
  /// decreases from cell to cell: cells stay close to affine, however thin they are. Boundary edges of a cell that a
  /// mapping of degree 2 would still invert or flatten somewhere, as where two edges on one circle meet at nearly 180
  /// degrees, stay straight (BoundaryFace::bends_cell).
  void bend_edges(MeshPiece<2> &piece);

  /// Cells with an edge that rises by more than a tenth of the height above it. Transition cells of a local refinement
  /// would have no room beside such an edge: these cells are divided regularly or not at all. @param piece after
  /// bend_edges().
  std::vector<bool> strongly_bent(const MeshPiece<2> &piece);

  /// Number of boundary edges that are straight though their boundary is curved.
  unsigned int n_unbent(const MeshPiece<2> &piece);
} // namespace slipstick::mesh
