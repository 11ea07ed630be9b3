#include <slipstick/mechanics/surface_facet.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>

namespace slipstick::mechanics
{
  using Place  = SurfaceFacet::Place;
  using Tensor = SurfaceFacet::Tensor;

  SurfaceFacet surface_part(const mesh::SubdomainMesh<3>                      &subdomain,
                            const Spaces<3>                                   &spaces,
                            const dealii::DoFHandler<3>::active_cell_iterator &cell,
                            const unsigned int                                 f)
  {
    const auto   face = cell->face(f);
    SurfaceFacet facet;
    facet.body      = subdomain.body;
    facet.boundary  = face->boundary_id();
    facet.subdomain = subdomain.subdomain;
    facet.n_nodes   = 0;
    spaces.for_each_face_node(subdomain, face, [&](const unsigned int, const NodeKey &key, const dealii::Point<3> &x) {
      facet.keys[facet.n_nodes] = key;
      facet.at[facet.n_nodes]   = {{x[0], x[1], x[2]}};
      ++facet.n_nodes;
    });
    if (facet.n_nodes == 4) // in rows: now around
      {
        std::swap(facet.keys[2], facet.keys[3]);
        std::swap(facet.at[2], facet.at[3]);
      }
    if (facet.area_vector(facet.middle_place()) * (facet.middle() - cell->center()) < 0)
      {
        std::reverse(facet.keys.begin(), facet.keys.begin() + facet.n_nodes);
        std::reverse(facet.at.begin(), facet.at.begin() + facet.n_nodes);
      }
    const auto end      = facet.keys.begin() + facet.n_nodes;
    const auto smallest = std::min_element(facet.keys.begin(), end) - facet.keys.begin();
    std::rotate(facet.keys.begin(), facet.keys.begin() + smallest, end);
    std::rotate(facet.at.begin(), facet.at.begin() + smallest, facet.at.begin() + facet.n_nodes);
    return facet;
  }

  SurfaceFacet::Shape SurfaceFacet::shape(const Place &s) const
  {
    if (n_nodes == 3)
      return {{1 - s[0] - s[1], s[0], s[1], 0.}};
    return {{(1 - s[0]) * (1 - s[1]), s[0] * (1 - s[1]), s[0] * s[1], (1 - s[0]) * s[1]}};
  }

  dealii::Point<3> SurfaceFacet::point(const Place &s) const
  {
    const Shape      N = shape(s);
    dealii::Point<3> x;
    for (unsigned int i = 0; i < n_nodes; ++i)
      x += N[i] * Tensor(node(i));
    return x;
  }

  SurfaceFacet::Tensor SurfaceFacet::area_vector(const Place &s) const
  {
    if (n_nodes == 3)
      return cross_product_3d(node(1) - node(0), node(2) - node(0));
    return cross_product_3d((1 - s[1]) * (node(1) - node(0)) + s[1] * (node(2) - node(3)),
                            (1 - s[0]) * (node(3) - node(0)) + s[0] * (node(2) - node(1)));
  }

  SurfaceFacet::Place SurfaceFacet::node_coordinate(const unsigned int i) const
  {
    static const std::array<std::array<double, 2>, 4> square = {{{{0, 0}}, {{1, 0}}, {{1, 1}}, {{0, 1}}}};
    if (n_nodes == 3 && i == 2)
      return {0, 1};
    return {square[i][0], square[i][1]};
  }

  SurfaceFacet::Place SurfaceFacet::middle_place() const
  {
    const double c = n_nodes == 3 ? 1. / 3 : 0.5;
    return {c, c};
  }

  double SurfaceFacet::chord() const
  {
    double sum = 0;
    for (unsigned int i = 0; i < n_nodes; ++i)
      sum += node(i).distance(node((i + 1) % n_nodes));
    return sum / n_nodes;
  }

  // Two Gauss points a direction integrate plane quadrilaterals exactly.
  SurfaceFacet::Shape SurfaceFacet::tributary_areas() const
  {
    Shape areas{};
    if (n_nodes == 3)
      {
        areas.fill(area_vector(middle_place()).norm() / 6);
        areas[3] = 0;
        return areas;
      }
    const double gauss = 0.5 / std::sqrt(3.);
    for (const double s : {0.5 - gauss, 0.5 + gauss})
      for (const double t : {0.5 - gauss, 0.5 + gauss})
        {
          const Shape  N  = shape({s, t});
          const double dx = area_vector({s, t}).norm() / 4;
          for (unsigned int i = 0; i < n_nodes; ++i)
            areas[i] += N[i] * dx;
        }
    return areas;
  }

  std::vector<dealii::Point<2>> inner_points(const SurfaceEdge<2> &edge)
  {
    std::vector<dealii::Point<2>> points;
    for (const double s : {0.05, 0.25, 0.5, 0.75, 0.95})
      points.push_back(edge.point(s));
    return points;
  }

  std::vector<dealii::Point<3>> inner_points(const SurfaceFacet &facet)
  {
    std::vector<dealii::Point<3>> points;
    const auto                    middle = facet.middle_place();
    for (const double part : {0., 0.5, 0.9}) // of the way to a corner
      for (unsigned int i = 0; i < (part > 0 ? facet.n_nodes : 1); ++i)
        points.push_back(facet.point(middle + part * (facet.node_coordinate(i) - middle)));
    return points;
  }

  std::vector<SurfaceFacet> outlines(const mesh::Mesh<3>     &mesh,
                                     const Spaces<3>         &spaces,
                                     const std::vector<bool> &wanted)
  {
    std::vector<SurfaceFacet> own, all;
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      if (wanted[mesh.subdomains[p]->body])
        for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
          for (const unsigned int f : cell->face_indices())
            if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() != mesh::cut_id)
              own.push_back(surface_part(*mesh.subdomains[p], spaces, cell, f));
    for (const auto &list : dealii::Utilities::MPI::all_gather(mesh.comm, own))
      all.insert(all.end(), list.begin(), list.end());
    std::sort(all.begin(), all.end());
    return all;
  }
} // namespace slipstick::mechanics
