#include "mesh_quality.h"
#include "piece.h"

#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/mesh/decomposition.h>

#include <array>
#include <random>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  struct Shape
  {
    std::string        name;
    mesh::MeshPiece<2> whole;
    double             least_angle, greatest_angle;
  };

  /// A lattice of unit squares, or of their halves.
  mesh::MeshPiece<2> lattice(const bool in_triangles)
  {
    auto piece = unit_cells(4, 3);
    if (!in_triangles)
      return piece;
    const auto squares = piece.cells;
    piece.cells.clear();
    for (const auto &cell : squares)
      {
        const auto c = [&](const unsigned int k) { return mesh::corner<2>(cell, k); };
        piece.cells.push_back(mesh::triangle<2>(c(0), c(1), c(2)));
        piece.cells.push_back(mesh::triangle<2>(c(0), c(2), c(3)));
      }
    return piece;
  }

  const std::vector<Shape> shapes = {{"quadrilaterals", lattice(false), 18, 162},
                                     {"triangles", lattice(true), 18, 117}};

  dealii::Point<2> centre(const mesh::MeshPiece<2> &piece, const mesh::MeshPiece<2>::Cell &cell)
  {
    dealii::Tensor<1, 2> sum;
    const unsigned int   n = mesh::n_corners<2>(cell);
    for (unsigned int k = 0; k < n; ++k)
      sum += piece.vertices[mesh::corner<2>(cell, k)] / n;
    return dealii::Point<2>(sum);
  }
} // namespace

TEST(AdaptiveRefinement, angles_do_not_wear_off)
{
  for (const auto &shape : shapes)
    for (const bool to_a_point : {true, false})
      {
        std::mt19937             random(7);
        std::set<mesh::CellPath> refined;
        const dealii::Point<2>   point(1.2, .7);
        mesh::AdaptedPiece<2>    mesh = mesh::adapted(shape.whole, refined);
        ASSERT_EQ(mesh.piece.cells.size(), shape.whole.cells.size());
        for (unsigned int step = 0; step < 7; ++step)
          {
            const std::size_t before = mesh.piece.cells.size();
            if (to_a_point) // the cells nearest to it, whatever their shape
              {
                std::vector<std::pair<double, std::size_t>> order;
                for (std::size_t c = 0; c < before; ++c)
                  order.emplace_back(centre(mesh.piece, mesh.piece.cells[c]).distance(point), c);
                std::sort(order.begin(), order.end());
                for (unsigned int k = 0; k < 3; ++k)
                  refined.insert(mesh.paths[order[k].second]);
              }
            else if (before < 3000)
              for (unsigned int k = 0; k < 3; ++k)
                refined.insert(mesh.paths[random() % before]);
            else
              break;
            mesh               = mesh::adapted(shape.whole, refined);
            const auto quality = quality_of(mesh.piece);
            ASSERT_GT(mesh.piece.cells.size(), before) << shape.name;
            ASSERT_EQ(mesh.paths.size(), mesh.piece.cells.size());
            EXPECT_TRUE(quality.conforming) << shape.name << ", step " << step;
            EXPECT_NEAR(quality.area, 12, 1e-12);
            EXPECT_GT(quality.least_angle, shape.least_angle) << shape.name << ", step " << step;
            EXPECT_LT(quality.greatest_angle, shape.greatest_angle) << shape.name << ", step " << step;
          }
      }
}

TEST(AdaptiveRefinement, marks_are_complete_and_do_not_depend_on_their_order)
{
  for (const auto &shape : shapes)
    {
      std::set<mesh::CellPath> refined = {{0}, {5}};
      auto                     mesh    = mesh::adapted(shape.whole, refined);
      for (const auto &path : mesh.paths)
        refined.insert(path); // all of the cells there are
      mesh          = mesh::adapted(shape.whole, refined);
      auto complete = refined;
      EXPECT_EQ(mesh::adapted(shape.whole, complete).piece.cells, mesh.piece.cells);
      EXPECT_EQ(complete, refined);
      for (const auto &path : mesh.paths)
        EXPECT_GT(path.size(), 1u) << shape.name; // no cell of the first mesh is left
    }
}

TEST(AdaptiveRefinement, cells_of_subdomains_are_found_by_their_vertices)
{
  scene::Scene<2> scene;
  for (const double x : {0., 20.})
    {
      scene.bodies.emplace_back();
      scene.bodies.back().name   = x > 0 ? "b" : "a";
      scene.bodies.back().origin = {x, 0};
      scene.bodies.back().size   = {4, 3};
      scene.bodies.back().cells  = std::array<unsigned int, 2>{{4, 3}};
    }
  scene.decomposition.subdomains = 5;
  mesh::Refinement refinement;
  refinement.refined = {{}, {{1}}};
  const auto  mesh   = mesh::make_mesh(scene, MPI_COMM_SELF, &refinement);
  std::size_t n_of_b = 0;
  for (const auto &subdomain : mesh.subdomains)
    for (const auto &cell : subdomain->triangulation.active_cell_iterators())
      {
        std::vector<mesh::GlobalVertex> vertices;
        for (const unsigned int v : cell->vertex_indices())
          vertices.push_back(subdomain->global_vertices[cell->vertex_index(v)]);
        const auto &[body, path] = refinement.cells.at(mesh::cell_key(std::move(vertices)));
        EXPECT_EQ(body, subdomain->body);
        n_of_b += body;
        if (path.size() > 1)
          {
            EXPECT_LT(cell->diameter(), .6);
          }
      }
  EXPECT_EQ(mesh.n_cells, refinement.cells.size());
  EXPECT_EQ(mesh.n_cells - n_of_b, 12u);
  EXPECT_GT(n_of_b, 12u + 8);
}
