#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/fem/body_contact.h>

#include <algorithm>

namespace slipstick::fem
{
  template <int dim>
  bool can_be_pruned(const scene::ContactPair<dim> &pair)
  {
    switch (pair.law)
      {
        case scene::ContactLaw::frictionless:
        case scene::ContactLaw::coulomb:
          return true;
        case scene::ContactLaw::tresca:
          return pair.only_closed;
        case scene::ContactLaw::bonded:
          return false;
      }
    return false;
  }

  namespace
  {
    template <int dim>
    std::string describe(const scene::Scene<dim> &scene, const scene::BoundaryName &where)
    {
      return scene.bodies[where.body].name + "/" + where.boundary;
    }

    template <int dim>
    double mean_chord(const std::vector<SurfaceEdge<dim>> &edges)
    {
      double sum = 0;
      for (const auto &edge : edges)
        sum += edge.chord();
      return sum / edges.size();
    }

    /// Diagonal of the box around the curve.
    template <int dim>
    double extent(const std::vector<SurfaceEdge<dim>> &edges)
    {
      dealii::Point<dim> low = edges[0].node(0), high = low;
      for (const auto &edge : edges)
        for (unsigned int i = 0; i < edge.n_nodes; ++i)
          for (unsigned int d = 0; d < dim; ++d)
            {
              low[d]  = std::min(low[d], edge.at[i][d]);
              high[d] = std::max(high[d], edge.at[i][d]);
            }
      return low.distance(high);
    }

    template <int dim>
    double automatic_reach(const std::vector<SurfaceEdge<dim>> &slave,
                           const std::vector<SurfaceEdge<dim>> &master,
                           const double                         distance)
    {
      return distance + std::max(2 * std::max(mean_chord(slave), mean_chord(master)),
                                 0.1 * std::min(extent(slave), extent(master)));
    }

    template <int dim>
    double widest_reach(const std::vector<SurfaceEdge<dim>> &slave,
                        const std::vector<SurfaceEdge<dim>> &master,
                        const double                         distance)
    {
      return distance + 0.5 * std::min(extent(slave), extent(master));
    }

    template <int dim>
    std::vector<MortarRow<dim>> rows_of(const scene::Scene<dim>             &scene,
                                        const scene::ContactPair<dim>       &pair,
                                        const std::vector<SurfaceEdge<dim>> &slave,
                                        const std::vector<SurfaceEdge<dim>> &master)
    {
      const std::string between =
        "Contact " + pair.name + ": " + describe(scene, pair.slave) + " and " + describe(scene, *pair.master);
      const auto distance = facing_distance(slave, master);
      if (slave.empty() || master.empty() || !distance)
        throw InputError(between + " do not face each other anywhere",
                         "choose boundaries whose outward normals are opposed, or move the bodies");
      const double near = pair.reach ? *pair.reach : automatic_reach(slave, master, *distance);
      // nodes that are farther apart have no rows at first, but are looked at again when the solution is known
      const double reach =
        pair.reach || !can_be_pruned(pair) ? near : std::max(near, widest_reach(slave, master, *distance));
      auto rows = mortar_rows(slave, master, {reach, near}, pair.discretization, pair.name);
      if (rows.empty())
        throw InputError(between + format(" do not meet within the reach of %g mm along the normals of the slave; "
                                          "where they face each other they are %g mm apart",
                                          reach,
                                          *distance),
                         "raise Contact " + pair.name + "/Reach, move the bodies, or exchange slave and master");
      return rows;
    }

    /// Nodes that hang together.
    class Groups
    {
    public:
      void join(const NodeKey &a, const NodeKey &b)
      {
        const NodeKey first = find(a), second = find(b);
        parent[std::max(first, second)] = std::min(first, second);
      }

      NodeKey find(NodeKey key)
      {
        NodeKey root = key;
        for (auto at = parent.emplace(root, root).first; at->second != root; at = parent.find(root))
          root = at->second;
        while (key != root)
          key = std::exchange(parent[key], root);
        return root;
      }

      std::map<NodeKey, NodeKey> parent;
    };
  } // namespace

  template <int dim>
  BodyContacts<dim> pair_bodies(const scene::Scene<dim> &scene, const Mesh<dim> &mesh, const Spaces<dim> &spaces)
  {
    BodyContacts<dim> contacts;
    contacts.rows.resize(scene.contacts.size());
    std::vector<bool> wanted(scene.bodies.size(), false);
    for (const auto &pair : scene.contacts)
      if (pair.master)
        wanted[pair.slave.body] = wanted[pair.master->body] = true;
    if (std::find(wanted.begin(), wanted.end(), true) == wanted.end())
      return contacts;
    const auto all = outlines(mesh, spaces, wanted);

    Groups groups;
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      if (scene.contacts[k].master)
        {
          contacts.rows[k] = rows_of(scene,
                                     scene.contacts[k],
                                     edges_on(mesh, all, scene.contacts[k].slave),
                                     edges_on(mesh, all, *scene.contacts[k].master));
          for (const auto &row : contacts.rows[k])
            for (const Weights *weights : {&row.slave_weights, &row.master_weights})
              for (const auto &[key, weight] : *weights)
                groups.join(row.slave, key);
        }

    std::map<NodeKey, unsigned int> first; // subdomain, by root
    for (const auto &edge : all)
      for (unsigned int i = 0; i < edge.n_nodes; ++i)
        if (groups.parent.count(edge.keys[i]) != 0)
          {
            const auto [entry, is_new] = first.emplace(groups.find(edge.keys[i]), edge.subdomain);
            entry->second              = std::min(entry->second, edge.subdomain);
          }
    std::vector<NodeKey> keys;
    for (const auto &[key, parent] : groups.parent)
      keys.push_back(key);
    for (const auto &key : keys)
      contacts.owner[key] = first.at(groups.find(key));
    return contacts;
  }

  template bool            can_be_pruned(const scene::ContactPair<2> &);
  template BodyContacts<2> pair_bodies(const scene::Scene<2> &, const Mesh<2> &, const Spaces<2> &);
} // namespace slipstick::fem
