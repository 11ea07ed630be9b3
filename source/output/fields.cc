#include <slipstick/base/collective.h>
#include <slipstick/base/log.h>
#include <slipstick/mechanics/elasticity.h>
#include <slipstick/output/fields.h>

#include <deal.II/base/data_out_base.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <zlib.h>

namespace slipstick::output
{
  namespace
  {
    /// Number types of .vtu arrays and VTK's names for them.
    template <class Number>
    constexpr const char *vtk_type = nullptr;
    template <>
    constexpr const char *vtk_type<float> = "Float32";
    template <>
    constexpr const char *vtk_type<std::int32_t> = "Int32";
    template <>
    constexpr const char *vtk_type<std::uint8_t> = "UInt8";

    /// A field: values of all nodes or cells in order.
    struct Field
    {
      std::string        name;
      unsigned int       n_components;
      std::vector<float> values;
    };

    /// Contents of a .vtu. Nodes are shared by cells.
    struct Grid
    {
      std::vector<float>        points; // x, y, z
      std::vector<std::int32_t> connectivity, offsets;
      std::vector<std::uint8_t> types;
      std::vector<Field>        nodal, of_cells;
    };

    constexpr std::uint8_t vtk_triangle = 5, vtk_quadrilateral = 9, vtk_tetrahedron = 10, vtk_hexahedron = 12;

    /// A hexahedron of degree 2 is drawn as eight hexahedra between its nodes.
    template <int dim>
    std::vector<std::vector<unsigned int>> parts_of_hexahedron(const dealii::FiniteElement<dim> &scalar)
    {
      std::array<unsigned int, 27> at{}; // by position on a lattice of three nodes per direction
      for (unsigned int i = 0; i < scalar.n_dofs_per_cell(); ++i)
        {
          unsigned int place = 0;
          for (unsigned int d = dim; d-- > 0;)
            place = 3 * place + static_cast<unsigned int>(std::lround(2 * scalar.unit_support_point(i)[d]));
          at[place] = i;
        }
      std::vector<std::vector<unsigned int>> parts;
      for (const unsigned int first : {0, 1, 3, 4, 9, 10, 12, 13})
        {
          parts.emplace_back();
          for (const unsigned int corner : {0, 1, 4, 3, 9, 10, 13, 12})
            parts.back().push_back(at[first + corner]);
        }
      return parts;
    }

    /// A tetrahedron of degree 2 is drawn as eight: four at its corners and four around an axis of the octahedron
    /// between them.
    template <int dim>
    std::vector<std::vector<unsigned int>> parts_of_tetrahedron(const dealii::FiniteElement<dim> &scalar)
    {
      const auto between = [&](const unsigned int a, const unsigned int b) {
        const auto   middle = (scalar.unit_support_point(a) + scalar.unit_support_point(b)) / 2.;
        unsigned int i      = dim + 1;
        while (scalar.unit_support_point(i).distance(dealii::Point<dim>(middle)) > 0.1)
          ++i;
        return i;
      };
      const unsigned int a = between(0, 1), b = between(1, 2), c = between(0, 2), d = between(0, 3), e = between(1, 3),
                         f = between(2, 3);
      return {{0, a, c, d},
              {a, 1, b, e},
              {c, b, 2, f},
              {d, e, f, 3},
              {c, e, a, b},
              {c, e, b, f},
              {c, e, f, d},
              {c, e, d, a}};
    }

    /// Nodes of the linear cells that represent a cell, counterclockwise; for degree 2 four cells, in space eight, with
    /// the nodes on its edges.
    template <int dim>
    std::vector<std::vector<unsigned int>> parts_of_cell(const mechanics::Element<dim> &element)
    {
      const bool is_simplex = element.cell.is_simplex(), is_linear = element.degree == 1;
      if constexpr (dim == 3)
        {
          if (!is_linear)
            return is_simplex ? parts_of_tetrahedron(*element.scalar) : parts_of_hexahedron(*element.scalar);
          if (is_simplex)
            return {{0, 1, 2, 3}};
          return {{0, 1, 3, 2, 4, 5, 7, 6}}; // its back face, then its front face
        }
      if (is_simplex)
        return is_linear ? std::vector<std::vector<unsigned int>>{{0, 1, 2}}
                         : std::vector<std::vector<unsigned int>>{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
      return is_linear ? std::vector<std::vector<unsigned int>>{{0, 1, 3, 2}}
                       : std::vector<std::vector<unsigned int>>{{0, 6, 8, 4}, {6, 1, 5, 8}, {4, 8, 7, 2}, {8, 5, 3, 7}};
    }

    /// Positions and cells of a subdomain, and the cellwise constant fields.
    template <int dim>
    Grid grid_of(const mesh::Mesh<dim>            &mesh,
                 const mechanics::Spaces<dim>     &spaces,
                 const unsigned int                p,
                 const mechanics::SubdomainStress &stress)
    {
      const auto                                  &subdomain   = *mesh.subdomains[p];
      const auto                                  &dof_handler = *spaces.dof_handlers[p];
      const auto                                  &element     = spaces.of(p);
      const auto                                   parts       = parts_of_cell(element);
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;
      std::vector<float>                           error;
      Grid                                         grid;
      grid.points.resize(3 * dof_handler.n_dofs() / dim, 0.f);
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          element.nodes_of(cell, dofs, nodes);
          for (unsigned int i = 0; i < nodes.size(); ++i)
            {
              const dealii::Point<dim> x =
                i < cell->n_vertices()
                  ? cell->vertex(i)
                  : element.mapping->transform_unit_to_real_cell(cell, element.scalar->unit_support_point(i));
              for (unsigned int c = 0; c < dim; ++c)
                grid.points[3 * nodes[i] + c] = x[c];
            }
          for (const auto &part : parts)
            {
              for (const unsigned int i : part)
                grid.connectivity.push_back(nodes[i]);
              grid.offsets.push_back(grid.connectivity.size());
              grid.types.push_back(dim == 3 ? (part.size() == 4 ? vtk_tetrahedron : vtk_hexahedron)
                                            : (part.size() == 3 ? vtk_triangle : vtk_quadrilateral));
              error.push_back(stress.error[cell->active_cell_index()]);
            }
        }
      const auto constant = [&grid](const unsigned int value) {
        return std::vector<float>(grid.types.size(), static_cast<float>(value));
      };
      grid.of_cells = {{"body", 1, constant(subdomain.body)},
                       {"subdomain", 1, constant(subdomain.subdomain)},
                       {"rank", 1, constant(mesh.rank_of_subdomain(subdomain.subdomain))},
                       {"error_estimate", 1, std::move(error)}};
      return grid;
    }

    /// Computes the output fields from displacement and stress components.
    /// @param stress nodes x 4: xx, yy, xy, zz [MPa]; for bodies of revolution zz is the hoop stress. In space nodes x
    /// 6: also xz, yz.
    template <int dim>
    std::vector<Field> nodal_fields(const Eigen::VectorXd &u, const Eigen::MatrixXd &stress, const bool has_hoop_stress)
    {
      std::vector<Field> fields = {{"displacement", 3, {}},
                                   {"stress", 9, {}},
                                   {"stress_zz", 1, {}},
                                   {"von_mises", 1, {}},
                                   {"principal_stress_1", 1, {}},
                                   {"principal_stress_2", 1, {}}};
      if (has_hoop_stress)
        fields.push_back({"hoop_stress", 1, {}});
      if (dim == 3)
        fields.push_back({"principal_stress_3", 1, {}});
      for (Field &field : fields)
        field.values.reserve(field.n_components * stress.rows());
      const auto add = [&fields](const unsigned int field, const std::initializer_list<double> values) {
        for (const double value : values)
          fields[field].values.push_back(static_cast<float>(value));
      };
      for (unsigned int node = 0; node < stress.rows(); ++node)
        {
          const double xx = stress(node, 0), yy = stress(node, 1), xy = stress(node, 2), zz = stress(node, 3);
          if constexpr (dim == 3)
            {
              const double                    xz = stress(node, 4), yz = stress(node, 5);
              dealii::SymmetricTensor<2, dim> tensor;
              tensor[0][0] = xx, tensor[1][1] = yy, tensor[2][2] = zz;
              tensor[0][1] = xy, tensor[0][2] = xz, tensor[1][2] = yz;
              const auto principal = dealii::eigenvalues(tensor); // in descending order
              add(0, {u[3 * node], u[3 * node + 1], u[3 * node + 2]});
              add(1, {xx, xy, xz, xy, yy, yz, xz, yz, zz});
              add(2, {zz});
              add(3, {mechanics::von_mises(xx, yy, xy, zz, xz, yz)});
              for (unsigned int k = 0; k < dim; ++k)
                add(4 + k, {principal[k]});
              continue;
            }
          const double mean = (xx + yy) / 2, radius = std::hypot((xx - yy) / 2, xy);
          add(0, {u[2 * node], u[2 * node + 1], 0.});
          add(1, {xx, xy, 0., xy, yy, 0., 0., 0., zz});
          add(2, {zz});
          add(3, {mechanics::von_mises(xx, yy, xy, zz)});
          add(4, {mean + radius});
          add(5, {mean - radius});
          if (has_hoop_stress)
            add(6, {zz});
        }
      return fields;
    }

    /// Compresses with zlib at its highest speed. The window, which zlib allocates and clears for every array, is no
    /// larger than the array: this gives the same output in a third of the time for arrays of a few kB.
    std::vector<unsigned char> compressed(const void *data, const std::size_t n_bytes)
    {
      constexpr int         smallest_window = 9, largest_window = 15; // powers of 2 [bytes], the limits of zlib
      constexpr std::size_t lookahead    = 262;                       // of zlib, after the contents of a window
      constexpr int         memory_level = 8;                         // default of zlib
      int                   window       = smallest_window;
      while (window < largest_window && (std::size_t(1) << window) < n_bytes + lookahead)
        ++window;
      z_stream stream{};
      AssertThrow(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, window, memory_level, Z_DEFAULT_STRATEGY) == Z_OK,
                  dealii::ExcMessage("zlib failed"));
      std::vector<unsigned char> block(deflateBound(&stream, n_bytes));
      stream.next_in    = static_cast<Bytef *>(const_cast<void *>(data));
      stream.avail_in   = static_cast<uInt>(n_bytes);
      stream.next_out   = block.data();
      stream.avail_out  = static_cast<uInt>(block.size());
      const int  status = deflate(&stream, Z_FINISH);
      const auto length = stream.total_out;
      deflateEnd(&stream);
      AssertThrow(status == Z_STREAM_END, dealii::ExcMessage("zlib failed"));
      block.resize(length);
      return block;
    }

    /// Base 64 of RFC 4648 (deal.II's, based on Boost iterators, took 2 % of a run with 10 000 subdomains).
    void write_base64(std::ostream &out, const unsigned char *bytes, const std::size_t n_bytes)
    {
      constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
      std::string    text((n_bytes + 2) / 3 * 4, '=');
      char          *next = text.data();
      for (std::size_t i = 0; i < n_bytes; i += 3)
        {
          const std::size_t   n     = std::min<std::size_t>(3, n_bytes - i); // bytes of this group
          const std::uint32_t group = bytes[i] << 16 | (n > 1 ? bytes[i + 1] << 8 : 0) | (n > 2 ? bytes[i + 2] : 0);
          for (std::size_t k = 0; k <= n; ++k)
            next[k] = digits[group >> (18 - 6 * k) & 63];
          next += 4;
        }
      out.write(text.data(), text.size());
    }

    /// Writes one compressed block as text: number of blocks, their size, size of the last, compressed size; the block.
    template <class Number>
    void write_array(std::ostream              &out,
                     const std::string         &name,
                     const unsigned int         n_components,
                     const std::vector<Number> &values)
    {
      const auto                         n_bytes = values.size() * sizeof(Number);
      const std::vector<unsigned char>   block   = compressed(values.data(), n_bytes);
      const std::array<std::uint32_t, 4> numbers{{1,
                                                  static_cast<std::uint32_t>(n_bytes),
                                                  static_cast<std::uint32_t>(n_bytes),
                                                  static_cast<std::uint32_t>(block.size())}};
      out << "<DataArray type=\"" << vtk_type<Number> << '"';
      if (!name.empty())
        out << " Name=\"" << name << '"';
      if (n_components > 1)
        out << " NumberOfComponents=\"" << n_components << '"';
      out << " format=\"binary\">\n";
      write_base64(out, reinterpret_cast<const unsigned char *>(numbers.data()), sizeof(numbers));
      write_base64(out, block.data(), block.size());
      out << "\n</DataArray>\n";
    }

    void write_fields_of(std::ostream &out, const std::string &section, const std::vector<Field> &fields)
    {
      out << '<' << section << ">\n";
      for (const Field &field : fields)
        write_array(out, field.name, field.n_components, field.values);
      out << "</" << section << ">\n";
    }

    constexpr const char *byte_order = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? "LittleEndian" : "BigEndian";

    void write_vtu(std::ostream &out, const Grid &grid)
    {
      out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
             "compressor=\"vtkZLibDataCompressor\" byte_order=\""
          << byte_order << "\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" << grid.points.size() / 3
          << "\" NumberOfCells=\"" << grid.types.size() << "\">\n<Points>\n";
      write_array(out, "", 3, grid.points);
      out << "</Points>\n<Cells>\n";
      write_array(out, "connectivity", 1, grid.connectivity);
      write_array(out, "offsets", 1, grid.offsets);
      write_array(out, "types", 1, grid.types);
      out << "</Cells>\n";
      write_fields_of(out, "PointData", grid.nodal);
      write_fields_of(out, "CellData", grid.of_cells);
      out << "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    }

    /// Writes the file that combines all subdomains; all have the same fields.
    void write_pvtu(std::ostream &out, const Grid &grid, const std::vector<std::string> &pieces)
    {
      const auto declare = [&out](const std::string &section, const std::vector<Field> &fields) {
        out << '<' << section << ">\n";
        for (const Field &field : fields)
          out << "<PDataArray type=\"Float32\" Name=\"" << field.name << "\" NumberOfComponents=\""
              << field.n_components << "\"/>\n";
        out << "</" << section << ">\n";
      };
      out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\" byte_order=\"" << byte_order
          << "\">\n<PUnstructuredGrid GhostLevel=\"0\">\n";
      declare("PPointData", grid.nodal);
      declare("PCellData", grid.of_cells);
      out << "<PPoints>\n<PDataArray type=\"Float32\" NumberOfComponents=\"3\"/>\n</PPoints>\n";
      for (const std::string &piece : pieces)
        out << "<Piece Source=\"" << piece << "\"/>\n";
      out << "</PUnstructuredGrid>\n</VTKFile>\n";
    }

    std::string vtu_name(const unsigned int step, const unsigned int subdomain)
    {
      return format("subdomain_%03u_%04u.vtu", step, subdomain);
    }

    std::string pvtu_name(const unsigned int step)
    {
      return format("solution_%03u.pvtu", step);
    }

    /// Writes one .vtu; for the first subdomain also the .pvtu, which has the same fields.
    template <int dim>
    void write_subdomain(const OutputDirectory            &directory,
                         const mesh::Mesh<dim>            &mesh,
                         const mechanics::Spaces<dim>     &spaces,
                         const unsigned int                p,
                         const Eigen::VectorXd            &u,
                         const mechanics::SubdomainStress &stress,
                         const bool                        has_hoop_stress,
                         const unsigned int                step)
    {
      const unsigned int subdomain = mesh.subdomains[p]->subdomain;
      Grid               grid      = grid_of(mesh, spaces, p, stress);
      grid.nodal                   = nodal_fields<dim>(u, stress.nodal, has_hoop_stress);
      directory.write(vtu_name(step, subdomain), [&](std::ostream &out) { write_vtu(out, grid); });
      if (subdomain == 0)
        directory.write(pvtu_name(step), [&](std::ostream &out) {
          std::vector<std::string> names;
          for (unsigned int s = 0; s < mesh.n_subdomains(); ++s)
            names.push_back(vtu_name(step, s));
          write_pvtu(out, grid, names);
        });
    }
  } // namespace

  template <int dim>
  void write_fields(const OutputDirectory              &directory,
                    const mesh::Mesh<dim>              &mesh,
                    const mechanics::Spaces<dim>       &spaces,
                    const std::vector<Eigen::VectorXd> &u,
                    const mechanics::StressResult      &stress,
                    const unsigned int                  step)
  {
    collectively(mesh.comm, [&] {
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        write_subdomain(directory, mesh, spaces, p, u[p], stress.subdomains[p], stress.has_hoop_stress, step);
    });
  }

  void write_pvd(const OutputDirectory &directory, const std::vector<double> &load_factors)
  {
    directory.write_from_root("solution.pvd", [&](std::ostream &out) {
      std::vector<std::pair<double, std::string>> records;
      for (unsigned int step = 0; step < load_factors.size(); ++step)
        records.emplace_back(load_factors[step], pvtu_name(step));
      dealii::DataOutBase::write_pvd_record(out, records);
    });
  }

  template void write_fields(const OutputDirectory &,
                             const mesh::Mesh<2> &,
                             const mechanics::Spaces<2> &,
                             const std::vector<Eigen::VectorXd> &,
                             const mechanics::StressResult &,
                             const unsigned int);
  template void write_fields(const OutputDirectory &,
                             const mesh::Mesh<3> &,
                             const mechanics::Spaces<3> &,
                             const std::vector<Eigen::VectorXd> &,
                             const mechanics::StressResult &,
                             const unsigned int);
} // namespace slipstick::output
