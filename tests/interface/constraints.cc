#include "torn.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/interface/echelon.h>

using namespace slipstick;
using namespace slipstick::test;
using tfeti::RowKind;

namespace
{
  tfeti::Constraints constraints(const Scene &scene, const MPI_Comm comm = MPI_COMM_WORLD)
  {
    const auto                 mesh = mesh::make_mesh(scene, comm);
    const mechanics::Spaces<2> spaces(mesh, scene.discretization.degree);
    return interface::contact_constraints(scene, mesh, spaces, 1.);
  }

  const std::vector<Cut> cuts = {whole(), blocks(2), blocks(4), metis(3), metis(7), metis(64)};

  /// A box that touches with its whole bottom and is held at its top: no contact node has a support.
  Scene hanging_box(const unsigned int n, const unsigned int degree = 1)
  {
    Scene scene               = box(n, degree);
    scene.bodies[0].thickness = 3;
    support(scene, 0, "top", "0", "1e-3*x");
    touch(scene, 0, "bottom", {4, -20}, 19, "100");
    return scene;
  }

  std::vector<tfeti::ContactPoint> contact_points(const Scene &scene)
  {
    std::vector<std::array<double, 9>> own;
    for (const auto &p : constraints(scene).contact_points)
      own.push_back({{p.position[0],
                      p.position[1],
                      p.normal[0],
                      p.normal[1],
                      p.gap,
                      p.area,
                      double(p.pair),
                      double(p.normal_row != tfeti::invalid_row),
                      double(p.tangential_row != tfeti::invalid_row)}});
    std::vector<tfeti::ContactPoint> all;
    for (const auto &p : gathered(own, MPI_COMM_WORLD))
      {
        tfeti::ContactPoint point;
        point.position = {{p[0], p[1], 0}};
        point.normal   = {{p[2], p[3], 0}};
        point.gap      = p[4];
        point.area     = p[5];
        point.pair     = static_cast<unsigned int>(p[6]);
        if (p[7] != 0)
          point.normal_row = 0;
        if (p[8] != 0)
          point.tangential_row = 0;
        all.push_back(point);
      }
    return all;
  }

  double total_area(const Scene &scene, const unsigned int pair)
  {
    double sum = 0;
    for (const auto &point : contact_points(scene))
      if (point.pair == pair)
        sum += point.area;
    return sum;
  }

  /// Identity and content of a row: label, kind, c, places and values of its entries. Sorted, of all ranks.
  using Row = std::tuple<std::uint64_t, unsigned int, double, std::vector<std::array<double, 4>>>;

  std::vector<Row> rows(const Scene &scene, const MPI_Comm comm)
  {
    const Torn                         torn(scene, comm);
    std::vector<std::array<double, 5>> entries; // row, place, component, value
    for (unsigned int p = 0; p < torn.matrices.size(); ++p)
      {
        const auto x = node_positions(torn.spaces, p);
        for (const auto &entry : torn.constraints.blocks[p])
          entries.push_back({{double(torn.constraints.rows->local_to_global(entry.row)),
                              x[entry.dof / 2][0],
                              x[entry.dof / 2][1],
                              double(entry.dof % 2),
                              entry.value}});
      }
    std::vector<unsigned int> own_kinds;
    for (const auto kind : torn.constraints.kind)
      own_kinds.push_back(unsigned(kind));
    const auto       labels = gathered(torn.constraints.label, comm);
    const auto       kinds  = gathered(own_kinds, comm);
    const auto       c      = gathered(torn.constraints.c, comm);
    std::vector<Row> all;
    for (unsigned int r = 0; r < labels.size(); ++r)
      all.push_back({labels[r], kinds[r], c[r], {}});
    for (const auto &[row, x, y, component, value] : gathered(entries, comm))
      std::get<3>(all[static_cast<unsigned int>(row)]).push_back({{x, y, component, value}});
    for (auto &row : all)
      std::sort(std::get<3>(row).begin(), std::get<3>(row).end());
    std::sort(all.begin(), all.end());
    return all;
  }
} // namespace

// counts

TEST(Constraints, of_the_papers_box_are_as_many_as_this_reading_has)
{
  const std::map<unsigned int, unsigned int> expect = {{1, 202}, {2, 808}, {4, 3232}};
  for (const auto &[N, total] : expect)
    EXPECT_EQ(constraints(cut(box_on_circle(50 * N, "500"), blocks(N))).counts.total(), total);
}

TEST(Constraints, of_blocks_follow_the_formulas)
{
  for (const unsigned int N : {1, 2, 3, 6})
    {
      const unsigned int n      = 12 / N;
      const auto         counts = constraints(cut(box_on_circle(12, "500"), blocks(N))).counts;
      EXPECT_EQ(counts.gluing, 2 * (n + 1) * (n + 1) * N * N - 2 * (n * N + 1) * (n * N + 1));
      EXPECT_EQ(counts.prescribed, 2 * (n * N + 1));
      EXPECT_EQ(counts.normal, n * N);
      EXPECT_EQ(counts.tangential, n * N);
      EXPECT_EQ(counts.candidates, n * N);
    }
}

TEST(Constraints, are_counted_by_kind)
{
  for (const Cut &how : cuts)
    {
      const Dense dense(Torn(cut(box_on_circle(8, "500"), how)));
      const auto  counts = constraints(cut(box_on_circle(8, "500"), how)).counts;
      const auto  n      = [&](const RowKind kind) {
        return std::size_t(std::count(dense.kind.begin(), dense.kind.end(), kind));
      };
      EXPECT_EQ(counts.gluing, n(RowKind::gluing));
      EXPECT_EQ(counts.prescribed, n(RowKind::prescribed));
      EXPECT_EQ(counts.normal, n(RowKind::normal));
      EXPECT_EQ(counts.tangential, n(RowKind::tangential));
      EXPECT_EQ(counts.total(), dense.kind.size());
    }
}

TEST(Constraints, one_subdomain_has_no_gluing)
{
  EXPECT_EQ(constraints(box_on_circle(6, "500")).counts.gluing, 0u);
}

TEST(Constraints, frictionless_contact_has_no_tangential_rows)
{
  const auto counts = constraints(cut(box_on_circle(6, ""), blocks(2))).counts;
  EXPECT_EQ(counts.tangential, 0u);
  EXPECT_EQ(counts.normal, 6u);
}

TEST(Constraints, linear_scene_has_no_contact_rows)
{
  const auto counts = constraints(cut(bent_box(6), blocks(2))).counts;
  EXPECT_EQ(counts.tangential + counts.normal + counts.candidates, 0u);
}

// independence

TEST(Constraints, rows_are_independent)
{
  for (const Cut &how : cuts)
    for (const unsigned int degree : {1, 2})
      {
        const Scene scene = cut(box_on_circle(8, "500", degree), how);
        if (how.n == 64 && degree == 2)
          continue;
        EXPECT_GT(smallest_singular_value(Dense(Torn(scene)).B), 1e-3) << how.n << ", degree " << degree;
      }
}

TEST(Constraints, gluing_and_supports_hold_the_torn_bodies_as_the_untorn_ones)
{
  // the kernel of the equality rows has as many dimensions as the untorn body has free unknowns
  for (const Cut &how : cuts)
    {
      const Dense                  dense(Torn(cut(hanging_box(8), how)));
      std::vector<Eigen::VectorXd> equality;
      for (unsigned int r = 0; r < dense.kind.size(); ++r)
        if (dense.kind[r] == RowKind::gluing || dense.kind[r] == RowKind::prescribed)
          equality.push_back(dense.B.row(r));
      EXPECT_EQ(dense.K.rows() - int(equality.size()), 2 * 81 - 2 * 9);
    }
}

TEST(Constraints, gluing_rows_join_copies_of_a_node)
{
  for (const Cut &how : cuts)
    for (const auto &[label, kind, c, entries] : rows(cut(bent_box(8, 2), how), MPI_COMM_WORLD))
      if (RowKind(kind) == RowKind::gluing)
        {
          ASSERT_EQ(entries.size(), 2u);
          EXPECT_NEAR(entries[0][0], entries[1][0], 1e-12);
          EXPECT_NEAR(entries[0][1], entries[1][1], 1e-12);
          EXPECT_EQ(entries[0][2], entries[1][2]);
          EXPECT_EQ(entries[0][3] + entries[1][3], 0);
          EXPECT_EQ(std::abs(entries[0][3]), 1);
          EXPECT_EQ(c, 0);
        }
}

TEST(Constraints, prescribed_rows_have_the_formulas_values)
{
  for (const Cut &how : cuts)
    for (const unsigned int degree : {1, 2})
      {
        const Scene scene = cut(bent_box(8, degree), how);
        for (const auto &[label, kind, c, entries] : rows(scene, MPI_COMM_WORLD))
          if (RowKind(kind) == RowKind::prescribed)
            {
              ASSERT_EQ(entries.size(), 1u);
              EXPECT_EQ(entries[0][3], 1);
              const Point x(entries[0][0], entries[0][1]);
              const bool  is_left = lies_on(scene.bodies[0], "left", x);
              EXPECT_NEAR(c, entries[0][2] == 0 ? 1e-3 * x[1] : is_left ? 2e-3 : 2e-3 - 1e-5 * x[0] * x[0], 1e-15);
            }
      }
}

TEST(Constraints, round_boundary_on_springs_along_its_normal_has_none_along_its_tangent)
{
  for (const unsigned int degree : {1, 2})
    for (const Cut &how : {whole(), metis(3)})
      {
        Scene scene                 = cut({}, how);
        scene.discretization.degree = degree;
        add_body(scene, "disc", {0, 0}, {1, 1}, {{1, 1}});
        scene.bodies[0].shape           = scene::Shape::disc;
        scene.bodies[0].radius          = 5;
        scene.bodies[0].cells_along_arc = 16;
        scene::Foundation<2> foundation;
        foundation.where            = {0, "arc"};
        foundation.normal_stiffness = 100;
        scene.foundations.push_back(foundation);
        const auto all = constraints(scene);
        EXPECT_EQ(all.counts.prescribed, 16 * degree);
        for (const double compliance : all.compliance)
          EXPECT_LT(compliance, 0.1); // 1 / (100 times a third of an edge, at least)
      }
}

TEST(Constraints, prescribed_values_follow_the_load_factor)
{
  Scene scene = box(2);
  support(scene, 0, "left", "3*t", "0");
  const Torn torn(scene, MPI_COMM_SELF, 0.5);
  EXPECT_NEAR(*std::max_element(torn.constraints.c.begin(), torn.constraints.c.end()), 1.5, 1e-15);
}

// contact nodes with a support

TEST(Constraints, contact_node_that_is_fully_held_has_no_contact_rows)
{
  for (const Cut &how : cuts)
    {
      const auto points = contact_points(cut(box_on_circle(8, "500"), how));
      EXPECT_EQ(points.size(), 8u);
      for (const auto &point : points)
        EXPECT_GT(point.position[0], 0);
    }
}

TEST(Constraints, contact_node_held_in_one_component_keeps_independent_rows)
{
  for (const std::string slip_bound : {"", "100"})
    for (const int component : {0, 1})
      for (const Cut &how : cuts)
        {
          Scene scene = box(8);
          support(scene, 0, "left", component == 0 ? "0" : "", component == 1 ? "0" : "");
          touch(scene, 0, "bottom", {4, -20}, 20, slip_bound);
          EXPECT_GT(smallest_singular_value(Dense(Torn(cut(scene, how))).B), 1e-3)
            << how.n << ", component " << component;
          for (const auto &point : contact_points(cut(scene, how)))
            if (point.position[0] == 0)
              {
                EXPECT_NE(point.normal_row, tfeti::invalid_row);
                EXPECT_EQ(point.tangential_row, tfeti::invalid_row);
              }
        }
}

TEST(Constraints, contact_node_held_along_its_normal_keeps_the_tangential_row)
{
  // the circle's centre below the corner: its normal is along y
  for (const Cut &how : cuts)
    {
      Scene scene = box(8);
      support(scene, 0, "left", "", "0");
      touch(scene, 0, "bottom", {0, -20}, 20, "100");
      unsigned int n = 0;
      for (const auto &point : contact_points(cut(scene, how)))
        if (point.position[0] == 0)
          {
            ++n;
            EXPECT_EQ(point.normal_row, tfeti::invalid_row);
            EXPECT_NE(point.tangential_row, tfeti::invalid_row);
          }
      EXPECT_EQ(n, 1u);
      EXPECT_GT(smallest_singular_value(Dense(Torn(cut(scene, how))).B), 1e-3);
    }
}

// contact geometry

TEST(Constraints, tributary_areas_sum_to_the_boundary)
{
  for (const unsigned int degree : {1, 2})
    for (const Cut &how : cuts)
      EXPECT_NEAR(total_area(cut(hanging_box(8, degree), how), 0), 10 * 3, 1e-12) << how.n << ", degree " << degree;
}

TEST(Constraints, tributary_areas_of_a_boundary_with_two_obstacles_sum_to_it_for_each)
{
  for (const unsigned int degree : {1, 2})
    {
      Scene scene = hanging_box(8, degree);
      touch(scene, 0, "bottom", {9, -15}, 12, "100");
      for (const Cut &how : cuts)
        {
          double sum[2] = {0, 0};
          for (const auto &point : contact_points(cut(scene, how)))
            sum[point.pair] += point.area;
          for (const double one : sum)
            EXPECT_NEAR(one, 10 * 3, 1e-10) << degree << ", cut " << how.n;
        }
    }
}

TEST(Constraints, tributary_areas_are_integrals_of_the_shape_functions)
{
  for (const Cut &how : cuts)
    {
      for (const auto &point : contact_points(cut(hanging_box(8), how)))
        EXPECT_NEAR(point.area, point.position[0] == 0 || point.position[0] == 10 ? 1.25 * 3 / 2 : 1.25 * 3, 1e-13);
      for (const auto &point : contact_points(cut(hanging_box(8, 2), how)))
        {
          const bool is_middle = std::fmod(point.position[0] + 1e-9, 1.25) > 0.1;
          const bool is_end    = point.position[0] == 0 || point.position[0] == 10;
          EXPECT_NEAR(point.area, 1.25 * 3 * (is_middle ? 4. : is_end ? 1. : 2.) / 6, 1e-13);
        }
    }
}

TEST(Constraints, gaps_and_normals_are_those_of_the_circle)
{
  for (const unsigned int degree : {1, 2})
    for (const Cut &how : cuts)
      for (const auto &point : contact_points(cut(hanging_box(8, degree), how)))
        {
          const double x = point.position[0] - 4, distance = std::hypot(x, 20.);
          EXPECT_EQ(point.position[1], 0);
          EXPECT_NEAR(point.gap, distance - 19, 1e-13);
          EXPECT_NEAR(point.normal[0], -x / distance, 1e-15);
          EXPECT_NEAR(point.normal[1], -20 / distance, 1e-15);
        }
}

TEST(Constraints, normal_rows_measure_the_closing_of_the_gap_and_tangential_rows_the_slip)
{
  for (const Cut &how : cuts)
    for (const auto &[label, kind, c, entries] : rows(cut(hanging_box(8), how), MPI_COMM_WORLD))
      if (RowKind(kind) == RowKind::normal || RowKind(kind) == RowKind::tangential)
        {
          const double x = entries[0][0] - 4, distance = std::hypot(x, 20.);
          const Point  normal(-x / distance, -20 / distance), tangent(-normal[1], normal[0]);
          double       along_x = 0, along_y = 0;
          for (const auto &entry : entries)
            (entry[2] == 0 ? along_x : along_y) += entry[3];
          const Point expect = RowKind(kind) == RowKind::normal ? normal : tangent;
          EXPECT_NEAR(along_x, expect[0], 1e-15);
          EXPECT_NEAR(along_y, expect[1], 1e-15);
          EXPECT_NEAR(c, RowKind(kind) == RowKind::normal ? distance - 19 : 0, 1e-13);
        }
}

TEST(Constraints, contact_points_know_their_rows)
{
  for (const Cut &how : cuts)
    {
      const auto B = constraints(cut(hanging_box(8), how));
      for (const auto &point : B.contact_points)
        {
          ASSERT_LT(point.normal_row, B.kind.size());
          ASSERT_LT(point.tangential_row, B.kind.size());
          EXPECT_EQ(B.kind[point.normal_row], RowKind::normal);
          EXPECT_EQ(B.kind[point.tangential_row], RowKind::tangential);
          EXPECT_EQ(B.c[point.normal_row], point.gap);
        }
    }
}

TEST(Constraints, contact_node_at_the_centre_of_its_circle_is_refused_on_all_ranks)
{
  for (const Cut &how : {whole(), blocks(2), metis(7)})
    {
      Scene scene = box(8);
      touch(scene, 0, "bottom", {5, 0}, 1, "");
      const std::string text = message_on_all_ranks<InputError>([&] { constraints(cut(scene, how)); });
      EXPECT_NE(text.find("circle"), std::string::npos) << text;
    }
}

// distribution

TEST(Constraints, rows_do_not_depend_on_the_number_of_ranks)
{
  for (const unsigned int degree : {1, 2})
    for (const Cut &how : cuts)
      {
        const Scene scene = cut(box_on_circle(8, "500", degree), how);
        EXPECT_TRUE(rows(scene, MPI_COMM_WORLD) == rows(scene, MPI_COMM_SELF)) << how.n << ", degree " << degree;
      }
}

TEST(Constraints, labels_of_rows_are_different)
{
  for (const Cut &how : cuts)
    {
      std::set<std::uint64_t> labels;
      const auto              all = rows(cut(box_on_circle(8, "500", 2), how), MPI_COMM_WORLD);
      for (const auto &row : all)
        labels.insert(std::get<0>(row));
      EXPECT_EQ(labels.size(), all.size());
    }
}

TEST(Constraints, interface_unknowns_are_one_for_all_copies)
{
  for (const Cut &how : cuts)
    {
      const Torn                         torn(cut(hanging_box(8), how));
      std::vector<std::array<double, 4>> own; // interface unknown, place, component
      for (unsigned int p = 0; p < torn.matrices.size(); ++p)
        {
          const auto x = node_positions(torn.spaces, p);
          for (const auto &entry : torn.constraints.interface_blocks[p])
            own.push_back({{double(torn.constraints.interface_dofs->local_to_global(entry.interface_dof)),
                            x[entry.dof / 2][0],
                            x[entry.dof / 2][1],
                            double(entry.dof % 2)}});
        }
      std::map<double, std::set<std::array<double, 3>>> places;
      std::set<std::array<double, 3>>                   all;
      for (const auto &[unknown, x, y, component] : gathered(own, MPI_COMM_WORLD))
        {
          places[unknown].insert(std::array<double, 3>{{x, y, component}});
          all.insert(std::array<double, 3>{{x, y, component}});
        }
      for (const auto &[unknown, at] : places)
        EXPECT_EQ(at.size(), 1u);
      EXPECT_EQ(all.size(), places.size());
      EXPECT_EQ(places.size(), torn.constraints.interface_dofs->size());
    }
}

// supports that contradict each other

TEST(Constraints, contradictory_supports_at_a_corner_are_refused_on_all_ranks)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(8);
      support(scene, 0, "right", "0.25", "");
      support(scene, 0, "top", "0.5", "");
      const std::string text = message_on_all_ranks<InputError>([&] { constraints(cut(scene, how)); });
      for (const std::string part : {"0.25", "0.5", "displacement x", "(10, 10)", "remedy: "})
        EXPECT_NE(text.find(part), std::string::npos) << text;
    }
}

TEST(Constraints, supports_that_agree_at_a_corner_give_one_row)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(8);
      support(scene, 0, "right", "1e-3*y", "0");
      support(scene, 0, "top", "1e-2", "");
      EXPECT_EQ(constraints(cut(scene, how)).counts.prescribed, 18u + 8);
    }
}

TEST(Echelon, finds_rows_that_others_imply)
{
  interface::Echelon rows;
  EXPECT_TRUE(rows.add({{0, 1.}, {2, -1.}}, 1e-8, 0, 2));
  EXPECT_TRUE(rows.add({{2, 1.}, {4, -0.5}, {5, -0.5}}, 1e-8, 2, 4));
  EXPECT_FALSE(rows.add({{0, 3.}, {4, -1.5}, {5, -1.5}}, 1e-8, 4, 6));
  EXPECT_TRUE(rows.reduce({{0, 1.}, {2, 1.}, {4, -1.}, {5, -1.}}).empty());
  EXPECT_TRUE(rows.add({{0, 3.}, {4, -1.5}, {5, -1.4}}, 1e-8, 4, 6));
  EXPECT_FALSE(rows.reduce({{6, 1.}, {0, 1.}}).empty());
}
