// I-deas' universal file format: http://www.sdrl.uc.edu/sdrl/referenceinfo/universalfileformats, data sets 2411, 2412,
// 2467.
#include <slipstick/base/text.h>
#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/solid_nodes.h>
#include <slipstick/mesh/word_reader.h>

#include <cmath>
#include <set>
#include <unordered_map>

namespace slipstick::mesh
{
  namespace
  {
    /// Elements by their "FE descriptor": dimension, corners, nodes. Second-order elements have a node in the middle of
    /// every edge, after its first end; solids list first the bottom in this way, then the mid nodes of the vertical
    /// edges, then the top.
    struct FeType
    {
      unsigned int dim, n_corners, n_nodes;
    };

    FeType fe_type(const long long type)
    {
      switch (type)
        {
          case 11: // rod
          case 21: // beams
          case 22:
            return {1, 2, 2};
          case 23:
          case 24:
            return {1, 2, 3};
          case 41: // plane stress
          case 51: // plane strain
          case 81: // axisymmetric
          case 61: // plate
          case 74: // membrane
          case 91: // thin shell
            return {2, 3, 3};
          case 42:
          case 52:
          case 82:
          case 62:
          case 72:
          case 92:
            return {2, 3, 6};
          case 44:
          case 54:
          case 84:
          case 64:
          case 71:
          case 94:
            return {2, 4, 4};
          case 45:
          case 55:
          case 85:
          case 65:
          case 75:
          case 95:
            return {2, 4, 8};
        }
      switch (type)
        {
          case 111:
            return {3, 4, 4};
          case 118:
            return {3, 4, 10};
          case 115:
            return {3, 8, 8};
          case 116:
            return {3, 8, 20};
          case 112: // wedge
            return {3, 6, 6};
        }
      return {type >= 101 && type <= 118 ? 3u : 0u, 0, 0};
    }

    /// Gmsh writes 9-node quadrilaterals and 27-node hexahedra with the first-order descriptors and with nodes in its
    /// own order.
    bool is_of_gmsh(const FeType &type, const unsigned int n_nodes)
    {
      return type.n_nodes == type.n_corners && type.n_corners > 0 &&
             ((type.dim == 2 && type.n_corners == 4 && n_nodes == 9) ||
              (type.dim == 3 && type.n_corners == 8 && n_nodes == 27));
    }

    /// The corners between which node @p k of an element lies; one: it is that corner; none: unknown.
    std::vector<unsigned int> corners_around(const FeType &type, const unsigned int k)
    {
      if (type.n_nodes == 0)
        return {};
      if (type.n_nodes == type.n_corners)
        return {k};
      const unsigned int n_below = type.dim < 3 ? type.n_corners : type.n_corners == 4 ? 3 : 4; // corners at the bottom
      if (k < 2 * n_below)
        {
          if (k % 2 == 0)
            return {k / 2};
          return {k / 2, (k / 2 + 1) % n_below};
        }
      const unsigned int n_above = type.n_corners - n_below, rising = k - 2 * n_below, above = k - 3 * n_below;
      if (k < 3 * n_below)
        return {rising, n_below + (n_above == 1 ? 0 : rising)};
      if (above % 2 == 0)
        return {n_below + above / 2};
      return {n_below + above / 2, n_below + (above / 2 + 1) % n_above};
    }

    class UnvReader
    {
    public:
      UnvReader(const std::string &file, const std::string &text)
        : in(
            file,
            text,
            "write it again (.unv with data sets 2411 and 2412, elements of first or second order), or save it as .msh "
            "in Gmsh")
      {
        mesh.file = file;
        mesh.about_names =
          "; Gmsh writes blanks in names as _ and leaves points out of .unv files: save as .msh in Gmsh for both";
      }

      MeshFile read();

    private:
      void read_nodes();
      void read_elements();
      void take_nodes(const FeType &type, MeshFile::Element &element, const std::vector<unsigned int> &nodes);
      void take_nodes_of_gmsh(MeshFile::Element &element, const std::vector<unsigned int> &nodes);
      void read_groups();
      void skip_set(const std::string &number);
      void make_groups();
      int  physical_of(const std::string &name);

      static constexpr unsigned int no_element = -1; // springs and masses: recognised but not stored

      std::set<long long>                                                ignored_types;
      WordReader                                                         in;
      MeshFile                                                           mesh;
      std::unordered_map<long long, unsigned int>                        node_index, element_index;
      std::map<int, std::pair<std::set<long long>, std::set<long long>>> members; // by physical: nodes, elements
    };

    void UnvReader::read_nodes()
    {
      for (auto node = in.integer(); node != -1; node = in.integer())
        {
          for (unsigned int k = 0; k < 3; ++k)
            in.integer(); // coordinate systems, colour
          const double x = in.real(), y = in.real(), z = in.real();
          if (!node_index.emplace(node, mesh.nodes.size()).second)
            in.fail("node " + std::to_string(node) + " occurs twice");
          mesh.nodes.emplace_back(x, y, z);
        }
    }

    void UnvReader::read_elements()
    {
      for (auto number = in.integer(); number != -1; number = in.integer())
        {
          const auto type = in.integer();
          for (unsigned int k = 0; k < 3; ++k)
            in.integer(); // property, material, colour
          const auto n_nodes = in.integer();
          if (n_nodes < 1 || n_nodes > 100)
            in.fail_corrupt();
          if (type >= 11 && type <= 32) // rods, beams and pipes have a line for orientation and cross-sections
            for (unsigned int k = 0; k < 3; ++k)
              in.integer();
          const FeType known   = fe_type(type);
          const bool   of_gmsh = is_of_gmsh(known, n_nodes);
          if (known.n_nodes > 0 ? n_nodes != known.n_nodes && !of_gmsh : known.dim == 0 && n_nodes > 2)
            in.fail("element " + std::to_string(number) + " of type " + std::to_string(type) + " with " +
                    std::to_string(n_nodes) + " nodes is not supported");
          MeshFile::Element element;
          element.dim    = known.dim;
          element.n      = known.n_corners;
          element.number = number;
          std::vector<unsigned int> nodes;
          for (unsigned int k = 0; k < n_nodes; ++k)
            {
              const auto node  = in.integer();
              const auto found = node_index.find(node);
              if (found == node_index.end())
                in.fail("cell " + std::to_string(number) + " has corner " + std::to_string(node) +
                        ", which is not in the file");
              nodes.push_back(found->second);
            }
          of_gmsh ? take_nodes_of_gmsh(element, nodes) : take_nodes(known, element, nodes);
          if (!element_index.emplace(number, mesh.elements.size()).second)
            in.fail("element " + std::to_string(number) + " occurs twice");
          if (type >= 41 && type <= 45)
            mesh.plane_stress_types.insert("type " + std::to_string(type));
          if (type >= 51 && type <= 55)
            mesh.plane_strain_types.insert("type " + std::to_string(type));
          if (type >= 81 && type <= 85)
            mesh.axisymmetric_types.insert("type " + std::to_string(type));
          mesh.is_curved = mesh.is_curved || (known.dim >= 2 && known.n_nodes > 0 && n_nodes > known.n_corners);
          if (known.n_nodes == 0 && known.dim == 0) // springs, masses
            {
              if (ignored_types.insert(type).second)
                mesh.remarks.push_back("mesh file " + mesh.file + ": not used: elements of type " +
                                       std::to_string(type));
              element_index[number] = no_element;
              continue;
            }
          mesh.elements.push_back(element);
        }
    }

    /// Stores corners, and midpoints of edges.
    void UnvReader::take_nodes(const FeType &type, MeshFile::Element &element, const std::vector<unsigned int> &nodes)
    {
      for (unsigned int k = 0; k < nodes.size(); ++k)
        if (const auto around = corners_around(type, k); around.size() == 1)
          element.corners[around[0]] = nodes[k];
      if (type.dim >= 2)
        for (unsigned int k = 0; k < nodes.size(); ++k)
          if (const auto around = corners_around(type, k); around.size() == 2)
            mesh.keep_middle_of_solid(element, around, nodes[k]);
    }

    void UnvReader::take_nodes_of_gmsh(MeshFile::Element &element, const std::vector<unsigned int> &nodes)
    {
      const auto &of_solid = middles_of_solid(NodeOrder::gmsh, element.dim == 3 ? nodes.size() : 0);
      for (unsigned int k = 0; k < nodes.size(); ++k)
        if (k < element.n)
          element.corners[k] = nodes[k];
        else if (element.dim == 2)
          mesh.keep_middle(element, k, nodes[k]);
        else if (k - element.n < of_solid.size())
          mesh.keep_middle_of_solid(element, of_solid[k - element.n], nodes[k]);
    }

    int UnvReader::physical_of(const std::string &name)
    {
      constexpr int first_of_names = 1000000000; // smaller numbers are their own names
      const auto    number         = parse_number(name);
      if (number && *number == static_cast<int>(*number) && std::abs(*number) < first_of_names)
        return *number;
      const int physical = first_of_names + members.size();
      for (const int dim : {0, 1, 2, 3})
        mesh.names[{dim, physical}] = name;
      return physical;
    }

    void UnvReader::read_groups()
    {
      for (auto group = in.integer(); group != -1; group = in.integer())
        {
          for (unsigned int k = 0; k < 6; ++k)
            in.integer();
          const auto n = in.count(4);
          in.line();
          const std::string name = in.line();
          if (name.empty())
            in.fail_corrupt();
          const int physical = physical_of(name);
          auto     &of_group = members[physical];
          for (std::size_t k = 0; k < n; ++k)
            {
              const auto kind = in.integer(), tag = in.integer();
              in.integer();
              in.integer();
              if (kind == 7)
                of_group.first.insert(tag);
              else if (kind == 8)
                of_group.second.insert(tag);
              else
                in.fail("group '" + name + "' has a member of kind " + std::to_string(kind) +
                        ", neither node (7) nor element (8)");
            }
        }
    }

    void UnvReader::skip_set(const std::string &number)
    {
      mesh.remarks.push_back("mesh file " + mesh.file + ": data set " + number + " is not used");
      while (!in.at_end())
        if (in.line() == "-1")
          return;
      in.fail_corrupt();
    }

    void UnvReader::make_groups()
    {
      std::vector<std::vector<int>> physicals(mesh.elements.size());
      for (const auto &[physical, of_group] : members)
        {
          const std::string name        = mesh.name_of(1, physical);
          const auto &[nodes, elements] = of_group;
          std::size_t n_missing         = 0;
          for (const auto tag : elements)
            if (const auto found = element_index.find(tag); found == element_index.end())
              ++n_missing;
            else if (found->second != no_element)
              physicals[found->second].push_back(physical);
          if (n_missing > 0 && n_missing < elements.size())
            in.fail("group '" + name + "' has " + std::to_string(n_missing) +
                    " elements that are not in the file, of " + std::to_string(elements.size()));
          if (n_missing > 0) // Gmsh does not write its points
            mesh.remarks.push_back("mesh file " + mesh.file + ": group '" + name +
                                   "' is left out, as none of its elements is in the file");
          for (const auto tag : nodes)
            {
              const auto found = node_index.find(tag);
              if (found == node_index.end())
                in.fail("group '" + name + "' has node " + std::to_string(tag) + ", which is not in the file");
              mesh.node_sets[name].push_back(found->second);
            }
        }
      std::map<std::vector<int>, unsigned int> group_of;
      const auto                               group = [&](const std::vector<int> &numbers) {
        const auto [found, is_new] = group_of.emplace(numbers, mesh.groups.size());
        if (is_new)
          mesh.groups.push_back(numbers);
        return found->second;
      };
      for (std::size_t e = 0; e < mesh.elements.size(); ++e)
        mesh.elements[e].group = group(physicals[e].empty() ? std::vector<int>{0} : physicals[e]);
      for (const auto &[physical, of_group] : members)
        if (!of_group.first.empty())
          mesh.add_sides_of_node_set(mesh.name_of(1, physical), group({physical}));
      mesh.add_outline();
    }

    MeshFile UnvReader::read()
    {
      in.section = "header";
      for (std::string word = in.word(); !word.empty(); word = in.word())
        {
          if (word != "-1")
            in.fail("is not a .unv file, or corrupt: '" + word.substr(0, 20) + "' where -1 belongs");
          in.section = in.word();
          if (in.section == "2411")
            read_nodes();
          else if (in.section == "2412")
            read_elements();
          else if (in.section == "2467" || in.section == "2477")
            read_groups();
          else
            skip_set(in.section);
        }
      make_groups();
      return std::move(mesh);
    }
  } // namespace

  MeshFile parse_unv(const std::string &file, const std::string &text)
  {
    return UnvReader(file, text).read();
  }
} // namespace slipstick::mesh
