#include <slipstick/app/stress_functionals.h>
#include <slipstick/base/text.h>
#include <slipstick/mechanics/rigid_modes.h>
#include <slipstick/mechanics/stress_point.h>
#include <slipstick/scene/adaptivity.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace slipstick::app
{
  namespace
  {
    // Stresses closer to a singular point than this fraction of the body's half diagonal depend on the mesh.
    constexpr double near_singular_point = 0.1;

    // A singular point is not resolved if its cell is larger than the region left out around the point. If the stress
    // of that cell exceeds this fraction of the largest stress elsewhere, refinement may move the largest stress to
    // that point.
    constexpr double may_become_largest = 0.5;

    // A probe is at a singular point if it is closer than this fraction of the radius left out around the point.
    constexpr double at_singular_point = 1e-6;

    /// A point with its stresses, of which several quantities are weighted sums.
    template <int dim>
    struct StressesAt
    {
      mechanics::StressPoint<dim>           point;
      mechanics::Stress<dim>                recovered;
      std::optional<mechanics::Stress<dim>> fitted;
    };

    template <int dim>
    class StressFunctionals
    {
    public:
      StressFunctionals(const StepSolver<dim> &solver_, const StepSolution &answer_, const double t_)
        : solver(solver_)
        , u(solver.elastic_part(answer_.recovery.u))
        , stress(*answer_.stress)
        , t(t_)
      {}

      /// Adds the largest von Mises stress over all nodes; and the largest over the nodes away from singular points, if
      /// the first one is near a singular point or not resolved, or if @p is_named.
      void add_largest(const std::vector<mechanics::Surroundings<dim>> &around,
                       const bool                                       is_named,
                       std::vector<Functional>                         &list) const
      {
        const auto all = mechanics::stress_places(solver.mesh(), solver.spaces(), stress).von_mises;
        list.push_back(von_mises("max_von_mises", at(all.body, all.position)));
        const auto near =
          std::find_if(around.begin(), around.end(), [&](const mechanics::Surroundings<dim> &surroundings) {
            return surroundings.of.body == all.body && surroundings.of.distance(all.position) <= surroundings.radius;
          });
        if (near != around.end())
          list.back().reason = "not resolved, or without limit, at " + near->of.what;
        list.back().is_singular = near != around.end();
        const auto cells        = mechanics::cells_at(solver.mesh(), solver.spaces(), stress, around);
        if (!note_unresolved(around, cells, list.back()) && near == around.end() && !is_named)
          return;
        const auto regular = mechanics::stress_places(solver.mesh(), solver.spaces(), stress, around).von_mises;
        if (regular.value > 0)
          {
            const auto stresses = at(regular.body, regular.position);
            list.push_back(von_mises("max_regular_von_mises", stresses));
            list.back().local_error += increase_towards(regular, stresses.point, around);
            note_unresolved(around, cells, list.back());
          }
        else
          list.push_back(
            {"max_regular_von_mises", "MPa", 0, {}, {}, "all nodes with stress are near singular points", false});
        list.back().note = description_of(around);
      }

      /// Components and von Mises stress at the point of a probe.
      void add_probe(const std::string                               &name,
                     const unsigned int                               body,
                     const dealii::Point<dim>                        &x,
                     const std::vector<mechanics::Surroundings<dim>> &around,
                     std::vector<Functional>                         &list) const
      {
        const auto        stresses = at(body, x);
        const std::size_t first    = list.size();
        for (unsigned int c = 0; c < 2 * dim; ++c)
          {
            mechanics::Stress<dim> weights = mechanics::Stress<dim>::Zero();
            weights[c]                     = 1;
            list.push_back(combination(name + ".stress_" + scene::stress_components[c], stresses, weights));
            if (stresses.fitted) // the two stresses may agree in one component by accident
              list.back().local_error = (*stresses.fitted - stresses.recovered).abs().maxCoeff();
          }
        list.push_back(von_mises(name + ".von_mises", stresses));
        for (const auto &[singular, radius] : around)
          if (singular.body == body && singular.distance(x) <= at_singular_point * radius)
            for (std::size_t k = first; k < list.size(); ++k)
              list[k].reason = "not resolved, or without limit, at " + singular.what;
      }

      /// Surroundings of these points, of corners and of ends of supports.
      std::vector<mechanics::Surroundings<dim>> surroundings(
        const std::vector<mechanics::SingularPoint<dim>> &acting) const
      {
        const auto frames = mechanics::body_frames(solver.discrete_scene(), solver.mesh());
        std::vector<mechanics::Surroundings<dim>> result;
        const auto                                add = [&](const mechanics::SingularPoint<dim> &point) {
          result.push_back({point, near_singular_point * frames[point.body].length});
        };
        for (const auto &point : acting)
          add(point);
        for (const auto &point : mechanics::singular_points(solver.discrete_scene(),
                                                            solver.mesh(),
                                                            solver.spaces(),
                                                            solver.n_given_supports()))
          if (!point.support && !point.load)
            add(point);
        return result;
      }

    private:
      /// Difference between the largest stress on the way from a node to the surroundings that are left out, and the
      /// stress of the node.
      double increase_towards(const mechanics::Peak<dim>                      &node,
                              const mechanics::StressPoint<dim>               &at_node,
                              const std::vector<mechanics::Surroundings<dim>> &around) const
      {
        double increase = 0;
        for (const auto &[place, s] : at_node.nodes_around(stress))
          for (const auto &[point, radius] : around)
            if (const double within = point.distance(place); point.body == node.body && within < radius)
              {
                const double beyond = point.distance(node.position);
                increase =
                  std::max(increase,
                           (mechanics::von_mises<dim>(s) - node.value) * (beyond - radius) / (beyond - within));
              }
        return dealii::Utilities::MPI::max(increase, solver.mesh().comm);
      }

      /// Sets the reason why @p largest has no error bar, if on a finer mesh the largest stress may be at one of the
      /// places @p around, whose cells are still larger than the region left out.
      /// @param cells cells at the places @p around. @return whether this reason has been set.
      bool note_unresolved(const std::vector<mechanics::Surroundings<dim>> &around,
                           const std::vector<mechanics::CellAtPlace>       &cells,
                           Functional                                      &largest) const
      {
        if (!largest.reason.empty())
          return false;
        for (std::size_t k = 0; k < around.size(); ++k)
          if (cells[k].size > around[k].radius && cells[k].von_mises > may_become_largest * largest.value)
            {
              largest.reason = format("%s at %s of body %s is not resolved: the cell there has edges of %.3g mm, and "
                                      "%.3g mm around it are left out",
                                      around[k].of.what.c_str(),
                                      point_text(around[k].of.middle(), dim).c_str(),
                                      solver.discrete_scene().bodies[around[k].of.body].name.c_str(),
                                      cells[k].size,
                                      around[k].radius);
              largest.is_resolvable = true;
              return true;
            }
        return false;
      }

      StressesAt<dim> at(const unsigned int body, const dealii::Point<dim> &x) const
      {
        const mechanics::StressPoint<dim> point(solver.discrete_scene(), solver.mesh(), solver.spaces(), body, x, t);
        return {point, point.recovered(stress), point.fitted(u)};
      }

      static Functional combination(const std::string            &name,
                                    const StressesAt<dim>        &at,
                                    const mechanics::Stress<dim> &weights)
      {
        Functional result{name, "MPa", (at.recovered * weights).sum(), {}, at.point.loads(weights), {}, false};
        if (at.fitted)
          result.local_error = std::abs(((*at.fitted - at.recovered) * weights).sum());
        else
          result.reason = "too few cells around the point";
        return result;
      }

      static Functional von_mises(const std::string &name, const StressesAt<dim> &at)
      {
        auto result  = combination(name, at, mechanics::von_mises_derivatives<dim>(at.recovered));
        result.value = mechanics::von_mises<dim>(at.recovered);
        if (!(result.value > 0))
          result.reason = "there is no stress";
        return result;
      }

      std::string description_of(const std::vector<mechanics::Surroundings<dim>> &around) const
      {
        std::set<std::string> texts;
        for (const auto &[point, radius] : around)
          texts.insert(format("%.3g mm from %s%s of body %s",
                              radius,
                              point.what.c_str(),
                              point.end ? "" : (" at " + point_text(point.position, dim)).c_str(),
                              solver.discrete_scene().bodies[point.body].name.c_str()));
        std::string result;
        for (const auto &text : texts)
          result += (result.empty() ? "farther than " : ", ") + text;
        return result;
      }

      const StepSolver<dim>             &solver;
      const std::vector<Eigen::VectorXd> u; // by subdomain
      const mechanics::StressResult     &stress;
      const double                       t;
    };
  } // namespace

  template <int dim>
  std::vector<Functional> stress_functionals(const StepSolver<dim>                            &solver,
                                             const mechanics::Probes<dim>                     &probes,
                                             const StepSolution                               &answer,
                                             const std::vector<mechanics::SingularPoint<dim>> &acting,
                                             const std::vector<mechanics::Surroundings<dim>>  &peaks,
                                             const double                                      t,
                                             const RequestedBars                              &requested)
  {
    std::vector<Functional>      list;
    const StressFunctionals<dim> of_scene(solver, answer, t);
    auto                         around = of_scene.surroundings(acting);
    around.insert(around.end(), peaks.begin(), peaks.end());
    const bool is_named = requested.is_goal("max_regular_von_mises");
    if (is_named || requested.includes_some_of("max_von_mises"))
      of_scene.add_largest(around, is_named, list);
    const auto &all = solver.discrete_scene().probes;
    for (unsigned int k = 0; k < all.size(); ++k)
      if (all[k].ends.size() == 1 && (requested.includes_some_of(all[k].name + ".stress_") ||
                                      requested.includes_some_of(all[k].name + ".von_mises")))
        of_scene.add_probe(all[k].name, all[k].body, probes.positions()[k][0].position, around, list);
    return list;
  }

  template std::vector<Functional> stress_functionals(const StepSolver<2> &,
                                                      const mechanics::Probes<2> &,
                                                      const StepSolution &,
                                                      const std::vector<mechanics::SingularPoint<2>> &,
                                                      const std::vector<mechanics::Surroundings<2>> &,
                                                      const double,
                                                      const RequestedBars &);
  template std::vector<Functional> stress_functionals(const StepSolver<3> &,
                                                      const mechanics::Probes<3> &,
                                                      const StepSolution &,
                                                      const std::vector<mechanics::SingularPoint<3>> &,
                                                      const std::vector<mechanics::Surroundings<3>> &,
                                                      const double,
                                                      const RequestedBars &);
} // namespace slipstick::app
