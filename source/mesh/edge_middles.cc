#include <slipstick/base/cross.h>
#include <slipstick/mesh/edge_middles.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <set>

namespace slipstick::mesh
{
  namespace
  {
    using PlanePiece = MeshPiece<2>;
    using Line       = PlanePiece::Line;
    using Tensor     = dealii::Tensor<1, 2>;

    // The rise of an edge decreases by this part of the height of the cell above it.
    constexpr double decrease_of_rise = 0.3;

    Tensor vertex(const PlanePiece &piece, const PlanePiece::Cell &cell, const unsigned int k)
    {
      return Tensor(piece.vertices[corner<2>(cell, k)]);
    }

    /// Distances of the midpoints of edges from their chords, by edge.
    using Rises = std::map<Line, Tensor>;

    Tensor rise_of(const Rises &rises, const Line &line)
    {
      const auto found = rises.find(line);
      return found != rises.end() ? found->second : Tensor();
    }

    /// Least distance of the other corners of a cell from the chord of its edge @p f.
    double height_above(const PlanePiece &piece, const PlanePiece::Cell &cell, const unsigned int f)
    {
      const Tensor start = vertex(piece, cell, f), along = vertex(piece, cell, f + 1) - start;
      double       height = std::numeric_limits<double>::max();
      for (unsigned int k = f + 2; k < f + n_corners<2>(cell); ++k)
        height = std::min(height, std::abs(cross(along, vertex(piece, cell, k) - start)) / along.norm());
      return height;
    }

    /// Jacobian of a cell with and without rises at @p u, @p v: from corner 0 towards the next and the previous corner.
    std::array<double, 2> jacobians(const PlanePiece       &piece,
                                    const PlanePiece::Cell &cell,
                                    const Rises            &rises,
                                    const double            u,
                                    const double            v)
    {
      const unsigned int n       = n_corners<2>(cell);
      const auto         x       = [&](const unsigned int k) { return vertex(piece, cell, k); };
      const auto         r       = [&](const unsigned int f) { return rise_of(rises, face_of_cell<2>(cell, f)); };
      Tensor             along_u = x(1) - x(0), along_v = x(n - 1) - x(0);
      if (n == 4)
        {
          along_u += v * (x(2) - x(1) - x(3) + x(0));
          along_v += u * (x(2) - x(1) - x(3) + x(0));
        }
      const double straight = cross(along_u, along_v);
      if (n == 4) // rises decrease linearly from an edge to the opposite one
        {
          along_u += 4 * ((1 - 2 * u) * ((1 - v) * r(0) + v * r(2)) + v * (1 - v) * (r(1) - r(3)));
          along_v += 4 * ((1 - 2 * v) * (u * r(1) + (1 - u) * r(3)) + u * (1 - u) * (r(2) - r(0)));
        }
      else // 4 (L0 L1 r0 + L1 L2 r1 + L2 L0 r2), L0 = 1 - u - v, L1 = u, L2 = v
        {
          along_u += 4 * ((1 - 2 * u - v) * r(0) + v * (r(1) - r(2)));
          along_v += 4 * (u * (r(1) - r(0)) + (1 - u - 2 * v) * r(2));
        }
      return {{cross(along_u, along_v), straight}};
    }

    bool keeps_its_shape(const PlanePiece &piece, const PlanePiece::Cell &cell, const Rises &rises)
    {
      const bool is_triangle = is_simplex<2>(cell);
      for (const double u : {0., 0.5, 1.})
        for (const double v : {0., 0.5, 1.})
          if (!(is_triangle && u + v > 1))
            if (const auto [bent, straight] = jacobians(piece, cell, rises, u, v);
                !(bent > 0 && bent >= smallest_jacobian * straight))
              return false;
      return true;
    }

    bool is_bent(const PlanePiece::Cell &cell, const Rises &rises)
    {
      for (unsigned int f = 0; f < n_corners<2>(cell); ++f)
        if (rises.count(face_of_cell<2>(cell, f)) > 0)
          return true;
      return false;
    }

    /// Bends edges inside the body, from the largest rise to smaller ones. An edge of a cell takes the rise of another
    /// one, less a part of the height above that, as far as both run in one direction: rises are second derivatives.
    /// @param fixed edges that keep their rises.
    void spread_rises(const PlanePiece &piece, const std::set<Line> &fixed, Rises &rises)
    {
      std::map<Line, std::vector<unsigned int>>    cells_of;
      std::priority_queue<std::pair<double, Line>> queue;
      for (unsigned int c = 0; c < piece.cells.size(); ++c)
        for (unsigned int f = 0; f < n_corners<2>(piece.cells[c]); ++f)
          cells_of[face_of_cell<2>(piece.cells[c], f)].push_back(c);
      for (const auto &[line, rise] : rises)
        queue.emplace(rise.norm(), line);
      while (!queue.empty())
        {
          const auto [size, source] = queue.top();
          queue.pop();
          const Tensor rise = rises.at(source);
          if (size < rise.norm()) // it has risen since
            continue;
          const Tensor along(piece.vertices[source[1]] - piece.vertices[source[0]]);
          for (const unsigned int c : cells_of.at(source))
            {
              const auto  &cell = piece.cells[c];
              unsigned int f    = 0;
              while (face_of_cell<2>(cell, f) != source)
                ++f;
              const double left = size - decrease_of_rise * height_above(piece, cell, f);
              for (unsigned int k = f + 1; left > 0 && k < f + n_corners<2>(cell); ++k)
                {
                  const Line line = face_of_cell<2>(cell, k % n_corners<2>(cell));
                  if (fixed.count(line) > 0)
                    continue;
                  const Tensor edge(piece.vertices[line[1]] - piece.vertices[line[0]]);
                  const double part  = edge * along / along.norm_square();
                  const Tensor taken = std::min(1., part * part) * left / size * rise;
                  if (taken.norm() <= rise_of(rises, line).norm())
                    continue;
                  rises[line] = taken;
                  queue.emplace(taken.norm(), line);
                }
            }
        }
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

  void bend_edges(MeshPiece<2> &piece)
  {
    const auto line_of = [](const PlanePiece::BoundaryFace &face) {
      return Line{{std::min(face.vertices[0], face.vertices[1]), std::max(face.vertices[0], face.vertices[1])}};
    };
    const auto chord = [&piece](const Line &line) {
      return piece.vertices[line[0]] + 0.5 * (piece.vertices[line[1]] - piece.vertices[line[0]]);
    };
    piece.line_middles.clear();
    std::set<Line> fixed;
    for (const auto &face : piece.boundary_faces)
      fixed.insert(line_of(face));
    Rises rises;
    for (bool is_good = false; !is_good;)
      {
        rises.clear();
        for (const auto &face : piece.boundary_faces)
          if (face.curve && face.bends_cell)
            rises[line_of(face)] = face.curve.point(0.5) - chord(line_of(face));
        if (rises.empty())
          return;
        spread_rises(piece, fixed, rises);
        is_good = true;
        std::set<Line> spoilt;
        for (const auto &cell : piece.cells)
          if (is_bent(cell, rises) && !keeps_its_shape(piece, cell, rises))
            {
              is_good = false;
              for (unsigned int f = 0; f < n_corners<2>(cell); ++f)
                spoilt.insert(face_of_cell<2>(cell, f));
            }
        for (auto &face : piece.boundary_faces)
          if (spoilt.count(line_of(face)) > 0)
            face.bends_cell = false;
        fixed.insert(spoilt.begin(), spoilt.end());
      }
    for (const auto &[line, rise] : rises)
      piece.line_middles[line] = chord(line) + rise;
  }

  std::vector<bool> strongly_bent(const MeshPiece<2> &piece)
  {
    constexpr double  large = 0.1;
    std::vector<bool> result(piece.cells.size(), false);
    for (unsigned int c = 0; !piece.line_middles.empty() && c < piece.cells.size(); ++c)
      for (unsigned int f = 0; f < n_corners<2>(piece.cells[c]); ++f)
        {
          const auto &cell   = piece.cells[c];
          const auto  middle = piece.line_middles.find(face_of_cell<2>(cell, f));
          if (middle == piece.line_middles.end())
            continue;
          const Tensor rise = Tensor(middle->second) - 0.5 * (vertex(piece, cell, f) + vertex(piece, cell, f + 1));
          result[c]         = result[c] || rise.norm() > large * height_above(piece, cell, f);
        }
    return result;
  }

  unsigned int n_unbent(const MeshPiece<2> &piece)
  {
    return std::count_if(piece.boundary_faces.begin(), piece.boundary_faces.end(), [](const auto &face) {
      return face.curve && !face.bends_cell;
    });
  }

  template class EdgeMiddles<2>;
} // namespace slipstick::mesh
