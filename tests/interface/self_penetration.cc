// Two faces of a body on both sides of a gap that closes.
#include "torn.h"

#include <slipstick/interface/self_penetration.h>

#include <functional>

using namespace slipstick;

namespace
{
  using Place = dealii::Point<3>;
  using Facet = mechanics::SurfaceFacet;

  constexpr double width = 0.1;

  Facet facet_at(const std::vector<Place> &corners, const unsigned int first_key)
  {
    Facet result;
    result.n_nodes = corners.size();
    for (unsigned int i = 0; i < corners.size(); ++i)
      {
        result.keys[i] = {{first_key + i, first_key + i}};
        result.at[i]   = {{corners[i][0], corners[i][1], corners[i][2]}};
      }
    return result;
  }

  /// The lower face looks up, the upper one, of two triangles, down.
  std::vector<Facet> two_faces()
  {
    const Place a(-0.5, width, -0.5), b(1.5, width, -0.5), c(1.5, width, 1.5), d(-0.5, width, 1.5);
    return {facet_at({Place(0, 0, 0), Place(0, 0, 1), Place(1, 0, 1), Place(1, 0, 0)}, 1),
            facet_at({a, b, c}, 10),
            facet_at({a, c, d}, 20)};
  }

  std::vector<Facet> displaced(std::vector<Facet> faces, const std::function<Place(const Place &, bool is_upper)> &u)
  {
    for (unsigned int f = 0; f < faces.size(); ++f)
      for (unsigned int i = 0; i < faces[f].n_nodes; ++i)
        {
          const Place by = u(faces[f].node(i), f > 0);
          for (unsigned int d = 0; d < 3; ++d)
            faces[f].at[i][d] += by[d];
        }
    return faces;
  }

  double found_depth(const std::function<Place(const Place &, bool is_upper)> &u,
                     const std::set<unsigned int>                             &exempt = {})
  {
    const auto found = interface::self_penetration<3>(two_faces(), displaced(two_faces(), u), exempt);
    return found ? found->depth : 0.;
  }
} // namespace

TEST(SelfPenetration, is_what_closes_beyond_the_gap)
{
  const auto closing = [](const double by) {
    return [by](const Place &, const bool is_upper) { return is_upper ? Place(0, -by, 0) : Place(); };
  };
  EXPECT_NEAR(found_depth(closing(0.15)), 0.05, 1e-12);
  EXPECT_EQ(found_depth(closing(0.09)), 0);
  EXPECT_EQ(found_depth(closing(-0.15)), 0);
  EXPECT_EQ(found_depth(closing(0.15), {0, 1, 2}), 0);
  EXPECT_NEAR(found_depth(
                [](const Place &x, const bool is_upper) { return is_upper ? Place(0, -0.3 * x[0], 0) : Place(); }),
              0.3 * 5 / 6 - width,
              1e-12); // seen from the middle of a triangle
}

TEST(SelfPenetration, is_none_in_rigid_motions)
{
  EXPECT_NEAR(found_depth([](const Place &x, bool) { return Place(3 - 2 * x[1], 5 + 2 * x[0] - x[2], x[1] - 7); }),
              0,
              1e-12);
}

TEST(SelfPenetration, is_not_seen_through_the_body)
{
  auto thin = two_faces(); // faces that look away from each other
  for (auto &face : thin)
    std::reverse(face.at.begin(), face.at.begin() + face.n_nodes);
  const auto now =
    displaced(thin, [](const Place &, const bool is_upper) { return is_upper ? Place(0, -0.15, 0) : Place(); });
  EXPECT_FALSE(interface::self_penetration<3>(thin, now, {}));
}
