// Curved edges of cells of degree 2: a manifold defined by the midpoints of edges.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <deal.II/grid/manifold.h>

namespace slipstick::mesh
{
  /// Lower limit of the Jacobian of a cell with curved edges, relative to that with straight edges.
  constexpr double smallest_jacobian = 0.2;

  /// Vertices in ascending order.
  template <int dim>
  using Middles = std::map<typename MeshPiece<dim>::Face, dealii::Point<dim>>;

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

  /// Midpoints of the curves of boundary faces (@p boundary, boundary_by_vertices() of the piece), except faces that do
  /// not bend their cell, and all faces of a cell that a mapping of degree 2 would invert or flatten
  /// somewhere, as where two edges on one circle meet at nearly 180 degrees.
  template <int dim>
  Middles<dim> middles_of_edges(
    const MeshPiece<dim>                                                                 &piece,
    const std::map<typename MeshPiece<dim>::Face, typename MeshPiece<dim>::BoundaryFace> &boundary);

  /// Whether the sagitta of a curve over face @p f of @p cell is small compared with the height of the cell over that
  /// face.
  template <int dim>
  bool has_room_for(const EdgeCurve<dim>                &curve,
                    const MeshPiece<dim>                &piece,
                    const typename MeshPiece<dim>::Cell &cell,
                    const unsigned int                   f);
} // namespace slipstick::mesh
