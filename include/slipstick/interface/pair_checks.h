// Checks of contact pairs: sides that face away from each other or are out of reach.
#pragma once

#include <slipstick/interface/mortar.h>

#include <algorithm>
#include <string>

namespace slipstick::interface
{
  /// The two sides of a contact pair of bodies, and the whole outlines of these bodies.
  template <int dim>
  struct PairSides
  {
    std::vector<mechanics::BoundaryPart<dim>> slave, master;
    std::vector<mechanics::BoundaryPart<dim>> slave_outline, master_outline;
  };

  /// Diagonal of the bounding box of the nodes of some edges or facets [mm].
  template <class Part>
  double extent(const std::vector<Part> &parts)
  {
    auto low = parts[0].node(0), high = low;
    for (const auto &part : parts)
      for (unsigned int i = 0; i < part.n_nodes; ++i)
        for (unsigned int d = 0; d < low.dimension; ++d)
          {
            low[d]  = std::min(low[d], part.at[i][d]);
            high[d] = std::max(high[d], part.at[i][d]);
          }
    return low.distance(high);
  }

  /// "BODY/BOUNDARY"
  template <int dim>
  std::string describe(const scene::Scene<dim> &scene, const scene::BoundaryName &where);

  /// The parameter with the reach of a pair of bodies, which may have been found by the contact search.
  template <int dim>
  std::string reach_of(const scene::Scene<dim> &scene, const scene::ContactPair<dim> &pair)
  {
    const auto name_of  = [&scene](const unsigned int body) { return scene.bodies[body].name; };
    const auto [a, b]   = std::minmax(pair.slave.body, pair.master->body);
    const bool is_found = scene.contact_search.automatic && pair.name == name_of(a) + "-" + name_of(b);
    return (is_found ? "Contact search" : "Contact " + pair.name) + "/Reach";
  }

  /// Whether every row has its master on the far side of the slave's body: deeper than a tenth of a mean slave edge
  /// although no point of one side is inside the other body (which would be an overlap). False if there are no rows.
  template <int dim>
  bool lies_behind(const PairSides<dim> &sides, const std::vector<MortarRow<dim>> &rows);

  /// Reports why there is no row within @p reach [mm].
  /// @throws InputError always: the sides face away from each other, have no opposed normals, or are too far apart.
  template <int dim>
  [[noreturn]] void refuse_pair(const scene::Scene<dim>       &scene,
                                const scene::ContactPair<dim> &pair,
                                const PairSides<dim>          &sides,
                                const double                   reach);

  /// Checks the rows of a pair of bodies. With an automatic reach the gap of the nearest row, offset included, must be
  /// at most the size of the larger side plus the largest prescribed displacement of the scene in at least one load
  /// step; a pair with a Reach or a Gap of its own may start at any distance within these. The same on all ranks.
  /// @throws InputError for sides that face away from each other (lies_behind) or are out of reach.
  template <int dim>
  void check_sides(const scene::Scene<dim>                         &scene,
                   const mesh::Mesh<dim>                           &mesh,
                   const scene::ContactPair<dim>                   &pair,
                   const PairSides<dim>                            &sides,
                   const std::vector<mechanics::BoundaryPart<dim>> &all,
                   const std::vector<MortarRow<dim>>               &rows);

  /// Checks the pairs with obstacles: some node must have an outward normal opposed to the obstacle (facing_cosine) and
  /// a gap within the Reach; with an automatic reach the rule is that of check_sides with the size of the slave
  /// boundary (and the diameter of a circle if that is larger). Bonds to obstacles act as supports and are not checked.
  /// Collective.
  /// @throws InputError on all ranks.
  template <int dim>
  void check_obstacle_pairs(const scene::Scene<dim>      &scene,
                            const mesh::Mesh<dim>        &mesh,
                            const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::interface
