#include <slipstick/interface/mortar.h>
#include <slipstick/interface/node_matching.h>
#include <slipstick/interface/surface_pairing.h>

#include <deal.II/base/quadrature_lib.h>

#include <Eigen/Dense>

#include <cmath>

namespace slipstick::interface
{
  namespace
  {
    using Facet  = mechanics::SurfaceFacet;
    using Tensor = dealii::Tensor<1, 3>;

    // Facets and nodes are left out if no more than this fraction of them is covered.
    constexpr double smallest_cover = 1e-10;
    // Parts that cover more than the facet by this fraction of it lie one behind the other.
    constexpr double overlapping = 1e-9;
    // Biorthogonal functions need a scaled mass matrix whose eigenvalues (at most 4) are above this.
    constexpr double least_eigenvalue = 1e-3;
    // Symmetric rules on the triangles of a part. Products of shape functions are of fourth order on parallelograms and
    // triangles, where five is exact; on other quadrilaterals they are rational functions.
    constexpr unsigned int n_exact = 3, n_rational = 6;

    bool is_affine(const Facet &facet)
    {
      const double twist =
        facet.n_nodes == 3 ? 0. : ((facet.node(0) - facet.node(1)) + (facet.node(2) - facet.node(3))).norm();
      return twist <= smallest_cover * facet.chord();
    }

    /// The integrals of all slave facets, by node.
    class SurfaceIntegrals
    {
    public:
      SurfaceIntegrals(const std::vector<Facet> &slave_, const std::vector<Facet> &master_, const Reach &reach)
        : pairing(slave_, master_, reach)
        , slave(slave_)
        , master(master_)
        , exact(n_exact)
        , rational(n_rational)
        , sums(pairing.nodes().size())
      {
        for (const auto &facet : master)
          for (unsigned int i = 0; i < facet.n_nodes; ++i)
            nodes.master[facet.keys[i]] = facet.node(i);
        for (const auto &node : pairing.nodes())
          nodes.slave[node.key] = node.position;
        for (unsigned int e = 0; e < slave.size(); ++e)
          integrate_facet(e);
      }

      std::vector<MortarRow<3>> rows() const
      {
        std::vector<MortarRow<3>> result;
        for (unsigned int i = 0; i < sums.size(); ++i)
          if (sums[i].area > smallest_cover * pairing.nodes()[i].covered)
            result.push_back(row_of(pairing.nodes()[i], sums[i]));
        return result;
      }

      const NodePlaces<3> &places_of_nodes() const
      {
        return nodes;
      }

    private:
      struct Sums
      {
        double                               area = 0;      // D_i
        std::map<mechanics::NodeKey, double> slave, master; // D_ik, M_ij
      };

      /// Of one facet, with T = N: <T_a T_b>, <T_a>, <T_a N_j(y)>.
      struct Moments
      {
        Eigen::MatrixXd                               mass;
        Eigen::VectorXd                               areas;
        std::map<mechanics::NodeKey, Eigen::VectorXd> master;
      };

      Moments moments_of(const unsigned int e) const
      {
        const Facet &facet = slave[e];
        const auto   parts = pairing.parts(e);
        const auto   plane = pairing.plane(e);
        Moments      sum{Eigen::MatrixXd::Zero(facet.n_nodes, facet.n_nodes), Eigen::VectorXd::Zero(facet.n_nodes), {}};
        double       covered = 0;
        for (const auto &part : parts)
          covered += area(part.polygon);
        const double full     = area(plane.project(facet));
        const bool   is_stack = covered > (1 + overlapping) * full;
        if (covered < smallest_cover * full)
          return sum;
        for (const auto &part : parts)
          {
            const Facet &to        = master[part.master];
            const auto  &rule      = is_affine(facet) && is_affine(to) ? exact : rational;
            const auto   is_hidden = [&](const dealii::Point<2> &x) { // is another master facet nearer there?
              const double own = std::abs(pairing.gap(e, part.master, plane, x));
              for (const auto &other : parts)
                if (&other != &part && contains(other.polygon, x) &&
                    std::abs(pairing.gap(e, other.master, plane, x)) < own)
                  return true;
              return false;
            };
            integrate(part.polygon, rule, [&](const dealii::Point<2> &x, const double weight) {
              if (is_stack && is_hidden(x))
                return;
              const auto   s  = plane.place_on(facet, x);
              const double dx = weight / (facet.normal(s) * plane.normal);
              const auto   N = facet.shape(s), N_m = to.shape(plane.place_on(to, x));
              const auto   test = Eigen::Map<const Eigen::VectorXd>(N.data(), facet.n_nodes);
              sum.mass += dx * test * test.transpose();
              sum.areas += dx * test;
              for (unsigned int j = 0; j < to.n_nodes; ++j)
                sum.master.emplace(to.keys[j], Eigen::VectorXd::Zero(facet.n_nodes)).first->second +=
                  dx * N_m[j] * test;
            });
          }
        return sum;
      }

      /// Adds the contributions of slave facet e to the integrals of its nodes.
      void integrate_facet(const unsigned int e)
      {
        const Facet  &facet   = slave[e];
        const Moments moments = moments_of(e);
        if (moments.master.empty())
          return;
        // phi = dual T, scaled: on a small part the entries are of very different size
        const Eigen::VectorXd scale  = moments.mass.diagonal().cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = scale.asDiagonal() * moments.mass * scale.asDiagonal();
        const bool            is_biorthogonal =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues()[0] > least_eigenvalue;
        Eigen::MatrixXd dual = Eigen::MatrixXd::Identity(facet.n_nodes, facet.n_nodes);
        if (is_biorthogonal)
          dual = moments.areas.asDiagonal() * (scale.asDiagonal() * scaled.inverse() * scale.asDiagonal()).eval();
        for (unsigned int i = 0; i < facet.n_nodes; ++i)
          {
            Sums &node = sums[pairing.nodes_of(e)[i]];
            node.area += moments.areas[i];
            if (is_biorthogonal)
              node.slave[facet.keys[i]] += moments.areas[i];
            else
              for (unsigned int k = 0; k < facet.n_nodes; ++k)
                node.slave[facet.keys[k]] += moments.mass(i, k);
          }
        for (const auto &[key, sum] : moments.master)
          {
            const Eigen::VectorXd M = dual * sum;
            for (unsigned int i = 0; i < facet.n_nodes; ++i)
              sums[pairing.nodes_of(e)[i]].master[key] += M[i];
          }
      }

      MortarRow<3> row_of(const SurfacePairing::Node &node, const Sums &sum) const
      {
        MortarRow<3> row;
        row.slave          = node.key;
        row.side           = node.side;
        row.position       = node.position;
        row.normal         = node.normal;
        row.measure        = sum.area;
        row.length         = sum.area;
        row.full_measure   = node.covered;
        row.full_length    = node.covered;
        row.slave_weights  = normalised(sum.slave, sum.area);
        row.master_weights = normalised(sum.master, sum.area);
        nodes.measure(row);
        return row;
      }

      const SurfacePairing                      pairing;
      const std::vector<Facet>                 &slave, &master;
      const dealii::QWitherdenVincentSimplex<2> exact, rational;
      std::vector<Sums>                         sums; // by node of the pairing
      NodePlaces<3>                             nodes;
    };

    /// Nearest point of a triangle (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
    dealii::Point<3> nearest_on_triangle(const std::array<dealii::Point<3>, 3> &corner, const dealii::Point<3> &x)
    {
      const Tensor a = corner[1] - corner[0], b = corner[2] - corner[0], n = cross_product_3d(a, b), to = x - corner[0];
      const double beta  = cross_product_3d(to, b) * n / n.norm_square(),
                   gamma = cross_product_3d(a, to) * n / n.norm_square();
      if (beta >= 0 && gamma >= 0 && beta + gamma <= 1)
        return corner[0] + beta * a + gamma * b;
      dealii::Point<3> best;
      double           least = std::numeric_limits<double>::max();
      for (unsigned int i = 0; i < 3; ++i)
        {
          const Tensor           along = corner[(i + 1) % 3] - corner[i];
          const double           s     = std::min(1., std::max(0., (x - corner[i]) * along / along.norm_square()));
          const dealii::Point<3> y     = corner[i] + s * along;
          if (x.distance(y) < least)
            {
              least = x.distance(y);
              best  = y;
            }
        }
      return best;
    }

    double distance_to(const Facet &facet, const dealii::Point<3> &x)
    {
      double least = x.distance(nearest_on_triangle({{facet.node(0), facet.node(1), facet.node(2)}}, x));
      if (facet.n_nodes == 4)
        least = std::min(least, x.distance(nearest_on_triangle({{facet.node(0), facet.node(2), facet.node(3)}}, x)));
      return least;
    }

    void one_way(const std::vector<Facet> &a, const std::vector<Facet> &b, double &smallest)
    {
      const auto tree = facet_tree(b);
      for (const auto &facet : a)
        for (unsigned int i = 0; i <= facet.n_nodes; ++i)
          {
            const auto s = i < facet.n_nodes ? facet.node_coordinate(i) : facet.middle_place();
            const auto x = facet.point(s);
            const auto n = facet.normal(s);
            tree.for_each_by_distance(
              x,
              [&] { return smallest; },
              [&](const unsigned int m) {
                if (b[m].normal(b[m].middle_place()) * n < facing_cosine)
                  smallest = std::min(smallest, distance_to(b[m], x));
                return true;
              });
          }
    }
  } // namespace

  std::vector<MortarRow<3>> mortar_rows(const std::vector<Facet>          &slave,
                                        const std::vector<Facet>          &master,
                                        const Reach                       &reach,
                                        const scene::ContactDiscretization discretization,
                                        const std::string                 &name,
                                        const mesh::Kinematics<3> &)
  {
    const SurfaceIntegrals integrals(slave, master, reach);
    return matched(integrals.rows(),
                   integrals.places_of_nodes(),
                   discretization,
                   name,
                   [](const MortarRow<3> &, const mechanics::NodeKey &) { return 0.; });
  }

  std::optional<double> facing_distance(const std::vector<Facet> &a, const std::vector<Facet> &b, const double bound)
  {
    double smallest = bound;
    one_way(a, b, smallest);
    one_way(b, a, smallest);
    if (smallest < bound)
      return smallest;
    return {};
  }
} // namespace slipstick::interface
