#include "assembled.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/interface/contact_constraints.h>
#include <slipstick/interface/contact_search.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/dofs/dof_tools.h>

#include <map>
#include <numeric>

namespace slipstick::random
{
  namespace
  {
    /// Number of every node of every subdomain among the nodes of the untorn bodies, body by body.
    struct Numbering
    {
      std::vector<std::vector<int>> of;    // subdomain, node there
      std::vector<int>              first; // node of every body, and their number
    };

    /// Nodes that gluing rows hold together get one number.
    Numbering number_nodes(const mesh::Mesh<2>                         &mesh,
                           const std::vector<tfeti::SubdomainMatrices> &matrices,
                           const tfeti::Constraints                    &constraints,
                           const unsigned int                           n_bodies)
    {
      std::vector<int> first(1, 0), parent;
      for (const auto &system : matrices)
        first.push_back(first.back() + system.load.size() / 2);
      parent.resize(first.back());
      std::iota(parent.begin(), parent.end(), 0);
      const auto root = [&parent](int i) {
        while (parent[i] != i)
          i = parent[i];
        return i;
      };
      std::map<unsigned int, int> seen; // gluing row, node
      for (unsigned int p = 0; p < matrices.size(); ++p)
        for (const auto &entry : constraints.blocks[p])
          if (constraints.kind[entry.row] == tfeti::RowKind::gluing)
            {
              const int node          = first[p] + entry.dof / 2;
              const auto [at, is_new] = seen.emplace(entry.row, node);
              if (!is_new)
                parent[root(node)] = root(at->second);
            }
      Numbering          numbering;
      std::map<int, int> number;
      numbering.of.resize(matrices.size());
      for (unsigned int b = 0; b < n_bodies; ++b)
        {
          numbering.first.push_back(number.size());
          for (unsigned int p = 0; p < matrices.size(); ++p)
            if (mesh.subdomains[p]->body == b)
              for (int i = first[p]; i < first[p + 1]; ++i)
                numbering.of[p].push_back(number.emplace(root(i), number.size()).first->second);
        }
      numbering.first.push_back(number.size());
      return numbering;
    }

    void add_bodies(const mesh::Mesh<2>                         &mesh,
                    const mechanics::Spaces<2>                  &spaces,
                    const std::vector<tfeti::SubdomainMatrices> &matrices,
                    const Numbering                             &numbering,
                    Problem                                     &problem)
    {
      const unsigned int n_bodies = numbering.first.size() - 1;
      problem.positions.resize(numbering.first.back());
      problem.f = Eigen::VectorXd::Zero(2 * numbering.first.back());
      for (unsigned int b = 0; b < n_bodies; ++b)
        {
          const int n = 2 * (numbering.first[b + 1] - numbering.first[b]);
          problem.bodies.push_back({2 * numbering.first[b], Eigen::MatrixXd::Zero(n, n)});
        }
      for (unsigned int p = 0; p < matrices.size(); ++p)
        {
          Body                         &body = problem.bodies[mesh.subdomains[p]->body];
          std::vector<dealii::Point<2>> x(spaces.dof_handlers[p]->n_dofs());
          dealii::DoFTools::map_dofs_to_support_points(*spaces.of(p).mapping, *spaces.dof_handlers[p], x);
          const auto unknown = [&](const int dof) { return 2 * numbering.of[p][dof / 2] + dof % 2; };
          for (unsigned int i = 0; i < x.size(); i += 2)
            problem.positions[numbering.of[p][i / 2]] = {x[i][0], x[i][1]};
          for (int i = 0; i < matrices[p].load.size(); ++i)
            problem.f[unknown(i)] += matrices[p].load[i];
          for (int column = 0; column < matrices[p].stiffness.outerSize(); ++column)
            for (Eigen::SparseMatrix<double>::InnerIterator entry(matrices[p].stiffness, column); entry; ++entry)
              {
                const int i = unknown(entry.row()) - body.first, j = unknown(entry.col()) - body.first;
                body.K(i, j) += entry.value();
                if (entry.row() != entry.col())
                  body.K(j, i) += entry.value();
              }
        }
      for (unsigned int b = 0; b < n_bodies; ++b)
        {
          Eigen::Vector2d low = problem.positions[numbering.first[b]], high = low;
          for (int i = numbering.first[b]; i < numbering.first[b + 1]; ++i)
            {
              low  = low.cwiseMin(problem.positions[i]);
              high = high.cwiseMax(problem.positions[i]);
            }
          problem.size = std::max(problem.size, (high - low).norm());
        }
    }

    /// b of every row of B, by unknown of the untorn bodies; gluing rows vanish.
    std::vector<std::vector<std::pair<int, double>>> coefficients(const tfeti::Constraints &constraints,
                                                                  const Numbering          &numbering)
    {
      std::vector<std::map<int, double>> sums(constraints.kind.size());
      for (unsigned int p = 0; p < constraints.blocks.size(); ++p)
        for (const auto &entry : constraints.blocks[p])
          sums[entry.row][2 * numbering.of[p][entry.dof / 2] + entry.dof % 2] += entry.value;
      std::vector<std::vector<std::pair<int, double>>> result;
      for (const auto &sum : sums)
        result.emplace_back(sum.begin(), sum.end());
      return result;
    }

    HeldDirection held_direction(const std::vector<std::pair<int, double>> &b, const double c, const double compliance)
    {
      HeldDirection held{b.at(0).first / 2, Eigen::Vector2d::Zero(), c, compliance > 0 ? 1 / compliance : 0.};
      for (const auto &[unknown, value] : b)
        {
          AssertThrow(unknown / 2 == held.node, dealii::ExcMessage("a support of more than one node"));
          held.direction[unknown % 2] = value;
        }
      return held;
    }
  } // namespace

  // Supports hold a contact node inside the other side when it is by more than this part of the largest body.
  constexpr double held_inside = 1e-6;

  Problem assembled(scene::Scene<2> scene, const MPI_Comm comm, const bool untorn)
  {
    constexpr double t = 1;
    if (untorn)
      scene.decomposition.method = scene::DecompositionMethod::none;
    const auto                 mesh = mesh::make_mesh(scene, comm);
    const mechanics::Spaces<2> spaces(mesh, scene.discretization.degree);
    interface::check_overlap(scene, mesh, spaces);
    interface::check_obstacle_pairs(scene, mesh, spaces);
    const auto  matrices    = mechanics::assemble(scene, mesh, spaces, t);
    const auto  all_rows    = interface::contact_rows(scene,
                                                  mesh,
                                                  spaces,
                                                  interface::pair_bodies(scene, mesh, spaces),
                                                  t,
                                                  std::numeric_limits<double>::infinity());
    const auto &constraints = all_rows.active;
    const auto  numbering   = number_nodes(mesh, matrices, constraints, scene.bodies.size());

    Problem problem;
    add_bodies(mesh, spaces, matrices, numbering, problem);
    const auto       b = coefficients(constraints, numbering);
    std::vector<int> number(b.size(), -1);
    for (unsigned int r = 0; r < b.size(); ++r)
      {
        const auto kind = constraints.kind[r];
        if (kind == tfeti::RowKind::gluing)
          continue;
        if (kind == tfeti::RowKind::prescribed)
          {
            const double compliance = constraints.compliance.empty() ? 0. : constraints.compliance[r];
            problem.held.push_back(held_direction(b[r], constraints.c[r], compliance));
            continue;
          }
        number[r] = problem.rows.size();
        Row row;
        row.kind = kind == tfeti::RowKind::bonded   ? RowKind::bond
                   : kind == tfeti::RowKind::normal ? RowKind::normal
                                                    : RowKind::tangential;
        row.b    = b[r];
        row.c    = constraints.c[r];
        problem.rows.push_back(row);
      }
    for (const auto *points : {&constraints.contact_points, &constraints.bonded_points})
      for (const auto &point : *points)
        {
          const auto  row_of = [&number](const unsigned int r) { return r == tfeti::invalid_row ? -1 : number[r]; };
          const auto &pair   = scene.contacts[point.pair];
          ContactNode node{point.pair,
                           {{point.position[0], point.position[1]}},
                           point.traction_area,
                           row_of(point.normal_row),
                           row_of(point.tangential_row)};
          const dealii::Point<2> x(point.position[0], point.position[1]);
          if (node.tangential >= 0 && pair.law.name == "Tresca")
            problem.rows[node.tangential].bound = pair.law.fixed->value.value(x, t) * point.area;
          if (node.tangential >= 0 && pair.law.name == "Coulomb")
            {
              problem.rows[node.tangential].mu     = node.normal >= 0 ? pair.law.coefficient->value.value(x, t) : -1.;
              problem.rows[node.tangential].normal = node.normal;
            }
          problem.nodes.push_back(node);
        }
    for (const auto &point : all_rows.held.points)
      {
        const auto &contact = point.contact;
        if (point.place == tfeti::invalid_row) // else it is there already
          problem.nodes.push_back({contact.pair, {{contact.position[0], contact.position[1]}}, contact.traction_area});
        if (!point.is_bonded && point.is_known && point.closing - contact.gap > held_inside * problem.size)
          problem.is_held_inside = true;
      }
    return problem;
  }
} // namespace slipstick::random
