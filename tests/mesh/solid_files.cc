// Solids of mesh files: Abaqus' elements and surfaces, second order, refinement.
#include <slipstick/base/exceptions.h>
#include <slipstick/mesh/body_mesh.h>
#include <slipstick/mesh/refinement.h>

#include <gtest/gtest.h>

#include <functional>
#include <sstream>

namespace
{
  using namespace slipstick;

  struct SolidFile
  {
    using Place = dealii::Point<3>;

    static mesh::BodyMesh<3> body(const std::string &text, const std::string &part = "")
    {
      scene::Body<3> body;
      body.name  = "body";
      body.shape = scene::Shape::mesh;
      body.file  = "typed.inp";
      body.part  = part;
      return mesh::body_from_file(body,
                                  text[0] == '$'   ? mesh::parse_gmsh("typed.msh", text)
                                  : text[0] == '*' ? mesh::parse_abaqus("typed.inp", text)
                                  : text[0] == '#' ? mesh::parse_vtk("typed.vtk", text)
                                  : text[0] == '1' ? mesh::parse_ucd("typed.ucd", text)
                                                   : mesh::parse_unv("typed.unv", text));
    }

    /// Centres of the faces of a boundary.
    static std::vector<Place> faces(const mesh::BodyMesh<3> &mesh, const std::string &name)
    {
      const auto         id = mesh.boundary_ids.at(name);
      std::vector<Place> result;
      for (const auto &face : mesh.piece.boundary_faces)
        {
          const auto combined = mesh.combined_ids.find(face.id);
          if (face.id != id && (combined == mesh.combined_ids.end() || combined->second.count(id) == 0))
            continue;
          Place        sum;
          unsigned int n = 0;
          for (const unsigned int v : face.vertices)
            if (v != mesh::MeshPiece<3>::no_vertex)
              {
                sum += mesh.piece.vertices[v];
                ++n;
              }
          result.push_back(Place(sum / double(n)));
        }
      return result;
    }

    /// Volume of tetrahedra, or of hexahedra with plane faces.
    static double volume(const mesh::MeshPiece<3> &piece)
    {
      double sum = 0;
      for (const auto &cell : piece.cells)
        {
          const auto at = [&](const unsigned int k) { return piece.vertices[cell[k]]; };
          const auto of_tetra =
            [&](const unsigned int a, const unsigned int b, const unsigned int c, const unsigned int d) {
              const double volume = cross_product_3d(at(b) - at(a), at(c) - at(a)) * (at(d) - at(a)) / 6;
              EXPECT_GT(volume, 0);
              return volume;
            };
          if (mesh::is_simplex<3>(cell))
            sum += of_tetra(0, 1, 2, 3);
          else // vertices in rows
            sum += of_tetra(0, 1, 2, 4) + of_tetra(3, 2, 1, 7) + of_tetra(5, 4, 7, 1) + of_tetra(6, 7, 4, 2) +
                   of_tetra(1, 2, 4, 7);
        }
      return sum;
    }

    static double area(const mesh::BodyMesh<3> &mesh, const mesh::MeshPiece<3> &piece, const std::string &name)
    {
      double sum = 0;
      for (const auto &face : piece.boundary_faces)
        if (face.id == mesh.boundary_ids.at(name))
          {
            // vertices in any order: of the three parallelograms of a quadrilateral the largest is the right one
            const auto &v = face.vertices;
            const auto  x = [&](const unsigned int k) { return piece.vertices[v[k]]; };
            if (v[3] == mesh::MeshPiece<3>::no_vertex)
              sum += cross_product_3d(x(1) - x(0), x(2) - x(0)).norm() / 2;
            else
              sum += std::max({cross_product_3d(x(1) - x(0), x(3) - x(2)).norm(),
                               cross_product_3d(x(2) - x(0), x(3) - x(1)).norm(),
                               cross_product_3d(x(3) - x(0), x(2) - x(1)).norm()}) /
                     2;
          }
      return sum;
    }

    static std::string refusal(const std::function<void()> &f)
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

    static void expect_said(const std::string &text, const std::string &word)
    {
      EXPECT_NE(text.find(word), std::string::npos) << text;
    }
  };

  // two cubes along x
  const std::string two_cubes =
    "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n"
    "8, 0, 1, 1\n9, 2, 0, 0\n10, 2, 1, 0\n11, 2, 0, 1\n12, 2, 1, 1\n";
  const std::string of_cubes =
    "*ELEMENT, TYPE=C3D8R, ELSET=First\n1, 1, 2, 3, 4, 5,\n6, 7, 8\n*ELEMENT, TYPE=C3D8I, ELSET=Second\n2, 2, 9, 10, 3, 6, 11, "
    "12, 7\n";
  const std::string one_tetrahedron = "*NODE\n1, 0, 0, 0\n2, 3, 0, 0\n3, 0, 3, 0\n4, 0, 0, 3\n";
} // namespace

TEST(SolidFiles, abaqus_hexahedra_with_sets_and_surfaces)
{
  using Place = SolidFile::Place;
  std::string sides;
  for (const std::string k : {"1", "2", "3", "4", "5", "6"})
    sides += "*SURFACE, NAME=side" + k + "\nFirst, S" + k + "\n";
  const auto whole = SolidFile::body(
    two_cubes + of_cubes +
    "*ELEMENT, TYPE=S4, ELSET=Shell\n9, 9, 10, 12, 11\n*ELEMENT, TYPE=CPS4, ELSET=Plane\n8, 1, 2, 9, 10\n" +
    "*NSET, NSET=Foot\n1, 2, 3, 4, 9, 10\n*NSET, NSET=tip\n12\n" + sides + "*SURFACE, NAME=All\nFirst,\nSecond,\n" +
    "*SURFACE, NAME=End\nShell, SPOS\n");
  EXPECT_EQ(whole.piece.cells.size(), 2u);
  EXPECT_NEAR(SolidFile::volume(whole.piece), 2, 1e-14);
  const std::vector<Place> middles = {{0.5, 0.5, 0}, {0.5, 0.5, 1}, {0.5, 0, 0.5}, {}, {0.5, 1, 0.5}, {0, 0.5, 0.5}};
  for (unsigned int k = 0; k < 6; ++k)
    if (k != 3)
      {
        const auto found = SolidFile::faces(whole, "side" + std::to_string(k + 1));
        ASSERT_EQ(found.size(), 1u) << k;
        EXPECT_LT(found[0].distance(middles[k]), 1e-14) << k;
      }
  EXPECT_EQ(whole.incomplete_boundaries.count("side4"), 1u); // between the cubes
  EXPECT_EQ(SolidFile::faces(whole, "Foot").size(), 2u);
  EXPECT_EQ(SolidFile::faces(whole, "All").size(), 10u);
  for (const std::string end : {"Shell", "End"})
    {
      ASSERT_EQ(SolidFile::faces(whole, end).size(), 1u);
      EXPECT_LT(SolidFile::faces(whole, end)[0].distance(Place(2, 0.5, 0.5)), 1e-14);
    }
  EXPECT_EQ(whole.incomplete_boundaries.count("Plane"), 1u); // no face of a cell
  EXPECT_EQ(whole.piece.vertices[whole.points.at("tip")], Place(2, 1, 1));
  EXPECT_EQ(SolidFile::body(two_cubes + of_cubes, "Second").piece.cells.size(), 1u);
  SolidFile::expect_said(
    SolidFile::body(two_cubes + of_cubes + "*NSET, NSET=Some\n1, 2, 3, 4, 12\n").incomplete_boundaries.at("Some"),
    "its node at (2, 1, 1) is not a corner of a face");
}

TEST(SolidFiles, abaqus_tetrahedra_with_their_sides)
{
  using Place = SolidFile::Place;
  std::string sides;
  for (const std::string k : {"1", "2", "3", "4"})
    sides += "*SURFACE, NAME=side" + k + "\n1, S" + k + "\n";
  const auto body = SolidFile::body(one_tetrahedron + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n" + sides);
  EXPECT_NEAR(SolidFile::volume(body.piece), 4.5, 1e-14);
  const std::vector<Place> middles = {{1, 1, 0}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (unsigned int k = 0; k < 4; ++k)
    {
      const auto found = SolidFile::faces(body, "side" + std::to_string(k + 1));
      ASSERT_EQ(found.size(), 1u) << k;
      EXPECT_LT(found[0].distance(middles[k]), 1e-14) << k;
    }
}

TEST(SolidFiles, elements_of_second_order_have_the_cells_of_their_corners)
{
  std::ostringstream nodes, mids;
  nodes << one_tetrahedron;
  for (unsigned int k = 5; k <= 10; ++k)
    {
      nodes << k << ", 1, 1, " << k << "\n";
      mids << ", " << k;
    }
  const auto tetrahedron = SolidFile::body(nodes.str() + "*ELEMENT, TYPE=C3D10M\n1, 1, 2, 3, 4,\n" +
                                           mids.str().substr(2) + "\n*SURFACE, NAME=s\n1, S3\n");
  EXPECT_NEAR(SolidFile::volume(tetrahedron.piece), 4.5, 1e-14);
  EXPECT_EQ(SolidFile::faces(tetrahedron, "s").size(), 1u);
  EXPECT_TRUE(tetrahedron.remarks.empty());

  std::ostringstream hexahedron, gmsh;
  hexahedron << two_cubes;
  for (unsigned int k = 13; k <= 24; ++k)
    hexahedron << k << ", 0.5, 0.5, 0." << k << "\n";
  hexahedron << "*ELEMENT, TYPE=C3D20R\n7, 1, 2, 3, 4, 5, 6, 7, 8, 13, 14, 15, 16, 17, 18, 19,\n20, 21, 22, 23, 24\n";
  EXPECT_NEAR(SolidFile::volume(SolidFile::body(hexahedron.str()).piece), 1, 1e-14);

  gmsh << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"below\"\n$EndPhysicalNames\n$Nodes\n27\n";
  const std::vector<std::array<int, 3>> corners =
    {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {{1, 0, 1}}, {{1, 1, 1}}, {{0, 1, 1}}};
  for (unsigned int k = 1; k <= 27; ++k)
    if (k <= 8)
      gmsh << k << ' ' << corners[k - 1][0] << ' ' << corners[k - 1][1] << ' ' << corners[k - 1][2] << '\n';
    else
      gmsh << k << " 0.5 0.5 0." << k << '\n';
  gmsh << "$EndNodes\n$Elements\n4\n";
  for (const auto &[type, n] : std::vector<std::pair<int, unsigned int>>{{12, 27}, {17, 20}}) // the same cell twice
    {
      gmsh << type << ' ' << type << " 2 0 0";
      for (unsigned int k = 1; k <= n; ++k)
        gmsh << ' ' << k;
      gmsh << '\n';
    }
  gmsh << "3 10 2 1 1 1 2 3 4 9 10 11 12 21\n4 16 2 1 1 1 2 3 4 9 10 11 12\n$EndElements\n";
  const auto cube = SolidFile::body(gmsh.str());
  EXPECT_EQ(cube.piece.cells.size(), 1u);
  EXPECT_NEAR(SolidFile::volume(cube.piece), 1, 1e-14);
  EXPECT_EQ(SolidFile::faces(cube, "below").size(), 1u);
}

TEST(SolidFiles, vtk_ucd_and_unv)
{
  // a cube and a tetrahedron on top of it
  const std::string places = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n0.5 0.5 2\n0.5 0.5 -1\n";
  const auto        vtk =
    SolidFile::body("# vtk DataFile Version 2.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n" + places +
                    "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n");
  EXPECT_NEAR(SolidFile::volume(vtk.piece), 1, 1e-14);
  EXPECT_EQ(SolidFile::faces(vtk, "0").size(), 6u);
  const auto tetrahedron = SolidFile::body(
    "# vtk DataFile Version 2.0\none\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n" + places +
    "CELLS 2 15\n10 0 1 3 4 9 9 9 9 9 9\n3 0 1 3\nCELL_TYPES 2\n24 5\nCELL_DATA 2\nSCALARS MaterialID int 1\n"
    "LOOKUP_TABLE default\n3 5\n");
  EXPECT_NEAR(SolidFile::volume(tetrahedron.piece), 1. / 6, 1e-14);
  EXPECT_TRUE(tetrahedron.remarks.empty());
  EXPECT_EQ(SolidFile::faces(tetrahedron, "5").size(), 1u);
  EXPECT_EQ(SolidFile::faces(tetrahedron, "0").size(), 3u);

  std::istringstream lines(places);
  std::ostringstream ucd, unv;
  ucd << "10 2 0 0 0\n";
  unv << "    -1\n  2411\n";
  std::string line;
  for (unsigned int k = 1; std::getline(lines, line); ++k)
    {
      ucd << k << ' ' << line << '\n';
      unv << k << " 1 1 11\n" << line << '\n';
    }
  ucd << "1 3 hex 5 6 7 8 1 2 3 4\n2 4 quad 1 2 3 4\n"; // the top first
  const auto of_ucd = SolidFile::body(ucd.str());
  EXPECT_NEAR(SolidFile::volume(of_ucd.piece), 1, 1e-14);
  EXPECT_EQ(SolidFile::faces(of_ucd, "4").size(), 1u);
  EXPECT_EQ(SolidFile::faces(of_ucd, "0").size(), 5u);

  unv << "    -1\n    -1\n  2412\n1 116 1 1 7 20\n1 9 2 9 3 9 4 9\n9 9 9 9 5 9 6 9\n7 9 8 9\n    -1\n";
  EXPECT_NEAR(SolidFile::volume(SolidFile::body(unv.str()).piece), 1, 1e-14);
  std::string text = unv.str();
  text.replace(text.find("1 116"), std::string::npos, "1 118 1 1 7 10\n1 9 2 9 4 9 9 9\n9 5\n    -1\n");
  EXPECT_NEAR(SolidFile::volume(SolidFile::body(text).piece), 1. / 6, 1e-14);
}

TEST(SolidFiles, what_does_not_fit_is_refused)
{
  const auto said = [](const std::string &text) { return SolidFile::refusal([&] { SolidFile::body(text); }); };
  SolidFile::expect_said(said(two_cubes + "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n"),
                         "has no solid cells, only 1 faces (CPS4)");
  SolidFile::expect_said(said(two_cubes + "*ELEMENT, TYPE=C3D6\n1, 1, 2, 3, 5, 6, 7\n"), "has a wedge, cell 1");
  SolidFile::expect_said(said(two_cubes + "*ELEMENT, TYPE=C3D27\n1, 1, 2, 3, 5, 6, 7\n"),
                         "type C3D27 are not supported");
  SolidFile::expect_said(said(two_cubes + "*ELEMENT, TYPE=SC8R\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"),
                         "type SC8R are not supported");
  SolidFile::expect_said(said(two_cubes + "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7\n"), "lacks nodes");
  SolidFile::expect_said(said(two_cubes + of_cubes + "*SURFACE, NAME=s\nFirst, S7\n"),
                         "has side S7 of element 1, which has sides S1 to S6");
  SolidFile::expect_said(said(one_tetrahedron + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n*SURFACE, NAME=s\n1, E1\n"),
                         "has side E1 of element 1");
  // the top below the bottom
  SolidFile::expect_said(said(two_cubes +
                              "*ELEMENT, TYPE=C3D8\n1, 5, 6, 7, 8, 1, 2, 3, 4\n2, 2, 9, 10, 3, 6, 11, 12, 7\n"),
                         "turned inside out");
}

TEST(SolidFiles, refinement_keeps_volumes_and_boundaries)
{
  const std::string surfaces    = "*SURFACE, NAME=below\nFirst, S1\nSecond, S1\n*SURFACE, NAME=end\n2, S4\n";
  const auto        cubes       = SolidFile::body(two_cubes + of_cubes + surfaces);
  const auto        tetrahedron = SolidFile::body(
    one_tetrahedron + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n*SURFACE, NAME=below\n1, S1\n*SURFACE, NAME=end\n1, S3\n");
  for (const auto &body : {cubes, tetrahedron})
    {
      auto piece = body.piece;
      for (unsigned int level = 0; level < 2; ++level)
        {
          const auto finer = mesh::refined(piece);
          EXPECT_EQ(finer.cells.size(), 8 * piece.cells.size());
          EXPECT_NEAR(SolidFile::volume(finer), SolidFile::volume(body.piece), 1e-13);
          for (const std::string name : {"below", "end"})
            EXPECT_NEAR(SolidFile::area(body, finer, name), SolidFile::area(body, body.piece, name), 1e-13);
          std::map<mesh::MeshPiece<3>::Face, unsigned int> n_cells;
          for (const auto &[face, c] : mesh::faces_with_cells(finer))
            ++n_cells[face];
          unsigned int n_outside = 0;
          for (const auto &[face, n] : n_cells)
            {
              EXPECT_LE(n, 2u);
              n_outside += n == 1;
            }
          EXPECT_EQ(n_outside, finer.boundary_faces.size()); // no face hangs
          piece = finer;
        }
    }
}
