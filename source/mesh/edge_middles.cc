#include <slipstick/base/cross.h>
#include <slipstick/mesh/edge_middles.h>

#include <cmath>

namespace slipstick::mesh
{
  namespace
  {
    // Limit on the sagitta relative to the height of the cell above that edge: above it the mapping of the cell is no
    // longer nearly linear.
    constexpr double largest_sagitta = 0.3;

    /// Whether the corners of a cell remain convex if its edges are parabolas through the midpoints.
    template <int dim>
    bool keeps_its_corners(const MeshPiece<dim>                &piece,
                           const typename MeshPiece<dim>::Cell &cell,
                           const Middles<dim>                  &middles)
    {
      const unsigned int n      = n_corners<dim>(cell);
      const auto         x      = [&](const unsigned int k) { return piece.vertices[corner<dim>(cell, k)]; };
      const auto         middle = [&](const unsigned int f) {
        const auto found = middles.find(face_of_cell<dim>(cell, f));
        return found != middles.end() ? found->second : x(f) + 0.5 * (x(f + 1) - x(f));
      };
      for (unsigned int k = 0; k < n; ++k)
        {
          const unsigned int last = k + n - 1; // face that ends at the corner
          const auto         to = x(k + 1) - x(k), from = x(last) - x(k);
          if (!(cross(4 * (middle(k) - x(k)) - to, 4 * (middle(last) - x(k)) - from) >=
                smallest_jacobian * cross(to, from)))
            return false;
        }
      return true;
    }
  } // namespace

  template <int dim>
  EdgeMiddles<dim>::EdgeMiddles(Middles<dim> middles)
    : middles(std::move(middles))
  {}

  template <int dim>
  std::unique_ptr<dealii::Manifold<dim>> EdgeMiddles<dim>::clone() const
  {
    return std::make_unique<EdgeMiddles<dim>>(middles);
  }

  template <int dim>
  dealii::Point<dim> EdgeMiddles<dim>::get_new_point_on_line(
    const typename dealii::Triangulation<dim>::line_iterator &line) const
  {
    const unsigned int a = line->vertex_index(0), b = line->vertex_index(1);
    const auto         found = middles.find({{std::min(a, b), std::max(a, b)}});
    return found != middles.end() ? found->second : dealii::FlatManifold<dim>::get_new_point_on_line(line);
  }

  template <int dim>
  bool has_room_for(const EdgeCurve<dim>                &curve,
                    const MeshPiece<dim>                &piece,
                    const typename MeshPiece<dim>::Cell &cell,
                    const unsigned int                   f)
  {
    const auto   x     = [&](const unsigned int k) { return piece.vertices[corner<dim>(cell, k)]; };
    const auto   along = x(f + 1) - x(f);
    const double rise  = sagitta(curve) * along.norm();
    for (unsigned int k = f + 2; k < f + n_corners<dim>(cell); ++k)
      if (rise > largest_sagitta * std::abs(cross(along, x(k) - x(f))))
        return false;
    return true;
  }

  template <int dim>
  Middles<dim> middles_of_edges(
    const MeshPiece<dim>                                                                 &piece,
    const std::map<typename MeshPiece<dim>::Face, typename MeshPiece<dim>::BoundaryFace> &boundary)
  {
    Middles<dim> middles;
    for (const auto &[vertices, face] : boundary)
      if (face.curve && face.bends_cell)
        middles[vertices] = face.curve.point(0.5);
    if (middles.empty())
      return middles;
    for (const auto &cell : piece.cells)
      {
        bool is_curved = false, is_good = true;
        for (unsigned int f = 0; f < n_corners<dim>(cell); ++f)
          if (const auto vertices = face_of_cell<dim>(cell, f); middles.count(vertices) > 0)
            {
              is_curved = true;
              is_good   = is_good && has_room_for<dim>(boundary.at(vertices).curve, piece, cell, f);
            }
        if (is_curved && !(is_good && keeps_its_corners(piece, cell, middles)))
          for (unsigned int f = 0; f < n_corners<dim>(cell); ++f)
            middles.erase(face_of_cell<dim>(cell, f));
      }
    return middles;
  }

  template class EdgeMiddles<2>;
  template bool       has_room_for(const EdgeCurve<2> &,
                                   const MeshPiece<2> &,
                                   const MeshPiece<2>::Cell &,
                                   const unsigned int);
  template Middles<2> middles_of_edges(const MeshPiece<2> &,
                                       const std::map<MeshPiece<2>::Face, MeshPiece<2>::BoundaryFace> &);
} // namespace slipstick::mesh
