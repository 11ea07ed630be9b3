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
    // The same for facets of degree 2, where products are of eighth order at most and the rule of ninth.
    constexpr unsigned int n_exact_quadratic = 5, n_rational_quadratic = 7;
    // A facet is covered as a whole if no more than this fraction of it is missing.
    constexpr double whole_facet = 1e-9;

    Eigen::VectorXd scale_of(const Eigen::MatrixXd &mass)
    {
      return mass.diagonal().cwiseSqrt().cwiseInverse();
    }
    double independence(const Eigen::MatrixXd &mass)
    {
      const Eigen::VectorXd scale  = scale_of(mass);
      const Eigen::MatrixXd scaled = scale.asDiagonal() * mass * scale.asDiagonal();
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues()[0];
    }
    Eigen::MatrixXd biorthogonal(const Eigen::MatrixXd &mass, const Eigen::VectorXd &measures)
    {
      const Eigen::VectorXd scale  = scale_of(mass);
      const Eigen::MatrixXd scaled = scale.asDiagonal() * mass * scale.asDiagonal();
      return measures.asDiagonal() * (scale.asDiagonal() * scaled.inverse() * scale.asDiagonal()).eval();
    }
    bool is_affine(const Facet &facet)
    {
      const double twist =
        facet.n_corners() == 3 ? 0. : ((facet.node(0) - facet.node(1)) + (facet.node(2) - facet.node(3))).norm();
      return twist <= smallest_cover * facet.chord();
    }

    bool is_quadratic(const std::vector<Facet> &slave, const std::vector<Facet> &master)
    {
      return (!slave.empty() && slave.front().is_quadratic()) || (!master.empty() && master.front().is_quadratic());
    }

    /// The values of the shape functions of degree 1 of a facet at its nodes: with them they are combinations of those of degree 2.
    Eigen::MatrixXd linear_functions(const Facet &facet)
    {
      Eigen::MatrixXd at_nodes(facet.n_corners(), facet.n_nodes);
      for (unsigned int k = 0; k < facet.n_nodes; ++k)
        {
          const auto N = facet.shape_of_corners(facet.node_coordinate(k));
          for (unsigned int i = 0; i < facet.n_corners(); ++i)
            at_nodes(i, k) = N[i];
        }
      return at_nodes;
    }

    /// The integrals of all slave facets, by node.
    class SurfaceIntegrals
    {
    public:
      SurfaceIntegrals(const std::vector<Facet> &slave_, const std::vector<Facet> &master_, const Reach &reach)
        : pairing(slave_, master_, reach)
        , slave(slave_)
        , master(master_)
        , exact(is_quadratic(slave_, master_) ? n_exact_quadratic : n_exact)
        , rational(is_quadratic(slave_, master_) ? n_rational_quadratic : n_rational)
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
          if (sums[i].area >
              smallest_cover * std::max(pairing.nodes()[i].covered, std::pow(pairing.nodes()[i].size, 2)))
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
        bool                                          is_whole = false; // is all of the facet covered?
      };

      Moments moments_of(const unsigned int e) const
      {
        const Facet &facet = slave[e];
        const auto   parts = pairing.parts(e);
        const auto   plane = pairing.plane(e);
        Moments      sum{Eigen::MatrixXd::Zero(facet.n_nodes, facet.n_nodes),
                    Eigen::VectorXd::Zero(facet.n_nodes),
                    {},
                    false};
        double       covered = 0;
        for (const auto &part : parts)
          covered += area(part.polygon);
        const double full     = area(plane.project(facet));
        const bool   is_stack = covered > (1 + overlapping) * full;
        sum.is_whole          = covered > (1 - whole_facet) * full;
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
        // phi = functions N; of degree 2 the functions of degree 1 take the place of N where the facet is covered in part
        const bool      is_linear = facet.is_quadratic() && !moments.is_whole;
        Eigen::MatrixXd functions =
          is_linear ? linear_functions(facet) : Eigen::MatrixXd::Identity(facet.n_nodes, facet.n_nodes);
        const Eigen::MatrixXd mass            = functions * moments.mass * functions.transpose();
        const Eigen::VectorXd areas           = functions * moments.areas;
        const bool            is_biorthogonal = independence(mass) > least_eigenvalue;
        if (is_biorthogonal)
          functions = biorthogonal(mass, areas) * functions;
        const Eigen::MatrixXd D = functions * moments.mass;
        for (unsigned int i = 0; i < functions.rows(); ++i)
          {
            Sums &node = sums[pairing.nodes_of(e)[i]];
            node.area += areas[i];
            for (unsigned int k = 0; k < facet.n_nodes; ++k)
              if (is_linear || !is_biorthogonal || i == k)
                node.slave[facet.keys[k]] += is_linear || !is_biorthogonal ? D(i, k) : areas[i];
          }
        for (const auto &[key, sum] : moments.master)
          {
            const Eigen::VectorXd M = functions * sum;
            for (unsigned int i = 0; i < M.size(); ++i)
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
      if (facet.n_corners() == 4)
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
