#include <slipstick/base/collective.h>
#include <slipstick/contact/slip_law.h>
#include <slipstick/qp/types.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <map>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;
  } // namespace

  Box multiplier_box(const tfeti::DualProblem &dual, const std::vector<double> &slip_bound)
  {
    Box box{dual.zero(), dual.zero()};
    for (unsigned int r = 0; r < dual.constraints().kind.size(); ++r)
      {
        double &lower = box.lower.local_element(r), &upper = box.upper.local_element(r);
        switch (dual.constraints().kind[r])
          {
            case tfeti::RowKind::tangential: // in space: the square around the disc
              lower = -slip_bound[r];
              upper = slip_bound[r];
              break;
            case tfeti::RowKind::normal:
              lower = 0;
              upper = qp::infinity;
              break;
            case tfeti::RowKind::gluing:
            case tfeti::RowKind::bonded:
            case tfeti::RowKind::prescribed:
              lower = -qp::infinity;
              upper = qp::infinity;
              break;
          }
      }
    return box;
  }

  namespace
  {
    /// The law of a node that one or several pairs share, with the pressure that is the same for all of them.
    /// @param acts_when_open becomes whether all laws with friction do.
    template <int dim>
    qp::NodeSet sum_of_laws(const scene::Scene<dim>                        &scene,
                            const std::vector<const tfeti::ContactPoint *> &parts,
                            const double                                    t,
                            bool                                           &acts_when_open)
    {
      dealii::Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = parts[0]->position[d];
      qp::NodeSet sum{0, 0, 0};
      for (const auto *part : parts)
        {
          const auto &pair = scene.contacts[part->pair];
          if (!pair.law.has_friction)
            continue;
          const auto forces = pair.law.admissible_forces(x, t, part->area, pair.name);
          sum.fixed += forces.fixed;
          sum.coefficient += part->share * forces.coefficient;
          sum.cap += forces.cap;
          acts_when_open = acts_when_open && pair.law.acts_when_open;
        }
      return sum;
    }
  } // namespace

  SlipLaw::SlipLaw(std::vector<double> fixed_bounds)
    : fixed(std::move(fixed_bounds))
  {}

  template <int dim>
  SlipLaw::SlipLaw(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t)
    : fixed(dual.constraints().kind.size(), 0.)
  {
    std::map<unsigned int, std::vector<const tfeti::ContactPoint *>> shared; // by carrier
    for (const auto &part : dual.constraints().shared_points)
      if (!part.is_bonded)
        shared[part.carrier].push_back(&part.point);
    collectively(dual.communicator(), [&] {
      const auto &points = dual.constraints().contact_points;
      for (unsigned int i = 0; i < points.size(); ++i)
        {
          const auto &point = points[i];
          if (point.tangential_row == tfeti::invalid_row)
            continue;
          std::vector<const tfeti::ContactPoint *> parts{&point};
          if (const auto found = shared.find(i); found != shared.end())
            parts.insert(parts.end(), found->second.begin(), found->second.end());
          bool       acts_when_open = true;
          const auto forces         = sum_of_laws(scene, parts, t, acts_when_open);
          if (acts_when_open || point.normal_row == tfeti::invalid_row) // a support takes the normal force
            {
              fixed[point.tangential_row] = forces.closed_radius(0);
              if (point.second_row == tfeti::invalid_row)
                continue;
              fixed[point.second_row] = fixed[point.tangential_row];
              discs.push_back({point.tangential_row, qp::no_entry, {fixed[point.tangential_row], 0}, point.second_row});
            }
          else
            rows.push_back({point.tangential_row,
                            point.normal_row,
                            forces,
                            point.second_row == tfeti::invalid_row ? qp::no_entry : point.second_row});
        }
    });
    follows_pressure   = dealii::Utilities::MPI::max(rows.empty() ? 0 : 1, dual.communicator()) > 0;
    const bool has_own = !discs.empty() || std::any_of(rows.begin(), rows.end(), [](const auto &row) {
      return row.is_disc(); // the others are intervals: supports hold one tangent
    });
    is_in_space        = dealii::Utilities::MPI::max(has_own ? 1 : 0, dual.communicator()) > 0;
  }

  SlipLaw SlipLaw::scaled(const double factor) const
  {
    SlipLaw result = *this;
    for (double &bound : result.fixed)
      bound *= factor;
    for (auto *nodes : {&result.rows, &result.discs})
      for (auto &node : *nodes)
        node.forces = {factor * node.forces.fixed, factor * node.forces.coefficient, factor * node.forces.cap};
    return result;
  }

  std::vector<double> SlipLaw::bounds(const Vector &x) const
  {
    std::vector<double> result = fixed;
    const double        least  = follows_pressure ? qp::force_rounding * x.linfty_norm() : 0.; // rounding
    for (const auto &row : rows)
      {
        const double pressed   = x.local_element(row.normal);
        result[row.tangential] = pressed > least ? row.forces.radius(pressed) : 0.;
        if (row.is_disc())
          result[row.second] = result[row.tangential];
      }
    return result;
  }

  std::vector<SlippingNode> SlipLaw::slipping_nodes(const Vector &x, const std::vector<bool> &free) const
  {
    std::vector<SlippingNode> result;
    for (const auto &node : rows)
      {
        const double first  = x.local_element(node.tangential),
                     second = node.is_disc() ? x.local_element(node.second) : 0.;
        const double bound = node.forces.radius(x.local_element(node.normal)), slope = node.forces.slope(bound);
        const bool   sticks = free[node.tangential] || (node.is_disc() && free[node.second]);
        if (!sticks && free[node.normal] && bound > 0 && slope > 0 && (first != 0 || second != 0))
          result.push_back({node, bound, slope});
      }
    return result;
  }

  std::vector<qp::PressureBound> SlipLaw::fixed_discs(const std::vector<double> &bounds, const bool all) const
  {
    std::vector<qp::PressureBound> result = discs;
    for (const auto &row : rows)
      if (all && row.is_disc())
        result.push_back({row.tangential, qp::no_entry, {bounds[row.tangential], 0}, row.second});
    return result;
  }

  qp::ForceSet<Vector> SlipLaw::admissible(const tfeti::DualProblem &dual) const
  {
    qp::ForceSet<Vector> set{multiplier_box(dual, fixed), {}};
    for (const auto &row : rows)
      {
        if (row.is_disc())
          continue;
        const bool   is_box                         = row.forces.coefficient == 0; // the closure of the set
        const double bound                          = is_box ? row.forces.closed_radius(0) : qp::infinity;
        set.box.lower.local_element(row.tangential) = -bound;
        set.box.upper.local_element(row.tangential) = bound;
        if (is_box)
          continue;
        set.box.lower.local_element(row.normal) = -qp::infinity;
        set.nodes.push_back(row);
      }
    const auto add_disc = [&set](const qp::PressureBound &disc) {
      for (const auto entry : {disc.tangential, disc.second})
        {
          set.box.lower.local_element(entry) = -qp::infinity;
          set.box.upper.local_element(entry) = qp::infinity;
        }
      if (disc.normal != qp::no_entry)
        set.box.lower.local_element(disc.normal) = -qp::infinity;
      set.nodes.push_back(disc);
    };
    for (const auto &disc : discs)
      add_disc(disc);
    for (const auto &row : rows)
      if (row.is_disc())
        add_disc(row);
    return set;
  }

  template SlipLaw::SlipLaw(const scene::Scene<2> &, const tfeti::DualProblem &, const double);
  template SlipLaw::SlipLaw(const scene::Scene<3> &, const tfeti::DualProblem &, const double);
} // namespace slipstick::contact
