#include <slipstick/base/gather.h>
#include <slipstick/mechanics/surface.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>

namespace slipstick::mechanics
{
  namespace
  {
    // Gauss, three points on [0, 1]: exact for straight edges of both degrees
    const std::array<double, 3> gauss_points  = {{0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)}};
    const std::array<double, 3> gauss_weights = {{5. / 18, 8. / 18, 5. / 18}};
    // Shares below this fraction of an edge count as zero: the end of a quadratic edge on the axis of revolution has
    // none if the edge is straight and almost none if it is curved; other nodes have a ninth or more.
    constexpr double smallest_edge_share = 0.01;

    /// Unit normal to the right of a direction.
    template <int dim>
    dealii::Tensor<1, dim> right_of(const dealii::Tensor<1, dim> &way)
    {
      static_assert(dim == 2, "the normal of a curve");
      dealii::Tensor<1, dim> n;
      n[0] = way[1];
      n[1] = -way[0];
      return n / n.norm();
    }
  } // namespace

  template <int dim>
  std::array<double, 3> SurfaceEdge<dim>::shape(const double s) const
  {
    if (n_nodes == 2)
      return {{1 - s, s, 0}};
    return {{(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)}};
  }

  template <int dim>
  std::array<double, 3> SurfaceEdge<dim>::shape_derivative(const double s) const
  {
    if (n_nodes == 2)
      return {{-1, 1, 0}};
    return {{4 * s - 3, 4 * s - 1, 4 - 8 * s}};
  }

  template <int dim>
  dealii::Point<dim> SurfaceEdge<dim>::point(const double s) const
  {
    const auto         N = shape(s);
    dealii::Point<dim> x;
    for (unsigned int i = 0; i < n_nodes; ++i)
      x += N[i] * dealii::Tensor<1, dim>(node(i));
    return x;
  }

  template <int dim>
  dealii::Tensor<1, dim> SurfaceEdge<dim>::tangent(const double s) const
  {
    const auto             dN = shape_derivative(s);
    dealii::Tensor<1, dim> t;
    for (unsigned int i = 0; i < n_nodes; ++i)
      t += dN[i] * dealii::Tensor<1, dim>(node(i));
    return t;
  }

  template <int dim>
  dealii::Tensor<1, dim> SurfaceEdge<dim>::normal(const double s) const
  {
    return right_of(tangent(s));
  }

  template <int dim>
  dealii::Tensor<1, dim> SurfaceEdge<dim>::outline_normal(const double s) const
  {
    return right_of(curve ? curve.tangent(s) : tangent(s));
  }

  template <int dim>
  std::array<double, 3> SurfaceEdge<dim>::tributary_measures(const mesh::Kinematics<dim> &kinematics) const
  {
    std::array<double, 3> measures{};
    for (unsigned int q = 0; q < gauss_points.size(); ++q)
      {
        const auto   N = shape(gauss_points[q]);
        const double dx =
          gauss_weights[q] * tangent(gauss_points[q]).norm() * kinematics.measure(point(gauss_points[q]));
        for (unsigned int i = 0; i < n_nodes; ++i)
          measures[i] += N[i] * dx;
      }
    for (double &measure : measures)
      if (measure < smallest_edge_share * (measures[0] + measures[1] + measures[2]))
        measure = 0;
    return measures;
  }

  template <int dim>
  SurfaceEdge<dim> surface_edge(const mesh::SubdomainMesh<dim>                               &subdomain,
                                const Spaces<dim>                                            &spaces,
                                const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                                const unsigned int                                            f)
  {
    const auto       face = cell->face(f);
    SurfaceEdge<dim> edge;
    edge.body      = subdomain.body;
    edge.boundary  = face->boundary_id();
    edge.subdomain = subdomain.subdomain;
    edge.n_nodes   = 0;
    spaces.for_each_face_node(subdomain,
                              face,
                              [&](const unsigned int, const NodeKey &key, const dealii::Point<dim> &x) {
                                edge.keys[edge.n_nodes] = key;
                                for (unsigned int d = 0; d < dim; ++d)
                                  edge.at[edge.n_nodes][d] = x[d];
                                ++edge.n_nodes;
                              });
    const unsigned int a = face->vertex_index(0), b = face->vertex_index(1);
    if (const auto found = subdomain.curves.find({{std::min(a, b), std::max(a, b)}}); found != subdomain.curves.end())
      edge.curve = a < b ? found->second : found->second.reversed();
    const auto along = edge.node(1) - edge.node(0), inward = cell->center() - edge.node(0);
    if (cross(along, inward) < 0)
      {
        std::swap(edge.keys[0], edge.keys[1]);
        std::swap(edge.at[0], edge.at[1]);
        edge.curve = edge.curve.reversed();
      }
    return edge;
  }

  template <int dim>
  std::vector<SurfaceEdge<dim>> outlines(const mesh::Mesh<dim>   &mesh,
                                         const Spaces<dim>       &spaces,
                                         const std::vector<bool> &wanted)
  {
    std::vector<SurfaceEdge<dim>> own, all;
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      if (wanted[mesh.subdomains[p]->body])
        for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
          for (const unsigned int f : cell->face_indices())
            if (mesh::is_on_outline(cell->face(f)))
              own.push_back(surface_edge(*mesh.subdomains[p], spaces, cell, f));
    for (const auto &list : all_gather(mesh.comm, own))
      all.insert(all.end(), list.begin(), list.end());
    std::sort(all.begin(), all.end());
    return all;
  }

  template <int dim>
  std::vector<SurfaceEdge<dim>> edges_on(const mesh::Mesh<dim>               &mesh,
                                         const std::vector<SurfaceEdge<dim>> &outlines,
                                         const scene::BoundaryName           &where)
  {
    std::vector<SurfaceEdge<dim>> edges;
    for (const auto &edge : outlines)
      if (edge.body == where.body && mesh.on_boundary(where, edge.boundary))
        edges.push_back(edge);
    return edges;
  }

  template <int dim>
  std::vector<unsigned int> smooth_normals(const std::vector<dealii::Tensor<1, dim>> &normals,
                                           std::vector<dealii::Tensor<1, dim>>       &means)
  {
    means.clear();
    std::vector<unsigned int> group(normals.size()), first;
    for (unsigned int i = 0; i < normals.size(); ++i)
      {
        unsigned int g = 0;
        while (g < first.size() && !(normals[first[g]] * normals[i] > corner_cosine))
          ++g;
        if (g == first.size())
          {
            first.push_back(i);
            means.emplace_back();
          }
        group[i] = g;
        means[g] += normals[i];
      }
    for (auto &mean : means)
      mean /= mean.norm();
    return group;
  }

  template struct SurfaceEdge<2>;
  template SurfaceEdge<2>              surface_edge(const mesh::SubdomainMesh<2> &,
                                                    const Spaces<2> &,
                                                    const dealii::DoFHandler<2>::active_cell_iterator &,
                                                    const unsigned int);
  template std::vector<SurfaceEdge<2>> outlines(const mesh::Mesh<2> &, const Spaces<2> &, const std::vector<bool> &);
  template std::vector<SurfaceEdge<2>> edges_on(const mesh::Mesh<2> &,
                                                const std::vector<SurfaceEdge<2>> &,
                                                const scene::BoundaryName &);
  template std::vector<unsigned int>   smooth_normals(const std::vector<dealii::Tensor<1, 2>> &,
                                                      std::vector<dealii::Tensor<1, 2>> &);
  template std::vector<unsigned int>   smooth_normals(const std::vector<dealii::Tensor<1, 3>> &,
                                                      std::vector<dealii::Tensor<1, 3>> &);
} // namespace slipstick::mechanics
