#include <slipstick/contact/given_bounds.h>
#include <slipstick/qp/feasible_point.h>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    /// Removes the bounds of the individual entries of a disc.
    void unbind(const qp::PressureBound &disc, Box &box)
    {
      for (const auto entry : {disc.tangential, disc.second})
        {
          box.lower.local_element(entry) = -qp::infinity;
          box.upper.local_element(entry) = qp::infinity;
        }
    }
  } // namespace

  Box shifted(Box box, const Vector &center)
  {
    box.lower -= center;
    box.upper -= center;
    return box;
  }

  qp::DiscBox<Vector> shifted_discs(const SlipLaw             &law,
                                    const std::vector<double> &slip_bound,
                                    const Box                 &box,
                                    const Vector              &center)
  {
    qp::DiscBox<Vector> result{shifted(box, center), {}};
    for (const auto &disc : law.fixed_discs(slip_bound, true))
      if (const double radius = disc.forces.closed_radius(0); radius > 0)
        {
          unbind(disc, result.box);
          result.discs.push_back({disc.tangential,
                                  disc.second,
                                  radius,
                                  {{-center.local_element(disc.tangential), -center.local_element(disc.second)}}});
        }
    return result;
  }

  std::optional<Vector> nearest_feasible(const tfeti::DualProblem  &dual,
                                         const SlipLaw             &law,
                                         const std::vector<double> &slip_bound,
                                         const Vector              &x)
  {
    Box box = multiplier_box(dual, slip_bound);
    if (law.has_discs())
      {
        qp::ForceSet<Vector> set{std::move(box), law.fixed_discs(slip_bound, true)};
        for (const auto &disc : set.nodes)
          unbind(disc, set.box);
        auto point = qp::feasible_point(dual, dual.particular(), set);
        return point.status == qp::Status::infeasible ? std::nullopt : std::optional<Vector>(std::move(point.x));
      }
    Vector missing = dual.particular();
    missing -= x;
    auto point = qp::feasible_point(dual, missing, shifted(std::move(box), x));
    if (point.status == qp::Status::infeasible)
      return {};
    point.x += x;
    return std::move(point.x);
  }

  Vector unshifted(const Box &box, const Box &shifted, const Vector &center, const Vector &step)
  {
    Vector x = center;
    x += step;
    for (unsigned int r = 0; r < x.locally_owned_size(); ++r)
      if (step.local_element(r) <= shifted.lower.local_element(r))
        x.local_element(r) = box.lower.local_element(r);
      else if (step.local_element(r) >= shifted.upper.local_element(r))
        x.local_element(r) = box.upper.local_element(r);
    return x;
  }
} // namespace slipstick::contact
