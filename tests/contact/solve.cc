#include "solved.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/contact/refinement.h>

using namespace slipstick;
using namespace slipstick::test;
using tfeti::RowKind;

namespace
{
  const std::vector<Cut> four_cuts = {whole(), blocks(2), blocks(4), metis(6)};

  /// The box pressed on the circle and pushed sideways.
  Scene pushed_box(const std::string &slip_bound, const unsigned int degree = 1)
  {
    Scene scene            = box_on_circle(8, slip_bound, degree);
    scene.solver.tolerance = 1e-10;
    load(scene, 0, "right", "40", "-30");
    return scene;
  }

  /// A box that only the circle holds, pressed on it obliquely.
  Scene floating_box(const std::string &traction_x, const std::string &traction_y)
  {
    Scene scene            = box(8);
    scene.solver.tolerance = 1e-10;
    touch(scene, 0, "bottom", {5, -20}, 20, "60");
    load(scene, 0, "top", traction_x, traction_y);
    return scene;
  }

  /// Contact forces (normal, tangential) by the position of the node.
  using Forces = std::map<std::array<long long, 2>, std::array<double, 2>>;

  Forces contact_forces(const Solved &solved)
  {
    std::vector<std::array<double, 4>> own;
    for (const auto &point : solved.torn.constraints.contact_points)
      {
        const auto force = [&](const unsigned int row) {
          return row == tfeti::invalid_row ? 0. : solved.solution.multipliers.local_element(row);
        };
        own.push_back({{point.position[0], point.position[1], force(point.normal_row), force(point.tangential_row)}});
      }
    Forces forces;
    for (const auto &[x, y, normal, tangential] : gathered(own, solved.torn.comm))
      forces[position_key(x, y, 1e-6)] = {{normal, tangential}};
    return forces;
  }

  /// The same forces from the untorn body: its compliance at the contact nodes, projected Gauss-Seidel.
  Forces reference_forces(const Scene &scene)
  {
    const Untorn   untorn(scene);
    const auto    &contact = scene.contacts[0];
    const auto    &circle  = scene.obstacles[0];
    const auto    &x       = untorn.positions[0];
    const unsigned n_nodes = x.size();
    struct Row
    {
      unsigned int    node;
      Eigen::VectorXd b;
      double          c, lower, upper;
    };
    std::vector<Row> rows;
    for (unsigned int i = 0; i < n_nodes; ++i)
      if (lies_on(scene.bodies[0], contact.slave.boundary, x[i]) && !untorn.held[0][2 * i])
        {
          const double h = 10. / 8, area = scene.discretization.degree == 1     ? (x[i][0] < 9.9 ? h : h / 2)
                                           : std::fmod(x[i][0] + 1e-9, h) > 0.1 ? h * 4 / 6
                                                                                : (x[i][0] < 9.9 ? h / 3 : h / 6);
          const auto   ray = circle.center - x[i];
          Row          normal{i, Eigen::VectorXd::Zero(2 * n_nodes), ray.norm() - circle.radius, 0, 1e300};
          normal.b[2 * i]     = ray[0] / ray.norm();
          normal.b[2 * i + 1] = ray[1] / ray.norm();
          rows.push_back(normal);
          if (!contact.law.has_friction)
            continue;
          const double bound = contact.law.fixed->value.value(x[i], 1.) * area;
          Row          tangential{i, Eigen::VectorXd::Zero(2 * n_nodes), 0, -bound, bound};
          tangential.b[2 * i]     = -normal.b[2 * i + 1];
          tangential.b[2 * i + 1] = normal.b[2 * i];
          rows.push_back(tangential);
        }
    const unsigned int    m = rows.size();
    const Eigen::VectorXd u = untorn.displacements(0, untorn.torn.matrices[0].load, 1.);
    Eigen::MatrixXd       C(m, m);
    Eigen::VectorXd       g(m), force = Eigen::VectorXd::Zero(m);
    for (unsigned int k = 0; k < m; ++k)
      {
        const Eigen::VectorXd response = untorn.displacements(0, rows[k].b, 0.);
        for (unsigned int l = 0; l < m; ++l)
          C(l, k) = rows[l].b.dot(response);
        g[k] = rows[k].b.dot(u) - rows[k].c;
      }
    for (unsigned int sweep = 0; sweep < 20000; ++sweep)
      {
        double change = 0;
        for (unsigned int k = 0; k < m; ++k)
          {
            const double old = force[k];
            force[k] = std::min(rows[k].upper, std::max(rows[k].lower, old + (g[k] - C.row(k).dot(force)) / C(k, k)));
            change   = std::max(change, std::abs(force[k] - old));
          }
        if (change < 1e-13 * force.cwiseAbs().maxCoeff())
          break;
      }
    Forces forces;
    for (unsigned int k = 0; k < m; ++k)
      forces[position_key(x[rows[k].node][0], x[rows[k].node][1], 1e-6)][rows[k].lower < 0 || rows[k].upper < 1e300] =
        force[k];
    return forces;
  }

  void expect_forces(const Forces &found, const Forces &expect, const double tolerance)
  {
    ASSERT_EQ(found.size(), expect.size());
    double largest = 0;
    for (const auto &[place, force] : expect)
      largest = std::max({largest, std::abs(force[0]), std::abs(force[1])});
    EXPECT_GT(largest, 0);
    for (const auto &[place, force] : expect)
      for (const int k : {0, 1})
        {
          ASSERT_EQ(found.count(place), 1u);
          EXPECT_NEAR(found.at(place)[k], force[k], tolerance * largest) << "x = " << place[0] * 1e-6;
        }
  }

  /// Violations of the optimality conditions by dense matrices, relative to |P d|.
  struct Violations
  {
    explicit Violations(const Solved &solved)
    {
      const Torn           &torn = solved.torn;
      const Dense           dense(torn);
      const Eigen::VectorXd x = gathered(solved.solution.multipliers, torn.comm);
      const auto box = contact::multiplier_box(*solved.dual, contact::slip_bounds(torn.scene, *solved.dual, 1.));
      const Eigen::VectorXd l = gathered(box.lower, torn.comm), u = gathered(box.upper, torn.comm);
      const Eigen::MatrixXd Kplus = dense.pseudo_inverse();
      const Eigen::VectorXd gap   = dense.c - dense.B * (Kplus * (dense.f - dense.B.transpose() * x)); // F x - d
      // a: least squares on the rows that are strictly inside their bounds
      Eigen::MatrixXd G = dense.G.transpose();
      Eigen::VectorXd r = gap;
      for (int i = 0; i < x.size(); ++i)
        if (!(x[i] > l[i] && x[i] < u[i]))
          {
            G.row(i).setZero();
            r[i] = 0;
          }
      const Eigen::VectorXd g     = gap - dense.G.transpose() * G.colPivHouseholderQr().solve(r);
      const double          scale = (dense.P() * (dense.B * (Kplus * dense.f) - dense.c)).norm();
      for (int i = 0; i < x.size(); ++i)
        {
          bounds = std::max({bounds, l[i] - x[i], x[i] - u[i]});
          if (x[i] > l[i] && x[i] < u[i])
            free = std::max(free, std::abs(g[i]) / scale);
          else if (l[i] < u[i])
            active = std::max(active, (x[i] <= l[i] ? -g[i] : g[i]) / scale);
        }
      balance = (dense.G * x - dense.e).norm() / dense.e.norm();
    }

    double bounds = 0, free = 0, active = 0, balance = 0;
  };

  void expect_optimal(const Solved &solved)
  {
    EXPECT_EQ(solved.solution.status, qp::Status::converged);
    const Violations violations(solved);
    EXPECT_EQ(violations.bounds, 0);
    EXPECT_LT(violations.free, 1e-8);
    EXPECT_LT(violations.active, 1e-8);
    EXPECT_LT(violations.balance, 1e-8);
  }

  const std::vector<std::string> slip_bounds = {"", "0", "20", "60*(1+sin(x))", "1e7"};
} // namespace

TEST(ContactSolve, multipliers_are_optimal)
{
  for (const std::string &bound : slip_bounds)
    for (const Cut &how : four_cuts)
      {
        SCOPED_TRACE("slip bound " + bound + ", cut " + std::to_string(how.n));
        expect_optimal(Solved(cut(pushed_box(bound), how)));
      }
}

TEST(ContactSolve, contact_forces_agree_with_those_of_the_untorn_body)
{
  for (const std::string &bound : slip_bounds)
    {
      const auto expect = reference_forces(pushed_box(bound));
      for (const Cut &how : four_cuts)
        {
          SCOPED_TRACE("slip bound " + bound + ", cut " + std::to_string(how.n));
          expect_forces(contact_forces(Solved(cut(pushed_box(bound), how))), expect, 1e-6);
        }
    }
}

TEST(ContactSolve, contact_forces_of_degree_two_agree_with_those_of_the_untorn_body)
{
  const auto expect = reference_forces(pushed_box("20", 2));
  for (const Cut &how : {blocks(2), metis(6)})
    expect_forces(contact_forces(Solved(cut(pushed_box("20", 2), how))), expect, 1e-6);
}

TEST(ContactSolve, some_nodes_slip_some_stick_some_are_open)
{
  // otherwise the tests above compare less than they claim
  const Solved solved(cut(pushed_box("100"), blocks(2)));
  const auto   bounds = contact::slip_bounds(solved.torn.scene, *solved.dual, 1.);
  unsigned int n[4]   = {0, 0, 0, 0};
  for (const auto &point : solved.torn.constraints.contact_points)
    {
      const double tangential = std::abs(solved.solution.multipliers.local_element(point.tangential_row));
      ++n[tangential >= bounds[point.tangential_row]];
      ++n[2 + (solved.solution.multipliers.local_element(point.normal_row) > 0)];
    }
  for (const unsigned int one : n)
    EXPECT_GT(dealii::Utilities::MPI::sum(one, MPI_COMM_WORLD), 0u)
      << n[0] << " " << n[1] << " " << n[2] << " " << n[3];
}

TEST(ContactSolve, slip_bound_zero_is_no_friction)
{
  const auto expect = contact_forces(Solved(cut(pushed_box(""), whole())));
  for (const Cut &how : four_cuts)
    expect_forces(contact_forces(Solved(cut(pushed_box("0"), how))), expect, 1e-7);
}

TEST(ContactSolve, free_rows_are_those_strictly_inside_their_bounds)
{
  for (const Cut &how : four_cuts)
    {
      const Solved solved(cut(pushed_box("20"), how));
      const auto box = contact::multiplier_box(*solved.dual, contact::slip_bounds(solved.torn.scene, *solved.dual, 1.));
      unsigned long long n = 0;
      for (unsigned int r = 0; r < solved.solution.free.size(); ++r)
        {
          const double x = solved.solution.multipliers.local_element(r);
          EXPECT_EQ(bool(solved.solution.free[r]), x > box.lower.local_element(r) && x < box.upper.local_element(r));
          n += !solved.solution.free[r];
        }
      EXPECT_EQ(solved.solution.active_constraints, dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD));
    }
}

TEST(ContactSolve, residuals_reported_are_below_the_tolerance_when_converged)
{
  for (const double tolerance : {1e-3, 1e-6, 1e-9})
    {
      Scene scene            = cut(pushed_box("20"), blocks(2));
      scene.solver.tolerance = tolerance;
      const Solved solved(scene);
      EXPECT_EQ(solved.solution.status, qp::Status::converged);
      EXPECT_LE(solved.solution.projected_gradient, tolerance);
      EXPECT_LE(solved.solution.equality, tolerance);
    }
}

TEST(ContactSolve, iteration_limit_is_a_status)
{
  Scene scene                              = cut(pushed_box("20"), blocks(2));
  scene.solver.algorithm                   = scene::Algorithm::smalbe;
  scene.solver.smalbe.max_outer_iterations = 1;
  const Torn torn(scene);
  const auto dual = torn.dual();
  EXPECT_EQ(contact::solve(*dual, contact::slip_bounds(scene, *dual, 1.), contact::resolved_options(scene), {}).status,
            qp::Status::iteration_limit);
}

TEST(ContactSolve, observer_sees_every_outer_step_on_every_rank)
{
  for (const Scene &scene : {cut(pushed_box("20"), blocks(2)), cut(bent_box(8), blocks(2))})
    {
      const Torn   torn(scene);
      const auto   dual     = torn.dual();
      unsigned int n        = 0;
      const auto   solution = contact::solve(*dual,
                                           contact::slip_bounds(scene, *dual, 1.),
                                           contact::resolved_options(scene),
                                           [&](const qp::OuterStep &step) { EXPECT_EQ(step.outer, ++n); });
      // projected conjugate gradients are one outer step, of which every inner step is reported
      EXPECT_EQ(n,
                solution.algorithm == scene::Algorithm::pcg ? solution.counts.cg_steps
                                                            : solution.counts.outer_iterations);
      EXPECT_GT(n, 0u);
    }
}

TEST(ContactSolve, multiplications_are_all_counted)
{
  for (const Scene &scene : {cut(pushed_box("20"), blocks(2)), cut(bent_box(8), blocks(2))})
    {
      const Torn torn(scene);
      const auto dual   = torn.dual();
      const auto before = dual->dual_operator().n_applications();
      const auto solution =
        contact::solve(*dual, contact::slip_bounds(scene, *dual, 1.), contact::resolved_options(scene), {});
      EXPECT_EQ(dual->dual_operator().n_applications() - before, solution.counts.hessian_multiplications);
    }
}

TEST(ContactSolve, linear_scene_goes_to_conjugate_gradients)
{
  EXPECT_EQ(Solved(cut(bent_box(8), blocks(2))).solution.algorithm, scene::Algorithm::pcg);
  EXPECT_EQ(Solved(cut(pushed_box("20"), blocks(2))).solution.algorithm, scene::Algorithm::semismooth_newton);
}

// no loads, no contact

TEST(ContactSolve, no_loads_give_no_forces)
{
  for (const Cut &how : four_cuts)
    {
      Scene scene = pushed_box("20");
      scene.tractions.clear();
      const Solved solved(cut(scene, how));
      EXPECT_EQ(solved.solution.status, qp::Status::converged);
      for (const auto &[place, force] : contact_forces(solved))
        // residuals are relative to |P d|, in which gaps of up to 0.6 mm count: as forces, gap / |P F P|
        EXPECT_LT(std::abs(force[0]) + std::abs(force[1]), 1e-8 * 0.6 / solved.dual->norm());
    }
}

TEST(ContactSolve, linear_scene_without_loads_stays_at_rest)
{
  for (const Cut &how : four_cuts)
    {
      Scene scene = box(8);
      support(scene, 0, "left", "0", "0");
      const Solved solved(cut(scene, how));
      EXPECT_EQ(solved.solution.status, qp::Status::converged);
      for (const auto &u : solved.u)
        EXPECT_LT(u.cwiseAbs().maxCoeff(), 1e-15);
    }
}

TEST(ContactSolve, circle_that_is_not_reached_carries_nothing)
{
  for (const Cut &how : four_cuts)
    {
      Scene scene               = pushed_box("");
      scene.obstacles[0].radius = 10;
      for (const auto &[place, force] : contact_forces(Solved(cut(scene, how))))
        EXPECT_EQ(force[0], 0);
    }
}

TEST(ContactSolve, overlap_is_pushed_out)
{
  for (const Cut &how : {whole(), blocks(2), metis(6)})
    {
      Scene scene               = pushed_box("");
      scene.obstacles[0].radius = 20.05;
      expect_forces(contact_forces(Solved(cut(scene, how))), reference_forces(scene), 1e-6);
    }
}

// bodies held by contact alone

TEST(ContactSolve, floating_box_is_carried_by_the_circle)
{
  for (const Cut &how : four_cuts)
    {
      SCOPED_TRACE(how.n);
      const Solved solved(cut(floating_box("0.5", "-20-x"), how));
      expect_optimal(solved);
      std::vector<double> own(2, 0.);
      for (const auto &point : solved.torn.constraints.contact_points)
        for (const unsigned int d : {0, 1})
          {
            const double tangent = d == 0 ? -point.normal[1] : point.normal[0];
            own[d] += solved.solution.multipliers.local_element(point.normal_row) * point.normal[d] +
                      solved.solution.multipliers.local_element(point.tangential_row) * tangent;
          }
      const double sum_x = dealii::Utilities::MPI::sum(own[0], MPI_COMM_WORLD),
                   sum_y = dealii::Utilities::MPI::sum(own[1], MPI_COMM_WORLD);
      EXPECT_NEAR(sum_x, 5, 1e-6 * 250);
      EXPECT_NEAR(sum_y, -250, 1e-6 * 250);
    }
}

TEST(ContactSolve, load_that_lifts_the_box_off_has_no_equilibrium_on_any_rank)
{
  for (const Cut &how : four_cuts)
    {
      const Scene       scene = cut(floating_box("0", "5000"), how);
      const Torn        torn(scene);
      const auto        dual   = torn.dual();
      const auto        bounds = contact::slip_bounds(scene, *dual, 1.);
      const std::string text   = message_on_all_ranks<NoEquilibrium>(
        [&] { contact::solve(*dual, bounds, contact::resolved_options(scene), {}); });
      EXPECT_NE(text.find("body box: translation along ("), std::string::npos) << text;
      EXPECT_NE(text.find(", 1)"), std::string::npos) << text;
    }
}

TEST(ContactSolve, push_beyond_the_slip_bound_has_no_equilibrium_on_any_rank)
{
  for (const Cut &how : four_cuts)
    {
      const Scene       scene = cut(floating_box("200", "-20"), how);
      const Torn        torn(scene);
      const auto        dual   = torn.dual();
      const auto        bounds = contact::slip_bounds(scene, *dual, 1.);
      const std::string text   = message_on_all_ranks<NoEquilibrium>(
        [&] { contact::solve(*dual, bounds, contact::resolved_options(scene), {}); });
      EXPECT_NE(text.find("body box: "), std::string::npos) << text;
    }
}

TEST(ContactSolve, frictionless_box_on_a_circle_may_roll_off)
{
  Scene scene           = floating_box("0", "-20");
  scene.contacts[0].law = {};
  for (const Cut &how : four_cuts)
    {
      const std::string text = message_on_all_ranks<NoEquilibrium>([&] { Torn(cut(scene, how)).dual(); });
      EXPECT_NE(text.find("nothing holds body box: rotation about (5, -20)"), std::string::npos) << text;
    }
}

TEST(Solve, operator_in_single_precision_gives_the_solution_of_double)
{
  for (const auto algorithm : {scene::Algorithm::semismooth_newton, scene::Algorithm::smalbe})
    for (const auto &how : {blocks(4), metis(6)})
      {
        Scene scene                     = cut(pushed_box("60"), how);
        scene.solver.algorithm          = algorithm;
        scene.solver.dual.dual_operator = tfeti::DualOperatorKind::explicit_blocks;
        const auto         options      = contact::resolved_options(scene);
        tfeti::DualOptions single       = options.dual;
        single.operator_precision       = tfeti::Precision::single_precision;
        const Torn torn(scene);
        const auto in_double = torn.dual(options.dual), in_single = torn.dual(single);
        const auto solve = [&](tfeti::DualProblem &dual, const bool refined) {
          const contact::SlipLaw law(contact::slip_bounds(scene, dual, 1.));
          auto                   solution = refined ? contact::solve_refined(dual, law, options, scene.friction, {})
                                                    : contact::solve(dual, law, options, scene.friction, {});
          EXPECT_EQ(solution.status, qp::Status::converged);
          return solution;
        };
        const auto at = [&](const contact::DualSolution &solution) {
          return gathered(solution.multipliers, MPI_COMM_WORLD);
        };
        const auto exact = at(solve(*in_double, true)), rough = at(solve(*in_single, false));
        const auto refined = solve(*in_single, true);
        EXPECT_LE(refined.projected_gradient, scene.solver.tolerance);
        EXPECT_LT(relative_difference(at(refined), exact), 1e-8);
        EXPECT_GT(relative_difference(rough, exact), 1e-8); // otherwise this test says nothing
      }
}

TEST(Solve, linear_problem_in_single_precision_gives_the_solution_of_double)
{
  Scene scene               = cut(bent_box(8), blocks(4));
  scene.solver.tolerance    = 1e-10;
  const auto options        = contact::resolved_options(scene);
  auto       single         = options.dual;
  single.dual_operator      = tfeti::DualOperatorKind::explicit_blocks;
  single.operator_precision = tfeti::Precision::single_precision;
  const Torn                   torn(scene);
  const auto                   in_double = torn.dual(options.dual), in_single = torn.dual(single);
  std::vector<Eigen::VectorXd> x;
  for (auto *dual : {in_double.get(), in_single.get()})
    {
      const contact::SlipLaw law(contact::slip_bounds(scene, *dual, 1.));
      const auto             solution = contact::solve_refined(*dual, law, options, scene.friction, {});
      EXPECT_EQ(solution.status, qp::Status::converged);
      EXPECT_LE(solution.projected_gradient, scene.solver.tolerance);
      x.push_back(gathered(solution.multipliers, MPI_COMM_WORLD));
    }
  EXPECT_LT(relative_difference(x[1], x[0]), 1e-8);
}

TEST(Solve, gap_that_a_motion_closes_leaves_no_forces)
{
  for (const Cut &how : four_cuts)
    for (const std::string law : {"Tresca", "Coulomb"})
      {
        Scene scene = box(4);
        add_body(scene, "lid", {0, 10}, {10, 10}, {{6, 6}});
        support(scene, 0, "bottom", "0", "0");
        support(scene, 1, "top", "0", "1e-3");
        touch(scene, {1, "bottom"}, {0, "top"}, scene::make_law<2>(law, {"0.5"}));
        scene.contacts[0].offset = scene::Field<2>("-1e-3", "test");
        const Solved solved(cut(scene, how));
        EXPECT_EQ(solved.solution.status, qp::Status::converged);
        EXPECT_LE(solved.solution.counts.hessian_multiplications, 1u) << law;
        EXPECT_LT(solved.solution.multipliers.linfty_norm(), 1e-10) << law;
      }
}
