#include <slipstick/base/exceptions.h>
#include <slipstick/fem/decomposition.h>
#include <slipstick/fem/mesh_piece.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <numeric>

namespace slipstick::fem
{
  namespace
  {
    // Cells of a METIS subdomain when their number is left to us: that of the paper's 50 x 50 blocks.
    constexpr double automatic_cells_per_subdomain = 2500;

    template <int dim>
    std::array<unsigned int, dim> lattice_cells(const scene::Scene<dim> &scene, const scene::Body<dim> &body)
    {
      std::array<unsigned int, dim> n;
      n.fill(scene.decomposition.blocks * scene.decomposition.cells_per_block);
      if (body.cells)
        n = *body.cells;
      for (unsigned int &k : n)
        k <<= scene.discretization.refinements;
      return n;
    }

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

    /// Every rank makes its own blocks.
    template <int dim>
    void make_blocks(const scene::Scene<dim> &scene, const std::vector<GlobalVertex> &first_vertex, Mesh<dim> &mesh)
    {
      const unsigned int N =
        scene.decomposition.method == scene::DecompositionMethod::none ? 1 : scene.decomposition.blocks;
      const unsigned int            rank = dealii::Utilities::MPI::this_mpi_process(mesh.comm);
      std::array<unsigned int, dim> n_blocks;
      n_blocks.fill(N);
      const unsigned int per_body = product<dim>(n_blocks);
      mesh.first_subdomain        = equal_shares(per_body * scene.bodies.size(), mesh.first_subdomain.size() - 1);
      for (unsigned int s = mesh.first_subdomain[rank]; s < mesh.first_subdomain[rank + 1]; ++s)
        {
          const unsigned int body = s / per_body, b = s % per_body;
          auto               piece = rectangle_piece<dim>(scene.bodies[body],
                                            lattice_cells(scene, scene.bodies[body]),
                                            n_blocks,
                                            {{b % N, b / N}});
          piece.subdomain          = s;
          piece.body               = body;
          for (GlobalVertex &v : piece.global_vertices)
            v += first_vertex[body];
          mesh.subdomains.push_back(triangulate(piece));
        }
    }

    /// Subdomains of every body, in proportion to its cells, at least one each.
    std::vector<unsigned int> shares_of_bodies(const std::vector<std::uint64_t> &n_cells, const unsigned int wanted)
    {
      const double total = std::accumulate(n_cells.begin(), n_cells.end(), 0.);
      const double parts = wanted == 0 ? std::max(1., std::round(total / automatic_cells_per_subdomain)) : wanted;
      std::vector<unsigned int> shares;
      for (const std::uint64_t n : n_cells)
        shares.push_back(std::max(1., std::round(parts * n / total)));
      return shares;
    }

    /// Rank 0 meshes and cuts all bodies.
    template <int dim>
    std::vector<MeshPiece<dim>> cut_bodies(const scene::Scene<dim>          &scene,
                                           const std::vector<std::uint64_t> &n_cells,
                                           const std::vector<GlobalVertex>  &first_vertex,
                                           std::vector<std::string>         &remarks)
    {
      const auto                    shares = shares_of_bodies(n_cells, scene.decomposition.subdomains);
      std::array<unsigned int, dim> one, zero;
      one.fill(1);
      zero.fill(0);
      std::vector<MeshPiece<dim>> pieces;
      for (unsigned int body = 0; body < scene.bodies.size(); ++body)
        {
          auto whole = rectangle_piece<dim>(scene.bodies[body], lattice_cells(scene, scene.bodies[body]), one, zero);
          whole.body = body;
          for (GlobalVertex &v : whole.global_vertices)
            v += first_vertex[body];
          auto parts = cut(whole, metis_parts(whole, shares[body]));
          if (parts.size() != shares[body])
            remarks.push_back("body " + scene.bodies[body].name + ": METIS made " + std::to_string(parts.size()) +
                              " face-connected subdomains of the " + std::to_string(shares[body]) + " asked for");
          std::move(parts.begin(), parts.end(), std::back_inserter(pieces));
        }
      for (unsigned int s = 0; s < pieces.size(); ++s)
        pieces[s].subdomain = s;
      return pieces;
    }

    template <int dim>
    void make_metis(const scene::Scene<dim>          &scene,
                    const std::vector<std::uint64_t> &n_cells,
                    const std::vector<GlobalVertex>  &first_vertex,
                    Mesh<dim>                        &mesh)
    {
      const unsigned int                                  n_ranks = mesh.first_subdomain.size() - 1;
      std::map<unsigned int, std::vector<MeshPiece<dim>>> to_send;
      unsigned int                                        n_pieces = 0;
      if (dealii::Utilities::MPI::this_mpi_process(mesh.comm) == 0)
        {
          auto pieces      = cut_bodies(scene, n_cells, first_vertex, mesh.remarks);
          n_pieces         = pieces.size();
          const auto first = equal_shares(n_pieces, n_ranks);
          for (unsigned int r = 0; r < n_ranks; ++r)
            for (unsigned int s = first[r]; s < first[r + 1]; ++s)
              to_send[r].push_back(std::move(pieces[s]));
        }
      mesh.first_subdomain = equal_shares(dealii::Utilities::MPI::broadcast(mesh.comm, n_pieces), n_ranks);
      auto received        = dealii::Utilities::MPI::some_to_some(mesh.comm, to_send);
      to_send.clear();
      for (auto &[rank, pieces] : received)
        for (auto &piece : pieces)
          {
            mesh.subdomains.push_back(triangulate(piece));
            piece = MeshPiece<dim>();
          }
    }
  } // namespace

  template <int dim>
  Mesh<dim> make_mesh(const scene::Scene<dim> &scene, const MPI_Comm comm)
  {
    Mesh<dim> mesh;
    mesh.comm = comm;
    mesh.first_subdomain.resize(dealii::Utilities::MPI::n_mpi_processes(comm) + 1);

    std::vector<std::uint64_t> n_cells;
    std::vector<GlobalVertex>  first_vertex(1, 0);
    for (const auto &body : scene.bodies)
      {
        const auto n          = lattice_cells(scene, body);
        auto       n_vertices = n;
        for (unsigned int &k : n_vertices)
          ++k;
        n_cells.push_back(product<dim>(n));
        first_vertex.push_back(first_vertex.back() + product<dim>(n_vertices));
        mesh.boundary_ids.push_back({{"left", 0}, {"right", 1}, {"bottom", 2}, {"top", 3}});
      }
    mesh.n_cells = std::accumulate(n_cells.begin(), n_cells.end(), std::uint64_t(0));
    if (scene.decomposition.method == scene::DecompositionMethod::metis)
      {
        if (scene.decomposition.subdomains > mesh.n_cells)
          throw InputError("Decomposition/Subdomains = " + std::to_string(scene.decomposition.subdomains) +
                             " is more than the " + std::to_string(mesh.n_cells) + " cells of the mesh",
                           "ask for at most one subdomain a cell, or set it to auto");
        make_metis(scene, n_cells, first_vertex, mesh);
      }
    else
      make_blocks(scene, first_vertex, mesh);
    return mesh;
  }

  template Mesh<2> make_mesh(const scene::Scene<2> &, const MPI_Comm);
} // namespace slipstick::fem
