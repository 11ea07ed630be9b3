#include <slipstick/mechanics/points.h>
#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/output/conditions.h>
#include <slipstick/output/csv.h>
#include <slipstick/output/load_places.h>

#include <algorithm>
#include <ostream>

namespace slipstick::output
{
  namespace
  {
    /// A boundary used by a condition of the scene.
    struct NamedBoundary
    {
      std::string         kind, name, side;
      scene::BoundaryName where;
    };

    template <int dim>
    std::vector<NamedBoundary> boundaries_of(const scene::Scene<dim> &scene)
    {
      std::vector<NamedBoundary> all;
      for (const auto &support : scene.supports)
        if (!support.point)
          all.push_back({"support", support.name, "", support.where});
      for (const auto &foundation : scene.foundations)
        all.push_back({"foundation", foundation.name, "", foundation.where});
      for (const auto &traction : scene.tractions)
        all.push_back({"traction", traction.name, "", traction.where});
      for (const auto &pair : scene.contacts)
        {
          all.push_back({"contact", pair.name, "slave", pair.slave});
          if (pair.master)
            all.push_back({"contact", pair.name, "master", *pair.master});
        }
      return all;
    }

    /// A point used by a condition of the scene.
    template <int dim>
    struct NamedPoint
    {
      std::string           kind, name;
      scene::PointName<dim> where;
    };

    template <int dim>
    std::vector<NamedPoint<dim>> points_of(const scene::Scene<dim> &scene)
    {
      std::vector<NamedPoint<dim>> all;
      for (const auto &support : scene.supports)
        if (support.point)
          all.push_back({"support", support.name, *support.point});
      for (const auto &load : scene.point_loads)
        all.push_back({"point load", load.name, load.where});
      return all;
    }

    template <int dim>
    std::string at(const dealii::Point<dim> &point)
    {
      std::string text;
      for (unsigned int d = 0; d < dim; ++d)
        text += "," + to_text(point[d]);
      return text;
    }

    template <int dim>
    void write_rows(std::ostream                                    &out,
                    const scene::Scene<dim>                         &scene,
                    const mesh::Mesh<dim>                           &mesh,
                    const std::vector<NamedBoundary>                &boundaries,
                    const std::vector<mechanics::BoundaryPart<dim>> &parts,
                    const std::vector<NamedPoint<dim>>              &named,
                    const std::vector<mechanics::PointNode<dim>>    &nodes,
                    const std::vector<LoadPlace<dim>>               &places)
    {
      constexpr unsigned int n_ends = dim == 2 ? 2 : 4;
      // columns for these loads exist only if there are any
      const std::string no_value = places.empty() ? "" : ",";
      const auto        row =
        [&](const std::string &kind, const std::string &name, const std::string &side, const unsigned int body) {
          out << csv_field(kind) << ',' << csv_field(name) << ',' << side << ',' << csv_field(scene.bodies[body].name);
        };
      out << (dim == 2 ? "kind,name,side,body,x1,y1,x2,y2" : "kind,name,side,body,x1,y1,z1,x2,y2,z2,x3,y3,z3,x4,y4,z4")
          << (places.empty() ? "\n" : ",value\n");
      for (const auto &boundary : boundaries)
        for (const auto &part : mechanics::parts_on(mesh, parts, boundary.where))
          {
            row(boundary.kind, boundary.name, boundary.side, boundary.where.body);
            for (unsigned int i = 0; i < n_ends; ++i)
              out << at(part.node(std::min(i, part.n_corners() - 1)));
            out << no_value << '\n';
          }
      for (unsigned int k = 0; k < named.size(); ++k)
        {
          row(named[k].kind, named[k].name, "", named[k].where.body);
          for (unsigned int i = 0; i < n_ends; ++i)
            out << at(nodes[k].position);
          out << no_value << '\n';
        }
      for (const auto &place : places)
        {
          row(place.kind, place.name, place.side, place.body);
          for (std::size_t i = 0; i < n_ends; ++i)
            out << at(place.ends[std::min(i, place.ends.size() - 1)]);
          out << ',' << to_text(place.value) << '\n';
        }
    }

    template <int dim>
    void write_table(const OutputDirectory        &directory,
                     const scene::Scene<dim>      &scene,
                     const mesh::Mesh<dim>        &mesh,
                     const mechanics::Spaces<dim> &spaces)
    {
      const auto        boundaries = boundaries_of(scene);
      std::vector<bool> wanted(scene.bodies.size());
      for (const auto &boundary : boundaries)
        wanted[boundary.where.body] = true;
      const auto parts = mechanics::outlines(mesh, spaces, wanted);

      const auto                         named = points_of(scene);
      std::vector<scene::PointName<dim>> points;
      std::vector<std::string>           owners;
      for (const auto &point : named)
        {
          points.push_back(point.where);
          owners.push_back(point.kind + " " + point.name);
        }
      const auto nodes  = mechanics::nodes_at(scene, mesh, spaces, points, owners);
      const auto places = load_places(scene, mesh);

      directory.write_from_root("conditions.csv", [&](std::ostream &out) {
        write_rows<dim>(out, scene, mesh, boundaries, parts, named, nodes, places);
      });
    }
  } // namespace

  template <int dim>
  void write_conditions(const OutputDirectory        &directory,
                        const scene::Scene<dim>      &scene,
                        const mesh::Mesh<dim>        &mesh,
                        const mechanics::Spaces<dim> &spaces)
  {
    write_table(directory, scene, mesh, spaces);
  }

  template void write_conditions<2>(const OutputDirectory &,
                                    const scene::Scene<2> &,
                                    const mesh::Mesh<2> &,
                                    const mechanics::Spaces<2> &);
  template void write_conditions<3>(const OutputDirectory &,
                                    const scene::Scene<3> &,
                                    const mesh::Mesh<3> &,
                                    const mechanics::Spaces<3> &);
} // namespace slipstick::output
