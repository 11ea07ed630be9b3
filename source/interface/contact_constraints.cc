#include <slipstick/interface/contact_constraints.h>
#include <slipstick/interface/row_builder.h>

#include <slipstick/base/collective.h>
#include <slipstick/base/numbering.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

#include <cmath>

namespace slipstick::interface
{
  namespace
  {
    // Contact nodes keep their rows if their gap exceeds the smallest one by less than this many mesh sizes.
    constexpr double mesh_sizes = 2;

    tfeti::Partitioner make_partitioner(const std::uint64_t                           first,
                                        const std::uint64_t                           n_owned,
                                        const std::uint64_t                           n_total,
                                        std::vector<dealii::types::global_dof_index> &touched,
                                        const MPI_Comm                                comm)
    {
      dealii::IndexSet owned(n_total), ghosts(n_total);
      owned.add_range(first, first + n_owned);
      if (n_total == 0) // with several ranks, deal.II 9.4 divides by it
        return std::make_shared<dealii::Utilities::MPI::Partitioner>(owned, comm);
      std::sort(touched.begin(), touched.end());
      touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
      ghosts.add_indices(touched.begin(), touched.end());
      ghosts.subtract_set(owned);
      return std::make_shared<dealii::Utilities::MPI::Partitioner>(owned, ghosts, comm);
    }

    /// Sends every entry to the rank of its subdomain and numbers rows and interface unknowns there.
    template <int dim>
    void distribute(const mesh::Mesh<dim>       &mesh,
                    const std::vector<RowEntry> &messages,
                    const std::uint64_t          n_interface,
                    tfeti::Constraints          &constraints)
    {
      const auto [first_row, n_rows]         = first_and_total(constraints.kind.size(), mesh.comm);
      const auto [first_unknown, n_unknowns] = first_and_total(n_interface, mesh.comm);
      std::map<unsigned int, std::vector<RowEntry>> to_send;
      for (RowEntry message : messages)
        {
          message.index += message.is_row ? first_row : first_unknown;
          to_send[mesh.rank_of_subdomain(message.subdomain)].push_back(message);
        }
      const auto received = dealii::Utilities::MPI::some_to_some(mesh.comm, to_send);

      std::vector<dealii::types::global_dof_index> touched_rows, touched_unknowns;
      for (const auto &[rank, list] : received)
        for (const auto &message : list)
          (message.is_row ? touched_rows : touched_unknowns).push_back(message.index);
      constraints.rows = make_partitioner(first_row, constraints.kind.size(), n_rows, touched_rows, mesh.comm);
      constraints.interface_dofs =
        make_partitioner(first_unknown, n_interface, n_unknowns, touched_unknowns, mesh.comm);

      constraints.blocks.resize(mesh.subdomains.size());
      constraints.interface_blocks.resize(mesh.subdomains.size());
      const unsigned int first_subdomain = mesh.first_subdomain[dealii::Utilities::MPI::this_mpi_process(mesh.comm)];
      for (const auto &[rank, list] : received)
        for (const auto &message : list)
          {
            const unsigned int p = message.subdomain - first_subdomain;
            if (message.is_row)
              constraints.blocks[p].push_back(
                {constraints.rows->global_to_local(message.index), message.dof, message.value});
            else
              constraints.interface_blocks[p].push_back(
                {message.dof, constraints.interface_dofs->global_to_local(message.index)});
          }
      for (auto &block : constraints.blocks)
        std::sort(block.begin(), block.end(), [](const auto &a, const auto &b) {
          return std::tie(a.row, a.dof) < std::tie(b.row, b.dof);
        });
    }

    tfeti::Constraints::Counts sum(tfeti::Constraints::Counts counts, const MPI_Comm comm)
    {
      for (unsigned long long *n :
           {&counts.tangential, &counts.normal, &counts.gluing, &counts.prescribed, &counts.candidates})
        *n = dealii::Utilities::MPI::sum(*n, comm);
      return counts;
    }
  } // namespace

  template <int dim>
  ContactRows contact_rows(const scene::Scene<dim>      &scene,
                           const mesh::Mesh<dim>        &mesh,
                           const mechanics::Spaces<dim> &spaces,
                           const BodyContacts<dim>      &contacts,
                           const double                  t,
                           const double                  part)
  {
    const auto              nodes = interface_nodes(scene, mesh, spaces, contacts, t);
    ContactRows             rows;
    RowBuilder<dim>         builder(scene, nodes, contacts, t, rows.active);
    std::vector<PairExtent> extents(scene.contacts.size());
    collectively(mesh.comm, [&] { extents = builder.extents(); });
    std::vector<double> limits;
    for (const auto &own : extents)
      {
        const double gap = dealii::Utilities::MPI::min(own.gap, mesh.comm);
        // along the boundary; in space the root of the area
        const double length  = std::pow(dealii::Utilities::MPI::sum(own.length, mesh.comm), 1. / (dim - 1));
        const double n_nodes = std::pow(double(dealii::Utilities::MPI::sum(own.n_nodes, mesh.comm)), 1. / (dim - 1));
        limits.push_back(n_nodes > 0 ? gap + std::max(part * length, mesh_sizes * length / n_nodes) : 0.);
      }
    builder.limit_gaps(limits);
    collectively(mesh.comm, [&] { builder.build(); });
    distribute(mesh, builder.entries, builder.n_interface, rows.active);
    rows.active.counts = sum(rows.active.counts, mesh.comm);
    rows.pruned        = std::move(builder.pruned);
    distribute(mesh, builder.pruned_entries, 0, rows.pruned);
    rows.held = std::move(builder.held);
    distribute(mesh, builder.held_entries, 0, rows.held.gaps);
    return rows;
  }

  template <int dim>
  tfeti::Constraints contact_constraints(const scene::Scene<dim>      &scene,
                                         const mesh::Mesh<dim>        &mesh,
                                         const mechanics::Spaces<dim> &spaces,
                                         const double                  t)
  {
    const auto contacts = pair_bodies(scene, mesh, spaces);
    return contact_rows(scene, mesh, spaces, contacts, t, std::numeric_limits<double>::infinity()).active;
  }

  double largest_penetration(const tfeti::Constraints           &pruned,
                             const std::vector<Eigen::VectorXd> &u,
                             const MPI_Comm                      comm)
  {
    if (pruned.rows->size() == 0)
      return 0;
    tfeti::DistributedVector closing(pruned.rows);
    for (unsigned int p = 0; p < u.size(); ++p)
      for (const auto &entry : pruned.blocks[p])
        closing.local_element(entry.row) += entry.value * u[p][entry.dof];
    closing.compress(dealii::VectorOperation::add);
    double largest = 0;
    for (unsigned int r = 0; r < pruned.c.size(); ++r)
      largest = std::max(largest, closing.local_element(r) - pruned.c[r]);
    return dealii::Utilities::MPI::max(largest, comm);
  }

  template ContactRows        contact_rows(const scene::Scene<2> &,
                                           const mesh::Mesh<2> &,
                                           const mechanics::Spaces<2> &,
                                           const BodyContacts<2> &,
                                           const double,
                                           const double);
  template tfeti::Constraints contact_constraints(const scene::Scene<2> &,
                                                  const mesh::Mesh<2> &,
                                                  const mechanics::Spaces<2> &,
                                                  const double);
  template ContactRows        contact_rows(const scene::Scene<3> &,
                                           const mesh::Mesh<3> &,
                                           const mechanics::Spaces<3> &,
                                           const BodyContacts<3> &,
                                           const double,
                                           const double);
  template tfeti::Constraints contact_constraints(const scene::Scene<3> &,
                                                  const mesh::Mesh<3> &,
                                                  const mechanics::Spaces<3> &,
                                                  const double);
} // namespace slipstick::interface
