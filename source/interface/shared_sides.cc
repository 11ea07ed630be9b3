#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/interface/shared_sides.h>

#include <algorithm>

namespace slipstick::interface
{
  namespace
  {
    template <int dim>
    using Parts = std::vector<mechanics::BoundaryPart<dim>>; // sorted

    template <class List>
    List common(const List &a, const List &b)
    {
      List both;
      std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
      return both;
    }

    template <int dim>
    struct Sides
    {
      Parts<dim> slave, master; // the latter empty for an obstacle
    };

    template <int dim>
    void refuse(const scene::Scene<dim>            &scene,
                const scene::ContactPair<dim>      &first,
                const scene::ContactPair<dim>      &second,
                const mechanics::BoundaryPart<dim> &part)
    {
      const char *const name = dim == 2 ? "edge" : "face";
      throw InputError(
        format("Contact %s and Contact %s join the same two sides: both have the %s of %s at %s%s",
               first.name.c_str(),
               second.name.c_str(),
               name,
               scene.bodies[part.body].name.c_str(),
               point_text(part.middle(), dim).c_str(),
               first.master ? "" : (", against obstacle " + scene.obstacles[first.obstacle].name).c_str()),
        format("keep one of the two, or choose boundaries that have no %s in common (`*` is the whole %s)",
               name,
               dim == 2 ? "outline" : "surface"));
    }

    template <int dim>
    void compare(const scene::Scene<dim>       &scene,
                 const scene::ContactPair<dim> &first,
                 const Sides<dim>              &a,
                 const scene::ContactPair<dim> &second,
                 const Sides<dim>              &b)
    {
      if (first.master.has_value() != second.master.has_value())
        return;
      if (first.master
            ? std::minmax(first.slave.body, first.master->body) != std::minmax(second.slave.body, second.master->body)
            : first.slave.body != second.slave.body)
        return;
      if (!first.master)
        {
          if (const auto slave = common(a.slave, b.slave); first.obstacle == second.obstacle && !slave.empty())
            refuse<dim>(scene, first, second, slave.front());
          return;
        }
      for (const bool is_crossed : {false, true})
        {
          const auto slave  = common(a.slave, is_crossed ? b.master : b.slave);
          const auto master = common(a.master, is_crossed ? b.slave : b.master);
          if (!slave.empty() && !master.empty() && facing_distance(slave, master))
            refuse<dim>(scene, first, second, slave.front());
        }
    }
  } // namespace

  template <int dim>
  void check_shared_sides(const scene::Scene<dim>      &scene,
                          const mesh::Mesh<dim>        &mesh,
                          const mechanics::Spaces<dim> &spaces)
  {
    if (scene.contacts.size() < 2)
      return;
    std::vector<bool> wanted(scene.bodies.size(), false);
    for (const auto &pair : scene.contacts)
      {
        wanted[pair.slave.body] = true;
        if (pair.master)
          wanted[pair.master->body] = true;
      }
    const auto              all = mechanics::outlines(mesh, spaces, wanted);
    std::vector<Sides<dim>> sides;
    for (const auto &pair : scene.contacts)
      sides.push_back({mechanics::parts_on(mesh, all, pair.slave),
                       pair.master ? mechanics::parts_on(mesh, all, *pair.master) : Parts<dim>()});
    for (unsigned int i = 0; i < sides.size(); ++i)
      for (unsigned int j = i + 1; j < sides.size(); ++j)
        compare(scene, scene.contacts[i], sides[i], scene.contacts[j], sides[j]);
  }

  template void check_shared_sides(const scene::Scene<2> &, const mesh::Mesh<2> &, const mechanics::Spaces<2> &);
  template void check_shared_sides(const scene::Scene<3> &, const mesh::Mesh<3> &, const mechanics::Spaces<3> &);
} // namespace slipstick::interface
