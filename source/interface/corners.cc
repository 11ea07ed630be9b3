#include <slipstick/interface/corners.h>
#include <slipstick/mechanics/surface.h>

#include <algorithm>
#include <map>

namespace slipstick::interface
{
  namespace
  {
    // A plane of symmetry is held along its normal up to this part of it.
    constexpr double off_normal = 1e-6;

    dealii::Tensor<1, 2> normal_at(const mechanics::SurfaceEdge<2> &edge, const unsigned int i)
    {
      return edge.outline_normal(mechanics::SurfaceEdge<2>::node_coordinate(i));
    }

    dealii::Tensor<1, 3> normal_at(const mechanics::SurfaceFacet &facet, const unsigned int i)
    {
      return facet.outline_normal(i);
    }

    template <int dim>
    bool is_held_along(const scene::PrescribedDisplacement<dim> &support, const dealii::Tensor<1, dim> &normal)
    {
      if (support.normal)
        return true;
      double squares = 0;
      for (unsigned int c = 0; c < dim; ++c)
        squares += support.components[c] ? 0. : normal[c] * normal[c];
      return squares <= off_normal * off_normal;
    }

    /// Whether the body continues beyond a part of its outline: a plane of symmetry, or the axis of revolution.
    template <int dim>
    bool continues_beyond(const scene::Scene<dim>            &scene,
                          const mesh::Mesh<dim>              &mesh,
                          const mechanics::BoundaryPart<dim> &part,
                          const dealii::Tensor<1, dim>       &normal)
    {
      const bool is_on_axis =
        mesh::Kinematics<dim>(scene.plane_state).is_revolution() &&
        std::max(std::abs(part.node(0)[0]), std::abs(part.node(1)[0])) <= off_normal * part.chord();
      return is_on_axis || std::any_of(scene.supports.begin(), scene.supports.end(), [&](const auto &support) {
               return !support.point && support.where.body == part.body &&
                      mesh.on_boundary(support.where, part.boundary) && is_held_along<dim>(support, normal);
             });
    }
  } // namespace

  template <int dim>
  Corners corners_of(const scene::Scene<dim>                         &scene,
                     const mesh::Mesh<dim>                           &mesh,
                     const scene::BoundaryName                       &where,
                     const std::vector<mechanics::BoundaryPart<dim>> &side,
                     const std::vector<mechanics::BoundaryPart<dim>> &outline)
  {
    using Tensor = dealii::Tensor<1, dim>;
    std::map<mechanics::NodeKey, std::vector<Tensor>> normals; // of the side
    for (const auto &part : side)
      for (unsigned int i = 0; i < part.n_nodes; ++i)
        normals[part.keys[i]].push_back(normal_at(part, i));
    Corners corners;
    for (const auto &part : outline)
      if (!mesh.on_boundary(where, part.boundary))
        for (unsigned int i = 0; i < part.n_nodes; ++i)
          if (const auto found = normals.find(part.keys[i]); found != normals.end())
            {
              const Tensor normal = normal_at(part, i);
              const bool   turns  = std::all_of(found->second.begin(), found->second.end(), [&](const Tensor &own) {
                std::vector<Tensor> means;
                mechanics::smooth_normals(std::vector<Tensor>{own, normal}, means);
                return means.size() > 1;
              });
              if (turns && !continues_beyond(scene, mesh, part, normal))
                corners.insert(part.keys[i]);
            }
    return corners;
  }

  template Corners corners_of(const scene::Scene<2> &,
                              const mesh::Mesh<2> &,
                              const scene::BoundaryName &,
                              const std::vector<mechanics::BoundaryPart<2>> &,
                              const std::vector<mechanics::BoundaryPart<2>> &);
  template Corners corners_of(const scene::Scene<3> &,
                              const mesh::Mesh<3> &,
                              const scene::BoundaryName &,
                              const std::vector<mechanics::BoundaryPart<3>> &,
                              const std::vector<mechanics::BoundaryPart<3>> &);
} // namespace slipstick::interface
