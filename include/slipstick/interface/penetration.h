// Penetrations after loading, computed from the geometry, at places without a contact row.
#pragma once

#include <slipstick/interface/deepest_penetration.h>
#include <slipstick/mechanics/spaces.h>

#include <Eigen/Dense>

#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace slipstick::interface
{
  struct Penetrations
  {
    /// By contact pair: the deepest slave node without a row because it is farther away than the pair's Reach, along
    /// the normal (linearised like the rows).
    std::vector<std::optional<Penetration>> beyond_reach;

    /// By contact pair with an obstacle: the deepest place on the slave boundary, nodes included. Bonds and pairs with
    /// a Gap of their own are omitted.
    std::vector<std::optional<Penetration>> in_obstacle;

    /// By pair of bodies (the first is inside the second): the deepest node or edge midpoint, minus its depth before
    /// loading. Bodies joined by a bond or by a pair with an Offset or a Gap of its own are omitted.
    std::map<std::pair<unsigned int, unsigned int>, Penetration> of_bodies;

    /// By body: the deepest place where it passes through itself, away from the sides of pairs of its own boundaries.
    std::map<unsigned int, Penetration> in_itself;
  };

  /// @param u displacements of this rank's subdomains [mm], at load factor @p t. The same on all ranks. Collective.
  template <int dim>
  Penetrations penetrations(const scene::Scene<dim>            &scene,
                            const mesh::Mesh<dim>              &mesh,
                            const mechanics::Spaces<dim>       &spaces,
                            const std::vector<Eigen::VectorXd> &u,
                            const double                        t);
} // namespace slipstick::interface
