#include <slipstick/interface/held_contact.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/interface/row_builder.h>
#include <slipstick/tfeti/dense.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace slipstick::interface
{
  namespace
  {
    // Normals are parallel when their product is above this.
    constexpr double parallel_cosine = 1 - 1e-8;
    // Tractions are forces over no less than this part of the tributary length: a node at the end of a boundary has
    // half of that of the others.
    constexpr double smallest_covered_part = 0.5;
    // In space tangents are held when supports leave less than this of their rows (the slave's part is 1): at the edge of a pair on a
    // plane of symmetry the weights of master nodes off the plane all but vanish, and such rows are nearly those of the supports.
    template <int dim>
    constexpr double held_tangent = dim == 2 ? held_direction_tolerance : 0.05;

    double norm(const std::map<unsigned int, double> &v)
    {
      double squares = 0;
      for (const auto &[i, value] : v)
        squares += value * value;
      return std::sqrt(squares);
    }

    double product(const std::map<unsigned int, double> &v, const std::map<unsigned int, double> &w)
    {
      double sum = 0;
      for (const auto &[i, value] : w)
        if (const auto found = v.find(i); found != v.end())
          sum += value * found->second;
      return sum;
    }

    /// v less its part along w.
    std::map<unsigned int, double> without(std::map<unsigned int, double> v, const std::map<unsigned int, double> &w)
    {
      const double part = product(v, w);
      for (const auto &[i, value] : w)
        v[i] -= part / (norm(w) * norm(w)) * value;
      return v;
    }

    /// Unit vectors across the normal and each other. In space the first is nearest to the axis that is most across.
    template <int dim>
    std::array<dealii::Tensor<1, dim>, dim - 1> tangents_of(const dealii::Tensor<1, dim> &normal)
    {
      std::array<dealii::Tensor<1, dim>, dim - 1> tangents;
      if constexpr (dim == 2)
        {
          tangents[0][0] = -normal[1];
          tangents[0][1] = normal[0];
        }
      else
        {
          unsigned int axis = 0;
          for (unsigned int d = 1; d < dim; ++d)
            if (std::abs(normal[d]) < std::abs(normal[axis]))
              axis = d;
          tangents[0][axis] = 1;
          tangents[0] -= normal[axis] * normal;
          tangents[0] /= tangents[0].norm();
          tangents[1] = cross_product_3d(normal, tangents[0]);
        }
      return tangents;
    }

    // What tells the names of the rows along both tangents of a node apart.
    constexpr std::uint64_t second_tangent = std::uint64_t(1) << 48;

    // Sums below this part of their terms are rounding.
    constexpr double rounding_of_sums = 1e-12;
    // Gaps of the geometry below this part of the coordinates are their rounding.
    constexpr double rounding_of_gaps = 16 * std::numeric_limits<double>::epsilon();

    /// Gap of a pair at a node: of the geometry or given, and the offset.
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
  } // namespace

  template <int dim>
  RowBuilder<dim>::RowBuilder(const scene::Scene<dim>               &scene,
                              const std::vector<InterfaceNode<dim>> &nodes,
                              const BodyContacts<dim>               &contacts,
                              const double                           t,
                              tfeti::Constraints                    &constraints)
    : scene(scene)
    , nodes(nodes)
    , t(t)
    , constraints(constraints)
    , limits(scene.contacts.size(), std::numeric_limits<double>::infinity())
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
  void RowBuilder<dim>::build()
  {
    find_bonds();
    for (unsigned int i = 0; i < nodes.size(); ++i)
      add(i);
    if (!scene.foundations.empty())
      constraints.compliance.resize(constraints.kind.size(), 0.);
  }

  template <int dim>
  std::vector<PairExtent> RowBuilder<dim>::extents() const
  {
    std::vector<PairExtent> result(scene.contacts.size());
    for (unsigned int i = 0; i < nodes.size(); ++i)
      for (const Touch &touch : touches_of(i))
        {
          auto &extent = result[touch.pair];
          extent.gap   = std::min(extent.gap, touch.point.gap);
          extent.length += touch.point.length;
          ++extent.n_nodes;
        }
    return result;
  }

  template <int dim>
  void RowBuilder<dim>::limit_gaps(std::vector<double> limits_)
  {
    limits = std::move(limits_);
  }

  template <int dim>
  void RowBuilder<dim>::add(const unsigned int i)
  {
    const auto &node = nodes[i];
    add_bonds_to_obstacles(i);
    add_contact(i);
    add_held_rows(i);
    for (unsigned int k = 0; k + 1 < node.copies.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        {
          const unsigned int row = new_row(tfeti::RowKind::gluing, 0., node.key, k * dim + c);
          entries.push_back({row, node.copies[k].first, node.copies[k].second * dim + c, 1., true});
          entries.push_back({row, node.copies[k + 1].first, node.copies[k + 1].second * dim + c, -1., true});
          ++constraints.counts.gluing;
        }
    for (unsigned int c = 0; c < dim; ++c)
      {
        for (const auto &copy : node.copies)
          entries.push_back({n_interface, copy.first, copy.second * dim + c, 1., false});
        constraints.interface_held.push_back(node.is_acted_on());
        ++n_interface;
      }
  }

  template <int dim>
  void RowBuilder<dim>::add_held_rows(const unsigned int i)
  {
    const auto        &node             = nodes[i];
    const unsigned int first_reaction   = constraints.reactions.size();
    const auto         row_coefficients = [i](const Tensor &direction) {
      Vector coefficients;
      for (unsigned int c = 0; c < dim; ++c)
        coefficients[dim * i + c] = direction[c];
      return coefficients;
    };
    for (const auto &held : node.held)
      {
        Tensor direction;
        for (unsigned int c = 0; c < dim; ++c)
          direction[c] = held.direction[c];
        const unsigned int row = new_row(tfeti::RowKind::prescribed, held.value, node.key, held.which);
        fill(row, row_coefficients(direction));
        add_reaction(i, row, direction, held.by);
        ++constraints.counts.prescribed;
      }
    // the contact nodes that were found here a moment ago share these
    std::vector<unsigned int> reactions(constraints.reactions.size() - first_reaction);
    std::iota(reactions.begin(), reactions.end(), first_reaction);
    for (auto point = held.points.rbegin(); point != held.points.rend() && point->contact.key == node.key; ++point)
      if (!point->contact.has_master)
        point->reactions = reactions;
    std::set<unsigned int> foundations;
    for (const auto &side : node.sides)
      if (side.condition >= scene.supports.size())
        foundations.insert(side.condition);
    for (unsigned int k = 0; k < node.springs.size(); ++k)
      {
        const unsigned int row = new_row(tfeti::RowKind::prescribed, 0., node.key, 1000 + k);
        fill(row, row_coefficients(node.springs[k].direction));
        add_reaction(i, row, node.springs[k].direction, {foundations.begin(), foundations.end()});
        constraints.compliance.resize(constraints.kind.size(), 0.);
        constraints.compliance.back() = 1 / node.springs[k].stiffness;
        ++constraints.counts.prescribed;
      }
  }

  template <int dim>
  void RowBuilder<dim>::add_reaction(const unsigned int               i,
                                     const unsigned int               row,
                                     const Tensor                    &direction,
                                     const std::vector<unsigned int> &holders)
  {
    tfeti::Reaction reaction;
    reaction.row     = row;
    reaction.holders = holders;
    for (unsigned int d = 0; d < dim; ++d)
      {
        reaction.direction[d] = direction[d];
        reaction.position[d]  = nodes[i].position[d];
      }
    constraints.reactions.push_back(std::move(reaction));
  }

  template <int dim>
  unsigned int RowBuilder<dim>::new_row(const tfeti::RowKind      kind,
                                        const double              c,
                                        const mechanics::NodeKey &key,
                                        const std::uint64_t       which)
  {
    constraints.kind.push_back(kind);
    constraints.c.push_back(c);
    std::uint64_t label = 1469598103934665603ull; // FNV-1a over what names the row
    for (const std::uint64_t part : {key[0], key[1], std::uint64_t(kind), which})
      label = (label ^ part) * 1099511628211ull;
    constraints.label.push_back(label);
    return constraints.kind.size() - 1;
  }

  template <int dim>
  void RowBuilder<dim>::fill(const unsigned int row, const Vector &coefficients)
  {
    fill(row, coefficients, entries);
  }

  template <int dim>
  void RowBuilder<dim>::fill(const unsigned int row, const Vector &coefficients, std::vector<RowEntry> &to) const
  {
    for (const auto &[i, value] : coefficients)
      if (value != 0)
        {
          const auto &copy = nodes[i / dim].copies[0];
          to.push_back({row, copy.first, copy.second * dim + i % dim, value, true});
        }
  }

  template <int dim>
  bool RowBuilder<dim>::touch_obstacle(const unsigned int i,
                                       const unsigned int pair,
                                       const Tributary   &area,
                                       Touch             &touch) const
  {
    return !scene.contacts[pair].law.is_bonded && place_on_obstacle(i, pair, area, touch);
  }

  template <int dim>
  bool RowBuilder<dim>::place_on_obstacle(const unsigned int i,
                                          const unsigned int pair,
                                          const Tributary   &area,
                                          Touch             &touch) const
  {
    const auto &node    = nodes[i];
    const auto &where   = scene.contacts[pair];
    const auto  contact = contact_with(scene.obstacles[where.obstacle], node.point(), t);
    touch.point.gap     = gap_of(where, node.point(), contact.gap, t);
    if (where.reach && touch.point.gap > *where.reach)
      return false;
    touch.pair                  = pair;
    touch.normal                = contact.normal;
    touch.slave                 = {{i, 1.}};
    touch.point.area            = area.area;
    touch.point.length          = area.length;
    touch.point.traction_area   = area.area;
    touch.point.traction_length = area.length;
    return area.area > 0;
  }

  template <int dim>
  bool RowBuilder<dim>::touch_body(const unsigned int    i,
                                   const unsigned int    pair,
                                   const MortarRow<dim> &row,
                                   Touch                &touch) const
  {
    const auto &where = scene.contacts[pair];
    touch.pair        = pair;
    touch.side        = row.side;
    touch.normal      = row.normal;
    for (const auto &[key, weight] : row.slave_weights)
      touch.slave.emplace_back(number.at(key), weight);
    for (const auto &[key, weight] : row.master_weights)
      touch.master.emplace_back(number.at(key), weight);
    auto &point       = touch.point;
    point.has_master  = true;
    point.master_body = where.master->body;
    for (unsigned int d = 0; d < dim; ++d)
      point.master_position[d] = row.master_position[d];
    point.gap    = gap_of(where, nodes[i].point(), row.gap, t);
    point.length = row.length;
    const double thickness =
      std::min(scene.bodies[where.slave.body].thickness, scene.bodies[where.master->body].thickness);
    point.area            = row.measure * thickness;
    point.traction_area   = std::max(row.measure, smallest_covered_part * row.full_measure) * thickness;
    point.traction_length = std::max(row.length, smallest_covered_part * row.full_length);
    return true;
  }

  template <int dim>
  std::vector<typename RowBuilder<dim>::Touch> RowBuilder<dim>::touches_of(const unsigned int i) const
  {
    const auto        &node = nodes[i];
    std::vector<Touch> touches;
    for (const auto &[pair, area] : node.areas)
      if (Touch touch; touch_obstacle(i, pair, area, touch))
        touches.push_back(touch);
    if (const auto found = pairs_of.find(node.key); found != pairs_of.end())
      for (const auto &[pair, row] : found->second)
        if (Touch touch; touch_body(i, pair, *row, touch))
          touches.push_back(touch);
    for (auto &touch : touches)
      complete(i, touch);
    // of obstacles in the same direction the nearest
    std::vector<Touch> kept;
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
  void RowBuilder<dim>::complete(const unsigned int i, Touch &touch) const
  {
    touch.point.pair          = touch.pair;
    touch.point.slave_body    = nodes[i].body;
    touch.point.key           = nodes[i].key;
    touch.point.interface_dof = dim * i;
    touch.has_tangent         = scene.contacts[touch.pair].law.has_tangential_row();
    for (unsigned int d = 0; d < dim; ++d)
      {
        touch.point.position[d] = nodes[i].position[d];
        touch.point.normal[d]   = touch.normal[d];
      }
    if constexpr (dim == 3)
      for (unsigned int k = 0; k + 1 < dim; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          touch.point.tangents[k][d] = tangents_of<dim>(touch.normal)[k][d];
  }

  template <int dim>
  void RowBuilder<dim>::choose_tangents(std::vector<Touch> &touches) const
  {
    for (unsigned int a = 0; a < touches.size(); ++a)
      for (unsigned int b = 0; b < a; ++b)
        if (touches[a].has_tangent && touches[b].has_tangent && touches[a].master == touches[b].master &&
            touches[a].slave == touches[b].slave)
          (touches[a].point.gap < touches[b].point.gap ? touches[b] : touches[a]).has_tangent = false;
  }

  template <int dim>
  typename RowBuilder<dim>::Vector RowBuilder<dim>::jump(const Touch &touch, const Tensor &direction) const
  {
    Vector row;
    for (unsigned int c = 0; c < dim; ++c)
      {
        for (const auto &[node, weight] : touch.slave)
          row[dim * node + c] += weight * direction[c];
        for (const auto &[node, weight] : touch.master)
          row[dim * node + c] -= weight * direction[c];
      }
    return row;
  }

  template <int dim>
  typename RowBuilder<dim>::Vector RowBuilder<dim>::bond(const Touch &touch, const unsigned int direction) const
  {
    return jump(touch, direction == 0 ? touch.normal : tangents_of<dim>(touch.normal)[direction - 1]);
  }

  template <int dim>
  typename RowBuilder<dim>::Vector RowBuilder<dim>::free_part(const Vector &row) const
  {
    Vector left;
    for (auto at = row.begin(); at != row.end(); std::advance(at, dim))
      {
        const unsigned int node = at->first / dim;
        Tensor             direction;
        for (unsigned int c = 0; c < dim; ++c)
          direction[c] = row.at(dim * node + c);
        direction = nodes[node].free_part(direction);
        for (unsigned int c = 0; c < dim; ++c)
          left[dim * node + c] = direction[c];
      }
    return left;
  }

  template <int dim>
  void RowBuilder<dim>::find_bonds()
  {
    // pairs in the order of the scene, so that the result does not depend on the numbers of the nodes
    std::vector<std::vector<std::pair<unsigned int, Touch>>> by_pair(scene.contacts.size());
    for (const auto &[key, list] : pairs_of)
      for (const auto &[pair, row] : list)
        if (scene.contacts[pair].law.is_bonded)
          {
            Touch touch;
            touch_body(number.at(key), pair, *row, touch);
            by_pair[pair].emplace_back(number.at(key), std::move(touch));
          }
    for (const auto &list : by_pair)
      for (const auto &[i, touch] : list)
        for (unsigned int d = 0; d < dim; ++d)
          if (bonds.add(free_part(bond(touch, d)), held_direction_tolerance, dim * i, dim * (i + 1)))
            kept_bonds.insert(std::array<unsigned int, 4>{{i, touch.pair, touch.side, d}});
  }

  template <int dim>
  void RowBuilder<dim>::add_contact(const unsigned int i)
  {
    auto touches = touches_of(i);
    choose_tangents(touches);
    const auto &key     = nodes[i].key;
    const auto  is_free = [](const Vector &left) { return norm(left) > held_direction_tolerance; };
    for (Touch &touch : touches)
      if (scene.contacts[touch.pair].law.is_bonded)
        {
          for (unsigned int d = 0; d < dim; ++d)
            {
              if (kept_bonds.count(std::array<unsigned int, 4>{{i, touch.pair, touch.side, d}}) == 0)
                continue;
              const unsigned int number =
                new_row(tfeti::RowKind::bonded, 0., key, (1ull << 32) + 16 * touch.pair + 4 * touch.side + d);
              (d == 0 ? touch.point.normal_row : d == 1 ? touch.point.tangential_row : touch.point.second_row) = number;
              fill(number, bond(touch, d));
              ++constraints.counts.gluing;
            }
          if (touch.point.normal_row != tfeti::invalid_row || touch.point.tangential_row != tfeti::invalid_row)
            constraints.bonded_points.push_back(touch.point);
        }
    for (Touch &touch : touches)
      {
        if (scene.contacts[touch.pair].law.is_bonded)
          continue;
        const auto normal     = jump(touch, touch.normal);
        const auto left       = bonds.reduce(free_part(normal));
        const bool has_normal = is_free(left);
        if (!has_normal)
          add_held(i, touch, normal);
        if (is_pruned(touch))
          {
            if (has_normal)
              add_pruned(touch, normal);
            continue;
          }
        std::vector<Vector> across; // along the tangents that are not held
        if (touch.has_tangent && !(!has_normal && is_held_open(held.points.back())))
          across = free_tangents(touch, has_normal ? left : Vector());
        if (!has_normal && across.empty())
          continue;
        const std::uint64_t which = touch.pair + (std::uint64_t(touch.side) << 32);
        for (unsigned int k = 0; k < across.size(); ++k)
          {
            const unsigned int row = new_row(tfeti::RowKind::tangential, 0., key, which + k * second_tangent);
            (k == 0 ? touch.point.tangential_row : touch.point.second_row) = row;
            fill(row, across[k]);
            ++constraints.counts.tangential;
          }
        if (has_normal)
          {
            touch.point.normal_row = new_row(tfeti::RowKind::normal, touch.point.gap, key, which);
            fill(touch.point.normal_row, normal);
            ++constraints.counts.normal;
          }
        else
          held.points.back().place = constraints.contact_points.size();
        ++constraints.counts.candidates;
        constraints.contact_points.push_back(touch.point);
      }
  }

  template <int dim>
  std::vector<typename RowBuilder<dim>::Vector> RowBuilder<dim>::free_tangents(Touch &touch, const Vector &left) const
  {
    const auto free_of = [&](const Vector &row) {
      auto free = bonds.reduce(free_part(row));
      return left.empty() ? free : without(free, left);
    };
    auto                tangents = tangents_of<dim>(touch.normal);
    std::vector<Vector> rows;
    if constexpr (dim == 3)
      { // where supports hold a tangent the force is along the other one: the disc becomes an interval
        const Vector    a = free_of(jump(touch, tangents[0])), b = free_of(jump(touch, tangents[1]));
        Eigen::Matrix2d gram;
        gram << product(a, a), product(a, b), product(a, b), product(b, b);
        const tfeti::SymmetricEigen principal(gram);
        if (principal.values[0] <= held_tangent<dim> * held_tangent<dim>)
          {
            const auto v = principal.vectors.col(1);
            const auto t = v[0] * tangents[0] + v[1] * tangents[1];
            tangents[1]  = v[0] * tangents[1] - v[1] * tangents[0];
            tangents[0]  = t;
          }
        for (unsigned int k = 0; k + 1 < dim; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            touch.point.tangents[k][d] = tangents[k][d];
      }
    for (const auto &tangent : tangents)
      if (const auto row = jump(touch, tangent); norm(free_of(row)) > held_tangent<dim>)
        rows.push_back(row);
    return rows;
  }

  template <int dim>
  bool RowBuilder<dim>::is_held_open(const tfeti::HeldContacts::Point &point) const
  {
    return point.is_known && scene.contacts[point.contact.pair].law.acts_where_closed_alone() &&
           point.contact.gap - point.closing > held_contact_tolerance(point);
  }

  template <int dim>
  void RowBuilder<dim>::add_held(const unsigned int i, const Touch &touch, const Vector &coefficients)
  {
    tfeti::HeldContacts::Point point;
    point.contact = touch.point;
    fill(held.points.size(), coefficients, held_entries);
    held.gaps.kind.push_back(tfeti::RowKind::normal);
    held.gaps.c.push_back(touch.point.gap);
    std::set<unsigned int> holders, all_nodes{i};
    for (const auto *side : {&touch.slave, &touch.master})
      for (const auto &[node, weight] : *side)
        all_nodes.insert(node);
    for (const unsigned int node : all_nodes)
      for (const auto &direction : nodes[node].held)
        holders.insert(direction.by.begin(), direction.by.end());
    point.holders.assign(holders.begin(), holders.end());
    point.is_known = norm(free_part(coefficients)) <= held_direction_tolerance;
    double size    = 0;
    for (const auto &[k, value] : coefficients)
      {
        const double part = value * nodes[k / dim].held_displacement()[k % dim];
        point.closing += part;
        size += std::abs(part);
      }
    if (std::abs(point.closing) <= rounding_of_sums * size) // both sides are moved alike
      point.closing = 0;
    held.points.push_back(std::move(point));
  }

  template <int dim>
  void RowBuilder<dim>::add_bonds_to_obstacles(const unsigned int i)
  {
    for (const auto &[k, area] : nodes[i].areas)
      if (const auto &pair = scene.contacts[k]; pair.law.is_bonded)
        if (Touch touch; place_on_obstacle(i, k, area, touch))
          {
            complete(i, touch);
            add_held(i, touch, jump(touch, touch.normal));
            held.points.back().is_bonded = true;
            held.points.back().holder    = scene.supports.size() + scene.foundations.size() + k;
          }
  }

  template <int dim>
  bool RowBuilder<dim>::is_pruned(const Touch &touch) const
  {
    return touch.point.gap > limits[touch.pair] && scene.contacts[touch.pair].law.acts_where_closed_alone();
  }

  template <int dim>
  void RowBuilder<dim>::add_pruned(const Touch &touch, const Vector &coefficients)
  {
    fill(pruned.c.size(), coefficients, pruned_entries);
    pruned.kind.push_back(tfeti::RowKind::normal);
    pruned.c.push_back(touch.point.gap);
    ++constraints.counts.candidates;
  }

  template class RowBuilder<2>;
  template class RowBuilder<3>;
} // namespace slipstick::interface
