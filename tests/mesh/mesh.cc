#include "piece.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/mesh/metis_parts.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  struct Sizes
  {
    double                         area = 0;
    std::map<unsigned int, double> length; // by boundary id
    std::set<mesh::GlobalVertex>   vertices;
    unsigned int                   n_cells = 0;

    void add(const mesh::SubdomainMesh<2> &mesh)
    {
      for (const auto &cell : mesh.triangulation.active_cell_iterators())
        {
          area += cell->measure();
          ++n_cells;
          for (const auto &face : cell->face_iterators())
            if (face->at_boundary())
              length[face->boundary_id()] += face->measure();
        }
      vertices.insert(mesh.global_vertices.begin(), mesh.global_vertices.end());
    }
  };

  /// Sizes of a body over all ranks.
  Sizes sizes_of(const mesh::Mesh<2> &mesh, const unsigned int body)
  {
    Sizes own;
    for (const auto &subdomain : mesh.subdomains)
      if (subdomain->body == body)
        own.add(*subdomain);
    Sizes sum;
    sum.area    = dealii::Utilities::MPI::sum(own.area, MPI_COMM_WORLD);
    sum.n_cells = dealii::Utilities::MPI::sum(own.n_cells, MPI_COMM_WORLD);
    for (const auto id : {0u, 1u, 2u, 3u, unsigned(mesh::cut_id)})
      sum.length[id] = dealii::Utilities::MPI::sum(own.length[id], MPI_COMM_WORLD);
    const auto all =
      gathered(std::vector<mesh::GlobalVertex>(own.vertices.begin(), own.vertices.end()), MPI_COMM_WORLD);
    sum.vertices.insert(all.begin(), all.end());
    return sum;
  }

  /// Number of parts that are connected through faces.
  unsigned int n_face_connected_parts(const dealii::Triangulation<2> &triangulation)
  {
    std::vector<bool> seen(triangulation.n_active_cells(), false);
    unsigned int      n = 0;
    for (const auto &start : triangulation.active_cell_iterators())
      {
        if (seen[start->active_cell_index()])
          continue;
        ++n;
        std::vector<dealii::Triangulation<2>::active_cell_iterator> stack = {start};
        seen[start->active_cell_index()]                                  = true;
        while (!stack.empty())
          {
            const auto cell = stack.back();
            stack.pop_back();
            for (const unsigned int f : cell->face_indices())
              if (!cell->at_boundary(f) && !seen[cell->neighbor(f)->active_cell_index()])
                {
                  seen[cell->neighbor(f)->active_cell_index()] = true;
                  stack.push_back(cell->neighbor(f));
                }
          }
      }
    return n;
  }

  Scene rectangle_and_square()
  {
    Scene scene;
    add_body(scene, "rectangle", {-3, 2}, {30, 5}, {{12, 6}});
    add_body(scene, "square", {100, 100}, {6, 6}, {{6, 12}});
    return scene;
  }

  const std::vector<Cut> cuts =
    {whole(), blocks(2), blocks(3), blocks(6), metis(1), metis(2), metis(5), metis(17), metis(72), metis(144)};
} // namespace

TEST(Mesh, subdomains_cover_the_bodies)
{
  for (const Cut &how : cuts)
    {
      const auto mesh = mesh::make_mesh(cut(rectangle_and_square(), how), MPI_COMM_WORLD);
      EXPECT_NEAR(sizes_of(mesh, 0).area, 150, 1e-11);
      EXPECT_NEAR(sizes_of(mesh, 1).area, 36, 1e-11);
      EXPECT_EQ(sizes_of(mesh, 0).n_cells + sizes_of(mesh, 1).n_cells, mesh.n_cells);
    }
}

TEST(Mesh, named_boundaries_keep_their_lengths)
{
  for (const Cut &how : cuts)
    {
      const auto  mesh      = mesh::make_mesh(cut(rectangle_and_square(), how), MPI_COMM_WORLD);
      const Sizes rectangle = sizes_of(mesh, 0), square = sizes_of(mesh, 1);
      for (const std::string name : {"left", "right", "bottom", "top"})
        {
          EXPECT_NEAR(rectangle.length.at(mesh.boundary_ids[0].at(name)),
                      name == "left" || name == "right" ? 5 : 30,
                      1e-11)
            << name;
          EXPECT_NEAR(square.length.at(mesh.boundary_ids[1].at(name)), 6, 1e-11) << name;
        }
    }
}

TEST(Mesh, named_boundaries_are_where_they_belong)
{
  for (const Cut &how : cuts)
    {
      const Scene scene = cut(rectangle_and_square(), how);
      const auto  mesh  = mesh::make_mesh(scene, MPI_COMM_WORLD);
      for (const auto &subdomain : mesh.subdomains)
        for (const auto &cell : subdomain->triangulation.active_cell_iterators())
          for (const auto &face : cell->face_iterators())
            for (const auto &[name, id] : mesh.boundary_ids[subdomain->body])
              if (face->at_boundary())
                {
                  EXPECT_EQ(face->boundary_id() == id, lies_on(scene.bodies[subdomain->body], name, face->center()));
                }
    }
}

TEST(Mesh, global_vertices_are_those_of_the_untorn_bodies)
{
  for (const Cut &how : cuts)
    {
      const auto mesh = mesh::make_mesh(cut(rectangle_and_square(), how), MPI_COMM_WORLD);
      const auto a = sizes_of(mesh, 0).vertices, b = sizes_of(mesh, 1).vertices;
      EXPECT_EQ(a.size(), 13u * 7);
      EXPECT_EQ(b.size(), 7u * 13);
      EXPECT_LT(*a.rbegin(), *b.begin());
    }
}

TEST(Mesh, global_vertex_means_one_place)
{
  for (const Cut &how : cuts)
    {
      const auto                         mesh = mesh::make_mesh(cut(rectangle_and_square(), how), MPI_COMM_WORLD);
      std::vector<std::array<double, 3>> own;
      for (const auto &subdomain : mesh.subdomains)
        for (unsigned int v = 0; v < subdomain->global_vertices.size(); ++v)
          {
            const auto &x = subdomain->triangulation.get_vertices()[v];
            own.push_back({{double(subdomain->global_vertices[v]), x[0], x[1]}});
          }
      std::map<double, std::set<std::array<double, 2>>> places;
      std::set<std::array<double, 2>>                   all;
      for (const auto &[vertex, x, y] : gathered(own, MPI_COMM_WORLD))
        {
          places[vertex].insert(std::array<double, 2>{{x, y}});
          all.insert(std::array<double, 2>{{x, y}});
        }
      for (const auto &[vertex, at] : places)
        EXPECT_EQ(at.size(), 1u) << vertex; // bitwise equal
      EXPECT_EQ(all.size(), places.size());
    }
}

TEST(Mesh, subdomains_hang_together_through_faces)
{
  for (const Cut &how : cuts)
    for (const auto &subdomain : mesh::make_mesh(cut(rectangle_and_square(), how), MPI_COMM_WORLD).subdomains)
      {
        EXPECT_GT(subdomain->triangulation.n_active_cells(), 0u);
        EXPECT_EQ(n_face_connected_parts(subdomain->triangulation), 1u);
      }
}

TEST(Mesh, every_rank_holds_its_own_subdomains_only)
{
  for (const Cut &how : cuts)
    {
      const auto                mesh = mesh::make_mesh(cut(rectangle_and_square(), how), MPI_COMM_WORLD);
      const unsigned int        rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      std::vector<unsigned int> own, expect;
      for (unsigned int s = 0; s < mesh.n_subdomains(); ++s)
        if (mesh.rank_of_subdomain(s) == rank)
          expect.push_back(s);
      for (const auto &subdomain : mesh.subdomains)
        own.push_back(subdomain->subdomain);
      EXPECT_EQ(own, expect);
      EXPECT_EQ(gathered(own, MPI_COMM_WORLD).size(), mesh.n_subdomains());
    }
}

TEST(Mesh, ranks_share_subdomains_evenly)
{
  const auto         mesh    = mesh::make_mesh(cut(rectangle_and_square(), blocks(3)), MPI_COMM_WORLD);
  const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  EXPECT_GE(mesh.subdomains.size(), 18 / n_ranks);
  EXPECT_LE(mesh.subdomains.size(), 18 / n_ranks + 1);
}

TEST(Mesh, blocks_are_as_many_as_asked_for)
{
  EXPECT_EQ(mesh::make_mesh(cut(rectangle_and_square(), blocks(3)), MPI_COMM_WORLD).n_subdomains(), 18u);
  EXPECT_EQ(mesh::make_mesh(cut(rectangle_and_square(), whole()), MPI_COMM_WORLD).n_subdomains(), 2u);
}

TEST(Mesh, metis_makes_about_as_many_as_asked_for_and_says_so_otherwise)
{
  for (const unsigned int n : {2, 5, 17, 72, 144})
    {
      const auto mesh = mesh::make_mesh(cut(rectangle_and_square(), metis(n)), MPI_COMM_WORLD);
      EXPECT_GE(mesh.n_subdomains(), n / 2);
      EXPECT_LE(mesh.n_subdomains(), n + n / 4 + 1);
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0 && n % 2 == 0)
        {
          EXPECT_EQ(mesh.remarks.empty(), mesh.n_subdomains() == n);
        }
    }
}

TEST(Mesh, number_of_subdomains_does_not_depend_on_the_ranks)
{
  for (const Cut &how : cuts)
    EXPECT_EQ(mesh::make_mesh(cut(rectangle_and_square(), how), MPI_COMM_WORLD).n_subdomains(),
              mesh::make_mesh(cut(rectangle_and_square(), how), MPI_COMM_SELF).n_subdomains());
}

TEST(Mesh, refinements_halve_the_cells)
{
  for (const Cut &how : {whole(), blocks(3), metis(5)})
    {
      Scene scene                      = cut(rectangle_and_square(), how);
      scene.discretization.refinements = 2;
      const auto mesh                  = mesh::make_mesh(scene, MPI_COMM_WORLD);
      EXPECT_EQ(mesh.n_cells, 2u * 72 * 16);
      EXPECT_EQ(sizes_of(mesh, 0).vertices.size(), 49u * 25);
    }
}

TEST(Mesh, more_subdomains_than_cells_are_refused_on_all_ranks)
{
  const std::string text =
    message_on_all_ranks<InputError>([] { mesh::make_mesh(cut(rectangle_and_square(), metis(145)), MPI_COMM_WORLD); });
  EXPECT_NE(text.find("145"), std::string::npos) << text;
  EXPECT_NE(text.find("144 cells"), std::string::npos) << text;
}

// cutting a piece

TEST(Cut, disconnected_part_falls_apart)
{
  const auto pieces = mesh::cut(unit_cells(3, 1), {0, 1, 0});
  ASSERT_EQ(pieces.size(), 3u);
  for (const auto &piece : pieces)
    EXPECT_EQ(piece.cells.size(), 1u);
}

TEST(Cut, part_hinged_at_a_vertex_falls_apart)
{
  // 0 1
  // 1 0
  EXPECT_EQ(mesh::cut(unit_cells(2, 2), {1, 0, 0, 1}).size(), 4u);
}

TEST(Cut, ring_stays_in_one_piece)
{
  const auto pieces = mesh::cut(unit_cells(3, 3), {0, 0, 0, 0, 1, 0, 0, 0, 0});
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].cells.size(), 8u);
  EXPECT_EQ(pieces[0].vertices.size(), 16u);
  EXPECT_EQ(n_face_connected_parts(mesh::triangulate(pieces[0])->triangulation), 1u);
}

TEST(Cut, ring_that_closes_at_a_vertex_is_one_piece_with_the_stiffness_of_one)
{
  // a part that touches itself at a vertex, connected through faces elsewhere: the vertex has one node
  const Scene                scene  = box(1);
  const auto                 pieces = mesh::cut(unit_cells(3, 3), {0, 0, 0, 0, 1, 0, 0, 0, 1});
  const mesh::Mesh<2>        mesh   = mesh_of(pieces[0]);
  const mechanics::Spaces<2> spaces(mesh, 1);
  const auto                 eigenvalues =
    tfeti::symmetric_eigenvalues(full(mechanics::assemble(scene, mesh, spaces, 1.)[0].stiffness));
  EXPECT_EQ((eigenvalues.array() < 1e-10 * eigenvalues.maxCoeff()).count(), 3);
}

TEST(Cut, empty_parts_are_left_out)
{
  EXPECT_EQ(mesh::cut(unit_cells(2, 1), {7, 3}).size(), 2u);
}

TEST(Cut, pieces_come_in_order_of_part_and_first_cell)
{
  const auto pieces = mesh::cut(unit_cells(5, 1), {1, 0, 1, 0, 0});
  ASSERT_EQ(pieces.size(), 4u);
  const std::vector<double> left = {1, 3, 0, 2};
  for (unsigned int k = 0; k < 4; ++k)
    EXPECT_EQ(pieces[k].vertices[pieces[k].cells[0][0]][0], left[k]);
}

TEST(Cut, boundary_ids_are_kept_and_the_rest_is_cut)
{
  const auto pieces = mesh::cut(unit_cells(4, 3), {0, 0, 1, 1, 0, 2, 2, 1, 0, 0, 1, 1});
  Sizes      sum;
  for (const auto &piece : pieces)
    sum.add(*mesh::triangulate(piece));
  EXPECT_NEAR(sum.length[0], 3, 1e-14);
  EXPECT_NEAR(sum.length[1], 3, 1e-14);
  EXPECT_NEAR(sum.length[2], 4, 1e-14);
  EXPECT_NEAR(sum.length[3], 4, 1e-14);
  // faces between parts, from both sides: part 2 has six, parts 0 and 1 meet in two
  EXPECT_NEAR(sum.length[mesh::cut_id], 2 * (6 + 2), 1e-14);
  EXPECT_EQ(sum.vertices.size(), 20u);
}

TEST(Cut, metis_gives_a_part_to_every_cell)
{
  const auto piece = unit_cells(9, 7);
  for (const unsigned int n : {1, 2, 5, 20, 63})
    {
      const auto part = mesh::metis_parts(piece, n);
      ASSERT_EQ(part.size(), 63u);
      EXPECT_LT(*std::max_element(part.begin(), part.end()), n);
      std::size_t n_cells = 0;
      for (const auto &one : mesh::cut(piece, part))
        {
          EXPECT_GT(one.cells.size(), 0u);
          n_cells += one.cells.size();
        }
      EXPECT_EQ(n_cells, 63u);
    }
}

namespace
{
  /// Largest ratio of the edges of the bounding boxes of the parts of a piece, mean over some seeds.
  template <int dim>
  double most_slender(const mesh::MeshPiece<dim> &piece, const unsigned int n)
  {
    double             sum     = 0;
    const unsigned int n_seeds = 8;
    for (unsigned int seed = 0; seed < n_seeds; ++seed)
      {
        double worst = 1;
        for (const auto &part : mesh::cut(piece, mesh::metis_parts(piece, n, seed)))
          {
            const dealii::BoundingBox<dim> box(part.vertices);
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int e = 0; e < dim; ++e)
                worst = std::max(worst, box.side_length(d) / box.side_length(e));
          }
        sum += worst / n_seeds;
      }
    return sum;
  }
} // namespace

// Counted by the number of faces, a cut across the bar is as large as one along the lattice, which is longer by the
// square root of 2.
TEST(Cut, interfaces_of_solids_count_by_their_area)
{
  scene::Body<3> body;
  body.size  = {24, 24, 3};
  auto piece = mesh::rectangle_piece<3>(body, {{24, 24, 3}}, {{1, 1, 1}}, {{0, 0, 0}});
  auto along = [&](const unsigned int v) { return piece.vertices[v][0] + piece.vertices[v][1]; };
  auto cells = std::move(piece.cells);
  piece.cells.clear();
  piece.boundary_faces.clear();
  for (const auto &cell : cells) // a bar along the diagonal
    if (const auto &x = piece.vertices[cell[0]]; std::abs(x[0] - x[1]) < 4.5)
      piece.cells.push_back(cell);
  for (const unsigned int seed : {1, 2, 3, 4})
    {
      const auto            part = mesh::metis_parts(piece, 2, seed);
      std::array<double, 2> low{{100, 100}}, high{{0, 0}};
      for (unsigned int c = 0; c < part.size(); ++c)
        {
          low[part[c]]  = std::min(low[part[c]], along(piece.cells[c][0]));
          high[part[c]] = std::max(high[part[c]], along(piece.cells[c][0]));
        }
      EXPECT_LT(std::min(high[0], high[1]) - std::max(low[0], low[1]), 5) << seed;
    }
}

TEST(Cut, flat_cells_make_no_flat_parts)
{
  auto plate = unit_cells(64, 64); // 64 x 4: cells 16 times as long as high
  for (auto &vertex : plate.vertices)
    vertex[1] /= 16;
  const double of_plate = most_slender(plate, 16);

  scene::Body<3> body;
  body.size  = {8, 8, 8};
  auto block = mesh::rectangle_piece<3>(body, {{8, 8, 8}}, {{1, 1, 1}}, {{0, 0, 0}});
  for (auto &vertex : block.vertices)
    vertex[2] /= 8;
  const double of_hexahedra  = most_slender(block, 16);
  const double of_tetrahedra = most_slender(mesh::in_tetrahedra(block, block.vertices), 16);

  // 26, 14 and 14 if all faces have the same weight
  EXPECT_LT(of_plate, 8);
  EXPECT_LT(of_hexahedra, 4);
  EXPECT_LT(of_tetrahedra, 8);
}
