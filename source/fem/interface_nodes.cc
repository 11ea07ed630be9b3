#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/fem/interface_nodes.h>

#include <deal.II/base/mpi.h>
#include <deal.II/fe/fe_values.h>

#include <cmath>

namespace slipstick::fem
{
  namespace
  {
    // Two supports agree on a component when their values differ by less than this part of the larger.
    constexpr double same_value_tolerance = 1e-12;

    template <int dim>
    using NodesOfSubdomain = std::map<unsigned int, InterfaceNode<dim>>; // by node number

    template <int dim>
    void merge_support(InterfaceNode<dim> &node, const unsigned int c, const double value)
    {
      if (node.held >> c & 1u && std::abs(node.prescribed[c] - value) >
                                   same_value_tolerance * std::max(std::abs(value), std::abs(node.prescribed[c])))
        throw InputError(format("supports prescribe both %g and %g for displacement %c at (%g, %g)",
                                node.prescribed[c],
                                value,
                                "xyz"[c],
                                node.position[0],
                                node.position[1]),
                         "free that component in one of the supports, or make the values agree where boundaries meet");
      node.held |= 1u << c;
      node.prescribed[c] = value;
    }

    /// What supports and contact pairs say about the nodes of one boundary face.
    template <int dim>
    void add_face(const scene::Scene<dim>                                      &scene,
                  const Mesh<dim>                                              &mesh,
                  const SubdomainMesh<dim>                                     &subdomain,
                  const Spaces<dim>                                            &spaces,
                  const Element<dim>                                           &element,
                  const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                  const unsigned int                                            f,
                  const double                                                  t,
                  dealii::FEFaceValues<dim>                                    &values,
                  NodesOfSubdomain<dim>                                        &nodes)
    {
      const auto                                   face = cell->face(f);
      std::vector<unsigned int>                    on_face, on_cell;
      std::vector<dealii::types::global_dof_index> dofs;
      spaces.for_each_face_node(subdomain,
                                face,
                                [&](const unsigned int node, const NodeKey &key, const dealii::Point<dim> &x) {
                                  InterfaceNode<dim> &entry = nodes[node];
                                  entry.key                 = key;
                                  entry.body                = subdomain.body;
                                  entry.copies              = {{subdomain.subdomain, node}};
                                  for (unsigned int d = 0; d < dim; ++d)
                                    entry.position[d] = x[d];
                                  on_face.push_back(node);
                                });
      if (face->boundary_id() == cut_id)
        return;

      const auto  here  = [&](const scene::BoundaryName &where) {
        return where.body == subdomain.body && mesh.on_boundary(where, face->boundary_id());
      };
      for (const auto &support : scene.supports)
        if (here(support.where))
          for (const unsigned int node : on_face)
            for (unsigned int c = 0; c < dim; ++c)
              if (support.components[c])
                merge_support(nodes[node], c, support.components[c]->value(nodes[node].point(), t));

      for (unsigned int k = 0; k < scene.contacts.size(); ++k)
        if (here(scene.contacts[k].slave))
          {
            values.reinit(typename dealii::Triangulation<dim>::cell_iterator(cell), f);
            element.nodes_of(cell, dofs, on_cell);
            for (unsigned int i = 0; i < on_face.size(); ++i)
              {
                const unsigned int local = std::find(on_cell.begin(), on_cell.end(), on_face[i]) - on_cell.begin();
                double             area  = 0;
                for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
                  area += values.shape_value(local, q) * values.JxW(q);
                area *= scene.bodies[subdomain.body].thickness;
                auto &areas = nodes[on_face[i]].areas;
                if (areas.empty() || areas.back().first != k)
                  areas.emplace_back(k, 0.);
                areas.back().second += area;
              }
          }
    }

    template <int dim>
    NodesOfSubdomain<dim> boundary_nodes(const scene::Scene<dim> &scene,
                                         const Mesh<dim>         &mesh,
                                         const Spaces<dim>       &spaces,
                                         const unsigned int       p,
                                         const double             t)
    {
      NodesOfSubdomain<dim>     nodes;
      const Element<dim>       &element = spaces.of(p);
      dealii::FEFaceValues<dim> values(*element.mapping,
                                       *element.scalar,
                                       element.face_quadrature(spaces.degree + 1),
                                       dealii::update_values | dealii::update_JxW_values);
      for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary())
            add_face(scene, mesh, *mesh.subdomains[p], spaces, element, cell, f, t, values, nodes);
      return nodes;
    }

    template <int dim>
    void merge(InterfaceNode<dim> &node, const InterfaceNode<dim> &other)
    {
      node.copies.insert(node.copies.end(), other.copies.begin(), other.copies.end());
      for (unsigned int c = 0; c < dim; ++c)
        if (other.held >> c & 1u)
          merge_support(node, c, other.prescribed[c]);
      for (const auto &[pair, area] : other.areas)
        {
          auto found =
            std::find_if(node.areas.begin(), node.areas.end(), [p = pair](const auto &a) { return a.first == p; });
          if (found == node.areas.end())
            node.areas.emplace_back(pair, area);
          else
            found->second += area;
        }
      std::sort(node.areas.begin(), node.areas.end());
    }

    template <int dim>
    bool by_key_and_copy(const InterfaceNode<dim> &a, const InterfaceNode<dim> &b)
    {
      return std::tie(a.key, a.copies) < std::tie(b.key, b.copies);
    }

    /// Merges neighbours with equal keys in a sorted list.
    template <int dim>
    void merge_copies(std::vector<InterfaceNode<dim>> &nodes)
    {
      std::sort(nodes.begin(), nodes.end(), by_key_and_copy<dim>);
      std::vector<InterfaceNode<dim>> merged;
      for (auto &node : nodes)
        if (!merged.empty() && merged.back().key == node.key)
          merge(merged.back(), node);
        else
          merged.push_back(std::move(node));
      nodes = std::move(merged);
    }

    template <class T>
    std::vector<T> send_and_receive(const MPI_Comm comm, const std::map<unsigned int, std::vector<T>> &to_send)
    {
      std::vector<T> all;
      for (auto &[rank, received] : dealii::Utilities::MPI::some_to_some(comm, to_send))
        std::move(received.begin(), received.end(), std::back_inserter(all));
      return all;
    }
  } // namespace

  template <int dim>
  std::vector<InterfaceNode<dim>> interface_nodes(const scene::Scene<dim> &scene,
                                                  const Mesh<dim>         &mesh,
                                                  const Spaces<dim>       &spaces,
                                                  const double             t)
  {
    const unsigned int                                      n_ranks = mesh.first_subdomain.size() - 1;
    std::map<unsigned int, std::vector<InterfaceNode<dim>>> to_meet;
    collectively(mesh.comm, [&] {
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        for (auto &[number, node] : boundary_nodes(scene, mesh, spaces, p, t))
          to_meet[(node.key[0] + node.key[1]) % n_ranks].push_back(std::move(node));
    });
    auto met = send_and_receive(mesh.comm, to_meet);
    to_meet.clear();
    std::map<unsigned int, std::vector<InterfaceNode<dim>>> to_owner;
    collectively(mesh.comm, [&] {
      merge_copies(met);
      for (auto &node : met)
        if (node.copies.size() > 1 || node.held != 0 || !node.areas.empty())
          to_owner[mesh.rank_of_subdomain(node.copies.front().first)].push_back(std::move(node));
    });
    auto owned = send_and_receive(mesh.comm, to_owner);
    std::sort(owned.begin(), owned.end(), by_key_and_copy<dim>);
    return owned;
  }

  template struct InterfaceNode<2>;
  template std::vector<InterfaceNode<2>> interface_nodes(const scene::Scene<2> &,
                                                         const Mesh<2> &,
                                                         const Spaces<2> &,
                                                         const double);
} // namespace slipstick::fem
