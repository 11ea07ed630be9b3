#include <slipstick/interface/surface_nodes.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace slipstick::interface
{
  template <int dim>
  SurfaceNodes<dim>::SurfaceNodes(const std::vector<Part> &surface, const mesh::Kinematics<dim> &kinematics)
    : of_part(surface.size())
  {
    std::map<mechanics::NodeKey, Places> at;
    for (unsigned int e = 0; e < surface.size(); ++e)
      for (unsigned int i = 0; i < surface[e].n_nodes; ++i)
        at[surface[e].keys[i]].emplace_back(e, i);
    for (const auto &[key, places] : at)
      add(surface, places, key);
    for (unsigned int e = 0; e < surface.size(); ++e)
      {
        const auto   lengths = surface[e].tributary_lengths(), measures = surface[e].tributary_measures(kinematics);
        const double size = surface[e].chord(), scale = std::accumulate(measures.begin(), measures.end(), 0.);
        for (unsigned int i = 0; i < surface[e].n_nodes; ++i)
          {
            SurfaceNode<dim> &node = nodes[of_part[e][i]];
            node.size              = std::max(node.size, size);
            node.covered += lengths[i];
            node.measure += measures[i];
            node.scale += scale;
          }
      }
  }

  /// The node at these places, once for each side.
  template <int dim>
  void SurfaceNodes<dim>::add(const std::vector<Part> &surface, const Places &places, const mechanics::NodeKey &key)
  {
    std::vector<Tensor> normals, means;
    for (const auto &[e, i] : places)
      normals.push_back(outline_normal_at(surface[e], i));
    const auto         side  = mechanics::smooth_normals(normals, means);
    const unsigned int first = nodes.size();
    for (unsigned int g = 0; g < means.size(); ++g)
      nodes.push_back({key, g, surface[places[0].first].node(places[0].second), means[g]});
    for (unsigned int k = 0; k < places.size(); ++k)
      of_part[places[k].first][places[k].second] = first + side[k];
  }

  template struct SurfaceNodes<2>;
  template struct SurfaceNodes<3>;
} // namespace slipstick::interface
