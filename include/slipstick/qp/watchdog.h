// Whole steps of the semismooth Newton method where its line search would cut them to next to nothing.
#pragma once

#include <slipstick/qp/line_search.h>
#include <slipstick/qp/newton_point.h>
#include <slipstick/qp/options.h>

#include <optional>
#include <utility>

namespace slipstick::qp::detail
{
  /// Watchdog technique (Chamberlain, Powell, Lemarechal, Pedersen 1982): the set at the end of a whole step is often much
  /// better than its residual tells. Whole steps go on while each but the first lowers the residual by a fixed part, until
  /// it is below the bound of the line search where they began; else the method goes back there. So convergence remains
  /// that of the line search. See doc/decisions/0128.
  template <typename Vector, typename Set>
  class Watchdog
  {
  public:
    /// Where whole steps began.
    struct Start
    {
      NewtonPoint<Vector>     from, to; // the step that was cut
      Vector                  told;     // gradient that told its set
      LineSearch<Vector, Set> line;     // as it was there
      double                  t;        // what was left of the step
    };

    /// @param options_ is referred to.
    explicit Watchdog(const NewtonOptions &options_)
      : options(&options_)
    {}

    /// Are whole steps being taken?
    bool is_watching() const
    {
      return start.has_value();
    }

    /// Are they worth while from here? Asked where a step is cut to next to nothing.
    bool may_begin(const LineSearch<Vector, Set> &line)
    {
      return n_cut++ >= n_to_wait && line.whole() <= options->largest_rise * line.present();
    }

    void begin(Start at)
    {
      start.emplace(std::move(at));
    }

    /// May the next one be taken? Where the residual is low enough they end here, and the line search goes on.
    bool goes_on(const LineSearch<Vector, Set> &line)
    {
      if (!(line.whole() <= (1 - options->sufficient_decrease) * start->line.most()))
        return line.whole() <= options->least_progress * line.present();
      start.reset();
      n_cut = n_to_wait = 0;
      return true;
    }

    /// They ended in vain: where they began. The next ones wait for more steps that are cut.
    Start give_up()
    {
      Start at = std::move(*start);
      start.reset();
      n_cut     = 0;
      n_to_wait = 2 * n_to_wait + 1;
      return at;
    }

    /// Residuals so far become those in another measure.
    void rescale(const double factor)
    {
      if (start)
        start->line.rescale(factor);
    }

  private:
    const NewtonOptions *options;
    std::optional<Start> start;
    unsigned int         n_cut = 0, n_to_wait = 0; // steps that were cut since the last whole ones
  };
} // namespace slipstick::qp::detail
