// Materials, loads, heat and elements as the .prm gives them.
#include "tools.h"

#include <slipstick/scene/checks.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  const std::string loads = R"(
set Materials    = steel
set Bodies       = box, other
set Supports     = left, far
set Tractions    = pressed
set Body forces  = weight, wheel
set Point loads  = pull
set Temperatures = warm
subsection Material steel
  set Density           = 7.85e-9
  set Thermal expansion = 1.2e-5
end
subsection Body box
  set Size     = 10, 10
  set Material = steel
end
subsection Body other
  set Origin   = 20, 0
  set Size     = 10, 10
  set Material = steel
end
subsection Support left
  set Boundary       = box/left
  set Displacement x = 0
  set Displacement y = 0
end
subsection Support far
  set Boundary       = other/right
  set Displacement x = 0
  set Displacement y = 0
end
subsection Traction pressed
  set Boundary = box/top
  set Pressure = 5*t
end
subsection Body force weight
  set Acceleration y = -9810
  set Force x        = x
end
subsection Body force wheel
  set Bodies           = other
  set Angular velocity = 100*t
  set Axis             = 25, 5
end
subsection Point load pull
  set Body    = other
  set Point   = 20, 10
  set Force y = 100
end
subsection Temperature warm
  set Bodies = box, other
  set Change = 30 + y
end
)";

  scene::Scene<2> loads_from(const std::vector<std::string> &overrides = {})
  {
    TemporaryDirectory directory;
    return scene::read_scene(directory.write("loads.prm", loads), overrides);
  }

  void loads_refused(const std::vector<std::string> &overrides, const std::vector<std::string> &parts)
  {
    TemporaryDirectory directory;
    expect_refused(directory.write("loads.prm", loads), overrides, parts);
  }
} // namespace

TEST(loads, are_read)
{
  const auto             scene = loads_from();
  const dealii::Point<2> x(3, 4);
  EXPECT_EQ(scene.materials[0].density, 7.85e-9);
  EXPECT_EQ(scene.materials[0].expansion, 1.2e-5);
  EXPECT_EQ(scene.tractions[0].pressure.value(x, 0.5), 2.5);
  ASSERT_EQ(scene.body_forces.size(), 2u);
  EXPECT_EQ(scene.body_forces[0].bodies, (std::vector<unsigned int>{0, 1}));
  EXPECT_EQ(scene.body_forces[0].acceleration[1].value(x, 1), -9810);
  EXPECT_EQ(scene.body_forces[0].force[0].value(x, 1), 3);
  EXPECT_EQ(scene.body_forces[1].bodies, (std::vector<unsigned int>{1}));
  EXPECT_EQ(scene.body_forces[1].angular_velocity.value(x, 0.5), 50);
  EXPECT_EQ(scene.body_forces[1].axis, dealii::Point<2>(25, 5));
  EXPECT_EQ(scene.point_loads[0].where.body, 1u);
  EXPECT_EQ(*scene.point_loads[0].where.coordinates, dealii::Point<2>(20, 10));
  EXPECT_EQ(scene.point_loads[0].force[1].value(x, 1), 100);
  EXPECT_EQ(scene.temperatures[0].bodies, (std::vector<unsigned int>{0, 1}));
  EXPECT_EQ(scene.temperatures[0].change.value(x, 1), 34);
}

TEST(loads, wrong_bodies)
{
  loads_refused({"Body force wheel/Bodies=othre"}, {"Body force wheel/Bodies", "'othre'", "did you mean 'other'?"});
  loads_refused({"Body force wheel/Bodies=box, box"}, {"names body 'box' twice"});
  loads_refused({"Temperature warm/Bodies="}, {"Temperature warm/Bodies", "names no body"});
  loads_refused({"Point load pull/Body=bx"}, {"Point load pull/Body", "'bx'", "did you mean 'box'?"});
}

TEST(loads, wrong_points)
{
  loads_refused({"Point load pull/Point=1"}, {"Point load pull/Point = '1'", "is no point", "2.5, 10"});
  loads_refused({"Point load pull/Point=1, 2, 3"}, {"is no point"});
  loads_refused({"Point load pull/Point=1, y"}, {"is no point"});
  loads_refused({"Point load pull/Point=tip"}, {"'tip'", "no named points", "give coordinates"});
}

TEST(loads, that_load_nothing)
{
  loads_refused({"Point load pull/Force y=0"}, {"Point load pull", "is no load", "set Force x or Force y"});
  loads_refused({"Body force wheel/Angular velocity=0"}, {"Body force wheel", "is no load"});
  const std::string list = "Tractions=pressed, more", where = "Traction more/Boundary=box/top";
  refused({list, where}, {"Traction more", "is no load", "set Pressure, Traction x or Traction y", "list Tractions"});
  EXPECT_EQ(box({list, where, "Traction more/Pressure=0"}).tractions.size(), 2u); // begins a study
}

TEST(loads, of_bodies_without_density_or_expansion)
{
  loads_refused({"Material steel/Density=0"},
                {"Body force weight", "body 'box'", "Material steel/Density is 0", "7.85e-9"});
  loads_refused({"Material steel/Thermal expansion=0"}, {"Temperature warm", "Thermal expansion is 0"});
  loads_refused({"Material steel/Density=-1"}, {"Material steel/Density = '-1'", "a number in [0, 1e+20]"});
}

TEST(loads, section_of_two_words_that_no_list_declares)
{
  loads_refused({"Body force gravity/Force x=1"}, {"'Body force gravity'", "set Body forces = weight, wheel, gravity"});
}

TEST(element, nearly_incompressible_is_for_plane_strain)
{
  loads_refused({"Discretization/Element=nearly incompressible"}, {"Discretization/Element", "plane strain"});
  EXPECT_EQ(
    loads_from({"Discretization/Element=nearly incompressible", "Plane state=plane strain"}).discretization.element,
    scene::ElementKind::nearly_incompressible);
}

TEST(element, that_locks_is_warned_of)
{
  const std::vector<std::string> rubber = {"Material steel/Poisson ratio=0.4999", "Plane state=plane strain"};
  const auto                     texts  = scene::warnings(loads_from(rubber));
  ASSERT_EQ(texts.size(), 1u);
  expect_parts(texts[0], {"0.4999", "Material steel", "Discretization/Element = nearly incompressible"});
  EXPECT_TRUE(scene::warnings(loads_from()).empty());
  EXPECT_TRUE(scene::warnings(loads_from({rubber[0]})).empty());
  EXPECT_TRUE(
    scene::warnings(loads_from({rubber[0], rubber[1], "Discretization/Element=nearly incompressible"})).empty());
}
