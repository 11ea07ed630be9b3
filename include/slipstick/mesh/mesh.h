// The torn mesh: one deal.II triangulation per subdomain; each rank stores its own subdomains only.
#pragma once

#include <slipstick/base/remark.h>
#include <slipstick/mesh/face_surface.h>
#include <slipstick/scene/scene.h>

#include <deal.II/grid/tria.h>

#include <mpi.h>

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace slipstick::mesh
{
  /// Number of a mesh vertex of the untorn bodies, the same in all subdomains and on all ranks.
  using GlobalVertex = std::uint64_t;

  /// Boundary id of the faces along which a body was cut into subdomains.
  constexpr dealii::types::boundary_id cut_id = 1000000;

  /// Whether a face (an iterator) is on the outline of its body, not on a cut.
  template <class Face>
  bool is_on_outline(const Face &face)
  {
    return face->at_boundary() && face->boundary_id() != cut_id;
  }

  template <int dim>
  struct SubdomainMesh
  {
    unsigned int               subdomain = 0; // global number
    unsigned int               body      = 0; // index into Scene::bodies
    dealii::Triangulation<dim> triangulation;
    std::vector<GlobalVertex>  global_vertices; // of every vertex of the triangulation

    /// Curves of the boundary edges that have one, by their two vertices in ascending order; they run from the first.
    /// In space: surfaces of boundary faces, by their vertices in ascending order, invalid_unsigned_int after those of
    /// a triangle.
    std::map<std::array<unsigned int, 2 * (dim - 1)>, BoundaryCurve<dim>> curves;
  };

  /// A named point of a mesh file.
  template <int dim>
  struct NamedPoint
  {
    dealii::Point<dim> position; // as placed [mm]
    GlobalVertex       vertex = 0;

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &position &vertex;
    }
  };

  template <int dim>
  struct Mesh
  {
    MPI_Comm                                                       comm;
    std::vector<std::unique_ptr<SubdomainMesh<dim>>>               subdomains;      // of this rank
    std::vector<unsigned int>                                      first_subdomain; // of each rank, and their number
    std::vector<std::map<std::string, dealii::types::boundary_id>> boundary_ids;    // by body and name
    std::vector<std::map<dealii::types::boundary_id, std::set<dealii::types::boundary_id>>>
      combined_ids;                                             // by body: id of faces with several names, their ids
    std::vector<std::map<std::string, NamedPoint<dim>>> points; // by body and name
    std::vector<double>                                 sizes;  // of the bodies: diagonals of their bounding boxes [mm]
    std::uint64_t                                       n_cells = 0; // over all ranks
    std::vector<Remark>                                 remarks;     // for the log, on rank 0

    unsigned int n_subdomains() const
    {
      return first_subdomain.back();
    }

    unsigned int rank_of_subdomain(const unsigned int subdomain) const;

    /// Whether a face of body @p where.body with boundary id @p id is on the named boundary (`*`: on any, except cuts).
    /// A face may be on several. make_mesh() has checked that the boundaries of the scene exist.
    bool on_boundary(const scene::BoundaryName &where, const dealii::types::boundary_id id) const;
  };
} // namespace slipstick::mesh
