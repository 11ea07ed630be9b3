// benchmark_bandwidth CASE.prm [REPETITIONS] [--set Section/Name=value]...: one multiplication with the explicit F against
// the time to read its blocks once. All ranks at the same time; in every repetition the product, then a plain sum over a
// buffer as large as the rank's blocks, so that both see the same machine. Ratio of the medians and of the least times;
// prints Markdown. Status 1 when the ratio of the medians is above the limit.
#include "common.h"

#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/scene/read.h>
#include <slipstick/tfeti/dual_operator.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>

namespace
{
  using namespace slipstick;
  using benchmark::median;
  using benchmark::seconds;

  constexpr double limit = 1.5; // of one multiplication over reading its data

  /// Reads all of it once; independent sums, so that memory and not the latency of the addition is the limit.
  double sum(const std::vector<double> &buffer)
  {
    std::array<double, 32> sums{};
    for (std::size_t i = 0; i + sums.size() <= buffer.size(); i += sums.size())
      for (std::size_t k = 0; k < sums.size(); ++k)
        sums[k] += buffer[i + k];
    double total = 0;
    for (const double s : sums)
      total += s;
    return total;
  }

  int run(const std::string &file, const std::vector<std::string> &overrides, const unsigned int repetitions)
  {
    const MPI_Comm       comm  = MPI_COMM_WORLD;
    const auto           scene = scene::read_scene(file, overrides);
    const auto                 mesh  = mesh::make_mesh(scene, comm);
    const mechanics::Spaces<2> spaces(mesh, scene.discretization.degree);
    const auto                 constraints = interface::contact_constraints(scene, mesh, spaces, 1.);
    auto                       matrices    = mechanics::assemble(scene, mesh, spaces, 1.);

    const auto                                           session = std::make_shared<tfeti::CholmodSession>();
    std::vector<std::unique_ptr<tfeti::SubdomainSystem>> systems;
    std::vector<tfeti::LocalGluing>                      gluing;
    std::vector<tfeti::PackedSymmetric>                  blocks;
    for (unsigned int p = 0; p < matrices.size(); ++p)
      {
        auto [local, touched] = tfeti::LocalGluing::make(constraints.blocks[p]);
        gluing.push_back(std::move(local));
        systems.push_back(
          std::make_unique<tfeti::SubdomainSystem>(session, std::move(matrices[p]), std::move(touched), true));
        blocks.push_back(systems.back()->pseudo_inverse_block(tfeti::Precision::double_precision));
      }
    std::size_t own_bytes = 0; // without what fills up panels
    for (const auto &block : blocks)
      own_bytes += static_cast<std::size_t>(block.n_rows()) * (block.n_rows() + 1) / 2 * sizeof(double);
    const tfeti::DualOperator F(systems, gluing, constraints.rows, &blocks);
    std::vector<double>       buffer(own_bytes / sizeof(double), 1.);

    tfeti::DistributedVector x(constraints.rows), y(constraints.rows);
    for (unsigned int r = 0; r < x.locally_owned_size(); ++r)
      x.local_element(r) = std::sin(1. + r);
    std::vector<double> product_times, read_times;
    double              checksum = 0;
    for (unsigned int k = 0; k < repetitions + 1; ++k)
      {
        const double product = seconds(comm, [&] { F.apply(x, y); });
        const double reading = seconds(comm, [&] { checksum += sum(buffer); });
        if (k == 0) // first touch
          continue;
        product_times.push_back(product);
        read_times.push_back(reading);
      }
    const double bytes    = dealii::Utilities::MPI::sum(static_cast<double>(own_bytes), comm);
    const double expected = dealii::Utilities::MPI::sum(static_cast<double>(buffer.size()), comm);
    checksum              = dealii::Utilities::MPI::sum(checksum, comm) / (repetitions + 1);
    if (std::abs(checksum / expected - 1) > 1e-4)
      throw std::runtime_error("the buffer was not read");
    const double ratio = median(product_times) / median(read_times);
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      {
        double load[1] = {0};
        getloadavg(load, 1);
        const auto least = [](const std::vector<double> &values) {
          return *std::min_element(values.begin(), values.end());
        };
        std::printf(
          "| subdomains | ranks | blocks MB | F x ms: median | least | reading ms: median | least | GB/s | ratio: "
          "medians | least | load |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
        std::printf("| %u | %u | %.1f | %.3f | %.3f | %.3f | %.3f | %.1f | %.2f | %.2f | %.1f |\n",
                    mesh.n_subdomains(),
                    dealii::Utilities::MPI::n_mpi_processes(comm),
                    bytes / 1e6,
                    1e3 * median(product_times),
                    1e3 * least(product_times),
                    1e3 * median(read_times),
                    1e3 * least(read_times),
                    bytes / 1e9 / median(read_times),
                    ratio,
                    least(product_times) / least(read_times),
                    load[0]);
        std::printf("\n- F-multiplication over reading its data: %.2f, asked at most %.1f: %s %.2f\n",
                    ratio,
                    limit,
                    ratio <= limit ? "met by" : "MISSED by",
                    std::abs(ratio - limit));
      }
    return ratio <= limit ? 0 : 1;
  }
} // namespace

int main(int argc, char **argv)
{
  return benchmark::main_of("benchmark_bandwidth", argc, argv, 51, [](const benchmark::Case &given) {
    return run(given.file, given.overrides, given.repetitions);
  });
}
