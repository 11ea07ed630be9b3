// Contact nodes whose gap supports prescribe.
#pragma once

#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/constraints.h>

#include <mpi.h>

namespace slipstick::interface
{
  /// Tolerance within which a prescribed gap counts as closed [mm].
  double held_contact_tolerance(const tfeti::HeldContacts::Point &point);

  /// @throws NoEquilibrium on all ranks when supports alone prescribe a penetration; the message names support and pair
  /// at the deepest place.
  /// Collective.
  template <int dim>
  void refuse_held_penetration(const scene::Scene<dim> &scene, const tfeti::HeldContacts &held, const MPI_Comm comm);

  /// The same for penetrations prescribed by bonds and supports together, which only the displacement shows.
  /// @param gaps of the points after loading [mm]. @param noise error of the solver in these gaps [mm].
  template <int dim>
  void refuse_held_penetration(const scene::Scene<dim>   &scene,
                               const tfeti::HeldContacts &held,
                               const std::vector<double> &gaps,
                               const double               noise,
                               const MPI_Comm             comm);
} // namespace slipstick::interface
