// Contact nodes whose gap supports prescribe.
#pragma once

#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/constraints.h>

#include <mpi.h>

namespace slipstick::interface
{
  /// By how much the prescribed gap of a node may differ from 0 and still counts as touching [mm].
  double held_contact_tolerance(const tfeti::HeldContacts::Point &point);

  /// @throws NoEquilibrium on all ranks when supports alone prescribe a penetration: names both at the deepest place.
  /// Collective.
  template <int dim>
  void refuse_held_penetration(const scene::Scene<dim> &scene, const tfeti::HeldContacts &held, const MPI_Comm comm);

  /// The same of penetrations that bonds and supports prescribe together, which the displacement shows.
  /// @param gaps of the points after loading [mm], @param noise what the solver leaves in them [mm].
  template <int dim>
  void refuse_held_penetration(const scene::Scene<dim>   &scene,
                               const tfeti::HeldContacts &held,
                               const std::vector<double> &gaps,
                               const double               noise,
                               const MPI_Comm             comm);
} // namespace slipstick::interface
