#include <slipstick/app/formula_warnings.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/mechanics/surface_facet.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace slipstick::app
{
  namespace
  {
    // Number of points on an edge, and along each direction of a face, at which formulas are compared with their nodal
    // values.
    constexpr unsigned int n_on_edge = 65, n_across_face = 17;
    // Admissible excess between nodes: relative to the largest value on the boundary (slip bounds), to the range of
    // values (displacements), to the smaller of edge length and largest displacement (gaps).
    constexpr double lost_part = 0.1;
    // Values that differ by less than this fraction of the largest count as constant.
    constexpr double rounding_of_values = 1e-9;

    enum class Scale
    {
      magnitude,
      range,
      length
    };

    template <int dim>
    struct Subject
    {
      std::string              name, unit;
      scene::BoundaryName      where;
      const scene::Field<dim> *formula;
      Scale                    scale;
    };

    /// The formulas of a scene that are evaluated at boundary nodes.
    template <int dim>
    std::vector<Subject<dim>> subjects_of(const scene::Scene<dim> &scene)
    {
      std::vector<Subject<dim>> all;
      const auto                add = [&all](const std::string         &name,
                              const std::string         &unit,
                              const scene::BoundaryName &where,
                              const scene::Field<dim>   &formula,
                              const Scale                scale) {
        if (!formula.is_constant())
          all.push_back({name, unit, where, &formula, scale});
      };
      for (const auto &support : scene.supports)
        {
          if (support.point)
            continue;
          const std::string name = "Support " + support.name + "/Displacement ";
          for (unsigned int d = 0; d < dim; ++d)
            if (support.components[d])
              add(name + "xyz"[d], "mm", support.where, *support.components[d], Scale::range);
          if (support.normal)
            add(name + "normal", "mm", support.where, *support.normal, Scale::range);
        }
      for (const auto &pair : scene.contacts)
        {
          const std::string name = "Contact " + pair.name + "/";
          for (const auto *number : pair.law.numbers())
            add(name + number->name, number->unit, pair.slave, number->value, Scale::magnitude);
          if (pair.gap)
            add(name + "Gap", "mm", pair.slave, *pair.gap, Scale::length);
          if (pair.gap || pair.master) // the obstacle itself is checked between the nodes
            add(name + "Offset", "mm", pair.slave, pair.offset, Scale::length);
        }
      return all;
    }

    /// Extremes of one formula on its boundary.
    struct Finding
    {
      double                least = std::numeric_limits<double>::infinity(), most = -least; // at nodes and between them
      double                excess = 0; // beyond the values at the nodes of the part
      double                value = 0, at_nodes = 0, edge = 0;
      std::array<double, 3> at{{0, 0, 0}};

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &least &most &excess &value &at_nodes &edge &at;
      }

      void take(const Finding &other)
      {
        const double lowest = std::min(least, other.least), highest = std::max(most, other.most);
        if (std::tie(other.excess, other.at) > std::tie(excess, at))
          *this = other;
        least = lowest;
        most  = highest;
      }
    };

    std::vector<dealii::Point<2>> places_of(const mechanics::SurfaceEdge<2> &edge)
    {
      std::vector<dealii::Point<2>> places;
      for (unsigned int i = 1; i + 1 < n_on_edge; ++i)
        places.push_back(edge.point(double(i) / (n_on_edge - 1)));
      return places;
    }

    std::vector<dealii::Point<3>> places_of(const mechanics::SurfaceFacet &facet)
    {
      std::vector<dealii::Point<3>> places;
      for (unsigned int i = 0; i < n_across_face; ++i)
        for (unsigned int j = 0; j < (facet.n_corners() == 3 ? n_across_face - i : n_across_face); ++j)
          places.push_back(facet.point({double(i) / (n_across_face - 1), double(j) / (n_across_face - 1)}));
      return places;
    }

    /// Infinite if the formula cannot be evaluated.
    template <int dim>
    double value_of(const scene::Field<dim> &formula, const dealii::Point<dim> &x, const double t)
    {
      try
        {
          return formula.value(x, t);
        }
      catch (const InputError &)
        {
          return std::numeric_limits<double>::infinity();
        }
    }

    template <int dim>
    Finding compare(const scene::Field<dim> &formula, const mechanics::BoundaryPart<dim> &part, const double t)
    {
      Finding found;
      for (unsigned int i = 0; i < part.n_nodes; ++i)
        {
          const double value = value_of(formula, part.node(i), t);
          found.least        = std::min(found.least, value);
          found.most         = std::max(found.most, value);
        }
      const double low = found.least, high = found.most;
      for (const auto &x : places_of(part))
        {
          const double value = value_of(formula, x, t);
          found.least        = std::min(found.least, value);
          found.most         = std::max(found.most, value);
          if (const double excess = std::max(value - high, low - value); excess > found.excess)
            {
              found.excess   = excess;
              found.value    = value;
              found.at_nodes = value > high ? high : low;
              found.edge     = part.chord();
              for (unsigned int d = 0; d < dim; ++d)
                found.at[d] = x[d];
            }
        }
      return found;
    }

    double allowed_excess(const Finding &found, const Scale scale, const double largest)
    {
      const double magnitude = std::max(std::abs(found.least), std::abs(found.most));
      const double size      = scale == Scale::magnitude ? magnitude
                               : scale == Scale::range   ? found.most - found.least
                                                         : std::min(found.edge, largest);
      return std::isfinite(size) ? std::max(lost_part * size, rounding_of_values * magnitude) : 0.;
    }
  } // namespace

  template <int dim>
  std::map<std::string, std::string> formula_warnings(const scene::Scene<dim>      &scene,
                                                      const mesh::Mesh<dim>        &mesh,
                                                      const mechanics::Spaces<dim> &spaces,
                                                      const double                  t,
                                                      const double                  largest)
  {
    std::map<std::string, std::string> texts;
    const auto                         subjects = subjects_of(scene);
    if (subjects.empty())
      return texts;
    std::vector<Finding> findings(subjects.size());
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
        for (const unsigned int f : cell->face_indices())
          if (mesh::is_on_outline(cell->face(f)))
            for (unsigned int k = 0; k < subjects.size(); ++k)
              if (subjects[k].where.body == mesh.subdomains[p]->body &&
                  mesh.on_boundary(subjects[k].where, cell->face(f)->boundary_id()))
                findings[k].take(
                  compare<dim>(*subjects[k].formula, mechanics::surface_part(*mesh.subdomains[p], spaces, cell, f), t));
    for (const auto &list : all_gather(mesh.comm, findings))
      for (unsigned int k = 0; k < subjects.size(); ++k)
        findings[k].take(list[k]);
    for (unsigned int k = 0; k < subjects.size(); ++k)
      {
        const auto &found = findings[k];
        if (!(found.excess > allowed_excess(found, subjects[k].scale, largest)))
          continue;
        const auto &body                     = scene.bodies[subjects[k].where.body].name;
        texts["formula " + subjects[k].name] = format(
          "%s: the formula is %.4g %s at %s, but %.4g at the nearest nodes of its %s of %.3g mm: it is evaluated "
          "at nodes only, so that this is lost; refine %s there (%sRefinements) until nodes resolve it, or place nodes there",
          subjects[k].name.c_str(),
          found.value,
          subjects[k].unit.c_str(),
          point_text(found.at, dim).c_str(),
          found.at_nodes,
          dim == 2 ? "edge" : "face",
          found.edge,
          body.c_str(),
          dim == 2 ? "Refine towards, " : "");
      }
    return texts;
  }

  template std::map<std::string, std::string> formula_warnings(const scene::Scene<2> &,
                                                               const mesh::Mesh<2> &,
                                                               const mechanics::Spaces<2> &,
                                                               const double,
                                                               const double);
  template std::map<std::string, std::string> formula_warnings(const scene::Scene<3> &,
                                                               const mesh::Mesh<3> &,
                                                               const mechanics::Spaces<3> &,
                                                               const double,
                                                               const double);
} // namespace slipstick::app
