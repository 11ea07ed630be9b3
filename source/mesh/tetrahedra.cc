#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/mesh/refinement.h>
#include <slipstick/mesh/solid_middles.h>

namespace slipstick::mesh
{
  namespace
  {
    using Solid   = MeshPiece<3>;
    using Corners = std::array<unsigned int, 3>;

    // Vertices are ordered along this direction: no two vertices of a lattice have the same position along it.
    const dealii::Tensor<1, 3> oblique({1, 0.6180339887, 0.3247179572});

    /// Position of every vertex in the order.
    std::vector<unsigned int> positions_along(const dealii::Tensor<1, 3>          &direction,
                                              const std::vector<dealii::Point<3>> &x)
    {
      std::vector<std::pair<double, unsigned int>> sorted;
      for (unsigned int v = 0; v < x.size(); ++v)
        sorted.emplace_back(direction * x[v], v);
      std::sort(sorted.begin(), sorted.end());
      std::vector<unsigned int> positions(x.size());
      for (unsigned int k = 0; k < sorted.size(); ++k)
        positions[sorted[k].second] = k;
      return positions;
    }

    /// The triangles of a quadrilateral face (vertices in lexicographic order), cut along the diagonal from its first
    /// vertex.
    std::array<Corners, 2> halves(const Solid::Face &rows, const std::vector<unsigned int> &position)
    {
      constexpr std::array<unsigned int, 4> around = {{0, 1, 3, 2}};
      unsigned int                          first  = 0;
      for (unsigned int k = 1; k < 4; ++k)
        if (position[rows[around[k]]] < position[rows[around[first]]])
          first = k;
      const auto corner = [&](const unsigned int k) { return rows[around[(first + k) % 4]]; };
      return {{{{corner(0), corner(1), corner(2)}}, {{corner(0), corner(2), corner(3)}}}};
    }

    Solid::Face rows_of_face(const Solid::Cell &cell, const unsigned int f)
    {
      Solid::Face rows;
      for (unsigned int v = 0; v < rows.size(); ++v)
        rows[v] = cell[dealii::GeometryInfo<3>::face_to_cell_vertices(f, v)];
      return rows;
    }

    /// The surface of half of a quadrilateral face.
    FaceSurface surface_of(const FaceSurface &whole, const Corners &half, const Solid &piece)
    {
      if (whole.kind != FaceSurface::Kind::patch)
        return whole;
      std::array<FaceSurface::Place, 3> places;
      for (unsigned int k = 0; k < 3; ++k)
        {
          const auto &x = piece.vertices[half[k]];
          const auto  near =
            std::min_element(whole.points.begin(),
                             whole.points.begin() + whole.n_corners(),
                             [&](const auto &a, const auto &b) { return a.distance(x) < b.distance(x); });
          places[k] = FacetShapes::node(whole.n_corners(), near - whole.points.begin());
        }
      std::vector<dealii::Point<3>> nodes;
      for (const auto &place : places)
        nodes.push_back(whole.point(place));
      for (unsigned int k = 0; k < 3; ++k)
        nodes.push_back(whole.point(places[k] + .5 * (places[(k + 1) % 3] - places[k])));
      return FaceSurface::patch(nodes);
    }

    /// @param is_turned whether the base is clockwise as seen from the apex.
    void add_tetrahedron(const unsigned int apex, const Corners &base, const bool is_turned, Solid &to)
    {
      Solid::Cell cell;
      cell.fill(Solid::no_vertex);
      cell[0]             = base[0];
      cell[1]             = base[is_turned ? 2 : 1];
      cell[2]             = base[is_turned ? 1 : 2];
      cell[3]             = apex;
      const auto  &x      = to.vertices;
      const double volume = cross_product_3d(x[cell[1]] - x[cell[0]], x[cell[2]] - x[cell[0]]) * (x[apex] - x[cell[0]]);
      if (!(volume > 0)) // six times its volume
        throw InputError(
          format("the hexahedron at (%.6g, %.6g, %.6g) is too distorted to be divided into tetrahedra, which "
                 "refinement by errors needs",
                 x[apex][0],
                 x[apex][1],
                 x[apex][2]),
          "mesh the body with better hexahedra or with tetrahedra, or set Accuracy without a percentage and "
          "Mesh = fixed");
      to.cells.push_back(cell);
    }
  } // namespace

  MeshPiece<3> in_tetrahedra(const MeshPiece<3> &piece, const std::vector<dealii::Point<3>> &places)
  {
    const auto position = positions_along(oblique, places);
    Solid      result;
    result.subdomain       = piece.subdomain;
    result.body            = piece.body;
    result.vertices        = piece.vertices;
    result.global_vertices = piece.global_vertices;
    for (const auto &cell : piece.cells)
      {
        if (is_simplex<3>(cell))
          {
            result.cells.push_back(cell);
            continue;
          }
        const unsigned int first = *std::min_element(cell.begin(), cell.end(), [&](const auto v, const auto w) {
          return position[v] < position[w];
        });
        for (unsigned int f = 0; f < 6; ++f)
          {
            const auto rows = rows_of_face(cell, f);
            if (std::find(rows.begin(), rows.end(), first) != rows.end())
              continue;
            // the lexicographic order is counterclockwise as seen from the side where the transverse coordinate grows
            const bool is_high = f % 2 == 1;
            for (const auto &half : halves(rows, position))
              add_tetrahedron(first, half, is_high, result);
          }
      }
    const auto boundary = boundary_by_vertices(piece);
    for (const auto &entry : boundary)
      if (entry.first[3] == Solid::no_vertex)
        result.boundary_faces.push_back(entry.second);
    for (const auto &cell : piece.cells)
      for (unsigned int f = 0; f < 6 && !is_simplex<3>(cell); ++f)
        if (const auto found = boundary.find(face_of_cell<3>(cell, f)); found != boundary.end())
          for (const auto &half : halves(rows_of_face(cell, f), position))
            {
              const auto &whole = found->second;
              Solid::Face face  = {{half[0], half[1], half[2], Solid::no_vertex}};
              std::sort(face.begin(), face.end());
              result.boundary_faces.push_back({face, whole.id, surface_of(whole.curve, half, piece), whole.bends_cell});
            }
    refine_middles(piece, {}, result);
    return result;
  }
} // namespace slipstick::mesh
