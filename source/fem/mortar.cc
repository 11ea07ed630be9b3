#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/fem/edge_tree.h>
#include <slipstick/fem/mortar.h>

#include <deal.II/base/quadrature_lib.h>

#include <Eigen/Dense>

#include <cmath>

namespace slipstick::fem
{
  namespace
  {
    // Parts of an edge (of its length) that are shorter than this are left out.
    constexpr double smallest_segment = 1e-12;
    constexpr double smallest_cover   = 1e-10;
    // An edge is covered as a whole when no more than this part is missing.
    constexpr double whole_edge = 1e-9;
    // Weights that are no more than rounding.
    constexpr double smallest_weight = 1e-11;
    // Master nodes lie across slave nodes when they are off by no more than this part of the tributary length ...
    constexpr double       across_automatic = 1e-6; // ... to be taken for matching meshes
    constexpr double       across_asked_for = 0.1;  // ... when node to node is asked for
    constexpr unsigned int n_gauss          = 5; // per segment; exact between straight parallel edges of both degrees

    double cross(const dealii::Tensor<1, 2> &a, const dealii::Tensor<1, 2> &b)
    {
      return a[0] * b[1] - a[1] * b[0];
    }

    /// Zero of a continuous f with f(low) f(high) <= 0: false position made safe (Illinois) between bisections.
    template <class F>
    double zero_between(const F &f, double low, double high, double f_low, double f_high)
    {
      for (unsigned int i = 0; i < 200 && high - low > 1e-16 && f_low != f_high; ++i)
        {
          const double s = i % 4 == 3 ? 0.5 * (low + high) : (low * f_high - high * f_low) / (f_high - f_low);
          if (!(s > low && s < high))
            return s <= low ? low : high;
          const double value = f(s);
          if (value == 0)
            return s;
          if ((value < 0) == (f_low < 0))
            {
              low   = s;
              f_low = value;
              f_high /= 2;
            }
          else
            {
              high   = s;
              f_high = value;
              f_low /= 2;
            }
        }
      return 0.5 * (low + high);
    }

    /// Where a ray from a slave point meets a master edge.
    struct Hit
    {
      double s   = 0; // on the master edge
      double gap = 0; // along the ray [mm]
    };

    struct Segment
    {
      double       from = 0, to = 0; // on the slave edge
      unsigned int master = 0;       // edge
    };

    /// The two curves with the nodes and the continuous normal field of the slave.
    class Pairing
    {
    public:
      using Edge   = SurfaceEdge<2>;
      using Tensor = dealii::Tensor<1, 2>;

      Pairing(const std::vector<Edge> &slave_, const std::vector<Edge> &master_, const Reach &reach_)
        : slave(slave_)
        , master(master_)
        , reach(reach_)
        , tree(master_)
        , gauss(n_gauss)
      {
        find_nodes();
      }

      /// Integrals of all edges, then rows of all nodes.
      std::vector<MortarRow<2>> rows()
      {
        for (unsigned int e = 0; e < slave.size(); ++e)
          integrate(e, segments(e));
        std::vector<MortarRow<2>> result;
        for (auto &node : nodes)
          if (node.length > smallest_cover * node.size)
            result.push_back(row_of(node));
        return result;
      }

    private:
      struct Node
      {
        NodeKey                   key{};
        unsigned int              side = 0;
        dealii::Point<2>          position;
        Tensor                    normal;
        double                    size   = 0;    // of the edges there
        double                    length = 0;    // D_i
        double                    full   = 0;    // D_i of covered edges
        std::map<NodeKey, double> slave, master; // D_ik, M_ij
      };

      void find_nodes()
      {
        std::map<NodeKey, std::vector<std::pair<unsigned int, unsigned int>>> at; // edge, node of the edge
        for (unsigned int e = 0; e < slave.size(); ++e)
          for (unsigned int i = 0; i < slave[e].n_nodes; ++i)
            at[slave[e].keys[i]].emplace_back(e, i);
        node_of.resize(slave.size());
        for (const auto &[key, places] : at)
          {
            std::vector<Tensor> normals, means;
            for (const auto &[e, i] : places)
              normals.push_back(slave[e].normal(Edge::node_coordinate(i)));
            const auto         side  = smooth_normals(normals, means);
            const unsigned int first = nodes.size();
            for (unsigned int g = 0; g < means.size(); ++g)
              {
                Node node;
                node.key      = key;
                node.side     = g;
                node.position = slave[places[0].first].node(places[0].second);
                node.normal   = means[g];
                nodes.push_back(node);
              }
            for (unsigned int k = 0; k < places.size(); ++k)
              {
                nodes[first + side[k]].full += slave[places[k].first].tributary_lengths()[places[k].second];
                node_of[places[k].first][places[k].second] = first + side[k];
                nodes[first + side[k]].size += slave[places[k].first].chord();
              }
          }
        for (const auto &edge : master)
          for (unsigned int i = 0; i < edge.n_nodes; ++i)
            master_positions[edge.keys[i]] = edge.node(i);
        for (const auto &node : nodes)
          slave_positions[node.key] = node.position;
      }

      /// The normal field on slave edge e, not of unit length.
      Tensor field(const unsigned int e, const double s) const
      {
        const auto N = slave[e].shape(s);
        Tensor     n;
        for (unsigned int i = 0; i < slave[e].n_nodes; ++i)
          n += N[i] * nodes[node_of[e][i]].normal;
        return n;
      }

      /// Side of the ray from slave edge e at s on which y lies.
      double side(const unsigned int e, const double s, const dealii::Point<2> &y) const
      {
        return cross(field(e, s), y - slave[e].point(s));
      }

      std::optional<Hit> hit(const unsigned int e, const double s, const unsigned int m) const
      {
        const Edge            &edge = master[m];
        const dealii::Point<2> x    = slave[e].point(s);
        const Tensor           n    = field(e, s);
        const double           f0 = cross(n, edge.node(0) - x), f1 = cross(n, edge.node(1) - x);
        if (f0 * f1 > 0 || f0 == f1)
          return {};
        Hit result;
        result.s   = edge.n_nodes == 2
                       ? f0 / (f0 - f1)
                       : zero_between([&](const double r) { return cross(n, edge.point(r) - x); }, 0., 1., f0, f1);
        result.gap = (edge.point(result.s) - x) * n / n.norm();
        return result;
      }

      /// The master edge that the ray from the middle of a segment meets first and from outside, if any.
      std::optional<unsigned int> partner(const unsigned int               e,
                                          const double                     s,
                                          const std::vector<unsigned int> &candidates) const
      {
        const Tensor n = field(e, s) / field(e, s).norm();
        // ahead and behind: the first crossing
        std::array<double, 2>       distance{{reach.ahead, reach.behind}};
        std::array<unsigned int, 2> first{};
        std::array<bool, 2>         is_facing{{false, false}};
        for (const unsigned int m : candidates)
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

      std::vector<unsigned int> candidates(const unsigned int e) const
      {
        std::vector<dealii::Point<2>> around;
        for (const double s : {0., 0.25, 0.5, 0.75, 1.})
          for (const double way : {-reach.behind, reach.ahead})
            around.push_back(slave[e].point(s) + way * field(e, s) / field(e, s).norm());
        auto box = EdgeTree::box_around(around);
        // a little larger: the field turns, and exact touching is on the border
        const double more = 0.05 * slave[e].chord();
        box.min_corner()  = {box.min_corner().get<0>() - more, box.min_corner().get<1>() - more};
        box.max_corner()  = {box.max_corner().get<0>() + more, box.max_corner().get<1>() + more};
        return tree.near(box);
      }

      /// Parts of slave edge e over which one master edge faces it.
      std::vector<Segment> segments(const unsigned int e) const
      {
        const auto          near   = candidates(e);
        std::vector<double> breaks = {0., 1.};
        for (const unsigned int m : near)
          for (const unsigned int i : {0, 1})
            {
              const auto   y  = master[m].node(i);
              const double f0 = side(e, 0., y), f1 = side(e, 1., y);
              if (f0 * f1 < 0)
                breaks.push_back(zero_between([&](const double s) { return side(e, s, y); }, 0., 1., f0, f1));
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
        return parts;
      }

      /// Adds what slave edge e gives to the integrals of its nodes.
      void integrate(const unsigned int e, const std::vector<Segment> &parts)
      {
        const Edge &edge    = slave[e];
        double      covered = 0;
        for (const auto &part : parts)
          covered += part.to - part.from;
        if (covered < smallest_cover)
          return;
        // test functions are made of linear shape functions where a quadratic edge is covered in part
        const unsigned int n_test    = covered > 1 - whole_edge ? edge.n_nodes : 2;
        const bool         is_linear = n_test == 2;

        Eigen::MatrixXd                    mass   = Eigen::MatrixXd::Zero(n_test, n_test);       // <T_a T_b>
        Eigen::MatrixXd                    slave_ = Eigen::MatrixXd::Zero(n_test, edge.n_nodes); // <T_a N_k>
        Eigen::VectorXd                    sums   = Eigen::VectorXd::Zero(n_test);               // <T_a>
        std::map<NodeKey, Eigen::VectorXd> other;                                                // <T_a N_j(y)>
        for (const auto &part : parts)
          for (unsigned int q = 0; q < gauss.size(); ++q)
            {
              const double s  = part.from + (part.to - part.from) * gauss.point(q)[0];
              const double dx = gauss.weight(q) * (part.to - part.from) * edge.tangent(s).norm();
              const auto   N  = edge.shape(s);
              const auto   T  = is_linear ? std::array<double, 3>{{1 - s, s, 0}} : N;
              const auto   y  = hit(e, s, part.master);
              const Edge  &to = master[part.master];
              // a Gauss point at the very end of a segment may miss by rounding
              const double r =
                y ? y->s : (std::abs(side(e, s, to.node(0))) < std::abs(side(e, s, to.node(1))) ? 0. : 1.);
              const auto            N_m  = to.shape(r);
              const Eigen::VectorXd test = Eigen::Map<const Eigen::VectorXd>(T.data(), n_test);
              mass += dx * test * test.transpose();
              slave_ += dx * test * Eigen::Map<const Eigen::RowVectorXd>(N.data(), edge.n_nodes);
              sums += dx * test;
              for (unsigned int j = 0; j < to.n_nodes; ++j)
                {
                  auto &sum = other.emplace(to.keys[j], Eigen::VectorXd::Zero(n_test)).first->second;
                  sum += dx * N_m[j] * test;
                }
            }
        // phi = diag(sums) mass^-1 T, scaled: on a short part the entries are of very different size
        const Eigen::VectorXd scale  = mass.diagonal().cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = scale.asDiagonal() * mass * scale.asDiagonal();
        const Eigen::MatrixXd dual =
          sums.asDiagonal() * (scale.asDiagonal() * scaled.inverse() * scale.asDiagonal()).eval();
        const Eigen::MatrixXd D = dual * slave_;
        for (unsigned int i = 0; i < n_test; ++i)
          {
            Node &node = nodes[node_of[e][i]];
            node.length += sums[i];
            for (unsigned int k = 0; k < edge.n_nodes; ++k)
              if (!(n_test == edge.n_nodes && i != k)) // biorthogonal
                node.slave[edge.keys[k]] += n_test == edge.n_nodes ? sums[i] : D(i, k);
          }
        for (const auto &[key, sum] : other)
          {
            const Eigen::VectorXd M = dual * sum;
            for (unsigned int i = 0; i < n_test; ++i)
              nodes[node_of[e][i]].master[key] += M[i];
          }
      }

      /// Weights over their sum, without what is rounding; the largest makes the sum 1 exactly.
      static Weights normalised(const std::map<NodeKey, double> &raw, const double sum)
      {
        Weights weights;
        for (const auto &[key, value] : raw)
          if (std::abs(value) > smallest_weight * sum)
            weights.emplace_back(key, value / sum);
        const auto by_size = [](const auto &a, const auto &b) { return std::abs(a.second) < std::abs(b.second); };
        const auto largest = std::max_element(weights.begin(), weights.end(), by_size);
        double     others  = 0;
        for (auto w = weights.begin(); w != weights.end(); ++w)
          if (w != largest)
            others += w->second;
        largest->second = 1 - others;
        return weights;
      }

      MortarRow<2> row_of(const Node &node) const
      {
        MortarRow<2> row;
        row.slave          = node.key;
        row.side           = node.side;
        row.position       = node.position;
        row.normal         = node.normal;
        row.length         = node.length;
        row.full_length    = node.full;
        row.slave_weights  = normalised(node.slave, node.length);
        row.master_weights = normalised(node.master, node.length);
        measure(row);
        return row;
      }

    public:
      /// Gap and mean master position from the weights.
      void measure(MortarRow<2> &row) const
      {
        dealii::Point<2> x;
        row.master_position = {};
        for (const auto &[key, weight] : row.slave_weights)
          x += weight * Tensor(slave_positions.at(key));
        for (const auto &[key, weight] : row.master_weights)
          row.master_position += weight * Tensor(master_positions.at(key));
        row.gap = row.normal * (row.master_position - x);
      }

      /// The master node across a slave node, and how far off it is to the side.
      std::pair<NodeKey, double> across(const MortarRow<2> &row) const
      {
        std::pair<NodeKey, double> best{{{0, 0}}, std::numeric_limits<double>::max()};
        for (const auto &[key, weight] : row.master_weights)
          {
            const double off = std::abs(cross(row.normal, master_positions.at(key) - row.position));
            if (off < best.second)
              best = {key, off};
          }
        return best;
      }

    private:
      const std::vector<Edge>                 &slave, &master;
      const Reach                              reach;
      const EdgeTree                           tree;
      const dealii::QGauss<1>                  gauss;
      std::vector<Node>                        nodes;
      std::vector<std::array<unsigned int, 3>> node_of; // by slave edge
      std::map<NodeKey, dealii::Point<2>>      slave_positions, master_positions;
    };

    /// Nearest point of the chord of an edge.
    dealii::Point<2> nearest_on(const SurfaceEdge<2> &edge, const dealii::Point<2> &x)
    {
      const auto   along = edge.node(1) - edge.node(0);
      const double s     = std::min(1., std::max(0., (x - edge.node(0)) * along / along.norm_square()));
      return edge.node(0) + s * along;
    }

    void one_way(const std::vector<SurfaceEdge<2>> &a, const std::vector<SurfaceEdge<2>> &b, double &smallest)
    {
      const EdgeTree tree(b);
      for (const auto &edge : a)
        for (const double s : {0., 0.5, 1.})
          {
            const auto x = edge.point(s);
            const auto n = edge.normal(s);
            tree.for_each_by_distance(
              x,
              [&] { return smallest; },
              [&](const unsigned int m) {
                if (b[m].normal(0.5) * n < facing_cosine)
                  smallest = std::min(smallest, x.distance(nearest_on(b[m], x)));
                return true;
              });
          }
    }
  } // namespace

  template <>
  std::vector<MortarRow<2>> mortar_rows(const std::vector<SurfaceEdge<2>> &slave,
                                        const std::vector<SurfaceEdge<2>> &master,
                                        const Reach                       &reach,
                                        const scene::ContactDiscretization discretization,
                                        const std::string                 &name)
  {
    Pairing pairing(slave, master, reach);
    auto    rows = pairing.rows();
    if (discretization == scene::ContactDiscretization::mortar)
      return rows;
    const bool   is_asked_for = discretization == scene::ContactDiscretization::node_to_node;
    const double tolerance    = is_asked_for ? across_asked_for : across_automatic;
    auto         to_nodes     = rows;
    for (auto &row : to_nodes)
      {
        const auto [key, off] = pairing.across(row);
        if (off > tolerance * row.length)
          {
            if (!is_asked_for)
              return rows;
            throw InputError(
              format("Contact %s: Discretization = node to node, but the meshes do not match: the master "
                     "node nearest to the slave node at (%g, %g) is %g mm aside",
                     name.c_str(),
                     row.position[0],
                     row.position[1],
                     off),
              "set Discretization = auto or mortar, or give both boundaries the same nodes");
          }
        row.slave_weights  = {{row.slave, 1.}};
        row.master_weights = {{key, 1.}};
        pairing.measure(row);
      }
    return to_nodes;
  }

  template <>
  std::optional<double> facing_distance(const std::vector<SurfaceEdge<2>> &a,
                                        const std::vector<SurfaceEdge<2>> &b,
                                        const double                       bound)
  {
    double smallest = bound;
    one_way(a, b, smallest);
    one_way(b, a, smallest);
    if (smallest < bound)
      return smallest;
    return {};
  }
} // namespace slipstick::fem
