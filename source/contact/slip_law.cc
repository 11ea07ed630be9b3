#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/contact/slip_law.h>

#include <deal.II/base/mpi.h>

#include <cmath>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    template <int dim>
    double value_at(const scene::Field<dim>   &field,
                    const tfeti::ContactPoint &point,
                    const double               t,
                    const std::string         &pair,
                    const char                *what,
                    const char                *unit)
    {
      dealii::Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = point.position[d];
      const double value = field.value(x, t);
      if (!(value >= 0 && std::isfinite(value)))
        throw InputError(format("Contact %s/%s is %g%s at (%g, %g)", pair.c_str(), what, value, unit, x[0], x[1]),
                         "it must be zero or positive everywhere on the slave boundary");
      return value;
    }
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
          const auto &pair = scene.contacts[point.pair];
          if (pair.law == scene::ContactLaw::tresca)
            {
              fixed[point.tangential_row] =
                value_at(pair.slip_bound, point, t, pair.name, "Slip bound", " MPa") * point.area;
              if (pair.only_closed && point.normal_row != tfeti::invalid_row)
                rows.push_back({point.tangential_row, point.normal_row, 0., false});
            }
          else if (pair.law == scene::ContactLaw::coulomb && point.normal_row != tfeti::invalid_row)
            rows.push_back({point.tangential_row,
                            point.normal_row,
                            value_at(pair.friction_coefficient, point, t, pair.name, "Friction coefficient", ""),
                            true});
        }
    });
    follows_pressure = dealii::Utilities::MPI::max(rows.empty() ? 0 : 1, dual.communicator()) > 0;
  }

  std::vector<double> SlipLaw::bounds(const Vector &x) const
  {
    std::vector<double> result = fixed;
    for (const Row &row : rows)
      {
        const double normal = std::max(x.local_element(row.normal), 0.);
        if (row.is_coulomb)
          result[row.tangential] = row.coefficient * normal;
        else if (!(normal > 0))
          result[row.tangential] = 0;
      }
    return result;
  }

  std::vector<qp::PressureBound> SlipLaw::pressure_bounds() const
  {
    std::vector<qp::PressureBound> result;
    for (const Row &row : rows)
      result.push_back({row.tangential,
                        row.normal,
                        row.is_coulomb ? 0. : fixed[row.tangential],
                        row.is_coulomb ? row.coefficient : 0.});
    return result;
  }

  qp::FrictionCones<Vector> SlipLaw::admissible(const tfeti::DualProblem &dual) const
  {
    qp::FrictionCones<Vector> set{multiplier_box(dual, fixed), {}};
    for (const Row &row : rows)
      if (row.is_coulomb)
        {
          for (const unsigned int r : {row.tangential, row.normal})
            {
              set.box.lower.local_element(r) = -qp::infinity;
              set.box.upper.local_element(r) = qp::infinity;
            }
          set.cones.push_back({row.tangential, row.normal, row.coefficient});
        }
    return set;
  }

  template SlipLaw::SlipLaw(const scene::Scene<2> &, const tfeti::DualProblem &, const double);
} // namespace slipstick::contact
