#include <slipstick/app/adaptivity.h>
#include <slipstick/base/gather.h>
#include <slipstick/mechanics/singular_points.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::app
{
  namespace
  {
    // The refined cells contribute this fraction of the error, unless fewer cells are sufficient (Doerfler 1996).
    constexpr double most_of_error = 0.6;
    // Factor by which refinement multiplies the additive error of a cell; for smooth solutions of degree 1 it is 1/9
    // for nine quadrilaterals and 1/4 for four triangles and eight tetrahedra, at singular points it is larger.
    constexpr double left_of_error = 0.25;
    // Cells whose errors differ by less than this fraction are refined together, so that the choice does not depend on
    // rounding.
    constexpr double alike = 1e-6;
    // The target is this fraction of the allowed error, so that the last mesh does not narrowly miss it.
    constexpr double aim = 0.9;

    // A vertex coincides with a point if its distance is less than this fraction of the diameter of its cell.
    constexpr double at_vertex = 1e-6;

    using Entry = std::pair<double, mesh::CellKey>;
  } // namespace

  template <int dim>
  std::vector<LeftOut<dim>> point_forces(const scene::Scene<dim>      &scene,
                                         const mesh::Mesh<dim>        &mesh,
                                         const mechanics::Spaces<dim> &spaces,
                                         const unsigned int            n_supports)
  {
    std::vector<LeftOut<dim>> list;
    for (const auto &point : mechanics::force_points(scene, mesh, spaces, n_supports))
      {
        double own = 0;
        for (const auto &subdomain : mesh.subdomains)
          if (subdomain->body == point.body)
            for (const auto &cell : subdomain->triangulation.active_cell_iterators())
              for (const unsigned int v : cell->vertex_indices())
                if (cell->vertex(v).distance(point.position) < at_vertex * cell->diameter())
                  own = std::max(own, cell->diameter());
        list.push_back({point.body, point.position, dealii::Utilities::MPI::max(own, mesh.comm), point.what});
      }
    return list;
  }

  template <int dim>
  CellErrors energy_errors(const mesh::Mesh<dim>           &mesh,
                           const mechanics::StressResult   &stress,
                           const std::vector<LeftOut<dim>> &left_out,
                           const double                     accuracy)
  {
    CellErrors   errors;
    const double all = stress.energy_squared + stress.error_squared;
    double       own = 0;
    for (unsigned int p = 0; p < stress.subdomains.size(); ++p)
      {
        errors.of_cells.push_back(stress.subdomains[p].error.array().square() / (all > 0 ? all : 1.));
        for (const auto &cell : mesh.subdomains[p]->triangulation.active_cell_iterators())
          for (const auto &place : left_out)
            if (place.body == mesh.subdomains[p]->body && cell->center().distance(place.position) < place.radius)
              errors.of_cells[p][cell->active_cell_index()] = 0;
        own += errors.of_cells[p].sum();
      }
    errors.total   = dealii::Utilities::MPI::sum(own, mesh.comm);
    errors.allowed = accuracy * accuracy;
    return errors;
  }

  CellErrors errors_of_goals(const std::vector<GoalError> &goals, const double accuracy, const MPI_Comm comm)
  {
    CellErrors errors;
    double     estimated = 0, own = 0;
    for (const auto &goal : goals)
      if (goal.is_known && goal.value != 0)
        {
          errors.of_cells.resize(goal.cells.size());
          for (unsigned int p = 0; p < goal.cells.size(); ++p)
            {
              const Eigen::VectorXd part = goal.cells[p].cwiseAbs() / std::abs(goal.value);
              errors.of_cells[p] = errors.of_cells[p].size() > 0 ? Eigen::VectorXd(errors.of_cells[p] + part) : part;
            }
          estimated = std::max(estimated, std::abs(goal.correction / goal.value));
        }
    for (const auto &part : errors.of_cells)
      own += part.sum();
    errors.total = dealii::Utilities::MPI::sum(own, comm);
    // magnitudes are assumed to decrease like the signed sum
    errors.allowed = estimated > 0 ? errors.total * accuracy / estimated : 0.;
    return errors;
  }

  template <int dim>
  std::size_t mark(const mesh::Mesh<dim> &mesh, const CellErrors &errors, mesh::Refinement &refinement)
  {
    std::vector<Entry> own;
    for (unsigned int p = 0; p < errors.of_cells.size(); ++p)
      for (const auto &cell : mesh.subdomains[p]->triangulation.active_cell_iterators())
        {
          std::vector<mesh::GlobalVertex> vertices;
          for (const unsigned int v : cell->vertex_indices())
            vertices.push_back(mesh.subdomains[p]->global_vertices[cell->vertex_index(v)]);
          own.emplace_back(errors.of_cells[p][cell->active_cell_index()], mesh::cell_key(std::move(vertices)));
        }
    const auto  gathered = gather(mesh.comm, own);
    std::size_t n_marked = 0;
    if (dealii::Utilities::MPI::this_mpi_process(mesh.comm) == 0)
      {
        std::vector<Entry> all;
        for (const auto &part : gathered)
          all.insert(all.end(), part.begin(), part.end());
        std::sort(all.begin(), all.end(), [](const Entry &a, const Entry &b) {
          return a.first != b.first ? a.first > b.first : a.second < b.second; // independent of the number of ranks
        });
        double marked = 0, last = std::numeric_limits<double>::infinity();
        for (const auto &[error, key] : all)
          {
            if ((marked >= most_of_error * errors.total ||
                 errors.total - (1 - left_of_error) * marked <= aim * errors.allowed) &&
                error < (1 - alike) * last)
              break;
            marked += error;
            last                     = error;
            const auto &[body, path] = refinement.cells.at(key);
            refinement.refined[body].insert(path);
            ++n_marked;
          }
      }
    return dealii::Utilities::MPI::broadcast(mesh.comm, n_marked);
  }

  std::optional<double> worst_error(const std::vector<output::ErrorBar> &bars,
                                    const std::map<std::string, double> &scales)
  {
    double worst = 0;
    for (const auto &bar : bars)
      if (const auto scale = scales.find(bar.quantity); scale != scales.end())
        {
          if (!bar.error || scale->second == 0)
            return {};
          worst = std::max(worst, *bar.error / scale->second);
        }
    return worst;
  }

  template std::vector<LeftOut<2>> point_forces(const scene::Scene<2> &,
                                                const mesh::Mesh<2> &,
                                                const mechanics::Spaces<2> &,
                                                const unsigned int);
  template std::vector<LeftOut<3>> point_forces(const scene::Scene<3> &,
                                                const mesh::Mesh<3> &,
                                                const mechanics::Spaces<3> &,
                                                const unsigned int);
  template CellErrors              energy_errors(const mesh::Mesh<2> &,
                                                 const mechanics::StressResult &,
                                                 const std::vector<LeftOut<2>> &,
                                                 const double);
  template CellErrors              energy_errors(const mesh::Mesh<3> &,
                                                 const mechanics::StressResult &,
                                                 const std::vector<LeftOut<3>> &,
                                                 const double);
  template std::size_t             mark(const mesh::Mesh<2> &, const CellErrors &, mesh::Refinement &);
  template std::size_t             mark(const mesh::Mesh<3> &, const CellErrors &, mesh::Refinement &);
} // namespace slipstick::app
