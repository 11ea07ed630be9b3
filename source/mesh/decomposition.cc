#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/mesh/make_body.h>
#include <slipstick/mesh/metis_parts.h>
#include <slipstick/mesh/shapes.h>
#include <slipstick/mesh/size_check.h>
#include <slipstick/mesh/triangulate.h>
#include <slipstick/scene/boundary_part.h>

#include <deal.II/base/mpi.h>

#include <deal.II/grid/grid_tools.h>

#include <boost/serialization/set.hpp>
#include <boost/serialization/string.hpp>

#include <cmath>
#include <numeric>
#include <queue>

namespace slipstick::mesh
{
  namespace
  {
    // Cells (times the square of the degree) per METIS subdomain if their number is `auto`: benchmarks/README.md, "How
    // many subdomains?".
    constexpr double automatic_cells_per_subdomain = 10000;

    // The same in space: a cube with 10 cells per edge (time of factors and coarse problem).
    constexpr double automatic_cells_per_subdomain_in_space = 1000;

    // If the number of subdomains is `auto`, bodies that only contact holds in some direction are cut so that subdomains
    // are about this many times as long as thick (doc/decisions/0133), in space also not shorter than this many times
    // their width (0171), if their own length is above the last number of thicknesses.
    constexpr double automatic_slenderness = 3, automatic_slenderness_in_space = 6, automatic_length_over_width = 2,
                     least_slenderness = 16;

    // Limits for two bodies that probably have different units (m and mm: 1e3 in size, Pa and MPa: 1e6 in modulus):
    // ratio of the larger to the smaller size or modulus. Parts of one assembly differ less in size; steel and rubber
    // differ by 1e5 in modulus. The lower limits must be exceeded together, by a smaller body that is also the stiffer
    // one, as with metres and pascal beside mm and MPa.
    constexpr double doubtful_size_ratio    = 300;
    constexpr double doubtful_modulus_ratio = 3e5;
    constexpr double doubtful_together_size = 30, doubtful_together_modulus = 3e4;

    template <int dim>
    std::uint64_t product(const std::array<unsigned int, dim> &n)
    {
      return std::accumulate(n.begin(), n.end(), std::uint64_t(1), std::multiplies<>());
    }

    /// Equal shares of the subdomains, in order: rank r has [first[r], first[r+1]).
    std::vector<unsigned int> equal_shares(const unsigned int n, const unsigned int n_ranks)
    {
      std::vector<unsigned int> first(n_ranks + 1);
      for (unsigned int r = 0; r <= n_ranks; ++r)
        first[r] = static_cast<std::uint64_t>(n) * r / n_ranks;
      return first;
    }

    /// Number of nodes per cell relative to a quadrilateral or hexahedron.
    template <int dim>
    double cost_of(const MeshPiece<dim> &piece)
    {
      return piece.cells.size() * (is_simplex<dim>(piece.cells[0]) ? (dim == 2 ? .5 : 1. / 6) : 1.);
    }

    /// Length of an edge, area of a facet.
    double measure_of(const MeshPiece<2> &piece, const MeshPiece<2>::Face &face)
    {
      return piece.vertices[face[0]].distance(piece.vertices[face[1]]);
    }

    double measure_of(const MeshPiece<3> &piece, const MeshPiece<3>::Face &face)
    {
      const auto triangle = [&](const unsigned int a, const unsigned int b, const unsigned int c) {
        const auto &x = piece.vertices;
        return cross_product_3d(x[b] - x[a], x[c] - x[a]).norm() / 2;
      };
      return triangle(face[0], face[1], face[2]) +
             (face[3] == MeshPiece<3>::no_vertex ? 0. : triangle(face[1], face[3], face[2]));
    }

    /// Sum over the boundary, and over the cells.
    template <int dim>
    std::pair<double, double> boundary_and_content(const MeshPiece<dim> &piece)
    {
      double boundary = 0, content = 0;
      for (const auto &face : piece.boundary_faces)
        boundary += measure_of(piece, face.vertices);
      for (const auto &cell : piece.cells)
        content += std::abs(dealii::GridTools::cell_measure<dim>(piece.vertices, {cell.data(), n_corners<dim>(cell)}));
      return {boundary, content};
    }

    /// Number of subdomains that a piece should have because it is slender. Its length over its thickness follows from
    /// its outline and its area; 4 for a square.
    double slender_parts(const MeshPiece<2> &piece)
    {
      const auto [outline, area] = boundary_and_content(piece);
      const double slenderness   = outline * outline / (4 * area);
      return slenderness > least_slenderness ? std::ceil(slenderness / automatic_slenderness) : 1;
    }

    /// The same in space, where the length is the diameter, the thickness that of a plate or half of that of a rod (5 for
    /// a cube), and the width is half of the surface over the length.
    double slender_parts(const MeshPiece<3> &piece)
    {
      const auto farthest_from = [&piece](const dealii::Point<3> &x) {
        return *std::max_element(piece.vertices.begin(), piece.vertices.end(), [&x](const auto &a, const auto &b) {
          return x.distance_square(a) < x.distance_square(b);
        });
      };
      const auto end               = farthest_from(piece.vertices[0]);
      const auto [surface, volume] = boundary_and_content(piece);
      const double length          = end.distance(farthest_from(end));
      const double slenderness = length * surface / (2 * volume), length_over_width = 2 * length * length / surface;
      if (slenderness <= least_slenderness)
        return 1;
      return std::ceil(
        std::min(slenderness / automatic_slenderness_in_space, length_over_width / automatic_length_over_width));
    }

    /// By body: whether only contact that may open or slip holds it in some direction.
    template <int dim>
    std::vector<bool> held_by_contact(const scene::Scene<dim> &scene)
    {
      std::array<bool, dim> by_nature{}; // bodies of revolution do not move away from their axis
      by_nature[0] = scene.plane_state == scene::PlaneState::axisymmetric;
      std::vector<std::array<bool, dim>> held(scene.bodies.size(), by_nature);
      std::vector<unsigned int>          n_normals(scene.bodies.size(), 0);
      for (const auto &support : scene.supports)
        {
          const unsigned int body = support.point ? support.point->body : support.where.body;
          for (unsigned int d = 0; d < dim; ++d)
            held[body][d] |= bool(support.components[d]);
          n_normals[body] += bool(support.normal);
        }
      std::vector<bool> loose;
      for (unsigned int b = 0; b < held.size(); ++b)
        loose.push_back(std::count(held[b].begin(), held[b].end(), true) + n_normals[b] < dim);
      for (const auto &foundation : scene.foundations)
        loose[foundation.where.body] = false;
      for (const auto &pair : scene.contacts)
        if (pair.law.is_bonded)
          {
            loose[pair.slave.body] = false;
            if (pair.master)
              loose[pair.master->body] = false;
          }
      return loose;
    }

    /// Whether every rank can generate its own blocks.
    template <int dim>
    bool has_blocks(const scene::Scene<dim> &scene)
    {
      using scene::DecompositionMethod;
      for (const auto &body : scene.bodies)
        if (body.shape != scene::Shape::rectangle ||
            (body.boundary_refinements > 0 && !body.refined_boundaries.empty()))
          return false;
      return !scene::has_boundary_parts(scene) && (scene.decomposition.method == DecompositionMethod::blocks ||
                                                   scene.decomposition.method == DecompositionMethod::none);
    }

    /// Adds a warning about the two bodies that exceed the limits most, if there are any.
    template <int dim>
    void remark_on_units(const scene::Scene<dim> &scene, Mesh<dim> &mesh)
    {
      const auto &size    = mesh.sizes;
      const auto  modulus = [&](const unsigned int body) { // materials may not be defined yet when meshes are made
        const unsigned int material = scene.bodies[body].material;
        return material < scene.materials.size() ? scene.materials[material].young_modulus
                                                  : scene::Material().young_modulus;
      };
      double       worst = 1; // relative to its limit
      unsigned int small = 0, large = 0;
      for (unsigned int a = 0; a < size.size(); ++a)
        for (unsigned int b = 0; b < size.size(); ++b)
          {
            const double sizes = size[b] / size[a], moduli = modulus(a) / modulus(b);
            const double over =
              std::max({sizes / doubtful_size_ratio,
                        moduli / doubtful_modulus_ratio,
                        std::min(sizes / doubtful_together_size, moduli / doubtful_together_modulus)});
            if (over > worst)
              {
                worst = over;
                small = a;
                large = b;
              }
          }
      if (worst == 1)
        return;
      const auto describe = [&](const unsigned int b) {
        return "body " + scene.bodies[b].name + " is " + number_text(size[b]) + " mm across with a Young modulus of " +
               number_text(modulus(b)) + " MPa";
      };
      mesh.remarks.emplace_back(describe(large) + ", " + describe(small) +
                                  ": check that their meshes and materials use the same units (Scale, Young modulus)",
                                true);
    }

    /// Every rank generates its own blocks.
    template <int dim>
    void make_blocks(const scene::Scene<dim> &scene, Mesh<dim> &mesh)
    {
      std::vector<GlobalVertex> first_vertex(1, 0);
      for (const auto &body : scene.bodies)
        {
          const auto n          = rectangle_cells(scene, body);
          auto       n_vertices = n;
          for (unsigned int &k : n_vertices)
            ++k;
          mesh.n_cells += product<dim>(n);
          first_vertex.push_back(first_vertex.back() + product<dim>(n_vertices));
          mesh.boundary_ids.push_back(shape_boundary_ids(body.shape, dim));
        }
      mesh.combined_ids.resize(scene.bodies.size());
      mesh.points.resize(scene.bodies.size());
      for (const auto &body : scene.bodies)
        mesh.sizes.push_back(body.size.norm());
      remark_on_units(scene, mesh);

      const unsigned int N =
        scene.decomposition.method == scene::DecompositionMethod::none ? 1 : scene.decomposition.blocks;
      const unsigned int            rank = dealii::Utilities::MPI::this_mpi_process(mesh.comm);
      std::array<unsigned int, dim> n_blocks;
      n_blocks.fill(N);
      const unsigned int per_body = product<dim>(n_blocks);
      mesh.first_subdomain        = equal_shares(per_body * scene.bodies.size(), mesh.first_subdomain.size() - 1);
      collectively(mesh.comm, [&] {
        for (unsigned int s = mesh.first_subdomain[rank]; s < mesh.first_subdomain[rank + 1]; ++s)
          {
            const unsigned int            body = s / per_body;
            std::array<unsigned int, dim> block;
            for (unsigned int d = 0, b = s % per_body; d < dim; ++d, b /= N)
              block[d] = b % N;
            auto piece =
              rectangle_piece<dim>(scene.bodies[body], rectangle_cells(scene, scene.bodies[body]), n_blocks, block);
            place_in_scene(scene, body, piece);
            piece.subdomain = s;
            piece.body      = body;
            for (GlobalVertex &v : piece.global_vertices)
              v += first_vertex[body];
            mesh.subdomains.push_back(triangulate(piece));
          }
      });
    }

    /// The meshes of all bodies with consecutive global vertices; on rank 0.
    template <int dim>
    std::vector<BodyMesh<dim>> make_bodies(const scene::Scene<dim> &scene, Refinement *refinement)
    {
      if (refinement)
        {
          refinement->refined.resize(scene.bodies.size());
          refinement->cells.clear();
        }
      std::vector<BodyMesh<dim>>      bodies;
      std::map<std::string, MeshFile> files;
      GlobalVertex                    first = 0;
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        {
          std::vector<CellPath> paths;
          bodies.push_back(make_body(scene, b, files, refinement ? &refinement->refined[b] : nullptr, &paths));
          const auto &piece = bodies.back().piece;
          for (GlobalVertex &v : bodies.back().piece.global_vertices)
            v += first;
          for (unsigned int c = 0; c < paths.size(); ++c)
            {
              std::vector<GlobalVertex> vertices;
              for (unsigned int k = 0; k < n_corners<dim>(piece.cells[c]); ++k)
                vertices.push_back(piece.global_vertices[piece.cells[c][k]]);
              refinement->cells[cell_key(std::move(vertices))] = {b, std::move(paths[c])};
            }
          first += bodies.back().piece.vertices.size();
        }
      for (auto &remark : unused_parts(scene, files))
        bodies.back().remarks.push_back(std::move(remark));
      return bodies;
    }

    template <int dim>
    double size_of(const MeshPiece<dim> &piece)
    {
      dealii::Point<dim> low = piece.vertices[0], high = low;
      for (const auto &x : piece.vertices)
        for (unsigned int d = 0; d < dim; ++d)
          {
            low[d]  = std::min(low[d], x[d]);
            high[d] = std::max(high[d], x[d]);
          }
      return low.distance(high);
    }

    /// Distributes subdomains among pieces of the given costs and cells: one each, then the next one always to the
    /// piece with the largest cost per subdomain.
    std::vector<unsigned int> shares_of_pieces(const std::vector<double>      &cost,
                                               const std::vector<std::size_t> &n_cells,
                                               const unsigned int              wanted)
    {
      std::vector<unsigned int>                            shares(cost.size(), 1);
      std::priority_queue<std::pair<double, unsigned int>> next; // the largest; for equal costs the last piece
      for (unsigned int k = 0; k < cost.size(); ++k)
        next.emplace(cost[k], k);
      for (unsigned int n = cost.size(); n < wanted && !next.empty();)
        {
          const unsigned int k = next.top().second;
          next.pop();
          if (shares[k] >= n_cells[k])
            continue;
          ++n;
          next.emplace(cost[k] / ++shares[k], k);
        }
      return shares;
    }

    /// Cuts the bodies, pieces in order of the bodies.
    template <int dim>
    std::vector<MeshPiece<dim>> cut_bodies(const scene::Scene<dim>    &scene,
                                           std::vector<BodyMesh<dim>> &bodies,
                                           std::vector<Remark>        &remarks)
    {
      // connected pieces with one type of cells: the minimum number of subdomains
      std::vector<MeshPiece<dim>> wholes;
      for (auto &body : bodies)
        {
          std::vector<unsigned int> kind;
          for (const auto &cell : body.piece.cells)
            kind.push_back(is_simplex<dim>(cell));
          auto pieces = cut(body.piece, kind);
          body.piece  = MeshPiece<dim>();
          std::move(pieces.begin(), pieces.end(), std::back_inserter(wholes));
        }
      std::vector<double>      cost;
      std::vector<std::size_t> n_cells;
      for (const auto &whole : wholes)
        {
          cost.push_back(cost_of(whole));
          n_cells.push_back(whole.cells.size());
        }
      const bool         one_each          = scene.decomposition.method == scene::DecompositionMethod::none;
      const unsigned int asked             = one_each ? scene.bodies.size() : scene.decomposition.subdomains;
      const double       total             = std::accumulate(cost.begin(), cost.end(), 0.);
      const double       unknowns_per_node = std::pow(scene.discretization.degree, dim);
      const double       cells_per_subdomain =
        dim == 3 ? automatic_cells_per_subdomain_in_space : automatic_cells_per_subdomain;
      const unsigned int wanted =
        asked > 0 ? asked : std::max(1., std::round(total * unknowns_per_node / cells_per_subdomain));
      if (asked > 0 && asked < wholes.size())
        remarks.push_back(std::to_string(wholes.size()) + " subdomains instead of " + std::to_string(asked) +
                          ": at least one for each body and cell type");
      auto shares = shares_of_pieces(cost, n_cells, wanted);
      if (asked == 0)
        {
          const auto loose = held_by_contact(scene);
          for (unsigned int k = 0; k < wholes.size(); ++k)
            if (loose[wholes[k].body])
              shares[k] = std::max<double>(shares[k], std::min<double>(slender_parts(wholes[k]), n_cells[k]));
        }

      std::vector<MeshPiece<dim>>                                   pieces;
      std::map<unsigned int, std::pair<unsigned int, unsigned int>> made; // by body: requested, obtained
      for (unsigned int k = 0; k < wholes.size(); ++k)
        {
          auto parts = cut(wholes[k], metis_parts(wholes[k], shares[k], scene.decomposition.seed));
          made[wholes[k].body].first += shares[k];
          made[wholes[k].body].second += parts.size();
          wholes[k] = MeshPiece<dim>();
          std::move(parts.begin(), parts.end(), std::back_inserter(pieces));
        }
      for (const auto &[body, n] : made)
        if (n.first != n.second)
          remarks.push_back("body " + scene.bodies[body].name + ": METIS made " + std::to_string(n.second) +
                            " face-connected subdomains of the " + std::to_string(n.first) + " asked for");
      for (unsigned int s = 0; s < pieces.size(); ++s)
        pieces[s].subdomain = s;
      return pieces;
    }

    /// Data of a body needed on all ranks, besides the subdomains.
    template <int dim>
    struct Names
    {
      std::map<std::string, dealii::types::boundary_id>                          boundary_ids;
      std::map<dealii::types::boundary_id, std::set<dealii::types::boundary_id>> combined_ids;
      std::map<std::string, NamedPoint<dim>>                                     points;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &boundary_ids &combined_ids &points;
      }
    };

    /// Rank 0 generates and cuts the bodies and sends every rank its subdomains.
    template <int dim>
    void make_on_one_rank(const scene::Scene<dim> &scene, Mesh<dim> &mesh, Refinement *refinement)
    {
      const unsigned int          n_ranks = mesh.first_subdomain.size() - 1;
      const bool                  is_root = dealii::Utilities::MPI::this_mpi_process(mesh.comm) == 0;
      std::vector<MeshPiece<dim>> pieces;
      std::vector<Names<dim>>     names;
      collectively(mesh.comm, [&] {
        if (!is_root)
          return;
        auto bodies = make_bodies(scene, refinement);
        for (const auto &body : bodies)
          {
            mesh.n_cells += body.piece.cells.size();
            mesh.remarks.insert(mesh.remarks.end(), body.remarks.begin(), body.remarks.end());
            names.push_back({body.boundary_ids, body.combined_ids, {}});
            for (const auto &[name, v] : body.points)
              names.back().points[name] = {body.piece.vertices[v], body.piece.global_vertices[v]};
          }
        for (const auto &body : bodies)
          mesh.sizes.push_back(size_of(body.piece));
        remark_on_units(scene, mesh);
        if (scene.decomposition.subdomains > mesh.n_cells &&
            scene.decomposition.method != scene::DecompositionMethod::none)
          throw InputError("Decomposition/Subdomains = " + std::to_string(scene.decomposition.subdomains) +
                             " is more than the " + std::to_string(mesh.n_cells) + " cells of the mesh",
                           "ask for at most one subdomain per cell, or set it to auto");
        pieces = cut_bodies(scene, bodies, mesh.remarks);
      });

      std::map<unsigned int, std::vector<MeshPiece<dim>>> to_send;
      const unsigned int                                  n_pieces =
        dealii::Utilities::MPI::broadcast(mesh.comm, static_cast<unsigned int>(pieces.size()));
      mesh.first_subdomain = equal_shares(n_pieces, n_ranks);
      for (unsigned int r = 0; r < n_ranks && is_root; ++r)
        for (unsigned int s = mesh.first_subdomain[r]; s < mesh.first_subdomain[r + 1]; ++s)
          to_send[r].push_back(std::move(pieces[s]));
      mesh.n_cells  = dealii::Utilities::MPI::broadcast(mesh.comm, mesh.n_cells);
      mesh.sizes    = dealii::Utilities::MPI::broadcast(mesh.comm, mesh.sizes);
      names         = dealii::Utilities::MPI::broadcast(mesh.comm, names);
      auto received = dealii::Utilities::MPI::some_to_some(mesh.comm, to_send);
      to_send.clear();
      for (auto &[rank, of_rank] : received)
        for (auto &piece : of_rank)
          {
            mesh.subdomains.push_back(triangulate(piece));
            piece = MeshPiece<dim>();
          }
      for (auto &of_body : names)
        {
          mesh.boundary_ids.push_back(std::move(of_body.boundary_ids));
          mesh.combined_ids.push_back(std::move(of_body.combined_ids));
          mesh.points.push_back(std::move(of_body.points));
        }
    }
  } // namespace

  template <int dim>
  Mesh<dim> make_mesh(const scene::Scene<dim> &scene, const MPI_Comm comm, Refinement *refinement)
  {
    Mesh<dim> mesh;
    mesh.comm = comm;
    mesh.first_subdomain.resize(dealii::Utilities::MPI::n_mpi_processes(comm) + 1);
    if (!refinement && has_blocks(scene))
      make_blocks(scene, mesh);
    else
      make_on_one_rank(scene, mesh, refinement);
    check_positions(scene, mesh);
    return mesh;
  }

  template Mesh<2> make_mesh(const scene::Scene<2> &, const MPI_Comm, Refinement *);
  template Mesh<3> make_mesh(const scene::Scene<3> &, const MPI_Comm, Refinement *);
} // namespace slipstick::mesh
