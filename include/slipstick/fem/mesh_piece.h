// A piece of mesh as plain lists: what is cut, sent between ranks and made into a triangulation.
#pragma once

#include <slipstick/fem/mesh.h>

#include <deal.II/base/geometry_info.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <array>

namespace slipstick::fem
{
  /// Cells, vertices and boundary faces of one subdomain (or of a whole body before it is cut).
  template <int dim>
  struct MeshPiece
  {
    static constexpr unsigned int vertices_per_cell = dealii::GeometryInfo<dim>::vertices_per_cell;
    static constexpr unsigned int vertices_per_face = dealii::GeometryInfo<dim>::vertices_per_face;

    struct BoundaryFace
    {
      std::array<unsigned int, vertices_per_face> vertices; // local numbers
      dealii::types::boundary_id                  id;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &vertices &id;
      }
    };

    unsigned int                                             subdomain = 0;
    unsigned int                                             body      = 0;
    std::vector<dealii::Point<dim>>                          vertices;
    std::vector<GlobalVertex>                                global_vertices;
    std::vector<std::array<unsigned int, vertices_per_cell>> cells;          // local vertices, deal.II's order
    std::vector<BoundaryFace>                                boundary_faces; // of the body; all others are cut

    /// For sending between ranks (Boost serialization, through deal.II's MPI utilities).
    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &subdomain &body &vertices &global_vertices &cells &boundary_faces;
    }
  };

  /// Block @p block (of n_blocks per direction) of a rectangle meshed by a lattice of equal cells.
  template <int dim>
  MeshPiece<dim> rectangle_piece(const scene::Body<dim>              &body,
                                 const std::array<unsigned int, dim> &n_cells,
                                 const std::array<unsigned int, dim> &n_blocks,
                                 const std::array<unsigned int, dim> &block);

  /// Cuts @p whole along @p part (a part number for every cell). Parts without cells are left out; parts that hang
  /// together through no face fall apart into several pieces. Pieces come in order of part and first cell.
  template <int dim>
  std::vector<MeshPiece<dim>> cut(const MeshPiece<dim> &whole, const std::vector<unsigned int> &part);

  /// METIS partition of the cells of @p piece, through deal.II. @return a part number for every cell.
  template <int dim>
  std::vector<unsigned int> metis_parts(const MeshPiece<dim> &piece, const unsigned int n_parts);

  /// The triangulation of a piece; faces that lie on no named boundary get cut_id.
  template <int dim>
  std::unique_ptr<SubdomainMesh<dim>> triangulate(const MeshPiece<dim> &piece);
} // namespace slipstick::fem
