// Solids of second order: nodes of mesh files, curved faces, refinement, cuts.
#include <slipstick/mesh/curved_faces.h>
#include <slipstick/mesh/refinement.h>
#include <slipstick/mesh/solid_middles.h>
#include <slipstick/mesh/triangulate.h>

#include <gtest/gtest.h>

#include <functional>
#include <sstream>

namespace
{
  using namespace slipstick;

  struct CurvedSolid
  {
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;
    using Piece  = mesh::MeshPiece<3>;
    using Map    = std::function<Point(const Point &)>;

    /// Nodes of the unit cube or the unit tetrahedron in the order of a program: corners, and for every other node the
    /// corners between which it lies.
    struct Cell
    {
      std::string                            kind; // of Abaqus, Gmsh's number, or number in .vtk or .unv
      std::vector<Point>                     corners;
      std::vector<std::vector<unsigned int>> between;
      std::vector<unsigned int>              order = {}; // of the nodes in the file, from 1; empty: this order
    };

    static std::vector<Cell> cells()
    {
      const std::vector<Point>
        cube        = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
        tetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      const std::vector<std::vector<unsigned int>>
        of_cube = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
        of_tetrahedron = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
      auto with_faces  = of_cube; // of VTK
      with_faces.insert(
        with_faces.end(),
        {{0, 3, 4, 7}, {1, 2, 5, 6}, {0, 1, 4, 5}, {2, 3, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}});
      return {{"C3D20R", cube, of_cube},
              {"C3D10", tetrahedron, of_tetrahedron},
              {"vtk 24", tetrahedron, of_tetrahedron},
              {"vtk 25", cube, of_cube},
              {"vtk 29", cube, with_faces},
              {"unv 118", tetrahedron, of_tetrahedron, {1, 5, 2, 6, 3, 7, 8, 9, 10, 4}},
              {"unv 116", cube, of_cube, {1, 9, 2, 10, 3, 11, 4, 12, 17, 18, 19, 20, 5, 13, 6, 14, 7, 15, 8, 16}},
              {"11", tetrahedron, {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}}},
              {"17",
               cube,
               {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}},
              {"12",
               cube,
               {{0, 1},
                {0, 3},
                {0, 4},
                {1, 2},
                {1, 5},
                {2, 3},
                {2, 6},
                {3, 7},
                {4, 5},
                {4, 7},
                {5, 6},
                {6, 7},
                {0, 1, 2, 3},
                {0, 1, 4, 5},
                {0, 3, 4, 7},
                {1, 2, 5, 6},
                {2, 3, 6, 7},
                {4, 5, 6, 7},
                {0, 1, 2, 3, 4, 5, 6, 7}}}};
    }

    /// A file with this one cell.
    static mesh::MeshFile file(const Cell &cell, const std::vector<Point> &nodes)
    {
      const std::string  program   = cell.kind.substr(0, cell.kind.find(' '));
      const std::string  separator = program[0] == 'C' ? ", " : " ", n = std::to_string(nodes.size());
      std::ostringstream numbered, places, numbers, from_zero;
      numbered.precision(17);
      places.precision(17);
      for (unsigned int k = 0; k < nodes.size(); ++k)
        {
          std::ostringstream place;
          place.precision(17);
          place << nodes[k][0] << separator << nodes[k][1] << separator << nodes[k][2] << '\n';
          numbered << k + 1 << (program == "unv" ? " 1 1 11\n" : separator) << place.str();
          places << place.str();
          const unsigned int number = cell.order.empty() ? k + 1 : cell.order[k];
          numbers << separator << number;
          from_zero << separator << number - 1;
        }
      const std::string type = cell.kind.substr(cell.kind.find(' ') + 1);
      if (program == "vtk")
        return mesh::parse_vtk("a.vtk",
                               "# vtk DataFile Version 2.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " + n +
                                 " double\n" + places.str() + "CELLS 1 " + std::to_string(nodes.size() + 1) + "\n" + n +
                                 from_zero.str() + "\nCELL_TYPES 1\n" + type + "\n");
      if (program == "unv")
        return mesh::parse_unv("a.unv",
                               "-1\n2411\n" + numbered.str() + "-1\n-1\n2412\n1 " + type + " 1 1 7 " + n + "\n" +
                                 numbers.str() + "\n-1\n");
      if (program[0] == 'C')
        return mesh::parse_abaqus("a.inp",
                                  "*NODE\n" + numbered.str() + "*ELEMENT, TYPE=" + cell.kind + "\n1" + numbers.str() +
                                    '\n');
      return mesh::parse_gmsh("a.msh",
                              "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + n + "\n" + numbered.str() +
                                "$EndNodes\n$Elements\n1\n1 " + cell.kind + " 2 0 0" + numbers.str() +
                                "\n$EndElements\n");
    }

    static mesh::BodyMesh<3> read(const Cell &cell, const Map &map, const bool is_smooth = true)
    {
      auto nodes = cell.corners;
      for (const auto &corners : cell.between)
        {
          Point sum;
          for (const unsigned int k : corners)
            sum += Tensor(cell.corners[k]) / double(corners.size());
          nodes.push_back(sum);
        }
      for (Point &x : nodes)
        x = map(x);
      scene::Body<3> body;
      body.name               = "body";
      body.has_smooth_outline = is_smooth;
      auto mesh               = mesh::body_from_file(body, file(cell, nodes));
      mesh::curve_faces(body, mesh);
      return mesh;
    }

    static Point bent(const Point &x)
    {
      return {x[0] + 0.1 * x[1] * x[1], x[1] - 0.1 * x[2] * x[0], x[2] + 0.1 * x[0] * x[0] - 0.05 * x[1] * x[1]};
    }

    /// Largest distance of the midpoints of curved edges from where a map of degree 2 places them.
    static double off(const Piece &piece, const Map &map, const Map &inverse)
    {
      const auto               boundary = mesh::boundary_by_vertices(piece);
      const mesh::SolidMiddles middles(piece, boundary);
      double                   largest = 0;
      const auto               mean    = [&](const auto &vertices) {
        Tensor sum;
        for (const unsigned int v : vertices)
          sum += Tensor(inverse(piece.vertices[v])) / double(vertices.size());
        return map(Point(sum));
      };
      for (const auto &[vertices, face] : boundary)
        if (face.curve) // edges within plane faces may be straight
          for (const auto &cell : piece.cells)
            for (const auto &line : mesh::lines_of_cell(cell))
              if (std::binary_search(vertices.begin(), vertices.end(), line[0]) &&
                  std::binary_search(vertices.begin(), vertices.end(), line[1]))
                largest = std::max(largest, middles.on_line(line[0], line[1]).distance(mean(line)));
      return largest;
    }
  };
} // namespace

TEST(CurvedSolid, nodes_of_second_order_are_where_the_programs_have_them)
{
  using S = CurvedSolid;
  for (const auto &cell : S::cells())
    {
      const auto mesh = S::read(cell, S::bent);
      // vertices are the nodes in the order of the file
      std::map<mesh::GlobalVertex, S::Point> corner;
      const auto                             inverse = [&](const S::Point &x) {
        for (const auto &c : cell.corners)
          if (S::bent(c).distance(x) < 1e-12)
            return c;
        ADD_FAILURE() << cell.kind;
        return x;
      };
      EXPECT_GE(mesh.piece.line_middles.size(), 5u) << cell.kind;
      EXPECT_LT(S::off(mesh.piece, S::bent, inverse), 1e-12) << cell.kind;
      EXPECT_EQ(mesh.remarks.size(), 1u);

      const auto straight = S::read(cell, [](const S::Point &x) { return S::Point(2 * x[0] + x[1], x[1], 3 * x[2]); });
      EXPECT_TRUE(straight.piece.line_middles.empty());
      for (const auto &face : straight.piece.boundary_faces)
        EXPECT_FALSE(face.curve);

      double     neglected_sagitta = 0;
      const auto polygon           = S::read(cell, S::bent, false);
      EXPECT_TRUE(polygon.piece.line_middles.empty());
      for (const auto &face : polygon.piece.boundary_faces)
        neglected_sagitta = std::max(neglected_sagitta, face.curve.neglected_sagitta);
      EXPECT_GT(neglected_sagitta, 0.01);
    }
}

// A quarter of a ring of radii 1 and 2: mid nodes between two nodes of a rim lie on the rim.
TEST(CurvedSolid, mid_nodes_of_other_formats_of_gmsh)
{
  using S = CurvedSolid;
  for (const std::string file : {"10.vtk", "10.unv", "27.vtk", "27.unv"})
    {
      scene::Body<3> body;
      body.name  = "body";
      body.shape = scene::Shape::mesh;
      body.file  = std::string(SLIPSTICK_MESHES) + "/gmsh_sector_" + file;
      auto mesh  = mesh::body_from_file(body, mesh::read_mesh_file(body.file));
      mesh::curve_faces(body, mesh);
      EXPECT_EQ(mesh.boundary_ids.count(file.find("unv") != std::string::npos ? "outer_rim" : "2"), 1u) << file;
      const auto   radius  = [](const S::Point &x) { return std::hypot(x[0], x[1]); };
      unsigned int n_bends = 0;
      for (const auto &entry : mesh.piece.line_middles)
        {
          const S::Point a = mesh.piece.vertices[entry.first[0]], b = mesh.piece.vertices[entry.first[1]];
          if (std::abs(radius(a) - radius(b)) > 1e-9)
            continue;
          ++n_bends;
          EXPECT_NEAR(radius(entry.second), radius(a), 1e-9) << file;
          EXPECT_LT(entry.second.distance(a + 0.5 * (b - a)), 0.3 * a.distance(b)) << file;
          EXPECT_NEAR(entry.second[2], (a[2] + b[2]) / 2, 1e-9) << file;
        }
      EXPECT_GE(n_bends, 8u) << file; // two edges at either rim of bottom and top
    }
}

// Refined twice, as a whole or towards one side: all new nodes lie on the surface z = x^2 / 10, and the edges follow
// it.
TEST(CurvedSolid, refinement_stays_on_the_surface)
{
  using S            = CurvedSolid;
  const auto map     = [](const S::Point &x) { return S::Point(x[0], x[1], x[2] + 0.1 * x[0] * x[0]); };
  const auto inverse = [](const S::Point &x) { return S::Point(x[0], x[1], x[2] - 0.1 * x[0] * x[0]); };
  for (const auto &cell : S::cells())
    for (const bool is_whole : {true, false})
      {
        auto piece                 = S::read(cell, map).piece;
        piece.boundary_faces[0].id = 7;
        for (unsigned int level = 0; level < 2; ++level)
          {
            piece = is_whole ? mesh::refined(piece) : mesh::refined_towards(piece, {7});
            std::set<unsigned int> outside;
            for (const auto &face : piece.boundary_faces)
              for (const unsigned int v : face.vertices)
                if (v != S::Piece::no_vertex)
                  outside.insert(v);
            for (const unsigned int v : outside)
              {
                const auto   x = inverse(piece.vertices[v]); // on the cube or tetrahedron
                const double to_plane =
                  std::min({x[0],
                            x[1],
                            x[2],
                            cell.corners.size() == 4 ? 1 - x[0] - x[1] - x[2] : 1 - std::max({x[0], x[1], x[2]})});
                EXPECT_NEAR(to_plane, 0, 1e-12) << cell.kind;
              }
            EXPECT_LT(S::off(piece, map, inverse), 1e-12) << cell.kind << level;
            EXPECT_EQ(mesh::keep_good_middles(piece), 0u);
          }
      }
}

// Edges inside of a body that only touch its curved surface belong to cells of other subdomains, too.
TEST(CurvedSolid, all_subdomains_at_an_edge_have_its_middle)
{
  scene::Scene<3> scene;
  scene.bodies.resize(1);
  auto &body           = scene.bodies[0];
  body.shape           = scene::Shape::ball;
  body.radius          = 10;
  body.cells_along_arc = 8;
  const auto piece     = mesh::body_from_shape(scene, body).piece;
  EXPECT_EQ(piece.line_middles.size(), 48u);
  for (const auto &[line, x] : piece.line_middles)
    EXPECT_NEAR(x.norm(), 10, 1e-12);
  std::vector<unsigned int> part;
  for (unsigned int c = 0; c < piece.cells.size(); ++c)
    part.push_back(c % 5);
  unsigned int n_curved = 0;
  for (const auto &cut : mesh::cut(piece, part))
    {
      const auto mesh = mesh::triangulate(cut);
      for (const auto &cell : mesh->triangulation.active_cell_iterators())
        for (const unsigned int l : cell->line_indices())
          if (const auto line = cell->line(l); line->vertex(0).norm() > 9.99 && line->vertex(1).norm() > 9.99)
            {
              ++n_curved;
              EXPECT_NEAR(line->center(true).norm(), 10, 1e-12);
            }
    }
  EXPECT_GE(n_curved, 96u);
}

TEST(CurvedSolid, cells_that_would_turn_over_keep_straight_edges)
{
  using S = CurvedSolid;
  for (const auto &cell : S::cells())
    {
      const auto mesh = S::read(cell, [](const S::Point &x) {
        return S::Point(x[0], x[1], x[2] + 6 * x[0] * (1 - x[0]) * (1 - x[2]));
      });
      EXPECT_TRUE(mesh.piece.line_middles.empty());
      ASSERT_EQ(mesh.remarks.size(), 1u);
      EXPECT_NE(mesh.remarks[0].text.find("edges of 1 cells that this would invert stay straight"), std::string::npos);
    }
}

// Red and green: no face hangs, and the refined mesh has the volume and the curved faces of the coarse one.
TEST(CurvedSolid, tetrahedra_refined_towards_a_boundary)
{
  using S = CurvedSolid;
  // cubes of six tetrahedra around a diagonal
  S::Piece               piece;
  constexpr unsigned int n      = 3;
  const auto             number = [](const unsigned int i, const unsigned int j, const unsigned int k) {
    return (k * (n + 1) + j) * (n + 1) + i;
  };
  for (unsigned int k = 0; k <= n; ++k)
    for (unsigned int j = 0; j <= n; ++j)
      for (unsigned int i = 0; i <= n; ++i)
        piece.vertices.emplace_back(i, j, k);
  for (unsigned int c = 0; c < n * n * n; ++c)
    for (const auto &[a, b] : {std::pair(1, 3), {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}})
      {
        const auto vertex = [&](const unsigned int v) {
          return number(c % n + (v & 1), c / n % n + (v >> 1 & 1), c / (n * n) + (v >> 2));
        };
        S::Piece::Cell cell;
        cell.fill(S::Piece::no_vertex);
        cell[0] = vertex(0), cell[1] = vertex(a), cell[2] = vertex(b), cell[3] = vertex(7);
        piece.cells.push_back(cell);
      }
  const auto faces = mesh::faces_with_cells(piece);
  for (std::size_t f = 0; f < faces.size(); ++f)
    if ((f == 0 || faces[f - 1].first != faces[f].first) &&
        (f + 1 == faces.size() || faces[f + 1].first != faces[f].first))
      {
        const auto &v = faces[f].first;
        piece.boundary_faces.push_back(
          {v, piece.vertices[v[0]][2] + piece.vertices[v[1]][2] + piece.vertices[v[2]][2] == 0 ? 1u : 0u});
      }
  const auto volume = [](const S::Piece &of) {
    double sum = 0;
    for (const auto &c : of.cells)
      {
        const auto  &x   = of.vertices;
        const double one = cross_product_3d(x[c[1]] - x[c[0]], x[c[2]] - x[c[0]]) * (x[c[3]] - x[c[0]]) / 6;
        EXPECT_GT(one, 0);
        sum += one;
      }
    return sum;
  };
  for (unsigned int level = 0; level < 3; ++level)
    {
      const std::size_t n_before = piece.cells.size();
      piece                      = mesh::refined_towards(piece, {1});
      EXPECT_NEAR(volume(piece), n * n * n, 1e-12);
      EXPECT_GT(piece.cells.size(), n_before);
      EXPECT_LT(piece.cells.size(), 8 * n_before);
      std::map<S::Piece::Face, unsigned int> n_cells;
      for (const auto &[face, c] : mesh::faces_with_cells(piece))
        ++n_cells[face];
      std::set<S::Piece::Face> outside, given;
      for (const auto &[face, n_at] : n_cells)
        {
          EXPECT_LE(n_at, 2u);
          if (n_at == 1)
            outside.insert(face);
        }
      double area = 0;
      for (const auto &face : piece.boundary_faces)
        {
          given.insert(face.vertices);
          const auto &x = piece.vertices;
          const auto &v = face.vertices;
          area += face.id * cross_product_3d(x[v[1]] - x[v[0]], x[v[2]] - x[v[0]]).norm() / 2;
        }
      EXPECT_EQ(outside, given);
      EXPECT_NEAR(area, n * n, 1e-12);
    }
}
