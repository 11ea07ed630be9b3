#include <slipstick/interface/curve_pairing.h>

#include <boost/math/special_functions/sign.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    // Parts of an edge shorter than this (relative to its length) are ignored.
    constexpr double smallest_segment = 1e-12;
    // Crossings whose distances differ by at most this fraction of an edge are the same: at a node of the master.
    constexpr double same_place = 1e-9;

    // absolute, for a zero in [0, 1]: rounding of the coordinates
    constexpr double         root_tolerance   = 1e-16;
    constexpr std::uintmax_t most_evaluations = 200;

    /// Zero in [0, 1] of a continuous f with f(0) f(1) <= 0.
    template <class F>
    double zero(const F &f, const double f_0, const double f_1)
    {
      auto       evaluations = most_evaluations;
      const auto is_close    = [](const double low, const double high) { return high - low <= root_tolerance; };
      const auto [low, high] = boost::math::tools::toms748_solve(f, 0., 1., f_0, f_1, is_close, evaluations);
      return 0.5 * (low + high);
    }
  } // namespace

  CurvePairing::CurvePairing(const std::vector<Edge>   &slave_,
                             const std::vector<Edge>   &master_,
                             const Reach               &reach_,
                             const mesh::Kinematics<2> &kinematics,
                             const Corners             &corners)
    : slave(slave_)
    , master(master_)
    , reach(reach_)
    , tree(master_)
    , own(slave_, kinematics)
  {
    average_normals(corners);
  }

  /// Replaces the slave's normals by the means of both sides wherever the slave's own normal meets a master that faces
  /// it, and by that of one side at a corner of the other.
  void CurvePairing::average_normals(const Corners &corners)
  {
    const SurfaceNodes<2> of_master(master);
    std::vector<Tensor>   facing(own.nodes.size());
    std::vector<bool>     is_done(own.nodes.size(), false), is_at_corner_of_master(own.nodes.size(), false);
    for (unsigned int e = 0; e < slave.size(); ++e)
      {
        const auto near = candidates(e);
        for (unsigned int i = 0; i < slave[e].n_nodes; ++i)
          {
            const unsigned int at = own.of_part[e][i];
            const double       s  = Edge::node_coordinate(i);
            if (is_done[at])
              continue;
            is_done[at]      = true;
            const auto first = partner(e, s, near);
            if (!first)
              continue;
            // at a node of the master take the side that is most opposed to the slave, independent of the numbering of
            // edges
            const double gap  = hit(e, s, *first)->gap;
            double       best = 0;
            for (const unsigned int m : near)
              if (const auto found = hit(e, s, m); found && std::abs(found->gap - gap) <= same_place * slave[e].chord())
                {
                  const auto   N     = master[m].shape(found->s);
                  const Tensor n     = of_master.normal(m, master[m].n_nodes, N);
                  const double along = n * own.nodes[at].normal / n.norm();
                  if (along < std::min(best, facing_cosine))
                    {
                      best                       = along;
                      facing[at]                 = n / n.norm();
                      is_at_corner_of_master[at] = is_at_corner(master[m], N, corners);
                    }
                }
          }
      }
    for (unsigned int i = 0; i < facing.size(); ++i)
      {
        own.nodes[i].normal = mean_normal(own.nodes[i], facing[i], is_at_corner_of_master[i], corners);
      }
  }

  CurvePairing::Tensor CurvePairing::field(const unsigned int e, const double s) const
  {
    return own.normal(e, slave[e].n_nodes, slave[e].shape(s));
  }

  double CurvePairing::side(const unsigned int e, const double s, const dealii::Point<2> &y) const
  {
    return cross(field(e, s), y - slave[e].point(s));
  }

  std::optional<CurvePairing::Hit> CurvePairing::hit(const unsigned int e, const double s, const unsigned int m) const
  {
    const Edge            &edge = master[m];
    const dealii::Point<2> x    = slave[e].point(s);
    const Tensor           n    = field(e, s);
    const double           f0 = cross(n, edge.node(0) - x), f1 = cross(n, edge.node(1) - x);
    if (boost::math::sign(f0) * boost::math::sign(f1) > 0 || f0 == f1)
      return {};
    Hit result;
    result.s =
      edge.n_nodes == 2 ? f0 / (f0 - f1) : zero([&](const double r) { return cross(n, edge.point(r) - x); }, f0, f1);
    result.gap = (edge.point(result.s) - x) * n / n.norm();
    return result;
  }

  /// The master edge that the ray from a point of slave edge e hits first and from outside, if any.
  std::optional<unsigned int> CurvePairing::partner(const unsigned int               e,
                                                    const double                     s,
                                                    const std::vector<unsigned int> &near) const
  {
    const Tensor n = field(e, s) / field(e, s).norm();
    // ahead and behind: the first crossing counts
    std::array<double, 2>       distance{{reach.ahead, reach.behind}};
    std::array<unsigned int, 2> first{};
    std::array<bool, 2>         is_facing{{false, false}};
    for (const unsigned int m : near)
      if (const auto found = hit(e, s, m))
        {
          const double       along = master[m].normal(found->s) * n;
          const unsigned int way   = found->gap < 0;
          if (std::abs(along) < -facing_cosine || std::abs(found->gap) > distance[way])
            continue;
          distance[way]  = std::abs(found->gap);
          first[way]     = m;
          is_facing[way] = along < 0;
        }
    if (!is_facing[0] && !is_facing[1])
      return {};
    const unsigned int way = is_facing[0] && (!is_facing[1] || distance[0] <= distance[1]) ? 0 : 1;
    return first[way];
  }

  /// Master edges near slave edge e.
  std::vector<unsigned int> CurvePairing::candidates(const unsigned int e) const
  {
    std::vector<dealii::Point<2>> around;
    for (const double s : {0., 0.25, 0.5, 0.75, 1.})
      for (const double way : {-reach.behind, reach.ahead})
        around.push_back(slave[e].point(s) + way * field(e, s) / field(e, s).norm());
    // slightly enlarged: the field of normals turns, and touching parts are on the border of the box
    return tree.near(EdgeTree::widened(EdgeTree::box_around(around), 0.05 * slave[e].chord()));
  }

  std::vector<CurvePairing::Segment> CurvePairing::segments(const unsigned int e) const
  {
    const auto          near   = candidates(e);
    std::vector<double> breaks = {0., 1.};
    for (const unsigned int m : near)
      for (const unsigned int i : {0, 1})
        {
          const auto   y  = master[m].node(i);
          const double f0 = side(e, 0., y), f1 = side(e, 1., y);
          if (f0 * f1 < 0)
            breaks.push_back(zero([&](const double s) { return side(e, s, y); }, f0, f1));
        }
    std::sort(breaks.begin(), breaks.end());
    std::vector<Segment> parts;
    double               from = 0;
    for (const double to : breaks)
      if (to - from > smallest_segment)
        {
          if (const auto m = partner(e, 0.5 * (from + to), near))
            parts.push_back({from, to, *m});
          from = to;
        }
    return nearest_level(e, std::move(parts));
  }

  std::vector<CurvePairing::Segment> CurvePairing::nearest_level(const unsigned int e, std::vector<Segment> parts) const
  {
    struct Ends // of a segment
    {
      double gap[2], slope;
    };
    const double      chord = slave[e].chord();
    std::vector<Ends> ends;
    for (const auto &part : parts)
      {
        const double inside = same_place * (part.to - part.from); // rounding may move the ends off the master edge
        const auto   first = hit(e, part.from + inside, part.master), last = hit(e, part.to - inside, part.master);
        const auto   middle = hit(e, 0.5 * (part.from + part.to), part.master);
        const double at     = middle ? middle->gap : 0.;
        ends.push_back({{first ? first->gap : at, last ? last->gap : at}, 0.});
        ends.back().slope = (ends.back().gap[1] - ends.back().gap[0]) / ((part.to - part.from) * chord);
      }
    const auto distance = [&](const std::size_t k) {
      return std::min(std::abs(ends[k].gap[0]), std::abs(ends[k].gap[1]));
    };
    // a steep part is a flank between two levels, unless all are steep
    const auto order = [&](const std::size_t k) {
      return std::make_pair(std::abs(ends[k].slope) > steepest_slope, distance(k));
    };
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < parts.size(); ++k)
      if (order(k) < order(nearest))
        nearest = k;
    std::vector<bool> is_on_level(parts.size(), false);
    const auto        follow = [&](const int way) { // from the nearest segment to one end of the edge
      std::size_t last = nearest;
      for (std::size_t k = nearest + way; k < parts.size(); k += way) // below 0 it exceeds the size
        {
                 const double between = (way > 0 ? parts[k].from - parts[last].to : parts[last].from - parts[k].to) * chord;
                 const double jump = ends[k].gap[way < 0] - ends[last].gap[way > 0];
                 if (std::abs(jump) > between + smallest_jump * chord ||
              std::abs(ends[k].slope - ends[nearest].slope) > steepest_slope)
            continue;
          is_on_level[k] = true;
                 last           = k;
        }
    };
    if (parts.empty())
      return parts;
    is_on_level[nearest] = true;
    follow(1);
    follow(-1);
    std::vector<Segment> level;
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (is_on_level[k])
        level.push_back(parts[k]);
    return level;
  }
} // namespace slipstick::interface
