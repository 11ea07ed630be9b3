// Lattices of quadrilaterals or triangles, mapped and cut into strips by hand; linear scenes solved on them.
#pragma once

#include "torn.h"

#include <slipstick/contact/friction.h>
#include <slipstick/mechanics/stress.h>

#include <deal.II/grid/manifold_lib.h>

#include <functional>
#include <memory>

namespace slipstick::test
{
  inline const double pi = std::acos(-1.);

  enum class Cells
  {
    quadrilaterals,
    triangles
  };

  struct Grid
  {
    std::array<unsigned int, 2>          n{{4, 4}}; // cells along the two directions of the lattice
    Cells                                cells  = Cells::quadrilaterals;
    std::function<Point(double, double)> map    = [](double s, double t) { return Point(s, t); }; // of the unit square
    unsigned int                         strips = 1;  // subdomains, along the first direction
    std::shared_ptr<dealii::Manifold<2>> manifold;    // of the boundary edges
    bool                                 fan = false; // triangles: diagonals alternate
  };

  struct Kind
  {
    Cells              cells;
    unsigned int       degree;
    scene::ElementKind element;
  };

  inline std::string name(const Kind &kind)
  {
    return std::string(kind.cells == Cells::triangles ? "triangles" : "quadrilaterals") + " of degree " +
           std::to_string(kind.degree) +
           (kind.element == scene::ElementKind::standard ? "" : ", nearly incompressible");
  }

  /// All digits of @p value.
  inline std::string digits(const double value)
  {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
  }

  inline scene::Field<2> number(const double value)
  {
    return field(digits(value));
  }

  /// The whole boundary of the lattice: left, right (s = 0, 1), bottom, top (t = 0, 1).
  inline std::unique_ptr<mesh::SubdomainMesh<2>> strip_of(const Grid &grid, const unsigned int strip)
  {
    const unsigned int n_t = grid.n[1], first = grid.n[0] * strip / grid.strips,
                       last = grid.n[0] * (strip + 1) / grid.strips;
    auto               mesh = std::make_unique<mesh::SubdomainMesh<2>>();
    std::vector<Point> vertices;
    for (unsigned int i = first; i <= last; ++i)
      for (unsigned int j = 0; j <= n_t; ++j)
        {
          vertices.push_back(grid.map(double(i) / grid.n[0], double(j) / n_t));
          mesh->global_vertices.push_back(i * (n_t + 1) + j);
        }
    std::vector<dealii::CellData<2>> cells;
    const auto                       add = [&](const std::vector<unsigned int> &corners) {
      dealii::CellData<2> cell(corners.size());
      cell.vertices.assign(corners.begin(), corners.end());
      cells.push_back(cell);
    };
    for (unsigned int i = 0; i < last - first; ++i)
      for (unsigned int j = 0; j < n_t; ++j)
        {
          const unsigned int a = i * (n_t + 1) + j, b = a + n_t + 1, c = a + 1, d = b + 1;
          if (grid.cells == Cells::quadrilaterals)
            add({a, b, c, d});
          else if (grid.fan && (i + first + j) % 2 == 1)
            {
              add({a, b, c});
              add({b, d, c});
            }
          else
            {
              add({a, b, d});
              add({a, d, c});
            }
        }
    mesh->subdomain = strip;
    mesh->triangulation.create_triangulation(vertices, cells, dealii::SubCellData());
    if (grid.manifold)
      mesh->triangulation.set_manifold(0, *grid.manifold);
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      for (const auto &face : cell->face_iterators())
        if (face->at_boundary())
          {
            const auto on = [&](const unsigned int direction, const unsigned int value) {
              for (unsigned int v = 0; v < 2; ++v)
                {
                  const auto global = mesh->global_vertices[face->vertex_index(v)];
                  if ((direction == 0 ? global / (n_t + 1) : global % (n_t + 1)) != value)
                    return false;
                }
              return true;
            };
            face->set_boundary_id(on(0, 0) ? 0 : on(0, grid.n[0]) ? 1 : on(1, 0) ? 2 : on(1, n_t) ? 3 : mesh::cut_id);
            if (grid.manifold && (on(1, 0) || on(1, n_t)))
              face->set_manifold_id(0);
          }
    return mesh;
  }

  /// Distributes the strips equally among the ranks.
  inline mesh::Mesh<2> mesh_of(const Grid &grid, const MPI_Comm comm = MPI_COMM_WORLD)
  {
    const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(comm),
                       rank    = dealii::Utilities::MPI::this_mpi_process(comm);
    mesh::Mesh<2> mesh;
    mesh.comm         = comm;
    mesh.boundary_ids = {{{"left", 0}, {"right", 1}, {"bottom", 2}, {"top", 3}}};
    for (unsigned int r = 0; r <= n_ranks; ++r)
      mesh.first_subdomain.push_back(grid.strips * r / n_ranks);
    for (unsigned int s = mesh.first_subdomain[rank]; s < mesh.first_subdomain[rank + 1]; ++s)
      mesh.subdomains.push_back(strip_of(grid, s));
    return mesh;
  }

  /// A scene of one body without conditions; its shape is that of the grid.
  inline Scene sheet(const unsigned int degree, const scene::PlaneState state = scene::PlaneState::plane_stress)
  {
    Scene scene                  = box(1, degree);
    scene.plane_state            = state;
    scene.bodies[0].thickness    = 3;
    scene.solver.tolerance       = 1e-12;
    scene.materials[0].density   = 2;
    scene.materials[0].expansion = 1e-3;
    return scene;
  }

  /// xx, yy, xy, zz of a displacement gradient, from the three-dimensional law
  inline Eigen::Vector4d stress_of(const Scene &scene, const Eigen::Matrix2d &gradient)
  {
    const double E = scene.materials[0].young_modulus, nu = scene.materials[0].poisson_ratio;
    const double G = E / (2 * (1 + nu)), lambda = 2 * G * nu / (1 - 2 * nu);
    const double e_zz  = scene.plane_state == scene::PlaneState::plane_strain ? 0 : -nu / (1 - nu) * gradient.trace();
    const double theta = gradient.trace() + e_zz;
    return {lambda * theta + 2 * G * gradient(0, 0),
            lambda * theta + 2 * G * gradient(1, 1),
            G * (gradient(0, 1) + gradient(1, 0)),
            lambda * theta + 2 * G * e_zz};
  }

  /// A linear scene on a grid, assembled.
  struct OnGrid
  {
    OnGrid(const Scene &scene_, const Grid &grid, const MPI_Comm comm_ = MPI_COMM_WORLD)
      : scene(scene_)
      , comm(comm_)
      , mesh(mesh_of(grid, comm))
      , spaces(mesh, scene.discretization.degree)
      , matrices(mechanics::assemble(scene, mesh, spaces, 1.))
      , constraints(interface::contact_constraints(scene, mesh, spaces, 1.))
    {}

    mechanics::StressResult stress(const std::vector<Eigen::VectorXd> &u) const
    {
      return mechanics::recover_stress(scene, mesh, spaces, constraints, u, 1.);
    }

    std::vector<Eigen::VectorXd> solve() const
    {
      const tfeti::DualProblem dual(matrices, constraints, scene.solver.dual, body_names(scene), comm);
      const auto               solution =
        contact::solve(dual, contact::slip_bounds(scene, dual, 1.), contact::resolved_options(scene), {});
      EXPECT_EQ(solution.status, qp::Status::converged);
      return tfeti::recover(dual, solution.multipliers, solution.free).u;
    }

    /// Nodal values of a function of position, by subdomain.
    std::vector<Eigen::VectorXd> nodal(const std::function<Eigen::Vector2d(const Point &)> &function) const
    {
      std::vector<Eigen::VectorXd> u;
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        {
          const auto x = node_positions(spaces, p);
          u.emplace_back(2 * x.size());
          for (unsigned int i = 0; i < x.size(); ++i)
            u.back().segment<2>(2 * i) = function(x[i]);
        }
      return u;
    }

    /// Root mean square of the nodal differences from a function, relative to that of the function.
    double difference(const std::vector<Eigen::VectorXd>                  &u,
                      const std::function<Eigen::Vector2d(const Point &)> &function) const
    {
      const auto            expect = nodal(function);
      std::array<double, 2> sums{{0, 0}};
      for (unsigned int p = 0; p < u.size(); ++p)
        {
          sums[0] += (u[p] - expect[p]).squaredNorm();
          sums[1] += expect[p].squaredNorm();
        }
      MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_DOUBLE, MPI_SUM, comm);
      return std::sqrt(sums[0] / sums[1]);
    }

    /// Largest difference of the nodal stresses xx, yy, xy, zz from a function.
    double stress_difference(const mechanics::StressResult                       &stress,
                             const std::function<Eigen::Vector4d(const Point &)> &function) const
    {
      double largest = 0;
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        {
          const auto x = node_positions(spaces, p);
          for (unsigned int i = 0; i < x.size(); ++i)
            largest =
              std::max(largest, (stress.subdomains[p].nodal.row(i).transpose() - function(x[i])).cwiseAbs().maxCoeff());
        }
      return dealii::Utilities::MPI::max(largest, comm);
    }

    /// Sum of all nodal forces and of their moments about the origin.
    Eigen::Vector3d resultant() const
    {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        {
          const auto x = node_positions(spaces, p);
          for (unsigned int i = 0; i < x.size(); ++i)
            {
              const Eigen::Vector2d f = matrices[p].load.segment<2>(2 * i);
              sum += Eigen::Vector3d(f[0], f[1], x[i][0] * f[1] - x[i][1] * f[0]);
            }
        }
      MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, comm);
      return sum;
    }

    Scene                                 scene;
    MPI_Comm                              comm;
    mesh::Mesh<2>                         mesh;
    mechanics::Spaces<2>                  spaces;
    std::vector<tfeti::SubdomainMatrices> matrices;
    tfeti::Constraints                    constraints;
  };

  /// Quarter of a ring between radii a and b, the first direction along the circumference; its arcs are on circles.
  inline Grid quarter_ring(const double                       a,
                           const double                       b,
                           const std::array<unsigned int, 2> &n,
                           const Cells                        cells,
                           const unsigned int                 strips)
  {
    Grid grid;
    grid.n        = n;
    grid.cells    = cells;
    grid.strips   = strips;
    grid.fan      = true;
    grid.manifold = std::make_shared<dealii::PolarManifold<2>>(Point());
    grid.map      = [a, b](const double s, const double t) {
      // from the y axis to the x axis, so that cells are counterclockwise
      const double angle = (1 - s) * std::acos(-1.) / 2, r = a + t * (b - a);
      return Point(s == 1 ? r : r * std::cos(angle), s == 0 ? r : s == 1 ? 0 : r * std::sin(angle));
    };
    return grid;
  }
} // namespace slipstick::test
