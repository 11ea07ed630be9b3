// The load steps of a scene: answers that pass their checks, pruning that is taken back, what is refused.
#include "torn.h"

#include <slipstick/app/restart.h>
#include <slipstick/app/run_summary.h>
#include <slipstick/app/step_solver.h>
#include <slipstick/base/exceptions.h>

#include <filesystem>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// All steps of a scene, and the number of rows of contact at first and at the end.
  struct Steps
  {
    explicit Steps(const Scene &scene, const MPI_Comm comm = MPI_COMM_WORLD)
      : log(comm, Verbosity::quiet)
      , solver(scene, log, clock, comm)
    {
      solver.build();
      rows_at_first = solver.dual().constraints().counts.normal;
      for (unsigned int step = 0; step < scene.load_factors.size(); ++step)
        answers.push_back(solver.solve(step, 0));
    }

    const contact::Checks &checks() const
    {
      return answers.back()->contact->checks;
    }
    unsigned long long rows() const
    {
      return solver.dual().constraints().counts.normal;
    }

    Log                                             log;
    StageClock                                      clock;
    app::StepSolver<2>                              solver;
    unsigned long long                              rows_at_first = 0;
    std::vector<std::unique_ptr<app::StepSolution>> answers;
  };

  void expect_same(const Steps &a, const Steps &b, const double tolerance)
  {
    EXPECT_NEAR(a.checks().energy, b.checks().energy, tolerance * b.checks().energy);
    EXPECT_NEAR(a.checks().max_displacement, b.checks().max_displacement, tolerance * b.checks().max_displacement);
    EXPECT_NEAR(a.checks().largest_force, b.checks().largest_force, tolerance * b.checks().largest_force);
  }

  /// The box pressed on a circle by its top, whose displacement is given.
  Scene pressed_box(const double radius, const std::string &y, const Cut &how)
  {
    Scene scene            = cut(box(16), how);
    scene.solver.tolerance = 1e-10;
    support(scene, 0, "top", "0", y);
    touch(scene, 0, "bottom", {5, -radius}, radius, "");
    return scene;
  }
} // namespace

TEST(StepSolver, answers_pass_their_checks_in_every_step)
{
  Scene scene        = pressed_box(20, "-0.05*t", blocks(2));
  scene.load_factors = {0.2, 0.6, 1};
  const Steps run(scene);
  double      energy = 0;
  for (const auto &answer : run.answers)
    {
      EXPECT_LE(answer->contact->checks.worst().second, app::check_limit(scene.solver.tolerance));
      EXPECT_GT(answer->contact->checks.energy, energy); // pressed more
      energy = answer->contact->checks.energy;
    }
  EXPECT_EQ(run.solver.convergence().back().step, 2u);
}

TEST(StepSolver, steps_of_contact_without_friction_lead_where_one_step_does)
{
  Scene       scene = pressed_box(20, "-0.05*t", metis(3));
  const Steps one(scene);
  scene.load_factors = {0.3, 1};
  expect_same(Steps(scene), one, 1e-8);
}

TEST(StepSolver, pruned_nodes_get_rows_where_they_would_penetrate)
{
  Scene       scene = pressed_box(6, "-60", blocks(2)); // so far that all of the bottom is pressed on the circle
  const Steps pruned(scene);
  scene.solver.prune_contact = false;
  const Steps all(scene);
  EXPECT_LT(pruned.rows_at_first, all.rows_at_first);
  EXPECT_GT(pruned.rows(), pruned.rows_at_first);
  expect_same(pruned, all, 1e-8);
}

TEST(StepSolver, pruned_nodes_stay_without_rows_where_they_remain_apart)
{
  Scene       scene = pressed_box(6, "-0.05", blocks(2));
  const Steps pruned(scene);
  scene.solver.prune_contact = false;
  const Steps all(scene);
  EXPECT_LT(pruned.rows(), all.rows());
  expect_same(pruned, all, 1e-8);
}

TEST(StepSolver, no_equilibrium_is_thrown_on_all_ranks)
{
  Scene scene = cut(box(8), blocks(2));
  touch(scene, 0, "bottom", {5, -20}, 20, "");
  load(scene, 0, "top", "0", "1"); // away from the circle, held by nothing
  EXPECT_THROW(Steps{scene}, NoEquilibrium);
}

TEST(StepSolver, state_is_the_same_after_it_was_written_and_taken_over)
{
  Scene scene        = cut(box_on_circle(16, "500"), metis(4));
  scene.load_factors = {.5, 1};
  Log                log(MPI_COMM_WORLD, Verbosity::quiet);
  StageClock         clock;
  app::StepSolver<2> solver(scene, log, clock, MPI_COMM_WORLD), other(scene, log, clock, MPI_COMM_WORLD);
  solver.build();
  solver.solve(0, 0);
  app::RunState run;
  run.solver = solver.state();
  run.summary.steps.resize(1);
  std::string path = (std::filesystem::temp_directory_path() / "slipstick-XXXXXX").string();
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    {
      ASSERT_NE(mkdtemp(path.data()), nullptr);
    }
  path = dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD, path);
  const output::OutputDirectory directory(path, MPI_COMM_WORLD);
  app::write_restart(directory, scene, run, MPI_COMM_WORLD);
  other.resume(app::read_restart(directory, scene, MPI_COMM_WORLD).solver);
  MPI_Barrier(MPI_COMM_WORLD);
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::filesystem::remove_all(path);

  const auto before = solver.state(), after = other.state();
  EXPECT_EQ(after.multipliers, before.multipliers);
  EXPECT_EQ(after.u, before.u);
  EXPECT_EQ(after.reference, before.reference);
  ASSERT_EQ(after.directions.size(), before.directions.size());
  ASSERT_GT(after.directions.size(), 2u);
  double largest = 0;
  for (std::size_t k = 0; k < after.directions.size(); ++k)
    {
      EXPECT_EQ(after.directions[k].p, before.directions[k].p);
      EXPECT_EQ(after.directions[k].Fp, before.directions[k].Fp);
      EXPECT_EQ(after.directions[k].error, before.directions[k].error);
      largest = std::max(largest, after.directions[k].error);
    }
  EXPECT_GT(largest, 0);
  const auto next = other.solve(1, 0), expected = solver.solve(1, 0);
  EXPECT_EQ(next->contact->checks.energy, expected->contact->checks.energy);
}
