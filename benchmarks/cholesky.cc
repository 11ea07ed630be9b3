// benchmark_cholesky CASE.prm [REPETITIONS] [--set Section/Name=value]...: one subdomain of the scene under several
// sparse Cholesky factorisations, and its dual operator explicit against implicit. One thread, processor time. Medians over
// the repetitions, all variants in turn in each of them; prints Markdown.
#include "common.h"

#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/scene/read.h>
#include <slipstick/tfeti/dual_operator.h>

#include <deal.II/base/mpi.h>

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <iostream>

namespace
{
  using namespace slipstick;
  using benchmark::median;
  using Matrix = Eigen::SparseMatrix<double>;
  using Vector = Eigen::VectorXd;

  constexpr unsigned int products_per_sample = 20;

  double cpu_seconds()
  {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
  }

  /// Processor time of this one thread: others on a shared machine do not count, as far as they leave the caches alone.
  double seconds(const std::function<void()> &work)
  {
    const double start = cpu_seconds();
    work();
    return cpu_seconds() - start;
  }

  double milliseconds(const std::vector<double> &values)
  {
    return 1e3 * median(values);
  }

  /// The least: what a busy machine disturbs least.
  double least_milliseconds(const std::vector<double> &values)
  {
    return 1e3 * *std::min_element(values.begin(), values.end());
  }

  /// A way to factorise and solve, timed again and again.
  struct Variant
  {
    std::string                                            name;
    std::function<std::function<Vector(const Vector &)>()> factorise; // returns the solver
    std::function<std::size_t()>                           nonzeros;
    std::vector<double>                                    factor_times, solve_times;
    double                                                 error = 0; // |A x - b| / |b|
  };

  template <class Solver>
  Variant eigen_variant(const std::string &name, const Matrix &A, const std::function<std::size_t(Solver &)> &nonzeros)
  {
    auto    solver = std::make_shared<std::unique_ptr<Solver>>();
    Variant variant;
    variant.name      = name;
    variant.factorise = [solver, &A]() -> std::function<Vector(const Vector &)> {
      solver->reset(); // the old factor's memory is free again, as in a run over many subdomains
      *solver = std::make_unique<Solver>();
      (*solver)->compute(A);
      if ((*solver)->info() != Eigen::Success)
        throw std::runtime_error("factorisation failed");
      return [solver](const Vector &b) -> Vector { return (*solver)->solve(b); };
    };
    variant.nonzeros = [solver, nonzeros] { return nonzeros(**solver); };
    return variant;
  }

  Variant own_variant(const std::string                            &name,
                      const Matrix                                 &A,
                      const std::vector<unsigned int>              &last,
                      const std::shared_ptr<tfeti::CholmodSession> &session)
  {
    auto    factor = std::make_shared<std::unique_ptr<tfeti::Cholesky>>();
    Variant variant;
    variant.name      = name;
    variant.factorise = [factor, &A, &last, session]() -> std::function<Vector(const Vector &)> {
      factor->reset();
      *factor = std::make_unique<tfeti::Cholesky>(session, A, last, "subdomain");
      return [factor](const Vector &b) -> Vector {
        Vector x = b;
        (*factor)->solve(x);
        return x;
      };
    };
    variant.nonzeros = [factor] { return (*factor)->n_nonzeros(); };
    return variant;
  }

  /// Analysis and factor of the same matrix, one row a variant.
  void compare_factorisations(const Matrix &A, const std::vector<unsigned int> &last, const unsigned int repetitions)
  {
    const auto                      session = std::make_shared<tfeti::CholmodSession>();
    const std::vector<unsigned int> none;
    using Supernodal = Eigen::CholmodSupernodalLLT<Matrix, Eigen::Lower>;
    using Llt        = Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::AMDOrdering<int>>;
    using Ldlt       = Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::AMDOrdering<int>>;
    std::vector<Variant> variants;
    variants.push_back(own_variant("tfeti::Cholesky (CHOLMOD, AMD)", A, none, session));
    variants.push_back(own_variant("tfeti::Cholesky (CHOLMOD, CAMD, boundary last)", A, last, session));
    variants.push_back(eigen_variant<Supernodal>("Eigen::CholmodSupernodalLLT", A, [](Supernodal &) { return 0; }));
    variants.push_back(eigen_variant<Llt>("Eigen::SimplicialLLT (AMD)", A, [](Llt &solver) {
      return solver.matrixL().nestedExpression().nonZeros();
    }));
    variants.push_back(eigen_variant<Ldlt>("Eigen::SimplicialLDLT (AMD)", A, [](Ldlt &solver) {
      return solver.matrixL().nestedExpression().nonZeros() + solver.vectorD().size();
    }));

    const Vector b = Vector::Random(A.rows());
    Vector       x;
    for (unsigned int k = 0; k < repetitions; ++k)
      for (auto &variant : variants)
        {
          std::function<Vector(const Vector &)> solve;
          variant.factor_times.push_back(seconds([&] { solve = variant.factorise(); }));
          x = solve(b);
          variant.solve_times.push_back(seconds([&] {
                                          for (unsigned int i = 0; i < products_per_sample; ++i)
                                            x = solve(b);
                                        }) /
                                        products_per_sample);
          variant.error = (A.selfadjointView<Eigen::Lower>() * x - b).norm() / b.norm();
        }

    std::printf("\n%ld unknowns, %ld nonzeros in the lower triangle, %u repetitions\n\n",
                static_cast<long>(A.rows()),
                static_cast<long>(A.nonZeros()),
                repetitions);
    std::printf(
      "| factorisation | analysis + factor ms: median | relative | least | solve ms: median | relative | least | "
      "nonzeros of L | residual |\n|---|---|---|---|---|---|---|---|---|\n");
    const double factor = milliseconds(variants[0].factor_times), solve = milliseconds(variants[0].solve_times);
    for (const auto &variant : variants)
      {
        const std::size_t n = variant.nonzeros();
        std::printf("| %s | %.2f | %.2f | %.2f | %.3f | %.2f | %.3f | %s | %.0e |\n",
                    variant.name.c_str(),
                    milliseconds(variant.factor_times),
                    milliseconds(variant.factor_times) / factor,
                    least_milliseconds(variant.factor_times),
                    milliseconds(variant.solve_times),
                    milliseconds(variant.solve_times) / solve,
                    least_milliseconds(variant.solve_times),
                    n > 0 ? std::to_string(n).c_str() : "same factor",
                    variant.error);
      }
  }

  /// Explicit against implicit F of the whole scene: set-up (factor, and blocks) and one product.
  void compare_operators(const scene::Scene<2>      &scene,
                         const mesh::Mesh<2>        &mesh,
                         const mechanics::Spaces<2> &spaces,
                         const unsigned int          repetitions)
  {
    const auto constraints = interface::contact_constraints(scene, mesh, spaces, 1.);
    const auto matrices    = mechanics::assemble(scene, mesh, spaces, 1.);

    std::vector<double>                   factor_times[2], block_times[2], product_times[2];
    double                                megabytes[2] = {0, 0};
    std::vector<tfeti::DistributedVector> results(2, tfeti::DistributedVector(constraints.rows));
    for (unsigned int repetition = 0; repetition < repetitions; ++repetition)
      for (const unsigned int is_explicit : {0u, 1u})
        {
          const auto                                           session = std::make_shared<tfeti::CholmodSession>();
          std::vector<std::unique_ptr<tfeti::SubdomainSystem>> systems;
          std::vector<tfeti::LocalGluing>                      gluing;
          auto                                                 copies = matrices; // not timed
          factor_times[is_explicit].push_back(seconds([&] {
            for (unsigned int p = 0; p < copies.size(); ++p)
              {
                auto [local, touched] = tfeti::LocalGluing::make(constraints.blocks[p]);
                gluing.push_back(std::move(local));
                systems.push_back(std::make_unique<tfeti::SubdomainSystem>(session,
                                                                           std::move(copies[p]),
                                                                           std::move(touched),
                                                                           is_explicit));
              }
          }));
          std::vector<tfeti::PackedSymmetric>  blocks;
          std::unique_ptr<tfeti::DualOperator> F;
          block_times[is_explicit].push_back(seconds([&] {
            if (is_explicit)
              for (const auto &system : systems)
                blocks.push_back(system->pseudo_inverse_block(tfeti::Precision::double_precision));
            F = std::make_unique<tfeti::DualOperator>(systems, gluing, constraints.rows, is_explicit ? &blocks : nullptr);
          }));
          tfeti::DistributedVector x(constraints.rows), &y = results[is_explicit];
          for (unsigned int r = 0; r < x.locally_owned_size(); ++r)
            x.local_element(r) = std::sin(1. + r);
          F->apply(x, y);
          product_times[is_explicit].push_back(seconds([&] {
                                                 for (unsigned int i = 0; i < products_per_sample; ++i)
                                                   F->apply(x, y);
                                               }) /
                                               products_per_sample);
          std::size_t bytes = F->block_bytes();
          for (const auto &system : systems)
            bytes += system->factor_bytes();
          megabytes[is_explicit] = bytes / 1e6;
        }

    const double n = matrices.size();
    std::printf("\n%g subdomain(s), %llu multipliers; per subdomain\n\n", n, constraints.counts.total());
    std::printf("| F | factor ms | blocks ms | one product ms | factor + blocks MB |\n|---|---|---|---|---|\n");
    for (const unsigned int k : {0u, 1u})
      std::printf("| %s | %.2f | %.2f | %.4f | %.2f |\n",
                  k ? "explicit" : "implicit",
                  milliseconds(factor_times[k]) / n,
                  milliseconds(block_times[k]) / n,
                  milliseconds(product_times[k]) / n,
                  megabytes[k] / n);
    results[0] -= results[1];
    std::printf("\nThe products differ by %.0e relative.\n", results[0].l2_norm() / results[1].l2_norm());
    const std::pair<const char *, double (*)(const std::vector<double> &)> statistics[] = {{"medians", milliseconds},
                                                                                           {"least times",
                                                                                            least_milliseconds}};
    for (const auto &[name, of] : statistics)
      {
        const double extra = of(factor_times[1]) + of(block_times[1]) - of(factor_times[0]);
        const double gain  = of(product_times[0]) - of(product_times[1]);
        std::printf(
          "By the %s explicit pays from %.0f multiplications on (%.2f ms more set-up, %.4f ms less a product, per "
          "subdomain).\n",
          name,
          gain > 0 ? std::ceil(extra / gain) : HUGE_VAL,
          extra / n,
          gain / n);
      }
  }
} // namespace

int main(int argc, char **argv)
{
  return benchmark::main_of("benchmark_cholesky", argc, argv, 21, [](const benchmark::Case &given) {
    const auto           scene = scene::read_scene(given.file, given.overrides);
    const auto                 mesh  = mesh::make_mesh(scene, MPI_COMM_WORLD);
    const mechanics::Spaces<2> spaces(mesh, scene.discretization.degree);

    // The matrix of the first subdomain, held at unknowns chosen as SubdomainSystem does.
    const auto   constraints = interface::contact_constraints(scene, mesh, spaces, 1.);
    auto         matrices    = mechanics::assemble(scene, mesh, spaces, 1.);
    auto         last        = tfeti::LocalGluing::make(constraints.blocks[0]).second;
    const auto   fixing      = tfeti::fixing_unknowns(matrices[0].kernel, last).first;
    Matrix       A           = matrices[0].stiffness;
    const double rho         = A.diagonal().mean();
    for (const unsigned int i : fixing)
      A.coeffRef(i, i) += rho;
    compare_factorisations(A, last, given.repetitions);
    matrices.clear();
    compare_operators(scene, mesh, spaces, given.repetitions);
    return 0;
  });
}
