#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/boundary_parts.h>
#include <slipstick/mesh/curved_faces.h>
#include <slipstick/mesh/edge_middles.h>
#include <slipstick/mesh/kinematics.h>
#include <slipstick/mesh/make_body.h>
#include <slipstick/mesh/refinement.h>
#include <slipstick/mesh/smooth_outline.h>
#include <slipstick/mesh/solid_middles.h>
#include <slipstick/scene/boundary_part.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace slipstick::mesh
{
  namespace
  {
    // Subdomains have cells of one kind. If triangles and quadrilaterals are mixed in parts smaller than this, the body
    // is converted to quadrilaterals.
    constexpr unsigned int least_cells_of_one_kind = 200;

    /// Number of connected pieces with one kind of cells, and the number of cells of the smallest.
    template <int dim>
    std::pair<unsigned int, std::size_t> pieces_of_one_kind(const MeshPiece<dim> &piece)
    {
      std::vector<unsigned int> kind;
      for (const auto &cell : piece.cells)
        kind.push_back(is_simplex<dim>(cell));
      const auto  pieces = cut(piece, kind);
      std::size_t least  = piece.cells.size();
      for (const auto &one : pieces)
        least = std::min(least, one.cells.size());
      return {pieces.size(), least};
    }

    template <int dim>
    bool is_mixed(const MeshPiece<dim> &piece)
    {
      for (const auto &cell : piece.cells)
        if (is_simplex<dim>(cell) != is_simplex<dim>(piece.cells[0]))
          return true;
      return false;
    }

    /// Uniform refinements and the choice of cell kinds for a mesh from a file.
    template <int dim>
    void refine_uniformly(const scene::Body<dim> &body,
                          unsigned int            refinements,
                          const bool              refines_cells,
                          BodyMesh<dim>          &mesh)
    {
      if (is_mixed(mesh.piece))
        {
          const bool towards = refines_cells || (body.boundary_refinements > 0 && !body.refined_boundaries.empty());
          const auto [n_pieces, least] = pieces_of_one_kind(mesh.piece);
          if (towards || least << std::min(2 * refinements, 20u) < least_cells_of_one_kind)
            {
              mesh.piece = in_quadrilaterals(mesh.piece);
              mesh.remarks.push_back("body " + body.name + ": its triangles and quadrilaterals " +
                                     (refines_cells ? std::string("are refined where the error is large")
                                      : towards     ? std::string("are refined towards a boundary")
                                                    : "mix in " + std::to_string(n_pieces) + " pieces, some of " +
                                                    std::to_string(least) + " cells") +
                                     ", so all are divided into quadrilaterals (" +
                                     (refinements > 0 ? "in place of one refinement" : "half their size") + ")");
              refinements -= refinements > 0;
            }
        }
      for (unsigned int k = 0; k < refinements; ++k)
        mesh.piece = refined(mesh.piece);
    }

    template <int dim>
    void refine_cells(BodyMesh<dim> &mesh, std::set<CellPath> &refined, std::vector<CellPath> &paths)
    {
      auto finer = adapted(mesh.piece, refined);
      mesh.piece = std::move(finer.piece);
      paths      = std::move(finer.paths);
    }

    /// For adaptive refinement: the templates for hexahedra would spread too far.
    void divide_into_tetrahedra(const scene::Scene<3> &scene, const unsigned int b, BodyMesh<3> &mesh)
    {
      const auto &cells = mesh.piece.cells;
      if (std::all_of(cells.begin(), cells.end(), [](const auto &cell) { return is_simplex<3>(cell); }))
        return;
      MeshPiece<3> placed;
      placed.vertices = mesh.piece.vertices;
      place_in_scene(scene, b, placed);
      mesh.piece = in_tetrahedra(mesh.piece, placed.vertices);
      mesh.remarks.push_back("body " + scene.bodies[b].name +
                             ": its hexahedra are refined where the error is large, so each of them is " +
                             "divided into six tetrahedra");
    }

    template <int dim>
    void refine_towards_boundaries(const scene::Body<dim> &body, BodyMesh<dim> &mesh)
    {
      if (body.boundary_refinements == 0 || body.refined_boundaries.empty())
        return;
      std::set<dealii::types::boundary_id> ids;
      for (const auto &face : mesh.piece.boundary_faces)
        for (const std::string &name : body.refined_boundaries)
          {
            const auto named    = mesh.boundary_ids.find(name);
            const auto combined = mesh.combined_ids.find(face.id);
            if (name == "*" || (named != mesh.boundary_ids.end() &&
                                (named->second == face.id ||
                                 (combined != mesh.combined_ids.end() && combined->second.count(named->second) > 0))))
              ids.insert(face.id);
          }
      for (unsigned int k = 0; k < body.boundary_refinements; ++k)
        mesh.piece = refined_towards(mesh.piece, ids);
    }

    /// Adds remarks on element types that contradict the plane state of the scene, which takes precedence.
    template <int dim>
    void remark_on_plane_state(const scene::Scene<dim> &scene, MeshFile &file)
    {
      const auto names = [](const std::set<std::string> &types) {
        std::string all;
        for (const std::string &type : types)
          all += (all.empty() ? "" : ", ") + type;
        return all;
      };
      const std::string computed_in = scene.plane_state == scene::PlaneState::plane_stress   ? "in plane stress"
                                      : scene.plane_state == scene::PlaneState::plane_strain ? "in plane strain"
                                                                                             : "as axisymmetric";
      if (scene.plane_state != scene::PlaneState::axisymmetric && !file.axisymmetric_types.empty())
        throw InputError("mesh file " + file.file + " has axisymmetric elements (" + names(file.axisymmetric_types) +
                           "), but the scene is computed " + computed_in,
                         "set Plane state = axisymmetric, or mesh the bodies with plane elements");
      const auto warn = [&](const std::set<std::string> &types, const std::string &kind) {
        if (!types.empty())
          file.remarks.emplace_back("mesh file " + file.file + " has elements of plane " + kind + " (" + names(types) +
                                      "), and the scene is computed " + computed_in + ": see Plane state",
                                    true);
      };
      if (scene.plane_state != scene::PlaneState::plane_stress)
        warn(file.plane_stress_types, "stress");
      if (scene.plane_state != scene::PlaneState::plane_strain)
        warn(file.plane_strain_types, "strain");
    }

    /// Moves nodes within rounding of the axis of revolution onto it; refuses nodes beyond it.
    template <int dim>
    void move_to_axis(const scene::Body<dim> &body, const Kinematics<dim> &kinematics, MeshPiece<dim> &piece)
    {
      if (!kinematics.is_revolution() || piece.vertices.empty())
        return;
      double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
      for (const auto &x : piece.vertices)
        {
          low  = std::min(low, x[0]);
          high = std::max(high, x[0]);
        }
      for (auto &x : piece.vertices)
        if (kinematics.is_on_axis(x, high - low))
          x[0] = 0;
        else if (x[0] < 0)
          throw InputError(
            format("Body %s: it reaches to x = %g mm, but with Plane state = axisymmetric x is the radius "
                   "and the axis is x = 0",
                   body.name.c_str(),
                   low),
            "mesh or place the half of its section where x >= 0 (Translation, Rotation; a ball is a half disc "
            "turned by 90 degrees or a quarter disc), or set another Plane state");
    }

    /// Checks that every boundary and point of body @p b that the scene uses exists.
    template <int dim>
    void check_names(const scene::Scene<dim> &scene, const unsigned int b, const BodyMesh<dim> &mesh)
    {
      const scene::Body<dim>  &body = scene.bodies[b];
      const std::string        from = body.shape == scene::Shape::mesh ? " in mesh file " + body.file : "";
      std::vector<std::string> boundaries, points;
      for (const auto &entry : mesh.boundary_ids)
        boundaries.push_back(entry.first);
      for (const auto &entry : mesh.points)
        points.push_back(entry.first);
      const auto boundary = [&](const std::string &user, const scene::BoundaryName &of_scene) {
        auto where = of_scene;
        if (mesh.boundary_ids.count(where.boundary) == 0)
          where.boundary = scene::part_of_boundary(where.boundary).name;
        if (const auto lost = mesh.incomplete_boundaries.find(where.boundary);
            where.body == b && lost != mesh.incomplete_boundaries.end())
          throw InputError(user + ": boundary '" + where.boundary + "' of body '" + body.name + "'" + from +
                             " is not all on its outline: " + lost->second,
                           "use the name only for edges of the outline, and write the mesh again");
        if (where.body == b && where.boundary != "*" && mesh.boundary_ids.count(where.boundary) == 0)
          throw InputError(user + ": body '" + body.name + "' has no boundary '" + where.boundary + "'" + from,
                           suggest_name(where.boundary, boundaries) +
                             (boundaries.empty() ? "; name lines of its outline in the mesh (Physical Curve)" : "") +
                             mesh.about_names);
      };
      const auto point = [&](const std::string &user, const scene::PointName<dim> &where) {
        if (where.body == b && !where.point.empty() && mesh.points.count(where.point) == 0)
          throw InputError(user + ": body '" + body.name + "' has no point '" + where.point + "'" + from,
                           suggest_name(where.point, points) +
                             (points.empty() ? "; name one in the mesh (Physical Point), or give coordinates" : "") +
                             mesh.about_names);
        if (const auto several = mesh.ambiguous_points.find(where.point);
            where.body == b && several != mesh.ambiguous_points.end())
          throw InputError(user + ": point '" + where.point + "' of body '" + body.name + "'" + from +
                             " is not one node: " + several->second,
                           "give each its own name in the mesh, or give coordinates");
      };
      for (const std::string &name : body.refined_boundaries)
        {
          if (!scene::part_of_boundary(name).condition.empty())
            throw InputError("Body " + body.name + "/Refine towards = '" + name + "': a condition is not allowed here",
                             "name the whole boundary");
          boundary("Body " + body.name + "/Refine towards", {b, name});
        }
      for (const auto &[user, where] : scene::used_boundaries(scene))
        boundary(user, where);
      for (const auto &support : scene.supports)
        if (support.point)
          point("Support " + support.name, *support.point);
      for (const auto &load : scene.point_loads)
        point("Point load " + load.name, load.where);
      for (const auto &probe : scene.probes)
        for (const auto &end : probe.ends)
          point("Probe " + probe.name, end);
    }
  } // namespace

  template <int dim>
  std::vector<Remark> unused_parts(const scene::Scene<dim> &scene, const std::map<std::string, MeshFile> &files)
  {
    std::vector<Remark> remarks;
    for (const auto &of_path : files) // lambdas capture no structured bindings in C++17
      {
        const std::string                  &path = of_path.first;
        const MeshFile                     &file = of_path.second;
        std::map<std::string, unsigned int> cells; // by names
        for (const auto &element : file.elements)
          if (element.dim == dim && std::none_of(scene.bodies.begin(), scene.bodies.end(), [&](const auto &body) {
                return body.file == path && file.is_in(element, body.part);
              }))
            {
              std::string names;
              for (const int physical : file.groups[element.group])
                names += (names.empty() ? "'" : ", '") + file.name_of(dim, physical) + "'";
              ++cells[names.empty() ? "no name" : names];
            }
        std::string all;
        for (const auto &[names, n] : cells)
          all += (all.empty() ? "" : "; ") + names + " (" + std::to_string(n) + ")";
        if (!all.empty())
          remarks.push_back("mesh file " + path + ": cells that belong to no body: " + all);
      }
    return remarks;
  }

  template <int dim>
  void place_in_scene(const scene::Scene<dim> &scene, const unsigned int b, MeshPiece<dim> &piece)
  {
    place(piece, scene.bodies[b].placement);
    move_to_axis(scene.bodies[b], Kinematics<dim>(scene.plane_state), piece);
  }

  template <int dim>
  BodyMesh<dim> make_body(const scene::Scene<dim>         &scene,
                          const unsigned int               b,
                          std::map<std::string, MeshFile> &files,
                          std::set<CellPath>              *refined,
                          std::vector<CellPath>           *paths)
  {
    const scene::Body<dim> &body = scene.bodies[b];
    BodyMesh<dim>           mesh;
    if constexpr (dim == 3)
      {
        if (body.shape == scene::Shape::mesh)
          {
            if (files.count(body.file) == 0)
              files[body.file] = read_mesh_file(body.file);
            mesh          = body_from_file(body, files[body.file]);
            auto &of_file = files[body.file].remarks; // report only once
            mesh.remarks.insert(mesh.remarks.begin(), of_file.begin(), of_file.end());
            of_file.clear();
            curve_faces(body, mesh);
            for (unsigned int k = 0; k < body.refinements + scene.discretization.refinements; ++k)
              mesh.piece = mesh::refined(mesh.piece);
          }
        else
          mesh = body_from_shape(scene, body);
        check_names(scene, b, mesh);
        if (refined)
          divide_into_tetrahedra(scene, b, mesh);
        refine_towards_boundaries(body, mesh);
        if (refined)
          refine_cells(mesh, *refined, *paths);
        keep_good_middles(mesh.piece);
        mesh.piece.body = b;
        place_in_scene(scene, b, mesh.piece);
        add_boundary_parts(scene, b, mesh);
        return mesh;
      }
    else
      {
        if (body.shape == scene::Shape::mesh)
          {
            if (files.count(body.file) == 0)
              {
                files[body.file] = read_mesh_file(body.file);
                remark_on_plane_state(scene, files[body.file]);
              }
            mesh          = body_from_file(body, files[body.file]);
            auto &of_file = files[body.file].remarks; // report only once
            mesh.remarks.insert(mesh.remarks.begin(), of_file.begin(), of_file.end());
            of_file.clear();
            check_names(scene, b, mesh);
            smooth_outline(body, mesh);
            refine_uniformly(body, body.refinements + scene.discretization.refinements, refined != nullptr, mesh);
          }
        else
          {
            mesh = body_from_shape(scene, body);
            check_names(scene, b, mesh);
          }
        refine_towards_boundaries(body, mesh);
        if (refined)
          refine_cells(mesh, *refined, *paths);
        const unsigned int n_of_refinement = n_unbent(mesh.piece);
        bend_edges(mesh.piece);
        // cells of degree 1 do not follow curves, only new nodes do
        if (const unsigned int n = scene.discretization.degree == 1 ? n_of_refinement : n_unbent(mesh.piece); n > 0)
          mesh.remarks.push_back(format("warning: body %s: %u edges of its outline are straight though the outline is "
                                        "curved, as their cells are too thin to follow it: use more cells along the "
                                        "curve or fewer across it",
                                        body.name.c_str(),
                                        n));
        mesh.piece.body = b;
        place_in_scene(scene, b, mesh.piece);
        add_boundary_parts(scene, b, mesh);
        return mesh;
      }
  }

  template void                place_in_scene(const scene::Scene<2> &, const unsigned int, MeshPiece<2> &);
  template void                place_in_scene(const scene::Scene<3> &, const unsigned int, MeshPiece<3> &);
  template std::vector<Remark> unused_parts(const scene::Scene<2> &, const std::map<std::string, MeshFile> &);
  template std::vector<Remark> unused_parts(const scene::Scene<3> &, const std::map<std::string, MeshFile> &);
  template BodyMesh<2>         make_body(const scene::Scene<2> &,
                                         const unsigned int,
                                         std::map<std::string, MeshFile> &,
                                         std::set<CellPath> *,
                                         std::vector<CellPath> *);
  template BodyMesh<3>         make_body(const scene::Scene<3> &,
                                         const unsigned int,
                                         std::map<std::string, MeshFile> &,
                                         std::set<CellPath> *,
                                         std::vector<CellPath> *);
} // namespace slipstick::mesh
