#include <slipstick/output/contact_line.h>
#include <slipstick/output/csv.h>

#include <deal.II/base/data_out_base.h>
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <ostream>
#include <tuple>

namespace slipstick::output
{
  namespace
  {
    using contact::ContactNode;

    std::vector<ContactNode> along_the_arc(std::vector<ContactNode> nodes)
    {
      std::stable_sort(nodes.begin(), nodes.end(), [](const ContactNode &a, const ContactNode &b) {
        return std::tie(a.pair, a.arc_length) < std::tie(b.pair, b.arc_length);
      });
      return nodes;
    }

    void write_row(std::ostream &out, const ContactNames &names, const unsigned int step, const ContactNode &node)
    {
      AssertIndexRange(node.pair, names.pairs.size());
      AssertIndexRange(node.pair, names.slave_bodies.size());
      out << csv_field(names.pairs[node.pair]) << ',' << csv_field(names.slave_bodies[node.pair]);
      for (const double value : {node.position[0],
                                 node.position[1],
                                 node.arc_length,
                                 node.gap,
                                 node.pressure,
                                 node.tangential_traction,
                                 node.slip})
        out << ',' << to_text(value);
      out << ',' << contact::to_string(node.status) << ',' << step << ',' << to_text(node.slip_bound) << ','
          << to_text(node.total_slip);
      if (names.dimension == 3)
        {
          out << ',' << to_text(node.position[2]) << ',' << to_text(node.area);
          for (const auto *vector : {&node.normal, &node.traction, &node.slip_vector})
            for (const double value : *vector)
              out << ',' << to_text(value);
        }
      out << ',' << to_text(node.initial_gap) << '\n';
    }

    bool is_little_endian()
    {
      const std::uint16_t one = 1;
      unsigned char       first;
      std::memcpy(&first, &one, 1);
      return first == 1;
    }

    const char *vtk_name(const double)
    {
      return "Float64";
    }

    const char *vtk_name(const std::int64_t)
    {
      return "Int64";
    }

    // A DataArray in base64: the number of bytes as UInt64, then the values. Exact; values that are not finite are
    // allowed.
    template <typename Number>
    void write_array(std::ostream              &out,
                     const std::string         &name,
                     const std::vector<Number> &values,
                     const unsigned int         n_components = 1)
    {
      const std::uint64_t        n_bytes = values.size() * sizeof(Number);
      std::vector<unsigned char> bytes(sizeof(n_bytes) + n_bytes);
      std::memcpy(bytes.data(), &n_bytes, sizeof(n_bytes));
      if (n_bytes > 0)
        std::memcpy(bytes.data() + sizeof(n_bytes), values.data(), n_bytes);
      out << "<DataArray type=\"" << vtk_name(Number()) << "\" Name=\"" << name << "\" NumberOfComponents=\""
          << n_components << "\" format=\"binary\">" << dealii::Utilities::encode_base64(bytes) << "</DataArray>\n";
    }

    template <typename Value>
    void write_scalar(std::ostream                   &out,
                      const std::string              &name,
                      const std::vector<ContactNode> &nodes,
                      const Value                    &value)
    {
      std::vector<decltype(value(nodes[0]))> values;
      for (const ContactNode &node : nodes)
        values.push_back(value(node));
      write_array(out, name, values);
    }

    std::vector<double> components(const std::vector<ContactNode> &nodes, std::array<double, 3> ContactNode::*vector)
    {
      std::vector<double> values;
      for (const ContactNode &node : nodes)
        values.insert(values.end(), (node.*vector).begin(), (node.*vector).end());
      return values;
    }

    /// @param displacement x, y, z of each node; empty: unknown.
    void write_point_data(std::ostream                   &out,
                          const std::vector<ContactNode> &nodes,
                          const unsigned int              dim,
                          const std::vector<double>      &displacement)
    {
      out << "<PointData Scalars=\"pressure\">\n";
      write_scalar(out, "pair", nodes, [](const ContactNode &node) { return std::int64_t(node.pair); });
      write_scalar(out, "s", nodes, [](const ContactNode &node) { return node.arc_length; });
      write_scalar(out, "area", nodes, [](const ContactNode &node) { return node.area; });
      write_scalar(out, "gap", nodes, [](const ContactNode &node) { return node.gap; });
      write_scalar(out, "initial_gap", nodes, [](const ContactNode &node) { return node.initial_gap; });
      write_scalar(out, "pressure", nodes, [](const ContactNode &node) { return node.pressure; });
      write_scalar(out, "tangential_traction", nodes, [](const ContactNode &node) { return node.tangential_traction; });
      write_scalar(out, "slip_bound", nodes, [](const ContactNode &node) { return node.slip_bound; });
      write_scalar(out, "slip", nodes, [](const ContactNode &node) { return node.slip; });
      write_scalar(out, "total_slip", nodes, [](const ContactNode &node) { return node.total_slip; });
      write_scalar(out, "status", nodes, [](const ContactNode &node) {
        return static_cast<std::int64_t>(node.status);
      });
      write_array(out, "normal", components(nodes, &ContactNode::normal), 3);
      if (!displacement.empty())
        write_array(out, "displacement", displacement, 3);
      if (dim == 3)
        {
          write_array(out, "tangential_traction_vector", components(nodes, &ContactNode::traction), 3);
          write_array(out, "slip_vector", components(nodes, &ContactNode::slip_vector), 3);
        }
      out << "</PointData>\n";
    }

    // Cells of a PolyData: node numbers of all cells, and the offset of the end of each cell.
    struct Cells
    {
      std::vector<std::int64_t> connectivity;
      std::vector<std::int64_t> offsets;
    };

    void write_cells(std::ostream &out, const std::string &kind, const Cells &cells)
    {
      if (cells.offsets.empty())
        return;
      out << "<" << kind << ">\n";
      write_array(out, "connectivity", cells.connectivity);
      write_array(out, "offsets", cells.offsets);
      out << "</" << kind << ">\n";
    }

    /// Adds a line along the arc of every pair, or a vertex for a pair with one node.
    void add_lines(const std::vector<ContactNode> &nodes, Cells &lines, Cells &vertices)
    {
      for (auto first = nodes.begin(); first != nodes.end();)
        {
          const auto last =
            std::find_if(first, nodes.end(), [&](const ContactNode &node) { return node.pair != first->pair; });
          Cells &cells = last - first > 1 ? lines : vertices;
          for (auto node = first; node != last; ++node)
            cells.connectivity.push_back(node - nodes.begin());
          cells.offsets.push_back(cells.connectivity.size());
          first = last;
        }
    }

    /// Adds the faces, and a vertex for every node without a face.
    void add_faces(const ContactStep &step, Cells &polygons, Cells &vertices)
    {
      std::vector<bool> is_on_face(step.nodes.size());
      for (const auto &face : step.faces)
        {
          for (const std::int64_t i : face)
            {
              polygons.connectivity.push_back(i);
              is_on_face[i] = true;
            }
          polygons.offsets.push_back(polygons.connectivity.size());
        }
      for (std::size_t i = 0; i < is_on_face.size(); ++i)
        if (!is_on_face[i])
          {
            vertices.connectivity.push_back(i);
            vertices.offsets.push_back(vertices.connectivity.size());
          }
    }

    /// Values in the order of along_the_arc().
    std::vector<double> along_the_arc(const std::vector<ContactNode>           &nodes,
                                      const std::vector<std::array<double, 3>> &vectors)
    {
      std::vector<std::size_t> order(nodes.size());
      std::iota(order.begin(), order.end(), 0);
      std::stable_sort(order.begin(), order.end(), [&nodes](const std::size_t a, const std::size_t b) {
        return std::tie(nodes[a].pair, nodes[a].arc_length) < std::tie(nodes[b].pair, nodes[b].arc_length);
      });
      std::vector<double> values;
      for (const std::size_t k : order)
        values.insert(values.end(), vectors[k].begin(), vectors[k].end());
      return values;
    }

    std::string vtp_name(const unsigned int step)
    {
      return "contact_" + dealii::Utilities::int_to_string(step, 3) + ".vtp";
    }

    void write_polydata(std::ostream                             &out,
                        const ContactStep                        &step,
                        const unsigned int                        dim,
                        const std::vector<std::array<double, 3>> &displacement)
    {
      const auto nodes = dim == 2 ? along_the_arc(step.nodes) : step.nodes;
      Cells      lines, vertices, polygons;
      if (dim == 2)
        add_lines(nodes, lines, vertices);
      else
        add_faces(step, polygons, vertices);
      out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\""
          << (is_little_endian() ? "LittleEndian" : "BigEndian") << "\" header_type=\"UInt64\">\n<PolyData>\n"
          << "<Piece NumberOfPoints=\"" << nodes.size() << "\" NumberOfVerts=\"" << vertices.offsets.size()
          << "\" NumberOfLines=\"" << lines.offsets.size() << "\" NumberOfStrips=\"0\" NumberOfPolys=\""
          << polygons.offsets.size() << "\">\n";
      write_point_data(out,
                       nodes,
                       dim,
                       displacement.empty() ? std::vector<double>() : along_the_arc(step.nodes, displacement));
      out << "<Points>\n";
      write_array(out, "Points", components(nodes, &ContactNode::position), 3);
      out << "</Points>\n";
      write_cells(out, "Verts", vertices);
      write_cells(out, "Lines", lines);
      write_cells(out, "Polys", polygons);
      out << "</Piece>\n</PolyData>\n</VTKFile>\n";
    }
  } // namespace

  void write_contact_csv(const OutputDirectory          &directory,
                         const ContactNames             &names,
                         const std::vector<ContactStep> &steps)
  {
    directory.write_from_root("contact.csv", [&](std::ostream &out) {
      out << "pair,slave body,x,y,s,gap,pressure,tangential_traction,slip,status,step,slip_bound,total_slip"
          << (names.dimension == 3
                ? ",z,area,normal_x,normal_y,normal_z,traction_x,traction_y,traction_z,slip_x,slip_y,slip_z"
                : "")
          << ",initial_gap\n";
      for (const ContactStep &step : steps)
        for (const ContactNode &node : along_the_arc(step.nodes))
          write_row(out, names, step.step, node);
    });
  }

  void write_contact_vtp(const OutputDirectory                    &directory,
                         const ContactStep                        &step,
                         const unsigned int                        dim,
                         const std::vector<std::array<double, 3>> &displacement)
  {
    directory.write_from_root(vtp_name(step.step),
                              [&](std::ostream &out) { write_polydata(out, step, dim, displacement); });
  }

  void write_contact_pvd(const OutputDirectory &directory, const std::vector<double> &load_factors)
  {
    directory.write_from_root("contact.pvd", [&](std::ostream &out) {
      std::vector<std::pair<double, std::string>> records;
      for (unsigned int step = 0; step < load_factors.size(); ++step)
        records.emplace_back(load_factors[step], vtp_name(step));
      dealii::DataOutBase::write_pvd_record(out, records);
    });
  }
} // namespace slipstick::output
