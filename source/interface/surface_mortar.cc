#include <slipstick/interface/biorthogonal.h>
#include <slipstick/interface/mortar.h>
#include <slipstick/interface/node_matching.h>
#include <slipstick/interface/surface_pairing.h>

#include <deal.II/base/quadrature_lib.h>

#include <cmath>

namespace slipstick::interface
{
  namespace
  {
    using Facet = mechanics::SurfaceFacet;

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

    /// Is another master facet nearer at x? Of several at one distance the first counts.
    bool is_hidden(const SurfacePairing::View &view, const SurfacePairing::Part &part, const dealii::Point<2> &x)
    {
      const double gap = std::abs(view.gap(part, x));
      for (const auto &other : view.parts)
        if (&other != &part && contains(other.polygon, x))
          if (const double to = std::abs(view.gap(other, x)); to < gap || (to == gap && other.master < part.master))
            return true;
      return false;
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
          if (has_row(pairing.nodes()[i], sums[i]))
            result.push_back(row_of(pairing.nodes()[i], sums[i], nodes));
        return result;
      }

      const NodePlaces<3> &places_of_nodes() const
      {
        return nodes;
      }

    private:
      /// Of one facet, with T = N: <T_a T_b>, <T_a>, <T_a N_j(y)>.
      struct Moments
      {
        Eigen::MatrixXd                               mass;
        Eigen::VectorXd                               areas;
        std::map<mechanics::NodeKey, Eigen::VectorXd> master;
      };

      Moments moments_of(const unsigned int e) const
      {
        const Facet               &facet = slave[e];
        const SurfacePairing::View view  = pairing.view(e);
        Moments sum{Eigen::MatrixXd::Zero(facet.n_nodes, facet.n_nodes), Eigen::VectorXd::Zero(facet.n_nodes), {}};
        double  covered = 0;
        for (const auto &part : view.parts)
          covered += area(part.polygon);
        const double full     = area(view.slave.outline());
        const bool   is_stack = covered > (1 + overlapping) * full;
        if (covered < smallest_cover * full)
          return sum;
        for (const auto &part : view.parts)
          {
            const Facet &to   = master[part.master];
            const auto  &rule = is_affine(facet) && is_affine(to) ? exact : rational;
            integrate(part.polygon, rule, [&](const dealii::Point<2> &x, const double weight) {
              if (is_stack && is_hidden(view, part, x))
                return;
              const auto   s  = view.slave.place_at(x);
              const double dx = weight / (facet.normal(s) * view.plane.normal);
              const auto   N = facet.shape(s), N_m = to.shape(part.facet.place_at(x));
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
        const bool            is_biorthogonal = independence(moments.mass) > least_eigenvalue;
        const Eigen::MatrixXd dual            = is_biorthogonal ? biorthogonal(moments.mass, moments.areas)
                                                                : Eigen::MatrixXd::Identity(facet.n_nodes, facet.n_nodes);
        for (unsigned int i = 0; i < facet.n_nodes; ++i)
          {
            NodeIntegrals &node = sums[pairing.nodes_of(e)[i]];
            node.measure += moments.areas[i];
            node.length += moments.areas[i];
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

      const SurfacePairing                      pairing;
      const std::vector<Facet>                 &slave, &master;
      const dealii::QWitherdenVincentSimplex<2> exact, rational;
      std::vector<NodeIntegrals>                sums; // by node of the pairing
      NodePlaces<3>                             nodes;
    };
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
} // namespace slipstick::interface
