#include <slipstick/base/gather.h>
#include <slipstick/base/nearest.h>
#include <slipstick/mechanics/surface_facet.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>

#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>

namespace slipstick::mechanics
{
  using Place  = SurfaceFacet::Place;
  using Tensor = SurfaceFacet::Tensor;

  namespace
  {
    using Corner = std::pair<NodeKey, dealii::Point<3>>; // also used for other nodes

    // Shares below this fraction of a facet count as zero: the corners of a triangle of degree 2 have none if it is
    // plane; other nodes have a thirty-sixth or more.
    constexpr double smallest_facet_share = 0.01;
    // Nodes of bent facets deviate by more than this fraction of an edge from those of straight-sided ones.
    constexpr double bent = 1e-9;

    bool by_key(const Corner &a, const Corner &b)
    {
      return a.first < b.first;
    }

    void add(const Corner &node, SurfaceFacet &facet)
    {
      facet.keys[facet.n_nodes] = node.first;
      facet.at[facet.n_nodes]   = {{node.second[0], node.second[1], node.second[2]}};
      ++facet.n_nodes;
    }

    /// Exact for the shape functions of plane facets.
    const dealii::Quadrature<2> &rule_of(const SurfaceFacet &facet)
    {
      static const dealii::QGaussSimplex<2>            triangle(1);
      static const dealii::QWitherdenVincentSimplex<2> quadratic_triangle(3);
      static const dealii::QGauss<2>                   quadrilateral(2), quadratic_quadrilateral(3);
      if (facet.n_corners() == 3)
        return facet.is_quadratic() ? static_cast<const dealii::Quadrature<2> &>(quadratic_triangle) : triangle;
      return facet.is_quadratic() ? quadratic_quadrilateral : quadrilateral;
    }
  } // namespace

  SurfaceFacet surface_part(const mesh::SubdomainMesh<3>                      &subdomain,
                            const Spaces<3>                                   &spaces,
                            const dealii::DoFHandler<3>::active_cell_iterator &cell,
                            const unsigned int                                 f)
  {
    const auto          face = cell->face(f);
    std::vector<Corner> corners, others;
    spaces.for_each_face_node(subdomain, face, [&](const unsigned int, const NodeKey &key, const dealii::Point<3> &x) {
      (key[0] == key[1] ? corners : others).push_back({key, x});
    });
    if (corners.size() == 4) // from lexicographic to cyclic order
      std::swap(corners[2], corners[3]);
    dealii::Point<3> center;
    for (const auto &[key, x] : corners)
      center += x / static_cast<double>(corners.size());
    const Tensor across =
      cross_product_3d(corners[2].second - corners[0].second, corners.back().second - corners[1].second);
    if (across * (center - cell->center()) < 0)
      std::reverse(corners.begin(), corners.end());
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), by_key), corners.end());

    SurfaceFacet facet;
    facet.body      = subdomain.body;
    facet.boundary  = face->boundary_id();
    facet.subdomain = subdomain.subdomain;
    facet.n_nodes   = 0;
    for (const auto &corner : corners)
      add(corner, facet);
    if (!subdomain.curves.empty())
      {
        std::array<unsigned int, 4> key;
        key.fill(dealii::numbers::invalid_unsigned_int);
        for (const unsigned int v : face->vertex_indices())
          key[v] = face->vertex_index(v);
        std::sort(key.begin(), key.end());
        if (const auto found = subdomain.curves.find(key); found != subdomain.curves.end())
          facet.surface = found->second;
      }
    if (others.empty())
      return facet;
    for (unsigned int i = 0; i < corners.size(); ++i)
      {
        const auto a = corners[i].first[0], b = corners[(i + 1) % corners.size()].first[0];
        const auto found = std::find_if(others.begin(), others.end(), [&](const Corner &other) {
          return other.first == NodeKey{{std::min(a, b), std::max(a, b)}};
        });
        add(*found, facet);
      }
    if (corners.size() == 4)
      add(others.back(), facet);
    return facet;
  }

  double SurfaceFacet::distance(const dealii::Point<3> &x) const
  {
    double least = x.distance(nearest_on_triangle({{node(0), node(1), node(2)}}, x));
    if (n_corners() == 4)
      least = std::min(least, x.distance(nearest_on_triangle({{node(0), node(2), node(3)}}, x)));
    return least;
  }

  SurfaceFacet::Shape SurfaceFacet::shape_of_corners(const Place &s) const
  {
    return mesh::FacetShapes::linear(n_corners(), s);
  }

  SurfaceFacet::Shape SurfaceFacet::shape(const Place &s) const
  {
    return is_quadratic() ? mesh::FacetShapes::quadratic(n_corners(), s) : shape_of_corners(s);
  }

  bool SurfaceFacet::is_bent() const
  {
    if (!is_quadratic())
      return false;
    const double least = bent * chord();
    for (unsigned int i = n_corners(); i < n_nodes; ++i)
      {
        const Shape N = shape_of_corners(node_coordinate(i));
        Tensor      off(node(i));
        for (unsigned int k = 0; k < n_corners(); ++k)
          off -= N[k] * Tensor(node(k));
        if (off.norm() > least)
          return true;
      }
    return false;
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
    if (is_quadratic())
      {
        const auto dN = mesh::FacetShapes::quadratic_derivatives(n_corners(), s);
        Tensor     a, b;
        for (unsigned int i = 0; i < n_nodes; ++i)
          {
            a += dN[i][0] * Tensor(node(i));
            b += dN[i][1] * Tensor(node(i));
          }
        return cross_product_3d(a, b);
      }
    if (n_nodes == 3)
      return cross_product_3d(node(1) - node(0), node(2) - node(0));
    return cross_product_3d((1 - s[1]) * (node(1) - node(0)) + s[1] * (node(2) - node(3)),
                            (1 - s[0]) * (node(3) - node(0)) + s[0] * (node(2) - node(1)));
  }

  double SurfaceFacet::chord() const
  {
    double sum = 0;
    for (unsigned int i = 0; i < n_corners(); ++i)
      sum += node(i).distance(node((i + 1) % n_corners()));
    return sum / n_corners();
  }

  SurfaceFacet::Shape SurfaceFacet::tributary_areas() const
  {
    Shape       areas{};
    double      whole = 0;
    const auto &rule  = rule_of(*this);
    for (unsigned int q = 0; q < rule.size(); ++q)
      {
        const Shape  N  = shape(rule.point(q));
        const double dx = area_vector(rule.point(q)).norm() * rule.weight(q);
        whole += dx;
        for (unsigned int i = 0; i < n_nodes; ++i)
          areas[i] += N[i] * dx;
      }
    if (n_nodes == 6 && is_bent()) // corners get none, as in plane facets
      for (unsigned int i = 0; i < 3; ++i)
        {
          for (unsigned int k = 3; k < 6; ++k)
            areas[k] += areas[i] / 3;
          areas[i] = 0;
        }
    for (double &area : areas)
      if (area < smallest_facet_share * whole)
        area = 0;
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
      for (unsigned int i = 0; i < (part > 0 ? facet.n_corners() : 1); ++i)
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
            if (mesh::is_on_outline(cell->face(f)))
              own.push_back(surface_part(*mesh.subdomains[p], spaces, cell, f));
    for (const auto &list : all_gather(mesh.comm, own))
      all.insert(all.end(), list.begin(), list.end());
    std::sort(all.begin(), all.end());
    return all;
  }

  BoxTree<3> facet_tree(const std::vector<SurfaceFacet> &facets)
  {
    std::vector<BoxTree<3>::Box> boxes;
    for (const auto &facet : facets)
      {
        std::vector<dealii::Point<3>> corners;
        for (unsigned int i = 0; i < facet.n_nodes; ++i)
          corners.push_back(facet.node(i));
        boxes.push_back(BoxTree<3>::box_around(corners));
      }
    return BoxTree<3>(boxes);
  }
} // namespace slipstick::mechanics
