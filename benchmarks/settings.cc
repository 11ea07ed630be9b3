// benchmark_settings CASE.prm [--largest N] [--smallest N] [--only TABLE]... [--set Section/Name=value]...:
// F-multiplications over outer steps in the cells of the paper's tables (all ten by default), with one setting of the
// solver changed at a time. The dual problem of every N is set up once; times are of the solver alone, over all cells.
// --only takes the beginning of a table's name. Prints Markdown on rank 0.
#include <slipstick/contact/friction.h>
#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/scene/read.h>
#include <slipstick/tfeti/process.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <iostream>

namespace
{
  using namespace slipstick;

  constexpr const char *usage = "usage: benchmark_settings CASE.prm [--largest N] [--smallest N] [--only TABLE]... "
                                "[--set Section/Name=value]...";

  /// One row of a table: what it is called and what it does to the defaults.
  struct Setting
  {
    std::string                                 table, name;
    std::function<void(scene::SolverOptions &)> change;
  };

  std::vector<Setting> settings()
  {
    std::vector<Setting> rows;
    const auto           add = [&](const std::string &table, const std::string &name, auto change) {
      rows.push_back({table, name, change});
    };
    const auto number = [](const double value) {
      char text[32];
      std::snprintf(text, sizeof text, "%g", value);
      return std::string(text);
    };
    using qp::Expansion;

    add("Defaults", "as shipped", [](scene::SolverOptions &) {});
    add("Expansion", "gradient projection", [](auto &o) { o.smalbe.inner.expansion = Expansion::gradient_projection; });
    add("Expansion", "boundary then projection", [](auto &o) {
      o.smalbe.inner.expansion = Expansion::boundary_then_projection;
    });
    add("Expansion", "projected CG", [](auto &o) { o.smalbe.inner.expansion = Expansion::projected_cg; });
    add("The paper's settings", "gradient projection, reduction 10, step 2, rho fixed", [](auto &o) {
      o.smalbe.inner.expansion   = Expansion::gradient_projection;
      o.smalbe.inner.step_length = 2;
      o.smalbe.balance_reduction = 10;
      o.smalbe.penalty_window    = o.smalbe.max_outer_iterations;
    });
    for (const double value : {1., 1.25, 1.5, 1.75, 1.95, 2.})
      add("Step length", number(value), [=](auto &o) { o.smalbe.inner.step_length = value; });
    for (const double value : {1.1, 1.25, 1.5, 2., 3., 10.})
      add("Balance reduction", number(value), [=](auto &o) { o.smalbe.balance_reduction = value; });
    for (const double value : {0.3, 1., 3.})
      add("Initial balance", number(value), [=](auto &o) { o.smalbe.initial_balance = value; });
    for (const double value : {0.3, 1., 3., 10.})
      add("Regularization (rho over the norm)", number(value), [=](auto &o) { o.smalbe.regularization = value; });
    for (const double value : {0.5, 1., 2.})
      add("Proportioning", number(value), [=](auto &o) { o.smalbe.inner.proportioning = value; });
    for (const unsigned int window : {5, 10, 15, 20, 30})
      add("Penalty growth: window of outer steps", std::to_string(window), [=](auto &o) {
        o.smalbe.penalty_window = window;
      });
    add("Penalty growth: window of outer steps", "never", [](auto &o) {
      o.smalbe.penalty_window = o.smalbe.max_outer_iterations;
    });
    for (const double value : {0.1, 0.25, 0.5, 0.75})
      add("Penalty growth: progress asked for in the window", number(value), [=](auto &o) {
        o.smalbe.penalty_progress = value;
      });
    for (const double value : {3., 10., 30.})
      add("Penalty growth: factor", number(value), [=](auto &o) { o.smalbe.penalty_growth = value; });
    for (const double value : {1e-4, 1e-6, 1e-8, 1e-10})
      add("Tolerance", number(value), [=](auto &o) { o.tolerance = value; });
    return rows;
  }

  /// The rows whose table begins with one of the names, all when there are none.
  std::vector<Setting> selected(const std::vector<std::string> &names)
  {
    std::vector<Setting> rows;
    for (const auto &row : settings())
      if (names.empty() ||
          std::any_of(names.begin(), names.end(), [&](const auto &name) { return row.table.rfind(name, 0) == 0; }))
        rows.push_back(row);
    if (rows.empty())
      throw std::runtime_error("--only: no table begins so");
    return rows;
  }

  struct Cell
  {
    double                    slip_bound;
    unsigned int              n_subdomains;
    std::vector<std::string>  results; // by setting
    std::vector<unsigned int> multiplications;
    std::vector<double>       seconds;
  };

  const char *word(const qp::Status status)
  {
    switch (status)
      {
        case qp::Status::converged:
          return "";
        case qp::Status::iteration_limit:
          return " (limit)";
        case qp::Status::stagnated:
          return " (stagnated)";
        case qp::Status::infeasible:
          return " (infeasible)";
      }
    return "";
  }

  std::vector<Cell> solve_cells(const std::string              &file,
                                const std::vector<std::string> &overrides,
                                const std::vector<Setting>     &rows,
                                const unsigned int              n,
                                const MPI_Comm                  comm)
  {
    const bool prints = dealii::Utilities::MPI::this_mpi_process(comm) == 0;
    const auto read   = [&](const double bound) {
      auto all = overrides;
      all.push_back("Decomposition/Blocks=" + std::to_string(n));
      all.push_back("Contact circle/Slip bound=" + std::to_string(bound));
      return scene::read_scene(file, all);
    };
    const auto               scene = read(500);
    const auto                 mesh  = mesh::make_mesh(scene, comm);
    const mechanics::Spaces<2> spaces(mesh, scene.discretization.degree);
    const tfeti::DualProblem   dual(mechanics::assemble(scene, mesh, spaces, 1.),
                                  interface::contact_constraints(scene, mesh, spaces, 1.),
                                  contact::resolved_options(scene).dual,
                                  {"box"},
                                  comm);
    std::vector<Cell>        cells;
    for (const double bound : {500., 150.})
      {
        const auto bounds = contact::slip_bounds(read(bound), dual, 1.);
        Cell       cell{bound, mesh.n_subdomains(), {}, {}, {}};
        for (const auto &row : rows)
          {
            auto options = contact::resolved_options(scene);
            row.change(options);
            const double start    = MPI_Wtime();
            const auto   solution = contact::solve(dual, bounds, options, {});
            cell.seconds.push_back(MPI_Wtime() - start);
            cell.multiplications.push_back(solution.counts.hessian_multiplications);
            cell.results.push_back(std::to_string(solution.counts.hessian_multiplications) + "/" +
                                   std::to_string(solution.counts.outer_iterations) + word(solution.status));
            if (prints)
              std::cerr << cell.n_subdomains << " subdomains, slip bound " << bound << ", " << row.table << " "
                        << row.name << ": " << cell.results.back() << ", " << cell.seconds.back() << " s" << std::endl;
          }
        cells.push_back(std::move(cell));
      }
    return cells;
  }

  void print(const std::vector<Setting> &rows, std::vector<Cell> &cells)
  {
    std::stable_sort(cells.begin(), cells.end(), [](const Cell &a, const Cell &b) {
      return a.slip_bound > b.slip_bound;
    });
    std::string table;
    for (unsigned int i = 0; i < rows.size(); ++i)
      {
        if (rows[i].table != table)
          {
            table = rows[i].table;
            std::printf("\n| %s |", table.c_str());
            for (const auto &cell : cells)
              std::printf(" %g, %u |", cell.slip_bound, cell.n_subdomains);
            std::printf(" sum | solver s |\n|---|");
            for (unsigned int k = 0; k < cells.size() + 2; ++k)
              std::printf("---|");
            std::printf("\n");
          }
        unsigned int sum     = 0;
        double       seconds = 0;
        std::printf("| %s |", rows[i].name.c_str());
        for (const auto &cell : cells)
          {
            std::printf(" %s |", cell.results[i].c_str());
            sum += cell.multiplications[i];
            seconds += cell.seconds[i];
          }
        std::printf(" %u | %.1f |\n", sum, seconds);
      }
    std::fflush(stdout);
  }
} // namespace

int main(int argc, char **argv)
{
  tfeti::Process           process;
  std::string              file;
  unsigned int             smallest = 1, largest = 16;
  std::vector<std::string> overrides, only;
  try
    {
      for (int i = 1; i < argc; ++i)
        {
          const std::string word = argv[i];
          if (word.rfind("--", 0) != 0 && file.empty())
            file = word;
          else if (i + 1 == argc)
            throw std::runtime_error(usage);
          else if (word == "--set")
            overrides.push_back(argv[++i]);
          else if (word == "--only")
            only.push_back(argv[++i]);
          else if (word == "--largest")
            largest = std::stoul(argv[++i]);
          else if (word == "--smallest")
            smallest = std::stoul(argv[++i]);
          else
            throw std::runtime_error(usage);
        }
      if (file.empty() || smallest == 0)
        throw std::runtime_error(usage);
      const auto        rows = selected(only);
      std::vector<Cell> cells;
      for (unsigned int n = smallest; n <= largest; n *= 2)
        {
          auto more = solve_cells(file, overrides, rows, n, MPI_COMM_WORLD);
          cells.insert(cells.end(), more.begin(), more.end());
        }
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        print(rows, cells);
    }
  catch (const std::exception &error)
    {
      std::cerr << "benchmark_settings: " << error.what() << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 1);
    }
  return 0;
}
