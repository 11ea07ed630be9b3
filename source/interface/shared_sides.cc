#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/interface/shared_sides.h>

#include <algorithm>

namespace slipstick::interface
{
  namespace
  {
    using Edges = std::vector<mechanics::SurfaceEdge<2>>; // sorted

    Edges common(const Edges &a, const Edges &b)
    {
      Edges both;
      std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
      return both;
    }

    struct Sides
    {
      Edges slave, master; // the latter empty for an obstacle
    };

    void refuse(const scene::Scene<2>           &scene,
                const scene::ContactPair<2>     &first,
                const scene::ContactPair<2>     &second,
                const mechanics::SurfaceEdge<2> &edge)
    {
      const auto x = edge.point(0.5);
      throw InputError(
        format("Contact %s and Contact %s join the same two sides: both have the edge of %s at (%.6g, %.6g)%s",
               first.name.c_str(),
               second.name.c_str(),
               scene.bodies[edge.body].name.c_str(),
               x[0],
               x[1],
               first.master ? "" : (", against obstacle " + scene.obstacles[first.obstacle].name).c_str()),
        "keep one of the two, or choose boundaries that have no edge in common (`*` is the whole outline)");
    }

    void compare(const scene::Scene<2>       &scene,
                 const scene::ContactPair<2> &first,
                 const Sides                 &a,
                 const scene::ContactPair<2> &second,
                 const Sides                 &b)
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
            refuse(scene, first, second, slave.front());
          return;
        }
      for (const bool is_crossed : {false, true})
        {
          const auto slave  = common(a.slave, is_crossed ? b.master : b.slave);
          const auto master = common(a.master, is_crossed ? b.slave : b.master);
          if (!slave.empty() && !master.empty() && facing_distance(slave, master))
            refuse(scene, first, second, slave.front());
        }
    }
  } // namespace

  template <>
  void check_shared_sides(const scene::Scene<2> &scene, const mesh::Mesh<2> &mesh, const mechanics::Spaces<2> &spaces)
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
    const auto         all = mechanics::outlines(mesh, spaces, wanted);
    std::vector<Sides> sides;
    for (const auto &pair : scene.contacts)
      sides.push_back({mechanics::edges_on(mesh, all, pair.slave),
                       pair.master ? mechanics::edges_on(mesh, all, *pair.master) : Edges()});
    for (unsigned int i = 0; i < sides.size(); ++i)
      for (unsigned int j = i + 1; j < sides.size(); ++j)
        compare(scene, scene.contacts[i], sides[i], scene.contacts[j], sides[j]);
  }
} // namespace slipstick::interface
