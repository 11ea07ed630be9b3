#include <slipstick/mesh/hexahedra_refinement.h>
#include <slipstick/mesh/refinement.h>
#include <slipstick/mesh/solid_middles.h>

#include <numeric>
#include <optional>
#include <set>

namespace slipstick::mesh
{
  namespace
  {
    using Piece = MeshPiece<3>;

    using Line = Piece::Line;

    Line line_of(const unsigned int a, const unsigned int b)
    {
      return {{std::min(a, b), std::max(a, b)}};
    }

    /// Edges to be halved such that every tetrahedron has zero, one, the three of a face, or all six of them: those of
    /// marked cells, and those that follow from this rule.
    std::set<Line> halved_lines(const Piece &piece, std::vector<bool> red)
    {
      std::set<Line> halved;
      for (bool has_changed = true; has_changed;)
        {
          has_changed    = false;
          const auto add = [&](const Line &line) { has_changed = halved.insert(line).second || has_changed; };
          for (unsigned int c = 0; c < piece.cells.size(); ++c)
            {
              const auto lines = lines_of_cell(piece.cells[c]);
              const auto n =
                std::count_if(lines.begin(), lines.end(), [&](const Line &l) { return halved.count(l) > 0; });
              // edges on one face do not contain the fourth corner
              std::optional<Piece::Face> face;
              for (unsigned int f = 0; f < 4; ++f)
                {
                  const unsigned int apart = piece.cells[c][f];
                  if (std::none_of(lines.begin(), lines.end(), [&](const Line &l) {
                        return halved.count(l) > 0 && (l[0] == apart || l[1] == apart);
                      }))
                    face = face_of_cell<3>(piece.cells[c], f);
                }
              if (red[c] || n > 3 || (n > 1 && !face))
                for (const Line &line : lines)
                  add(line);
              else if (n > 1)
                for (const auto &[k, l] : {std::pair(0, 1), {0, 2}, {1, 2}})
                  add(line_of((*face)[k], (*face)[l]));
            }
        }
      return halved;
    }

    /// Divides the cells of a piece by eight, all or those given by @p halved; tetrahedra then also by two or four (red
    /// and green).
    class SolidRefiner
    {
    public:
      explicit SolidRefiner(const Piece &piece_, std::optional<std::set<Line>> halved_ = {})
        : piece(piece_)
        , halved(std::move(halved_))
        , boundary(boundary_by_vertices(piece_))
        , curved(piece, boundary)
      {
        finer.subdomain = piece.subdomain;
        finer.body      = piece.body;
        finer.ordered   = piece.ordered;
        finer.vertices  = piece.vertices;
      }

      RefinedPiece<3> run()
      {
        std::vector<CellOrigin> origins;
        for (unsigned int c = 0; c < piece.cells.size(); ++c)
          {
            const auto &cell = piece.cells[c];
            !is_simplex<3>(cell) ? divide_hexahedron(cell) : halved ? divide_halved(cell) : divide_tetrahedron(cell);
            const unsigned int n = finer.cells.size() - origins.size();
            for (unsigned int child = 0; child < n; ++child)
              origins.push_back({c, child, n == 1 || n == 8, n == 1});
          }
        VerticesOnLines dividing;
        for (const auto &entry : piece.line_middles)
          if (const auto found = middles.find({entry.first[0], entry.first[1]}); found != middles.end())
            dividing[entry.first] = {{0.5, found->second}};
        refine_middles(piece, dividing, finer);
        finer.global_vertices.resize(finer.vertices.size());
        std::iota(finer.global_vertices.begin(), finer.global_vertices.end(), GlobalVertex(0));
        return {std::move(finer), std::move(origins)};
      }

    private:
      /// Midpoint of an edge, of a face (vertices in lexicographic order), or of the cell.
      dealii::Point<3> place_of(const Piece::Cell &cell, const std::vector<unsigned int> &of) const
      {
        if (of.size() == 8)
          return curved.in_hexahedron(cell);
        return of.size() == 4 ? curved.on_face({{of[0], of[1], of[2], of[3]}}) : curved.on_line(of[0], of[1]);
      }

      /// The vertex at the midpoint of others.
      unsigned int middle(const Piece::Cell &cell, std::vector<unsigned int> of)
      {
        if (of.size() == 1)
          return of[0];
        const auto rows = of;
        std::sort(of.begin(), of.end());
        const auto [found, is_new] = middles.emplace(of, finer.vertices.size());
        if (is_new && !piece.line_middles.empty() && curved.is_curved(cell))
          finer.vertices.push_back(place_of(cell, rows));
        else if (is_new)
          {
            dealii::Tensor<1, 3> sum;
            for (const unsigned int v : of)
              sum += piece.vertices[v] - piece.vertices[of[0]];
            finer.vertices.push_back(piece.vertices[of[0]] + sum / double(of.size()));
          }
        return found->second;
      }

      /// Vertex @p i of a lattice with three vertices per direction: its corners and the midpoints.
      unsigned int lattice_vertex(const Piece::Cell &cell, const std::array<unsigned int, 3> &i)
      {
        std::vector<unsigned int> of;
        for (unsigned int v = 0; v < cell.size(); ++v)
          {
            bool is_near = true;
            for (unsigned int d = 0; d < 3; ++d)
              is_near = is_near && (i[d] == 1 || i[d] == 2 * (v >> d & 1));
            if (is_near)
              of.push_back(cell[v]);
          }
        return middle(cell, std::move(of));
      }

      void divide_hexahedron(const Piece::Cell &cell)
      {
        for (unsigned int child = 0; child < 8; ++child)
          {
            Piece::Cell part;
            for (unsigned int v = 0; v < 8; ++v)
              part[v] = lattice_vertex(
                cell,
                {{(child & 1) + (v & 1), (child >> 1 & 1) + (v >> 1 & 1), (child >> 2 & 1) + (v >> 2 & 1)}});
            for (unsigned int f = 0; f < 6; ++f)
              if (const auto found = boundary.find(face_of_cell<3>(cell, f));
                  found != boundary.end() && (child >> (f / 2) & 1) == f % 2)
                add_face(found->second, face_of_cell<3>(part, f));
            finer.cells.push_back(part);
          }
      }

      /// Adds a quarter of a boundary face.
      void add_face(const Piece::BoundaryFace &whole, const Piece::Face &face)
      {
        finer.boundary_faces.push_back({face, whole.id, part_of(whole, face, finer), whole.bends_cell});
      }

      void add_tetrahedron(unsigned int a, unsigned int b, const unsigned int c, const unsigned int d)
      {
        const auto &x = finer.vertices;
        if (cross_product_3d(x[b] - x[a], x[c] - x[a]) * (x[d] - x[a]) < 0)
          std::swap(a, b);
        Piece::Cell cell;
        cell.fill(Piece::no_vertex);
        cell[0] = a;
        cell[1] = b;
        cell[2] = c;
        cell[3] = d;
        finer.cells.push_back(cell);
      }

      // Four tetrahedra at the corners, and an octahedron divided along its shortest diagonal.
      void divide_tetrahedron(const Piece::Cell &cell)
      {
        const auto m = [&](const unsigned int i, const unsigned int j) { return middle(cell, {cell[i], cell[j]}); };
        for (unsigned int i = 0; i < 4; ++i)
          add_tetrahedron(cell[i], m(i, (i + 1) % 4), m(i, (i + 2) % 4), m(i, (i + 3) % 4));
        const std::array<std::array<unsigned int, 2>, 3> across = {
          {{{m(0, 1), m(2, 3)}}, {{m(0, 2), m(1, 3)}}, {{m(0, 3), m(1, 2)}}}};
        const auto length = [&](const unsigned int k) {
          return finer.vertices[across[k][0]].distance(finer.vertices[across[k][1]]);
        };
        unsigned int shortest = 0;
        for (const unsigned int k : {1, 2})
          if (length(k) < length(shortest))
            shortest = k;
        const auto &axis = across[shortest], &r = across[(shortest + 1) % 3], &s = across[(shortest + 2) % 3];
        for (const unsigned int i : {0, 1})
          for (const unsigned int j : {0, 1})
            add_tetrahedron(axis[0], axis[1], r[i], s[j]);
        for (unsigned int f = 0; f < 4; ++f)
          if (const auto found = boundary.find(face_of_cell<3>(cell, f)); found != boundary.end())
            {
              const std::array<unsigned int, 3> at = {{(f + 1) % 4, (f + 2) % 4, (f + 3) % 4}};
              const auto add = [&](const unsigned int a, const unsigned int b, const unsigned int c) {
                Piece::Face face = {{a, b, c, Piece::no_vertex}};
                std::sort(face.begin(), face.end());
                add_face(found->second, face);
              };
              for (unsigned int k = 0; k < 3; ++k)
                add(cell[at[k]], m(at[k], at[(k + 1) % 3]), m(at[k], at[(k + 2) % 3]));
              add(m(at[0], at[1]), m(at[1], at[2]), m(at[2], at[0]));
            }
      }

      bool is_halved(const unsigned int a, const unsigned int b) const
      {
        return halved->count(line_of(a, b)) > 0;
      }

      /// Triangles into which a face with halved edges is divided: none, one, or three of them.
      std::vector<std::array<unsigned int, 3>> parts_of_face(const Piece::Cell &cell, const Piece::Face &face)
      {
        const auto &[a, b, c, none] = face;
        const auto                m = [&](const unsigned int v, const unsigned int w) { return middle(cell, {v, w}); };
        const std::array<Line, 3> edges      = {{{{a, b}}, {{b, c}}, {{c, a}}}};
        const std::array<unsigned, 3> across = {{c, a, b}};
        if (is_halved(a, b) && is_halved(b, c) && is_halved(c, a))
          return {{{a, m(a, b), m(c, a)}},
                  {{b, m(b, c), m(a, b)}},
                  {{c, m(c, a), m(b, c)}},
                  {{m(a, b), m(b, c), m(c, a)}}};
        for (unsigned int k = 0; k < 3; ++k)
          if (const auto &[v, w] = edges[k]; is_halved(v, w))
            return {{{v, m(v, w), across[k]}}, {{m(v, w), w, across[k]}}};
        return {{{a, b, c}}};
      }

      // Halved edges: none, one, those of one face, or all.
      void divide_halved(const Piece::Cell &cell)
      {
        unsigned int n = 0;
        for (const auto &[a, b] : lines_of_cell(cell))
          n += is_halved(a, b);
        if (n == 6)
          return divide_tetrahedron(cell);
        // the face with most halved edges
        std::size_t  most = 0;
        unsigned int base = 0;
        for (unsigned int f = 0; f < 4; ++f)
          if (const auto parts = parts_of_face(cell, face_of_cell<3>(cell, f)); parts.size() > most)
            {
              most = parts.size();
              base = f;
            }
        for (const auto &[a, b, c] : parts_of_face(cell, face_of_cell<3>(cell, base)))
          add_tetrahedron(a, b, c, cell[base]);
        for (unsigned int f = 0; f < 4; ++f)
          if (const auto found = boundary.find(face_of_cell<3>(cell, f)); found != boundary.end())
            {
              const auto parts = parts_of_face(cell, found->first);
              for (const auto &[a, b, c] : parts)
                {
                  Piece::Face face = {{a, b, c, Piece::no_vertex}};
                  std::sort(face.begin(), face.end());
                  if (parts.size() == 1)
                    finer.boundary_faces.push_back(found->second);
                  else
                    add_face(found->second, face);
                }
            }
      }

      const Piece                                      &piece;
      const std::optional<std::set<Line>>               halved;
      const std::map<Piece::Face, Piece::BoundaryFace>  boundary;
      const SolidMiddles                                curved;
      Piece                                             finer;
      std::map<std::vector<unsigned int>, unsigned int> middles; // by the vertices between which they lie
    };
  } // namespace

  template <>
  MeshPiece<3> refined(const MeshPiece<3> &piece)
  {
    return SolidRefiner(piece).run().piece;
  }

  template <>
  RefinedPiece<3> refined_at(const MeshPiece<3> &piece, const std::vector<bool> &marked)
  {
    return is_simplex<3>(piece.cells.front()) ? SolidRefiner(piece, halved_lines(piece, marked)).run()
                                              : hexahedra_refined_at(piece, marked);
  }
} // namespace slipstick::mesh
