#include <slipstick/base/disjoint_sets.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/body_mesh.h>
#include <slipstick/mesh/conformity.h>
#include <slipstick/mesh/names_of_file.h>
#include <slipstick/mesh/part_of_file.h>

#include <algorithm>
#include <numeric>

namespace slipstick::mesh
{
  namespace
  {
    constexpr unsigned int named_pieces = 3; // maximum number in messages

    const std::string remedy_of_overlap =
      "remove duplicate entities (in Gmsh: Coherence; Coherence Mesh), or choose one Part";

    /// Builds one body from a file.
    template <int dim>
    class Extraction
    {
    public:
      using Face = typename MeshPiece<dim>::Face;

      Extraction(const scene::Body<dim> &body, const MeshFile &file)
        : body(body)
        , file(file)
        , part(body, file)
      {}

      BodyMesh<dim> run()
      {
        mesh.about_names = file.about_names;
        add_cells();
        check_faces();
        const NamesOfFile<dim> names(file, vertex_of_node, n_cells_at);
        names.name_boundaries(mesh, body.name);
        names.name_points(mesh);
        keep_middles();
        check_connected();
        check_conformity();
        if (file.is_curved && mesh.middles.empty() && mesh.piece.line_middles.empty())
          mesh.remarks.push_back("body " + body.name + ": only the corners of the curved cells in " + file.file +
                                 " are used (mid nodes are used for cells of second order only)");
        return std::move(mesh);
      }

    private:
      void add_cells();
      void check_faces();
      void keep_middles();
      void check_connected();
      void check_conformity();

      /// Which of the two sides of the face the cell is on.
      bool is_behind(const Face &face, const unsigned int c) const
      {
        const auto &x    = mesh.piece.vertices;
        const auto &cell = mesh.piece.cells[c];
        if constexpr (dim == 2) // whether the cell runs along the edge in ascending direction
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

      const scene::Body<dim>              &body;
      const MeshFile                      &file;
      PartOfFile<dim>                      part;
      BodyMesh<dim>                        mesh;
      std::map<unsigned int, unsigned int> vertex_of_node;
      std::map<Face, unsigned int>         n_cells_at; // by face
    };

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
      for (const auto &cell : part.cells())
        mesh.piece.cells.push_back(cell_of<dim>(cell, vertex));
      mesh.piece.global_vertices.resize(mesh.piece.vertices.size());
      std::iota(mesh.piece.global_vertices.begin(), mesh.piece.global_vertices.end(), GlobalVertex(0));
    }

    template <int dim>
    void Extraction<dim>::check_faces()
    {
      const auto faces = faces_with_cells(mesh.piece);
      for (const auto &[face, c] : faces)
        if (++n_cells_at[face] > 2)
          part.fail(std::string("has ") + (dim == 2 ? "an edge" : "a face") + " of three cells, one of them " +
                      part.cell_text(c),
                    remedy_of_overlap);
      // neighbours are on opposite sides of their face, unless one is folded onto the other
      for (std::size_t k = 1; k < faces.size(); ++k)
        if (const auto &[face, c] = faces[k];
            faces[k - 1].first == face && is_behind(face, c) == is_behind(face, faces[k - 1].second))
          part.fail("has cells on top of each other: " + part.cell_text(faces[k - 1].second) + " and " +
                      part.cell_text(c) + " lie on the same side of their " + Words<dim>::face,
                    remedy_of_overlap);
    }

    template <int dim>
    void Extraction<dim>::check_conformity()
    {
      const auto fault = find_fault(mesh.piece);
      if (!fault)
        return;
      const std::string place = point_text(fault->place / body.scale, dim);
      const std::string of =
        part.cell_text(fault->first_cell) +
        (fault->first_cell == fault->second_cell ? "" : " and " + part.cell_text(fault->second_cell));
      const std::string remedy =
        std::string(
          "join the nodes (in Gmsh: Coherence before, Coherence Mesh after meshing); where a slit is meant, ") +
        "give the " + Words<dim>::boundary + "s on both its sides physical names";
      switch (fault->kind)
        {
          case ConformityFault<dim>::Kind::overlap:
            part.fail("has cells on top of each other at " + place + ": " + of, remedy_of_overlap);
          case ConformityFault<dim>::Kind::hanging_node:
            part.fail(std::string("has a node inside ") + (dim == 2 ? "an edge" : "an edge or face") + " at " + place +
                        ", which is not joined to it: " + of,
                      remedy);
          case ConformityFault<dim>::Kind::twin_nodes:
            part.fail("has two nodes at " + place + " that are not joined: " + of, remedy);
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
                for (unsigned int b = 0; b < a; ++b) // diagonals have no mid node
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
      DisjointSets connected(mesh.piece.vertices.size());
      for (const auto &cell : mesh.piece.cells)
        for (unsigned int k = 1; k < n_corners<dim>(cell); ++k)
          connected.join(cell[k], cell[0]);
      std::map<unsigned int, unsigned int> first_cell; // by piece
      for (unsigned int c = 0; c < part.cells().size(); ++c)
        first_cell.emplace(connected.root(mesh.piece.cells[c][0]), c);
      if (first_cell.size() == 1)
        return;
      std::string places;
      for (const auto &[piece, c] : first_cell)
        places += (places.empty() ? "" : ", ") + part.cell_text(c);
      if (first_cell.size() > named_pieces)
        places = part.cell_text(first_cell.begin()->second) + ", ...";
      part.fail("gives a body of " + std::to_string(first_cell.size()) + " pieces that share no node: " + places,
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
