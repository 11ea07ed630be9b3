#include <slipstick/mesh/hexahedra_refinement.h>
#include <slipstick/mesh/hexahedron_templates.h>
#include <slipstick/mesh/solid_middles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace slipstick::mesh
{
  namespace
  {
    using Piece  = MeshPiece<3>;
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;

    Marks marks_of(const Piece::Cell &cell, const std::vector<bool> &is_marked)
    {
      Marks marks = 0;
      for (unsigned int v = 0; v < cell.size(); ++v)
        marks |= unsigned(is_marked[cell[v]]) << v;
      return marks;
    }

    /// Vertices of the marked cells, and those to be added so that there is a template for each neighbour.
    std::vector<bool> marked_vertices(const Piece &piece, const std::vector<bool> &marked)
    {
      std::vector<bool> is_marked(piece.vertices.size(), false);
      for (std::size_t c = 0; c < piece.cells.size(); ++c)
        if (marked[c])
          for (const unsigned int v : piece.cells[c])
            is_marked[v] = true;
      for (bool has_changed = true; has_changed;)
        {
          has_changed = false;
          for (const auto &cell : piece.cells)
            {
              const Marks before = marks_of(cell, is_marked), after = convex(before);
              for (unsigned int v = 0; v < cell.size() && before != after; ++v)
                if (after >> v & 1)
                  is_marked[cell[v]] = has_changed = true;
            }
        }
      return is_marked;
    }

    class HexahedraRefiner
    {
    public:
      HexahedraRefiner(const Piece &piece_, const std::vector<bool> &marked)
        : piece(piece_)
        , boundary(boundary_by_vertices(piece_))
        , middles(piece, boundary)
        , is_marked(marked_vertices(piece_, marked))
      {
        for (const auto &entry : boundary)
          if (const auto &surface = entry.second.curve;
              surface && surface.kind != FaceSurface::Kind::patch && entry.second.bends_cell)
            for (const unsigned int a : entry.first)
              for (const unsigned int b : entry.first)
                if (a < b && middles.is_curved(a, b))
                  surfaces.emplace(Piece::Line{{a, b}}, &surface);
        finer.subdomain = piece.subdomain;
        finer.body      = piece.body;
        finer.vertices  = piece.vertices;
      }

      RefinedPiece<3> run()
      {
        std::vector<CellOrigin> origins;
        for (unsigned int c = 0; c < piece.cells.size(); ++c)
          {
            const auto &cell  = piece.cells[c];
            const Marks marks = marks_of(cell, is_marked);
            if (marks == 0)
              {
                finer.cells.push_back(cell);
                origins.push_back({c, 0, true, true});
                for (unsigned int f = 0; f < n_faces<3>(cell); ++f)
                  if (const auto found = boundary.find(face_of_cell<3>(cell, f)); found != boundary.end())
                    finer.boundary_faces.push_back(found->second);
                continue;
              }
            const Template &parts = templates_by_marks().at(marks);
            for (unsigned int child = 0; child < parts.size(); ++child)
              {
                add(cell, parts[child]);
                origins.push_back({c, child, marks == all_corners, false});
              }
          }
        for (auto &entry : on_lines)
          std::sort(entry.second.begin(), entry.second.end());
        refine_middles(piece, on_lines, finer);
        finer.global_vertices.resize(finer.vertices.size());
        std::iota(finer.global_vertices.begin(), finer.global_vertices.end(), GlobalVertex(0));
        return {std::move(finer), std::move(origins)};
      }

    private:
      // Bilinear weights of vertices, by which the adjacent cells identify a place.
      using Weights = std::vector<std::pair<unsigned int, unsigned int>>;

      static unsigned int weight(const Place &place, const unsigned int corner)
      {
        unsigned int product = 1;
        for (unsigned int d = 0; d < 3; ++d)
          product *= corner >> d & 1 ? place[d] : n_parts - place[d];
        return product;
      }

      unsigned int vertex_at(const Piece::Cell &cell, const Place &place)
      {
        Weights weights;
        for (unsigned int v = 0; v < cell.size(); ++v)
          if (const unsigned int w = weight(place, v); w > 0)
            weights.emplace_back(cell[v], w);
        if (weights.size() == 1)
          return weights[0].first;
        std::sort(weights.begin(), weights.end());
        const auto [found, is_new] = vertices.emplace(weights, finer.vertices.size());
        if (is_new)
          {
            finer.vertices.push_back(position(cell, place));
            if (weights.size() == 2)
              on_lines[{{weights[0].first, weights[1].first}}].emplace_back(double(weights[1].second) /
                                                                              (weights[0].second + weights[1].second),
                                                                            found->second);
          }
        return found->second;
      }

      void add(const Piece::Cell &cell, const Hexahedron &part)
      {
        Piece::Cell added;
        for (unsigned int v = 0; v < part.size(); ++v)
          added[v] = vertex_at(cell, part[v]);
        finer.cells.push_back(added);
        for (unsigned int f = 0; f < n_faces<3>(cell); ++f)
          {
            const auto found = boundary.find(face_of_cell<3>(cell, f));
            if (found == boundary.end())
              continue;
            const unsigned int d = f / 2, at = f % 2 * n_parts;
            for (unsigned int g = 0; g < n_faces<3>(cell); ++g)
              {
                std::array<unsigned int, 4> corners;
                for (unsigned int v = 0; v < 4; ++v)
                  corners[v] = dealii::GeometryInfo<3>::face_to_cell_vertices(g, v);
                if (std::all_of(corners.begin(), corners.end(), [&](const unsigned int v) { return part[v][d] == at; }))
                  add_face(found->second, cell, part, corners, face_of_cell<3>(added, g));
              }
          }
      }

      /// Adds a part of a boundary face. @param corners of the part of the cell, in lexicographic order.
      void add_face(const Piece::BoundaryFace         &whole,
                    const Piece::Cell                 &cell,
                    const Hexahedron                  &part,
                    const std::array<unsigned int, 4> &corners,
                    const Piece::Face                 &face)
      {
        FaceSurface surface = whole.curve;
        double      size    = 0;
        for (const auto &[a, b] : {std::pair(0, 1), {1, 3}, {3, 2}, {2, 0}})
          size = std::max(size, (vector_of(part[corners[a]]) - vector_of(part[corners[b]])).norm() / n_parts);
        if (surface.kind != FaceSurface::Kind::patch)
          surface.neglected_sagitta *= size * size;
        else
          surface = part_of(surface,
                            {place_on(surface, cell, part[corners[0]]),
                             place_on(surface, cell, part[corners[1]]),
                             place_on(surface, cell, part[corners[3]]),
                             place_on(surface, cell, part[corners[2]])});
        finer.boundary_faces.push_back({face, whole.id, surface, whole.bends_cell});
      }

      /// Local coordinates, in a patch over a face of a cell, of a place on that face.
      FaceSurface::Place place_on(const FaceSurface &patch, const Piece::Cell &cell, const Place &place) const
      {
        FaceSurface::Place result;
        for (unsigned int v = 0; v < cell.size(); ++v)
          if (const unsigned int w = weight(place, v); w > 0)
            {
              const Point &x    = piece.vertices[cell[v]];
              const auto   last = patch.points.begin() + patch.n_corners();
              const auto   near = std::min_element(patch.points.begin(), last, [&](const Point &a, const Point &b) {
                return a.distance(x) < b.distance(x);
              });
              result += double(w) / (n_parts * n_parts * n_parts) *
                        dealii::Tensor<1, 2>(FacetShapes::node(patch.n_corners(), near - patch.points.begin()));
            }
        return result;
      }

      /// Position on the curved boundary or, inside, on Coons patches.
      Point position(const Piece::Cell &cell, const Place &place) const
      {
        if (!piece.line_middles.empty() && middles.is_curved(cell))
          return in_cell(cell, place);
        const Point &from = piece.vertices[cell[0]];
        Tensor       sum;
        for (unsigned int v = 0; v < cell.size(); ++v)
          if (const unsigned int w = weight(place, v); w > 0)
            sum += double(w) / (n_parts * n_parts * n_parts) * (piece.vertices[cell[v]] - from);
        return from + sum;
      }

      Point in_cell(const Piece::Cell &cell, const Place &place) const
      {
        std::vector<unsigned int> inside; // directions in which the place is not at an end
        for (unsigned int d = 0; d < 3; ++d)
          if (place[d] % n_parts != 0)
            inside.push_back(d);
        if (inside.empty())
          return piece.vertices[cell[place[0] / n_parts + 2 * (place[1] / n_parts) + 4 * (place[2] / n_parts)]];
        if (inside.size() == 1)
          return on_line(cell, place, inside[0]);
        // transfinite interpolation: alternating sum of interpolations along some of the directions
        Point result;
        for (unsigned int along = 1; along < (1u << inside.size()); ++along)
          {
            unsigned int n = 0;
            for (unsigned int k = 0; k < inside.size(); ++k)
              n += along >> k & 1;
            for (unsigned int ends = 0; ends < (1u << inside.size()); ++ends)
              if ((ends | along) == along)
                {
                  Place  at    = place;
                  double share = n % 2 == 1 ? 1 : -1;
                  for (unsigned int k = 0; k < inside.size(); ++k)
                    if (along >> k & 1)
                      {
                        const double s = double(place[inside[k]]) / n_parts;
                        at[inside[k]]  = ends >> k & 1 ? n_parts : 0;
                        share *= ends >> k & 1 ? s : 1 - s;
                      }
                  result += share * Tensor(in_cell(cell, at));
                }
          }
        return inside.size() == 2 ? on_surface(cell, place, result) : result;
      }

      /// Position on an edge: on a parabola, on a ball or cylinder, or straight.
      Point on_line(const Piece::Cell &cell, const Place &place, const unsigned int along) const
      {
        unsigned int first = 0;
        for (unsigned int d = 0; d < 3; ++d)
          first |= (d != along && place[d] > 0 ? 1u : 0u) << d;
        const unsigned int a = cell[first], b = cell[first | 1u << along];
        const double       s = double(place[along]) / n_parts;
        if (!middles.is_curved(a, b))
          return piece.vertices[a] + s * (piece.vertices[b] - piece.vertices[a]);
        const Point parabola = on_parabola(piece.vertices[a], middles.on_line(a, b), piece.vertices[b], s);
        const auto  found    = surfaces.find({{std::min(a, b), std::max(a, b)}});
        return found != surfaces.end() ? found->second->nearest(parabola) : parabola;
      }

      /// Moves a point on a face of a cell to the curved boundary.
      Point on_surface(const Piece::Cell &cell, const Place &place, const Point &x) const
      {
        unsigned int f = 0;
        while (place[f / 2] != f % 2 * n_parts)
          ++f;
        const auto found = boundary.find(face_of_cell<3>(cell, f));
        if (found == boundary.end() || !found->second.curve || !found->second.bends_cell)
          return x;
        const FaceSurface &surface = found->second.curve;
        return surface.kind == FaceSurface::Kind::patch ? surface.point(place_on(surface, cell, place))
                                                        : surface.nearest(x);
      }

      const Piece                                     &piece;
      const std::map<Piece::Face, Piece::BoundaryFace> boundary;
      const SolidMiddles                               middles;
      std::map<Piece::Line, const FaceSurface *>       surfaces; // balls and cylinders, by curved edge
      const std::vector<bool>                          is_marked;
      Piece                                            finer;
      std::map<Weights, unsigned int>                  vertices;
      VerticesOnLines                                  on_lines;
    };
  } // namespace

  std::size_t n_hexahedra_refined_at(const MeshPiece<3> &piece, const std::vector<bool> &marked)
  {
    const auto  is_marked = marked_vertices(piece, marked);
    std::size_t n         = 0;
    for (const auto &cell : piece.cells)
      {
        const Marks marks = marks_of(cell, is_marked);
        n += marks == 0 ? 1 : templates_by_marks().at(marks).size();
      }
    return n;
  }

  RefinedPiece<3> hexahedra_refined_at(const MeshPiece<3> &piece, const std::vector<bool> &marked)
  {
    return HexahedraRefiner(piece, marked).run();
  }
} // namespace slipstick::mesh
