#include <slipstick/mesh/curved_faces.h>
#include <slipstick/mesh/solid_middles.h>

namespace slipstick::mesh
{
  namespace
  {
    using Piece  = MeshPiece<3>;
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;

    // Mid nodes no farther from the chord than this part of its length belong to straight edges: files give seven digits of
    // coordinates, which may be a hundred times as large. The same of faces that are plane.
    constexpr double straight = 1e-5;

    Point between(const Point &a, const Point &b)
    {
      return a + 0.5 * (b - a);
    }

    /// The vertices of the boundary faces, around.
    std::map<Piece::Face, std::vector<unsigned int>> vertices_around(const Piece &piece)
    {
      std::map<Piece::Face, std::vector<unsigned int>> around;
      for (const auto &face : piece.boundary_faces)
        around[face.vertices];
      for (const auto &cell : piece.cells)
        for (unsigned int f = 0; f < n_faces<3>(cell); ++f)
          if (const auto found = around.find(face_of_cell<3>(cell, f)); found != around.end())
            {
              if (is_simplex<3>(cell))
                found->second.assign(found->first.begin(), found->first.begin() + 3);
              else
                for (const unsigned int v : {0, 1, 3, 2})
                  found->second.push_back(cell[dealii::GeometryInfo<3>::face_to_cell_vertices(f, v)]);
            }
      return around;
    }

    /// Takes the middles of straight edges out.
    void straighten(Piece &piece)
    {
      for (auto entry = piece.line_middles.begin(); entry != piece.line_middles.end();)
        {
          const auto &[line, middle] = *entry;
          const Tensor chord = piece.vertices[line[1]] - piece.vertices[line[0]], to = middle - piece.vertices[line[0]];
          const double length = chord.norm();
          if ((to - (to * chord) / (length * length) * chord).norm() <= straight * length)
            entry = piece.line_middles.erase(entry);
          else
            ++entry;
        }
    }

    /// Are the nodes of a patch on the bilinear surface of its corners, or on their plane?
    bool is_flat(const FaceSurface &patch)
    {
      const unsigned int n = patch.n_corners();
      const Tensor across  = cross_product_3d(patch.points[2] - patch.points[0], patch.points[n - 1] - patch.points[1]);
      for (unsigned int i = n; i < patch.n_nodes; ++i)
        {
          const auto N = FacetShapes::linear(n, FacetShapes::node(n, i));
          Tensor     off(patch.points[i]);
          for (unsigned int k = 0; k < n; ++k)
            off -= N[k] * Tensor(patch.points[k]);
          if (std::abs(off * across) > straight * std::pow(across.norm(), 1.5))
            return false;
        }
      return true;
    }

    /// Through the corners, mid nodes of curved edges, the middles of straight ones, and that of the face.
    FaceSurface patch_of(const BodyMesh<3>               &mesh,
                         const Piece::BoundaryFace       &face,
                         const std::vector<unsigned int> &around)
    {
      static const std::map<Piece::Face, Piece::BoundaryFace> no_surfaces;
      const SolidMiddles                                      middles(mesh.piece, no_surfaces);
      std::vector<Point>                                      nodes;
      for (const unsigned int v : around)
        nodes.push_back(mesh.piece.vertices[v]);
      for (unsigned int k = 0; k < around.size(); ++k)
        nodes.push_back(middles.on_line(around[k], around[(k + 1) % around.size()]));
      if (around.size() == 4)
        {
          const auto found = mesh.middles.find(face.vertices);
          nodes.push_back(found != mesh.middles.end()
                            ? found->second
                            : middles.on_face({{around[0], around[1], around[3], around[2]}}));
        }
      return FaceSurface::patch(nodes);
    }
  } // namespace

  double sagitta(const FaceSurface &surface, const std::vector<Point> &corners)
  {
    double largest = 0;
    for (unsigned int k = 0; k < corners.size(); ++k)
      {
        const Point chord = between(corners[k], corners[(k + 1) % corners.size()]);
        largest           = std::max(largest,
                           chord.distance(surface.kind == FaceSurface::Kind::patch ? surface.points[corners.size() + k]
                                                                                   : surface.nearest(chord)));
      }
    return largest;
  }

  void curve_faces(const scene::Body<3> &body, BodyMesh<3> &mesh)
  {
    Piece &piece = mesh.piece;
    straighten(piece);
    if (piece.line_middles.empty())
      return;
    unsigned int n_bent = 0;
    const auto   around = vertices_around(piece);
    for (auto &face : piece.boundary_faces)
      {
        const auto &vertices = around.at(face.vertices);
        const auto  patch    = patch_of(mesh, face, vertices);
        if (is_flat(patch))
          continue;
        ++n_bent;
        face.curve = patch;
        if (!body.has_smooth_outline)
          {
            face.curve          = {};
            face.curve.left_out = sagitta(patch, {patch.points.begin(), patch.points.begin() + vertices.size()});
          }
      }
    if (!body.has_smooth_outline)
      {
        piece.line_middles.clear();
        return;
      }
    const unsigned int n_spoilt = keep_good_middles(piece);
    mesh.remarks.push_back(
      "body " + body.name + ": " + std::to_string(n_bent) + " of " + std::to_string(piece.boundary_faces.size()) +
      " boundary faces are curved by their mid nodes (Outline = polygon: straight)" +
      (n_spoilt == 0
         ? ""
         : "; the edges of " + std::to_string(n_spoilt) + " cells that this would turn over stay straight"));
  }
} // namespace slipstick::mesh
