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

    // If the covered parts exceed the facet by more than this fraction, some lie one behind the other.
    constexpr double overlapping = 1e-9;
    // Biorthogonal functions require a scaled mass matrix with eigenvalues above this (for whole facets of degree 2:
    // 0.25 or more).
    constexpr double least_eigenvalue = 1e-3;
    // Parameters of the symmetric quadrature (QWitherdenVincentSimplex) on the triangles of a part. Products of shape
    // functions are of fourth order on parallelograms and triangles, where the first rule, exact for fifth order, is
    // sufficient; on other quadrilaterals they are rational functions.
    constexpr unsigned int n_exact = 3, n_rational = 6;
    // The same for facets of degree 2, where products are of eighth order at most; the first rule is exact for ninth
    // order.
    constexpr unsigned int n_exact_quadratic = 5, n_rational_quadratic = 7;
    // Where a sliver is covered, means with the functions of the nodes beside it extrapolate; with more than this (about
    // 4 on whole facets, 4 h / w on a strip of width w) gaps would be those of the curvature along the sliver.
    constexpr double most_extrapolation = 400;
    // Slopes of gaps are those over at least this fraction of a facet, also where only a sliver of it is covered.
    constexpr double least_slope_length = 0.01;
    // A facet is fully covered if at most this fraction of it is missing.
    constexpr double whole_facet = 1e-9;
    // The same for bent facets, where polygons replace curved edges; small enough to exclude negative nodal areas.
    constexpr double whole_bent_facet = 1e-3;

    bool is_quadratic(const std::vector<Facet> &slave, const std::vector<Facet> &master)
    {
      return (!slave.empty() && slave.front().is_quadratic()) || (!master.empty() && master.front().is_quadratic());
    }

    bool is_affine(const Facet &facet)
    {
      const double twist =
        facet.n_corners() == 3 ? 0. : ((facet.node(0) - facet.node(1)) + (facet.node(2) - facet.node(3))).norm();
      return twist <= smallest_cover * facet.chord() && !facet.is_bent();
    }

    // Nodes are on their surface if their distance is at most this fraction of the facet.
    constexpr double on_surface = 1e-12;

    /// The shape functions of degree 1 of a facet as combinations of its own shape functions.
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
      SurfaceIntegrals(const std::vector<Facet> &slave_,
                       const std::vector<Facet> &master_,
                       const Reach              &reach,
                       const Corners            &corners)
        : pairing(slave_, master_, reach, corners)
        , slave(slave_)
        , master(master_)
        , exact(is_quadratic(slave_, master_) ? n_exact_quadratic : n_exact)
        , rational(is_quadratic(slave_, master_) ? n_rational_quadratic : n_rational)
        , parts_of_nodes(pairing.nodes().size())
      {
        for (const auto &facet : master)
          for (unsigned int i = 0; i < facet.n_nodes; ++i)
            nodes.master[facet.keys[i]] = facet.node(i);
        for (const auto *side : {&slave, &master})
          for (const auto &facet : *side)
            for (unsigned int i = 0; i < facet.n_nodes; ++i)
              if (facet.surface)
                curved[facet.keys[i]] = {&facet, i};
        for (const auto &node : pairing.nodes())
          nodes.slave[node.key] = node.position;
        for (unsigned int e = 0; e < slave.size(); ++e)
          integrate_facet(e);
      }

      std::vector<MortarRow<3>> rows() const
      {
        return rows_of_nodes(pairing.nodes(), parts_of_nodes, nodes);
      }

      /// Rise of the surface above the facets at a node, along the normal of a row: nonzero only for nodes between the
      /// corners of facets that could not be bent.
      double rise(const MortarRow<3> &row, const mechanics::NodeKey &key) const
      {
        const auto found = curved.find(key);
        if (found == curved.end())
          return 0;
        const auto &[facet, i] = found->second;
        const double distance  = facet->rise(facet->node_coordinate(i), row.normal);
        return std::abs(distance) > on_surface * facet->chord() ? distance : 0.;
      }

      const NodePlaces<3> &places_of_nodes() const
      {
        return nodes;
      }

    private:
      /// Integrals over one facet: <N_a N_b>, <N_a>, <N_a N_j(y)>, <N_a (rise of the master - rise of the slave)>.
      struct Moments
      {
        Eigen::MatrixXd                               mass;
        Eigen::VectorXd                               areas;
        std::map<mechanics::NodeKey, Eigen::VectorXd> master;
        Eigen::VectorXd                               rises;
        Facet::Tensor                                 normal; // direction of the rises
        double                                        neglected_sagitta = 0;
        bool                                          is_whole          = false; // the facet is fully covered
        std::map<unsigned int, double>                lost_beyond;               // of corners
      };

      Moments moments_of(const unsigned int e) const
      {
        const Facet               &facet = slave[e];
        const SurfacePairing::View view  = pairing.view(e);
        Moments                    sum{Eigen::MatrixXd::Zero(facet.n_nodes, facet.n_nodes),
                    Eigen::VectorXd::Zero(facet.n_nodes),
                    {},
                    Eigen::VectorXd::Zero(facet.n_nodes),
                    view.plane.normal,
                    0,
                    false,
                    {}};
        double                     covered = 0;
        for (const auto &part : view.parts)
          covered += area(part.polygon);
        const double full     = area(view.slave.outline());
        const bool   is_stack = covered > (1 + overlapping) * full;
        sum.is_whole          = covered > (1 - (facet.is_bent() ? whole_bent_facet : whole_facet)) * full;
        if (covered < smallest_cover * full)
          return sum;
        for (const auto &part : view.parts)
          {
            const Facet &to   = master[part.master];
            const auto  &rule = is_affine(facet) && is_affine(to) ? exact : rational;
            sum.neglected_sagitta =
              std::max(sum.neglected_sagitta, facet.surface.neglected_sagitta + to.surface.neglected_sagitta);
            integrate(part.polygon, rule, [&](const dealii::Point<2> &x, const double weight) {
              if (is_stack && view.is_hidden(part, x))
                return;
              const auto   s   = view.slave.place_at(x);
              const double dx  = weight / (facet.normal(s) * view.plane.normal);
              const auto   s_m = part.facet.place_at(x);
              const auto   N = facet.shape(s), N_m = to.shape(s_m);
              const auto   test = Eigen::Map<const Eigen::VectorXd>(N.data(), facet.n_nodes);
              sum.mass += dx * test * test.transpose();
              sum.areas += dx * test;
              if (facet.surface || to.surface)
                sum.rises += dx * (to.rise(s_m, view.plane.normal) - facet.rise(s, view.plane.normal)) * test;
              for (unsigned int j = 0; j < to.n_nodes; ++j)
                sum.master.emplace(to.keys[j], Eigen::VectorXd::Zero(facet.n_nodes)).first->second +=
                  dx * N_m[j] * test;
            });
          }
        if (!sum.is_whole)
          sum.lost_beyond = lost_beyond(facet, view);
        return sum;
      }

      /// For corners of a facet beyond its covered part: by how much the gap extrapolated from there is less than that
      /// at the nearest place that is covered.
      std::map<unsigned int, double> lost_beyond(const Facet &facet, const SurfacePairing::View &view) const
      {
        std::map<unsigned int, double> result;
        for (unsigned int i = 0; i < facet.n_corners(); ++i)
          {
            const dealii::Point<2>      corner  = view.plane.project(facet.node(i));
            double                      nearest = std::numeric_limits<double>::max();
            const SurfacePairing::Part *part    = nullptr;
            dealii::Point<2>            place;
            for (const SurfacePairing::Part &candidate : view.parts)
              {
                const dealii::Point<2> x = nearest_point(candidate.polygon, corner);
                if (const double apart = corner.distance(x); apart < nearest)
                  {
                    nearest = apart;
                    part    = &candidate;
                    place   = x;
                  }
              }
            if (nearest <= whole_facet * facet.chord())
              continue;
            const Facet &to  = master[part->master];
            const auto   gap = [&](const dealii::Point<2> &x) { // of the true surfaces
              return view.gap(*part, x) + to.rise(part->facet.place_at(x), view.plane.normal) -
                     facet.rise(view.slave.place_at(x), view.plane.normal);
            };
            const double length  = std::max(std::sqrt(area(part->polygon)), least_slope_length * facet.chord());
            const auto   inwards = (place - corner) * (length / nearest);
            const double rate    = (gap(place + inwards) - gap(place)) / inwards.norm();
            if (rate > 0)
              result[i] = rate * nearest;
          }
        return result;
      }

      /// Adds the contributions of slave facet e to the integrals of its nodes.
      void integrate_facet(const unsigned int e)
      {
        const Facet  &facet   = slave[e];
        const Moments moments = moments_of(e);
        if (moments.master.empty())
          return;
        const TestFunctions   phi     = test_functions(facet, moments);
        const Eigen::VectorXd rises   = phi.of_shapes * moments.rises;
        const auto            is_kept = [&](const Eigen::Index i) {
          return moments.is_whole || extrapolation(phi, moments, i) <= most_extrapolation;
        };
        double kept = 0, all = 0; // areas; the nodes that are left share that of the others
        for (Eigen::Index i = 0; i < phi.areas.size(); ++i)
          {
            all += phi.areas[i];
            kept += is_kept(i) ? phi.areas[i] : 0.;
          }
        for (unsigned int i = 0; i < phi.areas.size(); ++i)
          {
            if (!is_kept(i))
              continue;
            NodeIntegrals<3> node;
            node.rise              = rises[i] * moments.normal;
            node.neglected_sagitta = moments.neglected_sagitta;
            node.measure = node.length = phi.areas[i];
            node.whole                 = phi.whole[i];
            if (phi.is_biorthogonal)
              node.slave[facet.keys[i]] += phi.areas[i];
            else
              for (unsigned int k = 0; k < facet.n_nodes; ++k)
                node.slave[facet.keys[k]] += phi.slave(i, k);
            for (const auto &[key, sum] : moments.master)
              node.master[key] = phi.of_shapes.row(i).dot(sum);
            // otherwise a sloping master would reach a node beside it
            if (const auto lost = moments.lost_beyond.find(i); lost != moments.lost_beyond.end())
              node.rise += node.measure * lost->second * moments.normal;
            if (kept < all)
              node.scale(all / kept);
            parts_of_nodes[pairing.nodes_of(e)[i]].push_back(std::move(node));
          }
      }

      /// Test functions of one facet: phi = of_shapes N, their areas <phi_i>, <phi_i N_k>.
      struct TestFunctions
      {
        Eigen::MatrixXd of_shapes;
        Eigen::VectorXd areas;
        Eigen::VectorXd whole; // areas if the facet were fully covered
        Eigen::MatrixXd slave;
        bool            is_biorthogonal = false; // <phi_i N_k> is areas[i] for i = k and otherwise 0
      };

      /// Largest mean with function i over the largest value, at most.
      static double extrapolation(const TestFunctions &phi, const Moments &moments, const Eigen::Index i)
      {
        const Eigen::RowVectorXd of_shapes = phi.of_shapes.row(i);
        return std::sqrt((of_shapes * moments.mass).dot(of_shapes) * moments.areas.sum()) / std::abs(phi.areas[i]);
      }

      /// Corners of bent triangles of degree 2 have small areas of either sign: like those of plane ones they get no
      /// row.
      static void give_to_edges(Eigen::VectorXd &areas)
      {
        areas.tail(3).array() += areas.head(3).sum() / 3;
        areas.head(3).setZero();
      }

      /// For partly covered facets of degree 2 linear functions replace N: the nodal areas of N could be negative.
      static TestFunctions test_functions(const Facet &facet, const Moments &moments)
      {
        const bool    is_linear = facet.is_quadratic() && !moments.is_whole;
        TestFunctions phi;
        phi.of_shapes =
          is_linear ? linear_functions(facet) : Eigen::MatrixXd::Identity(facet.n_nodes, facet.n_nodes).eval();
        const Eigen::MatrixXd mass = phi.of_shapes * moments.mass * phi.of_shapes.transpose();
        phi.areas                  = phi.of_shapes * moments.areas;
        const auto whole           = facet.tributary_areas();
        phi.whole                  = phi.of_shapes * Eigen::Map<const Eigen::VectorXd>(whole.data(), facet.n_nodes);
        if (!is_linear && facet.n_nodes == 6 && facet.is_bent())
          give_to_edges(phi.areas);
        const bool is_independent = independence(mass) > least_eigenvalue;
        if (is_independent)
          phi.of_shapes = biorthogonal(mass, phi.areas) * phi.of_shapes;
        phi.slave           = phi.of_shapes * moments.mass;
        phi.is_biorthogonal = is_independent && !is_linear;
        return phi;
      }

      const SurfacePairing                      pairing;
      const std::vector<Facet>                 &slave, &master;
      const dealii::QWitherdenVincentSimplex<2> exact, rational;
      NodePlaces<3>                             nodes;

      std::vector<std::vector<NodeIntegrals<3>>> parts_of_nodes; // of every facet, by node of the pairing

      std::map<mechanics::NodeKey, std::pair<const Facet *, unsigned int>>
        curved; // a facet for every node on a curved surface
    };
  } // namespace

  std::vector<MortarRow<3>> mortar_rows(const std::vector<Facet>          &slave,
                                        const std::vector<Facet>          &master,
                                        const Reach                       &reach,
                                        const scene::ContactDiscretization discretization,
                                        const std::string                 &name,
                                        const mesh::Kinematics<3> &,
                                        const Corners &corners)
  {
    const SurfaceIntegrals integrals(slave, master, reach, corners);
    return matched(integrals.rows(),
                   integrals.places_of_nodes(),
                   discretization,
                   name,
                   [&](const MortarRow<3> &row, const mechanics::NodeKey &key) { return integrals.rise(row, key); });
  }
} // namespace slipstick::interface
