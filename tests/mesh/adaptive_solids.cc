// Hexahedra divided into tetrahedra, and local refinement of tetrahedra.
#include <slipstick/base/exceptions.h>
#include <slipstick/mesh/make_body.h>
#include <slipstick/mesh/refinement.h>
#include <slipstick/mesh/solid_middles.h>

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace
{
  using namespace slipstick;

  struct AdaptiveSolid
  {
    using Piece = mesh::MeshPiece<3>;
    using Point = dealii::Point<3>;

    static scene::Scene<3> scene_of(const scene::Shape shape)
    {
      scene::Scene<3> scene;
      scene.bodies.emplace_back();
      auto &body  = scene.bodies.back();
      body.name   = "solid";
      body.shape  = shape;
      body.size   = {3, 2, 2};
      body.cells  = std::array<unsigned int, 3>{{3, 2, 2}};
      body.radius = 2;
      return scene;
    }

    static mesh::BodyMesh<3> made(const scene::Scene<3>       &scene,
                                  std::set<mesh::CellPath>    &refined,
                                  std::vector<mesh::CellPath> &paths)
    {
      std::map<std::string, mesh::MeshFile> files;
      return mesh::make_body(scene, 0, files, &refined, &paths);
    }

    static double volume(const Piece &piece, const Piece::Cell &cell)
    {
      const auto &x = piece.vertices;
      return cross_product_3d(x[cell[1]] - x[cell[0]], x[cell[2]] - x[cell[0]]) * (x[cell[3]] - x[cell[0]]) / 6;
    }

    static double volume(const Piece &piece)
    {
      double sum = 0;
      for (const auto &cell : piece.cells)
        sum += volume(piece, cell);
      return sum;
    }

    /// Smallest ratio of the volume of a cell to that of the regular tetrahedron with its longest edge.
    static double shape(const Piece &piece)
    {
      double least = 1;
      for (const auto &cell : piece.cells)
        {
          double longest = 0;
          for (const auto &[a, b] : mesh::lines_of_cell(cell))
            longest = std::max(longest, piece.vertices[a].distance(piece.vertices[b]));
          least = std::min(least, volume(piece, cell) * 6 * std::sqrt(2.) / (longest * longest * longest));
        }
      return least;
    }

    /// Expects two cells, or one cell and a boundary face, at every face.
    static void expect_conforming(const Piece &piece)
    {
      std::map<Piece::Face, unsigned int> behind;
      for (const auto &entry : mesh::faces_with_cells(piece))
        ++behind[entry.first];
      const auto  ids     = mesh::ids_of_faces(piece);
      std::size_t outside = 0;
      for (const auto &[face, n] : behind)
        {
          EXPECT_EQ(n, ids.count(face) > 0 ? 1u : 2u);
          outside += n == 1;
        }
      EXPECT_EQ(outside, ids.size());
      EXPECT_EQ(piece.boundary_faces.size(), ids.size());
    }

    static std::map<dealii::types::boundary_id, double> areas(const Piece &piece)
    {
      std::map<dealii::types::boundary_id, double> result;
      for (const auto &face : piece.boundary_faces)
        {
          const auto &x = piece.vertices;
          const auto &v = face.vertices;
          result[face.id] += cross_product_3d(x[v[1]] - x[v[0]], x[v[2]] - x[v[0]]).norm() / 2;
        }
      return result;
    }
  };
} // namespace

TEST(AdaptiveSolid, six_tetrahedra_fill_a_hexahedron_whatever_its_numbers)
{
  using Corners = std::set<std::vector<double>>; // of a cell, by their places
  std::mt19937      random(3);
  std::set<Corners> first;
  for (unsigned int trial = 0; trial < 20; ++trial)
    {
      scene::Body<3> body;
      body.size                       = {3, 2, 2};
      auto                      piece = mesh::rectangle_piece<3>(body, {{3, 2, 2}}, {{1, 1, 1}}, {{0, 0, 0}});
      std::vector<unsigned int> number(piece.vertices.size());
      std::iota(number.begin(), number.end(), 0u);
      std::shuffle(number.begin(), number.end(), random);
      const auto vertices = piece.vertices;
      for (unsigned int v = 0; v < number.size(); ++v)
        piece.vertices[number[v]] = vertices[v];
      for (auto &cell : piece.cells)
        for (auto &v : cell)
          v = number[v];
      for (auto &face : piece.boundary_faces)
        for (auto &v : face.vertices)
          v = number[v];
      const auto whole = mesh::in_tetrahedra(piece, piece.vertices);
      EXPECT_EQ(whole.cells.size(), 6 * piece.cells.size());
      EXPECT_EQ(whole.vertices, piece.vertices);
      EXPECT_NEAR(AdaptiveSolid::volume(whole), 12, 1e-12);
      for (const auto &cell : whole.cells)
        EXPECT_GT(AdaptiveSolid::volume(whole, cell), 0.1);
      AdaptiveSolid::expect_conforming(whole);
      std::set<Corners> cells; // independent of the numbers, so that matching surfaces of bodies still match
      for (const auto &cell : whole.cells)
        {
          Corners corners;
          for (unsigned int k = 0; k < 4; ++k)
            corners.insert({whole.vertices[cell[k]][0], whole.vertices[cell[k]][1], whole.vertices[cell[k]][2]});
          cells.insert(corners);
        }
      if (trial == 0)
        first = cells;
      EXPECT_EQ(cells, first);
      EXPECT_EQ(whole.boundary_faces.size(), 2 * piece.boundary_faces.size());
      for (const auto &[id, area] : AdaptiveSolid::areas(whole))
        EXPECT_NEAR(area, id < 2 ? 4 : 6, 1e-12);
    }
}

TEST(AdaptiveSolid, distorted_hexahedra_are_refused)
{
  scene::Body<3> body;
  body.size         = {1, 1, 1};
  auto piece        = mesh::rectangle_piece<3>(body, {{1, 1, 1}}, {{1, 1, 1}}, {{0, 0, 0}});
  piece.vertices[7] = {.2, .2, -.1};
  EXPECT_THROW(mesh::in_tetrahedra(piece, piece.vertices), InputError);
}

TEST(AdaptiveSolid, patches_of_faces_are_cut_with_them)
{
  scene::Body<3> body;
  body.size           = {1, 1, 1};
  auto       piece    = mesh::rectangle_piece<3>(body, {{1, 1, 1}}, {{1, 1, 1}}, {{0, 0, 0}});
  const auto on_patch = [](const double x, const double y) {
    return AdaptiveSolid::Point(x, y, 1 + .2 * x * (1 - x) + .1 * y * (1 - y));
  };
  for (auto &face : piece.boundary_faces)
    if (face.id == 5)
      face.curve = mesh::FaceSurface::patch({on_patch(0, 0),
                                             on_patch(1, 0),
                                             on_patch(1, 1),
                                             on_patch(0, 1),
                                             on_patch(.5, 0),
                                             on_patch(1, .5),
                                             on_patch(.5, 1),
                                             on_patch(0, .5),
                                             on_patch(.5, .5)});
  const auto   whole   = mesh::in_tetrahedra(piece, piece.vertices);
  unsigned int patches = 0;
  for (const auto &face : whole.boundary_faces)
    if (face.id == 5)
      {
        ++patches;
        ASSERT_EQ(face.curve.n_nodes, 6u);
        for (const auto &x : face.curve.points)
          if (x.norm() > 0)
            {
              EXPECT_NEAR(x[2], on_patch(x[0], x[1])[2], 1e-14);
            }
      }
  EXPECT_EQ(patches, 2u);
  EXPECT_EQ(whole.line_middles.size(), 5u); // of the edges of the face, and of its diagonal
  for (const auto &entry : whole.line_middles)
    EXPECT_NEAR(entry.second[2], on_patch(entry.second[0], entry.second[1])[2], 1e-14);
}

TEST(AdaptiveSolid, shapes_do_not_wear_off_and_round_bodies_stay_round)
{
  for (const auto shape : {scene::Shape::rectangle, scene::Shape::ball})
    {
      const bool                  is_ball = shape == scene::Shape::ball;
      const auto                  scene   = AdaptiveSolid::scene_of(shape);
      const dealii::Point<3>      point   = is_ball ? dealii::Point<3>(1.2, -1.6, 0) : dealii::Point<3>(1.1, 2, .7);
      std::set<mesh::CellPath>    refined;
      std::vector<mesh::CellPath> paths;
      auto                        mesh   = AdaptiveSolid::made(scene, refined, paths);
      const double                coarse = AdaptiveSolid::shape(mesh.piece), volume = AdaptiveSolid::volume(mesh.piece);
      ASSERT_EQ(mesh.remarks.size(), 1u);
      EXPECT_NE(mesh.remarks[0].text.find("six tetrahedra"), std::string::npos) << mesh.remarks[0].text;
      for (unsigned int step = 0; step < 6; ++step)
        {
          const std::size_t                           before = mesh.piece.cells.size();
          std::vector<std::pair<double, std::size_t>> order;
          for (std::size_t c = 0; c < before; ++c)
            {
              dealii::Tensor<1, 3> sum;
              for (unsigned int k = 0; k < 4; ++k)
                sum += mesh.piece.vertices[mesh.piece.cells[c][k]] / 4;
              order.emplace_back((sum - point).norm(), c);
            }
          std::sort(order.begin(), order.end());
          for (unsigned int k = 0; k < 3; ++k)
            refined.insert(paths[order[k].second]);
          mesh = AdaptiveSolid::made(scene, refined, paths);
          ASSERT_EQ(paths.size(), mesh.piece.cells.size());
          EXPECT_GT(mesh.piece.cells.size(), before);
          EXPECT_LT(mesh.piece.cells.size(), before + 1000) << step; // it does not spread
          AdaptiveSolid::expect_conforming(mesh.piece);
          EXPECT_GT(AdaptiveSolid::shape(mesh.piece), .2 * coarse) << step;
          if (is_ball)
            {
              EXPECT_GT(AdaptiveSolid::volume(mesh.piece), volume * (1 - 1e-12));
              for (const auto &face : mesh.piece.boundary_faces)
                for (unsigned int k = 0; k < 3; ++k)
                  EXPECT_NEAR(mesh.piece.vertices[face.vertices[k]].norm(), 2, 1e-12);
              for (const auto &entry : mesh.piece.line_middles)
                EXPECT_NEAR(entry.second.norm(), 2, 1e-12);
            }
          else
            EXPECT_NEAR(AdaptiveSolid::volume(mesh.piece), 12, 1e-12);
        }
    }
}
