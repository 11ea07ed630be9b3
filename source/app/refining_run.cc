#include <slipstick/app/refining_run.h>
#include <slipstick/app/report.h>
#include <slipstick/app/run_summary.h>
#include <slipstick/base/memory.h>
#include <slipstick/base/text.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::app
{
  namespace
  {
    // A finer mesh may resolve a quantity without an estimate (a pressure at a single node).
    constexpr unsigned int most_without_estimate = 3; // consecutive meshes
    // ... that resolve the contact and have this size: what coarser ones do not resolve looks like a peak, ...
    template <int dim>
    constexpr unsigned int least_unknowns_without_estimate = dim == 2 ? 3000 : 10000;
    // ... unless its value grows by less than this factor from mesh to mesh: a pressure at a corner grows without limit.
    constexpr double settling = 1.1;
    // Cells with large errors in the energy norm are divided, too, if two meshes have not reduced the error of the goals
    // to this fraction.
    constexpr double stagnation = 0.7;
    // A stress grows without limit, as far as meshes show, if this many of its last increases are each at least this
    // fraction of the one before, and the last one is larger than the accuracy: those of a stress with a limit decrease
    // with the errors.
    constexpr std::size_t n_increases      = 3;
    constexpr double      lasting_increase = 0.9;
    // Presets leave out quantities whose value and error are below this fraction of the largest one with the same unit.
    constexpr double nothing = 1e-5;
    // The accuracy of a value that is 0 within its error applies to this fraction of the largest one with the same unit.
    constexpr double scale_of_zero = 0.1;
    // Cells that the refinement of one cell adds, estimated: in the plane eight (nine quadrilaterals replace one), in space
    // seven (eight tetrahedra), and in both the transition cells around them.
    constexpr double cells_for_one = 12;

    /// Largest magnitude of the results with this unit; 0: none is known.
    double largest_of_unit(const std::string &unit, const output::ResultSummary &results)
    {
      if (unit == "N")
        return largest_force(results);
      if (unit == "mm")
        return results.max_displacement;
      if (unit != "MPa")
        return 0;
      double largest = results.max_von_mises;
      for (const auto &pair : results.contact)
        largest = std::max(largest, pair.max_pressure);
      return largest;
    }

    /// @param values on all meshes so far.
    bool grows_without_limit(const std::vector<double> &values, const double accuracy)
    {
      const std::size_t n = values.size();
      if (n <= n_increases || values[n - 1] - values[n - 2] <= accuracy * values[n - 1])
        return false;
      for (std::size_t k = n - n_increases; k < n; ++k)
        if (const double increase = values[k] - values[k - 1];
            !(increase > 0) || (k > n - n_increases && increase < lasting_increase * (values[k - 1] - values[k - 2])))
          return false;
      return true;
    }
  } // namespace

  template <int dim>
  RefiningRun<dim>::RefiningRun(const scene::Scene<dim>        &scene_,
                                const scene::AdaptivityOptions &options_,
                                const output::OutputDirectory  &directory_,
                                const Log                      &log_,
                                const MPI_Comm                  comm_)
    : scene(scene_)
    , options(options_)
    , directory(directory_)
    , log(log_)
    , quiet(comm_, Verbosity::quiet)
    , comm(comm_)
  {}

  template <int dim>
  ExitStatus RefiningRun<dim>::run(std::optional<Run<dim>> &steps)
  {
    print_header(log, scene, comm);
    log.line(format("accuracy     %g %% of %s is to be reached, with at most %u meshes and %u unknowns",
                    100 * options.accuracy,
                    what().c_str(),
                    options.max_meshes,
                    options.max_unknowns));
    for (;;)
      {
        steps.reset();
        std::optional<RequestedBars> wanted;
        if (options.error_bars || !options.goals.empty())
          wanted = RequestedBars{options.error_bars, options.goals};
        steps.emplace(scene, directory, quiet, comm, wanted, &refinement);
        steps->start_from(std::move(contact));
        if (is_undriven)
          steps->assume_undriven();
        const auto &summary = steps->solve_and_write(false);
        contact             = steps->contact_of_first_step();
        if (rows.empty())
          is_undriven = steps->has_still_motions();
        const bool solved = summary.status == output::RunStatus::converged;
        if (rows.empty() && options.goals.empty())
          leave_out(steps->point_forces());
        else if (rows.empty())
          left_out = steps->point_forces();
        if (solved)
          add(*steps, summary);
        const std::string missed = solved ? why_to_stop(*steps, summary) : "a mesh was not solved";
        if (!solved || reached || !missed.empty())
          {
            for (const auto &[quantity, text] : zeros)
              unknown.push_back(text);
            notes.insert(notes.end(), unknown.begin(), unknown.end());
            steps->finish(rows, notes, reached ? "" : missed);
            steps->print_warnings(log);
            for (const std::string &note : unknown)
              log.remark("warning: " + note);
            steps->print(log);
            if (!reached)
              log.warning(missed);
            return reached ? ExitStatus::converged : ExitStatus::not_converged;
          }
      }
  }

  template <int dim>
  std::string RefiningRun<dim>::what() const
  {
    std::string names;
    for (const std::string &goal : options.goals)
      names += (names.empty() ? "" : ", ") + goal;
    return names.empty() ? "the energy norm" : names;
  }

  template <int dim>
  void RefiningRun<dim>::leave_out(std::vector<LeftOut<dim>> places)
  {
    left_out = std::move(places);
    for (const auto &place : left_out)
      {
        notes.push_back(format("the accuracy excludes the region within %.3g mm of %s of body %s, %s: the energy "
                               "is infinite there; spread the force over %s to include it",
                               place.radius,
                               point_text(place.position, dim).c_str(),
                               scene.bodies[place.body].name.c_str(),
                               place.what.c_str(),
                               dim == 2 ? "an edge" : "a part of the surface"));
        log.remark("warning: " + notes.back());
      }
  }

  template <int dim>
  void RefiningRun<dim>::add(const Run<dim> &steps, const output::Summary &summary)
  {
    output::MeshRow row;
    row.cells        = summary.problem.cells;
    row.unknowns     = summary.problem.primal_dofs;
    row.energy_error = summary.error.estimate_energy_relative;
    find_counted(summary.error_bars, summary.results);
    const auto worst  = options.goals.empty()       ? std::optional<double>(std::sqrt(errors_of(steps).total))
                        : !without_estimate.empty() ? std::optional<double>()
                                                    : worst_error(summary.error_bars, scales);
    is_known          = dealii::Utilities::MPI::broadcast(comm, worst.has_value());
    const auto change = options.goals.empty() ? 0. : change_of_counted(summary.error_bars);
    is_confirmed      = dealii::Utilities::MPI::broadcast(comm, change.has_value());
    row.error         = dealii::Utilities::MPI::broadcast(comm, std::max(worst.value_or(0.), change.value_or(0.)));
    bar_over_error    = row.error > 0 ? dealii::Utilities::MPI::broadcast(comm, worst.value_or(0.)) / row.error : 1.;
    row.seconds       = summary.time_s.total;
    rows.push_back(row);
    if (rows.size() == 1)
      {
        for (const auto &remark : steps.mesh().remarks)
          if (!remark.is_warning) // warnings are printed with the results
            log.remark(remark.text);
        log.line("              mesh      cells   unknowns  energy norm   error    time [s]");
      }
    is_accurate = is_known && row.error <= options.accuracy && summary.status == output::RunStatus::converged;
    reached     = is_accurate && is_confirmed;
    log.line(format("             %5zu %10llu %10llu %10.2g %% %8s %10.2f",
                    rows.size(),
                    static_cast<unsigned long long>(row.cells),
                    static_cast<unsigned long long>(row.unknowns),
                    100 * row.energy_error,
                    is_known ? format("%.2g %%", 100 * row.error).c_str() : "none",
                    row.seconds));
  }

  template <int dim>
  void RefiningRun<dim>::find_counted(const std::vector<output::ErrorBar> &bars, const output::ResultSummary &results)
  {
    counted = options.goals;
    unknown.clear();
    if (options.skips_unknown)
      for (const auto &bar : bars)
        if (const auto goal = std::find(counted.begin(), counted.end(), bar.quantity); goal != counted.end())
          {
            if (!bar.error || std::abs(bar.value) + *bar.error <= nothing * largest_of_unit(bar.unit, results))
              counted.erase(goal);
            if (!bar.error)
              unknown.push_back("the accuracy leaves out " + bar.quantity + ": " + bar.reason);
          }
    find_scales(bars, results);
    counted          = dealii::Utilities::MPI::broadcast(comm, counted);
    without_estimate = counted.empty() ? "none of the figures has an estimate" : "";
    may_settle       = true;
    for (const std::string &goal : counted)
      {
        const auto bar =
          std::find_if(bars.begin(), bars.end(), [&goal](const output::ErrorBar &one) { return one.quantity == goal; });
        const bool has_bar = bar != bars.end();
        const auto scale   = scales.find(goal);
        if (has_bar && bar->error && scale != scales.end() && scale->second > 0)
          continue;
        const auto before = values.find(goal);
        may_settle        = may_settle && has_bar && !bar->error && before != values.end() &&
                     std::abs(bar->value) <= settling * std::abs(before->second.back());
        if (without_estimate.empty())
          without_estimate =
            goal + " has no estimate: " +
            (!has_bar ? "the results do not include it"
             : !bar->error
               ? bar->reason
               : "it is 0, like all other figures with the same unit, so that a relative accuracy is meaningless");
      }
    may_settle       = dealii::Utilities::MPI::broadcast(comm, may_settle);
    without_estimate = dealii::Utilities::MPI::broadcast(comm, without_estimate);
  }

  // A value that is 0 by symmetry has no relative accuracy.
  template <int dim>
  void RefiningRun<dim>::find_scales(const std::vector<output::ErrorBar> &bars, const output::ResultSummary &results)
  {
    scales.clear();
    for (const auto &bar : bars)
      if (std::find(counted.begin(), counted.end(), bar.quantity) != counted.end())
        {
          double &scale = scales[bar.quantity] = std::abs(bar.value);
          zeros.erase(bar.quantity);
          const double largest = largest_of_unit(bar.unit, results);
          if (!bar.error || scale > *bar.error || !(largest > 0))
            continue;
          scale = std::max(scale, scale_of_zero * largest);
          zeros[bar.quantity] =
            format("%s is 0 within its error of %.2g %s: the accuracy applies to %.3g %s, %g of the "
                   "largest such figure",
                   bar.quantity.c_str(),
                   *bar.error,
                   bar.unit.c_str(),
                   scale,
                   bar.unit.c_str(),
                   scale_of_zero);
        }
  }

  template <int dim>
  std::optional<double> RefiningRun<dim>::change_of_counted(const std::vector<output::ErrorBar> &bars)
  {
    std::optional<double> change = 0.;
    for (const auto &bar : bars)
      if (std::find(counted.begin(), counted.end(), bar.quantity) != counted.end())
        {
          const auto before = values.find(bar.quantity);
          if (before == values.end())
            change.reset();
          else if (const double scale = scales.at(bar.quantity); change && scale > 0)
            change = std::max(*change, std::abs(bar.value - before->second.back()) / scale);
        }
    for (const auto &bar : bars)
      values[bar.quantity].push_back(bar.value);
    return change;
  }

  template <int dim>
  std::string RefiningRun<dim>::why_to_stop(const Run<dim> &steps, const output::Summary &summary)
  {
    if (reached)
      return "";
    const std::string so_far =
      format("the accuracy of %g %% of %s is not reached: ", 100 * options.accuracy, what().c_str()) +
      (is_known ? format("the error is %.3g %% after %zu mesh%s",
                         100 * rows.back().error,
                         rows.size(),
                         rows.size() == 1 ? "" : "es")
                : format("after %zu mesh%s %s", rows.size(), rows.size() == 1 ? "" : "es", without_estimate.c_str()));
    const auto goals = goals_of(steps);
    if (!is_known && !options.skips_unknown &&
        std::any_of(goals.begin(), goals.end(), [](const GoalError &goal) { return goal.is_infinite; }))
      return so_far;
    const bool is_resolvable =
      std::any_of(goals.begin(), goals.end(), [](const GoalError &goal) { return goal.is_resolvable; });
    const bool is_unresolved = std::any_of(goals.begin(), goals.end(), [&steps](const GoalError &goal) {
      return steps.is_unresolved(goal.quantity);
    });
    const bool is_coarse     = rows.back().unknowns < least_unknowns_without_estimate<dim>;
    n_without = is_known || is_resolvable || may_settle || is_unresolved || is_coarse ? 0 : n_without + 1;
    const std::string for_stress = remedy_for_stress(steps, summary);
    if (n_without == most_without_estimate)
      return so_far + (for_stress.empty() ? "" : "; " + for_stress);
    const std::string limit = mark_next(steps, summary);
    if (limit.empty())
      return "";
    if (is_accurate)
      {
        reached = true;
        notes.push_back("the errors of the figures are those of one mesh, which no finer one confirms: " + limit);
        return "";
      }
    return so_far + "; " + (for_stress.empty() ? limit : for_stress);
  }

  template <int dim>
  std::string RefiningRun<dim>::remedy_for_stress(const Run<dim> &steps, const output::Summary &summary) const
  {
    const std::string all = "max_von_mises", regular = "max_regular_von_mises";
    const std::string probe = "the stress of a point Probe beside this place";
    const auto        grows = [&](const std::string &goal) {
      const auto found = values.find(goal);
      return std::find(counted.begin(), counted.end(), goal) != counted.end() && found != values.end() &&
             grows_without_limit(found->second, options.accuracy);
    };
    std::string text;
    for (const auto &goal : goals_of(steps))
      if (goal.quantity == all && goal.is_singular)
        text = "finer meshes may not help: ask for " + regular + ", which leaves out such places, or for " + probe;
    if (grows(all))
      {
        const auto &results = summary.results;
        const auto &at      = results.max_von_mises_at;
        text =
          format("on the last %zu meshes %s grows without limit at %s of body %s%s, so that finer meshes do not help: "
                 "ask for %s, which leaves out corners, ends of supports and of bonds, or for %s",
                 n_increases + 1,
                 all.c_str(),
                 point_text(at.position, dim).c_str(),
                 at.body.c_str(),
                 results.singular.empty() ? "" : (", " + results.singular).c_str(),
                 regular.c_str(),
                 probe.c_str());
      }
    else if (grows(regular))
      text = format("on the last %zu meshes %s grows without limit at a place that does not count as singular, so that "
                    "finer meshes do not help: ask for %s",
                    n_increases + 1,
                    regular.c_str(),
                    probe.c_str());
    return dealii::Utilities::MPI::broadcast(comm, text);
  }

  template <int dim>
  std::string RefiningRun<dim>::mark_next(const Run<dim> &steps, const output::Summary &summary)
  {
    if (rows.size() >= options.max_meshes)
      return "allow more meshes (Adaptivity/Max meshes), or begin with a finer one";
    // bars that are too small, or not confirmed, show where the errors are but not how large they are
    const double aimed_at = is_accurate ? 0. : bar_over_error * options.accuracy;
    auto         cells =
      options.goals.empty() || !is_known ? errors_of(steps) : errors_of_goals(goals_of(steps), aimed_at, comm);
    auto n_marked = mark(steps.mesh(), cells, refinement);
    // Only the resolution of a pressure is missing, or peaks move along the contact with the cells that are divided.
    const std::size_t n         = rows.size();
    const bool        stagnates = is_known && n > 2 && rows[n - 1].error > stagnation * rows[n - 3].error;
    if ((n_marked == 0 || stagnates) && !options.goals.empty())
      {
        cells = errors_of(steps);
        n_marked += mark(steps.mesh(), cells, refinement);
      }
    if (!is_known) // errors may be larger elsewhere
      n_marked += steps.mark_unresolved_contacts(refinement);
    n_marked += steps.mark_coarse_masters(options.goals, refinement);
    const double growth = 1 + cells_for_one * n_marked / summary.problem.cells;
    if (n_marked == 0)
      return "no cell is left whose refinement would reduce the error";
    if (growth * rows.back().unknowns > options.max_unknowns)
      return format("the next mesh would have about %.2g unknowns; the limit is %u (Adaptivity/Max unknowns)",
                    growth * rows.back().unknowns,
                    options.max_unknowns);
    const double needed = dealii::Utilities::MPI::broadcast(comm, summary.memory_mb.peak_total * growth);
    const double free   = dealii::Utilities::MPI::sum(share_of_free_memory_mb(comm), comm) +
                        dealii::Utilities::MPI::broadcast(comm, summary.memory_mb.peak_total);
    if (needed > free)
      return format("the next mesh may need %.0f MB of memory, and %.0f MB are free", needed, free);
    return "";
  }

  template <int dim>
  std::vector<GoalError> RefiningRun<dim>::goals_of(const Run<dim> &steps) const
  {
    std::vector<GoalError> goals;
    for (const auto &goal : steps.goals())
      if (std::find(counted.begin(), counted.end(), goal.quantity) != counted.end())
        goals.push_back(goal);
    return goals;
  }

  template <int dim>
  CellErrors RefiningRun<dim>::errors_of(const Run<dim> &steps) const
  {
    return energy_errors(steps.mesh(), steps.stress(), left_out, options.goals.empty() ? options.accuracy : 0.);
  }

  template class RefiningRun<2>;
  template class RefiningRun<3>;
} // namespace slipstick::app
