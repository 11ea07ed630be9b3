#include <slipstick/app/contact_faces.h>
#include <slipstick/mechanics/surface_facet.h>

#include <algorithm>
#include <optional>

namespace slipstick::app
{
  namespace
  {
    using Facet   = mechanics::SurfaceFacet;
    using Polygon = std::vector<std::int64_t>;

    /// Nodes of the polygons of degree 1 that represent a facet.
    std::vector<std::vector<unsigned int>> parts_of(const Facet &facet)
    {
      switch (facet.n_nodes)
        {
          case 3:
            return {{0, 1, 2}};
          case 6:
            return {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
          case 4:
            return {{0, 1, 2, 3}};
          default:
            return {{0, 4, 8, 7}, {4, 1, 5, 8}, {8, 5, 2, 6}, {7, 8, 6, 3}};
        }
    }

    /// Midpoints of the edges around corners that are not contact nodes: from each one to the next, counter-clockwise.
    using Rings = std::map<mechanics::NodeKey, std::map<std::int64_t, std::int64_t>>;

    /// Adds one polygon per ring; rings are open at the end of a boundary.
    void add_rings(const Rings &rings, std::vector<Polygon> &faces)
    {
      for (const auto &[corner, next] : rings)
        {
          std::int64_t first = next.begin()->first;
          for (const auto &[from, to] : next) // start at the midpoint without predecessor, if there is one
            if (std::none_of(next.begin(), next.end(), [from = from](const auto &step) { return step.second == from; }))
              first = from;
          Polygon ring{first};
          for (auto step = next.find(first);
               step != next.end() && step->second != first && ring.size() < next.size() + 1;
               step = next.find(step->second))
            ring.push_back(step->second);
          if (ring.size() > 2)
            faces.push_back(ring);
        }
    }
  } // namespace

  std::vector<std::vector<std::int64_t>> contact_faces(
    const scene::Scene<3>                                                     &scene,
    const mesh::Mesh<3>                                                       &mesh,
    const mechanics::Spaces<3>                                                &spaces,
    const std::map<std::pair<unsigned int, mechanics::NodeKey>, std::int64_t> &number)
  {
    std::vector<bool> wanted(scene.bodies.size());
    for (const auto &pair : scene.contacts)
      wanted[pair.slave.body] = true;
    const auto           all = mechanics::outlines(mesh, spaces, wanted);
    std::vector<Polygon> faces;
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      {
        Rings rings;
        for (const auto &facet : mechanics::parts_on(mesh, all, scene.contacts[k].slave))
          {
            std::array<std::optional<std::int64_t>, Facet::max_nodes> node;
            for (unsigned int i = 0; i < facet.n_nodes; ++i)
              if (const auto found = number.find({k, facet.keys[i]}); found != number.end())
                node[i] = found->second;
            for (const auto &part : parts_of(facet))
              if (std::all_of(part.begin(), part.end(), [&](const unsigned int i) { return node[i]; }))
                {
                  faces.emplace_back();
                  for (const unsigned int i : part)
                    faces.back().push_back(*node[i]);
                }
            if (facet.n_nodes == 6)
              for (unsigned int i = 0; i < 3; ++i)
                if (const auto &before = node[3 + (i + 2) % 3], &behind = node[3 + i]; !node[i] && before && behind)
                  rings[facet.keys[i]][*behind] = *before;
          }
        add_rings(rings, faces);
      }
    return faces;
  }
} // namespace slipstick::app
