#include <slipstick/interface/held_slaves.h>
#include <slipstick/interface/node_matching.h>
#include <slipstick/mechanics/surface.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace slipstick::interface
{
  namespace
  {
    using Row = MortarRow<3>;

    // A normal is held if its part in free directions is below this.
    constexpr double held_normal = 1e-6;
    // Neighbours are equally near if their distances differ by less than this fraction.
    constexpr double equally_near = 1e-6;

    /// Components prescribed by supports, by node of the body.
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

    /// Whether supports hold the slave node along its normal.
    bool is_held(const Row &row, const std::map<mechanics::NodeKey, std::array<bool, 3>> &held)
    {
      const auto found = held.find(row.slave);
      if (found == held.end())
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
      row.apart += share / sum * (held.apart - row.apart);
      row.gap += share / sum * (held.gap - row.gap);
      row.neglected_sagitta = std::max(row.neglected_sagitta, held.neglected_sagitta);
      row.measure           = sum;
      row.length += part * held.length;
      row.full_measure += part * held.full_measure;
      row.full_length += part * held.full_length;
    }

    /// For nodes whose rows are removed: the nodes of the same facets.
    std::map<mechanics::NodeKey, std::set<mechanics::NodeKey>> neighbours_of(
      const std::vector<Row>                     &rows,
      const std::vector<bool>                    &goes,
      const std::vector<mechanics::SurfaceFacet> &slave)
    {
      std::map<mechanics::NodeKey, std::set<mechanics::NodeKey>> neighbours;
      for (std::size_t i = 0; i < rows.size(); ++i)
        if (goes[i])
          neighbours[rows[i].slave];
      for (const auto &facet : slave)
        for (unsigned int i = 0; i < facet.n_nodes; ++i)
          if (const auto found = neighbours.find(facet.keys[i]); found != neighbours.end())
            found->second.insert(facet.keys.begin(), facet.keys.begin() + facet.n_nodes);
      return neighbours;
    }

    /// The candidates nearest to a row.
    std::vector<std::size_t> nearest(const std::vector<Row>         &rows,
                                     const Row                      &row,
                                     const std::vector<std::size_t> &candidates)
    {
      const auto distance = [&](const std::size_t k) { return rows[k].position.distance(row.position); };
      double     least    = std::numeric_limits<double>::infinity();
      for (const std::size_t k : candidates)
        least = std::min(least, distance(k));
      std::vector<std::size_t> result;
      std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(result), [&](const std::size_t k) {
        return distance(k) <= (1 + equally_near) * least;
      });
      return result;
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
    const auto        held = held_components(scene, mesh, all, slave.front().body);
    std::vector<bool> goes(rows.size());
    std::map<std::pair<mechanics::NodeKey, unsigned int>, std::size_t> place; // of the rows that are not held
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!is_held(rows[i], held))
        place[{rows[i].slave, rows[i].side}] = i;
      else
        goes[i] = rows[i].master_weights.size() > 1;
    if (std::find(goes.begin(), goes.end(), true) == goes.end())
      return;
    const auto neighbours = neighbours_of(rows, goes, slave);

    const std::vector<Row> given = rows;
    std::vector<Row>       kept;
    for (std::size_t i = 0; i < given.size(); ++i)
      if (goes[i])
        {
          std::vector<std::size_t> candidates;
          for (const auto &key : neighbours.at(given[i].slave))
            if (const auto found = place.find({key, given[i].side}); found != place.end())
              candidates.push_back(found->second);
          const auto takers = nearest(given, given[i], candidates);
          for (const std::size_t k : takers)
            take(given[i], 1. / takers.size(), rows[k]);
          goes[i] = !takers.empty();
        }
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!goes[i])
        kept.push_back(std::move(rows[i]));
    rows = std::move(kept);
  }
} // namespace slipstick::interface
