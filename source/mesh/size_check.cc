#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/memory.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/shapes.h>
#include <slipstick/mesh/size_check.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace slipstick::mesh
{
  namespace
  {
    // Bytes per unknown: mesh, stiffness and output, and the factor, whose entries grow with the logarithm of the
    // subdomain's size. Measured: 1.33 million unknowns in 256 subdomains take 1 GB (README.md).
    constexpr double bytes_per_unknown = 300, bytes_per_unknown_and_doubling = 32;
    constexpr double cells_per_subdomain          = 10000; // target of auto, see decomposition.cc ...
    constexpr double cells_per_subdomain_in_space = 1000;
    // Measured in space: 1.1 million unknowns in 512 subdomains of 8^3 cells take 5 GB; one subdomain of 16^3 and 24^3
    // cells takes 14 and 24 kB per unknown, which grows as the root of their number.
    constexpr double bytes_per_unknown_in_space = 5000, unknowns_of_these = 2200;
    constexpr double most_cells          = 1e9;   // above this 32-bit counters may overflow
    constexpr double bytes_per_subdomain = 100e3; // its mesh and lists, for any number of cells
    constexpr double many_subdomains     = 1e4;   // above this the message mentions them
    constexpr double bytes_of_a_cell     = 40;    // in a mesh file, at least
    constexpr double around_an_edge      = 13;    // cells added per edge refined by 3, all levels together
    constexpr double around_a_face       = 6;     // the same in space per face: a cell becomes 27, the next one 22
    constexpr double usable              = 0.9;   // part of the free memory
    constexpr double finest = 1e-8; // edge length of cells over their distance from the origin: 8 digits remain

    // Nodes per triangle or tetrahedron of a large mesh, by degree; quadrilaterals and hexahedra have degree^dim.
    constexpr std::array<double, 2> nodes_per_triangle{{0.5, 2}}, nodes_per_tetrahedron{{0.2, 1.4}};

    struct Count
    {
      double cells = 0, outline = 0; // before refinements towards boundaries
      bool   is_simplex = false;     // triangles or tetrahedra only
    };

    double nodes_per_cell(const unsigned int dim, const unsigned int degree, const bool is_simplex)
    {
      if (is_simplex)
        return (dim == 2 ? nodes_per_triangle : nodes_per_tetrahedron)[degree - 1];
      return std::pow(degree, dim);
    }

    Count count_of_file(const std::string &path, const unsigned int dim)
    {
      const MeshFile                                                file = read_mesh_file(path);
      std::map<std::pair<unsigned int, unsigned int>, unsigned int> n_cells;
      Count                                                         count;
      double                                                        n_simplices = 0;
      for (const auto &cell : file.elements)
        if (cell.dim == dim)
          {
            ++count.cells;
            n_simplices += cell.n == dim + 1;
            for (unsigned int k = 0; k < cell.n; ++k)
              ++n_cells[std::minmax(cell.corners[k], cell.corners[(k + 1) % cell.n])];
          }
      for (const auto &entry : n_cells)
        count.outline += entry.second == 1;
      count.is_simplex = n_simplices == count.cells;
      if (dim == 2 && n_simplices > 0 && !count.is_simplex) // may become quadrilaterals, as make_body() divides them
        count.cells = 3 * n_simplices + 4 * (count.cells - n_simplices);
      return count;
    }

    /// Number of bodies that use parts of the same file.
    template <int dim>
    unsigned int bodies_in_file(const scene::Scene<dim> &scene, const scene::Body<dim> &body)
    {
      return body.part.empty() ? 1 : std::count_if(scene.bodies.begin(), scene.bodies.end(), [&](const auto &other) {
        return other.shape == scene::Shape::mesh && other.file == body.file && !other.part.empty();
      });
    }

    /// @param reads_files counts the cells in mesh files; otherwise they are estimated from the size of the file.
    template <int dim>
    Count count_of(const scene::Scene<dim> &scene, const scene::Body<dim> &body, const bool reads_files)
    {
      const double refined = std::ldexp(1., scene.discretization.refinements + body.refinements);
      Count        count;
      switch (body.shape)
        {
          case scene::Shape::rectangle:
            {
              const double n = double(scene.decomposition.blocks) * scene.decomposition.cells_per_block;
              const double a = body.cells ? (*body.cells)[0] : n, b = body.cells ? (*body.cells)[1] : n;
              count = {a * b, 2 * (a + b)};
              if (dim == 3)
                {
                  const double c = body.cells ? (*body.cells)[dim - 1] : n;
                  count          = {a * b * c * refined, 2 * (a * b + b * c + c * a) * refined};
                }
              break;
            }
          case scene::Shape::disc: // a square with a quarter of the edges per side, and about as many around it
          case scene::Shape::half_disc:
            {
              const double n = body.cells_along_arc;
              count          = {n * n / 8, body.shape == scene::Shape::disc ? n : 1.5 * n};
              break;
            }
          case scene::Shape::quarter_disc:
            {
              const double n = body.cells_along_arc;
              count          = {n * n / 2, 3 * n};
              break;
            }
          case scene::Shape::ring:
          case scene::Shape::quarter_ring:
            {
              const double around = body.cells ? (*body.cells)[0] : 64, across = body.cells ? (*body.cells)[1] : 16;
              count = {around * across, 2 * (around + across)};
              break;
            }
          case scene::Shape::ball: // a cube with a quarter of the edges per side, and twice as many around it
          case scene::Shape::half_ball:
            {
              const double n = body.cells_along_arc;
              count          = {n * n * n / 16 * refined, 2 * n * n * refined};
              break;
            }
          case scene::Shape::cylinder: // a disc extruded along the axis
          case scene::Shape::tube:
            if constexpr (dim == 3)
              {
                const auto   bar     = round_bar_cells(body);
                const double n       = body.cells_along_arc;
                const bool   is_tube = bar.across > 0;
                const double section = is_tube ? n * bar.across : n * n / 8;
                count = {section * bar.along * refined, (2 * section + (is_tube ? 2 : 1) * n * bar.along) * refined};
              }
            break;
          case scene::Shape::mesh:
            {
              std::error_code error;
              if (reads_files || refined > 1 || body.boundary_refinements > 0)
                count = count_of_file(body.file, dim);
              else
                count.cells = std::filesystem::file_size(body.file, error) / bytes_of_a_cell;
              const double n = bodies_in_file(scene, body);
              count          = {count.cells / n, count.outline / n, count.is_simplex};
              break;
            }
        }
      return {count.cells * refined * refined, count.outline * refined, count.is_simplex};
    }

    std::string rounded(const double value)
    {
      char text[32];
      std::snprintf(text, sizeof(text), value < 1e6 ? "%.0f" : "%.2g", value);
      return text;
    }
  } // namespace

  template <int dim>
  SizeEstimate estimate_size(const scene::Scene<dim> &scene, const bool reads_files)
  {
    SizeEstimate size;
    double       most = 0;
    for (const auto &body : scene.bodies)
      {
        const Count  count   = count_of(scene, body, reads_files);
        const double towards = body.refined_boundaries.empty() ? 0
                               : dim == 2
                                 ? count.outline * around_an_edge * (std::pow(3., body.boundary_refinements) - 1)
                                 : count.outline * around_a_face * (std::pow(9., body.boundary_refinements) - 1);
        size.cells += count.cells + towards;
        size.unknowns +=
          (count.cells + towards) * dim * nodes_per_cell(dim, scene.discretization.degree, count.is_simplex);
        if (count.cells + towards > most)
          {
            most         = count.cells + towards;
            size.largest = "Body " + body.name + ": " + rounded(most) + " cells" +
                           (towards > count.cells ? ", most of them by Refine levels" : "");
          }
      }
    double n_subdomains =
      std::max<double>(scene.bodies.size(),
                       size.unknowns / (dim * (dim == 2 ? cells_per_subdomain : cells_per_subdomain_in_space)));
    if (scene.decomposition.method == scene::DecompositionMethod::blocks)
      n_subdomains = double(scene.bodies.size()) * std::pow(scene.decomposition.blocks, dim);
    else if (scene.decomposition.method == scene::DecompositionMethod::none)
      n_subdomains = scene.bodies.size();
    else if (scene.decomposition.subdomains > 0)
      n_subdomains = std::min<double>(scene.decomposition.subdomains, size.cells); // more are refused elsewhere
    const double of_one = std::max(2., size.unknowns / n_subdomains);
    size.memory_mb =
      (n_subdomains * bytes_per_subdomain +
       size.unknowns * (dim == 3 ? bytes_per_unknown_in_space * std::sqrt(std::max(1., of_one / unknowns_of_these))
                                 : bytes_per_unknown + bytes_per_unknown_and_doubling * std::log2(of_one))) /
      1048576;
    if (n_subdomains > many_subdomains)
      size.largest += ", in " + rounded(n_subdomains) + " subdomains";
    return size;
  }

  template <int dim>
  void check_size(const scene::Scene<dim> &scene, const bool forced, const MPI_Comm comm)
  {
    const double free = dealii::Utilities::MPI::sum(share_of_free_memory_mb(comm), comm);
    collectively(comm, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(comm) != 0)
        return;
      SizeEstimate size = estimate_size(scene);
      if (size.cells > most_cells || size.memory_mb > usable * free)
        size = estimate_size(scene, true);
      const std::string asks = "the scene has about " + rounded(size.unknowns) + " unknowns (" + size.largest + ")";
      const std::string less = "use fewer Cells, Blocks, Refinements or Refine levels, or a coarser mesh file";
      if (size.cells > most_cells)
        throw InputError(asks + ", more than can be counted (" + rounded(most_cells) + " cells)", less);
      if (!forced && size.memory_mb > usable * free)
        throw InputError(asks + ", which take about " + rounded(size.memory_mb) + " MB of memory, and " +
                           rounded(free) + " MB are free",
                         less + "; or run it anyway with --force");
    });
  }

  template <int dim>
  void check_positions(const scene::Scene<dim> &scene, const Mesh<dim> &mesh)
  {
    collectively(mesh.comm, [&] {
      for (const auto &subdomain : mesh.subdomains)
        for (const auto &cell : subdomain->triangulation.active_cell_iterators())
          for (const auto &face : cell->face_iterators())
            {
              const double length = face->vertex(0).distance(face->vertex(1)), away = face->vertex(0).norm();
              if (!(length > finest * away))
                throw InputError(
                  "Body " + scene.bodies[subdomain->body].name + ": has an edge of " + number_text(length) + " mm at " +
                    number_text(away) + " mm from the origin, where numbers do not resolve such an edge well enough",
                  "move the body closer to the origin (Translation, Center, Origin or the mesh itself), or use "
                  "larger cells");
            }
    });
  }

  template SizeEstimate estimate_size(const scene::Scene<2> &, const bool);
  template void         check_size(const scene::Scene<2> &, const bool, const MPI_Comm);
  template SizeEstimate estimate_size(const scene::Scene<3> &, const bool);
  template void         check_size(const scene::Scene<3> &, const bool, const MPI_Comm);
  template void         check_positions(const scene::Scene<2> &, const Mesh<2> &);
  template void         check_positions(const scene::Scene<3> &, const Mesh<3> &);
} // namespace slipstick::mesh
