#include <slipstick/app/contact_profile.h>
#include <slipstick/app/error_bars.h>
#include <slipstick/base/text.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace slipstick::app
{
  namespace
  {
    using contact::ContactNode;

    // Contributions of cells partly cancel. If they cancel almost completely, the size of the sum is accidental;
    // therefore the error bar is at least this fraction of the sum of their magnitudes (measured: doc/error_bars.md).
    constexpr double least_part = 0.05;
    // The value of a goal agrees with the printed one if they differ by less than this fraction of the largest quantity
    // with the same unit.
    constexpr double same = 1e-5;
    // Values and error bars below this fraction of the largest one with the same unit are rounding errors and are not
    // printed.
    constexpr double nothing = 1e-9;

    // The error of a quantity that is exact is that of another place whose value may exceed it: it is at most this many
    // error bars smaller. Bars are meant to contain a fifth of the error at least.
    constexpr double most_bars = 5;

    constexpr const char *peak_at_one_node =
      "a peak at a single node: it grows with every refinement (a corner, an edge) or needs a finer mesh";

    double bar_of(const GoalError &goal)
    {
      const double bar = std::max(std::abs(goal.correction), least_part * goal.absolute) + goal.local;
      return goal.shortfall < most_bars * bar ? bar : 0.;
    }

    bool sticks(const ContactNode &node)
    {
      return node.is_closed && node.status == contact::ContactStatus::stick;
    }

    template <class Surface, class IsIn>
    output::ErrorBar size_of(const Surface &surface, const std::string &name, const IsIn &is_in)
    {
      const auto [value, error] = surface.size(is_in);
      return {name + Surface::measure, Surface::unit, value, error, "", ""};
    }

    std::vector<output::ErrorBar>::iterator find(std::vector<output::ErrorBar> &bars, const std::string &quantity)
    {
      return std::find_if(bars.begin(), bars.end(), [&](const output::ErrorBar &bar) {
        return bar.quantity == quantity;
      });
    }

    /// Whether one node carries nearly all of the square of the L2 norm of a traction, as where only one node touches:
    /// then the norm grows without limit, too.
    template <class Traction>
    bool is_of_one_node(const std::vector<ContactNode> &nodes, const Traction &traction)
    {
      double all = 0, largest = 0;
      for (const auto &node : nodes)
        {
          const double square = traction(node) * traction(node) * node.area;
          all += square;
          largest = std::max(largest, square);
        }
      constexpr double nearly_all = 0.9;
      return largest > nearly_all * all;
    }

    template <class Surface, class Traction>
    void add_norm_resolution(std::vector<output::ErrorBar>  &bars,
                             const std::string              &quantity,
                             const std::vector<ContactNode> &nodes,
                             const Surface                  &surface,
                             const Traction                 &traction)
    {
      const auto bar = find(bars, quantity);
      if (bar == bars.end() || !bar->error)
        return;
      *bar->error += bar->value * surface.norm_resolution(traction);
      if (!surface.resolution() && is_of_one_node(nodes, traction))
        {
          bar->error.reset();
          bar->reason = peak_at_one_node;
        }
    }

    /// The printed values, by names of goals.
    std::map<std::string, double> figures(const output::ResultSummary &results)
    {
      std::map<std::string, double> values = {{"max_displacement", results.max_displacement},
                                              {"strain_energy", results.strain_energy}};
      for (const auto &pair : results.contact)
        {
          values[pair.pair + ".normal_force"]     = pair.normal_force;
          values[pair.pair + ".tangential_force"] = pair.tangential_force;
          values[pair.pair + ".max_pressure"]     = pair.max_pressure;
          values[pair.pair + ".pressure_norm"]    = pair.norm.pressure;
          values[pair.pair + ".traction_norm"]    = pair.norm.tangential;
        }
      for (const auto &probe : results.probes)
        if (probe.is_point)
          {
            for (unsigned int d = 0; d < 3; ++d)
              values[probe.name + ".u_" + "xyz"[d]] = probe.points.front().displacement[d];
          }
      for (const auto &support : results.forces.supports)
        for (unsigned int d = 0; d < 3; ++d)
          values[support.name + ".force_" + "xyz"[d]] = support.sum.force[d];
      return values;
    }

    /// Largest magnitudes of the values, by unit.
    std::map<std::string, double> largest_of_units(const std::vector<output::ErrorBar> &bars)
    {
      std::map<std::string, double> largest;
      for (const auto &bar : bars)
        largest[bar.unit] = std::max(largest[bar.unit], std::abs(bar.value));
      return largest;
    }
  } // namespace

  template <int dim>
  std::vector<output::ErrorBar> error_bars(const std::vector<GoalError>               &goals,
                                           const output::ResultSummary                &results,
                                           const std::vector<contact::ContactNode>    &nodes,
                                           const std::vector<scene::ContactPair<dim>> &pairs)
  {
    std::vector<output::ErrorBar> bars;
    for (const auto &goal : goals)
      {
        bars.push_back({goal.quantity, goal.unit, goal.value, {}, goal.reason, goal.note});
        if (goal.is_known)
          bars.back().error = bar_of(goal);
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
        const auto                of_pair = nodes_of_pair(nodes, k);
        const ContactProfile<dim> surface(of_pair);
        add_norm_resolution(bars, pairs[k].name + ".pressure_norm", of_pair, surface, [](const ContactNode &node) {
          return node.pressure;
        });
        add_norm_resolution(bars, pairs[k].name + ".traction_norm", of_pair, surface, [](const ContactNode &node) {
          return node.tangential_traction;
        });
        const auto pressure = find(bars, pairs[k].name + ".max_pressure");
        if (pressure == bars.end())
          continue;
        const auto resolved = surface.resolution();
        if (!resolved)
          {
            pressure->error.reset();
            pressure->reason = peak_at_one_node;
          }
        else if (pressure->error)
          *pressure->error += *resolved;
        bars.push_back(size_of(surface, pairs[k].name + ".contact_", [](const ContactNode &n) { return n.is_closed; }));
        bars.push_back(size_of(surface, pairs[k].name + ".stick_", sticks));
      }
    return bars;
  }

  template std::vector<output::ErrorBar> error_bars(const std::vector<GoalError> &,
                                                    const output::ResultSummary &,
                                                    const std::vector<contact::ContactNode> &,
                                                    const std::vector<scene::ContactPair<2>> &);
  template std::vector<output::ErrorBar> error_bars(const std::vector<GoalError> &,
                                                    const output::ResultSummary &,
                                                    const std::vector<contact::ContactNode> &,
                                                    const std::vector<scene::ContactPair<3>> &);

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
        log.line(format("             %-36s %14.6g %s, no bar: %s",
                        bar.quantity.c_str(),
                        bar.value,
                        bar.unit.c_str(),
                        bar.reason.c_str()));
    for (const auto &bar : bars)
      if (!bar.note.empty())
        log.line(format("             %s: away from singular points, which summary.json lists", bar.quantity.c_str()));
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
        format("             errors above the %g %% of the preset: %s; Mesh = adaptive refines the mesh until they are "
               "below",
               100 * accuracy,
               names.c_str()));
  }
} // namespace slipstick::app
