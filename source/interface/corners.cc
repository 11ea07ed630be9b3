#include <slipstick/interface/corners.h>
#include <slipstick/interface/held_slaves.h>
#include <slipstick/mechanics/surface.h>

#include <algorithm>
#include <map>

namespace slipstick::interface
{
  namespace
  {
    // Nodes are on the axis of revolution if their distance from it is at most this fraction of the edge.
    constexpr double on_axis = 1e-6;

    /// Whether the body continues beyond a part of its outline: a plane of symmetry, or the axis of revolution.
    template <int dim>
    bool continues_beyond(const scene::Scene<dim>            &scene,
                          const mesh::Mesh<dim>              &mesh,
                          const mechanics::BoundaryPart<dim> &part,
                          const dealii::Tensor<1, dim>       &normal)
    {
      const bool is_on_axis = mesh::Kinematics<dim>(scene.plane_state).is_revolution() &&
                              std::max(std::abs(part.node(0)[0]), std::abs(part.node(1)[0])) <= on_axis * part.chord();
      return is_on_axis || std::any_of(scene.supports.begin(), scene.supports.end(), [&](const auto &support) {
               return !support.point && support.where.body == part.body &&
                      mesh.on_boundary(support.where, part.boundary) &&
                      (support.normal || are_held<dim>(support.components, normal));
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
        normals[part.keys[i]].push_back(outline_normal_at(part, i));
    Corners corners;
    for (const auto &part : outline)
      if (!mesh.on_boundary(where, part.boundary))
        for (unsigned int i = 0; i < part.n_nodes; ++i)
          if (const auto found = normals.find(part.keys[i]); found != normals.end())
            {
              const Tensor normal = outline_normal_at(part, i);
              const bool   turns  = std::all_of(found->second.begin(), found->second.end(), [&](const Tensor &own) {
                return own * normal <= mechanics::corner_cosine;
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
