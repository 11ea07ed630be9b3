// Curves of edges: arcs, parabolas through mid nodes, splines; refinement onto them.
#include <slipstick/mechanics/surface.h>
#include <slipstick/mesh/edge_middles.h>
#include <slipstick/mesh/refinement.h>
#include <slipstick/mesh/smooth_outline.h>
#include <slipstick/mesh/triangulate.h>

#include <gtest/gtest.h>

using namespace slipstick;
using Point = dealii::Point<2>;
using Curve = mesh::EdgeCurve<2>;

namespace
{
  Point on_circle(const double radius, const double angle)
  {
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

  /// A body with the given outline (counterclockwise, seen from the origin): triangles around the origin.
  mesh::BodyMesh<2> fan(const std::vector<Point> &outline)
  {
    mesh::BodyMesh<2>  mesh;
    const unsigned int n = outline.size();
    mesh.piece.vertices  = outline;
    mesh.piece.vertices.emplace_back(0, 0);
    for (unsigned int i = 0; i < n; ++i)
      {
        const unsigned int next = (i + 1) % n;
        mesh.piece.cells.push_back(mesh::triangle<2>(n, i, next));
        mesh.piece.boundary_faces.push_back({{{std::min(i, next), std::max(i, next)}}, 0});
      }
    mesh.piece.global_vertices.resize(n + 1);
    return mesh;
  }

  scene::Body<2> from_file()
  {
    scene::Body<2> body;
    body.shape = scene::Shape::mesh;
    return body;
  }

  /// n points on the circle, whose distances differ by a factor of up to 3.
  std::vector<Point> uneven_circle(const double radius, const unsigned int n)
  {
    std::vector<double> angles = {0};
    for (unsigned int k = 1; k <= n; ++k)
      angles.push_back(angles.back() + 2 + std::sin(1.7 * k));
    std::vector<Point> points;
    for (unsigned int k = 0; k < n; ++k)
      points.push_back(on_circle(radius, 2 * M_PI * angles[k] / angles.back()));
    return points;
  }

  /// Half circles of radius 1 around (-2, 0) and (2, 0), n edges each, and straight sides of m edges.
  std::vector<Point> stadium(const unsigned int n, const unsigned int m)
  {
    std::vector<Point> points;
    for (const double side : {1., -1.})
      {
        for (unsigned int k = 0; k < n; ++k)
          points.push_back(Point(side * 2, 0) + on_circle(side, M_PI * (double(k) / n - 0.5)));
        for (unsigned int k = 0; k < m; ++k)
          points.emplace_back(side * (2 - 4. * k / m), side);
      }
    return points;
  }
} // namespace

TEST(EdgeCurve, parts_reversed_and_distances_are_those_of_the_curve)
{
  const auto arc      = Curve::arc(on_circle(2, 0.3), on_circle(2, 1.1), Point());
  const auto parabola = Curve::parabola({0, 0}, {1, 0.4}, {2.2, 0});
  for (const auto &curve : {arc, parabola})
    for (const double s : {0., 0.2, 0.77, 1.})
      {
        const auto part = curve.part(0.1, 0.8), back = curve.reversed();
        EXPECT_LT(part.point(s).distance(curve.point(0.1 + 0.7 * s)), 1e-14);
        EXPECT_LT(back.point(s).distance(curve.point(1 - s)), 1e-14);
        EXPECT_LT((back.tangent(s) + curve.tangent(1 - s)).norm(), 1e-13);
        EXPECT_LT((curve.tangent(s) - (curve.point(s + 1e-6) - curve.point(s - 1e-6)) / 2e-6).norm(), 1e-8);
        dealii::Tensor<1, 2> direction;
        direction[0] = 0.6;
        direction[1] = 0.8;
        EXPECT_NEAR(curve.distance_along(curve.point(s) - 0.03 * direction, direction, 0.5), 0.03, 1e-14);
      }
  EXPECT_LT(parabola.point(0.5).distance(Point(1, 0.4)), 1e-15);
  EXPECT_NEAR(mesh::sagitta(arc), 2 * (1 - std::cos(0.4)), 1e-14);
}

TEST(SmoothOutline, nodes_of_a_circle_give_the_circle)
{
  for (const unsigned int n : {16, 40})
    {
      auto mesh = fan(uneven_circle(3, n));
      mesh::smooth_outline(from_file(), mesh);
      for (const auto &face : mesh.piece.boundary_faces)
        {
          ASSERT_TRUE(face.curve);
          for (const double s : {0., 0.25, 0.5, 0.9})
            EXPECT_NEAR(face.curve.point(s).norm(), 3, 1e-3 * mesh::sagitta(face.curve)) << n;
        }
    }
}

TEST(SmoothOutline, straight_sides_and_corners_stay)
{
  // square with several edges per side; a kink of 15 degrees between straight sides; hexagon
  std::vector<Point> square, kinked, hexagon;
  for (unsigned int k = 0; k < 20; ++k)
    {
      const double s    = k % 5 / 2.5 - 1;
      const Point  at[] = {{s, -1}, {1, s}, {-s, 1}, {-1, -s}};
      square.push_back(at[k / 5]);
      kinked.push_back(k / 5 == 2 ? Point(-s, 1 + (1 - std::abs(s)) * std::tan(M_PI / 24)) : at[k / 5]);
    }
  kinked.insert(kinked.begin() + 13, Point(0, 1 + std::tan(M_PI / 24)));
  for (unsigned int k = 0; k < 6; ++k)
    hexagon.push_back(on_circle(1, k * M_PI / 3));
  for (const auto &outline : {square, kinked, hexagon})
    {
      auto mesh = fan(outline);
      mesh::smooth_outline(from_file(), mesh);
      for (const auto &face : mesh.piece.boundary_faces)
        EXPECT_FALSE(face.curve) << outline.size();
    }
}

TEST(SmoothOutline, arcs_go_on_from_straight_sides_without_a_corner)
{
  auto mesh = fan(stadium(12, 6));
  mesh::smooth_outline(from_file(), mesh);
  unsigned int n_curves = 0;
  for (const auto &face : mesh.piece.boundary_faces)
    {
      const auto a = mesh.piece.vertices[face.vertices[0]], b = mesh.piece.vertices[face.vertices[1]];
      const bool is_straight = std::abs(std::abs(a[1]) - 1) < 1e-14 && std::abs(a[1] - b[1]) < 1e-14;
      EXPECT_EQ(bool(face.curve), !is_straight);
      n_curves += bool(face.curve);
      for (const double s : {0.2, 0.5, 0.8})
        if (face.curve)
          {
            const auto x = face.curve.point(s);
            EXPECT_NEAR(x.distance(Point(std::copysign(2, x[0]), 0)), 1, 1e-5);
          }
    }
  EXPECT_EQ(n_curves, 24u);
}

TEST(SmoothOutline, polygon_on_demand_and_too_coarse_circles_note_what_they_leave_out)
{
  for (const unsigned int n : {8, 24})
    {
      auto body               = from_file();
      body.has_smooth_outline = n == 8;
      std::vector<Point> circle;
      for (unsigned int k = 0; k < n; ++k)
        circle.push_back(on_circle(1, 2 * M_PI * k / n));
      auto mesh = fan(circle);
      mesh::smooth_outline(body, mesh);
      for (const auto &face : mesh.piece.boundary_faces)
        {
          EXPECT_FALSE(face.curve);
          EXPECT_NEAR(face.curve.neglected_sagitta, 1 - std::cos(M_PI / n), 1e-6);
        }
    }
}

TEST(SmoothOutline, refinement_goes_onto_the_curve)
{
  auto mesh = fan(uneven_circle(3, 20));
  mesh::smooth_outline(from_file(), mesh);
  auto fine = mesh::refined(mesh::refined_towards(mesh::refined(mesh.piece), {0}));
  EXPECT_EQ(fine.boundary_faces.size(), 160u);
  for (const auto &face : fine.boundary_faces)
    {
      EXPECT_TRUE(face.curve);
      EXPECT_LT(face.curve.point(0).distance(fine.vertices[face.vertices[0]]), 1e-14);
      EXPECT_NEAR(fine.vertices[face.vertices[0]].norm(), 3, 1e-5);
    }
}

TEST(SmoothOutline, mid_nodes_of_files_are_kept)
{
  // one cell of 8 nodes whose lower edge is bent
  const std::string
    gmsh   = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 2 0 0\n3 2 1 0\n4 0 1 0\n"
             "5 1 -0.1 0\n6 2 .5 0\n7 1 1 0\n8 0 .5 0\n$EndNodes\n$Elements\n1\n1 16 2 1 1 1 2 3 4 5 6 7 8\n"
             "$EndElements\n",
    abaqus = "*NODE\n1,0,0\n2,2,0\n3,2,1\n4,0,1\n5,1,-.1\n6,2,.5\n7,1,1\n8,0,.5\n"
             "*ELEMENT, TYPE=CPS8, ELSET=ALL\n1,1,2,3,4,5,6,7,8\n",
    vtk    = "# vtk DataFile Version 2.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n0 0 0\n2 0 0\n"
             "2 1 0\n0 1 0\n1 -.1 0\n2 .5 0\n1 1 0\n0 .5 0\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n23\n",
    unv    = "-1\n2411\n1 1 1 11\n0 0 0\n2 1 1 11\n2 0 0\n3 1 1 11\n2 1 0\n4 1 1 11\n0 1 0\n5 1 1 11\n1 -.1 0\n"
             "6 1 1 11\n2 .5 0\n7 1 1 11\n1 1 0\n8 1 1 11\n0 .5 0\n-1\n-1\n2412\n1 95 1 1 7 8\n"
             "1 5 2 6 3 7 4 8\n-1\n";
  for (const auto &file : {mesh::parse_gmsh("gmsh", gmsh),
                           mesh::parse_abaqus("abaqus", abaqus),
                           mesh::parse_vtk("vtk", vtk),
                           mesh::parse_unv("unv", unv)})
    {
      auto body  = from_file();
      body.scale = 10;
      auto mesh  = mesh::body_from_file(body, file);
      mesh::smooth_outline(body, mesh);
      unsigned int n_curves = 0;
      for (const auto &face : mesh.piece.boundary_faces)
        if (face.curve)
          {
            ++n_curves;
            EXPECT_LT(face.curve.point(0.5).distance(Point(10, -1)), 1e-13);
          }
      EXPECT_EQ(n_curves, 1u);
      // of the cells of degree 2, too: area of the cell and of the segment of a parabola
      mesh::Mesh<2> whole;
      whole.comm                 = MPI_COMM_SELF;
      whole.first_subdomain      = {0, 1};
      mesh.piece.global_vertices = {0, 1, 2, 3};
      mesh::bend_edges(mesh.piece);
      whole.subdomains.push_back(mesh::triangulate(mesh.piece));
      const mechanics::Spaces<2> spaces(whole, 2);
      const auto                 outline = mechanics::outlines(whole, spaces, {true});
      double                     area    = 0;
      for (const auto &edge : outline) // Gauss
        for (const double s : {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)})
          area += (s == 0.5 ? 8. : 5.) / 36 * cross(dealii::Tensor<1, 2>(edge.point(s)), edge.tangent(s));
      EXPECT_NEAR(area, 200 + 2. / 3 * 20 * 1, 1e-11);
    }
}

TEST(SmoothOutline, mid_nodes_of_other_formats_of_gmsh)
{
  for (const std::string file : {"gmsh_sector.vtk", "gmsh_sector.unv"}) // a quarter of a ring of radii 1 and 2
    {
      auto body = from_file();
      auto mesh = mesh::body_from_file(body, mesh::read_mesh_file(std::string(SLIPSTICK_MESHES) + "/" + file));
      mesh::smooth_outline(body, mesh);
      unsigned int n_curves = 0;
      for (const auto &face : mesh.piece.boundary_faces)
        if (face.curve)
          {
            ++n_curves;
            EXPECT_NEAR(face.curve.point(0.5).norm(), mesh.piece.vertices[face.vertices[0]].norm(), 1e-9) << file;
          }
      EXPECT_EQ(n_curves, 4u) << file;
    }
}
