#include <slipstick/base/exceptions.h>
#include <slipstick/interface/body_contact.h>
#include <slipstick/interface/corners.h>
#include <slipstick/interface/gap_rotation.h>
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

    /// Whether rows act only where the sides meet, so that no distance remains, and the bodies move independently.
    template <int dim>
    bool closes_between_bodies(const scene::ContactPair<dim> &pair)
    {
      return pair.law.acts_where_closed_alone() && !pair.gap && pair.slave.body != pair.master->body;
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
        find_rotation_weights(sides.slave, sides.master, !closes_between_bodies(pair), rows);
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

    /// BodyContacts::owner.
    template <int dim>
    std::map<mechanics::NodeKey, unsigned int> owners(const std::vector<std::vector<MortarRow<dim>>>  &rows,
                                                      const std::vector<mechanics::BoundaryPart<dim>> &all)
    {
      Groups groups;
      for (const auto &of_pair : rows)
        for (const auto &row : of_pair)
          {
            groups.join(row.slave, row.slave_weights);
            groups.join(row.slave, row.master_weights);
            for (const Weights &weights : row.rotation_weights)
              groups.join(row.slave, weights);
          }
      std::map<mechanics::NodeKey, unsigned int> first; // subdomain, by root
      for (const auto &part : all)
        for (unsigned int i = 0; i < part.n_nodes; ++i)
          if (groups.parent.count(part.keys[i]) != 0)
            {
              const auto [entry, is_new] = first.emplace(groups.find(part.keys[i]), part.subdomain);
              entry->second              = std::min(entry->second, part.subdomain);
            }
      std::vector<mechanics::NodeKey> keys;
      for (const auto &[key, parent] : groups.parent)
        keys.push_back(key);
      std::map<mechanics::NodeKey, unsigned int> owner;
      for (const auto &key : keys)
        owner[key] = first.at(groups.find(key));
      return owner;
    }

    /// Outlines of all bodies in contact with another; empty if there are none.
    template <int dim>
    std::vector<mechanics::BoundaryPart<dim>> outlines_in_contact(const scene::Scene<dim>      &scene,
                                                                  const mesh::Mesh<dim>        &mesh,
                                                                  const mechanics::Spaces<dim> &spaces)
    {
      std::vector<bool> wanted(scene.bodies.size(), false);
      for (const auto &pair : scene.contacts)
        if (pair.master)
          wanted[pair.slave.body] = wanted[pair.master->body] = true;
      if (std::find(wanted.begin(), wanted.end(), true) == wanted.end())
        return {};
      return mechanics::outlines(mesh, spaces, wanted);
    }
  } // namespace

  template <int dim>
  BodyContacts<dim> pair_bodies(const scene::Scene<dim>      &scene,
                                const mesh::Mesh<dim>        &mesh,
                                const mechanics::Spaces<dim> &spaces)
  {
    BodyContacts<dim> contacts;
    contacts.rows.resize(scene.contacts.size());
    const auto all = outlines_in_contact(scene, mesh, spaces);
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      if (scene.contacts[k].master)
        contacts.rows[k] = rows_of(scene, mesh, scene.contacts[k], all);
    contacts.owner = owners(contacts.rows, all);
    return contacts;
  }

  template <int dim>
  std::optional<BodyContacts<dim>> with_rotating_gaps(const scene::Scene<dim>      &scene,
                                                      const mesh::Mesh<dim>        &mesh,
                                                      const mechanics::Spaces<dim> &spaces,
                                                      const BodyContacts<dim>      &contacts)
  {
    std::vector<unsigned int> changed;
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      if (const auto &pair = scene.contacts[k]; pair.master && pair.law.has_tangential_row() &&
                                                closes_between_bodies(pair) &&
                                                !mesh::Kinematics<dim>(scene.plane_state).is_revolution())
        changed.push_back(k);
    if (changed.empty())
      return std::nullopt;
    const auto        all    = outlines_in_contact(scene, mesh, spaces);
    BodyContacts<dim> result = contacts;
    bool              any    = false;
    for (const unsigned int k : changed)
      {
        const auto &pair = scene.contacts[k];
        find_rotation_weights(mechanics::parts_on(mesh, all, pair.slave),
                              mechanics::parts_on(mesh, all, *pair.master),
                              true,
                              result.rows[k]);
        for (const auto &row : result.rows[k])
          any = any || !row.rotation_weights[0].empty();
      }
    if (!any)
      return std::nullopt;
    result.owner = owners(result.rows, all);
    return result;
  }

  template std::optional<BodyContacts<2>> with_rotating_gaps(const scene::Scene<2> &,
                                                             const mesh::Mesh<2> &,
                                                             const mechanics::Spaces<2> &,
                                                             const BodyContacts<2> &);
  template std::optional<BodyContacts<3>> with_rotating_gaps(const scene::Scene<3> &,
                                                             const mesh::Mesh<3> &,
                                                             const mechanics::Spaces<3> &,
                                                             const BodyContacts<3> &);
  template BodyContacts<2> pair_bodies(const scene::Scene<2> &, const mesh::Mesh<2> &, const mechanics::Spaces<2> &);
  template BodyContacts<3> pair_bodies(const scene::Scene<3> &, const mesh::Mesh<3> &, const mechanics::Spaces<3> &);
} // namespace slipstick::interface
