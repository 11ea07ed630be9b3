#include "tools.h"

using namespace slipstick;
using namespace slipstick::test;
using scene::read_scene;
using scene::Shape;

namespace
{
  /// A scene of one held body, its section given line by line.
  std::string scene_of(const std::string &body, const std::string &boundary = "*")
  {
    return "set Materials = steel\nset Bodies = part\nset Supports = held\nsubsection Material steel\nend\n"
           "subsection Body part\n  set Material = steel\n" +
           body + "end\nsubsection Support held\n  set Boundary = part/" + boundary +
           "\n  set Displacement x = 0\nend\n";
  }

  scene::Scene<2> read(const std::string &body, const std::string &boundary = "*")
  {
    TemporaryDirectory directory;
    return read_scene(directory.write("scene.prm", scene_of(body, boundary)));
  }

  void body_refused(const std::string &body, const std::vector<std::string> &parts, const std::string &boundary = "*")
  {
    expect_parts(error_of([&] { read(body, boundary); }), parts);
  }
} // namespace

TEST(bodies, shapes_with_their_parameters)
{
  const auto disc = read("set Shape = disc\nset Center = 1, 2\nset Radius = 3\nset Cells along arc = 24\n").bodies[0];
  EXPECT_EQ(disc.shape, Shape::disc);
  EXPECT_EQ(disc.center, dealii::Point<2>(1, 2));
  EXPECT_EQ(disc.radius, 3);
  EXPECT_EQ(disc.cells_along_arc, 24u);
  const auto ring =
    read("set Shape = quarter ring\nset Radius = 3\nset Inner radius = 2\nset Cells = 8, 4\n").bodies[0];
  EXPECT_EQ(ring.shape, Shape::quarter_ring);
  EXPECT_EQ(ring.inner_radius, 2);
  EXPECT_EQ((*ring.cells)[1], 4u);
  const auto placed =
    read("set Shape = half disc\nset Radius = 3\nset Mirror = y\nset Rotation = -30\nset Translation = 5, 6\n"
         "set Refinements = 2\nset Refine towards = arc, flat\nset Refine levels = 3\n",
         "arc")
      .bodies[0];
  EXPECT_FALSE(placed.placement.mirror_x);
  EXPECT_TRUE(placed.placement.mirror_y);
  EXPECT_EQ(placed.placement.rotation, -30);
  EXPECT_EQ(placed.placement.translation, dealii::Point<2>(5, 6));
  EXPECT_EQ(placed.refinements, 2u);
  EXPECT_EQ(placed.refined_boundaries, (std::vector<std::string>{"arc", "flat"}));
  EXPECT_EQ(placed.boundary_refinements, 3u);
}

TEST(bodies, parameters_must_fit_the_shape)
{
  body_refused("set Size = 1, 1\nset Radius = 3\n",
               {"Body part/Radius = '3'", "has no meaning for Shape = rectangle", "disc"});
  body_refused("set Shape = disc\nset Radius = 3\nset Size = 2, 1\n", {"Body part/Size", "rectangle"});
  body_refused("set Shape = disc\nset Radius = 3\nset Cells = 2, 1\n",
               {"Body part/Cells", "rectangle, ring, quarter ring"});
  body_refused("set Size = 1, 1\nset File = a.msh\n", {"Body part/File", "it belongs to mesh"});
}

TEST(bodies, required_parameters_are_named)
{
  body_refused("", {"Size is not set"});
  body_refused("set Shape = disc\n", {"Radius is not set"});
  body_refused("set Shape = ring\nset Radius = 2\n", {"Inner radius is not set"});
  body_refused("set Shape = mesh\n", {"File is not set"});
}

TEST(bodies, values_must_make_sense)
{
  body_refused("set Shape = ring\nset Radius = 2\nset Inner radius = 2\n",
               {"Body part/Inner radius = '2'", "not less than Radius = 2"});
  body_refused("set Shape = ring\nset Radius = 2\nset Inner radius = 1\nset Cells = 2, 2\n",
               {"at least 3 cells along its circumference"});
  body_refused("set Shape = disc\nset Radius = 2\nset Cells along arc = 30\n", {"multiple of 4"});
  body_refused("set Shape = half disc\nset Radius = 2\nset Cells along arc = 5\n", {"even number"});
  body_refused("set Size = 1, 1\nset Refine levels = 1\n", {"no boundary is named in Refine towards"});
  body_refused("set Size = 1, 1\nset Refine towards = top\n", {"Refine towards = 'top'", "set Refine levels = 1"});
  body_refused("set Size = 1, 1\nset Refine towards = botom\n", {"has no boundary 'botom'", "did you mean 'bottom'"});
  body_refused("set Size = 1, 1\nset Mirror = z\n", {"'z'", "none, x, y"});
  body_refused("set Shape = disc\nset Radius = 2\n", {"has no boundary 'left'", "arc"}, "left");
  body_refused("set Shape = mesh\nset File = nowhere.msh\n", {"Body part/File = 'nowhere.msh'", "no such file"});
}

TEST(bodies, names_of_a_mesh_are_left_for_later)
{
  TemporaryDirectory directory;
  directory.write("part.msh", "");
  const auto file =
    directory.write("scene.prm", scene_of("set Shape = mesh\nset File = part.msh\n", "any name/at all"));
  const auto scene = read_scene(file);
  EXPECT_EQ(scene.supports[0].where.boundary, "any name/at all");
  EXPECT_EQ(scene.decomposition.method, scene::DecompositionMethod::metis);
}

TEST(bodies, mesh_file_is_sought_from_the_scene_and_printed_so_that_it_is_found_from_anywhere)
{
  TemporaryDirectory directory, elsewhere;
  directory.write("part.msh", "");
  const auto scene = read_scene(directory.write("scene.prm", scene_of("set Shape = mesh\nset File = part.msh\n")));
  EXPECT_EQ(std::filesystem::path(scene.bodies[0].file), directory.path / "part.msh");
  const auto again = read_scene(elsewhere.write("parameters.prm", scene.parameters));
  EXPECT_EQ(again.bodies[0].file, scene.bodies[0].file);
  EXPECT_EQ(again.parameters, scene.parameters);
}

TEST(bodies, what_is_printed_reads_back_for_every_shape)
{
  TemporaryDirectory directory;
  for (const std::string body : {"set Size = 2, 1\n",
                                 "set Shape = disc\nset Radius = 3\nset Center = 1, 2\n",
                                 "set Shape = half disc\nset Radius = 3\nset Mirror = y\n",
                                 "set Shape = ring\nset Radius = 3\nset Inner radius = 1\nset Cells = 8, 2\n",
                                 "set Shape = quarter ring\nset Radius = 3\nset Inner radius = 1\nset Rotation = 90\n"})
    {
      const auto first = read(body);
      const auto again = read_scene(directory.write("parameters.prm", first.parameters));
      EXPECT_EQ(first.parameters, again.parameters) << body;
      EXPECT_EQ(first.bodies[0].shape, again.bodies[0].shape);
      EXPECT_EQ(first.bodies[0].radius, again.bodies[0].radius);
    }
}

TEST(bodies, automatic_decomposition)
{
  using scene::DecompositionMethod;
  EXPECT_EQ(read("set Size = 2, 1\n").decomposition.method, DecompositionMethod::blocks);
  EXPECT_EQ(read("set Size = 2, 1\nset Cells = 7, 3\n").decomposition.method, DecompositionMethod::metis);
  EXPECT_EQ(read("set Shape = disc\nset Radius = 3\n").decomposition.method, DecompositionMethod::metis);
  const std::string blocks = "end\nsubsection Decomposition\nset Method = blocks\n";
  body_refused("set Shape = disc\nset Radius = 3\n" + blocks,
               {"Decomposition/Method = 'blocks'", "'part' is not one", "METIS or auto"});
  body_refused("set Size = 2, 1\nset Refine towards = top\nset Refine levels = 1\n" + blocks, {"equal cells only"});
}
