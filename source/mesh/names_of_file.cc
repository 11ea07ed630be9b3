#include <slipstick/base/text.h>
#include <slipstick/mesh/names_of_file.h>
#include <slipstick/mesh/part_of_file.h>

#include <algorithm>

namespace slipstick::mesh
{
  /// The face of the body that corresponds to a line or a face of the file; none if a node is not in the body.
  template <int dim>
  std::optional<typename NamesOfFile<dim>::Face> NamesOfFile<dim>::face_of(const Element &element) const
  {
    Face face;
    face.fill(MeshPiece<dim>::no_vertex);
    for (unsigned int k = 0; k < element.n; ++k)
      if (const auto found = vertex_of_node.find(element.corners[k]); found != vertex_of_node.end())
        face[k] = found->second;
      else
        return {};
    std::sort(face.begin(), face.end());
    return face;
  }

  template <int dim>
  std::string NamesOfFile<dim>::place_of(const Element &element) const
  {
    if (element.dim == 1)
      return "from " + point_text(file.nodes[element.corners[0]], dim) + " to " +
             point_text(file.nodes[element.corners[1]], dim);
    return "with a corner at " + point_text(file.nodes[element.corners[0]], dim);
  }

  template <int dim>
  typename NamesOfFile<dim>::Names NamesOfFile<dim>::names_of_outline() const
  {
    Names names;
    for (const auto &[face, n] : n_cells_at)
      if (n == 1)
        names[face];
    for (const Element &line : file.elements)
      if (line.dim == dim - 1)
        if (const auto face = face_of(line))
          if (const auto found = names.find(*face); found != names.end())
            for (const int physical : file.groups[line.group])
              found->second.insert(file.name_of(dim - 1, physical));
    return names;
  }

  /// Boundary ids: 0 is the outline without a name, followed by the names, then by sets of several names.
  template <int dim>
  void NamesOfFile<dim>::number_boundaries(BodyMesh<dim> &mesh, const Names &names) const
  {
    dealii::types::boundary_id next = 1;
    for (const auto &[face, of_face] : names)
      for (const std::string &name : of_face)
        mesh.boundary_ids.emplace(name, 0);
    for (auto &entry : mesh.boundary_ids)
      entry.second = next++;
    std::map<std::set<std::string>, dealii::types::boundary_id> id_of_set = {{{}, 0}};
    for (const auto &[name, id] : mesh.boundary_ids)
      id_of_set[{name}] = id;
    for (const auto &[face, of_face] : names)
      {
        const auto [found, is_new] = id_of_set.emplace(of_face, next);
        if (is_new)
          {
            for (const std::string &name : of_face)
              mesh.combined_ids[next].insert(mesh.boundary_ids.at(name));
            ++next;
          }
        mesh.piece.boundary_faces.push_back({face, found->second});
      }
  }

  template <int dim>
  typename NamesOfFile<dim>::LeftOut NamesOfFile<dim>::left_out_lines(const Names &names) const
  {
    std::vector<Face> faces_of_cells; // of the whole file, by nodes; computed when needed
    const auto        is_face_of_cell = [&](const Element &line) {
      if (faces_of_cells.empty())
        {
          for (const Element &element : file.elements)
            if (element.dim == dim && (dim == 2 || element.n == 4 || element.n == 8))
              {
                const auto cell = cell_of<dim>(element, [](const unsigned int node) { return node; });
                for (unsigned int f = 0; f < n_faces<dim>(cell); ++f)
                  faces_of_cells.push_back(face_of_cell<dim>(cell, f));
              }
          std::sort(faces_of_cells.begin(), faces_of_cells.end());
        }
      Face face;
      face.fill(MeshPiece<dim>::no_vertex);
      std::copy(line.corners.begin(), line.corners.begin() + line.n, face.begin());
      std::sort(face.begin(), face.end());
      return std::binary_search(faces_of_cells.begin(), faces_of_cells.end(), face);
    };
    LeftOut left_out;
    for (const Element &line : file.elements)
      if (line.dim == dim - 1 && !line.implied)
        {
          const auto  face    = face_of(line);
          const bool  is_ours = face && n_cells_at.count(*face) > 0;
          std::string problem;
          if (is_ours && names.count(*face) == 0)
            problem = "lies inside the body";
          else if (!is_ours && !is_face_of_cell(line))
            problem = std::string("is not ") + (dim == 2 ? "an edge" : "a face") + " of a cell";
          else
            continue;
          for (const int physical : file.groups[line.group])
            if (auto &entry = left_out[file.name_of(dim - 1, physical)]; ++entry.first == 1)
              entry.second = std::string(Words<dim>::boundary) + " " + std::to_string(line.number) + " " +
                             place_of(line) + " " + problem;
        }
    return left_out;
  }

  /// Reports node sets some of whose nodes are not on a face of the boundary.
  template <int dim>
  void NamesOfFile<dim>::note_incomplete_sets(BodyMesh<dim> &mesh, const Names &names) const
  {
    for (const auto &[name, nodes] : file.node_sets)
      {
        std::set<unsigned int> reached;
        for (const auto &[face, of_face] : names)
          if (of_face.count(name) > 0)
            reached.insert(face.begin(), face.end());
        for (const unsigned int node : nodes)
          if (const auto v = vertex_of_node.find(node); v != vertex_of_node.end() && reached.count(v->second) == 0)
            if (std::string &problem = mesh.incomplete_boundaries[name]; problem.empty())
              problem = "its node at " + point_text(file.nodes[node], dim) +
                        (dim == 2 ? " is not an end of an edge of the outline between two nodes of the set"
                                  : " is not a corner of a face of the outline all of whose corners are in the set");
      }
  }

  template <int dim>
  void NamesOfFile<dim>::name_boundaries(BodyMesh<dim> &mesh, const std::string &body) const
  {
    const Names names = names_of_outline();
    number_boundaries(mesh, names);
    std::string all;
    for (const auto &[name, entry] : left_out_lines(names))
      {
        const std::string others         = entry.first > 1 ? ", and " + std::to_string(entry.first - 1) + " more" : "";
        mesh.incomplete_boundaries[name] = entry.second + others;
        all += (all.empty() ? "" : "; ") + ("'" + name + "': " + entry.second) + others;
      }
    if (!all.empty())
      mesh.remarks.push_back("body " + body + ": not on its outline and left out: " + all);
    note_incomplete_sets(mesh, names);
  }

  template <int dim>
  void NamesOfFile<dim>::name_points(BodyMesh<dim> &mesh) const
  {
    std::map<std::string, std::set<unsigned int>> nodes;
    for (const Element &point : file.elements)
      if (point.dim == 0)
        for (const int physical : file.groups[point.group])
          nodes[file.name_of(0, physical)].insert(point.corners[0]);
    for (const auto &[name, of_name] : nodes)
      for (const unsigned int node : of_name)
        if (const auto found = vertex_of_node.find(node); found != vertex_of_node.end())
          if (!mesh.points.emplace(name, found->second).second)
            mesh.ambiguous_points[name] = "there are several, one at " + point_text(file.nodes[node], dim);
  }

  template class NamesOfFile<2>;
  template class NamesOfFile<3>;
} // namespace slipstick::mesh
