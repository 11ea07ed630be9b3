#include "dense_solver.h"

#include <Eigen/SVD>

#include <cmath>
#include <limits>

namespace slipstick::random
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();

    // Directions, ranks: relative to the largest.
    constexpr double rank_tolerance = 1e-9;
    // A motion that the rows resist less than this (relative) counts as free, as of a round body in a round hole: only how
    // far chords are from the arc resists it.
    constexpr double least_hold = 1e-5;
    // Rows that resist a motion by less than this part of the motion resisted most do not hold it.
    constexpr double least_resistance = 1e-2;
    // A solution is one when all conditions hold to this.
    constexpr double solved_tolerance = 1e-11;
    // Rounding of displacements as files have them, relative to the largest: twice half a unit in the last place.
    constexpr double single_precision = 1.2e-7;
    // Strictly inside, strictly pressed: above this.
    constexpr double strict = 1e-7;
    // Loads that no admissible forces balance, relative: above this there are none.
    constexpr double infeasible_tolerance = 1e-6;

    /// Orthonormal basis of the kernel of A, whose entries are 1 in size unless all of them are rounding.
    Eigen::MatrixXd kernel_of(const Eigen::MatrixXd &A, const double tolerance = rank_tolerance)
    {
      const int n = A.cols();
      if (A.rows() == 0 || n == 0)
        return Eigen::MatrixXd::Identity(n, n);
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
      int                                     rank = 0;
      while (rank < svd.singularValues().size() &&
             svd.singularValues()[rank] > tolerance * std::max(svd.singularValues()[0], 1.))
        ++rank;
      return svd.matrixV().rightCols(n - rank);
    }

    /// Convex quadratic programme min 1/2 x'Wx - q'x, T'x = e, l <= x <= u by Mehrotra's predictor-corrector method.
    /// @return residuals at the end, relative; a: multipliers of T'x = e.
    double quadratic_programme(const Eigen::MatrixXd &W,
                               const Eigen::VectorXd &q,
                               const Eigen::MatrixXd &T,
                               const Eigen::VectorXd &e,
                               const Eigen::VectorXd &l,
                               const Eigen::VectorXd &u,
                               Eigen::VectorXd       &x,
                               Eigen::VectorXd       &a)
    {
      const int    m = W.rows(), k = T.cols();
      const double size =
        std::max({m > 0 ? q.cwiseAbs().maxCoeff() : 0., k > 0 ? e.cwiseAbs().maxCoeff() : 0., 1e-300});
      std::vector<char> has_l(m), has_u(m), is_fixed(m);
      Eigen::VectorXd   zl = Eigen::VectorXd::Zero(m), zu = zl;
      x = zl;
      a = Eigen::VectorXd::Zero(k);
      for (int i = 0; i < m; ++i)
        {
          is_fixed[i] = u[i] - l[i] <= 1e-14 * size;
          has_l[i]    = l[i] > -infinity && !is_fixed[i];
          has_u[i]    = u[i] < infinity && !is_fixed[i];
          if (is_fixed[i])
            x[i] = (l[i] + u[i]) / 2;
          else if (has_l[i] && has_u[i])
            x[i] = (l[i] + u[i]) / 2;
          else if (has_l[i])
            x[i] = l[i] + size;
          zl[i] = has_l[i] ? size : 0.;
          zu[i] = has_u[i] ? size : 0.;
        }
      double          best   = infinity;
      Eigen::VectorXd best_x = x, best_a = a;
      for (unsigned int iteration = 0; iteration < 100; ++iteration)
        {
          Eigen::VectorXd dual = W * x - q - T * a - zl + zu;
          for (int i = 0; i < m; ++i)
            if (is_fixed[i])
              dual[i] = 0;
          const Eigen::VectorXd primal = e - T.transpose() * x;
          double                gap = 0, worst_pair = 0;
          int                   n = 0;
          for (int i = 0; i < m; ++i)
            {
              if (has_l[i])
                gap += zl[i] * (x[i] - l[i]), ++n, worst_pair = std::max(worst_pair, std::min(zl[i], x[i] - l[i]));
              if (has_u[i])
                gap += zu[i] * (u[i] - x[i]), ++n, worst_pair = std::max(worst_pair, std::min(zu[i], u[i] - x[i]));
            }
          const double mu    = n > 0 ? gap / n : 0.;
          const double error = std::max({dual.size() > 0 ? dual.cwiseAbs().maxCoeff() : 0.,
                                         primal.size() > 0 ? primal.cwiseAbs().maxCoeff() : 0.,
                                         worst_pair}) /
                               size;
          if (!std::isfinite(error))
            break;
          if (error < best)
            {
              best   = error;
              best_x = x;
              best_a = a;
            }
          if (error < 1e-14 || (iteration > 60 && error > 10 * best))
            break;

          Eigen::MatrixXd M(m + k, m + k);
          M << W, -T, T.transpose(), Eigen::MatrixXd::Zero(k, k);
          for (int i = 0; i < m; ++i)
            {
              if (has_l[i])
                M(i, i) += zl[i] / (x[i] - l[i]);
              if (has_u[i])
                M(i, i) += zu[i] / (u[i] - x[i]);
              if (is_fixed[i])
                {
                  M.row(i).setZero();
                  M(i, i) = 1;
                }
            }
          const Eigen::PartialPivLU<Eigen::MatrixXd> lu(M);
          Eigen::VectorXd                            dx, da, dzl(m), dzu(m), cl = Eigen::VectorXd::Zero(m), cu = cl;
          const auto                                 step = [&](const double centre) {
            Eigen::VectorXd right(m + k);
            for (int i = 0; i < m; ++i)
              {
                double value = -dual[i];
                if (has_l[i])
                  value += -zl[i] + (centre - cl[i]) / (x[i] - l[i]);
                if (has_u[i])
                  value -= -zu[i] + (centre - cu[i]) / (u[i] - x[i]);
                right[i] = is_fixed[i] ? 0. : value;
              }
            right.tail(k)       = primal;
            Eigen::VectorXd sol = lu.solve(right);
            sol += lu.solve(right - M * sol);
            dx = sol.head(m);
            da = sol.tail(k);
            for (int i = 0; i < m; ++i)
              {
                dzl[i] = has_l[i] ? -zl[i] + (centre - cl[i] - zl[i] * dx[i]) / (x[i] - l[i]) : 0.;
                dzu[i] = has_u[i] ? -zu[i] + (centre - cu[i] + zu[i] * dx[i]) / (u[i] - x[i]) : 0.;
              }
          };
          const auto longest = [&]() {
            double length = 1 / 0.9995;
            for (int i = 0; i < m; ++i)
              {
                if (has_l[i] && dx[i] < 0)
                  length = std::min(length, -(x[i] - l[i]) / dx[i]);
                if (has_u[i] && dx[i] > 0)
                  length = std::min(length, (u[i] - x[i]) / dx[i]);
                if (has_l[i] && dzl[i] < 0)
                  length = std::min(length, -zl[i] / dzl[i]);
                if (has_u[i] && dzu[i] < 0)
                  length = std::min(length, -zu[i] / dzu[i]);
              }
            return length;
          };
          step(0);
          const double affine = std::min(1., longest());
          double       after  = 0;
          for (int i = 0; i < m; ++i)
            {
              if (has_l[i])
                after += (zl[i] + affine * dzl[i]) * (x[i] - l[i] + affine * dx[i]);
              if (has_u[i])
                after += (zu[i] + affine * dzu[i]) * (u[i] - x[i] - affine * dx[i]);
            }
          const double sigma = gap > 0 ? std::pow(std::max(after, 0.) / gap, 3.) : 0.;
          for (int i = 0; i < m; ++i)
            {
              cl[i] = has_l[i] ? dzl[i] * dx[i] : 0.;
              cu[i] = has_u[i] ? -dzu[i] * dx[i] : 0.;
            }
          step(sigma * mu);
          const double length = std::min(1., 0.9995 * longest());
          x += length * dx;
          a += length * da;
          zl += length * dzl;
          zu += length * dzu;
        }
      x = best_x;
      a = best_a;
      return best;
    }
  } // namespace

  DenseSolver::DenseSolver(const Problem &problem_, const Eigen::VectorXd *displacement)
    : problem(problem_)
  {
    condense(displacement);
  }

  void DenseSolver::condense(const Eigen::VectorXd *displacement)
  {
    const int m = problem.rows.size();
    u0          = Eigen::VectorXd::Zero(problem.f.size());
    std::vector<std::vector<const HeldDirection *>> held(problem.positions.size()), springs(problem.positions.size());
    for (const auto &one : problem.held)
      (one.stiffness > 0 ? springs : held)[one.node].push_back(&one);

    precise_d    = PreciseVector::Zero(m);
    precise_W    = PreciseMatrix::Zero(m, m);
    first_motion = {0};
    std::vector<Eigen::MatrixXd> all_T;
    std::vector<Eigen::VectorXd> all_e;
    for (const Body &body : problem.bodies)
      {
        const int       n = body.K.rows(), first_node = body.first / 2;
        Eigen::MatrixXd K = body.K, basis = Eigen::MatrixXd::Zero(n, n);
        Eigen::VectorXd f = problem.f.segment(body.first, n), prescribed = Eigen::VectorXd::Zero(n);
        int             n_free = 0;
        Eigen::Vector2d middle = Eigen::Vector2d::Zero();
        for (int i = 0; i < n / 2; ++i)
          middle += problem.positions[first_node + i] / (n / 2);
        double length = 0;
        for (int i = 0; i < n / 2; ++i)
          {
            const int node = first_node + i;
            length         = std::max(length, (problem.positions[node] - middle).norm());
            for (const auto *spring : springs[node])
              K.block<2, 2>(2 * i, 2 * i) += spring->stiffness * spring->direction * spring->direction.transpose();
            const auto &directions = held[node];
            if (directions.size() >= 2)
              {
                Eigen::Matrix2d D;
                D << directions[0]->direction.transpose(), directions[1]->direction.transpose();
                prescribed.segment<2>(2 * i) =
                  D.inverse() * Eigen::Vector2d(directions[0]->value, directions[1]->value);
              }
            else if (directions.size() == 1)
              {
                const Eigen::Vector2d along  = directions[0]->direction;
                prescribed.segment<2>(2 * i) = along * directions[0]->value / along.squaredNorm();
                basis(2 * i, n_free)         = -along[1] / along.norm();
                basis(2 * i + 1, n_free++)   = along[0] / along.norm();
              }
            else
              {
                basis(2 * i, n_free++)     = 1;
                basis(2 * i + 1, n_free++) = 1;
              }
          }
        Z.push_back(basis.leftCols(n_free));
        u0.segment(body.first, n) = prescribed;
        // rigid motions that supports and springs leave
        Eigen::MatrixXd R(n, 3);
        for (int i = 0; i < n / 2; ++i)
          {
            const Eigen::Vector2d x = (problem.positions[first_node + i] - middle) / length;
            R.row(2 * i) << 1, 0, -x[1];
            R.row(2 * i + 1) << 0, 1, x[0];
          }
        std::vector<Eigen::RowVector3d> resisted;
        for (int i = 0; i < n / 2; ++i)
          for (const auto *list : {&held[first_node + i], &springs[first_node + i]})
            for (const auto *one : *list)
              resisted.push_back(one->direction.transpose() * R.middleRows<2>(2 * i));
        Eigen::MatrixXd resists(resisted.size(), 3);
        for (unsigned int i = 0; i < resisted.size(); ++i)
          resists.row(i) = resisted[i];
        Eigen::MatrixXd motions = Z.back().transpose() * (R * kernel_of(resists, least_hold));
        if (motions.cols() > 0)
          motions = Eigen::HouseholderQR<Eigen::MatrixXd>(motions).householderQ() *
                    Eigen::MatrixXd::Identity(motions.rows(), motions.cols());
        N.push_back(motions);
        first_motion.push_back(first_motion.back() + motions.cols());

        H.push_back(Z.back().transpose() * K * Z.back());
        if (n_free > 0)
          H.back() += H.back().trace() / n_free * motions * motions.transpose();
        factor.emplace_back(H.back());

        C.push_back(Eigen::MatrixXd::Zero(m, n_free));
        Eigen::MatrixXd full = Eigen::MatrixXd::Zero(m, n);
        for (int r = 0; r < m; ++r)
          for (const auto &[unknown, value] : problem.rows[r].b)
            if (unknown >= body.first && unknown < body.first + n)
              full(r, unknown - body.first) = value;
        C.back()                   = full * Z.back();
        const Eigen::VectorXd load = Z.back().transpose() * (f - K * prescribed);
        precise_d += full.cast<Precise>() * prescribed.cast<Precise>();
        if (n_free > 0)
          {
            const unsigned int  b      = factor.size() - 1;
            const PreciseMatrix of_row = C.back().cast<Precise>();
            precise_d += of_row * solve_stiffness(b, load);
            precise_W += of_row * solve_stiffness(b, C.back().transpose());
          }
        all_T.push_back(C.back() * motions);
        all_e.push_back(motions.transpose() * load);
        size_of_e += motions.cols() > 0 ? (f - K * prescribed).cwiseAbs().sum() : 0.;
      }
    T.resize(m, first_motion.back());
    e.resize(first_motion.back());
    for (unsigned int b = 0; b < all_T.size(); ++b)
      {
        T.middleCols(first_motion[b], all_T[b].cols()) = all_T[b];
        e.segment(first_motion[b], all_e[b].size())    = all_e[b];
      }

    fixed_bound = Eigen::VectorXd::Zero(m);
    mu          = Eigen::VectorXd::Constant(m, -1);
    row_scale.resize(m);
    for (int r = 0; r < m; ++r)
      {
        row_scale[r] = precise_W(r, r) > 0 ? 1 / std::sqrt(static_cast<double>(precise_W(r, r))) : 1.;
        normal_of.push_back(problem.rows[r].normal);
      }
    for (int r = 0; r < m; ++r)
      {
        const Row &row = problem.rows[r];
        precise_d[r] -= row.c;
        fixed_bound[r] = row.bound / row_scale[r];
        if (row.kind == RowKind::tangential && row.mu >= 0)
          {
            mu[r]      = row.mu * row_scale[row.normal] / row_scale[r];
            is_coulomb = true;
          }
      }
    const PreciseVector precise_scale = row_scale.cast<Precise>();
    precise_W                         = precise_scale.asDiagonal() * precise_W * precise_scale.asDiagonal();
    precise_d                         = precise_d.cwiseProduct(precise_scale);
    W                                 = precise_W.cast<double>();
    d                                 = precise_d.cast<double>();
    T                                 = row_scale.asDiagonal() * T;
    given                             = Eigen::VectorXd::Zero(T.cols());
    if (displacement)
      {
        hold_free_motions(*displacement);
        return;
      }
    motions = Eigen::MatrixXd::Identity(T.cols(), T.cols());
    motion_scale.setOnes(T.cols());
    for (unsigned int b = 0; b < N.size();
         ++b) // of a body, whose motions are of one size: one that nothing resists keeps 0
      {
        const auto   of_body = T.middleCols(first_motion[b], N[b].cols());
        const double norm    = N[b].cols() > 0 ? of_body.colwise().norm().maxCoeff() : 0.;
        if (norm > 0)
          motion_scale.segment(first_motion[b], N[b].cols()).setConstant(1 / norm);
      }
    T = T * motion_scale.asDiagonal();
    e = e.cwiseProduct(motion_scale);
    size_of_e *= motion_scale.size() > 0 ? motion_scale.maxCoeff() : 0.;
    for (int k = 0; k < e.size(); ++k)
      if (std::abs(e[k]) < 1e-13 * size_of_e)
        e[k] = 0;
  }

  /// Takes motions that rows do not hold out of T and e; they are as in @p displacement.
  void DenseSolver::hold_free_motions(const Eigen::VectorXd &displacement)
  {
    const Eigen::MatrixXd held = kernel_of(T / T.colwise().norm().maxCoeff(), least_resistance);
    given                      = held * (held.transpose() * amplitudes(displacement));
    d += T * given;
    precise_d    = d.cast<Precise>();
    motions      = Eigen::HouseholderQR<Eigen::MatrixXd>(held).householderQ();
    motions      = motions.rightCols(T.cols() - held.cols()).eval();
    T            = (T * motions).eval();
    e            = (motions.transpose() * e).eval();
    motion_scale = T.colwise().norm().cwiseInverse();
    T            = (T * motion_scale.asDiagonal()).eval();
    e            = e.cwiseProduct(motion_scale).eval();
  }

  Eigen::VectorXd DenseSolver::amplitudes(const Eigen::VectorXd &displacement) const
  {
    Eigen::VectorXd result(first_motion.back());
    for (unsigned int b = 0; b < problem.bodies.size(); ++b)
      result.segment(first_motion[b], N[b].cols()) =
        N[b].transpose() * (Z[b].transpose() * displacement.segment(problem.bodies[b].first, Z[b].rows()));
    return result;
  }

  /// H^-1 times columns: the factor in double precision, corrected until what rounding left is that of extended precision.
  DenseSolver::PreciseMatrix DenseSolver::solve_stiffness(const unsigned int body, const Eigen::MatrixXd &right) const
  {
    constexpr unsigned int n_corrections = 2;
    const PreciseMatrix    precise_H = H[body].cast<Precise>(), precise_right = right.cast<Precise>();
    PreciseMatrix          x = factor[body].solve(right).cast<Precise>();
    for (unsigned int k = 0; k < n_corrections; ++k)
      {
        const PreciseMatrix left = precise_right - precise_H * x;
        x += factor[body].solve(left.cast<double>()).cast<Precise>();
      }
    return x;
  }

  Eigen::VectorXd DenseSolver::bounds(const Eigen::VectorXd &x) const
  {
    Eigen::VectorXd bound = fixed_bound;
    for (int r = 0; r < x.size(); ++r)
      if (mu[r] >= 0)
        bound[r] = mu[r] * std::max(x[normal_of[r]], 0.);
    return bound;
  }

  Eigen::VectorXd DenseSolver::jumps(const Point &at) const
  {
    return d - W * at.x + T * at.a;
  }

  double DenseSolver::scale(const Eigen::VectorXd &x) const
  {
    double size = 1e-300;
    if (x.size() > 0)
      {
        // where nothing presses, displacements in single precision are all there is
        const double forces = x.cwiseAbs().maxCoeff(), jumps = d.cwiseAbs().maxCoeff();
        size = std::max({size, forces, forces > strict * jumps ? 1e-3 * jumps : jumps});
      }
    return size;
  }

  double DenseSolver::residual(const Point &at, const Eigen::VectorXd &bound) const
  {
    double                worst = e.size() > 0 ? (T.transpose() * at.x - e).cwiseAbs().maxCoeff() : 0.;
    const Eigen::VectorXd j     = jumps(at);
    for (int r = 0; r < j.size(); ++r)
      {
        const double moved = at.x[r] + j[r];
        double       there = moved;
        if (problem.rows[r].kind == RowKind::normal)
          there = std::max(moved, 0.);
        else if (problem.rows[r].kind == RowKind::tangential)
          there = std::clamp(moved, -bound[r], bound[r]);
        worst = std::max(worst, std::abs(at.x[r] - there));
      }
    return worst / scale(at.x);
  }

  double DenseSolver::residual(const Point &at) const
  {
    return residual(at, bounds(at.x));
  }

  // Forces are sums of rays and bounded ones; least squares of what they leave of the loads.
  bool DenseSolver::feasible(Eigen::VectorXd &x, double &missing) const
  {
    const int                          m = W.rows();
    std::vector<Eigen::VectorXd>       columns;
    std::vector<double>                lower, upper;
    std::vector<std::array<double, 2>> ray; // part of tangential row
    std::vector<std::array<int, 2>>    rows;
    const auto add = [&](const int r, const int t, const double part, const double l, const double u) {
      Eigen::VectorXd column = T.row(r).transpose();
      if (t >= 0)
        column += part * T.row(t).transpose();
      columns.push_back(column);
      rows.push_back({{r, t}});
      ray.push_back({{1., part}});
      lower.push_back(l);
      upper.push_back(u);
    };
    std::vector<char> has_friction(m, 0);
    for (int r = 0; r < m; ++r)
      if (mu[r] >= 0)
        {
          has_friction[normal_of[r]] = 1;
          add(normal_of[r], r, mu[r], 0, infinity);
          add(normal_of[r], r, -mu[r], 0, infinity);
        }
    for (int r = 0; r < m; ++r)
      if (problem.rows[r].kind == RowKind::bond)
        add(r, -1, 0, -infinity, infinity);
      else if (problem.rows[r].kind == RowKind::normal && !has_friction[r])
        add(r, -1, 0, 0, infinity);
      else if (problem.rows[r].kind == RowKind::tangential && mu[r] < 0)
        add(r, -1, 0, -fixed_bound[r], fixed_bound[r]);
    x       = Eigen::VectorXd::Zero(m);
    missing = 0;
    if (e.size() == 0 || e.norm() == 0)
      return true;
    const int       n = columns.size();
    Eigen::MatrixXd A(e.size(), n);
    Eigen::VectorXd l(n), u(n), y, a;
    for (int i = 0; i < n; ++i)
      {
        A.col(i) = columns[i];
        l[i]     = lower[i];
        u[i]     = upper[i];
      }
    const Eigen::MatrixXd W1 = A.transpose() * A + 1e-12 * Eigen::MatrixXd::Identity(n, n);
    quadratic_programme(W1, A.transpose() * e, Eigen::MatrixXd(n, 0), Eigen::VectorXd(0), l, u, y, a);
    missing = (e - A * y).norm() / e.norm();
    for (int i = 0; i < n; ++i)
      {
        x[rows[i][0]] += y[i];
        if (rows[i][1] >= 0)
          x[rows[i][1]] += ray[i][1] * y[i];
      }
    return missing < infeasible_tolerance;
  }

  bool DenseSolver::interior_point(const Eigen::VectorXd &bound, Point &at) const
  {
    const int       m = W.rows();
    Eigen::VectorXd l = Eigen::VectorXd::Constant(m, -infinity), u = -l;
    for (int r = 0; r < m; ++r)
      if (problem.rows[r].kind == RowKind::normal)
        l[r] = 0;
      else if (problem.rows[r].kind == RowKind::tangential)
        {
          l[r] = -bound[r];
          u[r] = bound[r];
        }
    return quadratic_programme(W, d, T, e, l, u, at.x, at.a) < 1e-6;
  }

  DenseSolver::States DenseSolver::states(const Point &at, const Eigen::VectorXd &bound, const double step) const
  {
    const Eigen::VectorXd j = jumps(at);
    States                set(j.size(), State::free);
    for (int r = 0; r < j.size(); ++r)
      {
        const double moved = at.x[r] + step * j[r];
        if (problem.rows[r].kind == RowKind::normal && moved <= 0)
          set[r] = State::zero;
        else if (problem.rows[r].kind == RowKind::tangential)
          {
            if (bound[r] <= 0)
              set[r] = State::zero;
            else if (moved >= bound[r])
              set[r] = State::upper;
            else if (moved <= -bound[r])
              set[r] = State::lower;
          }
      }
    for (int r = 0; r < j.size(); ++r) // no friction where nothing presses; where something does it may begin
      if (mu[r] >= 0)
        {
          if (set[normal_of[r]] == State::zero || mu[r] == 0)
            set[r] = State::zero;
          else if (set[r] == State::zero)
            set[r] = j[r] > 0 ? State::upper : j[r] < 0 ? State::lower : State::free;
        }
    return set;
  }

  // The law with its inequalities decided: x = G y + h with the free entries y, jumps of them zero.
  bool DenseSolver::solve_set(const States &set, const Eigen::VectorXd *bound, Point &at) const
  {
    const int        m = W.rows(), k = T.cols();
    std::vector<int> number(m, -1), free;
    for (int r = 0; r < m; ++r)
      if (set[r] == State::free)
        {
          number[r] = free.size();
          free.push_back(r);
        }
    const int       n = free.size();
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(m, n);
    Eigen::VectorXd h = Eigen::VectorXd::Zero(m);
    for (int r = 0; r < m; ++r)
      if (set[r] == State::free)
        G(r, number[r]) = 1;
      else if (set[r] != State::zero)
        {
          const double sign = set[r] == State::upper ? 1 : -1;
          if (mu[r] < 0)
            h[r] = sign * fixed_bound[r];
          else if (bound != nullptr)
            h[r] = sign * (*bound)[r];
          else if (number[normal_of[r]] >= 0)
            G(r, number[normal_of[r]]) = sign * mu[r];
        }
    const PreciseMatrix WG = precise_W * G.cast<Precise>();
    const PreciseVector Wh = precise_d - precise_W * h.cast<Precise>();
    PreciseMatrix       precise_M(n + k, n + k);
    PreciseVector       right(n + k), solution(n + k);
    precise_M.bottomRightCorner(k, k).setZero();
    precise_M.bottomLeftCorner(k, n) = (T.transpose() * G).cast<Precise>();
    for (int i = 0; i < n; ++i)
      {
        precise_M.row(i).head(n) = WG.row(free[i]);
        precise_M.row(i).tail(k) = -T.row(free[i]).cast<Precise>();
        right[i]                 = Wh[free[i]];
      }
    right.tail(k)              = (e - T.transpose() * h).cast<Precise>();
    const Eigen::MatrixXd M    = precise_M.cast<double>();
    const double          size = std::max({right.size() > 0 ? double(right.cwiseAbs().maxCoeff()) : 0., scale(at.x)});
    const auto            left = [&] { return Eigen::VectorXd((right - precise_M * solution).cast<double>()); };
    // factors in double precision, residuals in extended precision
    const auto solve_by = [&](const auto &factors) {
      constexpr unsigned int n_corrections = 4;
      solution = factors.solve(Eigen::VectorXd(right.cast<double>())).template cast<Precise>();
      for (unsigned int correction = 0; correction < n_corrections; ++correction)
        solution += factors.solve(left()).template cast<Precise>();
    };
    if (n + k > 0)
      {
        solve_by(Eigen::PartialPivLU<Eigen::MatrixXd>(M));
        if (!solution.allFinite() || left().cwiseAbs().maxCoeff() > 1e-12 * size ||
            solution.cwiseAbs().maxCoeff() > 1e8 * size)
          {
            Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> cod;
            cod.setThreshold(1e-11);
            cod.compute(M);
            solve_by(cod);
          }
        if (!solution.allFinite())
          return false;
      }
    at.x = G * solution.head(n).cast<double>() + h;
    at.a = solution.tail(k).cast<double>();
    return true;
  }

  // Sets corrected until all conditions hold; bound: given ones, else the Coulomb law itself.
  bool DenseSolver::follow_sets(const Eigen::VectorXd *bound, Point &at) const
  {
    Point  now = at;
    States set = states(now, bound != nullptr ? *bound : bounds(now.x), 1.);
    for (unsigned int iteration = 0; iteration < 30; ++iteration)
      {
        if (!solve_set(set, bound, now))
          return false;
        const Eigen::VectorXd present = bound != nullptr ? *bound : bounds(now.x);
        if (residual(now, present) < solved_tolerance)
          {
            at = now;
            return true;
          }
        const States next = states(now, present, iteration < 15 ? 1. : 0.1);
        if (next == set)
          return false;
        set = next;
      }
    return false;
  }

  DenseSolution DenseSolver::solve() const
  {
    DenseSolution   solution;
    Eigen::VectorXd x;
    if (T.cols() > 0 && kernel_of(T, least_hold).cols() > 0)
      {
        solution.outcome = Outcome::loose;
        return solution;
      }
    if (!feasible(x, solution.margin))
      {
        solution.outcome = Outcome::infeasible;
        return solution;
      }
    Point              at{x, Eigen::VectorXd::Zero(T.cols())};
    Eigen::VectorXd    bound   = bounds(x);
    const unsigned int n_tries = is_coulomb ? 60 : 1;
    double             damping = 1;
    for (unsigned int k = 0; k < n_tries; ++k)
      {
        solution.bound_iterations = k;
        Point next                = at;
        interior_point(bound, next);
        Point polished = next;
        if (follow_sets(is_coulomb ? nullptr : &bound, polished))
          {
            at               = polished;
            solution.outcome = Outcome::solved;
            break;
          }
        polished = next;
        if (is_coulomb && follow_sets(&bound, polished))
          next = polished;
        at = next;
        if (!is_coulomb)
          break;
        if (residual(at) < solved_tolerance)
          {
            solution.outcome = Outcome::solved;
            break;
          }
        if (k == 20)
          damping = 0.5;
        if (k == 40)
          damping = 0.2;
        bound = (1 - damping) * bound + damping * bounds(at.x);
      }
    solution.residual = residual(at);
    if (solution.outcome != Outcome::solved && !is_coulomb && solution.residual < 1e-8) // sets that rounding decides
      solution.outcome = Outcome::solved;
    if (solution.outcome == Outcome::solved)
      examine(at, solution);
    solution.x = at.x.cwiseProduct(row_scale);
    solution.u = displacements(at);
    return solution;
  }

  // What the conditions leave open: motions with all forces as they are, forces with all jumps as they are.
  void DenseSolver::examine(const Point &at, DenseSolution &solution) const
  {
    const Eigen::VectorXd j = jumps(at), bound = bounds(at.x);
    const double          size = scale(at.x);
    std::vector<int>      strictly, movable;
    for (int r = 0; r < j.size(); ++r)
      {
        const auto kind   = problem.rows[r].kind;
        const bool inside = kind == RowKind::bond || (kind == RowKind::normal && at.x[r] > strict * size) ||
                            (kind == RowKind::tangential && std::abs(at.x[r]) < bound[r] - strict * size);
        const bool is_still = std::abs(j[r]) < strict * size;
        if (inside)
          strictly.push_back(r);
        if (inside || (is_still && (kind == RowKind::normal || bound[r] > 0)))
          movable.push_back(r);
      }
    Eigen::MatrixXd holds(strictly.size(), T.cols()), M(W.rows() + T.cols(), movable.size());
    for (unsigned int i = 0; i < strictly.size(); ++i)
      holds.row(i) = T.row(strictly[i]);
    for (unsigned int i = 0; i < movable.size(); ++i)
      {
        M.col(i).head(W.rows()) = W.col(movable[i]);
        M.col(i).tail(T.cols()) = T.row(movable[i]).transpose();
      }
    const Eigen::MatrixXd open = kernel_of(holds, least_hold);
    solution.position_unique   = T.cols() == 0 || open.cols() == 0;
    solution.forces_unique     = movable.empty() || kernel_of(M).cols() == 0;
    if (!solution.position_unique)
      solution.free_motions = displacements_under(open);
  }

  Eigen::MatrixXd DenseSolver::displacements_under(const Eigen::MatrixXd &scaled) const
  {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(problem.f.size(), scaled.cols());
    for (unsigned int b = 0; b < N.size(); ++b)
      result.middleRows(problem.bodies[b].first, Z[b].rows()) =
        Z[b] * (N[b] * (motions * motion_scale.asDiagonal() * scaled).middleRows(first_motion[b], N[b].cols()));
    return result;
  }

  Eigen::VectorXd DenseSolver::displacements(const Point &at) const
  {
    Eigen::VectorXd       u = u0;
    const Eigen::VectorXd x = at.x.cwiseProduct(row_scale), a = given + motions * at.a.cwiseProduct(motion_scale);
    for (unsigned int b = 0; b < problem.bodies.size(); ++b)
      {
        const Body           &body = problem.bodies[b];
        const int             n    = body.K.rows();
        const Eigen::VectorXd load =
          Z[b].transpose() * (problem.f.segment(body.first, n) - body.K * u0.segment(body.first, n)) -
          C[b].transpose() * x;
        if (Z[b].cols() > 0)
          u.segment(body.first, n) +=
            Z[b] * (solve_stiffness(b, load).cast<double>() + N[b] * a.segment(first_motion[b], N[b].cols()));
      }
    return u;
  }

  Violation DenseSolver::check(const Eigen::VectorXd &x, const Eigen::VectorXd &u) const
  {
    Point at{x.cwiseQuotient(row_scale), Eigen::VectorXd::Zero(T.cols())};
    at.a = (motions.transpose() * amplitudes(u - displacements(at))).cwiseQuotient(motion_scale);
    // u comes in single precision: rows that hold with equality tell the rigid part better
    const Eigen::VectorXd bound = bounds(at.x);
    const double          size  = scale(at.x);
    std::vector<int>      held;
    for (int r = 0; r < at.x.size(); ++r)
      if (problem.rows[r].kind == RowKind::bond ||
          (problem.rows[r].kind == RowKind::normal && at.x[r] > strict * size) ||
          (problem.rows[r].kind == RowKind::tangential && std::abs(at.x[r]) < bound[r] - strict * size))
        if (T.row(r).norm() > least_hold)
          held.push_back(r);
    if (!held.empty() && T.cols() > 0)
      {
        const Eigen::VectorXd j = jumps(at);
        Eigen::MatrixXd       A(held.size(), T.cols());
        Eigen::VectorXd       b(held.size());
        for (unsigned int i = 0; i < held.size(); ++i)
          {
            A.row(i) = T.row(held[i]);
            b[i]     = -j[held[i]];
          }
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> cod;
        cod.setThreshold(1e-6);
        cod.compute(A);
        at.a += cod.solve(b);
      }
    Violation violation;
    violation.equilibrium = e.size() > 0 ? (T.transpose() * at.x - e).cwiseAbs().maxCoeff() / size : 0.;
    const double largest  = std::max(u.cwiseAbs().maxCoeff(), 1e-13 * problem.size);
    const double rounding =
      at.x.size() > 0 ? single_precision * largest * row_scale.maxCoeff() / size : 0.; // of u in jumps
    violation.law          = std::max(0., residual(at) - rounding);
    violation.displacement = (u - displacements(at)).cwiseAbs().maxCoeff() / largest;
    return violation;
  }

  Eigen::VectorXd DenseSolver::nodal_forces(const Eigen::VectorXd &x) const
  {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(problem.f.size());
    for (unsigned int r = 0; r < problem.rows.size(); ++r)
      for (const auto &[unknown, value] : problem.rows[r].b)
        force[unknown] += value * x[r];
    for (unsigned int b = 0; b < problem.bodies.size(); ++b) // the rest is for the supports
      {
        auto there = force.segment(problem.bodies[b].first, Z[b].rows());
        there      = (Z[b] * (Z[b].transpose() * there)).eval();
      }
    return force;
  }

  double DenseSolver::energy(const Eigen::VectorXd &u) const
  {
    double sum = 0;
    for (const Body &body : problem.bodies)
      {
        const auto part = u.segment(body.first, body.K.rows());
        sum += part.dot(body.K * part) / 2;
      }
    return sum;
  }
} // namespace slipstick::random
