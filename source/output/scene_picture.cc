#include <slipstick/base/log.h>
#include <slipstick/mechanics/points.h>
#include <slipstick/mechanics/probes.h>
#include <slipstick/output/drawn_bodies.h>
#include <slipstick/output/load_places.h>
#include <slipstick/output/scene_picture.h>

#include <algorithm>
#include <ostream>

namespace slipstick::output
{
  namespace
  {
    // Approximate number of arrows per load.
    constexpr unsigned int arrows_of_load = 12;

    template <int dim, class LoadAt>
    dealii::Tensor<1, dim> largest(const std::vector<double> &load_factors, const LoadAt &load_at)
    {
      dealii::Tensor<1, dim> result;
      for (const double t : load_factors)
        if (const auto load = load_at(t); load.norm() > result.norm())
          result = load;
      return result;
    }

    /// Bounding box of the bodies, and of places in loads_in_bodies() whose distance from them is at most their size.
    template <int dim>
    View view_of(const std::vector<mechanics::BoundaryPart<dim>> &outlines, const std::vector<LoadPlace<dim>> &places)
    {
      const Projection<dim> project;
      auto                  low = project(outlines.front().node(0)), high = low;
      const auto            show = [&](const dealii::Point<2> &point) {
        for (unsigned int d = 0; d < 2; ++d)
          {
            low[d]  = std::min(low[d], point[d]);
            high[d] = std::max(high[d], point[d]);
          }
      };
      for (const auto &part : outlines)
        for (unsigned int i = 0; i < part.n_nodes; ++i)
          show(project(part.node(i)));
      const auto   middle = low + (high - low) / 2;
      const double size   = low.distance(high);
      for (const auto &place : places)
        for (const auto &end : place.ends)
          if (project(end).distance(middle) <= size)
            show(project(end));
      return View(low, high);
    }

    /// Draws conditions on boundaries, at points and in bodies, on top of the bodies.
    template <int dim>
    class Conditions
    {
    public:
      using Point = dealii::Point<dim>;
      using Parts = std::vector<mechanics::BoundaryPart<dim>>;

      Conditions(const scene::Scene<dim> &scene_,
                 const mesh::Mesh<dim>   &mesh_,
                 const Parts             &outlines_,
                 const View              &view_,
                 ScenePicture            &picture_)
        : scene(scene_)
        , mesh(mesh_)
        , outlines(outlines_)
        , view(view_)
        , picture(picture_)
      {}

      void boundary(const std::string &kind, const std::string &name, const scene::BoundaryName &where)
      {
        std::string path;
        for (const auto &part : mechanics::parts_on(mesh, outlines, where))
          path += view.path(seen(part)) + (dim == 2 ? "" : "z");
        if (dim == 2)
          picture.lines(kind, name, path);
        else
          picture.areas(kind, name, path);
        picture.in_legend(kind, name);
      }

      void point(const std::string &kind, const std::string &name, const Point &where)
      {
        picture.dot(kind, name, project(where));
        picture.in_legend(kind, name);
      }

      void tractions()
      {
        std::vector<LoadArrow> arrows;
        for (const auto &traction : scene.tractions)
          {
            boundary("traction", traction.name, traction.where);
            const auto        parts  = mechanics::parts_on(mesh, outlines, traction.where);
            const std::size_t stride = 1 + parts.size() / arrows_of_load;
            for (std::size_t k = stride / 2; k < parts.size(); k += stride)
              {
                const auto place  = parts[k].middle();
                const auto normal = mechanics::middle_normal(parts[k]);
                arrows.push_back(arrow(place, largest<dim>(scene.load_factors, [&](const double t) {
                                         dealii::Tensor<1, dim> load = -traction.pressure.value(place, t) * normal;
                                         for (unsigned int c = 0; c < dim; ++c)
                                           load[c] += traction.components[c].value(place, t);
                                         return load;
                                       })));
              }
          }
        picture.arrows("traction", arrows);
      }

      /// @param nodes of the point loads.
      void point_loads(const mechanics::PointNode<dim> *nodes)
      {
        std::vector<LoadArrow> arrows;
        for (const auto &load : scene.point_loads)
          {
            const auto place = nodes++->position;
            point("point load", load.name, place);
            arrows.push_back(arrow(place, largest<dim>(scene.load_factors, [&](const double t) {
                                     dealii::Tensor<1, dim> force;
                                     for (unsigned int c = 0; c < dim; ++c)
                                       force[c] = load.force[c].value(place, t);
                                     return force;
                                   })));
          }
        picture.arrows("point load", arrows);
      }

      void loads_in_bodies(const std::vector<LoadPlace<dim>> &places)
      {
        std::vector<LoadArrow> forces, tensions;
        for (const auto &place : places)
          {
            std::vector<dealii::Point<2>> ends;
            for (const auto &end : place.ends)
              ends.push_back(project(end));
            picture.in_legend(place.kind, place.name);
            if (place.kind == "temperature")
              continue; // drawn below
            if (place.side.empty())
              {
                if (place.value == 0)
                  continue; // the formula is 0 there
                picture.dot(place.kind, place.name, ends.front(), dot_radius);
                forces.push_back(arrow(place.ends.front(), place.force));
                forces.back().begins_there = true;
              }
            else if (ends.size() == 1)
              picture.turning(place.kind, place.name, ends.front());
            else
              picture.lines(place.kind, place.name, view.path(ends) + (ends.size() > 2 ? "z" : ""));
            if (place.kind == "pretension" && place.side == "axis")
              for (const double side : {-1., 1.}) // the arrows point at the section
                {
                  const auto along = place.ends.back() - place.ends.front();
                  tensions.push_back(arrow(section_of(places, place.name), side * place.value / along.norm() * along));
                }
          }
        picture.arrows("body force", forces);
        picture.arrows("pretension", tensions);
        for (const auto &place : places)
          if (place.kind == "temperature")
            picture.label(place.kind, place.name, project(place.ends.front()), format("%+.4g K", place.value));
      }

      void probe(const std::string &name, const std::vector<mechanics::ProbePoint<dim>> &points)
      {
        const auto first = project(points.front().position), last = project(points.back().position);
        if (points.size() == 1)
          picture.dot("probe", name, first, dot_radius);
        else
          picture.lines("probe", name, view.path({first, last}));
        picture.in_legend("probe", name);
      }

    private:
      // Radius of the dot at a probed point, and start of the arrow of a body force [pixels].
      static constexpr double dot_radius = 3.5;

      LoadArrow arrow(const Point &place, const dealii::Tensor<1, dim> &load) const
      {
        return {project(place), project.along(load), load.norm(), false};
      }

      /// Centre of the section of a bolt.
      static Point section_of(const std::vector<LoadPlace<dim>> &places, const std::string &bolt)
      {
        Point middle;
        for (const auto &place : places)
          if (place.kind == "pretension" && place.side == "section" && place.name == bolt)
            for (const auto &end : place.ends)
              middle += 1. / place.ends.size() * end;
        return middle;
      }

      const scene::Scene<dim> &scene;
      const mesh::Mesh<dim>   &mesh;
      const Parts             &outlines;
      const View              &view;
      ScenePicture            &picture;
      Projection<dim>          project;
    };

    template <int dim>
    std::vector<mechanics::PointNode<dim>> named_nodes(const scene::Scene<dim>      &scene,
                                                       const mesh::Mesh<dim>        &mesh,
                                                       const mechanics::Spaces<dim> &spaces)
    {
      std::vector<scene::PointName<dim>> points;
      std::vector<std::string>           owners;
      for (const auto &support : scene.supports)
        if (support.point)
          {
            points.push_back(*support.point);
            owners.push_back("Support " + support.name);
          }
      for (const auto &load : scene.point_loads)
        {
          points.push_back(load.where);
          owners.push_back("Point load " + load.name);
        }
      return mechanics::nodes_at(scene, mesh, spaces, points, owners);
    }
  } // namespace

  template <int dim>
  void write_scene_picture(const OutputDirectory        &directory,
                           const std::string            &file,
                           const scene::Scene<dim>      &scene,
                           const mesh::Mesh<dim>        &mesh,
                           const mechanics::Spaces<dim> &spaces)
  {
    const auto        outlines = mechanics::outlines(mesh, spaces, std::vector<bool>(scene.bodies.size(), true));
    const DrawnBodies bodies(mesh, outlines);
    const auto        places = load_places(scene, mesh);
    const auto        nodes  = named_nodes(scene, mesh, spaces);

    const mechanics::Probes<dim> probes(scene, mesh, spaces);
    directory.write_from_root(file, [&](std::ostream &out) {
      const View   view = view_of<dim>(outlines, places);
      ScenePicture picture(out,
                           view,
                           scene.supports.size() + scene.foundations.size() + scene.tractions.size() +
                             scene.point_loads.size() + 2 * scene.contacts.size() + scene.body_forces.size() +
                             scene.temperatures.size() + scene.pretensions.size() + scene.probes.size());
      if (dim == 2)
        bodies.write(out, view);
      picture.begin_clipped();
      for (const auto &obstacle : scene.obstacles)
        draw_obstacle(out, view, obstacle, scene.load_factors.front());
      picture.end_clipped();
      if (dim == 3) // in front of obstacles
        bodies.write(out, view);

      Conditions<dim> draw(scene, mesh, outlines, view, picture);
      for (const auto &pair : scene.contacts)
        {
          if (pair.master) // drawn beneath the slave, since the two often coincide
            draw.boundary("contact, master", pair.name, *pair.master);
          draw.boundary("contact, slave", pair.name, pair.slave);
        }
      auto next = nodes.data();
      for (const auto &support : scene.supports)
        if (support.point)
          draw.point("support", support.name, next++->position);
        else
          draw.boundary("support", support.name, support.where);
      for (const auto &foundation : scene.foundations)
        draw.boundary("foundation", foundation.name, foundation.where);
      draw.tractions();
      draw.point_loads(next);
      draw.loads_in_bodies(places);
      for (unsigned int k = 0; k < scene.probes.size(); ++k)
        draw.probe(scene.probes[k].name, probes.positions()[k]);
      picture.finish();
    });
  }

  template void write_scene_picture(const OutputDirectory &,
                                    const std::string &,
                                    const scene::Scene<2> &,
                                    const mesh::Mesh<2> &,
                                    const mechanics::Spaces<2> &);
  template void write_scene_picture(const OutputDirectory &,
                                    const std::string &,
                                    const scene::Scene<3> &,
                                    const mesh::Mesh<3> &,
                                    const mechanics::Spaces<3> &);
} // namespace slipstick::output
