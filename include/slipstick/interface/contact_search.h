// Automatic detection of bodies in contact.
#pragma once

#include <slipstick/mechanics/spaces.h>

namespace slipstick::interface
{
  /// The pairs found by `Contact search`: bodies whose outlines face each other closer than its Reach (a millionth of a
  /// cell if that is 0) and that no pair of the scene joins. The slave is the body with the finer edges there, or the
  /// first one in the scene if they are equal; the name is "a-b"; law, reach and the other properties are those of the
  /// section, so that only edges within that reach take part. Empty if the search is not automatic. The same on all
  /// ranks.
  /// Collective.
  template <int dim>
  std::vector<scene::ContactPair<dim>> find_contacts(const scene::Scene<dim>      &scene,
                                                     const mesh::Mesh<dim>        &mesh,
                                                     const mechanics::Spaces<dim> &spaces);

  /// Checks for overlaps. @throws InputError on all ranks when a vertex on the outline of a body lies inside another
  /// body by more than a tenth of the other's edge there, unless a contact pair joins the two. Collective.
  template <int dim>
  void check_overlap(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh, const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::interface
