// Nodes at which two pairs meet: their rows are those of one pair, their forces belong to both.
#pragma once

#include <slipstick/interface/touches.h>

#include <functional>

namespace slipstick::interface
{
  /// The force of a bond is also that of bonds that it implies, and of contacts with the same nodes: its tractions are
  /// relative to the areas of all of them that face the same way. Those with the same nodes become shared points, with
  /// parts of the force in proportion to their areas, as far as the laws of contacts admit these; contacts among them are
  /// marked as implied.
  /// @param is_kept whether a bond has a normal row. @param touching all candidates of the node of @p kept, which becomes
  /// the next of the bonded points.
  /// @throws InputError (on the calling rank) for a negative number of a law.
  template <int dim>
  void share_bond(const scene::Scene<dim>                                  &scene,
                  const dealii::Point<dim>                                 &x,
                  const double                                              t,
                  const std::function<bool(const ContactCandidate<dim> &)> &is_kept,
                  std::vector<ContactCandidate<dim>>                       &touching,
                  ContactCandidate<dim>                                    &kept,
                  tfeti::Constraints                                       &constraints);

  /// Where contact pairs meet, the normal force is divided by their areas and the tangential force by their bounds at
  /// equal pressures. @param touch becomes the next of the contact points; without effect if it has no parts.
  /// @throws InputError (on the calling rank) for a negative number of a law.
  template <int dim>
  void share_contact(const scene::Scene<dim>  &scene,
                     const dealii::Point<dim> &x,
                     const double              t,
                     ContactCandidate<dim>    &touch,
                     tfeti::Constraints       &constraints);
} // namespace slipstick::interface
