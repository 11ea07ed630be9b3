#include <slipstick/app/geometry_checks.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/interface/pair_checks.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace slipstick::app
{
  namespace
  {
    // Nodes out of reach must not penetrate by more than this fraction of the largest displacement, which is far above
    // the solver's error.
    constexpr double allowed_beyond_reach = 1e-3;
    // Limit for obstacles between nodes and for bodies in contact with each other, relative to the smaller of largest
    // displacement and edge length: on coarse meshes curved sides and slip cause penetrations of about this size.
    constexpr double allowed_between_nodes = 0.1;
    // The same for bodies without a contact pair, relative to the largest displacement.
    constexpr double allowed_without_contact = 1e-3;
    // Lower bound of all these limits, relative to an edge length: rounding of coordinates.
    constexpr double coordinate_rounding = 1e-9;
    // Margin of the proposed Reach.
    constexpr double reserve = 1.1;

    template <int dim>
    std::string place(const interface::Penetration &deepest)
    {
      return point_text(deepest.at, dim);
    }
  } // namespace

  template <int dim>
  GeometryFindings geometry_findings(const scene::Scene<dim>       &scene,
                                     const interface::Penetrations &found,
                                     const double                   largest)
  {
    GeometryFindings                                findings;
    std::set<std::pair<unsigned int, unsigned int>> joined;
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      {
        const auto &pair = scene.contacts[k];
        if (pair.master)
          joined.insert(std::minmax(pair.slave.body, pair.master->body));
        const std::string parameter =
          pair.master ? interface::reach_of(scene, pair) : "Contact " + pair.name + "/Reach";
        if (const auto &deepest = found.beyond_reach[k];
            deepest && deepest->depth > std::max(allowed_beyond_reach * largest, coordinate_rounding * deepest->edge) &&
            !findings.failure)
          findings.failure =
            format("Contact %s: at %s a slave node that was left out because it is farther away than the Reach of "
                   "%g mm penetrates by %.3g mm; the results are not a solution\n"
                   "  remedy: set %s to %g mm or more%s",
                   pair.name.c_str(),
                   place<dim>(*deepest).c_str(),
                   *pair.reach,
                   deepest->depth,
                   parameter.c_str(),
                   rounded_up(reserve * deepest->gap),
                   parameter == "Contact search/Reach" ? "" : ", or to auto");
        if (const auto &deepest = found.in_obstacle[k];
            deepest && deepest->depth > std::max(allowed_between_nodes * std::min(largest, deepest->edge),
                                                 coordinate_rounding * deepest->edge))
          findings.warnings["edge " + pair.name] =
            format("Contact %s: obstacle %s is %.3g mm inside body %s at %s, on %s of %.3g mm: contact acts at nodes, "
                   "and the obstacle enters between them; refine %s there (%sRefinements) until edges are "
                   "smaller than what touches them",
                   pair.name.c_str(),
                   scene.obstacles[pair.obstacle].name.c_str(),
                   deepest->depth,
                   scene.bodies[pair.slave.body].name.c_str(),
                   place<dim>(*deepest).c_str(),
                   dim == 2 ? "an edge" : "a face",
                   deepest->edge,
                   scene.bodies[pair.slave.body].name.c_str(),
                   dim == 2 ? "Refine towards, " : "");
      }
    for (const auto &[bodies, deepest] : found.of_bodies)
      {
        const bool   has_contact = joined.count(std::minmax(bodies.first, bodies.second)) > 0;
        const double allowed =
          has_contact ? allowed_between_nodes * std::min(largest, deepest.edge) : allowed_without_contact * largest;
        const auto &a = scene.bodies[bodies.first].name, &b = scene.bodies[bodies.second].name;
        if (deepest.depth > std::max(allowed, coordinate_rounding * deepest.edge))
          findings.warnings["inside " + std::min(a, b) + " " + std::max(a, b)] =
            format("body %s is %.3g mm inside body %s after loading, at %s: %s",
                   a.c_str(),
                   deepest.depth,
                   b.c_str(),
                   place<dim>(deepest).c_str(),
                   has_contact ? "their contact pairs do not cover this place; extend the boundaries of the pairs to "
                                 "it, or refine them"
                               : "no contact pair joins the two; declare one (Contacts), or move them apart");
      }
    for (const auto &[body, deepest] : found.in_itself)
      if (deepest.depth > std::max(allowed_without_contact * largest, coordinate_rounding * deepest.edge))
        findings.warnings["through itself " + scene.bodies[body].name] =
          format("body %s passes through itself by %.3g mm after loading, at %s: declare a contact pair (Contacts) "
                 "between the boundaries that meet there",
                 scene.bodies[body].name.c_str(),
                 deepest.depth,
                 place<dim>(deepest).c_str());
    return findings;
  }

  template GeometryFindings geometry_findings(const scene::Scene<2> &, const interface::Penetrations &, const double);
  template GeometryFindings geometry_findings(const scene::Scene<3> &, const interface::Penetrations &, const double);
} // namespace slipstick::app
