// Local refinement of hexahedra: templates, boundaries, curves.
#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/mesh/make_body.h>
#include <slipstick/mesh/refinement.h>
#include <slipstick/mesh/shapes.h>
#include <slipstick/mesh/solid_middles.h>

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace
{
  using namespace slipstick;
  struct Hexahedra
  {
    using Piece  = mesh::MeshPiece<3>;
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;

    /// A sheared lattice of n^3 cells; boundary ids 0 to 5 by sides as deal.II numbers them.
    static Piece lattice(const unsigned int n)
    {
      Piece      piece;
      const auto number = [n](const unsigned int i, const unsigned int j, const unsigned int k) {
        return (k * (n + 1) + j) * (n + 1) + i;
      };
      for (unsigned int k = 0; k <= n; ++k)
        for (unsigned int j = 0; j <= n; ++j)
          for (unsigned int i = 0; i <= n; ++i)
            piece.vertices.emplace_back(i + .1 * j + .2 * k, j - .07 * i, k + .05 * j);
      for (unsigned int c = 0; c < n * n * n; ++c)
        {
          const std::array<unsigned int, 3> at = {{c % n, c / n % n, c / (n * n)}};
          Piece::Cell                       cell;
          for (unsigned int v = 0; v < 8; ++v)
            cell[v] = number(at[0] + (v & 1), at[1] + (v >> 1 & 1), at[2] + (v >> 2));
          piece.cells.push_back(cell);
          for (unsigned int f = 0; f < 6; ++f)
            if (at[f / 2] == (f % 2 == 0 ? 0 : n - 1))
              piece.boundary_faces.push_back({mesh::face_of_cell<3>(cell, f), f});
        }
      return piece;
    }

    /// Jacobian of the trilinear map, from derivatives by the coordinates.
    static double jacobian(const Piece &piece, const Piece::Cell &cell, const std::array<double, 3> &at)
    {
      std::array<Tensor, 3> along;
      for (unsigned int v = 0; v < 8; ++v)
        for (unsigned int d = 0; d < 3; ++d)
          {
            double slope = v >> d & 1 ? 1 : -1;
            for (unsigned int e = 0; e < 3; ++e)
              if (e != d)
                slope *= v >> e & 1 ? at[e] : 1 - at[e];
            along[d] += slope * Tensor(piece.vertices[cell[v]]);
          }
      return cross_product_3d(along[0], along[1]) * along[2];
    }

    /// Smallest Jacobian at a corner over the volume of its cell, and the volumes of all cells.
    static std::pair<double, std::vector<double>> shapes(const Piece &piece)
    {
      double              worst = 1e300;
      std::vector<double> volumes;
      const double        gauss = 0.5 / std::sqrt(3.);
      for (const auto &cell : piece.cells)
        {
          double volume = 0, least = 1e300;
          for (unsigned int v = 0; v < 8; ++v)
            {
              std::array<double, 3> corner, point;
              for (unsigned int d = 0; d < 3; ++d)
                {
                  corner[d] = v >> d & 1;
                  point[d]  = 0.5 + (2 * corner[d] - 1) * gauss;
                }
              least = std::min(least, jacobian(piece, cell, corner));
              volume += jacobian(piece, cell, point) / 8;
            }
          worst = std::min(worst, least / volume);
          volumes.push_back(volume);
        }
      return {worst, volumes};
    }

    static std::pair<double, double> shapes_and_volume(const Piece &piece)
    {
      const auto [worst, volumes] = shapes(piece);
      return {worst, std::accumulate(volumes.begin(), volumes.end(), 0.)};
    }

    /// Expects that no face hangs and that the boundary faces are exactly the faces with one cell.
    static void expect_conforming(const Piece &piece)
    {
      std::map<Piece::Face, unsigned int> n_cells;
      for (const auto &entry : mesh::faces_with_cells(piece))
        ++n_cells[entry.first];
      std::set<Piece::Face> outside, given;
      for (const auto &[face, n] : n_cells)
        {
          EXPECT_LE(n, 2u);
          if (n == 1)
            outside.insert(face);
        }
      for (const auto &face : piece.boundary_faces)
        {
          auto key = face.vertices;
          std::sort(key.begin(), key.end());
          given.insert(key);
        }
      EXPECT_EQ(outside, given);
      EXPECT_EQ(given.size(), piece.boundary_faces.size());
    }

    /// Area of every boundary id, from the diagonals of its faces.
    static std::map<unsigned int, double> areas(const Piece &piece)
    {
      const auto                     boundary = mesh::boundary_by_vertices(piece);
      std::map<unsigned int, double> result;
      for (const auto &cell : piece.cells)
        for (unsigned int f = 0; f < 6; ++f)
          if (const auto found = boundary.find(mesh::face_of_cell<3>(cell, f)); found != boundary.end())
            {
              std::array<Point, 4> x;
              for (unsigned int v = 0; v < 4; ++v)
                x[v] = piece.vertices[cell[dealii::GeometryInfo<3>::face_to_cell_vertices(f, v)]];
              result[found->second.id] += cross_product_3d(x[3] - x[0], x[2] - x[1]).norm() / 2;
            }
      return result;
    }

    static mesh::BodyMesh<3> refined_shape(const scene::Shape shape,
                                           const std::string &towards,
                                           const unsigned int levels)
    {
      scene::Scene<3> scene;
      scene.bodies.resize(1);
      auto &body                = scene.bodies[0];
      body.name                 = "body";
      body.shape                = shape;
      body.radius               = 10;
      body.inner_radius         = 6;
      body.length               = 8;
      body.cells_along_arc      = 8;
      body.refined_boundaries   = {towards};
      body.boundary_refinements = levels;
      std::map<std::string, mesh::MeshFile> files;
      return mesh::make_body(scene, 0, files);
    }
  };
} // namespace

// Random marks that need every template: neighbours at corners, edges and faces, and concave sets.
TEST(HexahedraRefinement, conforms_for_all_marks_and_keeps_volumes_and_angles)
{
  using H                   = Hexahedra;
  const H::Piece     whole  = H::lattice(4);
  const auto         before = H::shapes_and_volume(whole);
  std::mt19937       random(1);
  std::set<unsigned> n_parts;
  for (unsigned int trial = 0; trial < 60; ++trial)
    {
      std::vector<bool> marked(whole.cells.size(), false);
      for (unsigned int n = 0; n < 1 + trial / 20; ++n)
        marked[random() % marked.size()] = true;
      const auto finer = mesh::refined_at(whole, marked);
      H::expect_conforming(finer.piece);
      const auto [worst, volume] = H::shapes_and_volume(finer.piece);
      EXPECT_NEAR(volume, before.second, 1e-11);
      EXPECT_GT(worst, 0.15);
      const auto areas = H::areas(finer.piece);
      for (const auto &[id, area] : H::areas(whole))
        EXPECT_NEAR(areas.at(id), area, 1e-11);
      std::map<unsigned int, unsigned int> children;
      for (const auto &origin : finer.origins)
        {
          ++children[origin.parent];
          EXPECT_FALSE(marked[origin.parent] && !origin.is_regular);
          EXPECT_FALSE(marked[origin.parent] && origin.is_parent);
        }
      for (const auto &[parent, n] : children)
        {
          n_parts.insert(n);
          EXPECT_TRUE(!marked[parent] || n == 27);
        }
    }
  EXPECT_EQ(n_parts, (std::set<unsigned>{1, 4, 11, 22, 27}));
}

// A slab at one side; slabs at two sides that meet: on a coarse lattice the marks spread, on a finer one they do not.
TEST(HexahedraRefinement, towards_boundaries)
{
  using H              = Hexahedra;
  const H::Piece whole = H::lattice(4);
  const H::Piece one   = mesh::refined_towards(whole, {4});
  H::expect_conforming(one);
  EXPECT_EQ(one.cells.size(), 16u * (27 + 22 + 2));
  EXPECT_EQ(mesh::refined_towards(whole, {0, 4}).cells.size(), 64u * 27);
  EXPECT_EQ(mesh::refined_towards(whole, {0, 1, 2, 3, 4, 5}).cells.size(), 64u * 27);
  const unsigned int n_fine = 10;
  const H::Piece     two    = mesh::refined_towards(H::lattice(n_fine), {0, 4});
  H::expect_conforming(two);
  EXPECT_GT(H::shapes_and_volume(two).first, 0.05);
  const auto volumes = H::shapes(two).second;
  EXPECT_EQ(std::count_if(volumes.begin(), volumes.end(), [](const double volume) { return volume > 0.9; }),
            8 * 8 * 10);
  H::Piece three = mesh::refined_towards(mesh::refined_towards(one, {4}), {4});
  H::expect_conforming(three);
  EXPECT_NEAR(H::shapes_and_volume(three).second, H::shapes_and_volume(whole).second, 1e-11);
  std::size_t n = 0;
  for (const auto &face : three.boundary_faces)
    n += face.id == 4;
  EXPECT_EQ(n, 16u * 9 * 9 * 9);
}

// Balls, cylinders and tubes: all vertices and midpoints of the boundary lie on it, and volumes between plane faces
// converge to those of the body.
TEST(HexahedraRefinement, follows_built_in_curves)
{
  using H = Hexahedra;
  for (const auto &[shape, towards, volume] : {std::tuple(scene::Shape::ball, "surface", 4. / 3 * M_PI * 1000),
                                               {scene::Shape::half_ball, "surface", 2. / 3 * M_PI * 1000},
                                               {scene::Shape::cylinder, "side", M_PI * 100 * 8},
                                               {scene::Shape::tube, "inner", M_PI * (100 - 36) * 8}})
    for (auto [levels, before] = std::pair(0u, 0.); levels < 3; ++levels)
      {
        const auto body = H::refined_shape(shape, towards, levels);
        H::expect_conforming(body.piece);
        const bool         is_ball = shape == scene::Shape::ball || shape == scene::Shape::half_ball;
        const double       radius  = shape == scene::Shape::tube ? 6 : 10;
        const unsigned int id      = body.boundary_ids.at(towards);
        const auto         off     = [&](const H::Point &x) {
          return std::abs((is_ball ? x.norm() : std::hypot(x[0], x[1])) - radius);
        };
        std::set<unsigned int> on_curve;
        for (const auto &face : body.piece.boundary_faces)
          if (face.id == id)
            for (const unsigned int v : face.vertices)
              {
                on_curve.insert(v);
                EXPECT_LT(off(body.piece.vertices[v]), 1e-12);
              }
        for (const auto &[line, middle] : body.piece.line_middles)
          EXPECT_TRUE(on_curve.count(line[0]) == 0 || on_curve.count(line[1]) == 0 || off(middle) < 1e-12);
        auto piece = body.piece;
        EXPECT_EQ(mesh::keep_good_middles(piece), 0u);
        const auto [worst, straight] = H::shapes_and_volume(piece);
        EXPECT_GT(worst, 0.05) << towards << levels;
        if (levels > 0 && shape != scene::Shape::tube) // its other side stays coarse
          {
            EXPECT_LT(volume - straight, (volume - before) / 6) << towards << levels;
          }
        before = straight;
      }
}
