#include <slipstick/mesh/solid_middles.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace slipstick::mesh
{
  namespace
  {
    using Piece  = MeshPiece<3>;
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;

    // Midpoints at most this fraction of the length away from the chord belong to straight edges, e.g. along the axis
    // of a cylinder.
    constexpr double on_chord = 1e-12;

    /// Jacobian of the mapping of degree 2 with three nodes per direction, at one of the nodes.
    double jacobian(const std::array<Point, 27> &x, const std::array<unsigned int, 3> &at)
    {
      // of the shape functions at 0, 1/2 and 1
      constexpr std::array<std::array<double, 3>, 3> derivatives = {{{{-3, 4, -1}}, {{-1, 0, 1}}, {{1, -4, 3}}}};
      std::array<Tensor, 3>                          along;
      for (unsigned int d = 0; d < 3; ++d)
        for (unsigned int k = 0; k < 3; ++k)
          {
            auto node = at;
            node[d]   = k;
            along[d] += derivatives[at[d]][k] * Tensor(x[node[0] + 3 * node[1] + 9 * node[2]]);
          }
      return cross_product_3d(along[0], along[1]) * along[2];
    }

    /// Whether the Jacobians at all nodes are positive and large enough.
    bool are_good(const std::array<Point, 27> &bent, const std::array<Point, 27> &straight)
    {
      for (unsigned int i = 0; i < 27; ++i)
        {
          const std::array<unsigned int, 3> at = {{i % 3, i / 3 % 3, i / 9}};
          if (!(jacobian(bent, at) >= smallest_jacobian * jacobian(straight, at)))
            return false;
        }
      return true;
    }
  } // namespace

  SolidMiddles::SolidMiddles(const Piece &piece, const std::map<Piece::Face, Piece::BoundaryFace> &boundary)
    : piece(piece)
    , boundary(boundary)
  {}

  bool SolidMiddles::is_curved(const unsigned int a, const unsigned int b) const
  {
    return piece.line_middles.count({{std::min(a, b), std::max(a, b)}}) > 0;
  }

  bool SolidMiddles::is_curved(const Piece::Cell &cell) const
  {
    for (const auto &[a, b] : lines_of_cell(cell))
      if (is_curved(a, b))
        return true;
    return false;
  }

  Point SolidMiddles::on_line(const unsigned int a, const unsigned int b) const
  {
    const auto found = piece.line_middles.find({{std::min(a, b), std::max(a, b)}});
    return found != piece.line_middles.end() ? found->second : between(piece.vertices[a], piece.vertices[b]);
  }

  Point SolidMiddles::on_face(const Piece::Face &rows) const
  {
    const auto &[a, b, c, d] = rows;
    Point coons;
    for (const auto &[v, w] : {std::pair(a, b), {a, c}, {b, d}, {c, d}})
      coons += 0.5 * Tensor(on_line(v, w));
    for (const unsigned int v : rows)
      coons -= 0.25 * Tensor(piece.vertices[v]);
    auto key = rows;
    std::sort(key.begin(), key.end());
    const auto found = boundary.find(key);
    if (found == boundary.end() || !found->second.curve || !found->second.bends_cell)
      return coons;
    const auto &surface = found->second.curve;
    return surface.kind == FaceSurface::Kind::patch ? surface.point({0.5, 0.5}) : surface.nearest(coons);
  }

  Point SolidMiddles::in_hexahedron(const Piece::Cell &cell) const
  {
    Point center;
    for (unsigned int f = 0; f < 6; ++f)
      {
        Piece::Face rows;
        for (unsigned int v = 0; v < 4; ++v)
          rows[v] = cell[dealii::GeometryInfo<3>::face_to_cell_vertices(f, v)];
        center += 0.5 * Tensor(on_face(rows));
      }
    for (const auto &[a, b] : lines_of_cell(cell))
      center -= 0.25 * Tensor(on_line(a, b));
    for (const unsigned int v : cell)
      center += 0.125 * Tensor(piece.vertices[v]);
    return center;
  }

  double SolidMiddles::jacobian(const Piece::Cell &cell, const std::array<double, 4> &L) const
  {
    std::array<Tensor, 4> by; // derivatives with respect to the barycentric coordinates
    for (unsigned int i = 0; i < 4; ++i)
      {
        by[i] += (4 * L[i] - 1) * Tensor(piece.vertices[cell[i]]);
        for (unsigned int j = 0; j < 4; ++j)
          if (j != i)
            by[i] += 4 * L[j] * Tensor(on_line(cell[i], cell[j]));
      }
    return cross_product_3d(by[1] - by[0], by[2] - by[0]) * (by[3] - by[0]);
  }

  bool SolidMiddles::keeps_its_shape(const Piece::Cell &cell) const
  {
    if (is_simplex<3>(cell))
      {
        std::array<Tensor, 3> straight;
        for (unsigned int d = 0; d < 3; ++d)
          straight[d] = piece.vertices[cell[d + 1]] - piece.vertices[cell[0]];
        const double volume = cross_product_3d(straight[0], straight[1]) * straight[2];
        for (unsigned int i = 0; i < 4; ++i) // at the corners and the midpoints of the edges
          for (unsigned int j = i; j < 4; ++j)
            {
              std::array<double, 4> L{};
              L[i] += 0.5;
              L[j] += 0.5;
              if (!(jacobian(cell, L) / volume >= smallest_jacobian))
                return false;
            }
        return true;
      }
    std::array<Point, 27> bent, straight;
    for (unsigned int i = 0; i < 27; ++i)
      {
        const std::array<unsigned int, 3> at = {{i % 3, i / 3 % 3, i / 9}};
        std::vector<unsigned int>         near; // corners, in lexicographic order
        Tensor                            sum;
        for (unsigned int v = 0; v < 8; ++v)
          {
            bool is_near = true;
            for (unsigned int d = 0; d < 3; ++d)
              is_near = is_near && (at[d] == 1 || at[d] == 2 * (v >> d & 1));
            if (is_near)
              {
                near.push_back(cell[v]);
                sum += Tensor(piece.vertices[cell[v]]);
              }
          }
        straight[i] = Point(sum / double(near.size()));
        bent[i]     = near.size() == 1   ? straight[i]
                      : near.size() == 2 ? on_line(near[0], near[1])
                      : near.size() == 4 ? on_face({{near[0], near[1], near[2], near[3]}})
                                         : in_hexahedron(cell);
      }
    return are_good(bent, straight);
  }

  void bend_lines(MeshPiece<3> &piece)
  {
    std::map<Piece::Face, const FaceSurface *> surfaces;
    for (auto &face : piece.boundary_faces)
      if (face.curve && face.curve.kind != FaceSurface::Kind::patch && face.bends_cell)
        {
          auto key = face.vertices;
          std::sort(key.begin(), key.end());
          surfaces[key] = &face.curve;
        }
    if (surfaces.empty())
      return;
    for (const auto &cell : piece.cells)
      for (unsigned int f = 0; f < n_faces<3>(cell); ++f)
        {
          const auto key   = face_of_cell<3>(cell, f);
          const auto found = surfaces.find(key);
          if (found == surfaces.end())
            continue;
          for (const auto &line : lines_of_cell(cell))
            if (std::binary_search(key.begin(), key.end(), line[0]) &&
                std::binary_search(key.begin(), key.end(), line[1]))
              {
                const Point a = piece.vertices[line[0]], b = piece.vertices[line[1]], chord = between(a, b);
                const Point middle = found->second->nearest(chord);
                if (middle.distance(chord) > on_chord * a.distance(b))
                  piece.line_middles[line] = middle;
              }
        }
  }

  Point on_parabola(const Point &from, const Point &middle, const Point &to, const double s)
  {
    return Point((1 - s) * (1 - 2 * s) * Tensor(from) + 4 * s * (1 - s) * Tensor(middle) +
                 s * (2 * s - 1) * Tensor(to));
  }

  FaceSurface part_of(const FaceSurface &patch, const std::vector<FaceSurface::Place> &corners)
  {
    const unsigned int n = patch.n_corners();
    std::vector<Point> nodes;
    for (unsigned int i = 0; i < patch.n_nodes; ++i)
      {
        const auto         N = FacetShapes::linear(n, FacetShapes::node(n, i));
        FaceSurface::Place at;
        for (unsigned int k = 0; k < n; ++k)
          at += N[k] * corners[k];
        nodes.push_back(patch.point(at));
      }
    return FaceSurface::patch(nodes);
  }

  FaceSurface part_of(const Piece::BoundaryFace &whole, const Piece::Face &face, const Piece &finer)
  {
    const FaceSurface &surface = whole.curve;
    if (surface.kind != FaceSurface::Kind::patch)
      {
        FaceSurface part = surface;
        part.neglected_sagitta /= 4; // edges are half as long
        return part;
      }
    // vertices are nodes of the patch
    const unsigned int              n = surface.n_corners();
    std::vector<FaceSurface::Place> corners;
    FaceSurface::Place              center;
    for (unsigned int k = 0; k < n; ++k)
      {
        const Point &x = finer.vertices[face[k]];
        const auto   node =
          std::min_element(surface.points.begin(),
                           surface.points.begin() + surface.n_nodes,
                           [&](const Point &a, const Point &b) { return a.distance(x) < b.distance(x); });
        corners.push_back(FacetShapes::node(n, node - surface.points.begin()));
        center += corners.back() / double(n);
      }
    std::sort(corners.begin(), corners.end(), [&](const auto &p, const auto &q) {
      return std::atan2(p[1] - center[1], p[0] - center[0]) < std::atan2(q[1] - center[1], q[0] - center[0]);
    });
    return part_of(surface, corners);
  }

  void refine_middles(const Piece &coarse, const VerticesOnLines &dividing, Piece &finer)
  {
    const auto put = [&finer](const unsigned int a, const unsigned int b, const Point &x) {
      if (x.distance(between(finer.vertices[a], finer.vertices[b])) >
          on_chord * finer.vertices[a].distance(finer.vertices[b]))
        finer.line_middles.emplace(Piece::Line{{std::min(a, b), std::max(a, b)}}, x);
    };
    for (const auto &[line, x] : coarse.line_middles)
      {
        const auto found = dividing.find(line);
        auto       ends  = found != dividing.end() ? found->second : VerticesOnLines::mapped_type();
        ends.emplace_back(1., line[1]);
        std::pair<double, unsigned int> last(0., line[0]);
        for (const auto &next : ends)
          {
            put(last.second,
                next.second,
                on_parabola(coarse.vertices[line[0]], x, coarse.vertices[line[1]], (last.first + next.first) / 2));
            last = next;
          }
      }
    for (const auto &face : finer.boundary_faces)
      if (face.curve.kind == FaceSurface::Kind::patch && face.bends_cell)
        {
          const unsigned int        n = face.curve.n_corners();
          std::vector<unsigned int> around; // vertices at the corners of the patch
          for (unsigned int k = 0; k < n; ++k)
            around.push_back(*std::min_element(face.vertices.begin(), face.vertices.begin() + n, [&](auto v, auto w) {
              return finer.vertices[v].distance(face.curve.points[k]) <
                     finer.vertices[w].distance(face.curve.points[k]);
            }));
          for (unsigned int k = 0; k < n; ++k)
            put(around[k], around[(k + 1) % n], face.curve.points[n + k]);
        }
    bend_lines(finer);
  }

  unsigned int keep_good_middles(MeshPiece<3> &piece)
  {
    std::set<unsigned int> spoilt;
    if (piece.line_middles.empty())
      return 0;
    for (;;)
      {
        const auto            boundary = boundary_by_vertices(piece);
        const SolidMiddles    middles(piece, boundary);
        std::set<Piece::Line> lost;
        for (unsigned int c = 0; c < piece.cells.size(); ++c)
          if (middles.is_curved(piece.cells[c]) && !middles.keeps_its_shape(piece.cells[c]))
            {
              spoilt.insert(c);
              for (const auto &line : lines_of_cell(piece.cells[c]))
                if (piece.line_middles.count(line) > 0)
                  lost.insert(line);
            }
        if (lost.empty())
          return spoilt.size();
        for (const auto &line : lost)
          piece.line_middles.erase(line);
        for (auto &face : piece.boundary_faces)
          for (const auto &[a, b] : lost)
            if (std::count(face.vertices.begin(), face.vertices.end(), a) > 0 &&
                std::count(face.vertices.begin(), face.vertices.end(), b) > 0)
              face.bends_cell = false;
      }
  }

  SolidManifold::SolidManifold(Lines lines, Faces faces)
    : lines(std::move(lines))
    , faces(std::move(faces))
  {}

  std::unique_ptr<dealii::Manifold<3>> SolidManifold::clone() const
  {
    return std::make_unique<SolidManifold>(lines, faces);
  }

  Point SolidManifold::get_new_point_on_line(const dealii::Triangulation<3>::line_iterator &line) const
  {
    const unsigned int a = line->vertex_index(0), b = line->vertex_index(1);
    const auto         found = lines.find({{std::min(a, b), std::max(a, b)}});
    return found != lines.end() ? found->second : between(line->vertex(0), line->vertex(1));
  }

  Point SolidManifold::get_new_point_on_quad(const dealii::Triangulation<3>::quad_iterator &face) const
  {
    Piece::Face key;
    key.fill(Piece::no_vertex);
    for (const unsigned int v : face->vertex_indices())
      key[v] = face->vertex_index(v);
    std::sort(key.begin(), key.end());
    const auto found = faces.find(key);
    return found != faces.end() ? found->second : dealii::FlatManifold<3>::get_new_point_on_quad(face);
  }

  void follow_middles(const MeshPiece<3>                               &piece,
                      const std::map<Piece::Face, Piece::BoundaryFace> &boundary,
                      dealii::Triangulation<3>                         &triangulation)
  {
    if (piece.line_middles.empty())
      return;
    const SolidMiddles   middles(piece, boundary);
    SolidManifold::Faces faces;
    for (const auto &cell : triangulation.active_cell_iterators())
      {
        for (const unsigned int l : cell->line_indices())
          if (const auto line = cell->line(l); middles.is_curved(line->vertex_index(0), line->vertex_index(1)))
            line->set_manifold_id(SolidManifold::id);
        for (const unsigned int f : cell->face_indices())
          {
            const auto face      = cell->face(f);
            bool       is_curved = false;
            for (unsigned int l = 0; l < face->n_lines(); ++l)
              is_curved = is_curved || face->line(l)->manifold_id() == SolidManifold::id;
            if (!is_curved)
              continue;
            face->set_manifold_id(SolidManifold::id);
            if (face->n_vertices() == 4)
              {
                Piece::Face rows;
                for (unsigned int v = 0; v < 4; ++v)
                  rows[v] = face->vertex_index(v);
                auto key = rows;
                std::sort(key.begin(), key.end());
                if (faces.count(key) == 0)
                  faces[key] = middles.on_face(rows);
              }
          }
      }
    triangulation.set_manifold(SolidManifold::id, SolidManifold(piece.line_middles, std::move(faces)));
  }
} // namespace slipstick::mesh
