// What spares typing: variables, ranges of load factors, materials of the library.
#include "tools.h"

using namespace slipstick;
using namespace slipstick::scene;
using namespace slipstick::test;

namespace
{
  const std::string plate = "set Bodies = plate\nset Supports = held\nset Tractions = pull\n"
                            "subsection Support held\n set Boundary = plate/left\n set Displacement x = 0\nend\n"
                            "subsection Traction pull\n set Boundary = plate/right\n set Traction x = {p}*t\nend\n"
                            "subsection Body plate\n set Size = {2*a}, {a + b}\n set Material = steel\nend\n";
  const std::string head  = "set Materials = steel\nset Variables = a = 3; b = a^2 - 1; p = -7\n";

  Scene<2> plate_from(const std::string &text, const std::vector<std::string> &overrides = {})
  {
    TemporaryDirectory directory;
    return read_scene(directory.write("plate.prm", text), overrides);
  }

  void plate_refused(const std::string              &text,
                     const std::vector<std::string> &overrides,
                     const std::vector<std::string> &parts)
  {
    expect_parts(error_of([&] { plate_from(text, overrides); }), parts);
  }
} // namespace

TEST(variables, stand_for_numbers_in_any_value)
{
  const auto scene = plate_from(head + plate);
  EXPECT_EQ(scene.bodies[0].size, dealii::Point<2>(6, 11));
  EXPECT_EQ(scene.tractions[0].components[0].value({0, 0}, 2), -14);
  // what is printed has the numbers, and reads as the same scene
  EXPECT_NE(scene.parameters.find("6, 11"), std::string::npos);
  EXPECT_EQ(plate_from(scene.parameters).parameters, scene.parameters);
}

TEST(variables, are_overridden_one_by_one)
{
  const auto scene = plate_from(head + plate, {"Variables/a=2", "Variables/p = 1 + a", "Variables/a=1"});
  EXPECT_EQ(scene.bodies[0].size, dealii::Point<2>(2, 1 + 0)); // the last override: a = 1, b = 0
  EXPECT_EQ(scene.tractions[0].components[0].value({0, 0}, 1), 2);
}

TEST(variables, negative_numbers_keep_their_sign)
{
  const auto value = [](const std::string &traction) {
    return plate_from(head + plate, {"Traction pull/Traction y=" + traction})
      .tractions[0]
      .components[1]
      .value({0, 0}, 1);
  };
  EXPECT_EQ(value("-{p}"), 7);
  EXPECT_EQ(value("2 - {p}*t"), 9);
  EXPECT_EQ(value("{p}^2"), 49);
  EXPECT_EQ(value("max({p}, -9)"), -7);
  EXPECT_EQ(plate_from(head + plate, {"Body plate/Origin = 1, {p}"}).bodies[0].origin, dealii::Point<2>(1, -7));
}

TEST(variables, mistakes_are_named)
{
  plate_refused(head + plate, {"Variables/c=2"}, {"--set Variables/c=2", "no variable 'c'", "valid: a, b, p"});
  plate_refused(head + plate,
                {"Body plate/Size={a}, {q}"},
                {"Body plate/Size", "'q' cannot be evaluated", "Variables here: a, b, p"});
  plate_refused(head + plate, {"Body plate/Size={a, 2"}, {"a brace without its partner"});
  plate_refused(head + plate, {"Body plate/Size={a/0}, 1"}, {"'a/0' is not a finite number"});
  plate_refused("set Variables = t = 2\n" + plate, {}, {"plate.prm:1", "'t' has a meaning of its own"});
  plate_refused("set Variables = a = 2; a = 3\n" + plate, {}, {"'a' is given twice"});
  plate_refused("set Variables = b = a; a = 3\n" + plate, {}, {"'a' cannot be evaluated"}); // only those before it
  plate_refused("set Variables = 2\n" + plate, {}, {"'2' is not NAME = NUMBER"});
}

TEST(variables, braces_are_characters_in_scenes_without)
{
  const auto scene = read_scene(prm("box_on_circle"), {"Title={a}"});
  EXPECT_NE(scene.parameters.find("{a}"), std::string::npos);
}

TEST(load_factors, ranges)
{
  const auto factors = [](const std::string &text) {
    return plate_from(head + plate, {"Load steps/Factors=" + text}).load_factors;
  };
  EXPECT_EQ(factors("0:0.1:0.3"), (std::vector<double>{0, 0.1, 0.2, 0.3}));
  EXPECT_EQ(factors("0.5:1:3"), (std::vector<double>{0.5, 1.5, 2.5}));
  EXPECT_EQ(factors("0:0.5:1, 2, 3:1:4"), (std::vector<double>{0, 0.5, 1, 2, 3, 4}));
  EXPECT_EQ(factors("{a}:1:{a + 2}"), (std::vector<double>{3, 4, 5}));
  for (const std::string wrong : {"0:0:1", "1:1:0", "0:1", "0:x:1", "0:1e-9:1", "0:1:2:3", "0:0.5:1, 1", ":1:2"})
    plate_refused(head + plate, {"Load steps/Factors=" + wrong}, {"Load steps/Factors", "FIRST:STEP:LAST"});
}

TEST(material_library, needs_no_subsection)
{
  const auto scene = plate_from(head + plate);
  EXPECT_EQ(scene.materials[0].young_modulus, 2.1e5);
  EXPECT_EQ(scene.materials[0].density, 7.85e-9);
}

TEST(material_library, what_is_set_takes_precedence)
{
  const std::string own = "set Variables = a = 1; b = 1; p = 1\nset Materials = steel, rim\n" + plate +
                          "subsection Material steel\n set Young modulus = 2e5\nend\n"
                          "subsection Material rim\n set Poisson ratio = 0.31\n set Library = cast iron\nend\n";
  const auto scene = plate_from(own);
  EXPECT_EQ(scene.materials[0].young_modulus, 2e5);
  EXPECT_EQ(scene.materials[0].density, 0); // a subsection of its own: no entry of the library, unless it asks for one
  EXPECT_EQ(scene.materials[1].young_modulus, 1.1e5);
  EXPECT_EQ(scene.materials[1].poisson_ratio, 0.31);
  EXPECT_EQ(scene.materials[1].expansion, 1.05e-5);
  plate_refused(own, {"Material rim/Library=cast irn"}, {"did you mean 'cast iron'?"});
  plate_refused(head + plate, {"Materials=steal"}, {"no subsection describes 'steal'"});
}
