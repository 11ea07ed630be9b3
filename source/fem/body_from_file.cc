#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/fem/body_mesh.h>

#include <cmath>
#include <cstdio>
#include <numeric>

namespace slipstick::fem
{
  namespace
  {
    constexpr double       flat_tolerance = 1e-8; // of z, over the size of the body
    constexpr double       least_sine     = 1e-6; // of the angles of a cell
    constexpr unsigned int named_cells    = 3;    // in messages

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
        if (file.is_curved && mesh.middles.empty())
          mesh.remarks.push_back("body " + body.name + ": only the corners of the curved cells in " + file.file +
                                 " are used (mid nodes are kept of cells of second order)");
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

      bool in_part(const Element &cell) const
      {
        if (body.part.empty())
          return true;
        for (const int physical : file.groups[cell.group])
          if (file.name_of(cell.dim, physical) == body.part || std::to_string(physical) == body.part)
            return true;
        return false;
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

      const scene::Body<dim>              &body;
      const MeshFile                      &file;
      BodyMesh<dim>                        mesh;
      std::vector<Element>                 cells;
      std::map<unsigned int, unsigned int> vertex_of_node;
      std::map<Face, unsigned int>         n_cells_at; // by face
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
          if (!in_part(element))
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
               (parts.empty() ? "; name its surfaces (Physical Surface), or leave Part away to take all cells" : ""));
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
      // orientation by the sum of the corners; a cell that crosses itself or is not convex has corners of both kinds
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
                   (left > 0 && right > 0 ? "crosses itself or is not convex"
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
              " cells turned over (clockwise): " + some + (clockwise.size() > named_cells ? ", ..." : ""),
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
      for (const auto &[face, c] : faces_with_cells(mesh.piece))
        if (++n_cells_at[face] > 2)
          fail("has an edge of three cells, one of them " + cell_text(cells[c]),
               "remove what lies on top of each other (in Gmsh: Coherence; Coherence Mesh), or choose one Part");
    }

    /// Lines of the file at the outline carry its names; what is left over is outline without a name.
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

    template <int dim>
    void Extraction<dim>::name_points()
    {
      for (const Element &point : file.elements)
        if (point.dim == 0)
          {
            const auto found = vertex_of_node.find(point.corners[0]);
            if (found != vertex_of_node.end())
              for (const int physical : file.groups[point.group])
                mesh.points.emplace(file.name_of(0, physical), found->second);
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
} // namespace slipstick::fem
