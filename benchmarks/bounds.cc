// benchmark_bounds CASE.prm [REPETITIONS] [--set Section/Name=value]...: the least that the stages of a run have to do, by
// itself, on all ranks at the same time; benchmarks/large compares. Prints one line of JSON: seconds of the slowest rank,
// medians over the repetitions.
//
// factorization   numeric Cholesky factorisation of every K_p (made regular at its fixing unknowns), CHOLMOD supernodal, AMD;
//                 one analysis for all of a pattern
// factorization_boundary_last  the same with the touched unknowns last, which the dense blocks need: more fill
// dual_setup      dense blocks of all subdomains from factors that are there: tfeti's inverse_of_product (F_p; dpotri takes twice
//                 as long) and dlauum (S_p)
// read_F, read_S  reading these blocks (packed triangles, double) once: a multiplication, an application of Dirichlet's
//                 preconditioner
// assembly        adding the same 8 x 8 matrix of a cell into the values of K_p at known places
// recovery        one forward and backward solve with every factor
#include "common.h"

#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/scene/read.h>
#include <slipstick/tfeti/cholesky.h>
#include <slipstick/tfeti/dual_operator.h>
#include <slipstick/tfeti/packed.h>

#include <deal.II/base/mpi.h>

#include <Eigen/CholmodSupport>

#include <algorithm>
#include <array>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

extern "C" void dlauum_(const char *, const int *, double *, const int *, int *);

namespace
{
  using namespace slipstick;
  using benchmark::median;
  using benchmark::seconds;

  /// Factorisations that share an analysis where patterns agree.
  class Factors
  {
  public:
    Factors()
    {
      cholmod_start(&common);
      common.supernodal         = CHOLMOD_SUPERNODAL;
      common.final_ll           = 1;
      common.nmethods           = 1;
      common.method[0].ordering = CHOLMOD_AMD;
    }

    ~Factors()
    {
      for (auto &[pattern, factor] : analysed)
        cholmod_free_factor(&factor, &common);
      for (auto &factor : all)
        cholmod_free_factor(&factor, &common);
      cholmod_finish(&common);
    }

    Factors(const Factors &)            = delete;
    Factors &operator=(const Factors &) = delete;

    void add(Eigen::SparseMatrix<double> &lower)
    {
      cholmod_sparse         A = Eigen::viewAsCholmod(std::as_const(lower).selfadjointView<Eigen::Lower>());
      const std::vector<int> pattern(lower.innerIndexPtr(), lower.innerIndexPtr() + lower.nonZeros());
      auto                  &analysis = analysed[pattern];
      if (!analysis)
        analysis = cholmod_analyze(&A, &common);
      cholmod_factor *factor = cholmod_copy_factor(analysis, &common);
      cholmod_factorize(&A, factor, &common);
      if (common.status != CHOLMOD_OK)
        throw std::runtime_error("CHOLMOD status " + std::to_string(common.status));
      all.push_back(factor);
    }

    void solve(const std::size_t p, Eigen::VectorXd &b)
    {
      cholmod_dense right{};
      right.nrow = right.d = right.nzmax = b.size();
      right.ncol                         = 1;
      right.x                            = b.data();
      right.xtype                        = CHOLMOD_REAL;
      right.dtype                        = CHOLMOD_DOUBLE;
      cholmod_dense *x                   = cholmod_solve(CHOLMOD_A, all[p], &right, &common);
      cholmod_free_dense(&x, &common);
    }

  private:
    cholmod_common                               common;
    std::map<std::vector<int>, cholmod_factor *> analysed;
    std::vector<cholmod_factor *>                all;
  };

  /// Places of the entries of every cell in the values of K_p.
  std::vector<int> places(const Eigen::SparseMatrix<double> &lower, const dealii::DoFHandler<2> &dofs)
  {
    std::vector<int>                             result;
    std::vector<dealii::types::global_dof_index> of_cell(dofs.get_fe().n_dofs_per_cell());
    for (const auto &cell : dofs.active_cell_iterators())
      {
        cell->get_dof_indices(of_cell);
        for (const auto i : of_cell)
          for (const auto j : of_cell)
            if (i >= j)
              {
                const int *begin = lower.innerIndexPtr() + lower.outerIndexPtr()[j];
                const int *end   = lower.innerIndexPtr() + lower.outerIndexPtr()[j + 1];
                result.push_back(std::lower_bound(begin, end, static_cast<int>(i)) - lower.innerIndexPtr());
              }
      }
    return result;
  }

  nlohmann::json run(const std::string &file, const std::vector<std::string> &overrides, const unsigned int repetitions)
  {
    const MPI_Comm       comm  = MPI_COMM_WORLD;
    const auto           scene = scene::read_scene(file, overrides);
    const auto                 mesh  = mesh::make_mesh(scene, comm);
    const mechanics::Spaces<2> spaces(mesh, scene.discretization.degree);
    const auto                 constraints = interface::contact_constraints(scene, mesh, spaces, 1.);
    auto                       matrices    = mechanics::assemble(scene, mesh, spaces, 1.);

    std::vector<int>                       sizes;
    std::vector<std::vector<unsigned int>> last;
    std::vector<std::vector<int>>          cells;
    std::size_t                            packed = 0;
    for (std::size_t p = 0; p < matrices.size(); ++p)
      {
        const auto touched = tfeti::LocalGluing::make(constraints.blocks[p]).second;
        auto      &K       = matrices[p].stiffness;
        cells.push_back(places(K, *spaces.dof_handlers[p]));
        const double rho = K.diagonal().mean();
        for (const unsigned int i : tfeti::fixing_unknowns(matrices[p].kernel, touched).first)
          K.coeffRef(i, i) += rho;
        sizes.push_back(touched.size());
        last.push_back(touched);
        packed += touched.size() * (touched.size() + 1) / 2;
      }

    std::map<std::string, std::vector<double>> times;
    std::vector<double>                        buffer(packed, 1.);
    double                                     checksum = 0;
    for (unsigned int k = 0; k < repetitions; ++k)
      {
        std::vector<std::vector<double>> values; // room first, as a matrix that has its pattern
        for (const auto &one : matrices)
          values.emplace_back(one.stiffness.nonZeros(), 0.);
        times["assembly"].push_back(seconds(comm, [&] {
          const unsigned int     n_entries = 36; // lower triangle of 8 x 8
          std::array<double, 36> cell;
          cell.fill(1.);
          for (std::size_t p = 0; p < matrices.size(); ++p)
            for (std::size_t c = 0; c < cells[p].size(); c += n_entries)
              for (unsigned int e = 0; e < n_entries; ++e)
                values[p][cells[p][c + e]] += cell[e];
        }));
        for (const auto &one : values) // they are needed
          checksum += *std::max_element(one.begin(), one.end());
        values.clear();
        {
          Factors factors;
          times["factorization"].push_back(seconds(comm, [&] {
            for (auto &one : matrices)
              factors.add(one.stiffness);
          }));
          times["recovery"].push_back(seconds(comm, [&] {
            for (std::size_t p = 0; p < matrices.size(); ++p)
              factors.solve(p, matrices[p].load);
          }));
        }
        times["factorization_boundary_last"].push_back(seconds(comm, [&] {
          const auto session = std::make_shared<tfeti::CholmodSession>();
          for (std::size_t p = 0; p < matrices.size(); ++p)
            checksum += tfeti::Cholesky(session, matrices[p].stiffness, last[p], "K").n_nonzeros();
        }));
        times["dual_setup"].push_back(seconds(comm, [&] {
          for (const int n : sizes)
            {
              Eigen::MatrixXd       S    = Eigen::MatrixXd::Identity(n, n);
              const Eigen::MatrixXd F    = tfeti::inverse_of_product(S);
              int                   info = 0;
              dlauum_("L", &n, S.data(), &n, &info);
              checksum += F(n - 1, 0) + S(n - 1, 0);
            }
        }));
        times["read"].push_back(seconds(comm, [&] {
          std::array<double, 32> sums{};
          for (std::size_t i = 0; i + sums.size() <= buffer.size(); i += sums.size())
            for (std::size_t j = 0; j < sums.size(); ++j)
              sums[j] += buffer[i + j];
          for (const double s : sums)
            checksum += s;
        }));
      }
    nlohmann::json out;
    for (const auto &[name, all] : times)
      out[name] = median(all);
    out["read_F"] = out["read_S"] = out["read"];
    out.erase("read");
    out["block_mb"]   = dealii::Utilities::MPI::sum(8e-6 * packed, comm);
    out["checksum"]   = dealii::Utilities::MPI::sum(checksum, comm); // so that nothing is optimised away
    out["subdomains"] = mesh.n_subdomains();
    return out;
  }
} // namespace

int main(int argc, char **argv)
{
  return benchmark::main_of("benchmark_bounds", argc, argv, 3, [](const benchmark::Case &given) {
    const auto out = run(given.file, given.overrides, given.repetitions);
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::cout << out.dump() << std::endl;
    return 0;
  });
}
