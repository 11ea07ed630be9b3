// Every scene in prm/ reads, means what it says, and survives the round trip; overrides; the listing.
#include "tools.h"

#include <algorithm>

using namespace slipstick;
using namespace slipstick::scene;
using namespace slipstick::test;

namespace
{
  /// Those of a dimension.
  std::vector<std::string> shipped_scenes(const unsigned int dim = 2)
  {
    std::vector<std::string> files;
    for (const auto &entry : std::filesystem::directory_iterator(std::string(SLIPSTICK_SOURCE_DIR) + "/prm"))
      if (entry.path().extension() == ".prm" && read_dimension(entry.path().string()) == dim)
        files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
  }

  std::string field(const Field<2> &value)
  {
    return value.formula() + (value.is_constant() ? "" : " (formula)");
  }

  std::string where(const BoundaryName &name)
  {
    return std::to_string(name.body) + "/" + name.boundary;
  }

  /// Every member of the scene but its name and parameters.
  std::string describe(const Scene<2> &scene)
  {
    std::ostringstream out;
    out << std::hexfloat << scene.title << '|' << int(scene.plane_state) << '\n';
    for (const auto &m : scene.materials)
      out << m.name << ' ' << m.young_modulus << ' ' << m.poisson_ratio << '\n';
    for (const auto &b : scene.bodies)
      {
        out << b.name << ' ' << int(b.shape) << ' ' << b.origin << ' ' << b.size << ' ' << b.material << ' '
            << b.thickness;
        if (b.cells)
          out << ' ' << (*b.cells)[0] << 'x' << (*b.cells)[1];
        out << '\n';
      }
    for (const auto &s : scene.supports)
      for (unsigned int d = 0; d < 2; ++d)
        out << s.name << ' ' << where(s.where) << ' ' << (s.components[d] ? field(*s.components[d]) : "-") << '\n';
    for (const auto &t : scene.tractions)
      out << t.name << ' ' << where(t.where) << ' ' << field(t.components[0]) << ' ' << field(t.components[1]) << '\n';
    for (const auto &o : scene.obstacles)
      out << o.name << ' ' << int(o.shape) << ' ' << o.center << ' ' << o.radius << '\n';
    for (const auto &c : scene.contacts)
      out << c.name << ' ' << where(c.slave) << ' ' << c.obstacle << ' ' << c.law.name << ' '
          << (c.law.fixed ? field(c.law.fixed->value) : "-") << '\n';
    const auto &d = scene.decomposition;
    out << int(d.method) << ' ' << d.blocks << ' ' << d.cells_per_block << ' ' << d.subdomains << ' '
        << scene.discretization.degree << ' ' << scene.discretization.refinements << '\n';
    const auto &s = scene.solver;
    out << int(s.algorithm) << ' ' << s.tolerance << ' ' << s.smalbe.initial_balance << ' '
        << s.smalbe.balance_reduction << ' ' << s.smalbe.regularization << ' ' << s.smalbe.max_outer_iterations << ' '
        << int(s.smalbe.inner.expansion) << ' ' << s.smalbe.inner.proportioning << ' ' << s.smalbe.inner.step_length
        << ' ' << s.smalbe.inner.max_iterations << ' ' << s.pcpg.max_iterations << ' ' << int(s.dual.dual_operator)
        << ' ' << int(s.dual.preconditioner) << ' ' << s.dual.max_norm_iterations << ' ' << s.dual.norm_tolerance << ' '
        << scene.output.vtu << '\n';
    return out.str();
  }

  std::string listing(const ListFormat format)
  {
    std::ostringstream text;
    list_parameters(text, format);
    return text.str();
  }
} // namespace

TEST(shipped_scenes, every_prm_reads)
{
  EXPECT_GE(shipped_scenes().size(), 4u);
  for (const std::string &file : shipped_scenes())
    EXPECT_NO_THROW(read_scene(file)) << file;
  EXPECT_GE(shipped_scenes(3).size(), 1u);
  for (const std::string &file : shipped_scenes(3))
    EXPECT_NO_THROW(read_scene<3>(file)) << file;
}

TEST(shipped_scenes, box_on_circle_is_the_paper_s)
{
  const auto scene = box({});
  EXPECT_EQ(scene.name, "box_on_circle");
  EXPECT_EQ(scene.plane_state, PlaneState::plane_stress);
  EXPECT_EQ(scene.materials.at(0).young_modulus, 1e5);
  EXPECT_EQ(scene.materials.at(0).poisson_ratio, 0.35);
  EXPECT_EQ(scene.bodies.at(0).size, dealii::Point<2>(10, 10));
  EXPECT_FALSE(scene.bodies[0].cells);
  EXPECT_EQ(scene.obstacles.at(0).center, dealii::Point<2>(5, -20));
  EXPECT_EQ(scene.obstacles[0].radius, 20);
  EXPECT_EQ(scene.supports.at(0).where.boundary, "left");
  EXPECT_TRUE(scene.supports[0].components[0] && scene.supports[0].components[1]);
  EXPECT_EQ(scene.tractions.at(0).components[1].value({3, 10}, 1), -250);
  EXPECT_EQ(scene.contacts.at(0).name, "circle");
  EXPECT_EQ(scene.contacts[0].slave.boundary, "bottom");
  EXPECT_EQ(scene.contacts[0].law.name, "Tresca");
  EXPECT_EQ(scene.contacts[0].law.fixed->value.value({5, 0}, 1), 500);
  EXPECT_EQ(scene.decomposition.blocks, 4u);
  EXPECT_EQ(scene.decomposition.cells_per_block, 50u);
  EXPECT_EQ(scene.solver.tolerance, 1e-4);
}

TEST(round_trip, parameters_of_every_scene_read_back_as_the_same_scene)
{
  const std::vector<std::string> overrides = {"Solver/Tolerance=1.2345678901234567e-7",
                                              "Friction/Tolerance=0.1",
                                              "Solver/SMALBE/Expansion=projected CG",
                                              "Solver/Algorithm=auto"};
  TemporaryDirectory             directory;
  for (const std::string &file : shipped_scenes())
    {
      const auto first = read_scene(file, overrides);
      const auto again = read_scene(directory.write("parameters.prm", first.parameters));
      EXPECT_EQ(describe(first), describe(again)) << file;
      EXPECT_EQ(first.parameters, again.parameters) << file;
    }
}

TEST(round_trip, parameters_of_solids_read_back)
{
  TemporaryDirectory directory;
  for (const std::string &file : shipped_scenes(3))
    {
      const auto first = read_scene<3>(file);
      EXPECT_EQ(read_scene<3>(directory.write("parameters.prm", first.parameters)).parameters, first.parameters)
        << file;
      EXPECT_EQ(read_dimension((directory.path / "parameters.prm").string()), 3u);
    }
}

TEST(round_trip, formulas_and_cells_read_back)
{
  const auto         first = box({"Traction pressed/Traction y=x < 5 ? -250 : -100*sin(pi*x/10)*t",
                                  "Body box/Cells=40,20",
                                  "Support held/Displacement y=free"});
  TemporaryDirectory directory;
  const auto         again = read_scene(directory.write("parameters.prm", first.parameters));
  EXPECT_EQ(describe(first), describe(again));
  EXPECT_EQ(again.tractions[0].components[1].value({2, 0}, 1), -250);
}

TEST(overrides, reach_nested_sections)
{
  const auto scene = box({"Solver/SMALBE/Expansion=gradient projection", "Solver/SMALBE/Max outer iterations=7"});
  EXPECT_EQ(scene.solver.smalbe.inner.expansion, qp::Expansion::gradient_projection);
  EXPECT_EQ(scene.solver.smalbe.max_outer_iterations, 7u);
}

TEST(overrides, reach_named_sections)
{
  EXPECT_EQ(box({"Contact circle/Slip bound=150"}).contacts[0].law.fixed->value.value({0, 0}, 1), 150);
  EXPECT_EQ(box({"Contact circle/Law=frictionless"}).contacts[0].law.name, "frictionless");
}

TEST(overrides, the_last_one_wins)
{
  EXPECT_EQ(box({"Decomposition/Blocks=2", "Decomposition/Blocks=8"}).decomposition.blocks, 8u);
}

TEST(overrides, lists_and_the_sections_they_declare)
{
  const auto scene = box({"Bodies=box, wedge",
                          "Body wedge/Size=1, 2",
                          "Body wedge/Material=elastic",
                          "Supports=held, foot",
                          "Support foot/Boundary=wedge/bottom",
                          "Support foot/Displacement y=0"});
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[1].size, dealii::Point<2>(1, 2));
  ASSERT_EQ(scene.supports.size(), 2u);
  EXPECT_EQ(scene.supports[1].where.body, 1u);
  EXPECT_FALSE(scene.supports[1].components[0]);
}

TEST(overrides, all_fixed_names_and_values_are_accepted)
{
  for (const std::string text : {"Decomposition/Method=METIS",
                                 "Decomposition/Method=none",
                                 "Decomposition/Cells per block=5",
                                 "Decomposition/Subdomains=7",
                                 "Decomposition/Subdomains=auto",
                                 "Discretization/Degree=2",
                                 "Discretization/Refinements=1",
                                 "Solver/Algorithm=smalbe",
                                 "Solver/Preconditioner=lumped",
                                 "Solver/Preconditioner=Dirichlet",
                                 "Solver/Dual operator=explicit",
                                 "Solver/Dual operator=implicit",
                                 "Material elastic/Young modulus=2.1e5",
                                 "Material elastic/Poisson ratio=-0.5",
                                 "Plane state=plane strain",
                                 "Title=another"})
    EXPECT_NO_THROW(box({text})) << text;
}

TEST(overrides, unused_materials_and_obstacles_are_allowed)
{
  EXPECT_NO_THROW(box({"Materials=elastic, spare",
                       "Material spare/Young modulus=1",
                       "Obstacles=disc, other",
                       "Obstacle other/Center=0, 0",
                       "Obstacle other/Radius=1"}));
}

TEST(listing, as_prm_is_a_scene_that_reads)
{
  TemporaryDirectory directory;
  EXPECT_NO_THROW(read_scene(directory.write("listed.prm", listing(ListFormat::prm))));
}

TEST(listing, every_format_names_every_kind_of_section)
{
  for (const auto format : {ListFormat::text, ListFormat::prm, ListFormat::json, ListFormat::latex})
    expect_parts(listing(format),
                 {"Young modulus",
                  "Contact circle",
                  "Slip bound",
                  "Support held",
                  "Traction pressed",
                  "Obstacle disc",
                  "Body box",
                  "Cells per block",
                  "Max inner iterations",
                  "Dual operator"});
}

TEST(listing, text_gives_unit_range_and_default)
{
  expect_parts(listing(ListFormat::text),
               {"Material elastic/Young modulus = 210000 [MPa]",
                "allowed: a number in [1e-20, 1e+20]",
                "default: 210000"});
}
