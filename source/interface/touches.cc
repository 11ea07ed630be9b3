#include <slipstick/base/across.h>
#include <slipstick/interface/gap_rotation.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/interface/touches.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace slipstick::interface
{
  namespace
  {
    // Normals are parallel if their scalar product is above this.
    constexpr double parallel_cosine = 1 - 1e-8;
    // The reference area of tractions is at least this fraction of the tributary area: a node at the end of a boundary
    // has half the tributary length of the others.
    constexpr double smallest_covered_part = 0.5;
    // Geometric gaps below this fraction of the coordinates are rounding.
    constexpr double rounding_of_gaps = 16 * std::numeric_limits<double>::epsilon();

    // Weights, which are of order 1, are equal if they differ by less.
    constexpr double rounding_of_weights = 1e-9;

    // A row follows the rotations of both sides if no more than this part of the vector between its points does not.
    constexpr double rounding_of_spans = 1e-6;

    /// Gap of a pair at a node: geometric or prescribed, plus the offset.
    template <int dim>
    double gap_of(const scene::ContactPair<dim> &pair,
                  const dealii::Point<dim>      &x,
                  const double                   of_geometry,
                  const double                   t)
    {
      double largest = 0;
      for (unsigned int d = 0; d < dim; ++d)
        largest = std::max(largest, std::abs(x[d]));
      const double without_rounding = std::abs(of_geometry) <= rounding_of_gaps * largest ? 0. : of_geometry;
      return (pair.gap ? pair.gap->value(x, t) : without_rounding) + pair.offset.value(x, t);
    }

    /// Whether the gap is neither prescribed nor changed by an offset.
    template <int dim>
    bool is_measured(const scene::ContactPair<dim> &pair, const dealii::Point<dim> &x, const double t)
    {
      return !pair.gap && pair.offset.value(x, t) == 0;
    }
  } // namespace

  template <int dim>
  Touches<dim>::Touches(const scene::Scene<dim>               &scene,
                        const std::vector<InterfaceNode<dim>> &nodes,
                        const BodyContacts<dim>               &contacts,
                        const double                           t)
    : scene(scene)
    , nodes(nodes)
    , t(t)
  {
    for (unsigned int i = 0; i < nodes.size(); ++i)
      if (nodes[i].is_paired)
        number[nodes[i].key] = i;
    for (unsigned int k = 0; k < contacts.rows.size(); ++k)
      for (const auto &row : contacts.rows[k])
        if (number.count(row.slave) != 0)
          pairs_of[row.slave].emplace_back(k, &row);
  }

  template <int dim>
  bool have_same_nodes(const ContactCandidate<dim> &a, const ContactCandidate<dim> &b)
  {
    const auto are_same = [](const auto &side, const auto &other) {
      std::map<unsigned int, double> difference(side.begin(), side.end());
      for (const auto &[node, weight] : other)
        difference[node] -= weight;
      return std::all_of(difference.begin(), difference.end(), [](const auto &entry) {
        return std::abs(entry.second) <= rounding_of_weights;
      });
    };
    return a.normal * b.normal > same_way && are_same(a.slave, b.slave) && are_same(a.master, b.master);
  }

  template <int dim>
  std::vector<ContactCandidate<dim>> Touches<dim>::of(const unsigned int i) const
  {
    auto touches = nearest(merged(i, candidates(i)));
    for (unsigned int a = 0; a < touches.size(); ++a)
      for (unsigned int b = 0; b < a; ++b)
        if (touches[a].has_tangent && touches[b].has_tangent && touches[a].master == touches[b].master &&
            touches[a].slave == touches[b].slave)
          (touches[a].point.gap < touches[b].point.gap ? touches[b] : touches[a]).has_tangent = false;
    return touches;
  }

  template <int dim>
  std::vector<ContactCandidate<dim>> Touches<dim>::candidates(const unsigned int i) const
  {
    const auto                        &node = nodes[i];
    std::vector<ContactCandidate<dim>> touches;
    for (const auto &[pair, area] : node.areas)
      if (ContactCandidate<dim> touch; !scene.contacts[pair].law.is_bonded && place_on_obstacle(i, pair, area, touch))
        touches.push_back(touch);
    if (const auto found = pairs_of.find(node.key); found != pairs_of.end())
      for (const auto &[pair, row] : found->second)
        touches.push_back(touch_body(i, pair, *row));
    for (auto &touch : touches)
      complete(i, touch);
    return touches;
  }

  // The sum of the areas of both pairs bears the force, and the smaller gap counts.
  template <int dim>
  std::vector<ContactCandidate<dim>> Touches<dim>::merged(const unsigned int                 i,
                                                          std::vector<ContactCandidate<dim>> touches) const
  {
    const auto meet = [this](const ContactCandidate<dim> &a, const ContactCandidate<dim> &b) {
      const auto &first = scene.contacts[a.pair], &second = scene.contacts[b.pair];
      return a.pair != b.pair && !first.law.is_bonded && !second.law.is_bonded &&
             first.master.has_value() == second.master.has_value() &&
             (first.master || first.obstacle == second.obstacle) && have_same_nodes(a, b);
    };
    std::vector<ContactCandidate<dim>> result;
    for (auto &touch : touches)
      {
        const auto first =
          std::find_if(result.begin(), result.end(), [&](const auto &other) { return meet(other, touch); });
        if (first == result.end())
          {
            result.push_back(std::move(touch));
            continue;
          }
        if (first->parts.empty())
          first->parts = {*first};
        first->parts.push_back(std::move(touch));
      }
    for (auto &touch : result)
      if (!touch.parts.empty())
        {
          auto                  &point = touch.point;
          dealii::Tensor<1, dim> normal;
          point.traction_area = point.traction_length = 0;
          for (const auto &part : touch.parts)
            {
              normal += part.point.traction_area * part.normal;
              point.gap         = std::min(point.gap, part.point.gap);
              point.is_measured = point.is_measured && part.point.is_measured;
              point.traction_area += part.point.traction_area;
              point.traction_length += part.point.traction_length;
            }
          if (normal.norm() > 0)
            touch.normal = normal / normal.norm();
          complete(i, touch);
          for (const auto &part : touch.parts)
            touch.has_tangent = touch.has_tangent || part.has_tangent;
        }
    return result;
  }

  // Of obstacles in the same direction only the nearest counts.
  template <int dim>
  std::vector<ContactCandidate<dim>> Touches<dim>::nearest(const std::vector<ContactCandidate<dim>> &touches) const
  {
    std::vector<ContactCandidate<dim>> kept;
    for (unsigned int a = 0; a < touches.size(); ++a)
      {
        bool is_nearest = true;
        for (unsigned int b = 0; b < touches.size(); ++b)
          if (a != b && touches[a].master.empty() && touches[b].master.empty() &&
              touches[a].normal * touches[b].normal > parallel_cosine &&
              std::make_pair(touches[b].point.gap, b) < std::make_pair(touches[a].point.gap, a))
            is_nearest = false;
        if (is_nearest)
          kept.push_back(touches[a]);
      }
    return kept;
  }

  template <int dim>
  bool Touches<dim>::place_on_obstacle(const unsigned int     i,
                                       const unsigned int     pair,
                                       const Tributary       &area,
                                       ContactCandidate<dim> &touch) const
  {
    const auto &node        = nodes[i];
    const auto &where       = scene.contacts[pair];
    const auto  contact     = contact_with(scene.obstacles[where.obstacle], node.point(), t);
    touch.point.gap         = gap_of(where, node.point(), contact.gap, t);
    touch.point.is_measured = is_measured(where, node.point(), t);
    if (where.reach && touch.point.gap > *where.reach)
      return false;
    touch.pair   = pair;
    touch.normal = contact.normal;
    touch.slave  = {{i, 1.}};
    for (unsigned int d = 0; d < dim; ++d)
      touch.point.slave_position[d] = node.position[d];
    touch.point.area            = area.area;
    touch.point.length          = area.length;
    touch.point.traction_area   = area.area;
    touch.point.traction_length = area.length;
    return area.area > 0;
  }

  template <int dim>
  ContactCandidate<dim> Touches<dim>::touch_body(const unsigned int    i,
                                                 const unsigned int    pair,
                                                 const MortarRow<dim> &row) const
  {
    ContactCandidate<dim> touch;
    const auto           &where = scene.contacts[pair];
    touch.pair                  = pair;
    touch.side                  = row.side;
    touch.normal                = row.normal;
    for (const auto &[key, weight] : row.slave_weights)
      touch.slave.emplace_back(number.at(key), weight);
    for (const auto &[key, weight] : row.master_weights)
      touch.master.emplace_back(number.at(key), weight);
    for (unsigned int k = 0; k < n_carriers; ++k)
      for (const auto &[key, weight] : row.rotation_weights[k])
        {
          auto &rotating = touch.rotating[k];
          rotating.nodes.push_back(number.at(key));
          rotating.weights.push_back(weight);
          rotating.positions.push_back(nodes[number.at(key)].point());
        }
    touch.apart           = row.apart;
    const auto spans      = carried_spans(row);
    auto      &point      = touch.point;
    point.has_master      = true;
    const bool is_carried = spans[0].norm() + spans[1].norm() > 0;
    point.rotates     = is_carried && (row.apart - spans[0] - spans[1]).norm() <= rounding_of_spans * row.apart.norm();
    point.master_body = where.master->body;
    for (unsigned int d = 0; d < dim; ++d)
      {
        point.master_position[d] = row.master_position[d] + spans[1][d];
        for (const auto &[slave, weight] : touch.slave)
          point.slave_position[d] += weight * nodes[slave].position[d];
        point.slave_position[d] -= spans[0][d];
      }
    point.gap         = gap_of(where, nodes[i].point(), row.gap, t);
    point.is_measured = is_measured(where, nodes[i].point(), t);
    point.length      = row.length;
    const double thickness =
      std::min(scene.bodies[where.slave.body].thickness, scene.bodies[where.master->body].thickness);
    point.area            = row.measure * thickness;
    point.traction_area   = std::max(row.measure, smallest_covered_part * row.full_measure) * thickness;
    point.traction_length = std::max(row.length, smallest_covered_part * row.full_length);
    return touch;
  }

  template <int dim>
  std::vector<ContactCandidate<dim>> Touches<dim>::bonds_to_obstacles(const unsigned int i) const
  {
    std::vector<ContactCandidate<dim>> touches;
    for (const auto &[pair, area] : nodes[i].areas)
      if (ContactCandidate<dim> touch; scene.contacts[pair].law.is_bonded && place_on_obstacle(i, pair, area, touch))
        {
          complete(i, touch);
          touches.push_back(touch);
        }
    return touches;
  }

  template <int dim>
  std::vector<std::vector<std::pair<unsigned int, ContactCandidate<dim>>>> Touches<dim>::bonds_between_bodies() const
  {
    std::vector<std::vector<std::pair<unsigned int, ContactCandidate<dim>>>> by_pair(scene.contacts.size());
    for (const auto &[key, list] : pairs_of)
      for (const auto &[pair, row] : list)
        if (scene.contacts[pair].law.is_bonded)
          by_pair[pair].emplace_back(number.at(key), touch_body(number.at(key), pair, *row));
    return by_pair;
  }

  template <int dim>
  void Touches<dim>::complete(const unsigned int i, ContactCandidate<dim> &touch) const
  {
    touch.point.pair       = touch.pair;
    touch.point.slave_body = nodes[i].body;
    touch.point.key        = nodes[i].key;
    touch.has_tangent      = scene.contacts[touch.pair].law.has_tangential_row();
    for (unsigned int d = 0; d < dim; ++d)
      {
        touch.point.position[d] = nodes[i].position[d];
        touch.point.normal[d]   = touch.normal[d];
      }
    if constexpr (dim == 3)
      {
        const auto tangents = across(touch.normal);
        for (unsigned int k = 0; k + 1 < dim; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            touch.point.tangents[k][d] = tangents[k][d];
      }
  }

  template <int dim>
  std::vector<PairExtent> Touches<dim>::extents() const
  {
    std::vector<PairExtent> result(scene.contacts.size());
    for (unsigned int i = 0; i < nodes.size(); ++i)
      for (const auto &touch : nearest(candidates(i)))
        {
          auto &extent = result[touch.pair];
          extent.gap   = std::min(extent.gap, touch.point.gap);
          extent.length += touch.point.length;
          ++extent.n_nodes;
        }
    return result;
  }

  template bool have_same_nodes(const ContactCandidate<2> &, const ContactCandidate<2> &);
  template bool have_same_nodes(const ContactCandidate<3> &, const ContactCandidate<3> &);
  template class Touches<2>;
  template class Touches<3>;
} // namespace slipstick::interface
