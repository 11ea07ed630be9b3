#include <slipstick/base/box_tree.h>
#include <slipstick/contact/other_mesh.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>

namespace slipstick::contact
{
  namespace
  {
    using Triple = std::array<double, 3>;

    // A node closer to a point than this fraction of the distance of the farthest one determines the value alone.
    constexpr double same_place = 1e-12;
    constexpr double smallest   = 1e-200; // distance whose inverse can be summed

    dealii::Point<3> point_of(const Triple &x)
    {
      return {x[0], x[1], x[2]};
    }

    double dot(const Triple &a, const Triple &b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }

    /// The nodes of one pair.
    class Field
    {
    public:
      explicit Field(std::vector<ContactNode> nodes_)
        : nodes(std::move(nodes_))
        , tree(boxes())
      {}

      /// Mean of the nearest nodes, weighted with their inverse distances: linear between two nodes of a line.
      ContactNode at(const tfeti::ContactPoint &point) const
      {
        const dealii::Point<3>                       x = point_of(point.position);
        const unsigned int                           n = point.is_in_space() ? 4 : 2;
        std::vector<std::pair<unsigned int, double>> near; // node, distance
        tree.for_each_by_distance(
          x,
          [] { return std::numeric_limits<double>::infinity(); },
          [&](const unsigned int k) {
            near.emplace_back(k, x.distance(point_of(nodes[k].position)));
            return near.size() < n;
          });
        const double least = std::max(same_place * near.back().second, smallest);
        double       sum   = 0;
        for (const auto &[k, distance] : near)
          sum += 1 / std::max(distance, least);
        ContactNode mean;
        for (const auto &[k, distance] : near)
          {
            const double weight = 1 / std::max(distance, least) / sum;
            const auto  &node   = nodes[k];
            mean.pressure += weight * node.pressure;
            mean.gap += weight * node.gap;
            mean.tangential_traction += weight * node.tangential_traction;
            mean.slip += weight * node.slip;
            for (unsigned int d = 0; d < 3; ++d)
              {
                mean.traction[d] += weight * node.traction[d];
                mean.slip_vector[d] += weight * node.slip_vector[d];
              }
          }
        return mean;
      }

    private:
      std::vector<BoxTree<3>::Box> boxes() const
      {
        std::vector<BoxTree<3>::Box> result;
        for (const auto &node : nodes)
          result.push_back(BoxTree<3>::box_around({point_of(node.position)}));
        return result;
      }

      std::vector<ContactNode> nodes;
      BoxTree<3>               tree;
    };
  } // namespace

  std::optional<DualSolution> start_from(const ContactOfMesh            &other,
                                         const tfeti::DualProblem       &dual,
                                         const std::vector<std::string> &pairs)
  {
    std::map<std::string, std::vector<ContactNode>> nodes;
    for (const auto &node : other.nodes)
      nodes[other.pairs[node.pair]].push_back(node);
    std::map<std::string, Field> fields;
    for (auto &[name, of_pair] : nodes)
      fields.emplace(name, std::move(of_pair));

    const auto &points = dual.constraints().contact_points;
    const bool  fits   = std::all_of(points.begin(), points.end(), [&](const tfeti::ContactPoint &point) {
      return fields.count(pairs[point.pair]) > 0;
    });
    if (dealii::Utilities::MPI::min(fits ? 1 : 0, dual.communicator()) == 0)
      return {};

    DualSolution start;
    start.multipliers = dual.zero();
    auto gradient     = dual.zero();
    for (const auto &point : points)
      {
        const auto node = fields.at(pairs[point.pair]).at(point);
        const auto set  = [&](const unsigned int row, const double traction, const double jump) {
          if (row == tfeti::invalid_row)
            return;
          start.multipliers.local_element(row) = traction * point.traction_area;
          gradient.local_element(row)          = -jump / dual.norm();
        };
        set(point.normal_row, node.pressure, -node.gap);
        if (!point.is_in_space())
          set(point.tangential_row, -node.tangential_traction, node.slip);
        else
          for (const unsigned int k : {0, 1})
            set(k == 0 ? point.tangential_row : point.second_row,
                -dot(node.traction, point.tangents[k]),
                dot(node.slip_vector, point.tangents[k]));
      }
    start.gradient = std::move(gradient);
    return start;
  }
} // namespace slipstick::contact
