#include <slipstick/interface/corners.h>
#include <slipstick/interface/curve_pairing.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/interface/surface_pairing.h>
#include <slipstick/interface/transfer_defect.h>

#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

namespace slipstick::interface
{
  namespace
  {
    // Parts are covered as a whole if at most this fraction is missing, ...
    constexpr double missing = 1e-9;
    // ... and of bent facets, where polygons replace curved edges, this fraction (as in mortar integrals).
    constexpr double missing_if_bent = 1e-3;
    // Gauss points per segment of an edge; parameter of the rule on triangles of facets (as in mortar integrals).
    constexpr unsigned int n_on_segment = 5, n_on_triangle = 5;
    // Tractions are resolved up to this many degrees beyond that of the elements. Of higher degrees nodal tractions say
    // nothing where the slave is finer: those of a stiff body alternate from node to node (doc/decisions/0150).
    constexpr unsigned int n_degrees = 1;
    // Defects below this part of the squared tractions are rounding.
    constexpr double least_defect = 1e-12;

    /// A product of powers of the local coordinates.
    struct Monomial
    {
      unsigned int first, second;
      unsigned int degree; // that of the elements which contain it

      double value(const double s, const double t) const
      {
        return std::pow(2 * s - 1, first) * std::pow(2 * t - 1, second);
      }
    };

    unsigned int degree_of(const mechanics::SurfaceEdge<2> &edge)
    {
      return edge.n_nodes - 1;
    }

    unsigned int degree_of(const mechanics::SurfaceFacet &facet)
    {
      return facet.is_quadratic() ? 2 : 1;
    }

    /// Those of the elements of a degree and of @p n_degrees more, by degree.
    std::vector<Monomial> monomials(const mechanics::SurfaceEdge<2> &edge)
    {
      std::vector<Monomial> result;
      for (unsigned int a = 0; a <= degree_of(edge) + n_degrees; ++a)
        result.push_back({a, 0, a});
      return result;
    }

    std::vector<Monomial> monomials(const mechanics::SurfaceFacet &facet)
    {
      const unsigned int    most        = degree_of(facet) + n_degrees;
      const bool            is_triangle = facet.n_corners() == 3;
      std::vector<Monomial> result;
      for (unsigned int a = 0; a <= most; ++a)
        for (unsigned int b = 0; b <= (is_triangle ? most - a : most); ++b)
          result.push_back({a, b, is_triangle ? a + b : std::max(a, b)});
      std::stable_sort(result.begin(), result.end(), [](const auto &a, const auto &b) { return a.degree < b.degree; });
      return result;
    }

    /// Calls f(measure, s, t) for points of a part; exact for products of two of its monomials if it is not bent.
    template <class F>
    void for_points(const mechanics::SurfaceEdge<2> &edge, const mesh::Kinematics<2> &kinematics, const F &f)
    {
      const dealii::QGauss<1> rule(degree_of(edge) + n_degrees + 1);
      for (unsigned int q = 0; q < rule.size(); ++q)
        {
          const double s = rule.point(q)[0];
          f(rule.weight(q) * edge.tangent(s).norm() * kinematics.measure(edge.point(s)), s, 0.5);
        }
    }

    template <class F>
    void for_points(const mechanics::SurfaceFacet &facet, const mesh::Kinematics<3> &, const F &f)
    {
      const unsigned int    n = degree_of(facet) + n_degrees + 1;
      dealii::Quadrature<2> rule =
        facet.n_corners() == 3 ? dealii::Quadrature<2>(dealii::QDuffy(n + 1, 1.)) : dealii::QGauss<2>(n);
      for (unsigned int q = 0; q < rule.size(); ++q)
        {
          const mechanics::SurfaceFacet::Place s(rule.point(q)[0], rule.point(q)[1]);
          f(rule.weight(q) * facet.area_vector(s).norm(), s[0], s[1]);
        }
    }

    /// Integrals of the products of tractions on an edge or facet with polynomials.
    template <int dim>
    class LoadedPart
    {
    public:
      explicit LoadedPart(const mechanics::BoundaryPart<dim> &part_)
        : part(part_)
      {}

      /// @param dx measure of a point. @param keys, N nodes of the slave, of which n count, and their functions there.
      /// @param s, t local coordinates on this part
      template <class Keys, class Functions>
      void add(const double       dx,
               const Keys        &keys,
               const unsigned int n,
               const Functions   &N,
               const double       s,
               const double       t)
      {
        if (powers.empty())
          powers = monomials(part);
        Eigen::VectorXd values(powers.size());
        for (unsigned int k = 0; k < powers.size(); ++k)
          values[k] = powers[k].value(s, t);
        for (unsigned int i = 0; i < n; ++i)
          moments.emplace(keys[i], Eigen::VectorXd::Zero(values.size())).first->second += dx * N[i] * values;
      }

      /// Appends the defect, if there is one.
      void append_defect(const mesh::Kinematics<dim> &kinematics, std::vector<TransferDefect<dim>> &result) const
      {
        if (moments.empty())
          return;
        const auto      n    = static_cast<Eigen::Index>(powers.size());
        Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
        for_points(part, kinematics, [&](const double dx, const double s, const double t) {
          Eigen::VectorXd values(n);
          for (Eigen::Index k = 0; k < n; ++k)
            values[k] = powers[k].value(s, t);
          mass += dx * values * values.transpose();
        });
        TransferDefect<dim> defect{part, {}, {}};
        Eigen::MatrixXd     of_nodes(n, moments.size());
        for (const auto &[node, of_node] : moments)
          {
            of_nodes.col(defect.nodes.size()) = of_node;
            defect.nodes.push_back(node);
          }
        // coefficients of orthonormal polynomials, by degree
        Eigen::MatrixXd coefficients = mass.llt().matrixL().solve(of_nodes);
        const double    all          = coefficients.squaredNorm();
        for (Eigen::Index k = 0; k < n; ++k)
          coefficients.row(k) *= powers[k].degree > degree_of(part) ? 1 / std::sqrt(powers[k].degree) : 0.;
        defect.rest = coefficients.transpose() * coefficients;
        if (defect.rest.trace() > least_defect * all)
          result.push_back(std::move(defect));
      }

    private:
      mechanics::BoundaryPart<dim>                  part;
      std::vector<Monomial>                         powers;
      std::map<mechanics::NodeKey, Eigen::VectorXd> moments; // of the functions of the slave's nodes
    };

    template <int dim>
    struct LoadedSides
    {
      using Parts = std::vector<mechanics::BoundaryPart<dim>>;

      LoadedSides(Parts slave_, Parts master_)
        : slave(std::move(slave_))
        , master(std::move(master_))
        , of_slave(slave.begin(), slave.end())
        , of_master(master.begin(), master.end())
      {}

      Parts                        slave, master;
      std::vector<LoadedPart<dim>> of_slave, of_master;
    };

    void load_sides(const CurvePairing &pairing, const mesh::Kinematics<2> &kinematics, LoadedSides<2> &sides)
    {
      const dealii::QGauss<1> gauss(n_on_segment);
      for (unsigned int e = 0; e < sides.slave.size(); ++e)
        {
          const auto &edge    = sides.slave[e];
          const auto  parts   = pairing.segments(e);
          double      covered = 0;
          for (const auto &part : parts)
            covered += part.to - part.from;
          const bool is_whole = covered > 1 - missing; // otherwise tractions are linear (mortar.h)
          for (const auto &part : parts)
            for (unsigned int q = 0; q < gauss.size(); ++q)
              {
                const double s = part.from + (part.to - part.from) * gauss.point(q)[0];
                const double dx =
                  gauss.weight(q) * (part.to - part.from) * edge.tangent(s).norm() * kinematics.measure(edge.point(s));
                const auto y = pairing.hit(e, s, part.master);
                if (!y) // rounding moved the point beyond the end of the segment
                  continue;
                const auto N = edge.shape(s);
                const auto T = is_whole ? N : std::array<double, 3>{{1 - s, s, 0}};
                const auto n = is_whole ? edge.n_nodes : 2;
                sides.of_slave[e].add(dx, edge.keys, n, T, s, 0.5);
                sides.of_master[part.master].add(dx, edge.keys, n, T, y->s, 0.5);
              }
        }
    }

    void load_sides(const SurfacePairing &pairing, const mesh::Kinematics<3> &, LoadedSides<3> &sides)
    {
      const dealii::QWitherdenVincentSimplex<2> rule(n_on_triangle);
      for (unsigned int e = 0; e < sides.slave.size(); ++e)
        {
          const auto &facet   = sides.slave[e];
          const auto  view    = pairing.view(e);
          double      covered = 0;
          for (const auto &part : view.parts)
            covered += area(part.polygon);
          const double full     = area(view.slave.outline());
          const bool   is_whole = covered > (1 - (facet.is_bent() ? missing_if_bent : missing)) * full;
          const bool   is_stack = covered > (1 + missing) * full;
          for (const auto &part : view.parts)
            integrate(part.polygon, rule, [&](const dealii::Point<2> &x, const double weight) {
              if (is_stack && view.is_hidden(part, x))
                return;
              const auto   s   = view.slave.place_at(x);
              const double dx  = weight / (facet.normal(s) * view.plane.normal);
              const auto   N   = facet.shape(s);
              const auto   T   = is_whole ? N : facet.shape_of_corners(s);
              const auto   n   = is_whole ? facet.n_nodes : facet.n_corners();
              const auto   s_m = part.facet.place_at(x);
              sides.of_slave[e].add(dx, facet.keys, n, T, s[0], s[1]);
              sides.of_master[part.master].add(dx, facet.keys, n, T, s_m[0], s_m[1]);
            });
        }
    }
  } // namespace

  template <int dim>
  std::vector<TransferDefect<dim>> transfer_defects(const scene::Scene<dim>                         &scene,
                                                    const mesh::Mesh<dim>                           &mesh,
                                                    const scene::ContactPair<dim>                   &pair,
                                                    const std::vector<mechanics::BoundaryPart<dim>> &all)
  {
    using Pairing = std::conditional_t<dim == 2, CurvePairing, SurfacePairing>;
    LoadedSides<dim> sides(mechanics::parts_on(mesh, all, pair.slave), mechanics::parts_on(mesh, all, *pair.master));
    const auto       outline_of = [&all](const unsigned int body) {
      std::vector<mechanics::BoundaryPart<dim>> outline;
      std::copy_if(all.begin(), all.end(), std::back_inserter(outline), [&](const auto &e) { return e.body == body; });
      return outline;
    };
    Corners corners = corners_of(scene, mesh, pair.slave, sides.slave, outline_of(pair.slave.body));
    corners.merge(corners_of(scene, mesh, *pair.master, sides.master, outline_of(pair.master->body)));
    auto both = sides.slave;
    both.insert(both.end(), sides.master.begin(), sides.master.end());
    const double                far = extent(both);
    const mesh::Kinematics<dim> kinematics(scene.plane_state);
    if constexpr (dim == 2)
      load_sides(Pairing(sides.slave, sides.master, Reach{far, far}, kinematics, corners), kinematics, sides);
    else
      load_sides(Pairing(sides.slave, sides.master, Reach{far, far}, corners), kinematics, sides);
    std::vector<TransferDefect<dim>> result;
    for (const auto *loaded : {&sides.of_slave, &sides.of_master})
      for (const LoadedPart<dim> &part : *loaded)
        part.append_defect(kinematics, result);
    return result;
  }

  template std::vector<TransferDefect<2>> transfer_defects(const scene::Scene<2> &,
                                                           const mesh::Mesh<2> &,
                                                           const scene::ContactPair<2> &,
                                                           const std::vector<mechanics::BoundaryPart<2>> &);
  template std::vector<TransferDefect<3>> transfer_defects(const scene::Scene<3> &,
                                                           const mesh::Mesh<3> &,
                                                           const scene::ContactPair<3> &,
                                                           const std::vector<mechanics::BoundaryPart<3>> &);
} // namespace slipstick::interface
