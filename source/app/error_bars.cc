#include <slipstick/app/error_bars.h>
#include <slipstick/base/box_tree.h>
#include <slipstick/base/text.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace slipstick::app
{
  namespace
  {
    using contact::ContactNode;

    // Contributions of cells cancel. If they cancel almost completely the sum is accidental; therefore the error bar is
    // at least this part of the sum of their magnitudes (measured: doc/error_bars.md).
    constexpr double least_part = 0.1;
    // A nodal pressure is a mean weighted with the shape function of the node, and the maximum may lie between two
    // nodes: the error of both together is at most this part of the second difference of the pressures.
    constexpr double of_second_difference = 1. / 8;
    // Unresolvable peaks: the largest pressure exceeds the adjacent ones by more than this part of it, or at the end of
    // a boundary by more than the second value.
    constexpr double peak = 0.25, peak_at_end = 0.05;
    // A quantity is reproduced if it agrees to this part of the largest one with the same unit.
    constexpr double same = 1e-5;
    // Values and error bars below this part of the largest one with the same unit are rounding and not printed.
    constexpr double nothing = 1e-9;

    // In space pressures are compared with those of this number of nearest nodes; a node is at the edge of the surface
    // if this number of nearest nodes leaves an angle free.
    constexpr unsigned int n_beside = 4, n_around = 8;
    constexpr double       angle_at_edge = 150 * M_PI / 180;

    /// The nodes of a pair.
    std::vector<ContactNode> of_pair(const std::vector<ContactNode> &nodes, const unsigned int pair)
    {
      std::vector<ContactNode> list;
      std::copy_if(nodes.begin(), nodes.end(), std::back_inserter(list), [&](const ContactNode &node) {
        return node.pair == pair;
      });
      return list;
    }

    bool sticks(const ContactNode &node)
    {
      return node.is_closed && node.status == contact::ContactStatus::stick;
    }

    /// Resolution error of a largest pressure; nothing if it cannot be resolved.
    /// @param drops differences to the adjacent nodes.
    std::optional<double> resolution(const double pressure, const std::vector<double> &drops, const bool is_at_end)
    {
      double sum = 0;
      for (const double drop : drops)
        {
          if (drop > (is_at_end ? peak_at_end : peak) * pressure)
            return {};
          sum += drop;
        }
      return of_second_difference * sum;
    }

    auto with_largest_pressure(const std::vector<ContactNode> &nodes)
    {
      return std::max_element(nodes.begin(), nodes.end(), [](const ContactNode &a, const ContactNode &b) {
        return a.pressure < b.pressure;
      });
    }

    /// Contact nodes along a line of the plane.
    class ContactLine
    {
    public:
      static constexpr const char *measure = "length", *unit = "mm";

      explicit ContactLine(std::vector<ContactNode> nodes)
        : line(std::move(nodes))
      {
        std::stable_sort(line.begin(), line.end(), [](const ContactNode &a, const ContactNode &b) {
          return a.arc_length < b.arc_length;
        });
      }

      /// Length of the nodes for which @p is_in holds, and half of the elements between nodes inside and outside.
      template <class IsIn>
      std::pair<double, double> size(const IsIn &is_in) const
      {
        std::pair<double, double> result{0, 0};
        for (std::size_t i = 0; i < line.size(); ++i)
          {
            result.first += is_in(line[i]) ? line[i].length : 0.;
            if (i > 0 && is_in(line[i - 1]) != is_in(line[i]))
              result.second += (line[i].arc_length - line[i - 1].arc_length) / 2;
          }
        return result;
      }

      std::optional<double> resolution() const
      {
        const auto at = with_largest_pressure(line);
        if (at == line.end())
          return 0.;
        std::vector<double> drops;
        if (at != line.begin())
          drops.push_back(at->pressure - (at - 1)->pressure);
        if (at + 1 != line.end())
          drops.push_back(at->pressure - (at + 1)->pressure);
        return app::resolution(at->pressure, drops, drops.size() < 2);
      }

    private:
      std::vector<ContactNode> line;
    };

    /// Contact nodes on a surface; nodes near each other count as adjacent.
    class ContactSurface
    {
    public:
      static constexpr const char *measure = "area", *unit = "mm^2";

      explicit ContactSurface(std::vector<ContactNode> nodes_)
        : nodes(std::move(nodes_))
        , tree(boxes())
      {}

      /// Area of the nodes for which @p is_in holds, and half of the area of those adjacent to a node for which it does
      /// not.
      template <class IsIn>
      std::pair<double, double> size(const IsIn &is_in) const
      {
        std::pair<double, double> result{0, 0};
        for (const auto &node : nodes)
          if (is_in(node))
            {
              result.first += node.length;
              const auto beside = nearest(node, n_beside);
              if (std::any_of(beside.begin(), beside.end(), [&](const unsigned int k) { return !is_in(nodes[k]); }))
                result.second += node.length / 2;
            }
        return result;
      }

      std::optional<double> resolution() const
      {
        const auto at = with_largest_pressure(nodes);
        if (at == nodes.end())
          return 0.;
        std::vector<double> drops;
        for (const unsigned int k : nearest(*at, n_beside))
          drops.push_back(at->pressure - nodes[k].pressure);
        return app::resolution(at->pressure, drops, is_at_edge(*at));
      }

    private:
      using Point  = dealii::Point<3>;
      using Tensor = dealii::Tensor<1, 3>;

      static Point place(const ContactNode &node)
      {
        return {node.position[0], node.position[1], node.position[2]};
      }

      std::vector<BoxTree<3>::Box> boxes() const
      {
        std::vector<BoxTree<3>::Box> result;
        for (const auto &node : nodes)
          result.push_back(BoxTree<3>::box_around({place(node)}));
        return result;
      }

      std::vector<unsigned int> nearest(const ContactNode &node, const unsigned int n) const
      {
        std::vector<unsigned int> found;
        tree.for_each_by_distance(
          place(node),
          [] { return std::numeric_limits<double>::infinity(); },
          [&](const unsigned int k) {
            if (nodes[k].position != node.position)
              found.push_back(k);
            return found.size() < n;
          });
        return found;
      }

      bool is_at_edge(const ContactNode &node) const
      {
        const Tensor normal({node.normal[0], node.normal[1], node.normal[2]});
        Tensor       first; // in the tangent plane
        first[std::abs(normal[0]) < std::abs(normal[1]) ? 0 : 1] = 1;
        first -= first * normal * normal;
        const Tensor        second = cross_product_3d(normal, first);
        std::vector<double> angles;
        for (const unsigned int k : nearest(node, n_around))
          angles.push_back(
            std::atan2((place(nodes[k]) - place(node)) * second, (place(nodes[k]) - place(node)) * first));
        if (angles.empty())
          return true;
        std::sort(angles.begin(), angles.end());
        double widest = 2 * M_PI + angles.front() - angles.back();
        for (std::size_t k = 1; k < angles.size(); ++k)
          widest = std::max(widest, angles[k] - angles[k - 1]);
        return widest > angle_at_edge;
      }

      const std::vector<ContactNode> nodes;
      const BoxTree<3>               tree;
    };

    template <class Surface, class IsIn>
    output::ErrorBar size_of(const Surface &surface, const std::string &name, const IsIn &is_in)
    {
      const auto [value, error] = surface.size(is_in);
      return {name + Surface::measure, Surface::unit, value, error, ""};
    }

    /// The printed values by the names of goals.
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
            for (unsigned int d = 0; d < 3; ++d)
              values[probe.name + ".u_" + "xyz"[d]] = probe.points.front().displacement[d];
          }
      for (const auto &support : results.forces.supports)
        for (unsigned int d = 0; d < 3; ++d)
          values[support.name + ".force_" + "xyz"[d]] = support.sum.force[d];
      return values;
    }

    /// Largest magnitudes of values and error bars, by unit.
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
    using Surface = std::conditional_t<dim == 2, ContactLine, ContactSurface>;
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
        const Surface surface(of_pair(nodes, k));
        const auto    pressure = std::find_if(bars.begin(), bars.end(), [&](const output::ErrorBar &bar) {
          return bar.quantity == pairs[k].name + ".max_pressure";
        });
        if (pressure == bars.end())
          continue;
        const auto resolved = surface.resolution();
        if (!resolved)
          {
            pressure->error.reset();
            pressure->reason =
              "a peak at a single node: it grows with every refinement (a corner, an edge) or needs a finer mesh";
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
        format("             errors above the %g %% of the preset: %s; Mesh = adaptive refines the mesh until they are "
               "below",
               100 * accuracy,
               names.c_str()));
  }
} // namespace slipstick::app
