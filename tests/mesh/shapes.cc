#include "mesh_quality.h"
#include "torn.h"

#include <slipstick/mesh/make_body.h>
#include <slipstick/mesh/refinement.h>
#include <slipstick/mesh/shapes.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q.h>

#include <array>

using namespace slipstick;
using namespace slipstick::test;
using scene::Shape;

namespace
{
  scene::Body<2> body_of(const Shape shape)
  {
    scene::Body<2> body;
    body.name         = "b";
    body.shape        = shape;
    body.center       = Point(3, -2);
    body.radius       = 5;
    body.inner_radius = 2;
    body.size         = Point(6, 4);
    body.cells        = {};
    return body;
  }

  const std::vector<Shape> round_shapes = {Shape::disc,
                                           Shape::half_disc,
                                           Shape::quarter_disc,
                                           Shape::ring,
                                           Shape::quarter_ring};

  bool is_disc(const Shape shape)
  {
    return shape == Shape::disc || shape == Shape::half_disc || shape == Shape::quarter_disc;
  }

  mesh::BodyMesh<2> make(const scene::Body<2> &body)
  {
    Scene scene;
    scene.bodies.push_back(body);
    std::map<std::string, mesh::MeshFile> files;
    return mesh::make_body(scene, 0, files);
  }

  double exact_area(const scene::Body<2> &body)
  {
    const double disc = M_PI * body.radius * body.radius, hole = M_PI * body.inner_radius * body.inner_radius;
    return body.shape == Shape::disc           ? disc
           : body.shape == Shape::half_disc    ? disc / 2
           : body.shape == Shape::quarter_disc ? disc / 4
           : body.shape == Shape::ring         ? disc - hole
                                               : (disc - hole) / 4;
  }
} // namespace

TEST(Shapes, round_bodies_have_their_area_up_to_second_order)
{
  for (const Shape shape : round_shapes)
    {
      double last = 0;
      for (unsigned int refinements = 0; refinements < 3; ++refinements)
        {
          auto body           = body_of(shape);
          body.refinements    = refinements;
          const auto   mesh   = make(body);
          const double error  = exact_area(body) - quality_of(mesh.piece).area;
          const auto   checks = quality_of(mesh.piece);
          EXPECT_TRUE(checks.conforming);
          EXPECT_GT(checks.least_angle, 40) << int(shape);
          EXPECT_LT(checks.greatest_angle, 150) << int(shape);
          EXPECT_GT(error, 0);
          EXPECT_LT(error, .02 * exact_area(body));
          if (refinements > 0)
            {
              EXPECT_NEAR(last / error, 4, .05) << int(shape);
            }
          last = error;
        }
    }
}

TEST(Shapes, vertices_of_arcs_lie_on_the_arc)
{
  for (const Shape shape : round_shapes)
    {
      auto body                 = body_of(shape);
      body.refinements          = 1;
      body.refined_boundaries   = {is_disc(shape) ? "arc" : "inner"};
      body.boundary_refinements = 2;
      const auto mesh           = make(body);
      const auto radius         = [&](const unsigned int id) {
        return is_disc(shape) || id == 1 ? body.radius : body.inner_radius;
      };
      for (const auto &face : mesh.piece.boundary_faces)
        if (face.curve)
          {
            for (const unsigned int v : face.vertices)
              EXPECT_NEAR(mesh.piece.vertices[v].distance(body.center), radius(face.id), 1e-13);
          }
    }
}

TEST(Shapes, boundaries_have_their_lengths)
{
  for (const Shape shape : round_shapes)
    {
      const auto   body = body_of(shape);
      const auto   mesh = make(body);
      const auto   at   = [&](const std::string &name) { return length_of(mesh.piece, mesh.boundary_ids.at(name)); };
      const double turn = shape == Shape::half_disc                                      ? M_PI
                          : shape == Shape::quarter_ring || shape == Shape::quarter_disc ? M_PI / 2
                                                                                         : 2 * M_PI;
      if (is_disc(shape))
        EXPECT_NEAR(at("arc") / (turn * 5), 1, .01);
      else
        {
          EXPECT_NEAR(at("outer") / (turn * 5), 1, .01);
          EXPECT_NEAR(at("inner") / (turn * 2), 1, .01);
        }
      if (shape == Shape::half_disc)
        {
          EXPECT_NEAR(at("flat"), 10, 1e-13);
        }
      if (shape == Shape::quarter_disc)
        {
          EXPECT_NEAR(at("flat"), 5, 1e-13);
          EXPECT_NEAR(at("side"), 5, 1e-13);
        }
      if (shape == Shape::quarter_ring)
        {
          EXPECT_NEAR(at("start"), 3, 1e-13);
          EXPECT_NEAR(at("end"), 3, 1e-13);
        }
    }
}

TEST(Shapes, half_disc_hangs_below_its_centre_and_quarter_ring_lies_between_the_axes)
{
  for (const auto &x : make(body_of(Shape::half_disc)).piece.vertices)
    EXPECT_LE(x[1], -2);
  const auto ring = make(body_of(Shape::quarter_ring));
  for (const auto &x : ring.piece.vertices)
    {
      EXPECT_GE(x[0], 3);
      EXPECT_GE(x[1], -2);
    }
  for (const auto &face : ring.piece.boundary_faces)
    for (const unsigned int v : face.vertices)
      if (face.id == ring.boundary_ids.at("start"))
        {
          EXPECT_EQ(ring.piece.vertices[v][1], -2);
        }
      else if (face.id == ring.boundary_ids.at("end"))
        {
          EXPECT_EQ(ring.piece.vertices[v][0], 3);
        }
}

TEST(Shapes, disc_and_half_disc_have_a_vertex_at_the_lowest_point)
{
  for (const Shape shape : {Shape::disc, Shape::half_disc})
    for (const unsigned int n : {8, 12, 20, 32, 36})
      {
        auto body            = body_of(shape);
        body.cells_along_arc = n;
        const auto mesh      = make(body);
        double     least     = 1e300;
        unsigned   n_arc     = 0;
        for (const auto &x : mesh.piece.vertices)
          least = std::min(least, x.distance(Point(3, -7)));
        for (const auto &face : mesh.piece.boundary_faces)
          n_arc += face.id == mesh.boundary_ids.at("arc");
        EXPECT_LT(least, 1e-13);
        EXPECT_EQ(n_arc, n);
      }
}

TEST(Shapes, degree_two_follows_the_arc)
{
  // whatever the cut, the area by an isoparametric mapping of degree 2 is far more accurate than that of straight edges
  for (const Cut &how : {whole(), metis(7)})
    for (const Shape shape : round_shapes)
      {
        Scene scene;
        auto  body = body_of(shape);
        scene.bodies.push_back(body);
        const auto mesh = mesh::make_mesh(cut(scene, how), MPI_COMM_WORLD);
        double     area = 0;
        for (const auto &subdomain : mesh.subdomains)
          {
            const dealii::MappingQ<2> mapping(2);
            const dealii::FE_Q<2>     element(2);
            dealii::FEValues<2>       values(mapping, element, dealii::QGauss<2>(4), dealii::update_JxW_values);
            for (const auto &cell : subdomain->triangulation.active_cell_iterators())
              {
                values.reinit(cell);
                for (const double w : values.get_JxW_values())
                  area += w;
              }
          }
        area = dealii::Utilities::MPI::sum(area, MPI_COMM_WORLD);
        EXPECT_NEAR(area / exact_area(body), 1, 2e-5) << int(shape);
      }
}

// placement

TEST(Placement, mirror_turn_and_move_in_this_order)
{
  auto body                       = body_of(Shape::rectangle);
  body.cells                      = std::array<unsigned int, 2>{{1, 1}};
  body.origin                     = Point(1, 2);
  body.placement.mirror_x         = true;
  body.placement.rotation         = 90;
  body.placement.translation      = Point(10, 20);
  const auto               mesh   = make(body);
  const std::vector<Point> expect = {Point(8, 19), Point(8, 13), Point(4, 19), Point(4, 13)};
  for (unsigned int v = 0; v < 4; ++v)
    EXPECT_EQ(mesh.piece.vertices[v], expect[v]); // quarters are exact
  EXPECT_NEAR(quality_of(mesh.piece).area, 24, 1e-12);
  EXPECT_NEAR(quality_of(mesh.piece).least_angle, 90, 1e-10);
}

TEST(Placement, keeps_areas_and_names_for_blocks_and_metis)
{
  for (const Cut &how : {whole(), blocks(2), metis(5)})
    {
      Scene scene;
      auto  body                 = body_of(Shape::rectangle);
      body.cells                 = std::array<unsigned int, 2>{{8, 4}};
      body.placement.mirror_y    = true;
      body.placement.rotation    = 30;
      body.placement.translation = Point(-3, 1);
      scene.bodies.push_back(body);
      const auto mesh = mesh::make_mesh(cut(scene, how), MPI_COMM_WORLD);
      double     area = 0, left = 0, wrong = 0;
      for (const auto &subdomain : mesh.subdomains)
        for (const auto &cell : subdomain->triangulation.active_cell_iterators())
          {
            area += cell->measure();
            for (const auto &face : cell->face_iterators())
              if (face->at_boundary() && mesh.on_boundary({0, "left"}, face->boundary_id()))
                {
                  left += face->measure();
                  // back to the rectangle's own axes
                  const auto x = face->center() - Point(-3, 1);
                  wrong        = std::max(wrong, std::abs(std::cos(M_PI / 6) * x[0] + std::sin(M_PI / 6) * x[1]));
                }
          }
      EXPECT_NEAR(dealii::Utilities::MPI::sum(area, MPI_COMM_WORLD), 24, 1e-12);
      EXPECT_NEAR(dealii::Utilities::MPI::sum(left, MPI_COMM_WORLD), 4, 1e-12);
      EXPECT_LT(dealii::Utilities::MPI::max(wrong, MPI_COMM_WORLD), 1e-13);
    }
}

// refinement

TEST(Refinement, towards_a_boundary_conforms_and_keeps_area_lengths_and_quality)
{
  for (const Shape shape : {Shape::rectangle, Shape::disc, Shape::half_disc, Shape::ring, Shape::quarter_ring})
    for (const unsigned int levels : {1, 3})
      for (const auto &[name, id] : mesh::shape_boundary_ids(shape))
        {
          auto body = body_of(shape);
          if (shape == Shape::rectangle)
            body.cells = std::array<unsigned int, 2>{{6, 4}};
          const auto coarse         = make(body);
          body.refined_boundaries   = {name};
          body.boundary_refinements = levels;
          const auto fine           = make(body);
          const auto before = quality_of(coarse.piece), after = quality_of(fine.piece);
          EXPECT_TRUE(after.conforming) << int(shape) << name;
          EXPECT_GT(after.least_angle, 30) << int(shape) << name; // the templates' 45 degrees on oblong cells
          EXPECT_LT(after.greatest_angle, 165) << int(shape) << name;
          EXPECT_GT(fine.piece.cells.size(), coarse.piece.cells.size());
          if (shape == Shape::rectangle)
            {
              EXPECT_NEAR(after.area, before.area, 1e-12);
              EXPECT_NEAR(after.least_edge, std::pow(3., -int(levels)), 1e-10);
            }
          // every edge of the boundary is divided
          std::size_t n_before = 0, n_after = 0;
          for (const auto &face : coarse.piece.boundary_faces)
            n_before += face.id == id;
          for (const auto &face : fine.piece.boundary_faces)
            n_after += face.id == id;
          EXPECT_EQ(n_after, n_before * unsigned(std::lround(std::pow(3, levels))));
        }
}

TEST(Refinement, every_template_conforms)
{
  // All patterns of marked corners occur on a lattice whose vertices are marked at random. A boundary id for every
  // pattern is not possible; the marks therefore come from single cells cut out of the lattice.
  for (unsigned int pattern = 1; pattern < 512; pattern += 7)
    {
      mesh::MeshPiece<2> piece;
      for (unsigned int j = 0; j <= 4; ++j)
        for (unsigned int i = 0; i <= 4; ++i)
          piece.vertices.emplace_back(i + .1 * j, j - .07 * i);
      for (unsigned int j = 0; j < 4; ++j)
        for (unsigned int i = 0; i < 4; ++i)
          if ((pattern >> ((i * 5 + j * 3) % 9) & 1) || j == 0)
            piece.cells.push_back(mesh::quadrilateral<2>(j * 5 + i, j * 5 + i + 1, j * 5 + i + 6, j * 5 + i + 5));
      const auto faces = mesh::faces_with_cells(piece);
      for (std::size_t k = 0; k < faces.size(); ++k)
        if ((k == 0 || faces[k - 1].first != faces[k].first) &&
            (k + 1 == faces.size() || faces[k + 1].first != faces[k].first))
          piece.boundary_faces.push_back({faces[k].first, (k * pattern) % 5 == 0 ? 1u : 0u});
      const auto fine = mesh::refined_towards(piece, {1});
      EXPECT_TRUE(quality_of(fine).conforming) << pattern;
      EXPECT_NEAR(quality_of(fine).area, quality_of(piece).area, 1e-12);
      EXPECT_GT(quality_of(fine).least_angle, 35) << pattern;
      EXPECT_LT(quality_of(fine).greatest_angle, 150) << pattern;
    }
}

TEST(Refinement, triangles_conform_and_keep_their_angles)
{
  mesh::MeshPiece<2> piece;
  const unsigned int n = 6;
  for (unsigned int j = 0; j <= n; ++j)
    for (unsigned int i = 0; i <= n; ++i)
      piece.vertices.emplace_back(i + .5 * j, j * std::sqrt(.75)); // equilateral
  for (unsigned int j = 0; j < n; ++j)
    for (unsigned int i = 0; i < n; ++i)
      {
        const unsigned int a = j * (n + 1) + i;
        piece.cells.push_back(mesh::triangle<2>(a, a + 1, a + n + 1));
        piece.cells.push_back(mesh::triangle<2>(a + 1, a + n + 2, a + n + 1));
      }
  for (unsigned int i = 0; i < n; ++i)
    {
      piece.boundary_faces.push_back({{{i, i + 1}}, i < 2 ? 1u : 0u});
      piece.boundary_faces.push_back({{{n * (n + 1) + i, n * (n + 1) + i + 1}}, 0});
      piece.boundary_faces.push_back({{{i * (n + 1), (i + 1) * (n + 1)}}, 0});
      piece.boundary_faces.push_back({{{i * (n + 1) + n, (i + 1) * (n + 1) + n}}, 0});
    }
  ASSERT_TRUE(quality_of(piece).conforming);
  const double area = quality_of(piece).area;
  EXPECT_EQ(mesh::refined(piece).cells.size(), 4 * piece.cells.size());
  for (unsigned int level = 0; level < 5; ++level)
    {
      piece = mesh::refined_towards(piece, {1});
      EXPECT_TRUE(quality_of(piece).conforming);
      EXPECT_NEAR(quality_of(piece).area, area, 1e-12);
      EXPECT_GT(quality_of(piece).least_angle, 29.9); // halves of equilateral triangles, and nothing worse
      EXPECT_LT(quality_of(piece).greatest_angle, 90.1);
      EXPECT_NEAR(length_of(piece, 1), 2, 1e-13);
    }
}
