#include <slipstick/app/error_bars.h>
#include <slipstick/base/text.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace slipstick::app
{
  namespace
  {
    using contact::ContactNode;

    // Contributions of cells cancel; where they do so nearly completely the sum is accidental, and this part of the sum of
    // their magnitudes is left (measured: doc/error_bars.md).
    constexpr double least_part = 0.1;
    // A nodal pressure is a mean with the shape function of the node, and the largest one may lie between two: together at
    // most this part of the second difference of the pressures.
    constexpr double of_second_difference = 1. / 8;
    // The largest pressure stands out from those beside it by more than this part of it, or at the end of a boundary by more
    // than that one: a peak that no mesh resolves.
    constexpr double peak = 0.25, peak_at_end = 0.05;
    // A figure is reproduced, to this part of the largest of its unit.
    constexpr double same = 1e-5;
    // Figures and bars below this part of the largest of their unit are rounding, and not printed.
    constexpr double nothing = 1e-9;

    /// The nodes of a pair, along its arc.
    std::vector<ContactNode> of_pair(const std::vector<ContactNode> &nodes, const unsigned int pair)
    {
      std::vector<ContactNode> line;
      std::copy_if(nodes.begin(), nodes.end(), std::back_inserter(line), [&](const ContactNode &node) {
        return node.pair == pair;
      });
      std::stable_sort(line.begin(), line.end(), [](const ContactNode &a, const ContactNode &b) {
        return a.arc_length < b.arc_length;
      });
      return line;
    }

    /// Length of the nodes for which @p is_in holds, and of the elements between those in and those out.
    template <class IsIn>
    output::ErrorBar length(const std::string &name, const std::vector<ContactNode> &line, const IsIn &is_in)
    {
      constexpr double half = .5;
      output::ErrorBar bar{name, "mm", 0, 0., ""};
      for (std::size_t i = 0; i < line.size(); ++i)
        {
          bar.value += is_in(line[i]) ? line[i].length : 0.;
          if (i > 0 && is_in(line[i - 1]) != is_in(line[i]))
            *bar.error += half * (line[i].arc_length - line[i - 1].arc_length);
        }
      return bar;
    }

    /// What the mesh makes of the largest pressure: nothing, if it cannot be resolved.
    std::optional<double> resolution(const std::vector<ContactNode> &line)
    {
      const auto at = std::max_element(line.begin(), line.end(), [](const ContactNode &a, const ContactNode &b) {
        return a.pressure < b.pressure;
      });
      if (at == line.end())
        return 0.;
      const bool is_end            = at == line.begin() || at + 1 == line.end();
      double     second_difference = 0;
      for (const int side : {-1, 1})
        {
          if (side < 0 ? at == line.begin() : at + 1 == line.end())
            continue;
          const double drop = at->pressure - (at + side)->pressure;
          if (drop > (is_end ? peak_at_end : peak) * at->pressure)
            return {};
          second_difference += drop;
        }
      return of_second_difference * second_difference;
    }

    /// What is printed, by the names of goals.
    std::map<std::string, double> figures(const output::ResultSummary &results)
    {
      std::map<std::string, double> values = {{"max_displacement", results.max_displacement},
                                              {"strain_energy", results.strain_energy}};
      for (const auto &pair : results.contact)
        {
          values[pair.pair + ".normal_force"]     = pair.normal_force;
          values[pair.pair + ".tangential_force"] = pair.tangential_force;
          values[pair.pair + ".max_pressure"]     = pair.max_pressure;
        }
      for (const auto &probe : results.probes)
        if (probe.is_point)
          {
            values[probe.name + ".u_x"] = probe.points.front().displacement[0];
            values[probe.name + ".u_y"] = probe.points.front().displacement[1];
          }
      for (const auto &support : results.forces.supports)
        {
          values[support.name + ".force_x"] = support.sum.force[0];
          values[support.name + ".force_y"] = support.sum.force[1];
        }
      return values;
    }

    /// Magnitudes of values and bars, by unit.
    std::map<std::string, double> largest_of_units(const std::vector<output::ErrorBar> &bars)
    {
      std::map<std::string, double> largest;
      for (const auto &bar : bars)
        largest[bar.unit] = std::max(largest[bar.unit], std::abs(bar.value));
      return largest;
    }
  } // namespace

  std::vector<output::ErrorBar> error_bars(const std::vector<GoalError>             &goals,
                                           const output::ResultSummary              &results,
                                           const std::vector<contact::ContactNode>  &nodes,
                                           const std::vector<scene::ContactPair<2>> &pairs)
  {
    std::vector<output::ErrorBar> bars;
    for (const auto &goal : goals)
      {
        bars.push_back({goal.quantity, goal.unit, goal.value, {}, goal.reason});
        if (goal.is_known)
          bars.back().error = std::max(std::abs(goal.signed_), least_part * goal.absolute);
      }
    const auto printed = figures(results), largest = largest_of_units(bars);
    for (auto &bar : bars)
      if (const auto found = printed.find(bar.quantity); found != printed.end())
        {
          if (std::abs(std::abs(bar.value) - std::abs(found->second)) > same * largest.at(bar.unit))
            {
              bar.error.reset();
              bar.reason = "supports hold some of its nodes, whose forces are not estimated";
            }
          bar.value = found->second;
        }
    for (unsigned int k = 0; k < pairs.size(); ++k)
      {
        const auto line     = of_pair(nodes, k);
        const auto pressure = std::find_if(bars.begin(), bars.end(), [&](const output::ErrorBar &bar) {
          return bar.quantity == pairs[k].name + ".max_pressure";
        });
        if (pressure == bars.end())
          continue;
        const auto resolved = resolution(line);
        if (!resolved)
          {
            pressure->error.reset();
            pressure->reason =
              "a peak at a single node: it grows with every refinement (a corner, an edge) or needs a finer mesh";
          }
        else if (pressure->error)
          *pressure->error += *resolved;
        bars.push_back(
          length(pairs[k].name + ".contact_length", line, [](const ContactNode &n) { return n.is_closed; }));
        bars.push_back(length(pairs[k].name + ".stick_length", line, [](const ContactNode &n) {
          return n.is_closed && n.status == contact::ContactStatus::stick;
        }));
      }
    return bars;
  }

  void print_bars(const Log &log, const std::vector<output::ErrorBar> &bars)
  {
    if (bars.empty())
      return;
    log.line("");
    log.line("figures with estimated errors of the mesh");
    const auto largest = largest_of_units(bars);
    for (const auto &bar : bars)
      if (bar.error && std::max(std::abs(bar.value), *bar.error) <= nothing * largest.at(bar.unit))
        continue;
      else if (bar.error)
        log.line(format("             %-36s %14.6g +- %-10.6g %s",
                        bar.quantity.c_str(),
                        bar.value,
                        *bar.error > 0 ? rounded_up(*bar.error) : 0.,
                        bar.unit.c_str()));
      else
        log.line(format("             %-36s %14.6g    no bar: %s (%s)",
                        bar.quantity.c_str(),
                        bar.value,
                        bar.reason.c_str(),
                        bar.unit.c_str()));
  }

  void print_inaccurate(const Log                           &log,
                        const std::vector<output::ErrorBar> &bars,
                        const std::vector<std::string>      &promised,
                        const double                         accuracy)
  {
    const auto  largest = largest_of_units(bars);
    std::string names;
    for (const auto &bar : bars)
      if (bar.error && *bar.error > accuracy * std::abs(bar.value) &&
          std::abs(bar.value) > nothing * largest.at(bar.unit) &&
          std::find(promised.begin(), promised.end(), bar.quantity) != promised.end())
        names +=
          (names.empty() ? "" : ", ") + bar.quantity + format(" (%.2g %%)", 100 * *bar.error / std::abs(bar.value));
    if (!names.empty())
      log.line(
        format("             known to less than the %g %% that the preset stands for: %s; Mesh = adaptive refines "
               "until they are known to it",
               100 * accuracy,
               names.c_str()));
  }
} // namespace slipstick::app
