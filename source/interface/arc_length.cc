#include <slipstick/base/gather.h>
#include <slipstick/interface/arc_length.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <set>

namespace slipstick::interface
{
  namespace
  {
    /// An edge of a slave boundary: its vertices, their coordinates, its length.
    template <int dim>
    struct OutlineEdge
    {
      unsigned int                           pair = 0;
      std::array<mesh::GlobalVertex, 2>      ends{};
      std::array<std::array<double, dim>, 2> at{};
      double                                 length = 0;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &pair &ends &at &length;
      }
    };

    template <int dim>
    std::vector<OutlineEdge<dim>> local_edges(const scene::Scene<dim>      &scene,
                                              const mesh::Mesh<dim>        &mesh,
                                              const mechanics::Spaces<dim> &spaces)
    {
      std::vector<OutlineEdge<dim>> edges;
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        for (unsigned int k = 0; k < scene.contacts.size(); ++k)
          {
            const auto &slave = scene.contacts[k].slave;
            if (slave.body != mesh.subdomains[p]->body)
              continue;
            for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
              for (const auto &face : cell->face_iterators())
                if (face->at_boundary() && mesh.on_boundary(slave, face->boundary_id()))
                  {
                    OutlineEdge<dim> edge;
                    edge.pair   = k;
                    edge.length = face->measure();
                    for (unsigned int v = 0; v < 2; ++v)
                      {
                        edge.ends[v] = mesh.subdomains[p]->global_vertices[face->vertex_index(v)];
                        for (unsigned int d = 0; d < dim; ++d)
                          edge.at[v][d] = face->vertex(v)[d];
                      }
                    edges.push_back(edge);
                  }
          }
      return edges;
    }

    /// Follows the lines of one pair.
    template <int dim>
    class Walk
    {
    public:
      explicit Walk(const std::vector<OutlineEdge<dim>> &edges_)
        : edges(edges_)
      {
        for (unsigned int e = 0; e < edges.size(); ++e)
          for (unsigned int v = 0; v < 2; ++v)
            {
              at_vertex[edges[e].ends[v]].push_back(e);
              position[edges[e].ends[v]] = edges[e].at[v];
            }
      }

      std::map<mechanics::NodeKey, double> lengths()
      {
        std::vector<mesh::GlobalVertex> starts; // ends of lines first, then any vertex (closed lines); by position
        for (const bool ends : {true, false})
          {
            std::vector<mesh::GlobalVertex> group;
            for (const auto &[vertex, list] : at_vertex)
              if ((list.size() == 1) == ends)
                group.push_back(vertex);
            std::sort(group.begin(), group.end(), [&](const auto a, const auto b) {
              return position.at(a) < position.at(b);
            });
            starts.insert(starts.end(), group.begin(), group.end());
          }
        for (const mesh::GlobalVertex start : starts)
          if (!found.count({{start, start}}))
            follow(start);
        return found;
      }

    private:
      void follow(mesh::GlobalVertex vertex)
      {
        found[{{vertex, vertex}}] = s;
        for (bool goes_on = true; goes_on;)
          {
            goes_on = false;
            for (const unsigned int e : at_vertex.at(vertex))
              if (walked.insert(e).second)
                {
                  const auto              &ends  = edges[e].ends;
                  const mesh::GlobalVertex other = ends[0] == vertex ? ends[1] : ends[0];
                  found[{{std::min(ends[0], ends[1]), std::max(ends[0], ends[1])}}] = s + edges[e].length / 2;
                  s += edges[e].length;
                  found.insert({mechanics::NodeKey{{other, other}}, s});
                  vertex  = other;
                  goes_on = true;
                  break;
                }
          }
      }

      const std::vector<OutlineEdge<dim>>                    &edges;
      std::map<mesh::GlobalVertex, std::vector<unsigned int>> at_vertex;
      std::map<mesh::GlobalVertex, std::array<double, dim>>   position;
      std::set<unsigned int>                                  walked;
      std::map<mechanics::NodeKey, double>                    found;
      double                                                  s = 0;
    };
  } // namespace

  template <int dim>
  std::map<std::pair<unsigned int, mechanics::NodeKey>, double> arc_lengths(const scene::Scene<dim>      &scene,
                                                                            const mesh::Mesh<dim>        &mesh,
                                                                            const mechanics::Spaces<dim> &spaces)
  {
    std::vector<std::vector<OutlineEdge<dim>>> by_pair(scene.contacts.size());
    for (const auto &list : gather(mesh.comm, local_edges(scene, mesh, spaces)))
      for (const auto &edge : list)
        by_pair[edge.pair].push_back(edge);
    std::map<std::pair<unsigned int, mechanics::NodeKey>, double> result;
    for (unsigned int k = 0; k < by_pair.size(); ++k)
      for (const auto &[key, s] : Walk<dim>(by_pair[k]).lengths())
        result[{k, key}] = s;
    return result;
  }

  template std::map<std::pair<unsigned int, mechanics::NodeKey>, double> arc_lengths(const scene::Scene<2> &,
                                                                                     const mesh::Mesh<2> &,
                                                                                     const mechanics::Spaces<2> &);
} // namespace slipstick::interface
