#include <slipstick/interface/held_slaves.h>
#include <slipstick/interface/node_matching.h>
#include <slipstick/mechanics/surface.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

namespace slipstick::interface
{
  namespace
  {
    using Row = MortarRow<3>;

    // A normal is held if the part of it along other directions is below this.
    constexpr double held_normal = 1e-6;
    // Neighbours count as equally near within this part of the distance.
    constexpr double equally_near = 1e-6;

    /// Which components supports prescribe, by node of the body.
    std::map<mechanics::NodeKey, std::array<bool, 3>> held_components(const scene::Scene<3>                      &scene,
                                                                      const mesh::Mesh<3>                        &mesh,
                                                                      const std::vector<mechanics::SurfaceFacet> &all,
                                                                      const unsigned int                          body)
    {
      std::map<mechanics::NodeKey, std::array<bool, 3>> held;
      for (const auto &support : scene.supports)
        if (!support.point && support.where.body == body)
          for (const auto &facet : mechanics::parts_on(mesh, all, support.where))
            for (unsigned int i = 0; i < facet.n_nodes; ++i)
              for (unsigned int c = 0; c < 3; ++c)
                if (support.components[c])
                  held[facet.keys[i]][c] = true;
      return held;
    }

    bool is_held(const Row &row, const std::map<mechanics::NodeKey, std::array<bool, 3>> &held)
    {
      const auto found = held.find(row.slave);
      if (found == held.end() || row.master_weights.size() < 2)
        return false;
      double squares = 0;
      for (unsigned int c = 0; c < 3; ++c)
        squares += found->second[c] ? 0. : row.normal[c] * row.normal[c];
      return squares <= held_normal * held_normal;
    }

    Weights mean(const Weights &a, const double of_a, const Weights &b, const double of_b)
    {
      std::map<mechanics::NodeKey, double> sum;
      for (const auto &[key, weight] : a)
        sum[key] += of_a * weight;
      for (const auto &[key, weight] : b)
        sum[key] += of_b * weight;
      return normalised(sum, of_a + of_b);
    }

    /// row += part times the held one, both weighted by their measures.
    void take(const Row &held, const double part, Row &row)
    {
      const double share = part * held.measure, sum = row.measure + share;
      row.slave_weights   = mean(row.slave_weights, row.measure, held.slave_weights, share);
      row.master_weights  = mean(row.master_weights, row.measure, held.master_weights, share);
      row.master_position = row.master_position + share / sum * (held.master_position - row.master_position);
      row.gap += share / sum * (held.gap - row.gap);
      row.left_out = std::max(row.left_out, held.left_out);
      row.measure  = sum;
      row.length += part * held.length;
      row.full_measure += part * held.full_measure;
      row.full_length += part * held.full_length;
    }
  } // namespace

  void give_held_rows_to_neighbours(const scene::Scene<3>                      &scene,
                                    const mesh::Mesh<3>                        &mesh,
                                    const std::vector<mechanics::SurfaceFacet> &all,
                                    const std::vector<mechanics::SurfaceFacet> &slave,
                                    std::vector<Row>                           &rows)
  {
    if (rows.empty() || slave.empty())
      return;
    const auto held = held_components(scene, mesh, all, slave.front().body);
    std::map<std::pair<mechanics::NodeKey, unsigned int>, std::size_t> place; // of rows that stay
    std::vector<bool>                                                  goes(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (goes[i] = is_held(rows[i], held); !goes[i])
        place[{rows[i].slave, rows[i].side}] = i;
    std::map<mechanics::NodeKey, std::set<mechanics::NodeKey>> neighbours; // of nodes whose rows go
    std::set<mechanics::NodeKey>                               going;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (goes[i])
        going.insert(rows[i].slave);
    if (going.empty())
      return;
    for (const auto &facet : slave)
      for (unsigned int i = 0; i < facet.n_nodes; ++i)
        if (going.count(facet.keys[i]) > 0)
          neighbours[facet.keys[i]].insert(facet.keys.begin(), facet.keys.begin() + facet.n_nodes);

    const std::vector<Row> given = rows;
    std::vector<bool>      left(rows.size(), true);
    for (std::size_t i = 0; i < given.size(); ++i)
      if (goes[i])
        {
          std::vector<std::pair<double, std::size_t>> near; // distance, row
          for (const auto &key : neighbours[given[i].slave])
            if (const auto found = place.find({key, given[i].side}); found != place.end())
              near.emplace_back(given[found->second].position.distance(given[i].position), found->second);
          if (near.empty())
            continue;
          const double least = std::min_element(near.begin(), near.end())->first;
          near.erase(std::remove_if(near.begin(),
                                    near.end(),
                                    [least](const auto &other) { return other.first > (1 + equally_near) * least; }),
                     near.end());
          for (const auto &[distance, k] : near)
            take(given[i], 1. / near.size(), rows[k]);
          left[i] = false;
        }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (left[i])
        {
          if (kept < i)
            rows[kept] = std::move(rows[i]);
          ++kept;
        }
    rows.resize(kept);
  }
} // namespace slipstick::interface
