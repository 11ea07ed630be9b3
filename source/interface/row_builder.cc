#include <slipstick/base/across.h>
#include <slipstick/interface/gap_rotation.h>
#include <slipstick/interface/held_contact.h>
#include <slipstick/interface/row_builder.h>
#include <slipstick/interface/shared_points.h>
#include <slipstick/tfeti/dense.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace slipstick::interface
{
  namespace
  {
    // A tangent is held if supports leave less than this fraction of its row (the slave's part is 1), ...
    constexpr double held_tangent = 0.05;
    // ... or of the slave's part, and less than this fraction of the master's: where the edge of a pair is on a plane of
    // symmetry, weights of master nodes off the plane cancel those of their mirror images, so that there is no such row.
    constexpr double held_master = 0.7;

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

    /// v minus its component along w.
    std::map<unsigned int, double> without(std::map<unsigned int, double> v, const std::map<unsigned int, double> &w)
    {
      const double factor = product(v, w) / product(w, w);
      for (const auto &[i, value] : w)
        v[i] -= factor * value;
      return v;
    }

    /// In space: if less than held_tangent of the row along some tangent is free, turns the tangents so that this is the
    /// second one. @param free_of the free part of the row along a tangent
    template <typename Tangents, typename FreePart>
    void turn_to_held(Tangents &tangents, const FreePart &free_of)
    {
      if constexpr (std::tuple_size<Tangents>() == 2)
        {
          const auto      a = free_of(tangents[0]), b = free_of(tangents[1]);
          Eigen::Matrix2d gram;
          gram << product(a, a), product(a, b), product(a, b), product(b, b);
          const tfeti::SymmetricEigen principal(gram);
          if (principal.values[0] > held_tangent * held_tangent)
            return;
          const auto v = principal.vectors.col(1);
          const auto t = v[0] * tangents[0] + v[1] * tangents[1];
          tangents[1]  = v[0] * tangents[1] - v[1] * tangents[0];
          tangents[0]  = t;
        }
    }

    // What distinguishes the labels of rows of one node and kind. Rows of contact pairs: the pair from bit 0, its side
    // from bit 32, the tangent in bit 48. Prescribed displacements: their component or normal; springs: this and more.
    constexpr unsigned int first_side = 32, second_tangent = 48, first_spring = 1000;

    /// The same for bonds, disjoint too: direction in bits 0 and 1, side in bits 2 and 3 and from bit 48, pair from bit 4.
    /// Bit 32 is always set. (Labels decide the start vector of Lanczos' method and thus the last digits of results.)
    std::uint64_t bond_number(const std::uint64_t pair, const std::uint64_t side, const std::uint64_t direction)
    {
      return direction + (side % 4 << 2) + (pair << 4) + (std::uint64_t(1) << 32) + (side / 4 << 48);
    }

    /// Solids only: those of the plane follow from the normal.
    template <typename Tangents>
    void set_tangents(const Tangents &tangents, tfeti::ContactPoint &point)
    {
      if constexpr (std::tuple_size<Tangents>() == 2)
        for (unsigned int k = 0; k < 2; ++k)
          for (unsigned int d = 0; d < 3; ++d)
            point.tangents[k][d] = tangents[k][d];
    }

    // Sums below this fraction of their terms are rounding.
    constexpr double rounding_of_sums = 1e-12;
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
    , touches(scene, nodes, contacts, t)
    , constraints(constraints)
    , limits(scene.contacts.size(), std::numeric_limits<double>::infinity())
  {}

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
    // the contact nodes just found at this node share these
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
        const unsigned int row = new_row(tfeti::RowKind::prescribed, 0., node.key, first_spring + k);
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
    std::uint64_t label = 1469598103934665603ull; // a hash like FNV-1a, but of whole words, of what identifies the row
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
  typename RowBuilder<dim>::Vector RowBuilder<dim>::jump(const ContactCandidate<dim> &touch,
                                                         const Tensor                &direction) const
  {
    Vector row;
    for (unsigned int c = 0; c < dim; ++c)
      {
        for (const auto &[node, weight] : touch.slave)
          row[dim * node + c] += weight * direction[c];
        for (const auto &[node, weight] : touch.master)
          row[dim * node + c] -= weight * direction[c];
      }
    const auto spans = spans_of_carriers<dim>(touch.apart, touch.normal);
    for (unsigned int k = 0; k < n_carriers; ++k)
      {
        const auto &carrier      = touch.rotating[k];
        const auto  coefficients = rotation_coefficients(carrier.weights, carrier.positions, spans[k], direction);
        for (unsigned int j = 0; j < coefficients.size(); ++j)
          for (unsigned int c = 0; c < dim; ++c)
            row[dim * carrier.nodes[j] + c] -= coefficients[j][c];
      }
    return row;
  }

  template <int dim>
  typename RowBuilder<dim>::Vector RowBuilder<dim>::free_sides(const ContactCandidate<dim> &touch,
                                                               const Tensor                &direction) const
  {
    Vector     result;
    const auto add_side = [&](const auto &side, const double factor) {
      double squares = 0;
      for (const auto &[node, weight] : side)
        squares += weight * weight;
      for (const auto &[node, weight] : side)
        {
          const Tensor left = nodes[node].free_part(direction);
          for (unsigned int c = 0; c < dim; ++c)
            result[dim * node + c] += factor * weight / std::sqrt(squares) * left[c];
        }
    };
    add_side(touch.slave, 1.);
    add_side(touch.master, held_tangent / held_master);
    return result;
  }

  template <int dim>
  typename RowBuilder<dim>::Tangents RowBuilder<dim>::tangents_of(const ContactCandidate<dim> &touch) const
  {
    auto tangents = across(touch.normal);
    turn_to_held(tangents, [&](const Tensor &tangent) { return free_sides(touch, tangent); });
    return tangents;
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
    for (const auto &list : touches.bonds_between_bodies())
      for (const auto &[i, touch] : list)
        {
          const auto tangents = tangents_of(touch);
          for (unsigned int d = 0; d < dim; ++d)
            {
              const Tensor &direction = d == 0 ? touch.normal : tangents[d - 1];
              const auto    row       = jump(touch, direction);
              if (d > 0 && norm(free_sides(touch, direction)) <= held_tangent && !is_moved(row))
                continue;
              if (bonds.add(free_part(row), held_direction_tolerance, dim * i, dim * (i + 1)))
                kept_bonds.insert(std::array<unsigned int, 4>{{i, touch.pair, touch.side, d}});
            }
        }
  }

  template <int dim>
  void RowBuilder<dim>::add_contact(const unsigned int i)
  {
    auto        touching = touches.of(i);
    const auto &key      = nodes[i].key;
    const auto  is_free  = [](const Vector &left) { return norm(left) > held_direction_tolerance; };
    const std::function<bool(const ContactCandidate<dim> &)> is_kept = [this, i](const ContactCandidate<dim> &bond) {
      return kept_bonds.count(std::array<unsigned int, 4>{{i, bond.pair, bond.side, 0}}) > 0;
    };
    for (ContactCandidate<dim> &touch : touching)
      if (scene.contacts[touch.pair].law.is_bonded)
        {
          const auto tangents = tangents_of(touch);
          set_tangents(tangents, touch.point);
          for (unsigned int d = 0; d < dim; ++d)
            {
              if (kept_bonds.count(std::array<unsigned int, 4>{{i, touch.pair, touch.side, d}}) == 0)
                continue;
              const unsigned int number =
                new_row(tfeti::RowKind::bonded, 0., key, bond_number(touch.pair, touch.side, d));
              (d == 0 ? touch.point.normal_row : d == 1 ? touch.point.tangential_row : touch.point.second_row) = number;
              fill(number, jump(touch, d == 0 ? touch.normal : tangents[d - 1]));
              ++constraints.counts.gluing;
            }
          if (touch.point.normal_row != tfeti::invalid_row)
            share_bond(scene, nodes[i].point(), t, is_kept, touching, touch, constraints);
          if (touch.point.normal_row != tfeti::invalid_row || touch.point.tangential_row != tfeti::invalid_row)
            constraints.bonded_points.push_back(touch.point);
        }
    for (ContactCandidate<dim> &touch : contacts_beside_bonds(std::move(touching)))
      {
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
        std::vector<Vector> across; // rows along the tangents that are not held
        if (touch.has_tangent && !(!has_normal && is_held_open(held.points.back())))
          {
            across                     = free_tangents(touch, has_normal ? left : Vector());
            touch.point.is_held_across = across.empty();
          }
        if (!has_normal && across.empty())
          continue;
        const std::uint64_t which = touch.pair + (std::uint64_t(touch.side) << first_side);
        for (unsigned int k = 0; k < across.size(); ++k)
          {
            const unsigned int row =
              new_row(tfeti::RowKind::tangential, 0., key, which + (std::uint64_t(k) << second_tangent));
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
        share_contact(scene, nodes[i].point(), t, touch, constraints);
        constraints.contact_points.push_back(touch.point);
      }
  }

  // Contacts that supports or bonds imply count for each pair by itself.
  template <int dim>
  std::vector<ContactCandidate<dim>> RowBuilder<dim>::contacts_beside_bonds(
    std::vector<ContactCandidate<dim>> touching) const
  {
    std::vector<ContactCandidate<dim>> result;
    for (ContactCandidate<dim> &touch : touching)
      {
        if (scene.contacts[touch.pair].law.is_bonded || touch.is_implied)
          continue;
        if (touch.parts.empty() || norm(bonds.reduce(free_part(jump(touch, touch.normal)))) > held_direction_tolerance)
          {
            result.push_back(std::move(touch));
            continue;
          }
        bool has_tangent = false; // of an earlier part
        for (ContactCandidate<dim> &part : touch.parts)
          {
            part.has_tangent = part.has_tangent && !has_tangent;
            has_tangent      = has_tangent || part.has_tangent;
            result.push_back(std::move(part));
          }
      }
    return result;
  }

  template <int dim>
  std::vector<typename RowBuilder<dim>::Vector> RowBuilder<dim>::free_tangents(ContactCandidate<dim> &touch,
                                                                               const Vector          &left) const
  {
    const auto free_of = [&](const Vector &row) {
      auto free = bonds.reduce(free_part(row));
      return left.empty() ? free : without(free, left);
    };
    auto tangents = tangents_of(touch); // if a support holds one of them, the disc becomes an interval along the other
    turn_to_held(tangents, [&](const Tensor &tangent) { return free_of(jump(touch, tangent)); });
    set_tangents(tangents, touch.point);
    std::vector<Vector> rows;
    for (const auto &tangent : tangents)
      {
        const auto row = jump(touch, tangent);
        if ((norm(free_of(row)) > held_tangent && norm(free_sides(touch, tangent)) > held_tangent) || is_moved(row))
          rows.push_back(row);
      }
    return rows;
  }

  template <int dim>
  double RowBuilder<dim>::prescribed(const Vector &row, const double at) const
  {
    double sum = 0, size = 0;
    for (auto entry = row.begin(); entry != row.end(); std::advance(entry, dim))
      {
        const auto displacement = held_displacement(entry->first / dim, at);
        for (unsigned int c = 0; c < dim; ++c)
          {
            const double part = row.at(entry->first + c) * displacement[c];
            sum += part;
            size += std::abs(part);
          }
      }
    return std::abs(sum) <= rounding_of_sums * size ? 0. : sum; // else both sides have the same prescribed displacement
  }

  template <int dim>
  dealii::Tensor<1, dim> RowBuilder<dim>::held_displacement(const unsigned int node, const double at) const
  {
    if (at == t)
      return nodes[node].held_displacement();
    auto then = nodes[node];
    for (auto &held : then.held)
      held.value = held.by.front() < scene.supports.size()
                     ? scene.supports[held.by.front()].displacement(held.which)->value(then.point(), at)
                     : 0.;
    return then.held_displacement();
  }

  template <int dim>
  bool RowBuilder<dim>::is_moved(const Vector &row) const
  {
    const auto &factors = scene.load_factors;
    return prescribed(row, t) != 0 || std::any_of(factors.begin(), factors.end(), [&](const double at) {
             return at < t && prescribed(row, at) != 0;
           });
  }

  template <int dim>
  bool RowBuilder<dim>::is_held_open(const tfeti::HeldContacts::Point &point) const
  {
    return point.is_known && scene.contacts[point.contact.pair].law.acts_where_closed_alone() &&
           point.contact.gap - point.closing > held_contact_tolerance(point);
  }

  template <int dim>
  void RowBuilder<dim>::add_held(const unsigned int i, const ContactCandidate<dim> &touch, const Vector &coefficients)
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
    point.closing  = prescribed(coefficients, t);
    held.points.push_back(std::move(point));
  }

  template <int dim>
  void RowBuilder<dim>::add_bonds_to_obstacles(const unsigned int i)
  {
    for (auto &touch : touches.bonds_to_obstacles(i))
      {
        for (const auto &other : touches.of(i)) // the bond bears the force of the contact with the same obstacle, too
          if (!scene.contacts[other.pair].law.is_bonded && !scene.contacts[other.pair].master &&
              scene.contacts[other.pair].obstacle == scene.contacts[touch.pair].obstacle)
            {
              touch.point.traction_area += other.point.traction_area;
              touch.point.traction_length += other.point.traction_length;
            }
        add_held(i, touch, jump(touch, touch.normal));
        held.points.back().is_bonded = true;
        held.points.back().holder    = scene.supports.size() + scene.foundations.size() + touch.pair;
      }
  }

  template <int dim>
  bool RowBuilder<dim>::is_pruned(const ContactCandidate<dim> &touch) const
  {
    const auto is_beyond = [this, &touch](const unsigned int pair) {
      return touch.point.gap > limits[pair] && scene.contacts[pair].law.acts_where_closed_alone();
    };
    return is_beyond(touch.pair) &&
           std::all_of(touch.parts.begin(), touch.parts.end(), [&](const auto &part) { return is_beyond(part.pair); });
  }

  template <int dim>
  void RowBuilder<dim>::add_pruned(const ContactCandidate<dim> &touch, const Vector &coefficients)
  {
    fill(pruned.c.size(), coefficients, pruned_entries);
    pruned.kind.push_back(tfeti::RowKind::normal);
    pruned.c.push_back(touch.point.gap);
    ++constraints.counts.candidates;
  }

  template class RowBuilder<2>;
  template class RowBuilder<3>;
} // namespace slipstick::interface
