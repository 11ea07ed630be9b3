// Boundary faces of solids: nodes, normals, areas.
#pragma once

#include <slipstick/mechanics/surface.h>

#include <boost/serialization/array.hpp>

namespace slipstick::mechanics
{
  /// A quadrilateral on the surface of a solid. Its vertices go around it, counterclockwise seen from outside, from
  /// the one with the smallest key.
  struct SurfaceFace
  {
    unsigned int                         body      = 0;
    unsigned int                         boundary  = 0; // boundary id
    unsigned int                         subdomain = 0;
    std::array<NodeKey, 4>               keys{};
    std::array<std::array<double, 3>, 4> at{}; // [mm]
    static constexpr unsigned int        n_nodes = 4;

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &body &boundary &subdomain &keys &at;
    }

    dealii::Point<3> node(const unsigned int i) const
    {
      return dealii::Point<3>(at[i][0], at[i][1], at[i][2]);
    }

    dealii::Point<3> middle() const;

    /// Outward, unit length, in the middle.
    dealii::Tensor<1, 3> normal() const;

    dealii::Tensor<1, 3> normal_at(const unsigned int) const
    {
      return normal();
    }

    double chord() const; // longer diagonal [mm]

    /// Integral of the shape function of every node [mm^2].
    std::array<double, 4> shares() const;

    /// Order of the faces of all bodies that does not depend on the decomposition.
    bool operator<(const SurfaceFace &other) const
    {
      return std::tie(body, keys) < std::tie(other.body, other.keys);
    }
  };

  /// The surfaces of bodies (by index: wanted or not), known to every rank, sorted. Collective.
  std::vector<SurfaceFace> surfaces(const mesh::Mesh<3>     &mesh,
                                    const Spaces<3>         &spaces,
                                    const std::vector<bool> &wanted);

  /// What the boundaries of bodies consist of: edges in the plane, faces in space.
  template <int dim>
  using BoundaryPart = std::conditional_t<dim == 2, SurfaceEdge<2>, SurfaceFace>;

  /// outlines() or surfaces().
  template <int dim>
  std::vector<BoundaryPart<dim>> boundary_parts(const mesh::Mesh<dim>   &mesh,
                                                const Spaces<dim>       &spaces,
                                                const std::vector<bool> &wanted)
  {
    if constexpr (dim == 2)
      return outlines(mesh, spaces, wanted);
    else
      return surfaces(mesh, spaces, wanted);
  }

  /// Those on one boundary, in their order.
  template <int dim, class Part>
  std::vector<Part> parts_on(const mesh::Mesh<dim>     &mesh,
                             const std::vector<Part>   &parts,
                             const scene::BoundaryName &where)
  {
    std::vector<Part> found;
    for (const auto &part : parts)
      if (part.body == where.body && mesh.on_boundary(where, part.boundary))
        found.push_back(part);
    return found;
  }
} // namespace slipstick::mechanics
