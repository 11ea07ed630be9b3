#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/boundary_parts.h>
#include <slipstick/scene/boundary_part.h>

#include <algorithm>

namespace slipstick::mesh
{
  namespace
  {
    // Distance from its ends, relative to its length, at which a condition is tested on an edge (on a face: from its
    // corners towards its centre): nodes on a limit belong to both sides.
    constexpr double end_of_edge = 1e-6;

    /// Whether a face with this id is on the boundary of that name.
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

    /// One boundary part: its faces get new ids, which represent all names that they had and this one.
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
          dealii::Point<dim> middle = mesh.piece.vertices[face.vertices[0]];
          if constexpr (dim == 2)
            middle += 0.5 * (mesh.piece.vertices[face.vertices[1]] - middle);
          else
            {
              dealii::Tensor<1, dim> sum;
              unsigned int           n = 0;
              for (const unsigned int v : face.vertices)
                if (v != MeshPiece<dim>::no_vertex)
                  {
                    sum += mesh.piece.vertices[v];
                    ++n;
                  }
              middle = dealii::Point<dim>(sum / n);
            }
          const auto holds = [&](const dealii::Point<dim> &x) { return condition.value(x, 0.) != 0; };
          const bool takes = holds(middle);
          if (std::any_of(face.vertices.begin(), face.vertices.end(), [&](const unsigned int v) {
                if (v == MeshPiece<dim>::no_vertex)
                  return false;
                const auto &x = mesh.piece.vertices[v];
                return takes != holds(x + 2 * end_of_edge * (middle - x));
              }))
            {
              ++n_cut;
              cut = middle;
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
      const char *const face_name = dim == 2 ? "edge" : "face";
      const std::string name      = "boundary '" + part.name + "' of body '" + body + "'";
      if (n_taken == 0)
        throw InputError(user + ": no " + face_name + " of " + name + " fulfils '" + part.condition + "'",
                         std::string("give a condition in ") + (dim == 2 ? "x and y" : "x, y and z") +
                           ", as placed and before loading, that holds in the middle of some " + face_name + "s");
      if (n_cut > 0)
        mesh.remarks.emplace_back(
          format("%s: '%s' changes within %u %s%s of %s, such as that around %s; %s "
                 "%s belongs to the part as a whole if its middle does: put a node of the mesh there",
                 user.c_str(),
                 part.condition.c_str(),
                 n_cut,
                 face_name,
                 n_cut == 1 ? "" : "s",
                 name.c_str(),
                 point_text(cut, dim).c_str(),
                 dim == 2 ? "an" : "a",
                 face_name),
          true);
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
  template void add_boundary_parts(const scene::Scene<3> &, const unsigned int, BodyMesh<3> &);
} // namespace slipstick::mesh
