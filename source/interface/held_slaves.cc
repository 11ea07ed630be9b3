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
    // Neighbours are equally near if their distances differ by less than this fraction.
    constexpr double equally_near = 1e-6;

    template <int dim>
    using HeldComponents = std::map<mechanics::NodeKey, std::array<bool, dim>>;

    /// Components prescribed by supports, by node of the body.
    template <int dim>
    HeldComponents<dim> held_components(const scene::Scene<dim>                         &scene,
                                        const mesh::Mesh<dim>                           &mesh,
                                        const std::vector<mechanics::BoundaryPart<dim>> &all,
                                        const unsigned int                               body)
    {
      HeldComponents<dim> held;
      for (const auto &support : scene.supports)
        if (!support.point && support.where.body == body)
          for (const auto &part : mechanics::parts_on(mesh, all, support.where))
            for (unsigned int i = 0; i < part.n_nodes; ++i)
              for (unsigned int c = 0; c < dim; ++c)
                if (support.components[c])
                  held[part.keys[i]][c] = true;
      return held;
    }

    /// Whether supports hold the slave node along its normal.
    template <int dim>
    bool is_held(const MortarRow<dim> &row, const HeldComponents<dim> &held)
    {
      const auto found = held.find(row.slave);
      if (found == held.end())
        return false;
      return are_held<dim>(found->second, row.normal);
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
    template <int dim>
    void take(const MortarRow<dim> &held, const double part, MortarRow<dim> &row)
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

    /// For nodes whose rows are removed: the nodes of the same edges or facets.
    template <int dim>
    std::map<mechanics::NodeKey, std::set<mechanics::NodeKey>> neighbours_of(
      const std::vector<MortarRow<dim>>               &rows,
      const std::vector<bool>                         &goes,
      const std::vector<mechanics::BoundaryPart<dim>> &slave)
    {
      std::map<mechanics::NodeKey, std::set<mechanics::NodeKey>> neighbours;
      for (std::size_t i = 0; i < rows.size(); ++i)
        if (goes[i])
          neighbours[rows[i].slave];
      for (const auto &part : slave)
        for (unsigned int i = 0; i < part.n_nodes; ++i)
          if (const auto found = neighbours.find(part.keys[i]); found != neighbours.end())
            found->second.insert(part.keys.begin(), part.keys.begin() + part.n_nodes);
      return neighbours;
    }

    /// The candidates nearest to a row.
    template <int dim>
    std::vector<std::size_t> nearest(const std::vector<MortarRow<dim>> &rows,
                                     const MortarRow<dim>              &row,
                                     const std::vector<std::size_t>    &candidates)
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

  template <int dim>
  void give_held_rows_to_neighbours(const scene::Scene<dim>                         &scene,
                                    const mesh::Mesh<dim>                           &mesh,
                                    const std::vector<mechanics::BoundaryPart<dim>> &all,
                                    const std::vector<mechanics::BoundaryPart<dim>> &slave,
                                    std::vector<MortarRow<dim>>                     &rows)
  {
    if (rows.empty() || slave.empty())
      return;
    const auto        held = held_components(scene, mesh, all, slave.front().body);
    std::vector<bool> goes(rows.size());
    std::map<std::pair<mechanics::NodeKey, unsigned int>, std::size_t> place; // of the rows that are not held
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!is_held<dim>(rows[i], held))
        place[{rows[i].slave, rows[i].side}] = i;
      else
        goes[i] = rows[i].master_weights.size() > 1;
    if (std::find(goes.begin(), goes.end(), true) == goes.end())
      return;
    const auto neighbours = neighbours_of(rows, goes, slave);

    const std::vector<MortarRow<dim>> given = rows;
    std::vector<MortarRow<dim>>       kept;
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

  template void give_held_rows_to_neighbours(const scene::Scene<2> &,
                                             const mesh::Mesh<2> &,
                                             const std::vector<mechanics::BoundaryPart<2>> &,
                                             const std::vector<mechanics::BoundaryPart<2>> &,
                                             std::vector<MortarRow<2>> &);
  template void give_held_rows_to_neighbours(const scene::Scene<3> &,
                                             const mesh::Mesh<3> &,
                                             const std::vector<mechanics::BoundaryPart<3>> &,
                                             const std::vector<mechanics::BoundaryPart<3>> &,
                                             std::vector<MortarRow<3>> &);
} // namespace slipstick::interface
