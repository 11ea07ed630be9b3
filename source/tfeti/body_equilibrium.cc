#include <slipstick/base/gather.h>
#include <slipstick/tfeti/body_equilibrium.h>
#include <slipstick/tfeti/gathered_by_label.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace slipstick::tfeti
{
  namespace
  {
    // Maximum number of Newton steps of one search; piecewise quadratic functions of a few variables take about five.
    constexpr unsigned int most_search_steps = 50;
    // A step must reduce the imbalance by this part times its length; otherwise it is halved, down to the shortest.
    constexpr double search_decrease = 1e-4, shortest_search_step = 1e-6;
    // Maximum number of rounds: Newton's method with fixed bounds, then with bounds that follow the normal forces.
    constexpr unsigned int max_rounds = 5;
    // Equilibrium to rounding: imbalance below this part of the sum of all forces.
    constexpr double balanced = 1e-12;
    // Regularisation of motions that no row inside its bounds resists: this part of the stiffness of all rows.
    constexpr double regularization = 1e-10;
    // Jumps below this part of the largest are rounding of zero.
    constexpr double negligible_share = 1e-10;
  } // namespace

  BodyEquilibrium::BodyEquilibrium(const BodyMotions &bodies, const Constraints &constraints, const MPI_Comm comm_)
    : comm(comm_)
    , place_of(constraints.kind.size(), -1)
  {
    std::vector<bool> is_equality_row(constraints.kind.size());
    for (unsigned int r = 0; r < is_equality_row.size(); ++r)
      is_equality_row[r] = is_equality(constraints.kind[r]);
    motions = bodies.free(is_equality_row);
    if (motions.empty())
      return;

    using Jumps = std::vector<std::pair<unsigned int, double>>; // of a row: motion, jump under the unit motion
    const Eigen::SparseMatrix<double, Eigen::RowMajor> jumps = bodies.jumps(motions);
    const double                                       largest =
      dealii::Utilities::MPI::max(jumps.nonZeros() > 0 ? jumps.coeffs().abs().maxCoeff() : 0., comm);
    std::vector<std::uint64_t> labels;
    std::vector<Jumps>         values;
    for (unsigned int r = 0; r < is_equality_row.size(); ++r)
      {
        Jumps of_row;
        for (decltype(jumps)::InnerIterator jump(jumps, r); jump && !is_equality_row[r]; ++jump)
          if (std::abs(jump.value()) > negligible_share * largest)
            of_row.emplace_back(jump.col(), jump.value());
        if (of_row.empty())
          continue;
        own.push_back(r);
        labels.push_back(constraints.label[r]);
        values.push_back(std::move(of_row));
      }
    const auto                          all = gathered_by_label(labels, values, comm);
    std::map<std::uint64_t, int>        place;
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto &[label, row] : all)
      {
        const int i = place.size();
        place.emplace(label, i);
        for (const auto &[motion, jump] : row)
          entries.emplace_back(i, motion, jump);
      }
    shares.resize(all.size(), motions.size());
    shares.setFromTriplets(entries.begin(), entries.end());
    by_columns = shares;
    magnitudes = shares.cwiseAbs();
    for (std::size_t i = 0; i < own.size(); ++i)
      place_of[own[i]] = place.at(labels[i]);
  }

  void BodyEquilibrium::set_loads(const Eigen::VectorXd &of_bodies)
  {
    all_loads.resize(motions.size());
    for (std::size_t m = 0; m < motions.size(); ++m)
      all_loads[m] = motions[m].amplitudes.dot(of_bodies);
  }

  std::vector<BodyEquilibrium::Row> BodyEquilibrium::gathered(const std::vector<double>                  &t,
                                                              const std::vector<double>                  &k,
                                                              const qp::AdmissibleSet<DistributedVector> &bounds) const
  {
    constexpr unsigned int width = 9;
    std::vector<double>    numbers;
    for (const unsigned int r : own)
      {
        const double l = bounds.box.lower.local_element(r), u = bounds.box.upper.local_element(r);
        numbers.insert(numbers.end(), {double(place_of[r]), t[r], k[r], l, u, -1., 0., 0., 0.});
      }
    for (const auto &bound : bounds.pressure_bounds)
      if (place_of[bound.tangential] >= 0 && bound.normal != qp::no_entry && place_of[bound.normal] >= 0)
        {
          double *row =
            numbers.data() + width * (std::lower_bound(own.begin(), own.end(), bound.tangential) - own.begin());
          row[5] = place_of[bound.normal];
          row[6] = bound.forces.fixed;
          row[7] = bound.forces.coefficient;
          row[8] = bound.forces.cap;
        }
    std::vector<Row> result(shares.rows());
    for (const auto &of_rank : all_gather(comm, numbers))
      for (std::size_t i = 0; i < of_rank.size(); i += width)
        {
          const double *n                        = of_rank.data() + i;
          result[static_cast<std::size_t>(n[0])] = {n[1], n[2], n[3], n[4], static_cast<int>(n[5]), {n[6], n[7], n[8]}};
        }
    return result;
  }

  void BodyEquilibrium::follow_pressures(const Eigen::VectorXd &a, std::vector<Row> &rows) const
  {
    const Eigen::VectorXd slips = shares * a;
    for (Row &row : rows)
      if (row.follows >= 0)
        {
          const Row   &normal = rows[row.follows];
          const double force  = qp::clip(normal.t - normal.k * slips[row.follows], normal.lower, normal.upper);
          row.upper           = row.forces.radius(force);
          row.lower           = -row.upper;
        }
  }

  Eigen::VectorXd BodyEquilibrium::clipped(const std::vector<Row> &rows, const Eigen::VectorXd &moved)
  {
    Eigen::VectorXd forces(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      forces[i] = qp::clip(moved[i], rows[i].lower, rows[i].upper);
    return forces;
  }

  // Derivative of clipped() with respect to `moved`, times k, for fixed bounds.
  Eigen::VectorXd BodyEquilibrium::stiffness_of(const std::vector<Row> &rows, const Eigen::VectorXd &moved)
  {
    Eigen::VectorXd stiffness(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      stiffness[i] = moved[i] > rows[i].lower && moved[i] < rows[i].upper ? rows[i].k : 0.;
    return stiffness;
  }

  // Minimum along a + s p: the slope is sum_i -S_i p clip(t_i - k_i (slip_i + s along_i)) + L'p, which grows with s.
  double BodyEquilibrium::line_minimum(const std::vector<Row> &rows,
                                       const Eigen::VectorXd  &slips,
                                       const Eigen::VectorXd  &along,
                                       const double            load) const
  {
    const auto slope = [&](const double s) {
      double sum = load;
      for (std::size_t i = 0; i < rows.size(); ++i)
        sum -= along[i] * qp::clip(rows[i].t - rows[i].k * (slips[i] + s * along[i]), rows[i].lower, rows[i].upper);
      return sum;
    };
    std::vector<double> kinks;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (along[i] != 0 && rows[i].k > 0)
        for (const double bound : {rows[i].lower, rows[i].upper})
          if (std::isfinite(bound))
            {
              const double s = ((rows[i].t - bound) / rows[i].k - slips[i]) / along[i];
              if (s > 0 && std::isfinite(s))
                kinks.push_back(s);
            }
    std::sort(kinks.begin(), kinks.end());
    std::size_t low = 0, high = kinks.size(); // the first kink at which the slope is not negative
    while (low < high)
      {
        const std::size_t middle = (low + high) / 2;
        slope(kinks[middle]) < 0 ? low = middle + 1 : high = middle;
      }
    const double s0 = low > 0 ? kinks[low - 1] : 0., f0 = slope(s0);
    if (!(f0 < 0))
      return s0;
    const double s1 = low < kinks.size() ? kinks[low] : s0 + std::max(1., s0), f1 = slope(s1);
    if (!(f1 > f0))
      return HUGE_VAL; // no further resistance: friction cannot bear the loads
    return s0 - f0 * (s1 - s0) / (f1 - f0);
  }

  bool BodyEquilibrium::minimise(const Eigen::VectorXd &loads, const std::vector<Row> &rows, Eigen::VectorXd &a) const
  {
    Eigen::VectorXd stiffness(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      stiffness[i] = rows[i].k;
    const Eigen::VectorXd least = regularization * (shares.cwiseAbs2().transpose() * stiffness);
    double                size  = 0;
    for (unsigned int step = 0; step < most_search_steps; ++step)
      {
        const Eigen::VectorXd slips = shares * a;
        Eigen::VectorXd       moved(rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i)
          moved[i] = rows[i].t - rows[i].k * slips[i];
        const Eigen::VectorXd forces = clipped(rows, moved);
        const Eigen::VectorXd slope  = loads - shares.transpose() * forces;
        size                         = std::max(size, sum_of_magnitudes(loads, forces));
        if (slope.norm() <= balanced * size)
          return true;
        Eigen::SparseMatrix<double> H = by_columns.transpose() * stiffness_of(rows, moved).asDiagonal() * by_columns;
        for (Eigen::Index m = 0; m < a.size(); ++m)
          H.coeffRef(m, m) += least[m] + std::numeric_limits<double>::min();
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(H);
        const Eigen::VectorXd                                    p = -factor.solve(slope);
        if (!(p.dot(slope) < 0) || !p.allFinite())
          return false;
        const double s = line_minimum(rows, slips, shares * p, loads.dot(p));
        if (!(s > 0) || std::isinf(s))
          return false;
        a += s * p;
      }
    return false;
  }

  double BodyEquilibrium::sum_of_magnitudes(const Eigen::VectorXd &loads, const Eigen::VectorXd &forces) const
  {
    return loads.norm() + (magnitudes.transpose() * forces.cwiseAbs()).norm();
  }

  // Imbalance and the sum of magnitudes of all forces; with bounds that follow normal forces, also the derivative.
  Eigen::VectorXd BodyEquilibrium::imbalance(const Eigen::VectorXd       &loads,
                                             std::vector<Row>            &rows,
                                             const Eigen::VectorXd       &a,
                                             double                      &size,
                                             Eigen::SparseMatrix<double> *derivative) const
  {
    follow_pressures(a, rows);
    const Eigen::VectorXd slips = shares * a;
    Eigen::VectorXd       moved(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      moved[i] = rows[i].t - rows[i].k * slips[i];
    const Eigen::VectorXd forces = clipped(rows, moved);
    size                         = sum_of_magnitudes(loads, forces);
    if (derivative)
      {
        const Eigen::VectorXd               stiffness = stiffness_of(rows, moved);
        std::vector<Eigen::Triplet<double>> entries; // derivatives of the forces with respect to the slips
        for (std::size_t i = 0; i < rows.size(); ++i)
          entries.emplace_back(i, i, -stiffness[i]);
        for (std::size_t i = 0; i < rows.size(); ++i) // rows whose bounds follow
          if (const int n = rows[i].follows; n >= 0 && forces[n] > 0)
            {
              const double length = std::abs(moved[i]);
              if (length >= rows[i].upper && length > 0)
                entries.emplace_back(i, n, -moved[i] / length * rows[i].forces.slope(rows[i].upper) * rows[n].k);
            }
        Eigen::SparseMatrix<double> by_slips(rows.size(), rows.size());
        by_slips.setFromTriplets(entries.begin(), entries.end());
        *derivative = -(by_columns.transpose() * by_slips * by_columns);
      }
    return loads - shares.transpose() * forces;
  }

  // Newton's method on the imbalance, with bounds that follow normal forces (the potential does not contain them).
  bool BodyEquilibrium::follow(const Eigen::VectorXd &loads, std::vector<Row> &rows, Eigen::VectorXd &a) const
  {
    double                      size, largest = 0;
    Eigen::SparseMatrix<double> derivative;
    Eigen::VectorXd             r = imbalance(loads, rows, a, size, &derivative);
    for (unsigned int step = 0; step < most_search_steps && r.norm() > balanced * (largest = std::max(largest, size));
         ++step)
      {
        const double scale = derivative.coeffs().size() ? derivative.coeffs().cwiseAbs().maxCoeff() : 0.;
        for (Eigen::Index m = 0; m < a.size(); ++m)
          derivative.coeffRef(m, m) += regularization * scale + std::numeric_limits<double>::min();
        Eigen::SparseLU<Eigen::SparseMatrix<double>> factor(derivative);
        if (factor.info() != Eigen::Success)
          return false;
        const Eigen::VectorXd p = -factor.solve(r);
        if (!p.allFinite())
          return false;
        double          part = 1;
        Eigen::VectorXd next = imbalance(loads, rows, a + p, size, nullptr);
        while (!(next.norm() < (1 - search_decrease * part) * r.norm()) && part > shortest_search_step)
          {
            part /= 2;
            next = imbalance(loads, rows, a + part * p, size, nullptr);
          }
        if (!(next.norm() < r.norm()))
          return false;
        a += part * p;
        r = imbalance(loads, rows, a, size, &derivative);
      }
    return r.norm() <= balanced * std::max(largest, size);
  }

  std::vector<double> BodyEquilibrium::shift(const std::vector<double>                  &t,
                                             const std::vector<double>                  &k,
                                             const qp::AdmissibleSet<DistributedVector> &bounds,
                                             const double                                tolerated) const
  {
    std::vector<Row>      rows = gathered(t, k, bounds);
    Eigen::VectorXd       a    = Eigen::VectorXd::Zero(all_loads.size());
    double                size;
    const Eigen::VectorXd r    = imbalance(all_loads, rows, a, size, nullptr);
    const double          left = std::max(tolerated, balanced) * size;
    if (r.norm() <= left)
      return std::vector<double>(t.size(), 0.);
    const Eigen::VectorXd loads = all_loads - left / r.norm() * r;
    for (unsigned int round = 0; round < max_rounds; ++round)
      {
        follow_pressures(a, rows);
        const bool is_bounded = minimise(loads, rows, a);
        if (follow(loads, rows, a) || !is_bounded)
          break;
      }
    const Eigen::VectorXd slips = shares * a;
    std::vector<double>   result(t.size(), 0.);
    for (const unsigned int row : own)
      result[row] = slips[place_of[row]];
    return result;
  }
} // namespace slipstick::tfeti
