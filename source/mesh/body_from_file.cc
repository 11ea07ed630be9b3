#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/body_mesh.h>
#include <slipstick/mesh/conformity.h>

#include <cmath>
#include <cstdio>
#include <numeric>

namespace slipstick::mesh
{
  namespace
  {
    constexpr double       flat_tolerance = 1e-8; // of z, over the size of the body
    constexpr double       least_sine     = 1e-6; // of the angles of a cell
    constexpr unsigned int named_cells    = 3;    // in messages

    const std::string remedy_of_overlap =
      "remove duplicate entities (in Gmsh: Coherence; Coherence Mesh), or choose one Part";

    std::array<unsigned int, 2> sorted(const unsigned int a, const unsigned int b)
    {
      return {{std::min(a, b), std::max(a, b)}};
    }

    std::string at(const dealii::Point<3> &x)
    {
      char text[80];
      std::snprintf(text, sizeof(text), "(%.6g, %.6g)", x[0], x[1]);
      return text;
    }

    /// One body as it is put together from a file.
    template <int dim>
    class Extraction
    {
    public:
      using Element = MeshFile::Element;
      using Face    = typename MeshPiece<dim>::Face;

      Extraction(const scene::Body<dim> &body, const MeshFile &file)
        : body(body)
        , file(file)
      {}

      BodyMesh<dim> run()
      {
        choose_cells();
        check_plane();
        check_shapes();
        add_cells();
        check_faces();
        name_boundaries();
        name_points();
        keep_middles();
        check_connected();
        check_conformity();
        if (file.is_curved && mesh.middles.empty())
          mesh.remarks.push_back("body " + body.name + ": only the corners of the curved cells in " + file.file +
                                 " are used (mid nodes are kept only for second-order cells in Gmsh and Abaqus files)");
        return std::move(mesh);
      }

    private:
      [[noreturn]] void fail(const std::string &problem, const std::string &remedy) const
      {
        throw InputError("Body " + body.name + ": mesh file " + file.file + " " + problem, remedy);
      }

      std::string cell_text(const Element &cell) const
      {
        dealii::Point<3> center;
        for (unsigned int k = 0; k < cell.n; ++k)
          center += (file.nodes[cell.corners[k]] - dealii::Point<3>()) / cell.n;
        return "cell " + std::to_string(cell.number) + " at " + at(center);
      }

      void choose_cells();
      void check_plane();
      void check_shapes();
      void add_cells();
      void check_faces();
      void name_boundaries();
      void name_points();
      void keep_middles();
      void check_connected();
      void check_conformity();
      void note_left_out_lines(const std::map<Face, std::set<std::string>> &names);

      const scene::Body<dim>              &body;
      const MeshFile                      &file;
      BodyMesh<dim>                        mesh;
      std::vector<Element>                 cells;
      std::map<unsigned int, unsigned int> vertex_of_node;
      std::map<Face, unsigned int>         n_cells_at; // by face
      std::set<Face>                       named_faces;
    };

    template <int dim>
    void Extraction<dim>::choose_cells()
    {
      std::set<std::array<unsigned int, 4>> seen; // version 2 lists a cell once for every physical name
      std::set<std::string>                 parts;
      std::array<std::size_t, 4>            n = {{0, 0, 0, 0}}; // by dimension
      for (const Element &element : file.elements)
        {
          ++n[element.dim];
          if (element.dim != 2)
            continue;
          for (const int physical : file.groups[element.group])
            parts.insert(file.name_of(2, physical));
          if (!file.is_in(element, body.part))
            continue;
          auto key = element.corners;
          if (element.n == 3)
            key[3] = MeshPiece<dim>::no_vertex;
          std::sort(key.begin(), key.end());
          if (seen.insert(key).second)
            cells.push_back(element);
        }
      if (n[3] > 0)
        fail("is three-dimensional, it has " + std::to_string(n[3]) + " cells with a volume",
             "give a plane mesh of triangles and quadrilaterals: gmsh -2 part.geo");
      if (n[2] == 0)
        fail("has no cells, only " + std::to_string(n[1]) + " lines and " + std::to_string(n[0]) + " points",
             "mesh the surfaces, and if physical names are used, name them too: Physical Surface(\"part\") = {1}; gmsh "
             "-2 part.geo");
      if (cells.empty())
        fail("has no part '" + body.part + "'",
             suggest_name(body.part, std::vector<std::string>(parts.begin(), parts.end())) +
               (parts.empty() ? "; name its surfaces (Physical Surface), or omit Part to take all cells" : ""));
    }

    template <int dim>
    void Extraction<dim>::check_plane()
    {
      std::array<double, 3> low, high;
      low.fill(std::numeric_limits<double>::max());
      high.fill(-std::numeric_limits<double>::max());
      for (const Element &cell : cells)
        for (unsigned int k = 0; k < cell.n; ++k)
          for (unsigned int d = 0; d < 3; ++d)
            {
              low[d]  = std::min(low[d], file.nodes[cell.corners[k]][d]);
              high[d] = std::max(high[d], file.nodes[cell.corners[k]][d]);
            }
      const double size = std::max(high[0] - low[0], high[1] - low[1]);
      if (high[2] - low[2] > flat_tolerance * std::max(size, high[2] - low[2]))
        fail("does not lie in a plane z = constant: z goes from " + number_text(low[2]) + " to " + number_text(high[2]),
             "give the mesh in the x, y plane");
    }

    /// Cells counterclockwise, with angles of (0, 180) degrees.
    template <int dim>
    void Extraction<dim>::check_shapes()
    {
      // orientation by the sum of the corners; a cell that intersects itself or is not convex has corners of both kinds
      std::vector<unsigned int> clockwise;
      for (unsigned int c = 0; c < cells.size(); ++c)
        {
          const Element &cell = cells[c];
          const auto     edge = [&](const unsigned int k) {
            const auto d = file.nodes[cell.corners[(k + 1) % cell.n]] - file.nodes[cell.corners[k % cell.n]];
            return std::array<double, 2>{{d[0], d[1]}};
          };
          unsigned int left = 0, right = 0;
          for (unsigned int k = 0; k < cell.n; ++k)
            {
              const auto   a = edge(k), b = edge(k + 1);
              const double cross = a[0] * b[1] - a[1] * b[0];
              const double scale = std::hypot(a[0], a[1]) * std::hypot(b[0], b[1]);
              left += cross > least_sine * scale;
              right += cross < -least_sine * scale;
            }
          if (left != cell.n && right != cell.n)
            fail(std::string("has a degenerate cell: ") + cell_text(cell) + " " +
                   (left > 0 && right > 0 ? "intersects itself or is not convex"
                    : left + right == 0   ? "has no area"
                                          : "has a corner of 0 or 180 degrees"),
                 "mesh again, or repair the geometry there (doubled or nearly equal points)");
          if (right > 0)
            clockwise.push_back(c);
        }
      if (!clockwise.empty() && clockwise.size() < cells.size())
        {
          std::string some;
          for (unsigned int k = 0; k < clockwise.size() && k < named_cells; ++k)
            some += (k > 0 ? ", " : "") + cell_text(cells[clockwise[k]]);
          fail(
            "has " + std::to_string(clockwise.size()) + " of " + std::to_string(cells.size()) +
              " cells with clockwise orientation: " + some + (clockwise.size() > named_cells ? ", ..." : ""),
            "give all cells the same orientation (in Gmsh: Recombine after Coherence, or ReverseMesh on the surface)");
        }
      for (const unsigned int c : clockwise) // all of them
        std::reverse(cells[c].corners.begin(), cells[c].corners.begin() + cells[c].n);
    }

    template <int dim>
    void Extraction<dim>::add_cells()
    {
      const auto vertex = [this](const unsigned int node) {
        const auto [found, is_new] = vertex_of_node.emplace(node, mesh.piece.vertices.size());
        if (is_new)
          mesh.piece.vertices.push_back(body.scale * dealii::Point<dim>(file.nodes[node][0], file.nodes[node][1]));
        return found->second;
      };
      for (const Element &cell : cells)
        {
          std::array<unsigned int, 4> v;
          for (unsigned int k = 0; k < cell.n; ++k)
            v[k] = vertex(cell.corners[k]);
          mesh.piece.cells.push_back(cell.n == 3 ? triangle<dim>(v[0], v[1], v[2])
                                                 : quadrilateral<dim>(v[0], v[1], v[2], v[3]));
        }
      mesh.piece.global_vertices.resize(mesh.piece.vertices.size());
      std::iota(mesh.piece.global_vertices.begin(), mesh.piece.global_vertices.end(), GlobalVertex(0));
    }

    template <int dim>
    void Extraction<dim>::check_faces()
    {
      const auto faces = faces_with_cells(mesh.piece);
      for (const auto &[face, c] : faces)
        if (++n_cells_at[face] > 2)
          fail("has an edge of three cells, one of them " + cell_text(cells[c]), remedy_of_overlap);
      // neighbours run along their edge in opposite ways, unless one is folded onto the other
      const auto runs_up = [this](const Face &face, const unsigned int c) {
        const auto &cell = mesh.piece.cells[c];
        for (unsigned int k = 0; k < n_corners<dim>(cell); ++k)
          if (corner<dim>(cell, k) == face[0] && corner<dim>(cell, k + 1) == face[1])
            return true;
        return false;
      };
      for (std::size_t k = 1; k < faces.size(); ++k)
        if (const auto &[face, c] = faces[k];
            faces[k - 1].first == face && runs_up(face, c) == runs_up(face, faces[k - 1].second))
          fail("has cells on top of each other: " + cell_text(cells[faces[k - 1].second]) + " and " +
                 cell_text(cells[c]) + " lie on the same side of their edge",
               remedy_of_overlap);
    }

    /// Lines of the file at the outline carry its names; the rest is outline without a name.
    template <int dim>
    void Extraction<dim>::name_boundaries()
    {
      std::map<Face, std::set<std::string>> names;
      for (const auto &[face, n] : n_cells_at)
        if (n == 1)
          names[face];
      for (const Element &line : file.elements)
        if (line.dim == 1 && vertex_of_node.count(line.corners[0]) > 0 && vertex_of_node.count(line.corners[1]) > 0)
          {
            const unsigned int a = vertex_of_node[line.corners[0]], b = vertex_of_node[line.corners[1]];
            const auto         found = names.find({{std::min(a, b), std::max(a, b)}});
            if (found != names.end())
              for (const int physical : file.groups[line.group])
                found->second.insert(file.name_of(1, physical));
          }

      note_left_out_lines(names);
      for (const auto &[face, of_face] : names)
        if (!of_face.empty())
          named_faces.insert(face);

      // 0 is the outline without a name; then the names; then the sets of several
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

    /// Boundaries with lines that are not on the outline would lose their share of a load.
    template <int dim>
    void Extraction<dim>::note_left_out_lines(const std::map<Face, std::set<std::string>> &names)
    {
      std::vector<Face> edges_of_cells; // of the whole file, by nodes; made when needed
      const auto        is_edge_of_cell = [&](const Face &edge) {
        if (edges_of_cells.empty())
          {
            for (const Element &cell : file.elements)
              if (cell.dim == 2)
                for (unsigned int k = 0; k < cell.n; ++k)
                  edges_of_cells.push_back(sorted(cell.corners[k], cell.corners[(k + 1) % cell.n]));
            std::sort(edges_of_cells.begin(), edges_of_cells.end());
          }
        return std::binary_search(edges_of_cells.begin(), edges_of_cells.end(), edge);
      };
      std::map<std::string, std::pair<unsigned int, std::string>> left_out; // how many, the first one
      for (const Element &line : file.elements)
        if (line.dim == 1 && !line.implied)
          {
            const auto a = vertex_of_node.find(line.corners[0]), b = vertex_of_node.find(line.corners[1]);
            const bool is_ours = a != vertex_of_node.end() && b != vertex_of_node.end() &&
                                 n_cells_at.count(sorted(a->second, b->second)) > 0;
            std::string problem;
            if (is_ours && names.count(sorted(a->second, b->second)) == 0)
              problem = "lies inside the body";
            else if (!is_ours && !is_edge_of_cell(sorted(line.corners[0], line.corners[1])))
              problem = "is not an edge of a cell";
            else
              continue;
            for (const int physical : file.groups[line.group])
              if (auto &entry = left_out[file.name_of(1, physical)]; ++entry.first == 1)
                entry.second = "line " + std::to_string(line.number) + " from " + at(file.nodes[line.corners[0]]) +
                               " to " + at(file.nodes[line.corners[1]]) + " " + problem;
          }
      std::string all;
      for (const auto &[name, entry] : left_out)
        {
          const std::string others = entry.first > 1 ? ", and " + std::to_string(entry.first - 1) + " more" : "";
          mesh.incomplete_boundaries[name] = entry.second + others;
          all += (all.empty() ? "" : "; ") + ("'" + name + "': " + entry.second) + others;
        }
      if (!all.empty())
        mesh.remarks.push_back("body " + body.name + ": not on its outline and left out: " + all);
      for (const auto &[name, nodes] : file.node_sets)
        {
          std::set<unsigned int> reached;
          for (const auto &[face, of_face] : names)
            if (of_face.count(name) > 0)
              reached.insert(face.begin(), face.end());
          for (const unsigned int node : nodes)
            if (const auto v = vertex_of_node.find(node); v != vertex_of_node.end() && reached.count(v->second) == 0)
              if (std::string &problem = mesh.incomplete_boundaries[name]; problem.empty())
                problem = "its node at " + at(file.nodes[node]) +
                          " is not an end of an edge of the outline between two nodes "
                          "of the set";
        }
    }

    template <int dim>
    void Extraction<dim>::name_points()
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
              mesh.ambiguous_points[name] = "there are several, one at " + at(file.nodes[node]);
    }

    template <int dim>
    void Extraction<dim>::check_conformity()
    {
      const auto fault = find_fault(mesh.piece, named_faces);
      if (!fault)
        return;
      const std::string place = at(dealii::Point<3>(fault->place[0] / body.scale, fault->place[1] / body.scale, 0));
      const std::string of =
        cell_text(cells[fault->first_cell]) +
        (fault->first_cell == fault->second_cell ? "" : " and " + cell_text(cells[fault->second_cell]));
      const std::string remedy =
        "join the nodes (in Gmsh: Coherence before, Coherence Mesh after meshing); where a slit is meant, "
        "give the lines on both its sides physical names";
      switch (fault->kind)
        {
          case ConformityFault<dim>::Kind::overlap:
            fail("has cells on top of each other at " + place + ": " + of, remedy_of_overlap);
          case ConformityFault<dim>::Kind::hanging_node:
            fail("has a node inside an edge at " + place + ", which is not joined to it: " + of, remedy);
          case ConformityFault<dim>::Kind::twin_nodes:
            fail("has two nodes at " + place + " that are not joined: " + of, remedy);
        }
    }

    template <int dim>
    void Extraction<dim>::keep_middles()
    {
      if (file.middles.empty())
        return;
      std::vector<unsigned int> node_of_vertex(vertex_of_node.size());
      for (const auto &[node, vertex] : vertex_of_node)
        node_of_vertex[vertex] = node;
      for (const auto &face : mesh.piece.boundary_faces)
        {
          const auto ends  = std::minmax(node_of_vertex[face.vertices[0]], node_of_vertex[face.vertices[1]]);
          const auto found = file.middles.find({ends.first, ends.second});
          if (found != file.middles.end())
            mesh.middles[face.vertices] =
              body.scale * dealii::Point<dim>(file.nodes[found->second][0], file.nodes[found->second][1]);
        }
    }

    template <int dim>
    void Extraction<dim>::check_connected()
    {
      std::vector<unsigned int> root(mesh.piece.vertices.size());
      std::iota(root.begin(), root.end(), 0);
      const auto find = [&root](unsigned int v) {
        while (root[v] != v)
          v = root[v] = root[root[v]];
        return v;
      };
      for (const auto &cell : mesh.piece.cells)
        for (unsigned int k = 1; k < n_corners<dim>(cell); ++k)
          root[find(cell[k])] = find(cell[0]);
      std::map<unsigned int, unsigned int> first_cell; // by piece
      for (unsigned int c = 0; c < cells.size(); ++c)
        first_cell.emplace(find(mesh.piece.cells[c][0]), c);
      if (first_cell.size() == 1)
        return;
      std::string places;
      for (const auto &[piece, c] : first_cell)
        places += (places.empty() ? "" : ", ") + cell_text(cells[c]);
      if (first_cell.size() > named_cells)
        places = cell_text(cells[first_cell.begin()->second]) + ", ...";
      fail("gives a body of " + std::to_string(first_cell.size()) + " pieces that share no node: " + places,
           "declare a body for every piece (Physical Surface in the mesh, Part in the scene), or join them (in Gmsh: "
           "Coherence)");
    }
  } // namespace

  template <int dim>
  BodyMesh<dim> body_from_file(const scene::Body<dim> &body, const MeshFile &file)
  {
    return Extraction<dim>(body, file).run();
  }

  template BodyMesh<2> body_from_file(const scene::Body<2> &, const MeshFile &);
} // namespace slipstick::mesh
