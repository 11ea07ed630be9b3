#include <slipstick/mesh/curved_faces.h>
#include <slipstick/mesh/solid_middles.h>

#include <cmath>

namespace slipstick::mesh
{
  namespace
  {
    using Piece  = MeshPiece<3>;
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;

    // Mid nodes at most this fraction of the length away from the chord belong to straight edges: files give
    // coordinates with seven digits, and coordinates may be a hundred times as large as the edge. The same for plane
    // faces.
    constexpr double straight = 1e-5;
    // A first-order face belongs to a curved surface if the angles to its neighbours at all of its corners are more
    // than this fraction of the largest angle; smaller angles [rad] are those of plane surfaces.
    constexpr double share_of_turn = 1. / 3, smallest_turn = 1e-4;

    /// The vertices of the boundary faces, in cyclic order.
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

    /// Removes the midpoints of straight edges.
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

    /// Whether the nodes of a patch are on the bilinear surface of its corners, or in their plane.
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

    /// Estimates the sagitta that first-order faces neglect, from the angles between them: the faces of a polygon
    /// around a cylinder meet at an angle on all sides, a plane face that ends at a chamfer on one side only. Angles of
    /// at least the corner angle of the body are edges of the body.
    class LeftOut
    {
    public:
      LeftOut(const double corner_angle, Piece &piece)
        : limit(corner_angle * M_PI / 180)
        , piece(piece)
        , around(vertices_around(piece))
      {}

      void run()
      {
        std::map<Piece::Line, std::vector<unsigned int>> faces_at;
        for (unsigned int f = 0; f < piece.boundary_faces.size(); ++f)
          for (const auto &line : lines_of(f))
            faces_at[line].push_back(f);
        for (const auto &[line, faces] : faces_at)
          if (faces.size() == 2)
            add_turn(line, normal(faces[0]), normal(faces[1]));
        for (unsigned int f = 0; f < piece.boundary_faces.size(); ++f)
          piece.boundary_faces[f].curve.neglected_sagitta = of_face(f);
      }

    private:
      std::vector<Piece::Line> lines_of(const unsigned int f) const
      {
        const auto              &v = around.at(piece.boundary_faces[f].vertices);
        std::vector<Piece::Line> lines;
        for (unsigned int k = 0; k < v.size(); ++k)
          lines.push_back({{std::min(v[k], v[(k + 1) % v.size()]), std::max(v[k], v[(k + 1) % v.size()])}});
        return lines;
      }

      /// Normal of length twice the area; orientation arbitrary.
      Tensor normal(const unsigned int f) const
      {
        const auto &v = around.at(piece.boundary_faces[f].vertices);
        const auto &x = piece.vertices;
        return cross_product_3d(x[v[2]] - x[v[0]], x[v[v.size() - 1]] - x[v[1]]);
      }

      void add_turn(const Piece::Line &line, const Tensor &a, const Tensor &b)
      {
        const double turn = std::atan2(cross_product_3d(a, b).norm(), std::abs(a * b));
        if (turn >= limit)
          return;
        turns[line] = turn;
        for (const unsigned int v : line)
          at_vertex[v] = std::max(at_vertex[v], turn);
      }

      double of_face(const unsigned int f) const
      {
        const double area    = normal(f).norm() / 2;
        double       largest = 0, neglected_sagitta = 0;
        for (const auto &line : lines_of(f))
          if (const auto found = turns.find(line); found != turns.end() && found->second > smallest_turn)
            {
              const double length = piece.vertices[line[0]].distance(piece.vertices[line[1]]);
              const double height = (around.at(piece.boundary_faces[f].vertices).size() == 3 ? 2 : 1) * area / length;
              largest             = std::max(largest, found->second);
              neglected_sagitta   = std::max(neglected_sagitta, height * found->second / 8);
            }
        for (const unsigned int v : around.at(piece.boundary_faces[f].vertices))
          if (const auto found = at_vertex.find(v); found != at_vertex.end() && found->second < share_of_turn * largest)
            return 0;
        return neglected_sagitta;
      }

      const double                                           limit;
      Piece                                                 &piece;
      const std::map<Piece::Face, std::vector<unsigned int>> around;
      std::map<Piece::Line, double>                          turns;
      std::map<unsigned int, double>                         at_vertex; // maximum per vertex
    };

    /// Patch through the corners, mid nodes of curved edges, midpoints of straight edges, and the centre of the face.
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
      return LeftOut(body.corner_angle, piece).run();
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
            face.curve = {};
            face.curve.neglected_sagitta =
              sagitta(patch, {patch.points.begin(), patch.points.begin() + vertices.size()});
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
      (n_spoilt == 0 ? ""
                     : "; the edges of " + std::to_string(n_spoilt) + " cells that this would invert stay straight"));
  }
} // namespace slipstick::mesh
