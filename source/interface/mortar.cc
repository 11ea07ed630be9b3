#include <slipstick/interface/biorthogonal.h>
#include <slipstick/interface/mortar.h>
#include <slipstick/interface/node_matching.h>

#include <deal.II/base/quadrature_lib.h>

#include <cmath>

namespace slipstick::interface
{
  namespace
  {
    // An edge is fully covered if at most this fraction is missing.
    constexpr double whole_edge = 1e-9;
    // Nodes are on their curve if their distance is at most this fraction of the edge.
    constexpr double       on_curve = 1e-12;
    constexpr unsigned int n_gauss  = 5; // per segment; exact between straight parallel edges of both degrees

    /// The integrals of all slave edges, by node.
    class MortarIntegrals
    {
    public:
      using Edge   = mechanics::SurfaceEdge<2>;
      using Tensor = dealii::Tensor<1, 2>;

      MortarIntegrals(const std::vector<Edge>   &slave_,
                      const std::vector<Edge>   &master_,
                      const Reach               &reach,
                      const mesh::Kinematics<2> &kinematics_,
                      const Corners             &corners)
        : kinematics(kinematics_)
        , pairing(slave_, master_, reach, kinematics, corners)
        , slave(slave_)
        , master(master_)
        , gauss(n_gauss)
        , parts_of_nodes(pairing.nodes().size())
      {
        for (const auto *side : {&slave, &master})
          for (const auto &edge : *side)
            for (unsigned int i = 0; i < edge.n_nodes; ++i)
              places[edge.keys[i]] = {&edge, Edge::node_coordinate(i)};
        for (const auto &edge : master)
          for (unsigned int i = 0; i < edge.n_nodes; ++i)
            nodes.master[edge.keys[i]] = edge.node(i);
        for (const auto &node : pairing.nodes())
          nodes.slave[node.key] = node.position;
        for (unsigned int e = 0; e < slave.size(); ++e)
          integrate(e, pairing.segments(e));
      }

      std::vector<MortarRow<2>> rows() const
      {
        return rows_of_nodes(pairing.nodes(), parts_of_nodes, nodes);
      }

    private:
      /// Adds the contributions of slave edge e to the integrals of its nodes.
      void integrate(const unsigned int e, const std::vector<CurvePairing::Segment> &parts)
      {
        const Edge &edge    = slave[e];
        double      covered = 0;
        for (const auto &part : parts)
          covered += part.to - part.from;
        if (covered < smallest_cover)
          return;
        // linear test functions on partly covered quadratic edges
        const unsigned int n_test    = covered > 1 - whole_edge ? edge.n_nodes : 2;
        const bool         is_linear = n_test == 2;

        Eigen::MatrixXd                               mass   = Eigen::MatrixXd::Zero(n_test, n_test);       // <T_a T_b>
        Eigen::MatrixXd                               slave_ = Eigen::MatrixXd::Zero(n_test, edge.n_nodes); // <T_a N_k>
        Eigen::VectorXd                               measures = Eigen::VectorXd::Zero(n_test);             // <T_a>
        Eigen::VectorXd                               lengths  = Eigen::VectorXd::Zero(n_test);    // in the plane
        Eigen::MatrixXd                               rises    = Eigen::MatrixXd::Zero(n_test, 2); // <T_a rise n>
        double                                        neglected_sagitta = 0;
        std::map<mechanics::NodeKey, Eigen::VectorXd> other; // <T_a N_j(y)>
        for (const auto &part : parts)
          for (unsigned int q = 0; q < gauss.size(); ++q)
            {
              const double s      = part.from + (part.to - part.from) * gauss.point(q)[0];
              const double length = gauss.weight(q) * (part.to - part.from) * edge.tangent(s).norm();
              const double dx     = length * kinematics.measure(edge.point(s));
              const auto   N      = edge.shape(s);
              const auto   T      = is_linear ? std::array<double, 3>{{1 - s, s, 0}} : N;
              const auto   y      = pairing.hit(e, s, part.master);
              const Edge  &to     = master[part.master];
              // rounding may move a Gauss point at the very end of a segment beyond it
              const double r =
                y ? y->s
                  : (std::abs(pairing.side(e, s, to.node(0))) < std::abs(pairing.side(e, s, to.node(1))) ? 0. : 1.);
              const auto            N_m  = to.shape(r);
              const Eigen::VectorXd test = Eigen::Map<const Eigen::VectorXd>(T.data(), n_test);
              mass += dx * test * test.transpose();
              slave_ += dx * test * Eigen::Map<const Eigen::RowVectorXd>(N.data(), edge.n_nodes);
              measures += dx * test;
              lengths += length * test;
              neglected_sagitta =
                std::max(neglected_sagitta, edge.curve.neglected_sagitta + to.curve.neglected_sagitta);
              if (edge.curve || to.curve)
                {
                  const Tensor n    = pairing.direction(e, s);
                  const Tensor rise = (to.rise(r, n) - edge.rise(s, n)) * n;
                  rises += dx * test * Eigen::RowVector2d(rise[0], rise[1]);
                }
              for (unsigned int j = 0; j < to.n_nodes; ++j)
                {
                  auto &sum = other.emplace(to.keys[j], Eigen::VectorXd::Zero(n_test)).first->second;
                  sum += dx * N_m[j] * test;
                }
            }
        const Eigen::MatrixXd dual = biorthogonal(mass, measures);
        const Eigen::MatrixXd D = dual * slave_, of_curves = dual * rises;
        for (unsigned int i = 0; i < n_test; ++i)
          {
            NodeIntegrals<2> node;
            node.measure = measures[i];
            node.length  = lengths[i];
            for (unsigned int d = 0; d < 2; ++d)
              node.rise[d] = of_curves(i, d);
            node.neglected_sagitta = neglected_sagitta;
            for (unsigned int k = 0; k < edge.n_nodes; ++k)
              if (!(n_test == edge.n_nodes && i != k)) // biorthogonal
                node.slave[edge.keys[k]] += n_test == edge.n_nodes ? measures[i] : D(i, k);
            for (const auto &[key, sum] : other)
              node.master[key] = dual.row(i).dot(sum);
            // otherwise a sloping master would reach a node beside it
            node.rise += node.measure * lost_beyond(e, i, parts);
            parts_of_nodes[pairing.nodes_of(e)[i]].push_back(std::move(node));
          }
      }

      /// By how much the gap at end i of edge e, if it does not face the master, would be less than that at the nearest
      /// place that does, extrapolated from the part that faces it; along the normal there.
      Tensor lost_beyond(const unsigned int                        e,
                         const unsigned int                        i,
                         const std::vector<CurvePairing::Segment> &parts) const
      {
        const auto  &near = i == 0 ? parts.front() : parts.back(), &far = i == 0 ? parts.back() : parts.front();
        const double inwards = i == 0 ? 1 : -1, first = i == 0 ? near.from : near.to, last = i == 0 ? far.to : far.from;
        const double beyond = std::abs(first - Edge::node_coordinate(i)), faced = std::abs(last - first);
        if (i > 1 || beyond <= whole_edge)
          return {};
        const double rounding = whole_edge * faced;
        const double s_near = first + inwards * rounding, s_far = last - inwards * rounding;
        const auto   hit_near = pairing.hit(e, s_near, near.master), hit_far = pairing.hit(e, s_far, far.master);
        if (!hit_near || !hit_far)
          return {};
        const auto gap =
          [&](const double s, const CurvePairing::Hit &there, const unsigned int m) { // of the true curves
            const Tensor n = pairing.direction(e, s);
            return there.gap + master[m].rise(there.s, n) - slave[e].rise(s, n);
          };
        const double fall = gap(s_far, *hit_far, far.master) - gap(s_near, *hit_near, near.master);
        return std::max(0., fall) * beyond / faced * pairing.direction(e, s_near);
      }

    public:
      /// Rise of the curve above the edges at a node, along the normal of a row: nonzero only for midside nodes of
      /// straight edges and nodes of edges that could not be bent.
      double rise(const MortarRow<2> &row, const mechanics::NodeKey &key) const
      {
        const auto &[edge, s] = places.at(key);
        const double distance = edge->rise(s, row.normal);
        return std::abs(distance) > on_curve * edge->chord() ? distance : 0.;
      }

      const NodePlaces<2> &places_of_nodes() const
      {
        return nodes;
      }

    private:
      const mesh::Kinematics<2> kinematics;
      const CurvePairing        pairing;
      const std::vector<Edge>  &slave, &master;
      const dealii::QGauss<1>   gauss;
      NodePlaces<2>             nodes;

      std::vector<std::vector<NodeIntegrals<2>>> parts_of_nodes; // of every edge, by node of the pairing

      std::map<mechanics::NodeKey, std::pair<const Edge *, double>>
        places; // an edge of every node, and the position on it
    };
  } // namespace

  template <>
  std::vector<MortarRow<2>> mortar_rows(const std::vector<mechanics::SurfaceEdge<2>> &slave,
                                        const std::vector<mechanics::SurfaceEdge<2>> &master,
                                        const Reach                                  &reach,
                                        const scene::ContactDiscretization            discretization,
                                        const std::string                            &name,
                                        const mesh::Kinematics<2>                    &kinematics,
                                        const Corners                                &corners)
  {
    const MortarIntegrals integrals(slave, master, reach, kinematics, corners);
    return matched(integrals.rows(),
                   integrals.places_of_nodes(),
                   discretization,
                   name,
                   [&](const MortarRow<2> &row, const mechanics::NodeKey &key) { return integrals.rise(row, key); });
  }
} // namespace slipstick::interface
