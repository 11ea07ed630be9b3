// Abaqus input files: *NODE, *ELEMENT, *ELSET, *NSET, *SURFACE, the keywords that describe a mesh.
#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/abaqus_element.h>
#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/solid_nodes.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <sstream>
#include <unordered_map>

namespace slipstick::mesh
{
  namespace
  {
    // Keywords that only structure the file, and those that would change the mesh and are not supported.
    const std::set<std::string> framing =
      {"HEADING", "PREPRINT", "PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE"};
    const std::set<std::string> changing =
      {"INCLUDE", "IMPORT", "SYSTEM", "NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "MANIFEST"};

    constexpr unsigned int no_element = -1; // index of elements that are recognised but not stored

    std::string upper(std::string text)
    {
      std::transform(text.begin(), text.end(), text.begin(), [](const unsigned char c) { return std::toupper(c); });
      return text;
    }

    class AbaqusReader
    {
    public:
      AbaqusReader(const std::string &file, const std::string &text)
        : lines(text)
      {
        mesh.file = file;
      }

      MeshFile read();

    private:
      using Key = std::string; // of a set: its name in capitals, since Abaqus is not case-sensitive

      /// A keyword line: its parameters by name, in capitals.
      struct Keyword
      {
        std::string                        name;
        std::map<std::string, std::string> parameters;

        std::string operator[](const std::string &parameter) const
        {
          const auto found = parameters.find(parameter);
          return found == parameters.end() ? "" : found->second;
        }
      };

      [[noreturn]] void fail(const std::string &problem) const
      {
        throw InputError(
          "mesh file " + mesh.file + ":" + std::to_string(line_number) + ": " + problem,
          "write a flat Abaqus input file of one part with *NODE, *ELEMENT (CPS3, CPE4, C3D8, C3D10, ...), *ELSET, "
          "*NSET, or use Gmsh's .msh");
      }

      void                     next_line();
      Keyword                  keyword() const;
      std::vector<std::string> words() const; // of a data line
      unsigned long long       number(const std::string &word) const;
      Key                      named(const std::string &name);

      template <typename F>
      void for_data(const F &f);

      /// Members of a set: numbers, and ranges of GENERATE, which are checked against the existing numbers before they
      /// are expanded.
      struct Set
      {
        using Range = std::array<unsigned long long, 4>; // first, last, step, line in the file

        std::set<unsigned long long> members;
        std::set<Range>              ranges;
        unsigned int                 line = 0; // of its first keyword
      };

      /// Members with expanded ranges. @throws InputError for one that is not in @p index.
      std::set<unsigned long long> written_out(const Key                                                  &key,
                                               const Set                                                  &set,
                                               const std::unordered_map<unsigned long long, unsigned int> &index,
                                               const std::string                                          &what);

      void list_ignored();
      void read_nodes(const Keyword &key);
      void read_elements(const Keyword &key);
      void read_set(const Keyword &key, const bool of_nodes);
      void read_surface(const Keyword &key);
      void make_groups();
      void add_side(const MeshFile::Element                      &cell,
                    const std::string                            &label,
                    const Key                                    &key,
                    const std::map<MeshFile::Side, unsigned int> &n_cells);

      unsigned int group(const std::set<int> &physicals);

      std::istringstream lines;
      std::string        line; // current line, trimmed
      bool               at_end      = false;
      unsigned int       line_number = 0;
      MeshFile           mesh;
      unsigned int       dim_of_cells = 2;

      std::unordered_map<unsigned long long, unsigned int> node_index, element_index; // by number in the file
      std::map<Key, int>                                   physical_of;
      std::map<Key, Set>                                   node_sets, element_sets;
      struct Side
      {
        std::string  of, side; // element or set, label
        unsigned int line;
      };
      std::map<Key, std::vector<Side>>      surfaces;
      std::map<std::string, unsigned int>   ignored; // keywords and types of elements: their number
      std::map<std::set<int>, unsigned int> index_of_group;
    };

    void AbaqusReader::next_line()
    {
      do
        {
          at_end = !std::getline(lines, line);
          ++line_number;
          line = at_end ? "" : trim(line);
      } while (!at_end && (line.empty() || line.compare(0, 2, "**") == 0));
    }

    AbaqusReader::Keyword AbaqusReader::keyword() const
    {
      const auto parts = split_list(line);
      Keyword    key;
      key.name = upper(collapse_blanks(parts[0].substr(1)));
      for (unsigned int k = 1; k < parts.size(); ++k)
        {
          const auto equal = parts[k].find('=');
          key.parameters[upper(trim(parts[k].substr(0, equal)))] =
            equal == std::string::npos ? "" : trim(parts[k].substr(equal + 1));
        }
      return key;
    }

    std::vector<std::string> AbaqusReader::words() const
    {
      auto parts = split_list(line);
      while (!parts.empty() && parts.back().empty()) // comma at the end of the line
        parts.pop_back();
      return parts;
    }

    unsigned long long AbaqusReader::number(const std::string &word) const
    {
      const auto value = parse_number(word);
      if (!value || *value < 0 || *value != std::floor(*value) || *value > 1e15)
        fail("'" + word + "' is not the number of a node or element");
      return static_cast<unsigned long long>(*value);
    }

    AbaqusReader::Key AbaqusReader::named(const std::string &name)
    {
      const Key key = upper(name);
      if (const auto [found, is_new] = physical_of.emplace(key, physical_of.size() + 1); is_new)
        for (const int dim : {0, 1, 2, 3})
          mesh.names[{dim, found->second}] = name;
      return key;
    }

    /// Calls f for the data lines up to the next keyword.
    template <typename F>
    void AbaqusReader::for_data(const F &f)
    {
      for (next_line(); !at_end && line[0] != '*'; next_line())
        f(words());
    }

    void AbaqusReader::read_nodes(const Keyword &key)
    {
      if (key.parameters.count("INPUT") > 0 || (!key["SYSTEM"].empty() && upper(key["SYSTEM"]) != "R"))
        fail("*NODE with INPUT, or in a system other than R, is not supported");
      const std::string set = key["NSET"];
      for_data([&](const std::vector<std::string> &parts) {
        if (parts.size() < 3)
          fail("a node needs a number and coordinates");
        std::array<double, 3> x = {{0, 0, 0}};
        for (unsigned int d = 0; d < 3 && d + 1 < parts.size(); ++d)
          {
            const auto value = parse_number(parts[d + 1]);
            if (!value || !std::isfinite(*value))
              fail("'" + parts[d + 1] + "' is not a coordinate");
            x[d] = *value;
          }
        const auto tag = number(parts[0]);
        if (!node_index.emplace(tag, mesh.nodes.size()).second)
          fail("node " + parts[0] + " occurs twice");
        mesh.nodes.emplace_back(x[0], x[1], x[2]);
        if (!set.empty())
          node_sets[named(set)].members.insert(tag);
      });
    }

    void AbaqusReader::read_elements(const Keyword &key)
    {
      const std::string type = upper(key["TYPE"]);
      const auto starts = [&type](const std::string &prefix) { return type.compare(0, prefix.size(), prefix) == 0; };
      if (type.empty() || key.parameters.count("INPUT") > 0)
        fail(type.empty() ? "*ELEMENT without TYPE" : "*ELEMENT with INPUT is not supported");
      const AbaqusElement kind = abaqus_element(type);
      if (!kind.problem.empty())
        fail(kind.problem);
      const unsigned int dim = kind.dim, n_nodes = kind.n_nodes;
      if (dim == 0)
        ++ignored["*ELEMENT, TYPE=" + type];
      if (starts("CPS"))
        mesh.plane_stress_types.insert(type);
      if (starts("CPE"))
        mesh.plane_strain_types.insert(type);
      if (starts("CAX"))
        mesh.axisymmetric_types.insert(type);
      const auto                     &of_solid = middles_of_solid(NodeOrder::abaqus, dim == 3 ? n_nodes : 0);
      const std::string               set      = key["ELSET"];
      std::vector<unsigned long long> data; // of one element, which may take several lines
      for_data([&](const std::vector<std::string> &parts) {
        for (const std::string &part : parts)
          data.push_back(number(part));
        if (dim == 0)
          {
            element_index.emplace(data.empty() ? 0 : data[0], no_element);
            data.clear();
            return;
          }
        if (data.size() < n_nodes + 1)
          return;
        if (data.size() > n_nodes + 1)
          fail("element " + std::to_string(data[0]) + " has more than the " + std::to_string(n_nodes) + " nodes of " +
               type);
        MeshFile::Element element;
        element.dim    = dim;
        element.n      = kind.n_corners;
        element.number = data[0];
        mesh.is_curved = mesh.is_curved || n_nodes > element.n;
        for (unsigned int k = 0; k < n_nodes; ++k)
          {
            const auto found = node_index.find(data[k + 1]);
            if (found == node_index.end())
              fail("element " + std::to_string(data[0]) + " has node " + std::to_string(data[k + 1]) +
                   ", which is not there");
            if (k < element.n || dim == 1)
              element.corners[k] = found->second;
            else if (dim == 2)
              mesh.keep_middle(element, k, found->second);
            else if (k - element.n < of_solid.size())
              mesh.keep_middle_of_solid(element, of_solid[k - element.n], found->second);
          }
        if (dim == 1 && n_nodes == 3) // the middle node comes second or last: it is the one between the others
          {
            const auto off_middle = [&](const unsigned int k) {
              const auto &x = mesh.nodes;
              return (x[element.corners[k]] - x[element.corners[(k + 1) % 3]] +
                      (x[element.corners[k]] - x[element.corners[(k + 2) % 3]]))
                .norm();
            };
            if (off_middle(1) < off_middle(2))
              std::swap(element.corners[1], element.corners[2]);
          }
        if (!element_index.emplace(data[0], mesh.elements.size()).second)
          fail("element " + std::to_string(data[0]) + " occurs twice");
        mesh.elements.push_back(element);
        if (!set.empty())
          element_sets[named(set)].members.insert(data[0]);
        data.clear();
      });
      if (!data.empty())
        fail("the last element of type " + type + " lacks nodes");
    }

    void AbaqusReader::read_set(const Keyword &key, const bool of_nodes)
    {
      const std::string name = key[of_nodes ? "NSET" : "ELSET"];
      if (name.empty())
        fail("a set without a name");
      if (of_nodes && key.parameters.count("ELSET") > 0)
        fail("*NSET with ELSET is not supported; name the nodes, or the sides of the elements (*SURFACE)");
      auto &sets = of_nodes ? node_sets : element_sets;
      auto &set  = sets[named(name)];
      if (set.line == 0)
        set.line = line_number;
      const bool generate = key.parameters.count("GENERATE") > 0;
      for_data([&](const std::vector<std::string> &parts) {
        if (generate)
          {
            if (parts.size() < 2)
              fail("GENERATE needs first, last and step");
            const auto step = parts.size() > 2 ? number(parts[2]) : 1;
            if (step == 0 || number(parts[1]) < number(parts[0]))
              fail("GENERATE with step " + std::to_string(step) + " from " + parts[0] + " up to " + parts[1]);
            set.ranges.insert(Set::Range{{number(parts[0]), number(parts[1]), step, line_number}});
            return;
          }
        for (const std::string &part : parts)
          if (parse_number(part))
            set.members.insert(number(part));
          else if (const auto other = sets.find(upper(part)); other != sets.end())
            {
              set.members.insert(other->second.members.begin(), other->second.members.end());
              set.ranges.insert(other->second.ranges.begin(), other->second.ranges.end());
            }
          else
            fail("there is no set '" + part + "' before this line");
      });
    }

    std::set<unsigned long long> AbaqusReader::written_out(
      const Key                                                  &key,
      const Set                                                  &set,
      const std::unordered_map<unsigned long long, unsigned int> &index,
      const std::string                                          &what)
    {
      auto all = set.members;
      for (const auto &[first, last, step, at_line] : set.ranges)
        {
          line_number = at_line;
          if ((last - first) / step >= index.size())
            fail("GENERATE with step " + std::to_string(step) + " from " + std::to_string(first) + " up to " +
                 std::to_string(last) + ": there are " + std::to_string(index.size()) + " " + what + "s only");
          for (auto k = first; k <= last; k += step)
            all.insert(k);
        }
      for (const auto tag : all)
        if (index.count(tag) == 0)
          {
            line_number = set.line;
            fail("set '" + key + "' has " + what + " " + std::to_string(tag) + ", which is not in the file");
          }
      return all;
    }

    void AbaqusReader::read_surface(const Keyword &key)
    {
      if (key["NAME"].empty())
        fail("a surface without a name");
      const std::string type = upper(key["TYPE"]);
      if ((type != "" && type != "ELEMENT" && type != "NODE") || key.parameters.count("COMBINE") > 0 ||
          key.parameters.count("CROP") > 0)
        fail("*SURFACE of this kind is not supported, only those of elements with their sides, and of nodes");
      const Key name = named(key["NAME"]);
      for_data([&](const std::vector<std::string> &parts) {
        const std::string side = parts.size() < 2 ? "" : upper(parts[1]);
        if (parts.empty() || parts[0].empty())
          fail("*SURFACE of everything is not supported; name sets of elements and their sides");
        if (type != "NODE")
          surfaces[name].push_back({parts[0], side, line_number});
        else if (const auto set = node_sets.find(upper(parts[0])); set != node_sets.end())
          {
            node_sets[name].members.insert(set->second.members.begin(), set->second.members.end());
            node_sets[name].ranges.insert(set->second.ranges.begin(), set->second.ranges.end());
          }
        else
          node_sets[name].members.insert(number(parts[0]));
      });
    }

    unsigned int AbaqusReader::group(const std::set<int> &physicals)
    {
      const auto [found, is_new] = index_of_group.emplace(physicals, mesh.groups.size());
      if (is_new)
        mesh.groups.emplace_back(physicals.begin(), physicals.end());
      return found->second;
    }

    /// Element sets define cells and lines (for solids: faces); node sets define the edges or faces between them, and
    /// points; surfaces define sides of elements.
    void AbaqusReader::make_groups()
    {
      std::vector<std::set<int>>                  physicals(mesh.elements.size());
      std::map<Key, std::set<unsigned long long>> elements_of;
      for (const auto &[key, set] : element_sets)
        for (const auto tag : elements_of[key] = written_out(key, set, element_index, "element"))
          if (const auto e = element_index.at(tag); e != no_element)
            physicals[e].insert(physical_of.at(key));
      const auto n_elements = mesh.elements.size();
      for (std::size_t e = 0; e < n_elements; ++e)
        mesh.elements[e].group = group(physicals[e]);

      dim_of_cells = mesh.dimension();
      std::map<MeshFile::Side, unsigned int> n_cells;
      for (const auto &cell : mesh.elements)
        if (cell.dim == dim_of_cells)
          for (const auto &side : sides_of(cell))
            ++n_cells[side.sorted()];
      for (const auto &[key, set] : node_sets)
        {
          const std::string name  = mesh.name_of(0, physical_of.at(key));
          auto             &nodes = mesh.node_sets[name];
          for (const auto tag : written_out(key, set, node_index, "node"))
            nodes.push_back(node_index.at(tag));
          if (nodes.empty())
            mesh.node_sets.erase(name);
          else
            mesh.add_sides_of_node_set(name, group({physical_of.at(key)}));
        }
      for (const auto &[key, sides] : surfaces)
        for (const auto &[of, side, at_line] : sides)
          {
            line_number    = at_line;
            const auto set = elements_of.find(upper(of));
            for (const auto tag : set != elements_of.end() ? set->second : std::set<unsigned long long>{number(of)})
              {
                const auto found = element_index.find(tag);
                if (found == element_index.end() || found->second == no_element)
                  fail("surface '" + key + "' has element " + std::to_string(tag) + ", which is not in the file");
                add_side(MeshFile::Element(mesh.elements[found->second]),
                         side,
                         key,
                         n_cells); // a copy, since elements are added
              }
          }
    }

    /// @param n_cells by side: a surface without labels consists of all sides with one cell. Lines of plane meshes and
    /// faces of solids are sides themselves.
    void AbaqusReader::add_side(const MeshFile::Element                      &cell,
                                const std::string                            &label,
                                const Key                                    &key,
                                const std::map<MeshFile::Side, unsigned int> &n_cells)
    {
      const auto add = [&](MeshFile::Element side) {
        side.number = cell.number;
        side.group  = group({physical_of.at(key)});
        mesh.elements.push_back(side);
      };
      if (cell.dim < dim_of_cells)
        {
          if (!label.empty() && label != "SPOS" && label != "SNEG")
            fail("surface '" + key + "' has side " + label + " of element " + std::to_string(cell.number) +
                 ", which has sides SPOS and SNEG");
          return add(cell);
        }
      const auto  sides = sides_of(cell);
      std::size_t which = sides.size();
      if (label.size() == 2 &&
          (label[0] == 'S' || (label[0] == 'E' && cell.dim == 2))) // sides of cells, edges of shells
        which = label[1] - '1';
      if (!label.empty() && which >= sides.size())
        fail("surface '" + key + "' has side " + label + " of element " + std::to_string(cell.number) +
             ", which has sides S1 to S" + std::to_string(sides.size()));
      for (std::size_t k = 0; k < sides.size(); ++k)
        if (label.empty() ? n_cells.at(sides[k].sorted()) == 1 : k == which)
          add(sides[k].element());
    }

    void AbaqusReader::list_ignored()
    {
      std::string all;
      for (const auto &[name, n] : ignored)
        all += (all.empty() ? "" : ", ") + name + (n > 1 ? " (" + std::to_string(n) + ")" : "");
      if (!all.empty())
        mesh.remarks.push_back(
          "warning: mesh file " + mesh.file +
          ": only its mesh is used; materials, supports, loads and steps come from the scene. Not used: " + all);
    }

    MeshFile AbaqusReader::read()
    {
      unsigned int n_parts = 0, n_instances = 0;
      next_line();
      while (!at_end)
        {
          if (line[0] != '*')
            fail("data without a keyword, or not an Abaqus input file");
          const Keyword key = keyword();
          if (key.name == "NODE")
            read_nodes(key);
          else if (key.name == "ELEMENT")
            read_elements(key);
          else if (key.name == "ELSET" || key.name == "NSET")
            read_set(key, key.name == "NSET");
          else if (key.name == "SURFACE")
            read_surface(key);
          else if (changing.count(key.name) > 0 || (key.name == "PART" && ++n_parts > 1) ||
                   (key.name == "INSTANCE" && ++n_instances > 1))
            fail("*" + key.name + (n_parts > 1 || n_instances > 1 ? " (the second)" : "") + " is not supported");
          else
            {
              const bool is_placed = key.name == "INSTANCE";
              if (framing.count(key.name) == 0)
                ++ignored["*" + key.name];
              for_data([&](const std::vector<std::string> &) {
                if (is_placed)
                  fail("*INSTANCE with a translation or rotation is not supported");
              });
            }
        }
      make_groups();
      list_ignored();
      return std::move(mesh);
    }
  } // namespace

  MeshFile parse_abaqus(const std::string &file, const std::string &text)
  {
    return AbaqusReader(file, text).read();
  }
} // namespace slipstick::mesh
