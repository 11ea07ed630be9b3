#include <slipstick/base/exceptions.h>
#include <slipstick/fem/mesh_piece.h>

#include <deal.II/grid/grid_tools.h>
#include <deal.II/lac/sparsity_tools.h>

#include <numeric>
#include <set>

namespace slipstick::fem
{
  namespace
  {
    template <int dim>
    using Face = std::array<unsigned int, MeshPiece<dim>::vertices_per_face>;

    template <int dim>
    Face<dim> face_of_cell(const std::array<unsigned int, MeshPiece<dim>::vertices_per_cell> &cell,
                           const unsigned int                                                 f)
    {
      Face<dim> face;
      for (unsigned int v = 0; v < face.size(); ++v)
        face[v] = cell[dealii::GeometryInfo<dim>::face_to_cell_vertices(f, v)];
      std::sort(face.begin(), face.end());
      return face;
    }

    /// Cells behind every face (one at the boundary, two inside).
    template <int dim>
    std::vector<std::pair<Face<dim>, unsigned int>> faces_with_cells(const MeshPiece<dim> &piece)
    {
      std::vector<std::pair<Face<dim>, unsigned int>> faces;
      faces.reserve(piece.cells.size() * dealii::GeometryInfo<dim>::faces_per_cell);
      for (unsigned int c = 0; c < piece.cells.size(); ++c)
        for (unsigned int f = 0; f < dealii::GeometryInfo<dim>::faces_per_cell; ++f)
          faces.emplace_back(face_of_cell<dim>(piece.cells[c], f), c);
      std::sort(faces.begin(), faces.end());
      return faces;
    }

    /// Sub-piece of the given cells.
    template <int dim>
    MeshPiece<dim> extract(const MeshPiece<dim>                                  &whole,
                           const std::vector<unsigned int>                       &cells,
                           const std::map<Face<dim>, dealii::types::boundary_id> &boundary)
    {
      MeshPiece<dim>                       piece;
      std::map<unsigned int, unsigned int> local;
      piece.body = whole.body;
      for (const unsigned int c : cells)
        {
          auto cell = whole.cells[c];
          for (unsigned int f = 0; f < dealii::GeometryInfo<dim>::faces_per_cell; ++f)
            {
              const auto found = boundary.find(face_of_cell<dim>(cell, f));
              if (found != boundary.end())
                piece.boundary_faces.push_back({found->first, found->second});
            }
          for (unsigned int &v : cell)
            {
              const auto [entry, is_new] = local.emplace(v, piece.vertices.size());
              if (is_new)
                {
                  piece.vertices.push_back(whole.vertices[v]);
                  piece.global_vertices.push_back(whole.global_vertices[v]);
                }
              v = entry->second;
            }
          piece.cells.push_back(cell);
        }
      for (auto &face : piece.boundary_faces)
        for (unsigned int &v : face.vertices)
          v = local.at(v);
      return piece;
    }
  } // namespace

  template <int dim>
  MeshPiece<dim> rectangle_piece(const scene::Body<dim>              &body,
                                 const std::array<unsigned int, dim> &n_cells,
                                 const std::array<unsigned int, dim> &n_blocks,
                                 const std::array<unsigned int, dim> &block)
  {
    static_assert(dim == 2, "the lattice below is written for two dimensions");
    std::array<unsigned int, dim> first, n; // lattice cells of this block
    for (unsigned int d = 0; d < dim; ++d)
      {
        n[d]     = n_cells[d] / n_blocks[d];
        first[d] = block[d] * n[d];
      }
    MeshPiece<dim> piece;
    const auto     vertex = [&](const unsigned int i, const unsigned int j) { return j * (n[0] + 1) + i; };
    for (unsigned int j = 0; j <= n[1]; ++j)
      for (unsigned int i = 0; i <= n[0]; ++i)
        {
          // from the lattice of the whole body, so that copies of a vertex have the same coordinates to the last bit
          const std::array<unsigned int, dim> lattice{{first[0] + i, first[1] + j}};
          dealii::Point<dim>                  x;
          for (unsigned int d = 0; d < dim; ++d)
            x[d] = body.origin[d] + body.size[d] * lattice[d] / n_cells[d];
          piece.vertices.push_back(x);
          piece.global_vertices.push_back(GlobalVertex(lattice[1]) * (n_cells[0] + 1) + lattice[0]);
        }
    for (unsigned int j = 0; j < n[1]; ++j)
      for (unsigned int i = 0; i < n[0]; ++i)
        piece.cells.push_back({{vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1)}});
    for (unsigned int j = 0; j < n[1]; ++j)
      {
        if (block[0] == 0)
          piece.boundary_faces.push_back({{{vertex(0, j), vertex(0, j + 1)}}, 0});
        if (block[0] + 1 == n_blocks[0])
          piece.boundary_faces.push_back({{{vertex(n[0], j), vertex(n[0], j + 1)}}, 1});
      }
    for (unsigned int i = 0; i < n[0]; ++i)
      {
        if (block[1] == 0)
          piece.boundary_faces.push_back({{{vertex(i, 0), vertex(i + 1, 0)}}, 2});
        if (block[1] + 1 == n_blocks[1])
          piece.boundary_faces.push_back({{{vertex(i, n[1]), vertex(i + 1, n[1])}}, 3});
      }
    return piece;
  }

  template <int dim>
  std::vector<MeshPiece<dim>> cut(const MeshPiece<dim> &whole, const std::vector<unsigned int> &part)
  {
    const unsigned int n_cells = whole.cells.size();
    AssertDimension(part.size(), n_cells);

    // union-find over faces between cells of the same part
    std::vector<unsigned int> root(n_cells);
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](unsigned int c) {
      while (root[c] != c)
        c = root[c] = root[root[c]];
      return c;
    };
    const auto faces = faces_with_cells(whole);
    for (std::size_t k = 1; k < faces.size(); ++k)
      if (faces[k].first == faces[k - 1].first && part[faces[k].second] == part[faces[k - 1].second])
        {
          const unsigned int a = find(faces[k].second), b = find(faces[k - 1].second);
          root[std::max(a, b)] = std::min(a, b);
        }

    std::map<Face<dim>, dealii::types::boundary_id> boundary;
    for (const auto &face : whole.boundary_faces)
      {
        auto key = face.vertices;
        std::sort(key.begin(), key.end());
        boundary[key] = face.id;
      }

    std::map<std::pair<unsigned int, unsigned int>, std::vector<unsigned int>> cells_of_piece; // by part and root
    for (unsigned int c = 0; c < n_cells; ++c)
      cells_of_piece[{part[c], find(c)}].push_back(c);
    std::vector<MeshPiece<dim>> pieces;
    for (const auto &[key, cells] : cells_of_piece)
      pieces.push_back(extract<dim>(whole, cells, boundary));
    return pieces;
  }

  template <int dim>
  std::vector<unsigned int> metis_parts(const MeshPiece<dim> &piece, const unsigned int n_parts)
  {
    if (n_parts <= 1)
      return std::vector<unsigned int>(piece.cells.size(), 0);

    const auto                     faces = faces_with_cells(piece);
    dealii::DynamicSparsityPattern connectivity(piece.cells.size(), piece.cells.size());
    for (std::size_t k = 1; k < faces.size(); ++k)
      if (faces[k].first == faces[k - 1].first)
        {
          connectivity.add(faces[k].second, faces[k - 1].second);
          connectivity.add(faces[k - 1].second, faces[k].second);
        }
    for (unsigned int c = 0; c < piece.cells.size(); ++c)
      connectivity.add(c, c);
    dealii::SparsityPattern pattern;
    pattern.copy_from(connectivity);
    std::vector<unsigned int> part(piece.cells.size());
    dealii::SparsityTools::partition(pattern, n_parts, part, dealii::SparsityTools::Partitioner::metis);
    return part;
  }

  template <int dim>
  std::unique_ptr<SubdomainMesh<dim>> triangulate(const MeshPiece<dim> &piece)
  {
    std::vector<dealii::CellData<dim>> cells(piece.cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c)
      cells[c].vertices.assign(piece.cells[c].begin(), piece.cells[c].end());

    // every face starts as a cut, the named boundaries are marked from their vertices
    auto mesh             = std::make_unique<SubdomainMesh<dim>>();
    mesh->subdomain       = piece.subdomain;
    mesh->body            = piece.body;
    mesh->global_vertices = piece.global_vertices;
    mesh->triangulation.create_triangulation(piece.vertices, cells, dealii::SubCellData());

    std::map<Face<dim>, dealii::types::boundary_id> boundary;
    for (const auto &face : piece.boundary_faces)
      {
        auto key = face.vertices;
        std::sort(key.begin(), key.end());
        boundary[key] = face.id;
      }
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      for (const auto &face : cell->face_iterators())
        if (face->at_boundary())
          {
            Face<dim> key;
            for (unsigned int v = 0; v < key.size(); ++v)
              key[v] = face->vertex_index(v);
            std::sort(key.begin(), key.end());
            const auto found = boundary.find(key);
            face->set_boundary_id(found == boundary.end() ? cut_id : found->second);
          }
    return mesh;
  }

  template struct MeshPiece<2>;
  template MeshPiece<2>                      rectangle_piece<2>(const scene::Body<2> &,
                                           const std::array<unsigned int, 2> &,
                                           const std::array<unsigned int, 2> &,
                                           const std::array<unsigned int, 2> &);
  template std::vector<MeshPiece<2>>         cut(const MeshPiece<2> &, const std::vector<unsigned int> &);
  template std::vector<unsigned int>         metis_parts(const MeshPiece<2> &, const unsigned int);
  template std::unique_ptr<SubdomainMesh<2>> triangulate(const MeshPiece<2> &);
} // namespace slipstick::fem
