#include <slipstick/app/contact_profile.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipstick::app
{
  namespace
  {
    using contact::ContactNode;
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;

    // A nodal pressure is a mean weighted with the shape function of the node, and the maximum may lie between two
    // nodes: the total error is at most this fraction of the second difference of the pressures.
    constexpr double of_second_difference = 1. / 8;
    // Where edges near a node differ by more than this factor, nodal pressures alternate: if the node is too high
    // by d and its neighbours too low by d / 2, d is this fraction of the second difference.
    constexpr double changing_size = 1.5, of_alternation = 1. / 3;
    // A peak is unresolved if its pressure exceeds an adjacent one by more than the first fraction of it, at the end of
    // a boundary by more than the second.
    constexpr double peak = 0.25, peak_at_end = 0.05;

    // Peaks other than the largest of a pair, for example at its other end, count if they are larger than this fraction
    // of it.
    constexpr double smallest_peak = 0.1;

    // Stresses closer to such a peak than this fraction of the size of the contact depend on the mesh.
    constexpr double surroundings_of_peak = 0.1;

    // In space pressures are compared with those of the `n_beside` nearest nodes; a node is at the edge of the surface
    // if the directions to its `n_around` nearest nodes leave a larger angle than `angle_at_edge` free.
    constexpr unsigned int n_beside = 4, n_around = 8;
    constexpr double       angle_at_edge = 150 * M_PI / 180;

    // A pair is not resolved if its unresolved zones carry more than this fraction of its normal force; corners that
    // touch, for instance at one end of a wide contact, carry less.
    constexpr double most_unresolved = 0.5;
    // Pairs with smaller forces, relative to the largest one, bear practically nothing.
    constexpr double negligible_force = 1e-5;

    // Nodes closer to the axis of revolution than this part of the length of a contact are on it.
    constexpr double on_axis = 1e-9;

    // A zone with at least this fraction of its nodes at the edge of the surface is one of a corner or edge.
    constexpr double part_at_edge = 1. / 3;

    /// Resolution error of a largest pressure; nothing if it cannot be resolved.
    /// @param drops differences to the adjacent nodes.
    std::optional<double> resolution(const double               pressure,
                                     const std::vector<double> &drops,
                                     const bool                 is_at_end,
                                     const double               part = of_second_difference)
    {
      double sum = 0;
      for (const double drop : drops)
        {
          if (drop > (is_at_end ? peak_at_end : peak) * pressure)
            return {};
          sum += drop;
        }
      return part * sum;
    }

    auto with_largest_pressure(const std::vector<ContactNode> &nodes)
    {
      return std::max_element(nodes.begin(), nodes.end(), [](const ContactNode &a, const ContactNode &b) {
        return a.pressure < b.pressure;
      });
    }

    /// Lower limit for the pressure of peaks.
    double least_peak(const std::vector<ContactNode> &nodes)
    {
      const auto at = with_largest_pressure(nodes);
      return at == nodes.end() ? 0. : smallest_peak * std::max(0., at->pressure);
    }

    Point place(const ContactNode &node)
    {
      return {node.position[0], node.position[1], node.position[2]};
    }

    std::vector<ContactZone> unresolved_zones(const ContactLine &line, const bool is_of_revolution)
    {
      return line.unresolved_zones(is_of_revolution);
    }

    std::vector<ContactZone> unresolved_zones(const ContactSurface &surface, const bool /*is_of_revolution*/)
    {
      return surface.unresolved_zones();
    }

    std::vector<BoxTree<3>::Box> boxes_of(const std::vector<ContactNode> &nodes)
    {
      std::vector<BoxTree<3>::Box> result;
      for (const auto &node : nodes)
        result.push_back(BoxTree<3>::box_around({place(node)}));
      return result;
    }
  } // namespace

  std::vector<ContactNode> nodes_of_pair(const std::vector<ContactNode> &nodes, const unsigned int pair)
  {
    std::vector<ContactNode> list;
    std::copy_if(nodes.begin(), nodes.end(), std::back_inserter(list), [&](const ContactNode &node) {
      return node.pair == pair;
    });
    return list;
  }

  ContactLine::ContactLine(std::vector<ContactNode> nodes)
    : line(std::move(nodes))
  {
    std::stable_sort(line.begin(), line.end(), [](const ContactNode &a, const ContactNode &b) {
      return a.arc_length < b.arc_length;
    });
  }

  std::optional<double> ContactLine::resolution() const
  {
    const auto at = with_largest_pressure(line);
    return at == line.end() ? 0. : resolution_at(at - line.begin());
  }

  std::optional<double> ContactLine::resolution_at(const std::size_t i) const
  {
    std::vector<double> drops;
    if (i > 0)
      drops.push_back(line[i].pressure - line[i - 1].pressure);
    if (i + 1 < line.size())
      drops.push_back(line[i].pressure - line[i + 1].pressure);
    const bool is_at_end = drops.size() < 2;
    double     longest = 0, shortest = std::numeric_limits<double>::infinity(); // two edges on each side
    for (std::size_t k = i > 1 ? i - 2 : 0; k < i + 2 && k + 1 < line.size(); ++k)
      {
        longest  = std::max(longest, line[k + 1].arc_length - line[k].arc_length);
        shortest = std::min(shortest, line[k + 1].arc_length - line[k].arc_length);
      }
    if (is_at_end && !drops.empty()) // of a plane of symmetry
      drops.push_back(drops[0]);
    return app::resolution(line[i].pressure,
                           drops,
                           is_at_end,
                           longest > changing_size * shortest ? of_alternation : of_second_difference);
  }

  std::vector<ContactNode> ContactLine::unresolved_peaks() const
  {
    std::vector<ContactNode> result;
    const double             least = least_peak(line);
    for (std::size_t i = 0; i < line.size(); ++i)
      if (line[i].pressure > least && (i == 0 || line[i].pressure >= line[i - 1].pressure) &&
          (i + 1 == line.size() || line[i].pressure >= line[i + 1].pressure) && !resolution_at(i))
        result.push_back(line[i]);
    return result;
  }

  std::vector<ContactZone> ContactLine::unresolved_zones(const bool may_cross_axis) const
  {
    const auto is_on_axis = [&](const ContactNode &node) {
      return may_cross_axis &&
             std::abs(node.position[0]) <= on_axis * (line.back().arc_length - line.front().arc_length);
    };
    std::vector<ContactZone> zones;
    for (std::size_t i = 0, end = 0; i < line.size(); i = end)
      {
        for (end = i; end < line.size() && line[end].is_closed == line[i].is_closed;)
          ++end;
        const bool begins = i == 0, ends = end == line.size();
        if (!line[i].is_closed || end - i > 2 || (begins && ends))
          continue;
        if ((begins || ends) && (end - i > 1 || !is_on_axis(line[i]))) // on the axis both neighbours are the same
          continue;
        const double before = begins ? HUGE_VAL : line[i].arc_length - line[i - 1].arc_length;
        const double after  = i + 1 == line.size() ? HUGE_VAL : line[i + 1].arc_length - line[i].arc_length;
        zones.push_back({line[i].position, static_cast<unsigned int>(end - i), 0, std::min(before, after)});
        for (std::size_t k = i; k < end; ++k)
          zones.back().force += line[k].pressure * line[k].area;
      }
    return zones;
  }

  ContactSurface::ContactSurface(std::vector<ContactNode> nodes_)
    : nodes(std::move(nodes_))
    , tree(boxes_of(nodes))
  {}

  std::optional<double> ContactSurface::resolution() const
  {
    const auto at = with_largest_pressure(nodes);
    return at == nodes.end() ? 0. : resolution_at(*at);
  }

  std::optional<double> ContactSurface::resolution_at(const ContactNode &node) const
  {
    std::vector<double> drops;
    for (const unsigned int k : beside(node))
      drops.push_back(node.pressure - nodes[k].pressure);
    return app::resolution(node.pressure, drops, is_at_edge(node));
  }

  std::vector<ContactNode> ContactSurface::unresolved_peaks() const
  {
    std::vector<ContactNode> result;
    const double             least = least_peak(nodes);
    for (const auto &node : nodes)
      if (node.pressure > least && !resolution_at(node))
        {
          const bool at_edge = is_at_edge(node);
          const auto around  = beside(node);
          if (std::none_of(around.begin(), around.end(), [&](const unsigned int k) {
                return nodes[k].pressure > node.pressure && !(at_edge && is_at_edge(nodes[k]));
              }))
            result.push_back(node);
        }
    return result;
  }

  std::vector<ContactZone> ContactSurface::unresolved_zones() const
  {
    std::vector<std::vector<unsigned int>> around(nodes.size()); // closed nodes next to closed ones, in both directions
    std::vector<bool>                      is_inside(nodes.size(), true);
    for (unsigned int i = 0; i < nodes.size(); ++i)
      {
        if (!nodes[i].is_closed)
          continue;
        for (const unsigned int k : beside(nodes[i]))
          {
            if (!nodes[k].is_closed)
              {
                is_inside[i] = false;
                continue;
              }
            around[i].push_back(k);
            around[k].push_back(i);
          }
      }
    std::vector<ContactZone> zones;
    std::vector<bool>        is_seen(nodes.size(), false);
    for (unsigned int first = 0; first < nodes.size(); ++first)
      {
        if (is_seen[first] || !nodes[first].is_closed)
          continue;
        std::vector<unsigned int> zone{first};
        is_seen[first] = true;
        for (std::size_t i = 0; i < zone.size(); ++i)
          for (const unsigned int k : around[zone[i]])
            if (!is_seen[k])
              {
                is_seen[k] = true;
                zone.push_back(k);
              }
        if (std::any_of(zone.begin(), zone.end(), [&](const unsigned int i) { return is_inside[i]; }))
          continue;
        const auto at_edge =
          std::count_if(zone.begin(), zone.end(), [&](const unsigned int i) { return is_at_edge(nodes[i]); });
        if (at_edge >= part_at_edge * zone.size())
          continue;
        zones.push_back({nodes[first].position, static_cast<unsigned int>(zone.size())});
        const auto next = nearest(nodes[first], 1);
        if (!next.empty())
          zones.back().distance = place(nodes[first]).distance(place(nodes[next[0]]));
        for (const unsigned int i : zone)
          zones.back().force += nodes[i].pressure * nodes[i].area;
      }
    return zones;
  }

  std::vector<unsigned int> ContactSurface::nearest(const ContactNode &node, const unsigned int n) const
  {
    std::vector<unsigned int> found;
    tree.for_each_by_distance(
      place(node),
      [] { return std::numeric_limits<double>::infinity(); },
      [&](const unsigned int k) {
        if (nodes[k].position != node.position)
          found.push_back(k);
        return found.size() < n;
      });
    return found;
  }

  std::vector<unsigned int> ContactSurface::beside(const ContactNode &node) const
  {
    return nearest(node, n_beside);
  }

  bool ContactSurface::is_at_edge(const ContactNode &node) const
  {
    const Tensor normal({node.normal[0], node.normal[1], node.normal[2]});
    Tensor       first; // in the tangent plane
    first[std::abs(normal[0]) < std::abs(normal[1]) ? 0 : 1] = 1;
    first -= first * normal * normal;
    const Tensor        second = cross_product_3d(normal, first);
    std::vector<double> angles;
    for (const unsigned int k : nearest(node, n_around))
      angles.push_back(std::atan2((place(nodes[k]) - place(node)) * second, (place(nodes[k]) - place(node)) * first));
    if (angles.empty())
      return true;
    std::sort(angles.begin(), angles.end());
    double widest = 2 * M_PI + angles.front() - angles.back();
    for (std::size_t k = 1; k < angles.size(); ++k)
      widest = std::max(widest, angles[k] - angles[k - 1]);
    return widest > angle_at_edge;
  }

  template <int dim>
  UnresolvedContacts unresolved_contacts(const std::vector<ContactNode>             &nodes,
                                         const std::vector<scene::ContactPair<dim>> &pairs,
                                         const double                                largest_force,
                                         const bool                                  is_of_revolution,
                                         const MPI_Comm                              comm)
  {
    UnresolvedContacts found;
    std::string        names, first;
    for (unsigned int k = 0; k < pairs.size(); ++k)
      {
        if (pairs[k].law.is_bonded)
          continue;
        const auto of_pair = nodes_of_pair(nodes, k);
        const auto zones   = unresolved_zones(ContactProfile<dim>(of_pair), is_of_revolution);
        double     force = 0, unresolved = 0;
        for (const auto &node : of_pair)
          force += node.pressure * node.area;
        for (const auto &zone : zones)
          unresolved += zone.force;
        if (zones.empty() || !(force > negligible_force * largest_force) || unresolved <= most_unresolved * force)
          continue;
        names += (names.empty() ? "" : ", ") + pairs[k].name;
        found.pairs.push_back(k);
        if (first.empty())
          first = format("%s: %u node%s at %s, where nodes are %.4g mm apart",
                         pairs[k].name.c_str(),
                         zones[0].n_nodes,
                         zones[0].n_nodes == 1 ? "" : "s",
                         point_text(zones[0].position, dim).c_str(),
                         zones[0].distance);
      }
    found.warning =
      names.empty()
        ? ""
        : format("Contact %s: most of the normal force acts on nodes next to open ones (%s), so that the mesh does "
                 "not resolve the contact: pressures depend on the mesh, and so do forces that equilibrium does "
                 "not determine; refine the mesh there (Refine towards) or set Mesh = adaptive",
                 names.c_str(),
                 first.c_str());
    found.pairs   = dealii::Utilities::MPI::broadcast(comm, found.pairs);
    found.warning = dealii::Utilities::MPI::broadcast(comm, found.warning);
    return found;
  }

  template UnresolvedContacts unresolved_contacts(const std::vector<ContactNode> &,
                                                  const std::vector<scene::ContactPair<2>> &,
                                                  const double,
                                                  const bool,
                                                  const MPI_Comm);
  template UnresolvedContacts unresolved_contacts(const std::vector<ContactNode> &,
                                                  const std::vector<scene::ContactPair<3>> &,
                                                  const double,
                                                  const bool,
                                                  const MPI_Comm);

  template <int dim>
  std::vector<mechanics::Surroundings<dim>> pressure_peaks(const std::vector<ContactNode>             &nodes,
                                                           const std::vector<scene::ContactPair<dim>> &pairs,
                                                           const MPI_Comm                              comm)
  {
    std::vector<std::pair<unsigned int, std::array<double, 4>>> found; // pair, position, radius
    for (unsigned int k = 0; k < pairs.size(); ++k)
      {
        const ContactProfile<dim> profile(nodes_of_pair(nodes, k));
        const double              size = profile.size([](const ContactNode &node) { return node.is_closed; }).first;
        for (const auto &node : profile.unresolved_peaks())
          {
            const auto &x = node.position;
            found.push_back({k, {{x[0], x[1], x[2], surroundings_of_peak * (dim == 2 ? size : std::sqrt(size))}}});
          }
      }
    std::vector<mechanics::Surroundings<dim>> points;
    for (const auto &[k, place] : dealii::Utilities::MPI::broadcast(comm, found))
      {
        mechanics::Surroundings<dim> around;
        for (unsigned int d = 0; d < dim; ++d)
          around.of.position[d] = place[d];
        around.of.what = "the peak of the pressure of " + pairs[k].name;
        around.of.body = pairs[k].slave.body;
        around.radius  = place[3];
        points.push_back(around);
        if (pairs[k].master)
          {
            around.of.body = pairs[k].master->body;
            points.push_back(around);
          }
      }
    return points;
  }

  template std::vector<mechanics::Surroundings<2>> pressure_peaks(const std::vector<ContactNode> &,
                                                                  const std::vector<scene::ContactPair<2>> &,
                                                                  const MPI_Comm);
  template std::vector<mechanics::Surroundings<3>> pressure_peaks(const std::vector<ContactNode> &,
                                                                  const std::vector<scene::ContactPair<3>> &,
                                                                  const MPI_Comm);
} // namespace slipstick::app
