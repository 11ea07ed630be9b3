#include <slipstick/base/collective.h>
#include <slipstick/contact/slip_law.h>

#include <deal.II/base/mpi.h>

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
            case tfeti::RowKind::tangential:
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

  SlipLaw::SlipLaw(std::vector<double> fixed_bounds)
    : fixed(std::move(fixed_bounds))
  {}

  template <int dim>
  SlipLaw::SlipLaw(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t)
    : fixed(dual.constraints().kind.size(), 0.)
  {
    collectively(dual.communicator(), [&] {
      for (const auto &point : dual.constraints().contact_points)
        {
          if (point.tangential_row == tfeti::invalid_row)
            continue;
          dealii::Point<dim> x;
          for (unsigned int d = 0; d < dim; ++d)
            x[d] = point.position[d];
          const auto &pair   = scene.contacts[point.pair];
          const auto  forces = pair.law.admissible_forces(x, t, point.area, pair.name);
          if (pair.law.acts_when_open || point.normal_row == tfeti::invalid_row) // supports take the normal force
            fixed[point.tangential_row] = forces.closed_radius(0);
          else
            rows.push_back({point.tangential_row, point.normal_row, forces});
        }
    });
    follows_pressure = dealii::Utilities::MPI::max(rows.empty() ? 0 : 1, dual.communicator()) > 0;
  }

  std::vector<double> SlipLaw::bounds(const Vector &x) const
  {
    std::vector<double> result = fixed;
    for (const auto &row : rows)
      result[row.tangential] = row.forces.radius(x.local_element(row.normal));
    return result;
  }

  qp::ForceSet<Vector> SlipLaw::admissible(const tfeti::DualProblem &dual) const
  {
    qp::ForceSet<Vector> set{multiplier_box(dual, fixed), {}};
    for (const auto &row : rows)
      {
        const bool   is_box                         = row.forces.coefficient == 0; // the closure of the set
        const double bound                          = is_box ? row.forces.closed_radius(0) : qp::infinity;
        set.box.lower.local_element(row.tangential) = -bound;
        set.box.upper.local_element(row.tangential) = bound;
        if (is_box)
          continue;
        set.box.lower.local_element(row.normal) = -qp::infinity;
        set.nodes.push_back(row);
      }
    return set;
  }

  template SlipLaw::SlipLaw(const scene::Scene<2> &, const tfeti::DualProblem &, const double);
} // namespace slipstick::contact
