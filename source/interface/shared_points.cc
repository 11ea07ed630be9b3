#include <slipstick/interface/shared_points.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipstick::interface
{
  namespace
  {
    /// The part of @p carrier that belongs to the pair of @p part.
    template <int dim>
    tfeti::SharedPoint shared_point(const tfeti::ContactPoint   &carrier,
                                    const std::size_t            index,
                                    const bool                   is_bonded,
                                    const ContactCandidate<dim> &part,
                                    const double                 share,
                                    const double                 tangential_share)
    {
      tfeti::SharedPoint shared{carrier, static_cast<unsigned int>(index), is_bonded, {}};
      shared.point.pair             = part.pair;
      shared.point.area             = part.point.area;
      shared.point.length           = part.point.length;
      shared.point.share            = share;
      shared.point.tangential_share = tangential_share;
      return shared;
    }
  } // namespace

  template <int dim>
  void share_bond(const scene::Scene<dim>                                  &scene,
                  const dealii::Point<dim>                                 &x,
                  const double                                              t,
                  const std::function<bool(const ContactCandidate<dim> &)> &is_kept,
                  std::vector<ContactCandidate<dim>>                       &touching,
                  ContactCandidate<dim>                                    &kept,
                  tfeti::Constraints                                       &constraints)
  {
    auto                                      &point = kept.point;
    double                                     area = point.area, length = point.length;
    std::vector<const ContactCandidate<dim> *> sharing;
    for (ContactCandidate<dim> &other : touching)
      {
        const bool is_bonded = scene.contacts[other.pair].law.is_bonded, is_same = have_same_nodes(other, kept);
        if (is_bonded ? is_kept(other) || other.normal * kept.normal <= same_way : !is_same)
          continue;
        other.is_implied = !is_bonded;
        std::vector<const ContactCandidate<dim> *> parts;
        for (const ContactCandidate<dim> &part : other.parts)
          parts.push_back(&part);
        if (parts.empty())
          parts.push_back(&other);
        for (const ContactCandidate<dim> *part : parts)
          {
            area += part->point.area;
            length += part->point.length;
            if (is_same)
              sharing.push_back(part);
          }
      }
    point.traction_area   = std::max(point.traction_area, area);
    point.traction_length = std::max(point.traction_length, length);
    const auto index      = constraints.bonded_points.size();
    for (const ContactCandidate<dim> *part : sharing)
      {
        const double share = part->point.area / area;
        const auto  &pair  = scene.contacts[part->pair];
        point.share -= share;
        auto shared = shared_point(point, index, true, *part, share, share);
        if (pair.law.has_friction)
          shared.law = pair.law.admissible_forces(x, t, part->point.area, pair.name);
        else if (!pair.law.is_bonded)
          shared.law = qp::NodeSet{0, 0, 0};
        constraints.shared_points.push_back(std::move(shared));
      }
    point.tangential_share = point.share;
  }

  template <int dim>
  void share_contact(const scene::Scene<dim>  &scene,
                     const dealii::Point<dim> &x,
                     const double              t,
                     ContactCandidate<dim>    &touch,
                     tfeti::Constraints       &constraints)
  {
    constexpr double    pressure = 1; // [MPa]; matters only where the bounds of two laws are not in proportion to it
    std::vector<double> bounds;
    for (const auto &part : touch.parts)
      {
        const auto  &pair = scene.contacts[part.pair];
        const double area = part.point.area;
        bounds.push_back(pair.law.has_friction
                           ? pair.law.admissible_forces(x, t, area, pair.name).closed_radius(pressure * area)
                           : 0.);
      }
    const double all = std::accumulate(bounds.begin(), bounds.end(), 0.), area = touch.point.traction_area;
    for (unsigned int k = 0; k < touch.parts.size(); ++k)
      {
        const double by_area   = area > 0 ? touch.parts[k].point.traction_area / area : 1. / touch.parts.size();
        const double by_bounds = all > 0 && std::isfinite(all) ? bounds[k] / all : by_area;
        if (k > 0)
          constraints.shared_points.push_back(
            shared_point(touch.point, constraints.contact_points.size(), false, touch.parts[k], by_area, by_bounds));
        else
          {
            touch.point.share            = by_area;
            touch.point.tangential_share = by_bounds;
          }
      }
  }

  template void share_bond(const scene::Scene<2> &,
                           const dealii::Point<2> &,
                           const double,
                           const std::function<bool(const ContactCandidate<2> &)> &,
                           std::vector<ContactCandidate<2>> &,
                           ContactCandidate<2> &,
                           tfeti::Constraints &);
  template void share_bond(const scene::Scene<3> &,
                           const dealii::Point<3> &,
                           const double,
                           const std::function<bool(const ContactCandidate<3> &)> &,
                           std::vector<ContactCandidate<3>> &,
                           ContactCandidate<3> &,
                           tfeti::Constraints &);
  template void share_contact(const scene::Scene<2> &,
                              const dealii::Point<2> &,
                              const double,
                              ContactCandidate<2> &,
                              tfeti::Constraints &);
  template void share_contact(const scene::Scene<3> &,
                              const dealii::Point<3> &,
                              const double,
                              ContactCandidate<3> &,
                              tfeti::Constraints &);
} // namespace slipstick::interface
