// Points and edges at which stresses grow without limit under refinement, and places of the largest stresses.
#pragma once

#include <slipstick/mechanics/deformation.h>
#include <slipstick/mechanics/stress.h>

#include <optional>
#include <string>

namespace slipstick::mechanics
{
  /// A point at which the stress of linear elasticity is infinite, or in a solid an edge of the mesh along which it is.
  template <int dim>
  struct SingularPoint
  {
    unsigned int       body = 0;
    dealii::Point<dim> position;
    std::string        what; // "the point support tip", "a re-entrant corner", "an end of the support wall"

    std::optional<unsigned int> support = std::nullopt, load = std::nullopt; // of a point: indices in Scene

    std::optional<dealii::Point<dim>> end = std::nullopt; // of an edge that begins at position

    dealii::Point<dim> middle() const
    {
      return end ? position + (*end - position) / 2 : position;
    }

    /// Distance of the point or edge from @p x [mm].
    double distance(const dealii::Point<dim> &x) const;
  };

  /// Point supports, then point loads, whatever they bear. The same on every rank. Collective.
  /// @param n_supports only the first n_supports of scene.supports are considered.
  template <int dim>
  std::vector<SingularPoint<dim>> force_points(const scene::Scene<dim> &scene,
                                               const mesh::Mesh<dim>   &mesh,
                                               const Spaces<dim>       &spaces,
                                               const unsigned int       n_supports);

  /// Singular points: those of force_points(); re-entrant corners of outlines with a turn of 35 degrees or more;
  /// ends of boundaries along which supports hold both displacements; ends of bonds (bond_ends). In solids the edges
  /// where the same happens in the plane across them. Outlines and surfaces are the true ones. The same on every rank.
  /// Collective.
  /// @param n_supports only the first n_supports of scene.supports are considered.
  template <int dim>
  std::vector<SingularPoint<dim>> singular_points(const scene::Scene<dim> &scene,
                                                  const mesh::Mesh<dim>   &mesh,
                                                  const Spaces<dim>       &spaces,
                                                  const unsigned int       n_supports);

  /// Places of the largest recovered stress and of the largest estimated error.
  template <int dim>
  struct StressPlaces
  {
    Peak<dim> von_mises; // a node [MPa]
    double    size = 0;  // diameter of the largest cell around it [mm]
    Peak<dim> error;     // the centre of a cell [sqrt(N mm)]
  };

  /// A singular point, and the radius within which stresses are attributed to it [mm].
  template <int dim>
  struct Surroundings
  {
    SingularPoint<dim> of;
    double             radius = 0;
  };

  /// The places of the largest stress and error; of equal values that with the smallest x, then y, independent of the
  /// number of ranks. Collective.
  /// @param left_out nodes there are not examined for the largest stress.
  template <int dim>
  StressPlaces<dim> stress_places(const mesh::Mesh<dim>                &mesh,
                                  const Spaces<dim>                    &spaces,
                                  const StressResult                   &stress,
                                  const std::vector<Surroundings<dim>> &left_out = {});

  /// The cell at a place: the one whose centre is nearest to it.
  struct CellAtPlace
  {
    double size      = 0; // mean length of its edges [mm]
    double von_mises = 0; // largest at its nodes [MPa]
  };

  /// For each of @p places the cell of its body there. The same on every rank. Collective.
  template <int dim>
  std::vector<CellAtPlace> cells_at(const mesh::Mesh<dim>                &mesh,
                                    const Spaces<dim>                    &spaces,
                                    const StressResult                   &stress,
                                    const std::vector<Surroundings<dim>> &places);
} // namespace slipstick::mechanics
