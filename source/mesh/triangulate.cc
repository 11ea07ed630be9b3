#include <slipstick/mesh/edge_middles.h>
#include <slipstick/mesh/solid_middles.h>
#include <slipstick/mesh/triangulate.h>

#include <deal.II/grid/grid_tools.h>

namespace slipstick::mesh
{
  template <int dim>
  std::unique_ptr<SubdomainMesh<dim>> triangulate(const MeshPiece<dim> &piece)
  {
    std::vector<dealii::CellData<dim>> cells(piece.cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c)
      {
        Assert(n_corners<dim>(piece.cells[c]) == n_corners<dim>(piece.cells[0]),
               dealii::ExcMessage("cells of one subdomain are of one kind"));
        cells[c].vertices.assign(piece.cells[c].begin(), piece.cells[c].begin() + n_corners<dim>(piece.cells[c]));
      }
    if (dim == 2 && !piece.ordered && !is_simplex<dim>(piece.cells[0]))
      dealii::GridTools::consistently_order_cells(cells);

    auto mesh             = std::make_unique<SubdomainMesh<dim>>();
    mesh->subdomain       = piece.subdomain;
    mesh->body            = piece.body;
    mesh->global_vertices = piece.global_vertices;
    mesh->triangulation.create_triangulation(piece.vertices, cells, dealii::SubCellData());

    // all faces are cuts initially; boundaries are marked by their vertices
    const auto boundary = boundary_by_vertices(piece);
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      for (const auto &face : cell->face_iterators())
        if (face->at_boundary())
          {
            typename MeshPiece<dim>::Face key;
            key.fill(MeshPiece<dim>::no_vertex);
            for (const unsigned int v : face->vertex_indices())
              key[v] = face->vertex_index(v);
            std::sort(key.begin(), key.end());
            const auto found = boundary.find(key);
            face->set_boundary_id(found == boundary.end() ? cut_id : found->second.id);
            if (found == boundary.end())
              continue;
            if (const auto &curve = found->second.curve; curve || curve.neglected_sagitta > 0)
              mesh->curves[key] = curve;
          }
    if constexpr (dim == 2)
      if (!piece.line_middles.empty())
        {
          for (const auto &cell : mesh->triangulation.active_cell_iterators())
            for (const auto &face : cell->face_iterators())
              {
                const unsigned int a = face->vertex_index(0), b = face->vertex_index(1);
                if (piece.line_middles.count({{std::min(a, b), std::max(a, b)}}) > 0)
                  face->set_manifold_id(EdgeMiddles<dim>::id);
              }
          mesh->triangulation.set_manifold(EdgeMiddles<dim>::id, EdgeMiddles<dim>(piece.line_middles));
        }
    if constexpr (dim == 3)
      follow_middles(piece, boundary, mesh->triangulation);
    return mesh;
  }

  template std::unique_ptr<SubdomainMesh<2>> triangulate(const MeshPiece<2> &);
  template std::unique_ptr<SubdomainMesh<3>> triangulate(const MeshPiece<3> &);
} // namespace slipstick::mesh
