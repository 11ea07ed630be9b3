#include "tools.h"

#include <slipstick/scene/checks.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  const std::vector<std::string> two_bodies = {"Bodies=box, wedge",
                                               "Body wedge/Size=1, 2",
                                               "Body wedge/Material=elastic",
                                               "Contacts=circle, both",
                                               "Contact both/Slave=box/right",
                                               "Contact both/Master=wedge/left"};

  std::vector<std::string> with(std::vector<std::string> overrides, const std::vector<std::string> &more)
  {
    overrides.insert(overrides.end(), more.begin(), more.end());
    return overrides;
  }
} // namespace

TEST(contact_sections, pair_of_bodies)
{
  const auto pair = box(with(two_bodies,
                             {"Contact both/Law=Coulomb",
                              "Contact both/Friction coefficient=0.3*x",
                              "Contact both/Offset=-0.01",
                              "Contact both/Gap=0.2",
                              "Contact both/Reach=0.5",
                              "Contact both/Discretization=mortar"}))
                      .contacts[1];
  ASSERT_TRUE(pair.master);
  EXPECT_EQ(pair.master->body, 1u);
  EXPECT_EQ(pair.master->boundary, "left");
  EXPECT_EQ(pair.law.name, "Coulomb");
  EXPECT_NEAR(pair.law.coefficient->value.value({2, 0}, 1), 0.6, 1e-15);
  EXPECT_EQ(pair.offset.value({0, 0}, 1), -0.01);
  EXPECT_EQ(pair.gap->value({0, 0}, 1), 0.2);
  EXPECT_EQ(*pair.reach, 0.5);
  EXPECT_EQ(pair.discretization, scene::ContactDiscretization::mortar);
}

TEST(contact_sections, cohesion)
{
  const std::vector<std::string> law       = {"Contact both/Law=cohesion",
                                              "Contact both/Cohesion=2*x",
                                              "Contact both/Friction coefficient=0.5"};
  const auto                     forces_at = [&](const std::vector<std::string> &more) {
    return box(with(with(two_bodies, law), more)).contacts[1].law.admissible_forces({1.5, 0}, 1, 4, "both");
  };
  EXPECT_EQ(forces_at({}).radius(10), 2 * 1.5 * 4 + 0.5 * 10);
  EXPECT_EQ(forces_at({"Contact both/Shear limit=4"}).radius(10), 4 * 4);
  EXPECT_EQ(forces_at({"Contact both/Shear limit=4"}).radius(4), 2 * 1.5 * 4 + 0.5 * 4);
  refused(with(two_bodies, {"Contact both/Law=cohesion"}), {"Cohesion is not set", "Law = Coulomb"});
  refused(with(with(two_bodies, law), {"Contact both/Shear limit=-1"}), {"Shear limit", "negative", ">= 0 [MPa]"});
}

TEST(contact_sections, defaults_of_a_pair)
{
  const auto pair = box(two_bodies).contacts[1];
  EXPECT_EQ(pair.law.name, "frictionless");
  EXPECT_FALSE(pair.gap);
  EXPECT_FALSE(pair.reach);
  EXPECT_TRUE(pair.law.acts_where_closed_alone());
  EXPECT_EQ(pair.discretization, scene::ContactDiscretization::automatic);
}

TEST(contact_sections, wrong_pairs_are_refused)
{
  refused(with(two_bodies, {"Contact both/Master=wedge/lfet"}), {"'wedge/lfet'", "did you mean 'left'?"});
  refused(with(two_bodies, {"Contact both/Master=dics"}), {"unknown obstacle", "disc"});
  refused(with(two_bodies, {"Contact both/Master=box/right"}), {"box/right", "itself", "different"});
  refused(with(two_bodies, {"Contact both/Master=box/*"}), {"itself"});
  refused(with(two_bodies, {"Contact both/Law=Coulomb"}), {"Friction coefficient is not set"});
  refused(with(two_bodies, {"Contact both/Law=Coulomb", "Contact both/Friction coefficient=-0.1"}),
          {"negative", ">= 0"});
  refused(with(two_bodies, {"Contact both/Reach=0"}), {"Contact both/Reach", "> 0", "auto"});
  refused(with(two_bodies,
               {"Contacts=circle, both, again", "Contact again/Slave=wedge/left", "Contact again/Master=box/right"}),
          {"Contact again", "Contact both", "same two sides"});
}

TEST(contact_sections, one_body_may_touch_itself_with_another_boundary)
{
  EXPECT_EQ(box({"Contacts=circle, self", "Contact self/Slave=box/right", "Contact self/Master=box/top"})
              .contacts[1]
              .master->boundary,
            "top");
}

TEST(contact_sections, search)
{
  const auto search = box({"Contact search/Mode=automatic",
                           "Contact search/Reach=0.1",
                           "Contact search/Law=Tresca",
                           "Contact search/Slip bound=7",
                           "Contact search/Slip bound acts on=contact"})
                        .contact_search;
  EXPECT_TRUE(search.automatic);
  EXPECT_EQ(search.reach, 0.1);
  EXPECT_EQ(search.pair.law.name, "Tresca");
  EXPECT_EQ(search.pair.law.fixed->value.value({0, 0}, 1), 7);
  EXPECT_TRUE(search.pair.law.acts_where_closed_alone());
  refused({"Contact search/Reach=-1"}, {"Reach", ">= 0"});
}

TEST(contact_sections, reach_of_no_search_is_refused)
{
  refused({"Contact search/Reach=0.1"},
          {"Contact search/Reach = '0.1'", "no effect", "Contact search/Mode = automatic"});
  EXPECT_EQ(box({"Contact search/Reach=0.1", "Contact search/Mode=declared"}).contact_search.reach, 0.1);
}

TEST(contact_sections, parameters_of_other_laws)
{
  const std::vector<std::string> given      = {"Contact circle/Friction coefficient=0.3"};
  const auto                     of_coulomb = scene::warnings(box(given)),
             of_cohesion                    = scene::warnings(box({"Contact circle/Shear limit=7"}));
  ASSERT_EQ(of_coulomb.size(), 1u);
  expect_parts(of_coulomb[0], {"Friction coefficient = '0.3'", "no effect with Law = Tresca", "Coulomb, cohesion"});
  ASSERT_EQ(of_cohesion.size(), 1u);
  expect_parts(of_cohesion[0], {"Shear limit = '7'", "it belongs to cohesion"});
  EXPECT_TRUE(scene::warnings(box(with(given, {"Contact circle/Law=Coulomb"}))).empty()); // the bound is in the file
  EXPECT_TRUE(scene::warnings(box({"Contact circle/Friction coefficient=0"})).empty());
  EXPECT_TRUE(scene::warnings(box({"Contact circle/Shear limit=none"})).empty());

  TemporaryDirectory directory;
  const auto         in_file = [&](const std::string &law, const std::string &more) {
    std::string       text = read_text(prm("box_on_circle"));
    const std::string old  = "set Law        = Tresca";
    const auto        at   = text.find(old);
    EXPECT_NE(at, std::string::npos);
    text.replace(at, old.size(), "set Law = " + law + "\n" + more);
    return scene::warnings(scene::read_scene(directory.write("box.prm", text), {}));
  };
  EXPECT_TRUE(in_file("Tresca", "set Slip bound acts on = contact").empty());
  for (const std::string law : {"Coulomb", "frictionless", "bonded"})
    {
      const auto warnings = in_file(law,
                                    std::string("set Slip bound acts on = contact\n") +
                                      (law == "Coulomb" ? "set Friction coefficient = 1" : ""));
      ASSERT_EQ(warnings.size(), 2u);
      expect_parts(warnings[0], {"box.prm:", "Contact circle/Slip bound = '500' has no effect with Law = " + law});
      expect_parts(warnings[1], {"Slip bound acts on = 'contact'", "it belongs to Tresca"});
    }
}

TEST(contact_sections, obstacles_of_all_shapes)
{
  const std::vector<std::string> half  = {"Obstacles=disc, o", "Obstacle o/Shape=half plane", "Obstacle o/Point=1, 2"};
  const auto                     plane = box(with(half, {"Obstacle o/Normal=3, 4"})).obstacles[1];
  EXPECT_EQ(plane.center, dealii::Point<2>(1, 2));
  EXPECT_NEAR(plane.normal[0], 0.6, 1e-15);
  EXPECT_NEAR(plane.normal[1], 0.8, 1e-15);
  refused(with(half, {"Obstacle o/Normal=0, 0"}), {"no length"});
  refused(with(half, {"Obstacle o/Radius=3"}), {"Obstacle o/Radius", "has no meaning"});

  const std::vector<std::string> line = {"Obstacles=disc, o", "Obstacle o/Shape=polyline"};
  EXPECT_EQ(box(with(line, {"Obstacle o/Points=0 0; 1 0; 2 1"})).obstacles[1].points[2], dealii::Point<2>(2, 1));
  refused(line, {"Points is not set"});
  refused(with(line, {"Obstacle o/Points=0 0"}), {"fewer than two"});
  refused(with(line, {"Obstacle o/Points=0 0; 0 0; 1 1"}), {"twice"});
  refused(with(line, {"Obstacle o/Points=0 0; 1"}), {"'1'", "no point"});

  const auto function = box({"Obstacles=disc, o", "Obstacle o/Shape=function", "Obstacle o/Height=x^2+t"}).obstacles[1];
  EXPECT_EQ(function.height.value({2, 0}, 1), 5);
  refused({"Obstacles=disc, o", "Obstacle o/Shape=hole", "Obstacle o/Center=0, 0"}, {"Radius is not set"});
}

TEST(contact_sections, supports_along_the_normal_and_at_points)
{
  const auto roller =
    box({"Supports=held, more", "Support more/Boundary=box/right", "Support more/Displacement normal=0.1"}).supports[1];
  EXPECT_EQ(roller.normal->value({0, 0}, 1), 0.1);
  const std::vector<std::string> at    = {"Supports=held, more", "Support more/Body=box", "Support more/Point=10, 10"};
  const auto                     point = box(with(at, {"Support more/Displacement y=0"})).supports[1];
  ASSERT_TRUE(point.point);
  EXPECT_EQ(*point.point->coordinates, dealii::Point<2>(10, 10));
  EXPECT_EQ(point.where.body, 0u);
  refused(with(at, {"Support more/Displacement normal=0"}), {"needs a boundary"});
  refused(with(at, {"Support more/Displacement y=0", "Support more/Boundary=box/top"}), {"Boundary", "Point"});
  refused({"Support held/Displacement normal=0"}, {"Displacement normal", "axis"});
}

TEST(contact_sections, foundations)
{
  const std::vector<std::string> bed        = {"Foundations=bed", "Foundation bed/Boundary=box/right"};
  const auto                     foundation = box(with(bed, {"Foundation bed/Normal stiffness=5"})).foundations[0];
  EXPECT_EQ(foundation.normal_stiffness, 5);
  EXPECT_EQ(foundation.tangential_stiffness, 0);
  refused(bed, {"Foundation bed", "holds nothing"});
  refused(with(bed, {"Foundation bed/Normal stiffness=-5"}), {"Normal stiffness", ">= 0"});
}
