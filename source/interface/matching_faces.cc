#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/interface/matching_faces.h>
#include <slipstick/interface/pair_checks.h>

#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    using Faces  = std::vector<mechanics::SurfaceFace>;
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;
    using Place  = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
    using Box    = boost::geometry::model::box<Place>;

    // How far nodes across may be off to the side, over the size of their faces: digits of mesh files.
    constexpr double off_to_the_side = 1e-3;
    // How far from its edges a face is hit, over its size: neighbours touch it there.
    constexpr double inside = 1e-2;
    // Nodes are looked for so far besides the normal, part of the distance: normals of curved sides differ.
    constexpr double around_the_normal = 0.05;
    constexpr auto   none              = static_cast<unsigned int>(-1);

    /// A node with those faces of a side that form no corner there.
    struct SideNode
    {
      mechanics::NodeKey                                 key{};
      unsigned int                                       side = 0;
      Point                                              x;
      Tensor                                             normal;
      std::vector<std::pair<unsigned int, unsigned int>> faces; // and which corner of them
      double                                             area = 0, covered = 0;
      unsigned int                                       partner = none; // on the other side
      Tensor                                             mean;           // of both normals
      double                                             gap = 0;
    };

    std::vector<SideNode> nodes_of(const Faces &faces)
    {
      std::map<mechanics::NodeKey, std::vector<std::pair<unsigned int, unsigned int>>> at;
      for (unsigned int f = 0; f < faces.size(); ++f)
        for (unsigned int v = 0; v < faces[f].n_nodes; ++v)
          at[faces[f].keys[v]].emplace_back(f, v);
      std::vector<SideNode> nodes;
      for (const auto &[key, corners] : at)
        {
          std::vector<Tensor> normals, means;
          for (const auto &[f, v] : corners)
            normals.push_back(faces[f].normal());
          const auto        group = mechanics::smooth_normals(normals, means);
          const std::size_t first = nodes.size();
          for (unsigned int g = 0; g < means.size(); ++g)
            {
              nodes.emplace_back();
              nodes.back().key    = key;
              nodes.back().side   = g;
              nodes.back().normal = means[g];
              nodes.back().x      = faces[corners[0].first].node(corners[0].second);
            }
          for (unsigned int i = 0; i < corners.size(); ++i)
            {
              auto &node = nodes[first + group[i]];
              node.faces.push_back(corners[i]);
              node.area += faces[corners[i].first].shares()[corners[i].second];
            }
        }
      return nodes;
    }

    /// Gives every slave node the master node across that is least off to the side, then nearest.
    void find_partners(std::vector<SideNode> &slave, const std::vector<SideNode> &master, const double reach)
    {
      std::vector<std::pair<Place, unsigned int>> places;
      for (unsigned int m = 0; m < master.size(); ++m)
        places.emplace_back(Place(master[m].x[0], master[m].x[1], master[m].x[2]), m);
      const boost::geometry::index::rtree<std::pair<Place, unsigned int>, boost::geometry::index::rstar<16>> tree(
        places);
      for (auto &node : slave)
        {
          const double size    = std::sqrt(node.area);
          const double allowed = off_to_the_side * size;
          Tensor       half;
          for (unsigned int d = 0; d < 3; ++d)
            half[d] = reach * (std::abs(node.normal[d]) + around_the_normal) + allowed;
          const Point                                 low = node.x - half, high = node.x + half;
          std::vector<std::pair<Place, unsigned int>> found;
          tree.query(boost::geometry::index::intersects(
                       Box(Place(low[0], low[1], low[2]), Place(high[0], high[1], high[2]))),
                     std::back_inserter(found));
          double best = std::numeric_limits<double>::max();
          for (const auto &candidate : found)
            {
              const unsigned int m = candidate.second;
              if (!(master[m].normal * node.normal < facing_cosine))
                continue;
              const Tensor mean = (node.normal - master[m].normal) / (node.normal - master[m].normal).norm();
              const Tensor way  = master[m].x - node.x;
              const double gap = way * mean, off = (way - gap * mean).norm();
              if (off > allowed || std::abs(gap) > reach || std::abs(gap) > best ||
                  (std::abs(gap) == best && node.partner < m))
                continue;
              best         = std::abs(gap);
              node.partner = m;
              node.mean    = mean;
              node.gap     = gap;
            }
        }
    }

    /// Does the line through x along n meet the face, away from its edges and not farther than @p reach?
    bool hits(const mechanics::SurfaceFace &face, const Point &x, const Tensor &n, const double reach)
    {
      const Tensor m     = face.normal();
      const double slope = n * m;
      if (!(slope < facing_cosine))
        return false;
      const double at = (face.middle() - x) * m / slope;
      if (std::abs(at) > reach)
        return false;
      const Point p = x + at * n;
      for (unsigned int v = 0; v < face.n_nodes; ++v)
        {
          const Tensor along = face.node((v + 1) % face.n_nodes) - face.node(v);
          if (cross_product_3d(along, p - face.node(v)) * m < inside * along.norm() * face.chord())
            return false;
        }
      return true;
    }

    std::string between(const scene::Scene<3> &scene, const scene::ContactPair<3> &pair)
    {
      return "Contact " + pair.name + ": " + describe(scene, pair.slave) + " and " + describe(scene, *pair.master);
    }

    /// Faces of @p side that are not matched must not face the other side.
    void check_unmatched(const scene::Scene<3>       &scene,
                         const scene::ContactPair<3> &pair,
                         const Faces                 &side,
                         const std::vector<bool>     &matched,
                         const Faces                 &other,
                         const double                 reach)
    {
      for (unsigned int f = 0; f < side.size(); ++f)
        if (!matched[f])
          for (const auto &face : other)
            if (hits(face, side[f].middle(), side[f].normal(), reach))
              throw InputError(
                between(scene, pair) + ": the meshes do not match at " + point_text(side[f].middle(), 3) +
                  ", and contact between bodies in space (Dimension = 3) is node to node",
                "give both sides the same nodes where they face each other (Cells, Size, Origin), or make one "
                "of them an obstacle");
    }

    double mean_chord(const Faces &faces)
    {
      double sum = 0;
      for (const auto &face : faces)
        sum += face.chord();
      return sum / faces.size();
    }

    /// How far nodes may be apart.
    double reach_of(const scene::ContactPair<3> &pair,
                    const std::vector<SideNode> &nodes,
                    const Faces                 &slave,
                    const Faces                 &master)
    {
      if (pair.reach)
        return *pair.reach;
      double smallest = std::numeric_limits<double>::max();
      for (const auto &node : nodes)
        if (node.partner != none)
          smallest = std::min(smallest, std::abs(node.gap));
      const double part = pair.law.acts_where_closed_alone() ? 0.5 : 0.1;
      return smallest + std::max(2 * std::max(mean_chord(slave), mean_chord(master)),
                                 part * std::min(extent(slave), extent(master)));
    }
  } // namespace

  std::vector<MortarRow<3>> matching_rows(const scene::Scene<3>       &scene,
                                          const scene::ContactPair<3> &pair,
                                          const Faces                 &slave,
                                          const Faces                 &master)
  {
    const std::string choose = "choose boundaries whose outward normals oppose each other, or move the bodies";
    if (slave.empty() || master.empty())
      throw InputError(between(scene, pair) + " do not face each other anywhere", choose);
    auto both = slave;
    both.insert(both.end(), master.begin(), master.end());
    const double any       = extent(both);
    auto         nodes     = nodes_of(slave);
    const auto   of_master = nodes_of(master);
    find_partners(nodes, of_master, any);
    const double reach = reach_of(pair, nodes, slave, master);

    std::vector<unsigned int> n_slave(slave.size()), n_master(master.size()); // corners that have partners
    bool                      is_behind = true;
    for (auto &node : nodes)
      {
        if (node.partner != none && std::abs(node.gap) > reach)
          node.partner = none;
        if (node.partner == none)
          continue;
        is_behind = is_behind && node.gap < -mean_chord(slave);
        for (const auto &corner : node.faces)
          ++n_slave[corner.first];
        for (const auto &corner : of_master[node.partner].faces)
          ++n_master[corner.first];
      }
    std::vector<bool> slave_matched, master_matched;
    for (const unsigned int n : n_slave)
      slave_matched.push_back(n == mechanics::SurfaceFace::n_nodes);
    for (const unsigned int n : n_master)
      master_matched.push_back(n == mechanics::SurfaceFace::n_nodes);
    check_unmatched(scene, pair, slave, slave_matched, master, reach);
    check_unmatched(scene, pair, master, master_matched, slave, reach);

    std::vector<MortarRow<3>> rows;
    for (auto &node : nodes)
      {
        for (const auto &[f, v] : node.faces)
          node.covered += slave_matched[f] ? slave[f].shares()[v] : 0.;
        if (node.partner == none || !(node.covered > 0))
          continue;
        const auto  &across = of_master[node.partner];
        MortarRow<3> row;
        row.slave           = node.key;
        row.side            = node.side;
        row.position        = node.x;
        row.normal          = node.mean;
        row.slave_weights   = {{node.key, 1.}};
        row.master_weights  = {{across.key, 1.}};
        row.master_position = across.x;
        row.gap             = node.gap;
        row.measure = row.length = node.covered;
        row.full_measure = row.full_length = node.area;
        rows.push_back(std::move(row));
      }
    if (rows.empty())
      throw InputError(between(scene, pair) + (pair.reach ? format(" do not meet within the Reach of %g mm", reach)
                                                          : std::string(" do not face each other anywhere")),
                       choose);
    if (is_behind)
      throw InputError(between(scene, pair) +
                         " face away from each other: the slave finds the master only against its outward normal",
                       "choose the boundaries that lie between the two bodies, or move, mirror or rotate a body");
    return rows;
  }
} // namespace slipstick::interface
