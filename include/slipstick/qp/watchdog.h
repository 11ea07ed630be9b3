// Whole steps of the semismooth Newton method where its line search would cut them to almost nothing.
#pragma once

#include <slipstick/qp/line_search.h>
#include <slipstick/qp/newton_point.h>
#include <slipstick/qp/options.h>

#include <optional>
#include <utility>

namespace slipstick::qp::detail
{
  /// Watchdog technique (Chamberlain, Powell, Lemarechal, Pedersen 1982): the set at the end of a whole step is often
  /// much better than its residual suggests. Whole steps continue while each but the first reduces the residual by a
  /// fixed factor, until it is below the residual where they began. Otherwise the method returns to that point, so that
  /// it converges as with the line search alone. See doc/decisions/0128.
  template <typename Vector, typename Set>
  class Watchdog
  {
  public:
    /// State of the method where whole steps began.
    struct Start
    {
      NewtonPoint<Vector>     from, to;       // the step that was cut
      Vector                  predicted_from; // gradient that determined its set
      LineSearch<Vector, Set> line;           // its state there
      double                  t;              // part of the step that the line search left
    };

    /// @param options_ is kept by reference.
    explicit Watchdog(const NewtonOptions &options_)
      : options(&options_)
    {}

    /// Whether whole steps are being taken.
    bool is_watching() const
    {
      return start.has_value();
    }

    /// Whether whole steps may begin here. Called where a step is cut to almost nothing.
    bool may_begin(const LineSearch<Vector, Set> &line)
    {
      return n_cut++ >= n_to_wait && line.whole() <= options->largest_rise * line.present();
    }

    void begin(Start at)
    {
      start.emplace(std::move(at));
    }

    /// Whether the next whole step may be taken. If the residual is low enough, it is the last one, and the line search
    /// takes over.
    bool continues(const LineSearch<Vector, Set> &line)
    {
      if (!(line.whole() <= (1 - options->sufficient_decrease) * start->line.present()))
        return line.whole() <= options->least_progress * line.present();
      start.reset();
      n_cut = n_to_wait = 0;
      return true;
    }

    /// Ends whole steps without success. @return where they began. The next ones have to wait for more steps that are
    /// cut.
    Start give_up()
    {
      Start at = std::move(*start);
      start.reset();
      n_cut     = 0;
      n_to_wait = 2 * n_to_wait + 1;
      return at;
    }

    /// Converts the residuals so far to another measure.
    void rescale(const double factor)
    {
      if (start)
        start->line.rescale(factor);
    }

  private:
    const NewtonOptions *options;
    std::optional<Start> start;
    unsigned int         n_cut = 0, n_to_wait = 0; // steps that were cut since the last whole ones; number to wait for
  };
} // namespace slipstick::qp::detail
