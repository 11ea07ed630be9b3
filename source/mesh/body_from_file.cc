#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/body_mesh.h>
#include <slipstick/mesh/conformity.h>

#include <cmath>
#include <numeric>
#include <optional>

namespace slipstick::mesh
{
  namespace
  {
    constexpr double       flat_tolerance = 1e-8; // of z, over the size of the body
    constexpr double       least_sine     = 1e-6; // of the angles of a cell, in space of their volumes
    constexpr double       same_place     = 1e-9; // distance of two nodes, over the size of the body
    constexpr unsigned int named_cells    = 3;    // in messages

    const std::string remedy_of_overlap =
      "remove duplicate entities (in Gmsh: Coherence; Coherence Mesh), or choose one Part";

    /// The words of messages.
    template <int dim>
    struct Words
    {
      static constexpr const char *face = dim == 2 ? "edge" : "face", *boundary = dim == 2 ? "line" : "face",
                                  *physical = dim == 2 ? "Physical Surface" : "Physical Volume";
    };

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
        if (file.is_curved && mesh.middles.empty() && mesh.piece.line_middles.empty())
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
        return "cell " + std::to_string(cell.number) + " at " + point_text(center, dim);
      }

      /// Types of elements of the plane, which are faces beside solids.
      std::string plane_types() const
      {
        std::string all;
        for (const auto *types : {&file.plane_stress_types, &file.plane_strain_types, &file.axisymmetric_types})
          for (const std::string &type : *types)
            all += (all.empty() ? " (" : ", ") + type;
        return all.empty() ? all : all + ")";
      }

      void choose_cells();
      void check_kinds(const std::array<std::size_t, 4> &n) const;
      void check_plane();
      void check_shapes();
      void check_shapes_of_solids();
      void fail_inverted(const std::vector<unsigned int> &inverted,
                         const std::string               &how,
                         const std::string               &remedy) const;
      void add_cells();
      void check_faces();
      void name_boundaries();
      void name_points();
      void keep_middles();
      void check_connected();
      void check_conformity();
      void check_twin_nodes();

      /// On which side of a face is a cell?
      bool is_behind(const Face &face, const unsigned int c) const
      {
        const auto &x    = mesh.piece.vertices;
        const auto &cell = mesh.piece.cells[c];
        if constexpr (dim == 2) // does it run along its edge upwards?
          {
            for (unsigned int k = 0; k < n_corners<dim>(cell); ++k)
              if (corner<dim>(cell, k) == face[0] && corner<dim>(cell, k + 1) == face[1])
                return true;
            return false;
          }
        else
          {
            dealii::Tensor<1, dim> center;
            for (unsigned int k = 0; k < n_corners<dim>(cell); ++k)
              center += (x[cell[k]] - x[face[0]]) / n_corners<dim>(cell);
            return cross_product_3d(x[face[1]] - x[face[0]], x[face[2]] - x[face[0]]) * center < 0;
          }
      }

      /// The cell of the corners that @p number gives.
      template <class Number>
      typename MeshPiece<dim>::Cell cell_of(const Element &element, const Number &number) const
      {
        typename MeshPiece<dim>::Cell v;
        v.fill(MeshPiece<dim>::no_vertex);
        for (unsigned int k = 0; k < element.n; ++k)
          v[k] = number(element.corners[k]);
        if (!is_simplex<dim>(v)) // around: now in rows
          for (unsigned int k = 2; k < element.n; k += 4)
            std::swap(v[k], v[k + 1]);
        return v;
      }

      /// The face that a line or a face of the file stands for; none if a node is not of the body.
      std::optional<Face> face_of(const Element &element) const
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

      std::string place_of(const Element &element) const
      {
        if (element.dim == 1)
          return "from " + point_text(file.nodes[element.corners[0]], dim) + " to " +
                 point_text(file.nodes[element.corners[1]], dim);
        return "with a corner at " + point_text(file.nodes[element.corners[0]], dim);
      }
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
      std::set<std::array<unsigned int, 8>> seen; // version 2 lists a cell once for every physical name
      std::set<std::string>                 parts;
      std::array<std::size_t, 4>            n = {{0, 0, 0, 0}}; // by dimension
      for (const Element &element : file.elements)
        {
          ++n[element.dim];
          if (element.dim != dim)
            continue;
          for (const int physical : file.groups[element.group])
            parts.insert(file.name_of(dim, physical));
          if (!file.is_in(element, body.part))
            continue;
          auto key = element.corners;
          std::fill(key.begin() + element.n, key.end(), MeshPiece<dim>::no_vertex);
          std::sort(key.begin(), key.end());
          if (seen.insert(key).second)
            cells.push_back(element);
        }
      check_kinds(n);
      if (cells.empty())
        fail("has no part '" + body.part + "'",
             suggest_name(body.part, std::vector<std::string>(parts.begin(), parts.end())) +
               (parts.empty() ? std::string(dim == 2 ? "; name its surfaces (" : "; name its volumes (") +
                                  Words<dim>::physical + "), or omit Part to take all cells"
                              : ""));
      for (const Element &cell : cells)
        if (dim == 3 && cell.n != 4 && cell.n != 8)
          fail("has a " + std::string(cell.n == 6 ? "wedge" : "pyramid") + ", cell " + std::to_string(cell.number),
               "mesh with tetrahedra or hexahedra alone");
    }

    /// @param n elements of the file, by dimension.
    template <int dim>
    void Extraction<dim>::check_kinds(const std::array<std::size_t, 4> &n) const
    {
      if (dim == 2 && n[3] > 0)
        fail("is three-dimensional, it has " + std::to_string(n[3]) + " cells with a volume",
             "give a plane mesh of triangles and quadrilaterals: gmsh -2 part.geo");
      if (dim == 2 && n[2] == 0)
        fail("has no cells, only " + std::to_string(n[1]) + " lines and " + std::to_string(n[0]) + " points",
             "mesh the surfaces, and if physical names are used, name them too: Physical Surface(\"part\") = {1}; gmsh "
             "-2 part.geo");
      if (dim == 3 && n[3] == 0)
        fail(
          "has no solid cells, only " + std::to_string(n[2]) + " faces" + plane_types() + ", " + std::to_string(n[1]) +
            " lines and " + std::to_string(n[0]) + " points",
          "mesh the volumes, and if physical names are used, name them too: Physical Volume(\"part\") = {1}; gmsh -3 "
          "part.geo; or set Dimension = 2");
    }

    template <int dim>
    void Extraction<dim>::check_plane()
    {
      if (dim == 3)
        return;
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

    template <int dim>
    void Extraction<dim>::fail_inverted(const std::vector<unsigned int> &inverted,
                                        const std::string               &how,
                                        const std::string               &remedy) const
    {
      std::string some;
      for (unsigned int k = 0; k < inverted.size() && k < named_cells; ++k)
        some += (k > 0 ? ", " : "") + cell_text(cells[inverted[k]]);
      fail("has " + std::to_string(inverted.size()) + " of " + std::to_string(cells.size()) + " cells " + how + ": " +
             some + (inverted.size() > named_cells ? ", ..." : ""),
           remedy);
    }

    /// Cells with positive Jacobians at all corners.
    template <int dim>
    void Extraction<dim>::check_shapes_of_solids()
    {
      // at every corner the nodes along three edges, right-handed
      constexpr std::array<std::array<unsigned int, 3>, 4> of_tetrahedron = {
        {{{1, 2, 3}}, {{2, 0, 3}}, {{0, 1, 3}}, {{0, 2, 1}}}};
      constexpr std::array<std::array<unsigned int, 3>, 8> of_hexahedron = {
        {{{1, 3, 4}}, {{2, 0, 5}}, {{3, 1, 6}}, {{0, 2, 7}}, {{7, 5, 0}}, {{4, 6, 1}}, {{5, 7, 2}}, {{6, 4, 3}}}};
      std::vector<unsigned int> inverted;
      for (unsigned int c = 0; c < cells.size(); ++c)
        {
          const Element &cell  = cells[c];
          unsigned int   right = 0, left = 0;
          for (unsigned int k = 0; k < cell.n; ++k)
            {
              const auto                         &ends = cell.n == 4 ? of_tetrahedron[k] : of_hexahedron[k];
              std::array<dealii::Tensor<1, 3>, 3> edge;
              for (unsigned int d = 0; d < 3; ++d)
                edge[d] = file.nodes[cell.corners[ends[d]]] - file.nodes[cell.corners[k]];
              const double volume = cross_product_3d(edge[0], edge[1]) * edge[2];
              const double scale  = edge[0].norm() * edge[1].norm() * edge[2].norm();
              right += volume > least_sine * scale;
              left += volume < -least_sine * scale;
            }
          if (right != cell.n && left != cell.n)
            fail(std::string("has a degenerate cell: ") + cell_text(cell) +
                   (left > 0 && right > 0 ? " is turned inside out at some of its corners"
                                          : " has no volume at a corner"),
                 "mesh again, or repair the geometry there (doubled or nearly equal points)");
          if (left > 0)
            inverted.push_back(c);
        }
      if (!inverted.empty() && inverted.size() < cells.size())
        fail_inverted(inverted, "turned inside out", "give all cells the same orientation");
      for (const unsigned int c : inverted) // all of them
        if (auto &v = cells[c].corners; cells[c].n == 4)
          std::swap(v[0], v[1]);
        else
          std::swap_ranges(v.begin(), v.begin() + 4, v.begin() + 4);
    }

    /// Cells counterclockwise, with angles of (0, 180) degrees.
    template <int dim>
    void Extraction<dim>::check_shapes()
    {
      if (dim == 3)
        return check_shapes_of_solids();
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
        fail_inverted(
          clockwise,
          "with clockwise orientation",
          "give all cells the same orientation (in Gmsh: Recombine after Coherence, or ReverseMesh on the surface)");
      for (const unsigned int c : clockwise) // all of them
        std::reverse(cells[c].corners.begin(), cells[c].corners.begin() + cells[c].n);
    }

    template <int dim>
    void Extraction<dim>::add_cells()
    {
      const auto vertex = [this](const unsigned int node) {
        const auto [found, is_new] = vertex_of_node.emplace(node, mesh.piece.vertices.size());
        if (is_new)
          {
            mesh.piece.vertices.emplace_back();
            for (unsigned int d = 0; d < dim; ++d)
              mesh.piece.vertices.back()[d] = body.scale * file.nodes[node][d];
          }
        return found->second;
      };
      for (const Element &cell : cells)
        mesh.piece.cells.push_back(cell_of(cell, vertex));
      mesh.piece.global_vertices.resize(mesh.piece.vertices.size());
      std::iota(mesh.piece.global_vertices.begin(), mesh.piece.global_vertices.end(), GlobalVertex(0));
    }

    template <int dim>
    void Extraction<dim>::check_faces()
    {
      const auto faces = faces_with_cells(mesh.piece);
      for (const auto &[face, c] : faces)
        if (++n_cells_at[face] > 2)
          fail(std::string("has ") + (dim == 2 ? "an edge" : "a face") + " of three cells, one of them " +
                 cell_text(cells[c]),
               remedy_of_overlap);
      // neighbours lie on the two sides of their face, unless one is folded onto the other
      for (std::size_t k = 1; k < faces.size(); ++k)
        if (const auto &[face, c] = faces[k];
            faces[k - 1].first == face && is_behind(face, c) == is_behind(face, faces[k - 1].second))
          fail("has cells on top of each other: " + cell_text(cells[faces[k - 1].second]) + " and " +
                 cell_text(cells[c]) + " lie on the same side of their " + Words<dim>::face,
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
        if (line.dim == dim - 1)
          if (const auto face = face_of(line))
            if (const auto found = names.find(*face); found != names.end())
              for (const int physical : file.groups[line.group])
                found->second.insert(file.name_of(dim - 1, physical));

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
      std::vector<Face> faces_of_cells; // of the whole file, by nodes; made when needed
      const auto        is_face_of_cell = [&](const Element &line) {
        if (faces_of_cells.empty())
          {
            for (const Element &element : file.elements)
              if (element.dim == dim && (dim == 2 || element.n == 4 || element.n == 8))
                {
                  const auto cell = cell_of(element, [](const unsigned int node) { return node; });
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
      std::map<std::string, std::pair<unsigned int, std::string>> left_out; // how many, the first one
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
                problem = "its node at " + point_text(file.nodes[node], dim) +
                          (dim == 2 ? " is not an end of an edge of the outline between two nodes of the set"
                                    : " is not a corner of a face of the outline all of whose corners are in the set");
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
              mesh.ambiguous_points[name] = "there are several, one at " + point_text(file.nodes[node], dim);
    }

    template <int dim>
    void Extraction<dim>::check_conformity()
    {
      if constexpr (dim == 3)
        check_twin_nodes();
      else
        {
          const auto fault = find_fault(mesh.piece, named_faces);
          if (!fault)
            return;
          const std::string place = point_text(fault->place / body.scale, dim);
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
    }

    /// Boundary nodes at one place, unless all faces there have names: a slit that is meant.
    template <int dim>
    void Extraction<dim>::check_twin_nodes()
    {
      std::set<unsigned int> outline, unnamed; // vertices
      for (const auto &face : mesh.piece.boundary_faces)
        for (const unsigned int v : face.vertices)
          if (v != MeshPiece<dim>::no_vertex)
            {
              outline.insert(v);
              if (face.id == 0)
                unnamed.insert(v);
            }
      const auto                     &x = mesh.piece.vertices;
      const std::vector<unsigned int> all(outline.begin(), outline.end());
      dealii::Point<dim>              low = x[all[0]], high = low;
      for (const unsigned int v : all)
        for (unsigned int d = 0; d < dim; ++d)
          {
            low[d]  = std::min(low[d], x[v][d]);
            high[d] = std::max(high[d], x[v][d]);
          }
      const double tolerance = same_place * low.distance(high);
      auto         by_x      = all;
      std::sort(by_x.begin(), by_x.end(), [&](const unsigned int a, const unsigned int b) {
        return x[a][0] < x[b][0];
      });
      for (std::size_t i = 0; i < by_x.size(); ++i)
        for (std::size_t k = i + 1; k < by_x.size() && x[by_x[k]][0] - x[by_x[i]][0] <= tolerance; ++k)
          if (x[by_x[i]].distance(x[by_x[k]]) <= tolerance &&
              (unnamed.count(by_x[i]) > 0 || unnamed.count(by_x[k]) > 0))
            fail(
              "has two nodes at " + point_text(x[by_x[i]] / body.scale, dim) + " that are not joined",
              "join the nodes (in Gmsh: Coherence before, Coherence Mesh after meshing); where a slit is meant, give "
              "the faces on both its sides physical names");
    }

    template <int dim>
    void Extraction<dim>::keep_middles()
    {
      if (file.middles.empty())
        return;
      std::vector<unsigned int> node_of_vertex(vertex_of_node.size());
      for (const auto &[node, vertex] : vertex_of_node)
        node_of_vertex[vertex] = node;
      const auto place = [&](const unsigned int node) {
        dealii::Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = body.scale * file.nodes[node][d];
        return x;
      };
      for (const auto &face : mesh.piece.boundary_faces)
        if constexpr (dim == 3)
          {
            std::array<unsigned int, 4> nodes;
            nodes.fill(MeshPiece<dim>::no_vertex);
            for (unsigned int a = 0; a < nodes.size() && face.vertices[a] != MeshPiece<dim>::no_vertex; ++a)
              {
                nodes[a] = node_of_vertex[face.vertices[a]];
                for (unsigned int b = 0; b < a; ++b) // diagonals have none
                  if (const auto found = file.middles.find(std::minmax({nodes[a], nodes[b]}));
                      found != file.middles.end())
                    {
                      const auto ends = std::minmax({face.vertices[a], face.vertices[b]});
                      mesh.piece.line_middles[{{ends.first, ends.second}}] = place(found->second);
                    }
              }
            std::sort(nodes.begin(), nodes.end());
            if (const auto found = file.middles_of_faces.find(nodes); found != file.middles_of_faces.end())
              mesh.middles[face.vertices] = place(found->second);
          }
        else
          {
            const auto ends  = std::minmax(node_of_vertex[face.vertices[0]], node_of_vertex[face.vertices[1]]);
            const auto found = file.middles.find({ends.first, ends.second});
            if (found != file.middles.end())
              mesh.middles[face.vertices] = place(found->second);
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
           std::string("declare a body for every piece (") + Words<dim>::physical +
             " in the mesh, Part in the scene), or join them (in Gmsh: Coherence)");
    }
  } // namespace

  template <int dim>
  BodyMesh<dim> body_from_file(const scene::Body<dim> &body, const MeshFile &file)
  {
    return Extraction<dim>(body, file).run();
  }

  template BodyMesh<2> body_from_file(const scene::Body<2> &, const MeshFile &);
  template BodyMesh<3> body_from_file(const scene::Body<3> &, const MeshFile &);
} // namespace slipstick::mesh
