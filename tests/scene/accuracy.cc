// Presets of accuracy over the single knobs.
#include "tools.h"

#include <slipstick/scene/accuracy.h>

using namespace slipstick;
using namespace slipstick::scene;
using namespace slipstick::test;

namespace
{
  /// prm/box_on_circle.prm without its own tolerance.
  Scene<2> box_without_knobs(const std::vector<std::string> &overrides, const std::string &first_lines = "")
  {
    TemporaryDirectory directory;
    std::string        text  = read_text(prm("box_on_circle"));
    const auto         place = text.find("set Tolerance = 1e-4", text.find("subsection Solver"));
    EXPECT_NE(place, std::string::npos);
    text.erase(place, std::string("set Tolerance = 1e-4").size());
    return read_scene(directory.write("box.prm", first_lines + text), overrides);
  }

  void expect_same_knobs(const Scene<2> &a, const Scene<2> &b)
  {
    EXPECT_EQ(a.solver.tolerance, b.solver.tolerance);
    EXPECT_EQ(a.solver.stops_at_discretization_error, b.solver.stops_at_discretization_error);
    EXPECT_EQ(a.solver.prune_contact, b.solver.prune_contact);
    EXPECT_EQ(a.solver.dual.operator_precision, b.solver.dual.operator_precision);
    EXPECT_EQ(a.friction.tolerance, b.friction.tolerance);
    EXPECT_EQ(a.discretization.degree, b.discretization.degree);
  }
} // namespace

TEST(accuracy, engineering_is_the_default_of_every_knob)
{
  const auto unset = box_without_knobs({});
  EXPECT_EQ(unset.accuracy, Accuracy::engineering);
  expect_same_knobs(unset, box_without_knobs({"Accuracy=engineering"}));
  EXPECT_EQ(unset.solver.tolerance, 1e-4);
  EXPECT_EQ(unset.friction.tolerance, 1e-6);
  EXPECT_EQ(unset.discretization.degree, 1u);
  EXPECT_TRUE(unset.solver.prune_contact);
}

TEST(accuracy, presets_set_all_knobs)
{
  const auto draft     = box_without_knobs({"Accuracy=draft"}),
             reference = box_without_knobs({}, "set Accuracy = reference\n");
  EXPECT_EQ(draft.accuracy, Accuracy::draft);
  EXPECT_TRUE(draft.solver.stops_at_discretization_error);
  EXPECT_EQ(draft.friction.tolerance, 1e-3);
  EXPECT_EQ(draft.discretization.degree, 1u);
  EXPECT_EQ(draft.solver.dual.operator_precision, tfeti::Precision::single_precision);
  EXPECT_EQ(reference.accuracy, Accuracy::reference);
  EXPECT_EQ(reference.solver.tolerance, 1e-8);
  EXPECT_EQ(reference.friction.tolerance, 1e-8);
  EXPECT_EQ(reference.discretization.degree, 2u);
  EXPECT_EQ(reference.solver.dual.operator_precision, tfeti::Precision::double_precision);
  EXPECT_FALSE(reference.solver.prune_contact);
}

TEST(accuracy, knobs_of_the_file_and_of_overrides_win_in_any_order)
{
  EXPECT_EQ(read_scene(prm("box_on_circle"), {"Accuracy=reference"}).solver.tolerance, 1e-4); // set in the file
  for (const std::vector<std::string> &overrides :
       {std::vector<std::string>{"Accuracy=reference", "Solver/Tolerance=1e-5", "Discretization/Degree=1"},
        std::vector<std::string>{"Discretization/Degree=1", "Solver/Tolerance=1e-5", "Accuracy=reference"}})
    {
      const auto scene = box_without_knobs(overrides);
      EXPECT_EQ(scene.solver.tolerance, 1e-5);
      EXPECT_EQ(scene.discretization.degree, 1u);
      EXPECT_EQ(scene.friction.tolerance, 1e-8);
      EXPECT_FALSE(scene.solver.prune_contact);
    }
  const auto file_wins = box_without_knobs({"Accuracy=draft"}, "set Accuracy = reference\n"); // the last preset counts
  EXPECT_TRUE(file_wins.solver.stops_at_discretization_error);
}

TEST(accuracy, echo_shows_the_values_and_reads_back)
{
  const auto         first = box_without_knobs({"Accuracy=reference", "Friction/Tolerance=1e-4"});
  TemporaryDirectory directory;
  const auto         again = read_scene(directory.write("parameters.prm", first.parameters), {});
  for (const std::string text : {"set Accuracy", "= reference", "= 1e-8", "= 1e-4", "= false"})
    EXPECT_NE(first.parameters.find(text), std::string::npos) << text;
  expect_same_knobs(first, again);
  EXPECT_EQ(first.parameters, again.parameters);
}

TEST(accuracy, unknown_preset_is_refused)
{
  expect_refused(prm("box_on_circle"),
                 {"Accuracy=drafty"},
                 {"Accuracy = 'drafty'", "draft, engineering, reference", "did you mean 'draft'"});
  expect_refused(prm("box_on_circle"), {"Solver/Accuracy=draft"}, {"Solver/Accuracy", "did you mean 'Accuracy'"});
}

TEST(accuracy, percentage_refines_meshes)
{
  AdaptivityOptions none, one;
  read_scene(prm("box_on_circle"), {}, &none);
  EXPECT_FALSE(none.refines());
  EXPECT_FALSE(none.error_bars);
  const auto scene = box_without_knobs({"Accuracy=0.5 %"});
  EXPECT_EQ(scene.solver.tolerance, 1e-6);
  EXPECT_EQ(scene.discretization.degree, 1u);
  read_scene(prm("box_on_circle"), {"Accuracy= 0.5%", "Goal=circle.max_pressure, strain_energy"}, &one);
  EXPECT_DOUBLE_EQ(one.accuracy, 5e-3);
  EXPECT_EQ(one.goals, (std::vector<std::string>{"circle.max_pressure", "strain_energy"}));
  EXPECT_EQ(read_scene(prm("box_on_circle"), {"Accuracy=0.5 %"}).solver.tolerance, 1e-4); // set in the file
  for (const std::string wrong : {"0 %", "100 %", "-1 %", "%", "1", "1 % 2"})
    EXPECT_EQ(accuracy_of(wrong), 0) << wrong;
  expect_refused(prm("box_on_circle"),
                 {"Accuracy=1 %", "Goal=circle.max_presure"},
                 {"Goal", "there is no quantity 'circle.max_presure'", "did you mean 'circle.max_pressure'"});
  expect_refused(prm("box_on_circle"), {"Goal=strain_energy"}, {"Goal", "set Accuracy = 1 %"});
  const std::string limit  = "Adaptivity/Max meshes=5";
  const auto        warned = read_scene(prm("box_on_circle"), {limit}, &none).warnings;
  ASSERT_EQ(warned.size(), 1u);
  for (const char *words : {"Max meshes = '5'", "no effect", "Mesh = adaptive"})
    EXPECT_NE(warned[0].find(words), std::string::npos) << warned[0];
  for (const std::string other : {"Accuracy=1 %", "Mesh=adaptive", "Adaptivity/Max meshes=12"}) // 12: the default
    EXPECT_TRUE(read_scene(prm("box_on_circle"), {limit, other}, &none).warnings.empty()) << other;
}

TEST(accuracy, adaptive_meshes_of_presets)
{
  AdaptivityOptions draft, reference, goal, percentage;
  const auto        scene = read_scene(prm("hertz"), {"Mesh=adaptive", "Accuracy=reference"}, &reference);
  EXPECT_DOUBLE_EQ(reference.accuracy, 3e-3);
  EXPECT_TRUE(reference.skips_unknown);
  EXPECT_EQ(
    reference.goals,
    (std::vector<std::string>{"max_displacement", "strain_energy", "touch.normal_force", "touch.max_pressure"}));
  EXPECT_EQ(scene.discretization.degree, 2u);
  EXPECT_EQ(scene.friction.tolerance, 1e-6); // of runs that compare meshes
  read_scene(prm("hertz"), {"Mesh=adaptive", "Accuracy=draft"}, &draft);
  EXPECT_DOUBLE_EQ(draft.accuracy, 0.1);
  read_scene(prm("hertz"), {"Mesh=adaptive", "Goal=strain_energy"}, &goal);
  EXPECT_DOUBLE_EQ(goal.accuracy, 0.03);
  EXPECT_EQ(goal.goals, std::vector<std::string>{"strain_energy"});
  EXPECT_FALSE(goal.skips_unknown);
  read_scene(prm("hertz"), {"Mesh=fixed", "Accuracy=2 %"}, &percentage); // as parameters.prm of such a run has it
  EXPECT_DOUBLE_EQ(percentage.accuracy, 0.02);
  EXPECT_TRUE(percentage.goals.empty());
  expect_refused(prm("hertz"), {"Mesh=adaptve"}, {"Mesh = 'adaptve'", "fixed, adaptive", "did you mean 'adaptive'"});
}

TEST(accuracy, automatic_tolerance)
{
  const auto scene = box_without_knobs({"Solver/Tolerance=auto"});
  EXPECT_TRUE(scene.solver.stops_at_discretization_error);
  EXPECT_LE(scene.solver.tolerance, 1e-8);
  EXPECT_FALSE(
    box_without_knobs({"Solver/Tolerance=auto", "Solver/Tolerance=1e-3"}).solver.stops_at_discretization_error);
  TemporaryDirectory directory;
  EXPECT_TRUE(read_scene(directory.write("a.prm", scene.parameters), {}).solver.stops_at_discretization_error);
}
