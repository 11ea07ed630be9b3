#include <slipstick/fem/contact_constraints.h>
#include <slipstick/fem/interface_nodes.h>
#include <slipstick/fem/obstacle.h>

#include <slipstick/base/collective.h>
#include <slipstick/base/numbering.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

namespace slipstick::fem
{
  namespace
  {
    // A direction whose free part is shorter than this is held by the support.
    constexpr double held_direction_tolerance = 1e-8;

    /// What a subdomain is told of rows and interface unknowns; numbers are global.
    struct Message
    {
      std::uint64_t index; // row or interface unknown
      unsigned int  subdomain;
      unsigned int  dof;
      double        value;
      bool          is_row;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &index &subdomain &dof &value &is_row;
      }
    };

    /// Rows of the nodes that this rank owns; indices are owned ones until they are shifted.
    template <int dim>
    class RowBuilder
    {
    public:
      RowBuilder(const scene::Scene<dim> &scene, tfeti::Constraints &constraints)
        : scene(scene)
        , constraints(constraints)
      {}

      void add(const InterfaceNode<dim> &node)
      {
        for (const auto &[pair, area] : node.areas)
          add_contact(node, pair, area);
        for (unsigned int c = 0; c < dim; ++c)
          if (node.held >> c & 1u)
            {
              entry(new_row(tfeti::RowKind::prescribed, node.prescribed[c], node, c), node.copies[0], c, 1.);
              ++constraints.counts.prescribed;
            }
        for (unsigned int k = 0; k + 1 < node.copies.size(); ++k)
          for (unsigned int c = 0; c < dim; ++c)
            {
              const unsigned int row = new_row(tfeti::RowKind::gluing, 0., node, k * dim + c);
              entry(row, node.copies[k], c, 1.);
              entry(row, node.copies[k + 1], c, -1.);
              ++constraints.counts.gluing;
            }
        for (unsigned int c = 0; c < dim; ++c)
          {
            for (const auto &copy : node.copies)
              messages.push_back({n_interface, copy.first, copy.second * dim + c, 1., false});
            constraints.interface_held.push_back(node.held != 0 || !node.areas.empty());
            ++n_interface;
          }
      }

      std::vector<Message> messages;
      std::uint64_t        n_interface = 0;

    private:
      unsigned int new_row(const tfeti::RowKind      kind,
                           const double              c,
                           const InterfaceNode<dim> &node,
                           const unsigned int        which)
      {
        constraints.kind.push_back(kind);
        constraints.c.push_back(c);
        std::uint64_t label = 1469598103934665603ull; // FNV-1a over what names the row
        for (const std::uint64_t part : {node.key[0], node.key[1], std::uint64_t(kind), std::uint64_t(which)})
          label = (label ^ part) * 1099511628211ull;
        constraints.label.push_back(label);
        return constraints.kind.size() - 1;
      }

      void entry(const unsigned int                           row,
                 const std::pair<unsigned int, unsigned int> &copy,
                 const unsigned int                           c,
                 const double                                 value)
      {
        messages.push_back({row, copy.first, copy.second * dim + c, value, true});
      }

      unsigned int contact_row(const tfeti::RowKind          kind,
                               const double                  c,
                               const InterfaceNode<dim>     &node,
                               const unsigned int            pair,
                               const dealii::Tensor<1, dim> &direction)
      {
        const unsigned int row = new_row(kind, c, node, pair);
        for (unsigned int d = 0; d < dim; ++d)
          if (direction[d] != 0)
            entry(row, node.copies[0], d, direction[d]);
        return row;
      }

      void add_contact(const InterfaceNode<dim> &node, const unsigned int pair, const double area)
      {
        static_assert(dim == 2, "one tangent: two dimensions");
        const auto             contact = contact_with(scene.obstacles[scene.contacts[pair].obstacle], node.point());
        dealii::Tensor<1, dim> tangent;
        tangent[0] = -contact.normal[1];
        tangent[1] = contact.normal[0];

        // a held component leaves one free direction: then the normal row, or the tangential one if that is all there is
        const bool free_normal  = free_part(contact.normal, node.held) > held_direction_tolerance;
        const bool free_tangent = free_part(tangent, node.held) > held_direction_tolerance;
        const bool has_normal   = free_normal;
        const bool has_tangent  = free_tangent && (node.held == 0 || !free_normal) &&
                                 scene.contacts[pair].law != scene::ContactLaw::frictionless;
        if (!has_normal && !has_tangent)
          return;

        tfeti::ContactPoint point;
        point.pair = pair;
        for (unsigned int d = 0; d < dim; ++d)
          {
            point.position[d] = node.position[d];
            point.normal[d]   = contact.normal[d];
          }
        point.key           = node.key;
        point.gap           = contact.gap;
        point.area          = area;
        point.length        = area / scene.bodies[node.body].thickness;
        point.interface_dof = n_interface;
        if (has_tangent)
          {
            point.tangential_row = contact_row(tfeti::RowKind::tangential, 0., node, pair, tangent);
            ++constraints.counts.tangential;
          }
        if (has_normal)
          {
            point.normal_row = contact_row(tfeti::RowKind::normal, contact.gap, node, pair, contact.normal);
            ++constraints.counts.normal;
          }
        ++constraints.counts.candidates;
        constraints.contact_points.push_back(point);
      }

      static double free_part(const dealii::Tensor<1, dim> &direction, const unsigned int held)
      {
        double squares = 0;
        for (unsigned int c = 0; c < dim; ++c)
          if (!(held >> c & 1u))
            squares += direction[c] * direction[c];
        return std::sqrt(squares);
      }

      const scene::Scene<dim> &scene;
      tfeti::Constraints      &constraints;
    };

    tfeti::Partitioner make_partitioner(const std::uint64_t                           first,
                                        const std::uint64_t                           n_owned,
                                        const std::uint64_t                           n_total,
                                        std::vector<dealii::types::global_dof_index> &touched,
                                        const MPI_Comm                                comm)
    {
      dealii::IndexSet owned(n_total), ghosts(n_total);
      owned.add_range(first, first + n_owned);
      if (n_total == 0) // deal.II 9.4 divides by it when there are several ranks
        return std::make_shared<dealii::Utilities::MPI::Partitioner>(owned, comm);
      std::sort(touched.begin(), touched.end());
      touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
      ghosts.add_indices(touched.begin(), touched.end());
      ghosts.subtract_set(owned);
      return std::make_shared<dealii::Utilities::MPI::Partitioner>(owned, ghosts, comm);
    }

    /// Sends every entry to the rank of its subdomain and numbers rows and interface unknowns there.
    template <int dim>
    void distribute(const Mesh<dim>            &mesh,
                    const std::vector<Message> &messages,
                    const std::uint64_t         n_interface,
                    tfeti::Constraints         &constraints)
    {
      const auto [first_row, n_rows]         = first_and_total(constraints.kind.size(), mesh.comm);
      const auto [first_unknown, n_unknowns] = first_and_total(n_interface, mesh.comm);
      std::map<unsigned int, std::vector<Message>> to_send;
      for (Message message : messages)
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
  tfeti::Constraints contact_constraints(const scene::Scene<dim> &scene,
                                         const Mesh<dim>         &mesh,
                                         const Spaces<dim>       &spaces,
                                         const double             t)
  {
    const auto         nodes = interface_nodes(scene, mesh, spaces, t);
    tfeti::Constraints constraints;
    RowBuilder<dim>    builder(scene, constraints);
    collectively(mesh.comm, [&] {
      for (const auto &node : nodes)
        builder.add(node);
    });
    distribute(mesh, builder.messages, builder.n_interface, constraints);
    constraints.counts = sum(constraints.counts, mesh.comm);
    return constraints;
  }

  template tfeti::Constraints contact_constraints(const scene::Scene<2> &,
                                                  const Mesh<2> &,
                                                  const Spaces<2> &,
                                                  const double);
} // namespace slipstick::fem
