#include "mesh_quality.h"
#include "torn.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/mesh/make_body.h>
#include <slipstick/mesh/size_check.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <unistd.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  std::string path_of(const std::string &name)
  {
    return std::string(SLIPSTICK_MESHES) + "/" + name;
  }

  std::string content_of(const std::string &name)
  {
    std::ifstream      in(path_of(name), std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }

  const std::vector<std::string> formats = {"two_parts_msh22.msh",
                                            "two_parts_msh22.bin.msh",
                                            "two_parts_msh41.msh",
                                            "two_parts_msh41.bin.msh",
                                            "two_parts_curved.msh"};

  scene::Body<2> body_of(const std::string &file, const std::string &part)
  {
    scene::Body<2> body;
    body.name  = part.empty() ? "all" : part;
    body.shape = scene::Shape::mesh;
    body.file  = path_of(file);
    body.part  = part;
    return body;
  }

  /// Block and roof of one file.
  Scene two_parts(const std::string &file)
  {
    Scene scene;
    scene.bodies = {body_of(file, "block"), body_of(file, "roof")};
    return scene;
  }

  double length_of(const mesh::BodyMesh<2> &mesh, const std::string &name)
  {
    const auto id     = mesh.boundary_ids.at(name);
    double     length = test::length_of(mesh.piece, id);
    for (const auto &[combined, names] : mesh.combined_ids)
      if (names.count(id) > 0)
        length += test::length_of(mesh.piece, combined);
    return length;
  }

  /// A mesh in Gmsh's version 2: nodes, and elements without their numbers.
  std::string gmsh_2(const std::vector<std::array<double, 3>> &nodes, const std::vector<std::string> &elements)
  {
    std::ostringstream text;
    text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << nodes.size() << "\n";
    for (unsigned int k = 0; k < nodes.size(); ++k)
      text << k + 1 << " " << nodes[k][0] << " " << nodes[k][1] << " " << nodes[k][2] << "\n";
    text << "$EndNodes\n$Elements\n" << elements.size() << "\n";
    for (unsigned int k = 0; k < elements.size(); ++k)
      text << k + 1 << " " << elements[k] << "\n";
    text << "$EndElements\n";
    return text.str();
  }

  mesh::BodyMesh<2> body_of_text(const std::string &text, const std::string &part = "")
  {
    auto body = body_of("typed.msh", part);
    return mesh::body_from_file(body, mesh::parse_gmsh(body.file, text));
  }

  /// The message of the InputError that @p f throws.
  std::string refusal(const std::function<void()> &f)
  {
    try
      {
        f();
      }
    catch (const InputError &error)
      {
        return error.what();
      }
    return "nothing was refused";
  }

#define EXPECT_SAYS(text, word) EXPECT_NE((text).find(word), std::string::npos) << (text)

  const std::vector<std::array<double, 3>> square =
    {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}, {{2, 0, 0}}, {{2, 1, 0}}};
} // namespace

TEST(MeshFiles, all_formats_of_gmsh_give_the_same_bodies)
{
  for (const std::string &format : formats)
    {
      const auto file  = mesh::read_mesh_file(path_of(format));
      const auto block = mesh::body_from_file(body_of(format, "block"), file);
      const auto roof  = mesh::body_from_file(body_of(format, "roof"), file);
      EXPECT_EQ(block.piece.cells.size(), 8u) << format;
      EXPECT_EQ(block.piece.vertices.size(), 15u) << format;
      EXPECT_EQ(quality_of(block.piece).n_triangles, 0u);
      EXPECT_NEAR(quality_of(block.piece).area, 2, 1e-10) << format;
      EXPECT_EQ(quality_of(roof.piece).n_triangles, roof.piece.cells.size());
      EXPECT_NEAR(quality_of(roof.piece).area, 2, 1e-10);
      EXPECT_TRUE(quality_of(block.piece).conforming);
      EXPECT_TRUE(quality_of(roof.piece).conforming);
      EXPECT_TRUE(block.remarks.empty());
      EXPECT_EQ(block.middles.empty(), format != "two_parts_curved.msh");

      EXPECT_EQ(block.boundary_ids.size(), 4u);
      EXPECT_NEAR(length_of(block, "foot"), 2, 1e-10);
      EXPECT_NEAR(length_of(block, "interface"), 2, 1e-10);
      EXPECT_NEAR(length_of(block, "right side"), 1, 1e-10);
      EXPECT_NEAR(length_of(block, "outline"), 4, 1e-10);
      EXPECT_EQ(roof.boundary_ids.size(), 2u);
      EXPECT_NEAR(length_of(roof, "interface"), 2, 1e-10);
      EXPECT_NEAR(length_of(roof, "right side"), std::sqrt(5), 1e-10);

      EXPECT_EQ(block.points.size(), 2u);
      EXPECT_LT(block.piece.vertices[block.points.at("corner")].distance(Point(0, 0)), 1e-10);
      EXPECT_LT(block.piece.vertices[block.points.at("shoulder")].distance(Point(2, 1)), 1e-10);
      EXPECT_EQ(roof.points.size(), 2u);
      EXPECT_LT(roof.piece.vertices[roof.points.at("top")].distance(Point(1, 3)), 1e-10);
    }
}

TEST(MeshFiles, bodies_of_one_file_do_not_share_vertices)
{
  for (const Cut &how : {whole(), metis(5)})
    {
      const auto mesh = mesh::make_mesh(cut(two_parts(formats[2]), how), MPI_COMM_WORLD);
      EXPECT_EQ(mesh.n_subdomains(), how.n == 1 ? 2u : 5u);
      std::vector<mesh::GlobalVertex> own;
      for (const auto &subdomain : mesh.subdomains)
        for (const auto v : subdomain->global_vertices)
          own.push_back(subdomain->body == 0 ? v : v + 1000);
      std::set<mesh::GlobalVertex> block, roof;
      for (const auto v : gathered(own, MPI_COMM_WORLD))
        (v < 1000 ? block : roof).insert(v % 1000);
      EXPECT_EQ(block.size(), 15u);
      EXPECT_LT(*block.rbegin(), *roof.begin());
      // every rank knows names and points
      EXPECT_EQ(mesh.boundary_ids[1].count("interface"), 1u);
      EXPECT_LT(mesh.points[1].at("top").position.distance(Point(1, 3)), 1e-10);
      EXPECT_EQ(roof.count(mesh.points[1].at("top").vertex), 1u);
    }
}

TEST(MeshFiles, a_face_lies_on_all_its_boundaries)
{
  const auto                    mesh = mesh::make_mesh(cut(two_parts(formats[0]), metis(6)), MPI_COMM_WORLD);
  std::map<std::string, double> length;
  for (const auto &subdomain : mesh.subdomains)
    for (const auto &cell : subdomain->triangulation.active_cell_iterators())
      for (const auto &face : cell->face_iterators())
        if (subdomain->body == 0 && face->at_boundary())
          for (const std::string name : {"foot", "outline", "right side", "*"})
            if (mesh.on_boundary({0, name}, face->boundary_id()))
              length[name] += face->measure();
  const std::map<std::string, double> expect = {{"foot", 2}, {"outline", 4}, {"right side", 1}, {"*", 6}};
  for (const auto &[name, l] : expect)
    EXPECT_NEAR(dealii::Utilities::MPI::sum(length[name], MPI_COMM_WORLD), l, 1e-10) << name;
}

TEST(MeshFiles, scale_placement_and_refinement)
{
  Scene scene = two_parts(formats[1]);
  for (auto &body : scene.bodies)
    {
      body.scale                 = 1000;
      body.placement.mirror_x    = true;
      body.placement.translation = Point(0, -500);
      body.refinements           = 1;
    }
  scene.discretization.refinements = 1;
  std::map<std::string, mesh::MeshFile> files;
  const auto                            block = mesh::make_body(scene, 0, files);
  EXPECT_EQ(files.size(), 1u);
  EXPECT_EQ(block.piece.cells.size(), 8u * 16);
  EXPECT_NEAR(quality_of(block.piece).area, 2e6, 1e-3);
  EXPECT_NEAR(length_of(block, "outline"), 4000, 1e-6);
  EXPECT_LT(block.piece.vertices[block.points.at("shoulder")].distance(Point(-2000, 500)), 1e-6);
  EXPECT_TRUE(quality_of(block.piece).conforming);
}

TEST(MeshFiles, part_by_number_and_all_cells)
{
  const auto file = mesh::read_mesh_file(path_of(formats[3]));
  EXPECT_EQ(mesh::body_from_file(body_of(formats[3], "1"), file).piece.cells.size(), 8u);
  auto everything = mesh::body_from_file(body_of(formats[3], ""), file);
  EXPECT_NEAR(quality_of(everything.piece).area, 4, 1e-10);
  EXPECT_EQ(everything.boundary_ids.count("interface"), 0u); // inside now
}

TEST(MeshFiles, subdomains_of_a_mixed_body_have_one_kind_of_cells)
{
  for (const unsigned int refinements : {0u, 1u, 3u})
    for (const std::string file : {"mixed.msh", "two_parts_msh41.msh"})
      for (const Cut &how : {whole(), metis(9)})
        {
          Scene scene;
          scene.bodies                = {body_of(file, "")};
          scene.bodies[0].refinements = refinements;
          const auto   mesh           = mesh::make_mesh(cut(scene, how), MPI_COMM_WORLD);
          double       area           = 0;
          unsigned int kinds[2]       = {0, 0};
          for (const auto &subdomain : mesh.subdomains)
            {
              ASSERT_EQ(subdomain->triangulation.get_reference_cells().size(), 1u);
              ++kinds[subdomain->triangulation.all_reference_cells_are_hyper_cube()];
              for (const auto &cell : subdomain->triangulation.active_cell_iterators())
                area += cell->measure();
            }
          EXPECT_NEAR(dealii::Utilities::MPI::sum(area, MPI_COMM_WORLD), file == "mixed.msh" ? 6 : 4, 1e-9);
          const bool keeps_triangles = file != "mixed.msh" && refinements == 3; // two large parts there
          EXPECT_EQ(dealii::Utilities::MPI::sum(kinds[0], MPI_COMM_WORLD) > 0, keeps_triangles) << file << refinements;
          if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0 && !keeps_triangles)
            {
              std::string remarks;
              for (const auto &remark : mesh.remarks)
                remarks += remark.text;
              EXPECT_SAYS(remarks, "quadrilaterals");
            }
        }
}

TEST(MeshFiles, refinement_towards_named_lines)
{
  Scene                                 scene = two_parts(formats[0]);
  std::map<std::string, mesh::MeshFile> files;
  const mesh::BodyMesh<2>               coarse[] = {mesh::make_body(scene, 0, files), mesh::make_body(scene, 1, files)};
  for (auto &body : scene.bodies)
    {
      body.refined_boundaries   = {"interface"};
      body.boundary_refinements = 2;
    }
  for (const unsigned int b : {0, 1})
    {
      const auto mesh = mesh::make_body(scene, b, files);
      EXPECT_TRUE(quality_of(mesh.piece).conforming);
      EXPECT_NEAR(quality_of(mesh.piece).area, 2, 1e-10);
      EXPECT_GT(quality_of(mesh.piece).least_angle, .45 * quality_of(coarse[b].piece).least_angle);
      const auto id = mesh.boundary_ids.at("interface");
      for (const auto &face : mesh.piece.boundary_faces) // four edges of length 0.5 there
        if (face.id == id)
          {
            EXPECT_NEAR(mesh.piece.vertices[face.vertices[0]].distance(mesh.piece.vertices[face.vertices[1]]),
                        b == 0 ? .5 / 9 : .5 / 4,
                        1e-9);
          }
    }
}

TEST(MeshFiles, clockwise_cells_are_turned_when_all_are)
{
  const auto mesh = body_of_text(gmsh_2(square, {"3 2 1 1 1 4 3 2", "3 2 1 1 2 3 6 5"}));
  EXPECT_NEAR(quality_of(mesh.piece).area, 2, 1e-14);
  EXPECT_TRUE(quality_of(mesh.piece).conforming);
}

TEST(MeshFiles, cells_listed_once_for_every_name_count_once)
{
  const std::string cells = gmsh_2(square, {"3 2 1 1 1 2 3 4", "3 2 7 1 1 2 3 4", "3 2 7 1 2 5 6 3"});
  EXPECT_EQ(body_of_text(cells).piece.cells.size(), 2u);
  EXPECT_EQ(body_of_text(cells, "1").piece.cells.size(), 1u);
  EXPECT_EQ(body_of_text(cells, "7").piece.cells.size(), 2u);
}

TEST(MeshFiles, unused_nodes_are_ignored)
{
  auto nodes = square;
  nodes.push_back({{100, 100, 100}});
  EXPECT_EQ(body_of_text(gmsh_2(nodes, {"3 2 1 1 1 2 3 4"})).piece.vertices.size(), 4u);
}

TEST(MeshFiles, hinge_at_a_node_is_no_gap)
{
  const std::vector<std::array<double, 3>> nodes = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{2, 1, 0}}, {{2, 2, 0}}};
  EXPECT_EQ(body_of_text(gmsh_2(nodes, {"2 2 1 1 1 2 3", "2 2 1 1 3 4 5"})).piece.vertices.size(), 5u);
}

TEST(MeshFiles, bad_cells_are_refused_by_name_and_place)
{
  const std::string some_turned = refusal([] { body_of_text(gmsh_2(square, {"3 2 1 1 1 2 3 4", "3 2 1 1 2 3 6 5"})); });
  EXPECT_SAYS(some_turned, "1 of 2 cells with clockwise orientation");
  EXPECT_SAYS(some_turned, "cell 2 at (1.5, 0.5)");
  EXPECT_SAYS(some_turned, "remedy: ");
  EXPECT_SAYS(refusal([] { body_of_text(gmsh_2(square, {"3 2 1 1 1 2 4 3"})); }),
              "cell 1 at (0.5, 0.5) intersects itself");
  EXPECT_SAYS(refusal([] { body_of_text(gmsh_2(square, {"2 2 1 1 1 2 5"})); }), "cell 1 at (1, 0) has no area");
  EXPECT_SAYS(refusal([] { body_of_text(gmsh_2(square, {"3 2 1 1 1 2 5 6"})); }), "180 degrees");
  EXPECT_SAYS(refusal([] { body_of_text(gmsh_2(square, {"3 2 1 1 1 2 2 4"})); }), "cell 1");
  auto dented = square;
  dented[2]   = {{.3, .3, 0}};
  EXPECT_SAYS(refusal([&] { body_of_text(gmsh_2(dented, {"3 2 1 1 1 2 3 4"})); }), "not convex");
}

TEST(MeshFiles, wrong_dimension_is_refused)
{
  EXPECT_SAYS(refusal([] {
                body_of_text(gmsh_2(square, {"1 2 1 1 1 2", "15 2 1 1 1"}));
              }),
              "no cells, only 1 lines and 1 points");
  EXPECT_SAYS(refusal([] {
                body_of_text(gmsh_2(square, {"3 2 1 1 1 2 3 4", "4 2 1 1 1 2 3 5"}));
              }),
              "three-dimensional");
  auto bent  = square;
  bent[2][2] = .1;
  EXPECT_SAYS(refusal([&] { body_of_text(gmsh_2(bent, {"3 2 1 1 1 2 3 4"})); }), "z goes from 0 to 0.1");
  auto raised = square;
  for (auto &node : raised)
    node[2] = 7;
  EXPECT_EQ(body_of_text(gmsh_2(raised, {"3 2 1 1 1 2 3 4"})).piece.cells.size(), 1u);
}

TEST(MeshFiles, body_in_pieces_is_refused)
{
  std::vector<std::array<double, 3>> nodes = square;
  nodes.push_back({{5, 0, 0}});
  nodes.push_back({{6, 0, 0}});
  nodes.push_back({{6, 1, 0}});
  const std::string text = refusal([&] { body_of_text(gmsh_2(nodes, {"3 2 1 1 1 2 3 4", "2 2 1 1 7 8 9"})); });
  EXPECT_SAYS(text, "2 pieces that share no node");
  EXPECT_SAYS(text, "(5.66667, 0.333333)");
}

TEST(MeshFiles, edge_of_three_cells_is_refused)
{
  const std::vector<std::array<double, 3>> nodes = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{.2, 2, 0}}, {{0, -1, 0}}};
  EXPECT_SAYS(refusal([&] {
                body_of_text(gmsh_2(nodes, {"2 2 1 1 1 2 3", "2 2 1 1 1 2 4", "2 2 1 1 1 5 2"}));
              }),
              "edge of three cells");
}

TEST(MeshFiles, unknown_names_are_refused_with_the_nearest_on_all_ranks)
{
  const auto refused = [](const Scene &scene) { return refusal([&] { mesh::make_mesh(scene, MPI_COMM_WORLD); }); };
  Scene      scene   = cut(two_parts(formats[0]), metis(3));
  support(scene, 0, "fot", "0", "0");
  EXPECT_SAYS(refused(scene), "Support held fot: body 'block' has no boundary 'fot'");
  EXPECT_SAYS(refused(scene), "did you mean 'foot'");

  scene = cut(two_parts(formats[0]), metis(3));
  support(scene, 1, "foot", "0", "0"); // of the other body
  EXPECT_SAYS(refused(scene), "body 'roof' has no boundary 'foot'");

  scene                              = cut(two_parts(formats[0]), metis(3));
  scene.bodies[1].refined_boundaries = {"interfaces"};
  EXPECT_SAYS(refused(scene), "Refine towards");

  scene                = cut(two_parts(formats[0]), metis(3));
  scene.bodies[0].part = "blok";
  EXPECT_SAYS(refused(scene), "no part 'blok'");
  EXPECT_SAYS(refused(scene), "did you mean 'block'");

  scene = cut(two_parts(formats[0]), metis(3));
  scene::PointLoad<2> load;
  load.name        = "pull";
  load.where.body  = 1;
  load.where.point = "tip";
  scene.point_loads.push_back(load);
  EXPECT_SAYS(refused(scene), "Point load pull: body 'roof' has no point 'tip'");
  EXPECT_SAYS(refused(scene), "top");
}

TEST(MeshFiles, broken_files_are_refused)
{
  for (const std::string &format : formats)
    {
      const std::string whole_text = content_of(format);
      // truncated at any place
      for (std::size_t n = 0; n + 20 < whole_text.size(); n += 37)
        {
          const std::string text = refusal([&] { body_of_text(whole_text.substr(0, n)); });
          EXPECT_SAYS(text, "typed.msh");
          EXPECT_SAYS(text, "remedy: ");
        }
    }
  // line ends changed by a copy in text mode
  for (const std::string &format : {formats[1], formats[3]})
    {
      std::string text;
      for (const char c : content_of(format))
        text += c == '\n' ? std::string("\r\n") : std::string(1, c);
      EXPECT_SAYS(refusal([&] { body_of_text(text); }), "corrupt");
    }
  // a binary file whose header declares ASCII
  std::string text = content_of(formats[3]);
  text.replace(text.find("4.1 1 8"), 7, "4.1 0 8");
  EXPECT_SAYS(refusal([&] { body_of_text(text); }), "corrupt");
  EXPECT_SAYS(refusal([&] { body_of_text("$MeshFormat\n4 0 8\n$EndMeshFormat\n"); }), "version 4");
  EXPECT_SAYS(refusal([&] { body_of_text("solid nonsense\n"); }), "not a Gmsh file");
  EXPECT_SAYS(refusal([&] { body_of_text("$NOD\n1\n"); }), "version 1");
  EXPECT_SAYS(refusal([&] { body_of_text(gmsh_2(square, {"3 2 1 1 1 2 3 44"})); }), "node 44");
  // a number without an absolute value, where the sign is dropped
  EXPECT_SAYS(refusal([&] { body_of_text(gmsh_2(square, {"3 2 -2147483648 1 1 2 3 4"})); }), "corrupt");
  EXPECT_SAYS(refusal([&] {
                body_of_text(
                  "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 0 0\n1 0 0 0 1 -2147483648\n$EndEntities\n");
              }),
              "corrupt");
}

TEST(MeshFiles, lines_may_end_as_windows_has_it)
{
  for (const std::string &format : {formats[0], formats[2]})
    {
      std::string text;
      for (const char c : content_of(format))
        text += c == '\n' ? std::string("\r\n") : std::string(1, c);
      EXPECT_NEAR(quality_of(body_of_text(text, "roof").piece).area, 2, 1e-10);
    }
}

TEST(MeshFiles, units_that_do_not_fit_are_remarked)
{
  Scene scene = two_parts(formats[0]);
  for (const double scale : {1e-3, 1e3})
    {
      scene.bodies[1].scale = scale;
      const auto mesh       = mesh::make_mesh(cut(scene, metis(2)), MPI_COMM_SELF);
      ASSERT_EQ(mesh.remarks.size(), 1u);
      EXPECT_SAYS(mesh.remarks[0].text, "units");
    }
  scene.bodies[1].scale = 1e-2; // parts do differ in size
  EXPECT_TRUE(mesh::make_mesh(cut(scene, metis(2)), MPI_COMM_SELF).remarks.empty());
}

TEST(MeshFiles, subdomains_are_shared_by_cost)
{
  for (const unsigned int n : {2, 3, 6, 11, 20})
    {
      Scene scene                               = two_parts(formats[0]);
      scene.bodies[0].refinements               = 3; // 512 quadrilaterals
      scene.bodies[1].refinements               = 2;
      const auto                           mesh = mesh::make_mesh(cut(scene, metis(n)), MPI_COMM_SELF);
      std::map<unsigned int, unsigned int> count;
      std::map<unsigned int, double>       cells;
      for (const auto &subdomain : mesh.subdomains)
        {
          ++count[subdomain->body];
          cells[subdomain->body] += subdomain->triangulation.n_active_cells() * (subdomain->body == 0 ? 1 : .5);
        }
      EXPECT_EQ(mesh.n_subdomains(), n);
      // no other share would make the most expensive subdomain cheaper
      const double dearest = std::max(cells[0] / count[0], cells[1] / count[1]);
      for (unsigned int k = 1; k < n; ++k)
        EXPECT_GE(std::max(cells[0] / k, cells[1] / (n - k)), dearest - 1e-12);
    }
}

TEST(MeshFiles, seeds_change_the_cut_and_nothing_else)
{
  Scene scene                 = cut(two_parts(formats[0]), metis(7));
  scene.bodies[0].refinements = 3;
  std::set<std::vector<unsigned int>> cuts;
  for (scene.decomposition.seed = 0; scene.decomposition.seed < 6; ++scene.decomposition.seed)
    {
      const auto                mesh = mesh::make_mesh(scene, MPI_COMM_SELF);
      std::vector<unsigned int> sizes;
      for (const auto &subdomain : mesh.subdomains)
        sizes.push_back(subdomain->global_vertices.size());
      cuts.insert(sizes);
      EXPECT_EQ(mesh.n_subdomains(), 7u);
    }
  EXPECT_GT(cuts.size(), 1u);
}

// other formats

TEST(MeshFiles, abaqus_input_with_its_sets_and_surfaces)
{
  const std::string text =
    "*Heading\n two squares\n** a comment\n*NODE, NSET=all\n1, 0, 0\n2, 1., 0\n3, 1, 1\n4, 0, 1E0\n5, 2, 0\n6, 2, 1\n"
    "*Element, type=CPS4R, ELSET=Plate\n1, 1, 2, 3,\n4\n*ELEMENT, TYPE=CPE3, elset=rest\n2, 2, 5, 6\n3, 2, 6, 3\n"
    "*ELEMENT, type=T3D2, ELSET=Line1\n9, 1, 2\n"
    "*NSET, NSET=Foot, GENERATE\n1, 2, 1\n*Nset, nset=Foot\n5,\n*NSET, NSET=tip\n6\n"
    "*ELSET, ELSET=Body\nPlate, rest\n*SURFACE, TYPE=ELEMENT, NAME=Top\nPlate, S3\n3, s2\n"
    "*MATERIAL, NAME=steel\n*ELASTIC\n2.1e5, 0.3\n";
  auto       body  = body_of("typed.inp", "Body");
  const auto file  = mesh::parse_abaqus(body.file, text);
  const auto whole = mesh::body_from_file(body, file);
  EXPECT_EQ(whole.piece.cells.size(), 3u);
  EXPECT_NEAR(quality_of(whole.piece).area, 2, 1e-14);
  EXPECT_NEAR(length_of(whole, "Foot"), 2, 1e-14);
  EXPECT_NEAR(length_of(whole, "Top"), 2, 1e-14);
  EXPECT_NEAR(length_of(whole, "Line1"), 1, 1e-14);
  EXPECT_EQ(whole.piece.vertices[whole.points.at("tip")], Point(2, 1));
  body.part = "rest";
  EXPECT_EQ(mesh::body_from_file(body, file).piece.cells.size(), 2u);

  EXPECT_SAYS(refusal([] { mesh::parse_abaqus("a.inp", "*NODE\n1, 0, 0\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n"); }),
              "a.inp:4: element 1 has node 2");
  EXPECT_SAYS(refusal([] { mesh::parse_abaqus("a.inp", "*NODE\n1, 0, O\n"); }), "'O' is not a coordinate");
  EXPECT_SAYS(refusal([] { mesh::parse_abaqus("a.inp", "*NSET, NSET=a\nb\n"); }), "no set 'b'");
  EXPECT_SAYS(refusal([] { mesh::parse_abaqus("a.inp", "*NSET, NSET=a, GENERATE\n1, 1e9, 1\n"); }),
              "from 1 up to 1000000000");
  EXPECT_SAYS(refusal([] {
                mesh::parse_abaqus("a.inp", "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n*ELEMENT, TYPE=CPS3\n1, 1, 2\n");
              }),
              "lacks nodes");
  EXPECT_SAYS(refusal([&] {
                mesh::body_from_file(body,
                                     mesh::parse_abaqus("a.inp",
                                                        "*NODE\n1, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1, 1, 1\n"));
              }),
              "three-dimensional");
}

TEST(MeshFiles, ucd_with_its_materials)
{
  const auto name = std::filesystem::temp_directory_path() / ("slipstick_" + std::to_string(getpid()) + ".ucd");
  {
    std::ofstream out(name);
    out << "6 3 0 0 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n"
           "1 5 quad 1 2 3 4\n2 6 quad 2 5 6 3\n3 7 line 1 2\n";
  }
  auto body        = body_of("", "");
  body.file        = name;
  const auto file  = mesh::read_mesh_file(body.file);
  const auto whole = mesh::body_from_file(body, file);
  EXPECT_NEAR(quality_of(whole.piece).area, 2, 1e-14);
  EXPECT_NEAR(length_of(whole, "7"), 1, 1e-14);
  body.part = "6";
  EXPECT_EQ(mesh::body_from_file(body, file).piece.cells.size(), 1u);
  {
    std::ofstream out(name);
    out << "6 3 0 0 0\n1 0 0 0\n";
  }
  EXPECT_SAYS(refusal([&] { mesh::read_mesh_file(body.file); }), "is truncated or corrupt in its section of nodes");
  std::filesystem::remove(name);
  EXPECT_SAYS(refusal([&] { mesh::read_mesh_file(body.file); }), "cannot be read");
  EXPECT_SAYS(refusal([] { mesh::read_mesh_file(path_of("two_parts.geo")); }), "unknown ending '.geo'");
}

TEST(MeshFiles, numbers_in_vtk_and_unv_are_checked)
{
  const auto refusal_of =
    [](const std::string &ending, std::string text, const std::string &what, const std::string &by) {
      const auto name = std::filesystem::temp_directory_path() / ("slipstick_" + std::to_string(getpid()) + ending);
      if (!what.empty())
        text.replace(text.find(what), what.size(), by);
      std::ofstream(name) << text;
      std::string said;
      try
        {
          said = std::to_string(mesh::read_mesh_file(name).elements.size()) + " elements";
        }
      catch (const InputError &error)
        {
          said = error.what();
        }
      std::filesystem::remove(name);
      return said;
    };
  const std::string vtk =
    "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n0 0 0 1 0 0 1 1 0 "
    "0 1 0 2 0 0 2 1 0\nCELLS 3 13\n4 0 1 2 3\n4 1 4 5 2\n2 0 1\nCELL_TYPES 3\n9 9 3\n";
  EXPECT_SAYS(refusal_of(".vtk", vtk, "", ""), "8 elements");
  EXPECT_SAYS(refusal_of(".vtk", vtk, "1 4 5 2", "1 4 6 2"), "cell 1 has corner 6");
  EXPECT_SAYS(refusal_of(".vtk", vtk, "2 0 1", "2 0 2147483647"), "cell 2 has corner 2147483647");
  EXPECT_SAYS(refusal_of(".vtk", vtk, "CELL_TYPES 3\n9 9 3", "CELL_TYPES 2\n9 9"), "3 cells, but 2 types");
  EXPECT_SAYS(refusal_of(".vtk", vtk, "CELL_TYPES 3\n9 9 3", "CELL_TYPES 3\n9 9 9"), "cell 2 of type 9 has 2 corners");
  EXPECT_SAYS(refusal_of(".vtk", vtk, "4 0 1 2 3", "4 0 1 2 1e16"), "corrupt in its section CELLS");
  EXPECT_SAYS(refusal_of(".vtk", vtk, "4 0 1 2 3", "0 0 0 1 0 0\n4 0 1 2 3"), "corrupt in its section CELLS");
  EXPECT_SAYS(refusal_of(".vtk", vtk, "0 1 0 2 0 0", "0 1 O 2 0 0"), "corrupt in its section POINTS");

  const std::string unv = "-1\n2411\n1 1 1 11\n0 0 0\n2 1 1 11\n1 0 0\n3 1 1 11\n1 1 0\n4 1 1 11\n0 1 0\n-1\n-1\n2412\n"
                          "1 44 2 1 7 4\n1 2 3 4\n2 11 2 1 7 2\n0 1 1\n1 2\n-1\n";
  EXPECT_SAYS(refusal_of(".unv", unv, "", ""), "5 elements");
  EXPECT_SAYS(refusal_of(".unv", unv, "1 2 3 4", "1 2 3 5"), "cell 1 has corner 5");
  EXPECT_SAYS(refusal_of(".unv", unv, "0 1 1\n1 2", "0 1 1\n1 9"), "cell 2 has corner 9");
  EXPECT_SAYS(refusal_of(".unv", unv, "4 1 1 11", "3 1 1 11"), "node 3 occurs twice");
  EXPECT_SAYS(refusal_of(".unv", unv, "1 44 2 1 7 4\n1 2 3 4", "1 44 2 1 7 5\n1 2 3 4 1"),
              "with 5 nodes is not supported");
  EXPECT_SAYS(refusal_of(".unv", unv, "1 44 2 1 7 4", "1 84 2 1 7 4"), "5 elements"); // axisymmetric

  const std::string ids = "CELL_DATA 3\nSCALARS MaterialID int 1\nLOOKUP_TABLE default\n7 7 4\n";
  EXPECT_SAYS(refusal_of(".vtk", vtk + ids, "", ""), "8 elements");
  EXPECT_SAYS(refusal_of(".vtk", vtk + ids, "7 7 4", "7 4"), "corrupt in its section SCALARS");
  EXPECT_SAYS(refusal_of(".vtk", vtk + ids, "CELL_DATA 3", "CELL_DATA 2"), "CELL_DATA for 2, but 3 cells");
  EXPECT_SAYS(refusal_of(".vtk", vtk + ids, "7 7 4", "7 7 4 4"), "section '4' that is not supported");
  const std::string group = unv + "-1\n2477\n1 0 0 0 0 0 0 2\nfoot\n8 2 0 0 8 1 0 0\n-1\n";
  EXPECT_SAYS(refusal_of(".unv", group, "", ""), "5 elements");
  EXPECT_SAYS(refusal_of(".unv", group, "8 2 0 0 8 1", "8 2 0 0 8 3"),
              "group 'foot' has 1 elements that are not in the file");
  EXPECT_SAYS(refusal_of(".unv", group, "8 2 0 0 8 1", "7 2 0 0 7 9"), "group 'foot' has node 9");
}

namespace
{
  /// Four squares of a plate of 2 x 2 with lines BOTTOM (1), LEFT (2), TOP (3) around node 5 in its middle.
  const std::vector<std::array<double, 3>> grid        = {{{0, 0, 0}},
                                                          {{1, 0, 0}},
                                                          {{2, 0, 0}},
                                                          {{0, 1, 0}},
                                                          {{1, 1, 0}},
                                                          {{2, 1, 0}},
                                                          {{0, 2, 0}},
                                                          {{1, 2, 0}},
                                                          {{2, 2, 0}},
                                                          {{1, 1, 0}}};
  const std::vector<std::string>           plate_lines = {"1 2 1 0 1 2",
                                                          "1 2 1 0 2 3",
                                                          "1 2 2 0 1 4",
                                                          "1 2 2 0 4 7",
                                                          "1 2 3 0 7 8"};
  const std::vector<std::string>           plate_cells = {"3 2 10 0 1 2 5 4",
                                                          "3 2 10 0 2 3 6 5",
                                                          "3 2 10 0 4 5 8 7",
                                                          "3 2 10 0 5 6 9 8"};

  std::string plate(const std::vector<std::string> &lines, const std::vector<std::string> &cells)
  {
    auto all = plate_lines;
    all.insert(all.end(), lines.begin(), lines.end());
    all.insert(all.end(), cells.begin(), cells.end());
    return gmsh_2(grid, all);
  }
} // namespace

TEST(MeshFiles, cells_on_top_of_each_other_and_nodes_that_are_not_joined_are_refused)
{
  EXPECT_EQ(body_of_text(plate({}, plate_cells)).piece.cells.size(), 4u);
  auto cells = plate_cells;
  cells.push_back("3 2 10 0 1 3 9 7"); // on top of all others
  EXPECT_SAYS(refusal([&] { body_of_text(plate({}, cells)); }),
              "cells on top of each other at (1, 0): cell 10 at (1, 1)");
  cells    = plate_cells;
  cells[3] = "3 2 10 0 10 6 9 8"; // a copy of the node in the middle
  EXPECT_SAYS(refusal([&] { body_of_text(plate({}, cells)); }), "two nodes at (1, 1) that are not joined");
  EXPECT_SAYS(refusal([&] {
                body_of_text(plate({}, {"3 2 10 0 1 3 6 4", plate_cells[2], plate_cells[3]}));
              }),
              "node inside an edge at (1, 1)");
  // folded along an edge, whose nodes are the only common ones
  EXPECT_SAYS(refusal([&] {
                body_of_text(gmsh_2(grid, {"2 2 1 1 1 3 7", "2 2 1 1 1 3 8"}));
              }),
              "lie on the same side of their edge");
  // two strips that cross and are joined at a corner
  const std::vector<std::array<double, 3>> strips =
    {{{0, 0, 0}}, {{3, 0, 0}}, {{3, 1, 0}}, {{0, 1, 0}}, {{1, -1, 0}}, {{2, -1, 0}}, {{2, 3, 0}}, {{1, 3, 0}}};
  EXPECT_SAYS(refusal([&] {
                body_of_text(gmsh_2(strips, {"3 2 1 1 1 2 3 4", "3 2 1 1 5 6 7 8", "2 2 1 1 4 1 8"}));
              }),
              "on top of each other");
  // a small cell in the middle of a large one, joined at one corner
  const std::vector<std::array<double, 3>> inner =
    {{{0, 0, 0}}, {{9, 0, 0}}, {{9, 9, 0}}, {{0, 9, 0}}, {{2, 1, 0}}, {{1, 2, 0}}};
  EXPECT_SAYS(refusal([&] {
                body_of_text(gmsh_2(inner, {"3 2 1 1 1 2 3 4", "2 2 1 1 1 5 6"}));
              }),
              "on top of each other");
}

TEST(MeshFiles, slits_are_taken_where_both_flanks_have_names)
{
  // nodes 5 and 10 and a slit from the middle to the right: 6 has no copy, so the slit is closed at both ends ...
  auto cells = plate_cells;
  cells[3]   = "3 2 10 0 10 6 9 8"; // ... and goes around the corner, to 8
  EXPECT_EQ(
    body_of_text(plate({"1 2 4 0 5 6", "1 2 4 0 10 6", "1 2 5 0 5 8", "1 2 5 0 10 8"}, cells)).piece.cells.size(),
    4u);
  EXPECT_SAYS(refusal([&] {
                body_of_text(plate({"1 2 4 0 5 6", "1 2 4 0 10 6", "1 2 5 0 5 8"}, cells));
              }),
              "not joined");
}

TEST(MeshFiles, lines_off_the_outline_are_refused_where_they_are_used_and_listed_elsewhere)
{
  const auto refused = [](const std::string &line, const std::string &boundary) {
    Scene      scene;
    const auto name = std::filesystem::temp_directory_path() / ("slipstick_" + std::to_string(getpid()) + ".msh");
    std::ofstream(name) << plate({line}, plate_cells);
    scene.bodies         = {body_of("", "")};
    scene.bodies[0].file = name;
    support(scene, 0, boundary, "0", "0");
    std::map<std::string, mesh::MeshFile> files;
    std::string                           remarks;
    const std::string                     said = refusal([&] {
      for (const auto &remark : mesh::make_body(scene, 0, files).remarks)
        remarks += remark.text;
    });
    std::filesystem::remove(name);
    return said + remarks;
  };
  EXPECT_SAYS(refused("1 2 3 0 8 9", "3"), "nothing was refused");
  EXPECT_SAYS(refused("1 2 3 0 7 9", "3"), "boundary '3' of body 'all' in mesh file");
  EXPECT_SAYS(refused("1 2 3 0 7 9", "3"), "line 6 from (0, 2) to (2, 2) is not an edge of a cell");
  EXPECT_SAYS(refused("1 2 3 0 4 5", "3"), "line 6 from (0, 1) to (1, 1) lies inside the body");
  EXPECT_SAYS(refused("1 2 3 0 4 5", "1"), "nothing was refused");
  EXPECT_SAYS(refused("1 2 3 0 4 5", "1"), "left out: '3': line 6");
  EXPECT_SAYS(refused("1 2 3 0 7 10", "1"), "left out: '3': line 6");
}

TEST(MeshFiles, points_of_several_nodes_and_cells_of_no_body)
{
  Scene      scene;
  const auto name = std::filesystem::temp_directory_path() / ("slipstick_" + std::to_string(getpid()) + ".msh");
  std::ofstream(name) << gmsh_2(square,
                                {"3 2 1 1 1 2 3 4", "3 2 7 1 2 5 6 3", "15 2 4 0 1", "15 2 4 0 3", "15 2 5 0 3"});
  scene.bodies         = {body_of("", "1")};
  scene.bodies[0].file = name;
  scene::PointLoad<2> load;
  load.name        = "pull";
  load.where.point = "5";
  scene.point_loads.push_back(load);
  const auto mesh = mesh::make_mesh(scene, MPI_COMM_SELF);
  ASSERT_EQ(mesh.remarks.size(), 1u);
  EXPECT_SAYS(mesh.remarks[0].text, "cells that belong to no body: '7' (1)");
  scene.point_loads[0].where.point = "4";
  EXPECT_SAYS(refusal([&] { mesh::make_mesh(scene, MPI_COMM_SELF); }), "point '4' of body '1' in mesh file");
  std::filesystem::remove(name);
}

TEST(MeshFiles, gmsh_writes_other_formats_too)
{
  for (const std::string file : {"gmsh.vtk", "gmsh_curved.vtk", "gmsh.unv", "gmsh_curved.unv", "gmsh_curved.inp"})
    {
      const bool has_names = file.find(".vtk") == std::string::npos;
      auto       body      = body_of(file, has_names ? "block" : "3");
      const auto mesh      = mesh::body_from_file(body, mesh::read_mesh_file(body.file));
      EXPECT_EQ(mesh.piece.cells.size(), 8u) << file;
      EXPECT_NEAR(quality_of(mesh.piece).area, 2, 1e-10) << file;
      EXPECT_NEAR(length_of(mesh, has_names ? "foot" : "1"), 2, 1e-10) << file;
      EXPECT_NEAR(length_of(mesh, has_names ? "top_side" : "2"), 2, 1e-10) << file;
    }
}

TEST(MeshFiles, names_that_other_formats_lack_are_said_to_be_in_msh)
{
  const auto refused = [](const std::string &file, const std::string &part, const std::string &foot) {
    Scene scene;
    scene.bodies = {body_of(file, part)};
    support(scene, 0, foot, "0", "0");
    scene::PointLoad<2> load;
    load.name        = "pull";
    load.where.point = "tip";
    scene.point_loads.push_back(load);
    std::map<std::string, mesh::MeshFile> files;
    return refusal([&] { mesh::make_body(scene, 0, files); });
  };
  for (const auto &said :
       {refused("gmsh.vtk", "block", "foot"), refused("gmsh.vtk", "3", "foot"), refused("gmsh.vtk", "3", "1")})
    EXPECT_SAYS(said, "save as .msh in Gmsh for the names");
  EXPECT_SAYS(refused("gmsh.vtk", "block", "foot"), "has no part 'block'");
  EXPECT_SAYS(refused("gmsh.vtk", "3", "foot"), "no boundary 'foot'");
  EXPECT_SAYS(refused("gmsh.vtk", "3", "1"), "no point 'tip'");
  for (const auto &said : {refused("gmsh.unv", "block", "top side"), refused("gmsh.unv", "block", "foot")})
    EXPECT_SAYS(said, "save as .msh in Gmsh");
  EXPECT_SAYS(refused("gmsh.unv", "block", "top side"), "did you mean 'top_side'?");
  EXPECT_SAYS(refused("gmsh.unv", "block", "foot"), "no point 'tip'");
}

TEST(MeshFiles, every_item_of_an_abaqus_file_is_used_refused_or_listed)
{
  const auto read = [](const std::string &what, const std::string &by) {
    std::string text =
      "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 2, 0\n6, 2, 1\n*ELEMENT, TYPE=CPS4, ELSET=Plate\n1, 1, 2, 3, 4\n"
      "2, 2, 5, 6, 3\n*NSET, NSET=Foot\n1, 2\n*ELSET, ELSET=Some\n1\n*SURFACE, NAME=Top\nSome, S3\n";
    if (!what.empty())
      text.replace(text.find(what), what.size(), by);
    std::string said;
    auto        file = mesh::MeshFile();
    said             = refusal([&] { file = mesh::parse_abaqus("a.inp", text); });
    for (const auto &remark : file.remarks)
      said += remark.line();
    return said;
  };
  EXPECT_EQ(read("", ""), "nothing was refused");
  EXPECT_SAYS(read("S3", "S5"), "a.inp:16: surface 'TOP' has side S5 of element 1");
  EXPECT_SAYS(read("S3", "SPOS"), "side SPOS");
  EXPECT_SAYS(read("Some, S3", "9, S3"), "surface 'TOP' has element 9, which is not in the file");
  EXPECT_SAYS(read("Some, S3", "None, S3"), "'None' is not the number");
  EXPECT_SAYS(read("*ELEMENT, TYPE=CPS4,", "*ELEMENT,"), "*ELEMENT without TYPE");
  EXPECT_SAYS(read("TYPE=CPS4", "TYPE=QUAD4"), "type QUAD4 are not supported");
  EXPECT_SAYS(read("TYPE=CPS4", "TYPE=CGAX4R"), "CGAX4R are axisymmetric with twist");
  EXPECT_SAYS(read("1, 2\n*ELSET", "1, 2, 77\n*ELSET"), "set 'FOOT' has node 77, which is not in the file");
  EXPECT_SAYS(read("ELSET=Some\n1", "ELSET=Some\n1, 3"), "set 'SOME' has element 3");
  EXPECT_SAYS(read("*NSET, NSET=Foot\n1, 2", "*NSET, NSET=Foot, GENERATE\n1, 9000000, 1"), "there are 6 nodes only");
  EXPECT_SAYS(read("*NSET", "*SYSTEM\n1, 0, 0\n*NSET"), "*SYSTEM is not supported");
  const std::string listed =
    read("*NSET", "*MATERIAL, NAME=s\n*ELASTIC\n1, 0\n*STEP\n*BOUNDARY\nFoot, 1, 2\n*END STEP\n*BOUNDARY\n3, 1\n*NSET");
  EXPECT_SAYS(listed, "nothing was refusedwarning: mesh file a.inp: only its mesh is used");
  EXPECT_SAYS(listed, "Not used: *BOUNDARY (2), *ELASTIC, *END STEP, *MATERIAL, *STEP");
}

TEST(MeshFiles, surfaces_and_sets_of_nodes_must_lie_on_the_outline)
{
  auto              body = body_of("typed.inp", "");
  const std::string mesh =
    "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 2, 0\n6, 2, 1\n*ELEMENT, TYPE=CPS4, ELSET=Plate\n1, 1, 2, 3, 4\n"
    "2, 2, 5, 6, 3\n";
  const auto made = [&](const std::string &sets) {
    return mesh::body_from_file(body, mesh::parse_abaqus(body.file, mesh + sets));
  };
  EXPECT_EQ(made("*SURFACE, NAME=top\nPlate, S3\n").incomplete_boundaries.size(), 0u);
  EXPECT_EQ(made("*SURFACE, NAME=right\n1, S2\n").incomplete_boundaries.count("right"), 1u);
  EXPECT_NEAR(length_of(made("*SURFACE, NAME=all\nPlate,\n"), "all"), 6, 1e-14);
  EXPECT_EQ(made("*NSET, NSET=corners\n1, 2, 3, 6\n").incomplete_boundaries.size(),
            0u); // 2-3 is inside, all are at the outline
  EXPECT_EQ(made("*NSET, NSET=gone\n1, 2, 6\n").incomplete_boundaries.count("gone"), 1u);
}

TEST(MeshFiles, elements_that_contradict_the_plane_state_are_warned_of)
{
  Scene      scene;
  const auto name = std::filesystem::temp_directory_path() / ("slipstick_" + std::to_string(getpid()) + ".inp");
  std::ofstream(name) << "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n*ELEMENT, TYPE=CPE3, ELSET=Plate\n1, 1, 2, 3\n";
  scene.bodies         = {body_of("", "")};
  scene.bodies[0].file = name;
  for (const auto state : {scene::PlaneState::plane_stress, scene::PlaneState::plane_strain})
    {
      scene.plane_state  = state;
      const auto remarks = mesh::make_mesh(scene, MPI_COMM_SELF).remarks;
      ASSERT_EQ(remarks.size(), state == scene::PlaneState::plane_stress ? 1u : 0u);
      for (const auto &remark : remarks)
        {
          EXPECT_TRUE(remark.is_warning);
          EXPECT_SAYS(remark.text, "mesh file " + name.string() + " has elements of plane strain (CPE3)");
        }
    }
  std::ofstream(name) << "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n*ELEMENT, TYPE=CAX3, ELSET=Plate\n1, 1, 2, 3\n";
  const auto message = refusal([&] { mesh::make_mesh(scene, MPI_COMM_SELF); });
  EXPECT_SAYS(message, "has axisymmetric elements (CAX3), but the scene is computed in plane strain");
  scene.plane_state = scene::PlaneState::axisymmetric;
  EXPECT_EQ(mesh::make_mesh(scene, MPI_COMM_SELF).remarks.size(), 0u);
  std::filesystem::remove(name);
}

TEST(MeshFiles, sections_of_bodies_of_revolution_do_not_reach_beyond_the_axis)
{
  Scene scene;
  add_body(scene, "pin", Point(-1e-12, 0), Point(2, 3), {{2, 3}});
  scene.plane_state = scene::PlaneState::axisymmetric;
  scene             = cut(scene, whole());
  for (const auto &subdomain : mesh::make_mesh(scene, MPI_COMM_SELF).subdomains)
    for (const auto &x : subdomain->triangulation.get_vertices())
      EXPECT_TRUE(x[0] == 0 || x[0] > 0.5);
  scene.bodies[0].origin[0] = -0.25;
  EXPECT_SAYS(refusal([&] { mesh::make_mesh(scene, MPI_COMM_SELF); }), "Body pin: it reaches to x = -0.25 mm");
}

TEST(MeshFiles, parts_of_one_file_are_not_each_estimated_as_large_as_the_file)
{
  Scene all;
  all.bodies = {body_of(formats[0], "")};
  EXPECT_GT(mesh::estimate_size(all).cells, 0);
  EXPECT_NEAR(mesh::estimate_size(two_parts(formats[0])).cells, mesh::estimate_size(all).cells, 1e-9);
}

TEST(MeshFiles, cells_are_counted_where_the_size_of_the_file_is_not_enough)
{
  Scene all;
  all.bodies          = {body_of(formats[0], "")};
  const auto counted  = mesh::estimate_size(all, true);
  const auto expected = mesh::make_mesh(cut(all, whole()), MPI_COMM_SELF).n_cells;
  EXPECT_EQ(counted.cells, expected);
  EXPECT_NE(mesh::estimate_size(all).cells, expected); // from the size of the file
}
