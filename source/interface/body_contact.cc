#include <slipstick/base/exceptions.h>
#include <slipstick/interface/body_contact.h>
#include <slipstick/interface/corners.h>
#include <slipstick/interface/gap_rotation.h>
#include <slipstick/interface/held_rotation.h>
#include <slipstick/interface/held_slaves.h>
#include <slipstick/interface/pair_checks.h>

#include <algorithm>

namespace slipstick::interface
{
  namespace
  {
    template <class Part>
    double mean_size(const std::vector<Part> &parts)
    {
      double sum = 0;
      for (const auto &part : parts)
        sum += part.chord();
      return sum / parts.size();
    }

    template <class Part>
    double automatic_reach(const std::vector<Part> &slave, const std::vector<Part> &master, const double distance)
    {
      return distance +
             std::max(2 * std::max(mean_size(slave), mean_size(master)), 0.1 * std::min(extent(slave), extent(master)));
    }

    template <class Part>
    double widest_reach(const std::vector<Part> &slave, const std::vector<Part> &master, const double distance)
    {
      return distance + 0.5 * std::min(extent(slave), extent(master));
    }

    template <class Part>
    std::vector<Part> outline_of(const std::vector<Part> &all, const unsigned int body)
    {
      std::vector<Part> outline;
      std::copy_if(all.begin(), all.end(), std::back_inserter(outline), [&](const auto &e) { return e.body == body; });
      return outline;
    }

    template <int dim>
    std::vector<MortarRow<dim>> rows_of(const scene::Scene<dim>                         &scene,
                                        const mesh::Mesh<dim>                           &mesh,
                                        const scene::ContactPair<dim>                   &pair,
                                        const std::vector<mechanics::BoundaryPart<dim>> &all)
    {
      const PairSides<dim> sides{mechanics::parts_on(mesh, all, pair.slave),
                                 mechanics::parts_on(mesh, all, *pair.master),
                                 outline_of(all, pair.slave.body),
                                 outline_of(all, pair.master->body)};
      const auto           distance = facing_distance(sides.slave, sides.master);
      if (!distance) // also if a side is empty
        refuse_pair(scene, pair, sides, 0.);
      const double automatic = automatic_reach(sides.slave, sides.master, *distance);
      const double widest    = std::max(automatic, widest_reach(sides.slave, sides.master, *distance));
      // which open nodes have friction must not depend on the mesh
      const double near = pair.reach ? *pair.reach : pair.law.acts_when_open ? widest : automatic;
      // more distant nodes have no rows at first, but are checked again with the solution
      const double reach   = pair.reach || !pair.law.acts_where_closed_alone() ? near : widest;
      Corners      corners = corners_of(scene, mesh, pair.slave, sides.slave, sides.slave_outline);
      corners.merge(corners_of(scene, mesh, *pair.master, sides.master, sides.master_outline));
      auto rows = mortar_rows(sides.slave,
                              sides.master,
                              {reach, near},
                              pair.discretization,
                              pair.name,
                              mesh::Kinematics<dim>(scene.plane_state),
                              corners);
      if (rows.empty())
        refuse_pair(scene, pair, sides, reach);
      check_sides(scene, mesh, pair, sides, all, rows);
      give_held_rows_to_neighbours<dim>(scene, mesh, all, sides.slave, rows);
      if (!mesh::Kinematics<dim>(scene.plane_state).is_revolution()) // bodies of revolution do not rotate
        {
          const auto is_held = [&](const unsigned int body) { return supports_hold_rotation(scene, mesh, all, body); };
          // where rows are closed, a gap of the geometry is, too
          const bool closes = pair.law.acts_where_closed_alone() && !pair.gap;
          const bool only_strained =
            closes && pair.slave.body != pair.master->body && is_held(pair.slave.body) && is_held(pair.master->body);
          find_rotation_weights(sides.slave, sides.master, !only_strained, rows);
        }
      return rows;
    }

    /// Connected components of nodes.
    class Groups
    {
    public:
      void join(const mechanics::NodeKey &a, const mechanics::NodeKey &b)
      {
        const mechanics::NodeKey first = find(a), second = find(b);
        parent[std::max(first, second)] = std::min(first, second);
      }

      void join(const mechanics::NodeKey &a, const Weights &weights)
      {
        for (const auto &[key, weight] : weights)
          join(a, key);
      }

      mechanics::NodeKey find(mechanics::NodeKey key)
      {
        mechanics::NodeKey root = key;
        for (auto at = parent.emplace(root, root).first; at->second != root; at = parent.find(root))
          root = at->second;
        while (key != root)
          key = std::exchange(parent[key], root);
        return root;
      }

      std::map<mechanics::NodeKey, mechanics::NodeKey> parent;
    };
  } // namespace

  template <int dim>
  BodyContacts<dim> pair_bodies(const scene::Scene<dim>      &scene,
                                const mesh::Mesh<dim>        &mesh,
                                const mechanics::Spaces<dim> &spaces)
  {
    BodyContacts<dim> contacts;
    contacts.rows.resize(scene.contacts.size());
    std::vector<bool> wanted(scene.bodies.size(), false);
    for (const auto &pair : scene.contacts)
      if (pair.master)
        wanted[pair.slave.body] = wanted[pair.master->body] = true;
    if (std::find(wanted.begin(), wanted.end(), true) == wanted.end())
      return contacts;
    const auto all = mechanics::outlines(mesh, spaces, wanted);

    Groups groups;
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      if (scene.contacts[k].master)
        {
          contacts.rows[k] = rows_of(scene, mesh, scene.contacts[k], all);
          for (const auto &row : contacts.rows[k])
            {
              groups.join(row.slave, row.slave_weights);
              groups.join(row.slave, row.master_weights);
              for (const Weights &weights : row.rotation_weights)
                groups.join(row.slave, weights);
            }
        }

    std::map<mechanics::NodeKey, unsigned int> first; // subdomain, by root
    for (const auto &edge : all)
      for (unsigned int i = 0; i < edge.n_nodes; ++i)
        if (groups.parent.count(edge.keys[i]) != 0)
          {
            const auto [entry, is_new] = first.emplace(groups.find(edge.keys[i]), edge.subdomain);
            entry->second              = std::min(entry->second, edge.subdomain);
          }
    std::vector<mechanics::NodeKey> keys;
    for (const auto &[key, parent] : groups.parent)
      keys.push_back(key);
    for (const auto &key : keys)
      contacts.owner[key] = first.at(groups.find(key));
    return contacts;
  }

  template BodyContacts<2> pair_bodies(const scene::Scene<2> &, const mesh::Mesh<2> &, const mechanics::Spaces<2> &);
  template BodyContacts<3> pair_bodies(const scene::Scene<3> &, const mesh::Mesh<3> &, const mechanics::Spaces<3> &);
} // namespace slipstick::interface
