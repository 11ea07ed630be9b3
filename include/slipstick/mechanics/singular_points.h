// Where stresses grow without limit under refinement, and where the largest ones are.
#pragma once

#include <slipstick/mechanics/deformation.h>
#include <slipstick/mechanics/stress.h>

#include <string>

namespace slipstick::mechanics
{
  /// A point at which the stress of linear elasticity is infinite.
  template <int dim>
  struct SingularPoint
  {
    unsigned int       body = 0;
    dealii::Point<dim> position;
    std::string        what; // "the point support tip", "a re-entrant corner", "an end of the support wall"
  };

  /// Point supports and point loads; corners of outlines that go in by 35 degrees or more; ends of boundaries along
  /// which supports hold both displacements. Outlines are those of the curves that edges stand for. Known to every
  /// rank. Collective.
  /// @param n_supports of scene.supports count, from the first.
  template <int dim>
  std::vector<SingularPoint<dim>> singular_points(const scene::Scene<dim> &scene,
                                                  const mesh::Mesh<dim>   &mesh,
                                                  const Spaces<dim>       &spaces,
                                                  const unsigned int       n_supports);

  /// Where recovered stresses are largest, and where the error is that was estimated.
  template <int dim>
  struct StressPlaces
  {
    Peak<dim> von_mises; // a node [MPa]
    double    size = 0;  // diameter of the largest cell around it [mm]
    Peak<dim> error;     // the centre of a cell [sqrt(N mm)]
  };

  /// Of equal ones the place with the smallest x, then y, whatever the number of ranks. Collective.
  template <int dim>
  StressPlaces<dim> stress_places(const mesh::Mesh<dim> &mesh, const Spaces<dim> &spaces, const StressResult &stress);
} // namespace slipstick::mechanics
