#include <slipstick/mesh/edge_middles.h>
#include <slipstick/mesh/hexahedra_refinement.h>
#include <slipstick/mesh/refinement.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipstick::mesh
{
  namespace
  {
    /// The finer piece while it is built from the coarse one.
    template <int dim>
    class Refiner
    {
    public:
      using Cell = typename MeshPiece<dim>::Cell;
      using Face = typename MeshPiece<dim>::Face;

      explicit Refiner(const MeshPiece<dim> &piece)
        : coarse(bent(piece))
        , boundary(boundary_by_vertices(coarse))
      {
        fine.subdomain = coarse.subdomain;
        fine.body      = coarse.body;
        fine.vertices  = coarse.vertices;
      }

      /// The coarse piece, with bent edges.
      const MeshPiece<dim> &bent_piece() const
      {
        return coarse;
      }

      void add(const Cell &cell)
      {
        fine.cells.push_back(cell);
      }

      /// Records the origin of the cells added since the last call.
      /// @param n_regular number of children if the cell is divided regularly.
      void end_of(const unsigned int parent, const unsigned int n_regular)
      {
        const unsigned int n = fine.cells.size() - origins.size();
        for (unsigned int child = 0; child < n; ++child)
          origins.push_back({parent, child, n == 1 || n == n_regular, n == 1});
      }

      std::vector<CellOrigin> origins; // of the cells added so far

      /// Point @p k of @p n equal parts of the edge from @p a to @p b; repeated calls return the same vertex.
      unsigned int on_edge(const unsigned int a, const unsigned int b, const unsigned int k, const unsigned int n)
      {
        if (k == 0)
          return a;
        if (k == n)
          return b;
        const std::array<unsigned int, 4> key =
          a < b ? std::array<unsigned int, 4>{{a, b, k, n}} : std::array<unsigned int, 4>{{b, a, n - k, n}};
        const auto [found, is_new] = edge_vertices.emplace(key, fine.vertices.size());
        if (is_new)
          fine.vertices.push_back(edge_point(key[0], key[1], double(key[2]) / n));
        return found->second;
      }

      /// New vertex inside a cell, at @p u, @p v in [0, 1] from corner @p first towards the next and the previous one,
      /// on the Coons patch of the edges.
      unsigned int inside(const Cell &cell, const unsigned int first, const double u, const double v)
      {
        const auto c = [&](const unsigned int k) { return corner<dim>(cell, first + k); };
        const auto x = [&](const unsigned int k) { return dealii::Tensor<1, dim>(coarse.vertices[c(k)]); };
        const auto e = [&](const unsigned int a, const unsigned int b, const double s) {
          return dealii::Tensor<1, dim>(c(a) < c(b) ? edge_point(c(a), c(b), s) : edge_point(c(b), c(a), 1 - s));
        };
        fine.vertices.emplace_back((1 - v) * e(0, 1, u) + v * e(3, 2, u) + (1 - u) * e(0, 3, v) + u * e(1, 2, v) -
                                   (1 - u) * (1 - v) * x(0) - u * (1 - v) * x(1) - u * v * x(2) - (1 - u) * v * x(3));
        return fine.vertices.size() - 1;
      }

      unsigned int centroid(const Cell &triangle)
      {
        dealii::Tensor<1, dim> x;
        for (unsigned int k = 0; k < 3; ++k)
          x += coarse.vertices[triangle[k]] / 3;
        fine.vertices.emplace_back(x);
        return fine.vertices.size() - 1;
      }

      /// Divides the boundary faces like their cells.
      MeshPiece<dim> finish()
      {
        std::map<Face, std::vector<std::pair<double, unsigned int>>> points_of; // along the face
        for (const auto &[key, vertex] : edge_vertices)
          points_of[{{key[0], key[1]}}].emplace_back(double(key[2]) / key[3], vertex);
        for (const auto &[face, whole] : boundary)
          {
            auto points = points_of[face];
            std::sort(points.begin(), points.end());
            points.emplace_back(1., face[1]);
            unsigned int last = face[0];
            double       from = 0;
            for (const auto &[s, vertex] : points)
              {
                const auto curve = points.size() == 1 ? whole.curve : whole.curve.part(from, s);
                fine.boundary_faces.push_back({{{last, vertex}}, whole.id, curve, whole.bends_cell});
                last = vertex;
                from = s;
              }
          }
        fine.global_vertices.resize(fine.vertices.size());
        std::iota(fine.global_vertices.begin(), fine.global_vertices.end(), GlobalVertex(0));
        return std::move(fine);
      }

    private:
      static MeshPiece<dim> bent(MeshPiece<dim> piece)
      {
        if constexpr (dim == 2)
          bend_edges(piece);
        return piece;
      }

      /// At @p s in [0, 1] from @p a to @p b, a < b; on the curve of the edge if it has one.
      dealii::Point<dim> edge_point(const unsigned int a, const unsigned int b, const double s) const
      {
        const auto face = boundary.find({{a, b}});
        if (face != boundary.end() && face->second.curve && face->second.bends_cell)
          return face->second.curve.point(s);
        const auto straight = coarse.vertices[a] + s * (coarse.vertices[b] - coarse.vertices[a]);
        const auto middle   = coarse.line_middles.find({{a, b}});
        if (middle == coarse.line_middles.end())
          return straight;
        const auto rise = middle->second - (coarse.vertices[a] + 0.5 * (coarse.vertices[b] - coarse.vertices[a]));
        return straight + 4 * s * (1 - s) * rise;
      }

      const MeshPiece<dim>                                        coarse;   // with bent edges
      const std::map<Face, typename MeshPiece<dim>::BoundaryFace> boundary; // by vertices
      MeshPiece<dim>                                              fine;
      std::map<std::array<unsigned int, 4>, unsigned int>         edge_vertices; // by edge, k, n
    };

    template <int dim>
    void divide_in_quadrilaterals(Refiner<dim> &refiner, const typename MeshPiece<dim>::Cell &cell)
    {
      const unsigned int n      = n_corners<dim>(cell);
      const unsigned int center = n == 3 ? refiner.centroid(cell) : refiner.inside(cell, 0, .5, .5);
      const auto         middle = [&](const unsigned int k) {
        return refiner.on_edge(corner<dim>(cell, k), corner<dim>(cell, k + 1), 1, 2);
      };
      for (unsigned int k = 0; k < n; ++k)
        refiner.add(quadrilateral<dim>(corner<dim>(cell, k), middle(k), center, middle(k + n - 1)));
    }

    template <int dim>
    void divide_in_triangles(Refiner<dim> &refiner, const typename MeshPiece<dim>::Cell &cell)
    {
      std::array<unsigned int, 3> middle;
      for (unsigned int k = 0; k < 3; ++k)
        middle[k] = refiner.on_edge(corner<dim>(cell, k), corner<dim>(cell, k + 1), 1, 2);
      for (unsigned int k = 0; k < 3; ++k)
        refiner.add(triangle<dim>(corner<dim>(cell, k), middle[k], middle[(k + 2) % 3]));
      refiner.add(triangle<dim>(middle[0], middle[1], middle[2]));
    }

    using Lattice  = std::array<unsigned int, 2>; // position on the 3 x 3 division of a cell
    using Template = std::vector<std::array<Lattice, 4>>;

    // Corner 0 at (0, 0), corner 1 at (3, 0), corner 2 at (3, 3). An edge between two marked corners has two points; an
    // edge with one marked end has the point next to it.
    const Template one_corner    = {{{{{0, 0}}, {{1, 0}}, {{1, 1}}, {{0, 1}}}},
                                    {{{{1, 0}}, {{3, 0}}, {{3, 3}}, {{1, 1}}}},
                                    {{{{1, 1}}, {{3, 3}}, {{0, 3}}, {{0, 1}}}}};
    const Template two_adjacent  = {{{{{0, 0}}, {{1, 0}}, {{1, 1}}, {{0, 1}}}},
                                    {{{{1, 0}}, {{2, 0}}, {{2, 1}}, {{1, 1}}}},
                                    {{{{2, 0}}, {{3, 0}}, {{3, 1}}, {{2, 1}}}},
                                    {{{{0, 1}}, {{1, 1}}, {{1, 2}}, {{0, 3}}}},
                                    {{{{1, 1}}, {{2, 1}}, {{2, 2}}, {{1, 2}}}},
                                    {{{{2, 1}}, {{3, 1}}, {{3, 3}}, {{2, 2}}}},
                                    {{{{1, 2}}, {{2, 2}}, {{3, 3}}, {{0, 3}}}}};
    const Template three_corners = {{{{{0, 0}}, {{1, 0}}, {{1, 1}}, {{0, 1}}}},
                                    {{{{1, 0}}, {{2, 0}}, {{2, 1}}, {{1, 1}}}},
                                    {{{{2, 0}}, {{3, 0}}, {{3, 1}}, {{2, 1}}}},
                                    {{{{2, 1}}, {{3, 1}}, {{3, 2}}, {{2, 2}}}},
                                    {{{{2, 2}}, {{3, 2}}, {{3, 3}}, {{2, 3}}}},
                                    {{{{1, 1}}, {{2, 1}}, {{2, 2}}, {{1, 2}}}},
                                    {{{{0, 1}}, {{1, 1}}, {{1, 2}}, {{0, 3}}}},
                                    {{{{1, 2}}, {{2, 2}}, {{2, 3}}, {{0, 3}}}}};

    constexpr unsigned int cells_of_nine = 9;

    // If refining at several boundaries together gives more cells than this factor times that for them one by one, the
    // marks have spread from where the boundaries meet.
    constexpr double spread = 2;

    Template nine_cells()
    {
      Template cells;
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int i = 0; i < 3; ++i)
          cells.push_back({{{{i, j}}, {{i + 1, j}}, {{i + 1, j + 1}}, {{i, j + 1}}}});
      return cells;
    }

    /// Applies a template to a cell, its corner 0 at corner @p first of the cell.
    template <int dim>
    void apply(const Template                      &cells,
               Refiner<dim>                        &refiner,
               const typename MeshPiece<dim>::Cell &cell,
               const unsigned int                   first)
    {
      std::map<Lattice, unsigned int> inner;
      const auto                      c      = [&](const unsigned int k) { return corner<dim>(cell, first + k); };
      const auto                      vertex = [&](const Lattice &at) {
        if (at[1] == 0)
          return refiner.on_edge(c(0), c(1), at[0], 3);
        if (at[0] == 3)
          return refiner.on_edge(c(1), c(2), at[1], 3);
        if (at[1] == 3)
          return refiner.on_edge(c(3), c(2), at[0], 3);
        if (at[0] == 0)
          return refiner.on_edge(c(0), c(3), at[1], 3);
        const auto found = inner.find(at);
        return found != inner.end() ? found->second : inner[at] = refiner.inside(cell, first, at[0] / 3., at[1] / 3.);
      };
      for (const auto &[p, q, r, s] : cells)
        refiner.add(quadrilateral<dim>(vertex(p), vertex(q), vertex(r), vertex(s)));
    }

    template <int dim>
    void divide_by_marks(Refiner<dim>                        &refiner,
                         const typename MeshPiece<dim>::Cell &cell,
                         const std::vector<bool>             &marked)
    {
      std::array<bool, 4> at;
      for (unsigned int k = 0; k < 4; ++k)
        at[k] = marked[corner<dim>(cell, k)];
      const auto n     = std::count(at.begin(), at.end(), true);
      const auto start = [&](const auto &fits) { // first corner from which the marks match the template
        unsigned int k = 0;
        while (!fits(k))
          ++k;
        return k;
      };
      if (n == 0)
        refiner.add(cell);
      else if (n == 1)
        apply(one_corner, refiner, cell, start([&](const unsigned int k) { return at[k]; }));
      else if (n == 3)
        apply(three_corners, refiner, cell, start([&](const unsigned int k) { return !at[(k + 3) % 4]; }));
      else if (n == 4)
        apply(nine_cells(), refiner, cell, 0);
      else if (at[0] == at[2]) // opposite corners: a kite at every corner around the middle
        {
          const unsigned int first  = at[0] ? 0 : 1;
          const unsigned int center = refiner.inside(cell, first, .5, .5);
          const auto         c      = [&](const unsigned int k) { return corner<dim>(cell, first + k); };
          const auto         near   = [&](const unsigned int marked_corner, const unsigned int other) {
            return refiner.on_edge(c(marked_corner), c(other), 1, 3);
          };
          refiner.add(quadrilateral<dim>(c(0), near(0, 1), center, near(0, 3)));
          refiner.add(quadrilateral<dim>(c(1), near(2, 1), center, near(0, 1)));
          refiner.add(quadrilateral<dim>(c(2), near(2, 3), center, near(2, 1)));
          refiner.add(quadrilateral<dim>(c(3), near(0, 3), center, near(2, 3)));
        }
      else
        apply(two_adjacent, refiner, cell, start([&](const unsigned int k) { return at[k] && at[(k + 1) % 4]; }));
    }

    /// Whether each cell has a vertex on the boundaries.
    template <int dim>
    std::vector<bool> touching(const MeshPiece<dim> &piece, const std::set<dealii::types::boundary_id> &ids)
    {
      std::vector<bool> on_boundary(piece.vertices.size(), false), touches(piece.cells.size(), false);
      for (const auto &face : piece.boundary_faces)
        if (ids.count(face.id) > 0)
          for (const unsigned int v : face.vertices)
            if (v != MeshPiece<dim>::no_vertex)
              on_boundary[v] = true;
      for (unsigned int c = 0; c < piece.cells.size(); ++c)
        for (unsigned int k = 0; k < n_corners<dim>(piece.cells[c]); ++k)
          if (on_boundary[piece.cells[c][k]])
            touches[c] = true;
      return touches;
    }

    /// Marks all corners of strongly bent quadrilaterals that have a marked one. @param piece with bent edges.
    void mark_strongly_bent(const MeshPiece<2> &piece, std::vector<bool> &marked)
    {
      const auto bent = strongly_bent(piece);
      for (bool changed = true; changed;)
        {
          changed = false;
          for (unsigned int c = 0; c < piece.cells.size(); ++c)
            if (bent[c])
              {
                const auto n = std::count_if(piece.cells[c].begin(), piece.cells[c].end(), [&](const unsigned int v) {
                  return marked[v];
                });
                if (n == 0 || n == 4)
                  continue;
                for (const unsigned int v : piece.cells[c])
                  marked[v] = true;
                changed = true;
              }
        }
    }

    template <int dim>
    RefinedPiece<dim> triangles_at(const MeshPiece<dim> &piece, std::vector<bool> red)
    {
      Refiner<dim> refiner(piece);
      const auto   bent = strongly_bent(refiner.bent_piece());
      // a triangle with two bisected edges is divided into four; repeat until nothing changes
      std::set<typename MeshPiece<dim>::Face> halved;
      for (bool changed = true; changed;)
        {
          changed = false;
          for (unsigned int c = 0; c < piece.cells.size(); ++c)
            {
              unsigned int n = 0;
              for (unsigned int f = 0; f < 3; ++f)
                n += halved.count(face_of_cell<dim>(piece.cells[c], f));
              if (n < 3 && (red[c] || n == 2 || (n == 1 && bent[c])))
                {
                  red[c] = changed = true;
                  for (unsigned int f = 0; f < 3; ++f)
                    halved.insert(face_of_cell<dim>(piece.cells[c], f));
                }
            }
        }
      for (unsigned int c = 0; c < piece.cells.size(); ++c)
        {
          const auto               &cell = piece.cells[c];
          std::vector<unsigned int> edges;
          for (unsigned int f = 0; f < 3; ++f)
            if (halved.count(face_of_cell<dim>(cell, f)) > 0)
              edges.push_back(f);
          if (edges.empty())
            refiner.add(cell);
          else if (edges.size() == 3)
            divide_in_triangles(refiner, cell);
          else
            {
              const unsigned int f = edges[0], a = corner<dim>(cell, f), b = corner<dim>(cell, f + 1),
                                 opposite = corner<dim>(cell, f + 2), middle = refiner.on_edge(a, b, 1, 2);
              refiner.add(triangle<dim>(a, middle, opposite));
              refiner.add(triangle<dim>(middle, b, opposite));
            }
          refiner.end_of(c, 4);
        }
      auto origins = std::move(refiner.origins);
      return {refiner.finish(), std::move(origins)};
    }
  } // namespace

  template <int dim>
  MeshPiece<dim> refined(const MeshPiece<dim> &piece)
  {
    Refiner<dim> refiner(piece);
    for (const auto &cell : piece.cells)
      if (is_simplex<dim>(cell))
        divide_in_triangles(refiner, cell);
      else
        divide_in_quadrilaterals(refiner, cell);
    return refiner.finish();
  }

  template <int dim>
  MeshPiece<dim> in_quadrilaterals(const MeshPiece<dim> &piece)
  {
    Refiner<dim> refiner(piece);
    for (const auto &cell : piece.cells)
      divide_in_quadrilaterals(refiner, cell);
    return refiner.finish();
  }

  template <int dim>
  RefinedPiece<dim> refined_at(const MeshPiece<dim> &piece, const std::vector<bool> &marked)
  {
    if (is_simplex<dim>(piece.cells.front()))
      return triangles_at(piece, marked);

    std::vector<bool> marked_vertex(piece.vertices.size(), false);
    for (unsigned int c = 0; c < piece.cells.size(); ++c)
      if (marked[c])
        for (const unsigned int v : piece.cells[c])
          marked_vertex[v] = true;
    Refiner<dim> refiner(piece);
    if constexpr (dim == 2)
      mark_strongly_bent(refiner.bent_piece(), marked_vertex);
    for (unsigned int c = 0; c < piece.cells.size(); ++c)
      {
        divide_by_marks(refiner, piece.cells[c], marked_vertex);
        refiner.end_of(c, cells_of_nine);
      }
    auto origins = std::move(refiner.origins);
    return {refiner.finish(), std::move(origins)};
  }

  template <int dim>
  MeshPiece<dim> refined_towards(const MeshPiece<dim> &piece, const std::set<dealii::types::boundary_id> &ids)
  {
    const auto touches = touching(piece, ids);
    if constexpr (dim == 3)
      if (!is_simplex<dim>(piece.cells.front()) && ids.size() > 1)
        {
          std::size_t n = 0;
          for (const auto id : ids)
            n += n_hexahedra_refined_at(piece, touching(piece, {id}));
          if (n_hexahedra_refined_at(piece, touches) > spread * n)
            {
              MeshPiece<dim> finer = piece;
              for (const auto id : ids)
                finer = refined_at(finer, touching(finer, {id})).piece;
              return finer;
            }
        }
    return refined_at(piece, touches).piece;
  }

  template MeshPiece<2>    refined(const MeshPiece<2> &);
  template MeshPiece<2>    in_quadrilaterals(const MeshPiece<2> &);
  template RefinedPiece<2> refined_at(const MeshPiece<2> &, const std::vector<bool> &);
  template MeshPiece<2>    refined_towards(const MeshPiece<2> &, const std::set<dealii::types::boundary_id> &);
  template MeshPiece<3>    refined_towards(const MeshPiece<3> &, const std::set<dealii::types::boundary_id> &);
} // namespace slipstick::mesh
