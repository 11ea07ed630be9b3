#include <slipstick/tfeti/dense.h>
#include <slipstick/tfeti/gathered_by_label.h>
#include <slipstick/tfeti/loose_bodies.h>

#include <deal.II/base/mpi.h>

#include <cmath>

namespace slipstick::tfeti
{
  namespace
  {
    // A set of rows holds loose motions if the pivots of their shares differ by no more than this factor.
    constexpr double least_hold = 1e-8;
    // Motions count as weakly held if the free rows resist them by less than this part of the best held motion.
    constexpr double weak_resistance = 1e-3;
    // Gaps below this part of the largest are treated as equal.
    constexpr double least_gap = 1e-6;
    // Rows with one bound resist by this factor times the sum of all two-sided bounds and the loads.
    constexpr double barrier = 10;
    // |t| is smoothed to sqrt(t^2 + eps^2), eps from the largest jump at the start down by this factor ...
    constexpr double smoothing_reduction = 0.1;
    // ... to this part of it, ...
    constexpr double least_smoothing = 1e-10;
    // ... each minimised by at most this number of Newton steps.
    constexpr unsigned int max_newton_steps = 30;
    // A step must reduce the sum by this part of its slope; otherwise it is halved, down to the shortest; ...
    constexpr double least_decrease = 1e-4, shortest_step = 1e-10;
    // ... the search ends when the predicted reduction is less than this part of the sum.
    constexpr double least_gain = 1e-12;
    // Limit on the products of shares in each of its Newton steps; above it the search is skipped (about a hundred
    // steps take seconds).
    constexpr double most_products = 1e8;

    /// A row of a loose body, or in space both tangential rows of a node, whose resultant is bounded by the capacity.
    struct LooseRow
    {
      double          capacity; // infinite: one-sided
      Eigen::VectorXd share, second;

      double jump(const Eigen::VectorXd &a) const
      {
        return std::hypot(share.dot(a), second.dot(a));
      }
    };

    /// The motion along which the rows bear the smallest part of the loads: the a with e'a = -1 that minimises sum r |S
    /// a|.
    class WeakestMotion
    {
    public:
      /// @param loads_ e, not 0.
      WeakestMotion(std::vector<LooseRow> rows_, Eigen::VectorXd loads_)
        : rows(std::move(rows_))
        , loads(std::move(loads_))
      {
        double all = loads.norm();
        for (const LooseRow &row : rows)
          all += std::isfinite(row.capacity) ? row.capacity : 0.;
        for (LooseRow &row : rows)
          {
            one_sided.push_back(!std::isfinite(row.capacity));
            if (one_sided.back())
              row.capacity = barrier * all;
          }
      }

      /// Lower bound of the part of the loads along a that the rows bear; one-sided rows must not be moved against.
      double held_part(const Eigen::VectorXd &a) const
      {
        double bears = 0;
        for (std::size_t i = 0; i < rows.size(); ++i)
          bears += rows[i].capacity * (one_sided[i] ? std::max(0., -rows[i].share.dot(a)) : rows[i].jump(a));
        const double drives = -loads.dot(a);
        return drives > 0 ? bears / drives : HUGE_VAL;
      }

      Eigen::VectorXd motion() const
      {
        Eigen::VectorXd       a = -loads / loads.squaredNorm();
        const Eigen::MatrixXd across =
          Eigen::MatrixXd(Eigen::HouseholderQR<Eigen::MatrixXd>(loads).householderQ()).rightCols(loads.size() - 1);
        if (across.cols() == 0)
          return a;
        double largest = 0;
        for (const LooseRow &row : rows)
          largest = std::max(largest, row.jump(a));
        for (double eps = largest; std::isfinite(largest) && eps > least_smoothing * largest;
             eps *= smoothing_reduction)
          for (unsigned int k = 0; k < max_newton_steps; ++k)
            {
              Eigen::VectorXd       slope;
              Eigen::MatrixXd       curvature;
              const double          value = evaluate(a, eps, &slope, &curvature);
              const Eigen::VectorXd step =
                -across * shortest_solution(across.transpose() * curvature * across, across.transpose() * slope);
              const double along = slope.dot(step);
              if (!(along < 0))
                break;
              double t = 1;
              while (t > shortest_step && !(evaluate(a + t * step, eps) <= value + least_decrease * t * along))
                t /= 2;
              a += t * step;
              if (-along <= least_gain * std::abs(value) || t <= shortest_step)
                break;
            }
        return a;
      }

    private:
      /// The smoothed sum, its slope and curvature.
      double evaluate(const Eigen::VectorXd &a,
                      const double           eps,
                      Eigen::VectorXd       *slope     = nullptr,
                      Eigen::MatrixXd       *curvature = nullptr) const
      {
        double value = 0;
        if (slope)
          {
            *slope     = Eigen::VectorXd::Zero(loads.size());
            *curvature = Eigen::MatrixXd::Zero(loads.size(), loads.size());
          }
        for (std::size_t i = 0; i < rows.size(); ++i)
          {
            const double          t = rows[i].share.dot(a), across = rows[i].second.dot(a);
            const double          smooth = std::hypot(t, across, eps);
            const double          factor = one_sided[i] ? rows[i].capacity / 2 : rows[i].capacity;
            const Eigen::VectorXd along  = t * rows[i].share + across * rows[i].second;
            value += factor * (smooth - (one_sided[i] ? t : 0.));
            if (slope)
              {
                *slope += factor * along / smooth - (one_sided[i] ? factor : 0.) * rows[i].share;
                *curvature += factor / smooth *
                              (rows[i].share * rows[i].share.transpose() + rows[i].second * rows[i].second.transpose() -
                               along * along.transpose() / (smooth * smooth));
              }
          }
        return value;
      }

      std::vector<LooseRow> rows;
      std::vector<bool>     one_sided;
      Eigen::VectorXd       loads;
    };
  } // namespace

  LooseBodies::LooseBodies(const BodyMotions &motions_, const Constraints &rows_, const MPI_Comm comm_)
    : motions(motions_)
    , rows(rows_)
    , comm(comm_)
    , held_by_contact(motions, rows, comm)
  {}

  void LooseBodies::update_loads()
  {
    if (!held_by_contact.empty())
      held_by_contact.set_loads(motions.loads());
  }

  bool LooseBodies::stop_driven(const std::vector<RigidMotion> &loose,
                                const std::vector<double>      &gaps,
                                std::vector<bool>              &free) const
  {
    Eigen::VectorXd loads(loose.size());
    for (std::size_t m = 0; m < loose.size(); ++m)
      loads[m] = loose[m].load;
    if (loads.isZero(0.))
      return false;
    const Eigen::MatrixXd            own = motions.jumps(loose).toDense();
    std::vector<std::vector<double>> numbers; // gap, shares
    std::vector<std::uint64_t>       labels;
    for (unsigned int r = 0; r < free.size(); ++r)
      if (!free[r] && rows.kind[r] == RowKind::normal && !own.row(r).isZero(0.))
        {
          numbers.push_back({gaps[r]});
          for (std::size_t m = 0; m < loose.size(); ++m)
            numbers.back().push_back(own(r, m));
          labels.push_back(rows.label[r]);
        }
    const auto closing = gathered_by_label(labels, numbers, comm);

    std::set<std::uint64_t> stopped;
    Eigen::MatrixXd         open = Eigen::MatrixXd::Identity(loose.size(), loose.size()); // projector: motions not held
    for (std::size_t n = 0; n < loose.size(); ++n)
      {
        const Eigen::VectorXd driven = open * loads;
        if (driven.norm() <= least_hold * loads.norm())
          break;
        double          least = HUGE_VAL;
        std::uint64_t   first = 0;
        Eigen::VectorXd held;
        for (const auto &[label, row] : closing)
          {
            const Eigen::Map<const Eigen::VectorXd> share(row.data() + 1, loose.size());
            const double                            rate = share.dot(driven) / driven.norm();
            if (rate > least_hold && row[0] / rate < least)
              {
                least = row[0] / rate;
                first = label;
                held  = open * share;
              }
          }
        if (least == HUGE_VAL)
          break;
        stopped.insert(first);
        open -= held * held.transpose() / held.squaredNorm();
      }
    for (unsigned int r = 0; r < free.size(); ++r)
      free[r] = free[r] || stopped.count(rows.label[r]) > 0;
    return !stopped.empty();
  }

  bool LooseBodies::hold_by(const std::vector<RigidMotion> &loose,
                            const std::vector<bool>        &is_candidate,
                            const std::vector<double>      &scale,
                            std::vector<bool>              &free,
                            const std::vector<qp::Turn>    &turns) const
  {
    Eigen::MatrixXd own = motions.jumps(loose).toDense();
    for (const qp::Turn &turn : turns)
      {
        const Eigen::RowVectorXd first = own.row(turn.first), second = own.row(turn.second);
        own.row(turn.first)  = turn.cosine * first + turn.sine * second;
        own.row(turn.second) = turn.cosine * second - turn.sine * first;
      }
    std::vector<std::vector<double>> candidates;
    std::vector<std::uint64_t>       labels;
    for (unsigned int r = 0; r < free.size(); ++r)
      if (is_candidate[r])
        {
          const Eigen::VectorXd share = scale[r] * own.row(r);
          candidates.emplace_back(share.data(), share.data() + share.size());
          labels.push_back(rows.label[r]);
        }
    const auto all = gathered_by_label(labels, candidates, comm);
    if (all.empty()) // Eigen's decomposition reads out of bounds for a matrix without columns
      return false;
    Eigen::MatrixXd shares(loose.size(), all.size());
    unsigned int    column = 0;
    for (const auto &candidate : all)
      shares.col(column++) = Eigen::Map<const Eigen::VectorXd>(candidate.second.data(), loose.size());
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> pivoted(shares);
    // for unit motions; shares at rounding level hold nothing
    pivoted.setThreshold(least_hold * std::max(1., 1 / std::max(pivoted.maxPivot(), least_hold)));
    if (pivoted.rank() < static_cast<Eigen::Index>(loose.size()))
      return false;
    std::set<std::uint64_t> chosen;
    for (unsigned int i = 0; i < loose.size(); ++i)
      chosen.insert(std::next(all.begin(), pivoted.colsPermutation().indices()[i])->first);
    for (unsigned int r = 0; r < free.size(); ++r)
      free[r] = free[r] || (is_candidate[r] && chosen.count(rows.label[r]) > 0);
    return true;
  }

  std::vector<bool> LooseBodies::hold(const std::vector<bool>     &free,
                                      const std::vector<double>   &gaps,
                                      const bool                   include_weakly_held,
                                      const std::vector<qp::Turn> &turns) const
  {
    std::vector<bool> result = free;
    auto loose = motions.free(free, include_weakly_held ? weak_resistance : BodyMotions::rounding_of_resistance, turns);
    if (!include_weakly_held && !predict_active_sets() && !loose.empty() && stop_driven(loose, gaps, result))
      loose = motions.free(result, BodyMotions::rounding_of_resistance, turns);
    if (loose.empty())
      return result;
    const double largest =
      dealii::Utilities::MPI::max(gaps.empty() ? 0. : *std::max_element(gaps.begin(), gaps.end()), comm);
    std::vector<bool>   is_candidate(free.size());
    std::vector<double> scale(free.size(), 1.);
    for (unsigned int r = 0; r < free.size(); ++r)
      {
        is_candidate[r] = !result[r];
        scale[r]        = 1 / (least_gap + (largest > 0 ? gaps[r] / largest : 0.));
      }
    hold_by(loose, is_candidate, scale, result, turns);
    return result;
  }

  bool LooseBodies::predict_active_sets() const
  {
    return !held_by_contact.empty() && !motions.are_solids();
  }

  void LooseBodies::balance(const std::vector<double>                  &stiffness,
                            const qp::AdmissibleSet<DistributedVector> &bounds,
                            const double                                tolerated,
                            std::vector<double>                        &moved) const
  {
    if (held_by_contact.empty())
      return;
    const auto jumps = held_by_contact.shift(moved, stiffness, bounds, tolerated);
    for (std::size_t r = 0; r < moved.size(); ++r)
      moved[r] -= stiffness[r] * jumps[r];
  }

  std::optional<Overload> LooseBodies::overload(const std::vector<bool>   &free,
                                                const std::vector<double> &capacity,
                                                const double               below) const
  {
    std::vector<bool> supports = free, contacts = free;
    for (unsigned int r = 0; r < free.size(); ++r)
      (is_equality(rows.kind[r]) ? contacts : supports)[r] = false;
    // the normals of a rough mesh hardly resist a motion along the true surface
    const auto loose = motions.free(contacts, weak_resistance, {}, supports);
    if (loose.empty())
      return {};
    const double n_loose = loose.size(), n_rows = dealii::Utilities::MPI::sum(free.size(), comm);
    if (n_loose * n_loose * n_rows > most_products)
      return {};
    const Eigen::MatrixXd            own = motions.jumps(loose).toDense();
    std::vector<std::vector<double>> numbers;
    std::vector<std::uint64_t>       labels;
    Eigen::VectorXd                  loads(loose.size());
    for (std::size_t m = 0; m < loose.size(); ++m)
      loads[m] = loose[m].load;
    std::vector<unsigned int> second(free.size(), invalid_row); // tangential row of the same node
    std::vector<bool>         is_second(free.size(), false);
    for (const auto &point : rows.contact_points)
      if (point.tangential_row != invalid_row && point.second_row != invalid_row)
        {
          second[point.tangential_row] = point.second_row;
          is_second[point.second_row]  = true;
        }
    for (unsigned int r = 0; r < free.size(); ++r)
      {
        const bool is_pair = second[r] != invalid_row;
        if (free[r] || is_second[r] || capacity[r] < 0 ||
            (own.row(r).isZero(0.) && !(is_pair && !own.row(second[r]).isZero(0.))))
          continue;
        numbers.push_back({capacity[r]});
        for (std::size_t m = 0; m < loose.size(); ++m)
          numbers.back().push_back(own(r, m));
        for (std::size_t m = 0; m < loose.size(); ++m)
          numbers.back().push_back(is_pair ? own(second[r], m) : 0.);
        labels.push_back(rows.label[r]);
      }
    std::vector<LooseRow> all;
    for (const auto &[label, row] : gathered_by_label(labels, numbers, comm)) // capacity, shares
      {
        const Eigen::Map<const Eigen::MatrixXd> shares(row.data() + 1, loose.size(), 2);
        all.push_back({row[0], shares.col(0), shares.col(1)});
      }
    if (all.empty() || loads.isZero(0.))
      return {};
    const WeakestMotion   weakest(std::move(all), loads);
    const Eigen::VectorXd a = weakest.motion();
    if (!a.allFinite() || a.isZero(0.))
      return {};
    const double held = weakest.held_part(a);
    if (!(held < below))
      return {};
    RigidMotion motion = loose.front();
    motion.amplitudes.setZero();
    for (std::size_t m = 0; m < loose.size(); ++m)
      motion.amplitudes -= a[m] * loose[m].amplitudes; // G'a is opposite to the motion of the bodies
    motion.amplitudes.normalize();
    return Overload{motion, held, -loads.dot(a) / a.norm()};
  }
} // namespace slipstick::tfeti
