// Gmsh's MSH format, https://gmsh.info/doc/texinfo/gmsh.html, sections "MSH file format" and "... version 2".
#include <slipstick/base/text.h>
#include <slipstick/mesh/gmsh_cursor.h>
#include <slipstick/mesh/gmsh_element.h>
#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/solid_nodes.h>

#include <cmath>
#include <unordered_map>

namespace slipstick::mesh
{
  namespace
  {
    class GmshReader
    {
    public:
      GmshReader(const std::string &file, const std::string &text)
        : in(file, text)
      {
        mesh.file = file;
      }

      MeshFile read();

    private:
      void         read_format();
      void         read_names();
      void         read_entities();
      void         read_nodes();
      void         read_nodes_2();
      void         read_elements();
      void         read_elements_2();
      void         add_node(const std::size_t tag, const double x, const double y, const double z);
      unsigned int group(const std::vector<int> &physicals);
      GmshElement  type_of(const int type);

      /// The element whose node numbers follow.
      template <typename ReadTag>
      void add_element(const GmshElement &type,
                       const unsigned int of_group,
                       const std::size_t  number,
                       const ReadTag     &read_tag);

      GmshCursor                                      in;
      MeshFile                                        mesh;
      bool                                            is_version_2 = false;
      std::unordered_map<std::size_t, unsigned int>   index_of_node;
      std::map<std::vector<int>, unsigned int>        index_of_group;
      std::map<std::pair<int, int>, std::vector<int>> physicals_of_entity; // version 4: by dimension and number
      bool                                            has_nodes = false, has_elements = false;
    };

    void GmshReader::read_format()
    {
      if (in.next_section() != "MeshFormat")
        {
          if (in.section == "NOD" || in.section == "NOE")
            in.fail("has the Gmsh format version 1", "save it as 4.1: gmsh OLD.msh -save -format msh41 -o NEW.msh");
          in.section.clear();
          in.fail("is not a Gmsh file: it does not start with $MeshFormat", "give a .msh file of version 2.2 or 4.1");
        }
      const double version = in.word<double>();
      const int    kind    = in.word<int>();
      const int    size    = in.word<int>();
      is_version_2         = version >= 2 && version < 3;
      if (!is_version_2 && !(version >= 4.1 && version < 4.2))
        in.fail("has version " + number_text(version) + "; versions 2.0 to 2.2 and 4.1 are supported",
                "save it as 4.1: gmsh OLD.msh -save -format msh41 -o NEW.msh");
      if (size != 8 || kind < 0 || kind > 1)
        in.fail_broken();
      in.line();
      if (kind == 1)
        {
          in.binary = true;
          if (in.integer() != 1)
            in.fail("is binary with another byte order, or corrupt",
                    "save it in ASCII: gmsh OLD.msh -save -format msh41 -o NEW.msh");
        }
      in.end_section(false);
    }

    void GmshReader::read_names()
    {
      const auto n = in.word<std::size_t>();
      for (std::size_t k = 0; k < n; ++k)
        {
          const int dim = in.word<int>(), number = in.word<int>();
          mesh.names[{dim, number}] = in.quoted();
        }
      in.end_section(false);
    }

    void GmshReader::read_entities()
    {
      std::array<std::size_t, 4> n;
      for (auto &k : n)
        k = in.count();
      for (int dim = 0; dim < 4; ++dim)
        for (std::size_t k = 0; k < n[dim]; ++k)
          {
            const int tag = in.integer();
            for (unsigned int d = 0; d < (dim == 0 ? 3 : 6); ++d)
              in.real(); // bounding box
            auto &physicals = physicals_of_entity[{dim, tag}];
            physicals.resize(in.checked(in.count(), 1));
            for (int &physical : physicals)
              physical = in.physical(in.integer());
            if (dim > 0)
              for (std::size_t b = in.count(); b > 0; --b)
                in.integer();
          }
      in.end_section(false);
    }

    void GmshReader::add_node(const std::size_t tag, const double x, const double y, const double z)
    {
      if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z) ||
          !index_of_node.emplace(tag, mesh.nodes.size()).second)
        in.fail_broken();
      mesh.nodes.emplace_back(x, y, z);
    }

    void GmshReader::read_nodes()
    {
      const std::size_t n_blocks = in.count();
      in.count();
      in.count();
      in.count();
      for (std::size_t b = 0; b < n_blocks; ++b)
        {
          const int dim = in.integer();
          in.integer();
          const bool               parametric = in.integer() != 0;
          std::vector<std::size_t> tags(in.checked(in.count(), 1));
          for (auto &tag : tags)
            tag = in.count();
          for (const auto tag : tags)
            {
              const double x = in.real(), y = in.real(), z = in.real();
              for (int d = 0; d < (parametric ? dim : 0); ++d)
                in.real();
              add_node(tag, x, y, z);
            }
        }
    }

    void GmshReader::read_nodes_2()
    {
      const auto n = in.word<std::size_t>();
      in.line();
      for (std::size_t k = 0; k < n; ++k)
        {
          const int    tag = in.integer();
          const double x = in.real(), y = in.real(), z = in.real();
          add_node(tag, x, y, z);
        }
    }

    unsigned int GmshReader::group(const std::vector<int> &physicals)
    {
      const auto [found, is_new] = index_of_group.emplace(physicals, mesh.groups.size());
      if (is_new)
        mesh.groups.push_back(physicals);
      return found->second;
    }

    GmshElement GmshReader::type_of(const int type)
    {
      const GmshElement result = gmsh_element(type);
      if (result.n_nodes == 0)
        in.fail(
          "has elements of type " + std::to_string(type) + ", which is not supported, or is corrupt",
          "mesh with triangles, quadrilaterals, tetrahedra or hexahedra of first or second order (Mesh.ElementOrder = 1)");
      return result;
    }

    template <typename ReadTag>
    void GmshReader::add_element(const GmshElement &type,
                                 const unsigned int of_group,
                                 const std::size_t  number,
                                 const ReadTag     &read_tag)
    {
      MeshFile::Element element;
      element.dim          = type.dim;
      element.n            = type.n_corners;
      element.group        = of_group;
      element.number       = number;
      const auto &of_solid = middles_of_solid(NodeOrder::gmsh, type.n_nodes);
      for (unsigned int k = 0; k < type.n_nodes; ++k)
        {
          const std::size_t tag   = read_tag();
          const auto        found = index_of_node.find(tag);
          if (found == index_of_node.end())
            in.fail("element " + std::to_string(number) + " has node " + std::to_string(tag) +
                      ", which is not in the file",
                    "write the file again with Gmsh");
          if (k < element.corners.size() && k < type.n_corners)
            element.corners[k] = found->second;
          else if (type.dim == 2 &&
                   (type.n_nodes == 6 || type.n_nodes == 8 || (type.n_nodes == 9 && type.n_corners == 4)))
            mesh.keep_middle(element, k, found->second);
          else if (type.dim == 3 && k - type.n_corners < of_solid.size())
            mesh.keep_middle_of_solid(element, of_solid[k - type.n_corners], found->second);
        }
      mesh.is_curved = mesh.is_curved || (type.dim >= 2 && type.n_nodes > type.n_corners);
      mesh.elements.push_back(element);
    }

    void GmshReader::read_elements()
    {
      const std::size_t n_blocks = in.count();
      in.count();
      in.count();
      in.count();
      for (std::size_t b = 0; b < n_blocks; ++b)
        {
          const int          dim      = in.integer();
          const int          entity   = in.integer();
          const GmshElement  type     = type_of(in.integer());
          const std::size_t  n        = in.checked(in.count(), 1);
          const auto         found    = physicals_of_entity.find({dim, entity});
          const unsigned int of_group = group(found == physicals_of_entity.end() ? std::vector<int>() : found->second);
          for (std::size_t k = 0; k < n; ++k)
            {
              const std::size_t number = in.count();
              add_element(type, of_group, number, [this] { return in.count(); });
            }
        }
    }

    void GmshReader::read_elements_2()
    {
      const auto n = in.word<std::size_t>();
      in.line();
      for (std::size_t k = 0; k < n;)
        {
          // in binary: type, number of elements that follow, number of tags; in ASCII each element separately
          int number = 0, type = 0, in_block = 1, n_tags = 0;
          if (!in.binary)
            number = in.integer();
          type = in.integer();
          if (in.binary)
            in_block = in.integer();
          n_tags = in.integer();
          if (in_block < 1 || n_tags < 0)
            in.fail_broken();
          const GmshElement known = type_of(type);
          for (int e = 0; e < in_block; ++e, ++k)
            {
              if (in.binary)
                number = in.integer();
              int physical = 0;
              for (int t = 0; t < n_tags; ++t)
                {
                  const int tag = in.integer();
                  if (t == 0)
                    physical = in.physical(tag);
                }
              add_element(known,
                          group(physical == 0 ? std::vector<int>() : std::vector<int>{physical}),
                          number,
                          [this] { return static_cast<std::size_t>(in.integer()); });
            }
        }
    }

    MeshFile GmshReader::read()
    {
      read_format();
      while (true)
        {
          const std::string section = in.next_section();
          if (section.empty())
            break;
          if (section == "PhysicalNames")
            read_names();
          else if (section == "Entities")
            read_entities();
          else if (section == "Nodes")
            {
              is_version_2 ? read_nodes_2() : read_nodes();
              in.end_section(false);
              has_nodes = true;
            }
          else if (section == "Elements")
            {
              if (!has_nodes)
                in.fail("has its elements before its nodes", "write it again with Gmsh");
              is_version_2 ? read_elements_2() : read_elements();
              in.end_section(false);
              has_elements = true;
            }
          else if (section == "PartitionedEntities")
            in.fail("is partitioned", "save it without partitions: slipstick decomposes bodies itself");
          else
            in.end_section(true);
        }
      if (!has_nodes || !has_elements)
        in.fail(std::string("has no $") + (has_nodes ? "Elements" : "Nodes") + ", it is incomplete",
                "mesh the geometry and save: gmsh -2 part.geo -format msh41");
      return std::move(mesh);
    }
  } // namespace

  MeshFile parse_gmsh(const std::string &file, const std::string &text)
  {
    return GmshReader(file, text).read();
  }
} // namespace slipstick::mesh
