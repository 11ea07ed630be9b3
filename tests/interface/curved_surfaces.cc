// Gaps, weights and areas between facets that represent curved surfaces.
#include <slipstick/interface/mortar.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

namespace
{
  using namespace slipstick;
  using scene::ContactDiscretization;

  struct CurvedSurface
  {
    using Facet  = mechanics::SurfaceFacet;
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;
    using Place  = std::function<Point(double, double)>;

    static constexpr std::uint64_t of_master = 100000;
    static constexpr double        half      = 0.4; // of the angles [rad]

    /// Top of a ball around the origin, or of a cylinder around z; s, t are counter-clockwise as seen from outside.
    static Place on(const double radius, const bool is_ball)
    {
      return [=](const double s, const double t) {
        const double a = std::tan(half * (2 * s - 1)), b = std::tan(half * (2 * t - 1));
        if (is_ball)
          return Point(radius / std::sqrt(1 + a * a + b * b) * Tensor({b, 1., a}));
        return Point(radius * std::sin(half * (2 * t - 1)),
                     radius * std::cos(half * (2 * t - 1)),
                     radius * half * (2 * s - 1));
      };
    }

    /// n x m quadrilaterals, or twice as many triangles; nodes of degree 2 are on the surface, too.
    static std::vector<Facet> facets(const unsigned int       n,
                                     const unsigned int       m,
                                     const Place             &place,
                                     const bool               is_reversed,
                                     const unsigned int       degree,
                                     const bool               is_split,
                                     const std::uint64_t      first_key,
                                     const mesh::FaceSurface &surface)
    {
      using Corner = std::array<unsigned int, 2>; // on a lattice twice as fine
      std::vector<Facet> result;
      const auto         add = [&](std::vector<Corner> corners) {
        if (is_reversed)
          std::reverse(corners.begin(), corners.end());
        auto nodes = corners;
        for (unsigned int k = 0; degree == 2 && k < corners.size(); ++k)
          {
            const auto &p = corners[k], &q = corners[(k + 1) % corners.size()];
            nodes.push_back({{(p[0] + q[0]) / 2, (p[1] + q[1]) / 2}});
          }
        if (degree == 2 && corners.size() == 4)
          nodes.push_back({{(corners[0][0] + corners[2][0]) / 2, (corners[0][1] + corners[2][1]) / 2}});
        Facet facet;
        facet.n_nodes = nodes.size();
        facet.surface = surface;
        for (unsigned int i = 0; i < nodes.size(); ++i)
          {
            const Point         x   = place(nodes[i][0] / (2. * n), nodes[i][1] / (2. * m));
            const std::uint64_t key = first_key + nodes[i][0] + (2 * n + 1) * nodes[i][1];
            facet.keys[i]           = {{key, key}};
            facet.at[i]             = {{x[0], x[1], x[2]}};
          }
        result.push_back(facet);
      };
      for (unsigned int b = 0; b < 2 * m; b += 2)
        for (unsigned int a = 0; a < 2 * n; a += 2)
          if (is_split)
            {
              add({{{a, b}}, {{a + 2, b}}, {{a + 2, b + 2}}});
              add({{{a, b}}, {{a + 2, b + 2}}, {{a, b + 2}}});
            }
          else
            add({{{a, b}}, {{a + 2, b}}, {{a + 2, b + 2}}, {{a, b + 2}}});
      return result;
    }

    static mesh::FaceSurface surface(const double radius, const bool is_ball)
    {
      return is_ball ? mesh::FaceSurface::ball(Point(), radius)
                     : mesh::FaceSurface::cylinder(Point(), Tensor({0, 0, 1}), radius);
    }

    /// Largest deviation of the gap of the rows from a value.
    static double off(const std::vector<interface::MortarRow<3>> &rows, const double gap)
    {
      double largest = rows.empty() ? 1e10 : 0;
      for (const auto &row : rows)
        largest = std::max(largest, std::abs(row.gap - gap));
      return largest;
    }
  };
} // namespace

TEST(CurvedSurface, gaps_of_balls_and_cylinders_are_those_of_the_surfaces)
{
  using S = CurvedSurface;
  for (const bool is_ball : {true, false})
    for (const unsigned int degree : {1, 2})
      for (const bool is_split : {false, true})
        for (const double radius : {10., 10.05})
          {
            const auto rows = [&](const bool is_curved) {
              const auto none = mesh::FaceSurface();
              return interface::mortar_rows(S::facets(5,
                                                      4,
                                                      S::on(10, is_ball),
                                                      false,
                                                      degree,
                                                      is_split,
                                                      0,
                                                      is_curved ? S::surface(10, is_ball) : none),
                                            S::facets(6,
                                                      5,
                                                      S::on(radius, is_ball),
                                                      true,
                                                      degree,
                                                      false,
                                                      S::of_master,
                                                      is_curved ? S::surface(radius, is_ball) : none),
                                            {1., 1.},
                                            ContactDiscretization::mortar,
                                            "pair");
            };
            EXPECT_LT(S::off(rows(true), radius - 10), radius == 10 ? 1e-10 : 0.02 * 0.05)
              << is_ball << degree << is_split << radius;
            EXPECT_GT(S::off(rows(false), radius - 10), degree == 1 ? 0.01 : 1e-5);
          }
}

TEST(CurvedSurface, areas_of_bent_facets_are_those_of_the_ball)
{
  using S = CurvedSurface;
  for (const bool is_split : {false, true})
    {
      const auto slave = S::facets(5, 5, S::on(10, true), false, 2, is_split, 0, {});
      double     sum = 0, of_facets = 0;
      for (const auto &facet : slave)
        {
          const auto areas = facet.tributary_areas();
          of_facets += std::accumulate(areas.begin(), areas.end(), 0.);
        }
      const auto rows = interface::mortar_rows(slave,
                                               S::facets(5, 5, S::on(10.01, true), true, 2, false, S::of_master, {}),
                                               {1., 1.},
                                               ContactDiscretization::mortar,
                                               "pair");
      // corners of triangles have no rows: all facets count as covered
      EXPECT_EQ(rows.size(), is_split ? 11u * 11u - 6u * 6u : 11u * 11u);
      for (const auto &row : rows)
        sum += row.measure;
      const double a     = std::tan(S::half);
      const double exact = 100 * 4 * std::asin(a * a / (1 + a * a)); // solid angle of a pyramid
      EXPECT_NEAR(of_facets, exact, 5e-4 * exact);
      EXPECT_NEAR(sum, exact, 2e-3 * exact);
    }
}

TEST(FaceSurface, patch_of_a_mesh_file_is_met_along_lines_and_divided)
{
  using Point      = dealii::Point<3>;
  using Tensor     = dealii::Tensor<1, 3>;
  const auto place = [](const double s, const double t) {
    return Point(s, t, 0.1 * s * s - 0.2 * t * t + 0.1 * s * t);
  };
  for (const unsigned int n : {3, 4})
    {
      std::vector<Point> nodes;
      for (unsigned int i = 0; i < (n == 3 ? 6u : 9u); ++i)
        nodes.push_back(place(mesh::FacetShapes::node(n, i)[0], mesh::FacetShapes::node(n, i)[1]));
      const auto   patch = mesh::FaceSurface::patch(nodes);
      const Tensor up({0.1, -0.05, 1.});
      const Tensor along = up / up.norm();
      const Point  on    = place(0.3, 0.4);
      EXPECT_NEAR(patch.distance_along(on - 0.07 * along, along), 0.07, 1e-13);
      const Tensor normal({-0.1 * 2 * 0.3 - 0.1 * 0.4, 0.4 * 0.4 - 0.1 * 0.3, 1});
      EXPECT_LT((patch.normal(on, -1. * along) + normal / normal.norm()).norm(), 1e-13);
      for (unsigned int part = 0; part < 4; ++part)
        EXPECT_NEAR(patch.quarter(part).distance_along(on - 0.07 * along, along), 0.07, 1e-12); // extrapolated
      EXPECT_LT(patch.quarter(0).points[n].distance(place(0.25, 0)), 1e-13);
    }
}
