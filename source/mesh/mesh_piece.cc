#include <slipstick/base/disjoint_sets.h>
#include <slipstick/mesh/mesh_piece.h>

namespace slipstick::mesh
{
  namespace
  {
    std::vector<MeshPiece<3>::Line> lines_of(const MeshPiece<3>::Cell &cell)
    {
      return lines_of_cell(cell);
    }

    std::vector<MeshPiece<2>::Line> lines_of(const MeshPiece<2>::Cell &cell)
    {
      std::vector<MeshPiece<2>::Line> lines;
      for (unsigned int f = 0; f < n_corners<2>(cell); ++f)
        lines.push_back(face_of_cell<2>(cell, f));
      return lines;
    }

    /// Sub-piece of the given cells.
    template <int dim>
    MeshPiece<dim> extract(
      const MeshPiece<dim>                                                                 &whole,
      const std::vector<unsigned int>                                                      &cells,
      const std::map<typename MeshPiece<dim>::Face, typename MeshPiece<dim>::BoundaryFace> &boundary)
    {
      MeshPiece<dim>                       piece;
      std::map<unsigned int, unsigned int> local;
      piece.body    = whole.body;
      piece.ordered = whole.ordered;
      for (const unsigned int c : cells)
        {
          auto cell = whole.cells[c];
          for (unsigned int f = 0; f < n_faces<dim>(cell); ++f)
            {
              const auto found = boundary.find(face_of_cell<dim>(cell, f));
              if (found != boundary.end())
                piece.boundary_faces.push_back(found->second);
            }
          for (unsigned int k = 0; k < n_corners<dim>(cell); ++k)
            {
              unsigned int &v            = cell[k];
              const auto [entry, is_new] = local.emplace(v, piece.vertices.size());
              if (is_new)
                {
                  piece.vertices.push_back(whole.vertices[v]);
                  piece.global_vertices.push_back(whole.global_vertices[v]);
                }
              v = entry->second;
            }
          if (!whole.line_middles.empty())
            for (const auto &[a, b] : lines_of(whole.cells[c]))
              if (const auto found = whole.line_middles.find({{a, b}}); found != whole.line_middles.end())
                {
                  const auto ends                                 = std::minmax(local.at(a), local.at(b));
                  piece.line_middles[{{ends.first, ends.second}}] = found->second;
                }
          piece.cells.push_back(cell);
        }
      for (auto &face : piece.boundary_faces)
        for (unsigned int &v : face.vertices)
          if (v != MeshPiece<dim>::no_vertex)
            v = local.at(v);
      return piece;
    }
  } // namespace

  template <int dim>
  std::vector<std::pair<typename MeshPiece<dim>::Face, unsigned int>> faces_with_cells(const MeshPiece<dim> &piece)
  {
    std::vector<std::pair<typename MeshPiece<dim>::Face, unsigned int>> faces;
    faces.reserve(piece.cells.size() * dealii::GeometryInfo<dim>::faces_per_cell);
    for (unsigned int c = 0; c < piece.cells.size(); ++c)
      for (unsigned int f = 0; f < n_faces<dim>(piece.cells[c]); ++f)
        faces.emplace_back(face_of_cell<dim>(piece.cells[c], f), c);
    std::sort(faces.begin(), faces.end());
    return faces;
  }

  template <int dim>
  std::map<typename MeshPiece<dim>::Face, dealii::types::boundary_id> ids_of_faces(const MeshPiece<dim> &piece)
  {
    std::map<typename MeshPiece<dim>::Face, dealii::types::boundary_id> ids;
    for (const auto &face : piece.boundary_faces)
      {
        auto key = face.vertices;
        std::sort(key.begin(), key.end());
        ids[key] = face.id;
      }
    return ids;
  }

  template <int dim>
  std::map<typename MeshPiece<dim>::Face, typename MeshPiece<dim>::BoundaryFace> boundary_by_vertices(
    const MeshPiece<dim> &piece)
  {
    std::map<typename MeshPiece<dim>::Face, typename MeshPiece<dim>::BoundaryFace> faces;
    for (auto face : piece.boundary_faces)
      {
        if constexpr (dim == 3)
          std::sort(face.vertices.begin(), face.vertices.end());
        else if (face.vertices[0] > face.vertices[1])
          {
            std::swap(face.vertices[0], face.vertices[1]);
            face.curve = face.curve.reversed();
          }
        faces[face.vertices] = face;
      }
    return faces;
  }

  template <int dim>
  MeshPiece<dim> rectangle_piece(const scene::Body<dim>              &body,
                                 const std::array<unsigned int, dim> &n_cells,
                                 const std::array<unsigned int, dim> &n_blocks,
                                 const std::array<unsigned int, dim> &block)
  {
    std::array<unsigned int, dim> first, n, stride; // lattice cells of this block; from a vertex to the next
    unsigned int                  n_vertices = 1, n_own_cells = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        n[d]      = n_cells[d] / n_blocks[d];
        first[d]  = block[d] * n[d];
        stride[d] = n_vertices;
        n_vertices *= n[d] + 1;
        n_own_cells *= n[d];
      }
    MeshPiece<dim> piece;
    piece.ordered       = true;
    const auto place_of = [](unsigned int                         i,
                             const std::array<unsigned int, dim> &size) { // the first direction runs fastest
      std::array<unsigned int, dim> at;
      for (unsigned int d = 0; d < dim; ++d)
        {
          at[d] = i % size[d];
          i /= size[d];
        }
      return at;
    };
    auto n_points = n;
    for (unsigned int &k : n_points)
      ++k;
    for (unsigned int i = 0; i < n_vertices; ++i)
      {
        // computed from the lattice of the whole body, so that copies of a vertex have bitwise the same coordinates
        const auto         own = place_of(i, n_points);
        dealii::Point<dim> x;
        GlobalVertex       number = 0;
        for (unsigned int d = dim; d-- > 0;)
          {
            x[d]   = body.origin[d] + body.size[d] * (first[d] + own[d]) / n_cells[d];
            number = number * (n_cells[d] + 1) + first[d] + own[d];
          }
        piece.vertices.push_back(x);
        piece.global_vertices.push_back(number);
      }
    const auto vertex = [&](const std::array<unsigned int, dim> &cell, const unsigned int corner) {
      unsigned int v = 0;
      for (unsigned int d = 0; d < dim; ++d)
        v += (cell[d] + (corner >> d & 1)) * stride[d];
      return v;
    };
    for (unsigned int c = 0; c < n_own_cells; ++c)
      {
        const auto                    at = place_of(c, n);
        typename MeshPiece<dim>::Cell cell;
        for (unsigned int v = 0; v < cell.size(); ++v)
          cell[v] = vertex(at, v);
        piece.cells.push_back(cell);
      }
    // faces 2 d and 2 d + 1 are at the ends of direction d
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int c = 0; c < n_own_cells; ++c)
        if (auto at = place_of(c, n); at[d] == 0)
          for (const unsigned int end : {0, 1})
            if (block[d] + 1 == (end == 0 ? 1 : n_blocks[d]))
              {
                at[d] = end == 0 ? 0 : n[d] - 1;
                typename MeshPiece<dim>::Face face;
                for (unsigned int v = 0; v < face.size(); ++v)
                  face[v] = vertex(at, dealii::GeometryInfo<dim>::face_to_cell_vertices(2 * d + end, v));
                piece.boundary_faces.push_back({face, 2 * d + end});
              }
    return piece;
  }

  template <int dim>
  void place(MeshPiece<dim> &piece, const scene::Placement<dim> &placement)
  {
    const auto move = placement.motion();
    for (auto &x : piece.vertices)
      move(x);
    for (auto &face : piece.boundary_faces)
      face.curve.move(move);
    for (auto &entry : piece.line_middles)
      move(entry.second);
    if (placement.mirror_x != placement.mirror_y)
      for (auto &cell : piece.cells)
        {
          if (dim == 2)
            std::swap(cell[1], cell[2]); // of a quadrilateral in lexicographic order, and of a triangle
          for (unsigned int v = 0; dim == 3 && v < (is_simplex<dim>(cell) ? 2 : cell.size()); v += 2)
            std::swap(cell[v], cell[v + 1]);
        }
  }

  template <int dim>
  std::vector<MeshPiece<dim>> cut(const MeshPiece<dim> &whole, const std::vector<unsigned int> &part)
  {
    const unsigned int n_cells = whole.cells.size();
    AssertDimension(part.size(), n_cells);

    DisjointSets connected(n_cells); // by faces between cells of the same part
    const auto   faces = faces_with_cells(whole);
    for (std::size_t k = 1; k < faces.size(); ++k)
      if (faces[k].first == faces[k - 1].first && part[faces[k].second] == part[faces[k - 1].second])
        connected.join(faces[k].second, faces[k - 1].second);

    const auto                                                                 boundary = boundary_by_vertices(whole);
    std::map<std::pair<unsigned int, unsigned int>, std::vector<unsigned int>> cells_of_piece; // by part and root
    for (unsigned int c = 0; c < n_cells; ++c)
      cells_of_piece[{part[c], connected.root(c)}].push_back(c);
    std::vector<MeshPiece<dim>> pieces;
    for (const auto &[key, cells] : cells_of_piece)
      pieces.push_back(extract<dim>(whole, cells, boundary));
    return pieces;
  }

  template struct MeshPiece<2>;
  template std::vector<std::pair<MeshPiece<2>::Face, unsigned int>> faces_with_cells(const MeshPiece<2> &);
  template std::map<MeshPiece<2>::Face, dealii::types::boundary_id> ids_of_faces(const MeshPiece<2> &);
  template std::map<MeshPiece<2>::Face, MeshPiece<2>::BoundaryFace> boundary_by_vertices(const MeshPiece<2> &);
  template MeshPiece<2>                                             rectangle_piece<2>(const scene::Body<2> &,
                                           const std::array<unsigned int, 2> &,
                                           const std::array<unsigned int, 2> &,
                                           const std::array<unsigned int, 2> &);
  template void                                                     place(MeshPiece<2> &, const scene::Placement<2> &);
  template std::vector<MeshPiece<2>> cut(const MeshPiece<2> &, const std::vector<unsigned int> &);
  template struct MeshPiece<3>;
  template std::vector<std::pair<MeshPiece<3>::Face, unsigned int>> faces_with_cells(const MeshPiece<3> &);
  template std::map<MeshPiece<3>::Face, dealii::types::boundary_id> ids_of_faces(const MeshPiece<3> &);
  template std::map<MeshPiece<3>::Face, MeshPiece<3>::BoundaryFace> boundary_by_vertices(const MeshPiece<3> &);
  template MeshPiece<3>                                             rectangle_piece<3>(const scene::Body<3> &,
                                           const std::array<unsigned int, 3> &,
                                           const std::array<unsigned int, 3> &,
                                           const std::array<unsigned int, 3> &);
  template void                                                     place(MeshPiece<3> &, const scene::Placement<3> &);
  template std::vector<MeshPiece<3>> cut(const MeshPiece<3> &, const std::vector<unsigned int> &);
} // namespace slipstick::mesh
