#include <slipstick/base/collective.h>
#include <slipstick/interface/interface_nodes.h>
#include <slipstick/interface/nodal_conditions.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/mechanics/face_shares.h>
#include <slipstick/mechanics/points.h>

#include <deal.II/base/mpi.h>

#include <cmath>

namespace slipstick::interface
{
  namespace
  {
    // Keys of nodes inside a subdomain start here, far above the vertices.
    constexpr mesh::GlobalVertex inside_key = mesh::GlobalVertex(1) << 63;

    template <int dim>
    using NodesOfSubdomain = std::map<unsigned int, InterfaceNode<dim>>; // by node number

    template <int dim>
    dealii::Tensor<1, dim> axis(const unsigned int c)
    {
      dealii::Tensor<1, dim> e;
      e[c] = 1;
      return e;
    }

    /// Adds to the tributary area of a node in the pair.
    template <int dim>
    void add_area(InterfaceNode<dim> &node, const unsigned int pair, const Tributary &area)
    {
      const auto found =
        std::find_if(node.areas.begin(), node.areas.end(), [pair](const auto &a) { return a.first == pair; });
      if (found == node.areas.end())
        node.areas.emplace_back(pair, area);
      else
        found->second += area;
    }

    double mean_of(const std::vector<Tributary> &areas)
    {
      double sum = 0;
      for (const auto &area : areas)
        sum += area.area;
      return sum / areas.size();
    }

    /// Adds the conditions of supports, foundations and obstacles to the nodes of one boundary face.
    template <int dim>
    void add_face(const scene::Scene<dim>                                      &scene,
                  const mesh::Mesh<dim>                                        &mesh,
                  const mesh::SubdomainMesh<dim>                               &subdomain,
                  const mechanics::Spaces<dim>                                 &spaces,
                  const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                  const unsigned int                                            f,
                  const double                                                  t,
                  NodesOfSubdomain<dim>                                        &nodes)
    {
      const auto                        face = cell->face(f);
      std::vector<InterfaceNode<dim> *> on_face;
      spaces.for_each_face_node(subdomain,
                                face,
                                [&](const unsigned int        node,
                                    const mechanics::NodeKey &key,
                                    const dealii::Point<dim> &x) {
                                  InterfaceNode<dim> &entry = nodes[node];
                                  entry.key                 = key;
                                  entry.body                = subdomain.body;
                                  entry.copies              = {{subdomain.subdomain, node}};
                                  for (unsigned int d = 0; d < dim; ++d)
                                    entry.position[d] = x[d];
                                  on_face.push_back(&entry);
                                });
      const mesh::Kinematics<dim> kinematics(scene.plane_state);
      for (auto *node : on_face)
        if (kinematics.is_on_axis(node->point(), face->vertex(0).distance(face->vertex(1))))
          hold(*node,
               axis<dim>(0),
               0.,
               0,
               {static_cast<unsigned int>(scene.supports.size() + scene.foundations.size() + scene.contacts.size())});
      if (face->boundary_id() == mesh::cut_id)
        return;
      const auto here = [&](const scene::BoundaryName &where) {
        return where.body == subdomain.body && mesh.on_boundary(where, face->boundary_id());
      };

      const auto             shares = mechanics::face_shares(subdomain, spaces, cell, f, kinematics);
      std::vector<Tributary> areas(on_face.size());
      std::vector<typename InterfaceNode<dim>::Side> sides(on_face.size());
      for (unsigned int i = 0; i < on_face.size(); ++i)
        {
          areas[i]      = {shares[i].measure * scene.bodies[subdomain.body].thickness, shares[i].length};
          sides[i].area = areas[i].area;
          for (unsigned int d = 0; d < dim; ++d)
            sides[i].normal[d] = shares[i].normal[d];
        }
      const auto add_sides = [&](const unsigned int condition) {
        for (unsigned int i = 0; i < on_face.size(); ++i)
          {
            sides[i].condition = condition;
            on_face[i]->sides.push_back(sides[i]);
          }
      };

      for (unsigned int s = 0; s < scene.supports.size(); ++s)
        if (const auto &support = scene.supports[s]; !support.point && here(support.where))
          {
            for (auto *node : on_face)
              for (unsigned int c = 0; c < dim; ++c)
                if (support.components[c])
                  hold(*node, axis<dim>(c), support.components[c]->value(node->point(), t), c, {s});
            if (support.normal)
              add_sides(s);
          }
      for (unsigned int s = 0; s < scene.foundations.size(); ++s)
        if (here(scene.foundations[s].where))
          add_sides(scene.supports.size() + s);

      for (unsigned int k = 0; k < scene.contacts.size(); ++k)
        if (const auto &pair = scene.contacts[k]; !pair.master && here(pair.slave))
          for (unsigned int i = 0; i < on_face.size(); ++i)
            // a bond also acts at nodes where a uniform pressure has no nodal force; their tractions need an area
            add_area(*on_face[i],
                     k,
                     pair.law.is_bonded && areas[i].area == 0 ? Tributary{mean_of(areas), 0.} : areas[i]);
    }

    /// A copy of the node of every point support; entries of supports on boundaries are unused. Collective.
    template <int dim>
    std::vector<mechanics::PointNode<dim>> held_points(const scene::Scene<dim>      &scene,
                                                       const mesh::Mesh<dim>        &mesh,
                                                       const mechanics::Spaces<dim> &spaces)
    {
      std::vector<scene::PointName<dim>> points;
      std::vector<std::string>           names;
      for (const auto &support : scene.supports)
        if (support.point)
          {
            points.push_back(*support.point);
            names.push_back("Support " + support.name);
            if (!support.point->point.empty())
              points.back().coordinates = mesh.points[support.point->body].at(support.point->point).position;
          }
      const auto                             found = mechanics::nodes_at(scene, mesh, spaces, points, names);
      std::vector<mechanics::PointNode<dim>> of_support(scene.supports.size());
      for (unsigned int s = 0, k = 0; s < scene.supports.size(); ++s)
        if (scene.supports[s].point)
          of_support[s] = found[k++];
      return of_support;
    }

    /// Adds the conditions of point supports to one copy of their node.
    template <int dim>
    void add_points(const scene::Scene<dim>                      &scene,
                    const mesh::SubdomainMesh<dim>               &subdomain,
                    const std::vector<mechanics::PointNode<dim>> &points,
                    const double                                  t,
                    NodesOfSubdomain<dim>                        &nodes)
    {
      for (unsigned int s = 0; s < scene.supports.size(); ++s)
        if (const auto &support = scene.supports[s]; support.point && points[s].subdomain == subdomain.subdomain)
          {
            const auto [entry, is_inside] = nodes.emplace(points[s].node, InterfaceNode<dim>());
            auto &node                    = entry->second;
            if (is_inside) // on no face of a boundary or a cut: one copy, no key made of vertices
              {
                node.key    = {{inside_key + subdomain.subdomain, points[s].node}};
                node.body   = subdomain.body;
                node.copies = {{subdomain.subdomain, points[s].node}};
                for (unsigned int d = 0; d < dim; ++d)
                  node.position[d] = points[s].position[d];
              }
            for (unsigned int c = 0; c < dim; ++c)
              if (support.components[c])
                hold(node, axis<dim>(c), support.components[c]->value(node.point(), t), c, {s});
          }
    }

    template <int dim>
    NodesOfSubdomain<dim> boundary_nodes(const scene::Scene<dim>                      &scene,
                                         const mesh::Mesh<dim>                        &mesh,
                                         const mechanics::Spaces<dim>                 &spaces,
                                         const std::vector<mechanics::PointNode<dim>> &points,
                                         const unsigned int                            p,
                                         const double                                  t)
    {
      NodesOfSubdomain<dim> nodes;
      for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary())
            add_face(scene, mesh, *mesh.subdomains[p], spaces, cell, f, t, nodes);
      add_points(scene, *mesh.subdomains[p], points, t, nodes);
      return nodes;
    }

    template <int dim>
    void merge(InterfaceNode<dim> &node, const InterfaceNode<dim> &other)
    {
      node.copies.insert(node.copies.end(), other.copies.begin(), other.copies.end());
      for (const auto &held : other.held)
        {
          dealii::Tensor<1, dim> direction;
          for (unsigned int d = 0; d < dim; ++d)
            direction[d] = held.direction[d];
          hold(node, direction, held.value, held.which, held.by);
        }
      node.sides.insert(node.sides.end(), other.sides.begin(), other.sides.end());
      for (const auto &[pair, area] : other.areas)
        add_area(node, pair, area);
      std::sort(node.areas.begin(), node.areas.end());
    }

    /// Bonds to an obstacle hold all components.
    template <int dim>
    void hold_bonds(InterfaceNode<dim> &node, const scene::Scene<dim> &scene, const double t)
    {
      for (const auto &[k, area] : node.areas)
        if (const auto &pair = scene.contacts[k];
            pair.law.is_bonded &&
            !(pair.reach && contact_with(scene.obstacles[pair.obstacle], node.point(), t).gap > *pair.reach))
          for (unsigned int c = 0; c < dim; ++c)
            hold(node,
                 axis<dim>(c),
                 0.,
                 c,
                 {static_cast<unsigned int>(scene.supports.size() + scene.foundations.size() + k)});
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
  std::vector<InterfaceNode<dim>> interface_nodes(const scene::Scene<dim>      &scene,
                                                  const mesh::Mesh<dim>        &mesh,
                                                  const mechanics::Spaces<dim> &spaces,
                                                  const BodyContacts<dim>      &contacts,
                                                  const double                  t)
  {
    const unsigned int n_ranks = mesh.first_subdomain.size() - 1;
    const auto         points  = held_points(scene, mesh, spaces);

    std::map<unsigned int, std::vector<InterfaceNode<dim>>> to_meet;
    collectively(mesh.comm, [&] {
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        for (auto &[number, node] : boundary_nodes(scene, mesh, spaces, points, p, t))
          to_meet[(node.key[0] + node.key[1]) % n_ranks].push_back(std::move(node));
    });
    auto met = send_and_receive(mesh.comm, to_meet);
    to_meet.clear();
    std::map<unsigned int, std::vector<InterfaceNode<dim>>> to_owner;
    collectively(mesh.comm, [&] {
      merge_copies(met);
      for (auto &node : met)
        {
          const auto owner = contacts.owner.find(node.key);
          node.is_paired   = owner != contacts.owner.end();
          hold_bonds(node, scene, t);
          if (node.copies.size() > 1 || node.is_acted_on())
            to_owner[mesh.rank_of_subdomain(node.is_paired ? owner->second : node.copies.front().first)].push_back(
              std::move(node));
        }
    });
    auto owned = send_and_receive(mesh.comm, to_owner);
    collectively(mesh.comm, [&] {
      std::sort(owned.begin(), owned.end(), by_key_and_copy<dim>);
      for (auto &node : owned)
        resolve_sides(node, scene, t);
    });
    return owned;
  }

  template std::vector<InterfaceNode<2>> interface_nodes(const scene::Scene<2> &,
                                                         const mesh::Mesh<2> &,
                                                         const mechanics::Spaces<2> &,
                                                         const BodyContacts<2> &,
                                                         const double);
  template std::vector<InterfaceNode<3>> interface_nodes(const scene::Scene<3> &,
                                                         const mesh::Mesh<3> &,
                                                         const mechanics::Spaces<3> &,
                                                         const BodyContacts<3> &,
                                                         const double);
} // namespace slipstick::interface
