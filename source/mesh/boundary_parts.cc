#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/mesh/boundary_parts.h>
#include <slipstick/scene/boundary_part.h>

#include <algorithm>

namespace slipstick::mesh
{
  namespace
  {
    // Distance from its ends, relative to its length, at which a condition is tried on an edge: nodes on a limit belong
    // to both sides.
    constexpr double end_of_edge = 1e-6;

    /// Is a face with this id on the boundary of that name?
    template <int dim>
    bool is_on(const BodyMesh<dim> &mesh, const std::string &name, const dealii::types::boundary_id id)
    {
      if (name == "*")
        return true;
      const auto named    = mesh.boundary_ids.at(name);
      const auto combined = mesh.combined_ids.find(id);
      return id == named || (combined != mesh.combined_ids.end() && combined->second.count(named) > 0);
    }

    template <int dim>
    dealii::types::boundary_id unused_id(const BodyMesh<dim> &mesh)
    {
      dealii::types::boundary_id largest = 0;
      for (const auto &[name, id] : mesh.boundary_ids)
        largest = std::max(largest, id);
      for (const auto &[id, names] : mesh.combined_ids)
        largest = std::max(largest, id);
      for (const auto &face : mesh.piece.boundary_faces)
        largest = std::max(largest, face.id);
      return largest + 1;
    }

    /// One part: its faces get ids of their own, which stand for all names that they had and this one.
    template <int dim>
    void add_part(const std::string         &user,
                  const std::string         &body,
                  const scene::BoundaryPart &part,
                  BodyMesh<dim>             &mesh)
    {
      const scene::Field<dim> condition(part.condition, user);
      const auto              own  = unused_id(mesh);
      auto                    next = own + 1;

      std::map<dealii::types::boundary_id, dealii::types::boundary_id> renamed;
      unsigned int                                                     n_taken = 0, n_cut = 0;
      dealii::Point<dim>                                               cut;
      for (auto &face : mesh.piece.boundary_faces)
        {
          if (!is_on(mesh, part.name, face.id))
            continue;
          const dealii::Point<dim> a = mesh.piece.vertices[face.vertices[0]], b = mesh.piece.vertices[face.vertices[1]];
          const auto               holds = [&](const double at) { return condition.value(a + at * (b - a), 0.) != 0; };
          const bool               takes = holds(0.5);
          if (takes != holds(end_of_edge) || takes != holds(1 - end_of_edge))
            {
              ++n_cut;
              cut = a + 0.5 * (b - a);
            }
          if (!takes)
            continue;
          ++n_taken;
          const auto [to, is_new] = renamed.emplace(face.id, next);
          if (is_new)
            {
              const auto had = mesh.combined_ids.find(face.id);
              auto ids = had != mesh.combined_ids.end() ? had->second : std::set<dealii::types::boundary_id>{face.id};
              ids.insert(own);
              mesh.combined_ids[next++] = std::move(ids);
            }
          face.id = to->second;
        }
      const std::string name = "boundary '" + part.name + "' of body '" + body + "'";
      if (n_taken == 0)
        throw InputError(
          user + ": no edge of " + name + " fulfils '" + part.condition + "'",
          "give a condition in x and y, as placed and before loading, that holds in the middle of some edges");
      if (n_cut > 0)
        mesh.remarks.push_back(
          format("warning: %s: '%s' changes within %u edge%s of %s, such as that around (%.6g, %.6g); an "
                 "edge belongs to the part as a whole if its middle does: put a node of the mesh there",
                 user.c_str(),
                 part.condition.c_str(),
                 n_cut,
                 n_cut == 1 ? "" : "s",
                 name.c_str(),
                 cut[0],
                 cut[1]));
      mesh.boundary_ids[to_string(part)] = own;
    }
  } // namespace

  template <int dim>
  void add_boundary_parts(const scene::Scene<dim> &scene, const unsigned int b, BodyMesh<dim> &mesh)
  {
    for (const auto &[user, where] : scene::used_boundaries(scene))
      if (where.body == b && mesh.boundary_ids.count(where.boundary) == 0)
        {
          const auto part = scene::part_of_boundary(where.boundary);
          if (!part.condition.empty())
            add_part(user, scene.bodies[b].name, part, mesh);
        }
  }

  template void add_boundary_parts(const scene::Scene<2> &, const unsigned int, BodyMesh<2> &);
} // namespace slipstick::mesh
