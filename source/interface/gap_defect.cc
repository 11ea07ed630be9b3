#include <slipstick/interface/gap_defect.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/interface/pair_checks.h>

#include <deal.II/base/quadrature_lib.h>

namespace slipstick::interface
{
  namespace
  {
    // Number of points along an edge, and along each direction of a facet.
    constexpr unsigned int n_points_along = 3;
    // Nodes whose shape functions have less than this fraction of the mean integral have no tributary area.
    constexpr double least_share = 1e-6;

    /// A point of an edge or facet.
    template <int dim>
    struct PointOfPart
    {
      dealii::Point<dim>  x;           // on the true surface
      double              measure = 0; // of the edge or facet, times the quadrature weight
      std::vector<double> shape;       // functions of the nodes
    };

    std::vector<PointOfPart<2>> points_of(const mechanics::SurfaceEdge<2> &edge)
    {
      const dealii::QGauss<1>     rule(n_points_along);
      std::vector<PointOfPart<2>> points;
      for (unsigned int q = 0; q < rule.size(); ++q)
        {
          const double s      = rule.point(q)[0];
          const auto   normal = edge.normal(s);
          const auto   N      = edge.shape(s);
          points.push_back({edge.point(s) + edge.rise(s, normal) * normal,
                            rule.weight(q) * edge.tangent(s).norm(),
                            {N.begin(), N.begin() + edge.n_nodes}});
        }
      return points;
    }

    std::vector<PointOfPart<3>> points_of(const mechanics::SurfaceFacet &facet)
    {
      const dealii::Quadrature<2> rule = facet.n_corners() == 3
                                           ? dealii::Quadrature<2>(dealii::QGaussSimplex<2>(n_points_along))
                                           : dealii::Quadrature<2>(dealii::QGauss<2>(n_points_along));
      std::vector<PointOfPart<3>> points;
      for (unsigned int q = 0; q < rule.size(); ++q)
        {
          const mechanics::SurfaceFacet::Place s(rule.point(q)[0], rule.point(q)[1]);
          const auto                           normal = facet.normal(s);
          const auto                           N      = facet.shape(s);
          points.push_back({facet.point(s) + facet.rise(s, normal) * normal,
                            rule.weight(q) * facet.area_vector(s).norm(),
                            {N.begin(), N.begin() + facet.n_nodes}});
        }
      return points;
    }

    template <int dim>
    std::map<mechanics::NodeKey, double> defects_at_obstacle(const scene::Scene<dim>                         &scene,
                                                             const scene::ContactPair<dim>                   &pair,
                                                             const std::vector<mechanics::BoundaryPart<dim>> &slave,
                                                             const double                                     t)
    {
      const mesh::Kinematics<dim> kinematics(scene.plane_state);
      const auto                  gap_at = [&](const dealii::Point<dim> &x) {
        return contact_with(scene.obstacles[pair.obstacle], x, t).gap + pair.offset.value(x, t);
      };
      std::map<mechanics::NodeKey, std::pair<double, double>> sums; // of defects, of shape functions
      double                                                  all = 0;
      for (const auto &part : slave)
        {
          std::vector<double> at_nodes;
          for (unsigned int i = 0; i < part.n_nodes; ++i)
            at_nodes.push_back(gap_at(part.node(i)));
          for (const auto &point : points_of(part))
            {
              const double measure = point.measure * (kinematics.is_revolution() ? kinematics.measure(point.x) : 1.);
              double       defect  = -gap_at(point.x);
              for (unsigned int i = 0; i < part.n_nodes; ++i)
                defect += point.shape[i] * at_nodes[i];
              for (unsigned int i = 0; i < part.n_nodes; ++i)
                {
                  auto &[of_defects, of_shapes] = sums[part.keys[i]];
                  of_defects += measure * point.shape[i] * defect;
                  of_shapes += measure * point.shape[i];
                }
              all += measure;
            }
        }
      std::map<mechanics::NodeKey, double> result;
      for (const auto &[key, sum] : sums)
        result[key] = sum.second > least_share * all / sums.size() ? sum.first / sum.second : 0.;
      return result;
    }

    /// Node-to-node rows use the gaps at nodes, mortar rows would use mean gaps.
    template <int dim>
    std::map<mechanics::NodeKey, double> defects_of_bodies(const scene::Scene<dim>                         &scene,
                                                           const scene::ContactPair<dim>                   &pair,
                                                           const std::vector<MortarRow<dim>>               &rows,
                                                           const std::vector<mechanics::BoundaryPart<dim>> &slave,
                                                           const std::vector<mechanics::BoundaryPart<dim>> &master)
    {
      auto both = slave;
      both.insert(both.end(), master.begin(), master.end());
      const double                                                  far = extent(both);
      std::map<std::pair<mechanics::NodeKey, unsigned int>, double> means;
      for (const auto &row : mortar_rows(slave,
                                         master,
                                         {far, far},
                                         scene::ContactDiscretization::mortar,
                                         pair.name,
                                         mesh::Kinematics<dim>(scene.plane_state)))
        means[{row.slave, row.side}] = row.gap;
      std::map<mechanics::NodeKey, double> result;
      for (const auto &row : rows)
        if (const auto found = means.find({row.slave, row.side}); found != means.end())
          result[row.slave] = row.gap - found->second;
      return result;
    }
  } // namespace

  template <int dim>
  GapDefects<dim> gap_defects(const scene::Scene<dim>      &scene,
                              const mesh::Mesh<dim>        &mesh,
                              const mechanics::Spaces<dim> &spaces,
                              const double                  t)
  {
    GapDefects<dim> result;
    result.of_pairs.resize(scene.contacts.size());
    result.n_parts.resize(scene.contacts.size());
    const auto all      = mechanics::outlines(mesh, spaces, std::vector<bool>(scene.bodies.size(), true));
    const auto contacts = pair_bodies(scene, mesh, spaces);
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      {
        const auto &pair  = scene.contacts[k];
        const auto  slave = mechanics::parts_on(mesh, all, pair.slave);
        for (const auto &part : slave)
          for (unsigned int i = 0; i < part.n_nodes; ++i)
            ++result.n_parts[k][part.keys[i]];
        if (pair.gap) // prescribed gap, the same everywhere
          continue;
        result.of_pairs[k] =
          pair.master
            ? defects_of_bodies(scene, pair, contacts.rows[k], slave, mechanics::parts_on(mesh, all, *pair.master))
            : defects_at_obstacle(scene, pair, slave, t);
      }
    return result;
  }

  template GapDefects<2> gap_defects(const scene::Scene<2> &,
                                     const mesh::Mesh<2> &,
                                     const mechanics::Spaces<2> &,
                                     const double);
  template GapDefects<3> gap_defects(const scene::Scene<3> &,
                                     const mesh::Mesh<3> &,
                                     const mechanics::Spaces<3> &,
                                     const double);
} // namespace slipstick::interface
