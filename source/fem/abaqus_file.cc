// Abaqus' input files as far as they describe a mesh in the plane: *NODE, *ELEMENT, *ELSET, *NSET, *SURFACE.
#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/fem/mesh_file.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <sstream>
#include <unordered_map>

namespace slipstick::fem
{
  namespace
  {
    constexpr unsigned long long most_generated = 10000000; // members of a set by one line; more is a slip of the pen

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
      using Key = std::string; // of a set: its name in capitals, as Abaqus does not tell them apart

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
          "write a flat Abaqus input file of one part with *NODE, *ELEMENT (CPS3, CPS4, CPE3, ...), *ELSET, "
          "*NSET, or use Gmsh's .msh");
      }

      void                     next_line();
      Keyword                  keyword() const;
      std::vector<std::string> words() const; // of a data line
      unsigned long long       number(const std::string &word) const;
      Key                      named(const std::string &name);

      template <typename F>
      void for_data(const F &f);

      void read_nodes(const Keyword &key);
      void read_elements(const Keyword &key);
      void read_set(const Keyword &key, const bool of_nodes);
      void read_surface(const Keyword &key);
      void make_groups();

      unsigned int group(const std::set<int> &physicals);

      std::istringstream lines;
      std::string        line; // present one, trimmed
      bool               at_end      = false;
      unsigned int       line_number = 0;
      MeshFile           mesh;

      std::unordered_map<unsigned long long, unsigned int>    node_index, element_index; // by number in the file
      std::map<Key, int>                                      physical_of;
      std::map<Key, std::set<unsigned long long>>             node_sets, element_sets;
      std::map<Key, std::vector<std::pair<std::string, int>>> surfaces; // element or set, side
      std::map<std::set<int>, unsigned int>                   index_of_group;
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
      while (!parts.empty() && parts.back().empty()) // a comma at the end
        parts.pop_back();
      return parts;
    }

    unsigned long long AbaqusReader::number(const std::string &word) const
    {
      const auto value = parse_number(word);
      if (!value || *value < 0 || *value != std::floor(*value) || *value > 1e15)
        fail("'" + word + "' is no number of a node or element");
      return static_cast<unsigned long long>(*value);
    }

    AbaqusReader::Key AbaqusReader::named(const std::string &name)
    {
      const Key key = upper(name);
      if (const auto [found, is_new] = physical_of.emplace(key, physical_of.size() + 1); is_new)
        for (const int dim : {0, 1, 2})
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
      const std::string set = key["NSET"];
      for_data([&](const std::vector<std::string> &parts) {
        if (parts.size() < 3)
          fail("a node needs a number and coordinates");
        std::array<double, 3> x = {{0, 0, 0}};
        for (unsigned int d = 0; d < 3 && d + 1 < parts.size(); ++d)
          {
            const auto value = parse_number(parts[d + 1]);
            if (!value || !std::isfinite(*value))
              fail("'" + parts[d + 1] + "' is no coordinate");
            x[d] = *value;
          }
        const auto tag = number(parts[0]);
        if (!node_index.emplace(tag, mesh.nodes.size()).second)
          fail("node " + parts[0] + " comes twice");
        mesh.nodes.emplace_back(x[0], x[1], x[2]);
        if (!set.empty())
          node_sets[named(set)].insert(tag);
      });
    }

    void AbaqusReader::read_elements(const Keyword &key)
    {
      // CPS4R -> 4 nodes, C3D8 -> a volume, T3D2 -> a line
      const std::string type = upper(key["TYPE"]);
      const auto   starts = [&type](const std::string &prefix) { return type.compare(0, prefix.size(), prefix) == 0; };
      unsigned int dim = 0, n_nodes = 0;
      if (starts("C3D") || starts("SC"))
        dim = 3;
      for (const std::string candidate :
           {"CPEG", "CPS", "CPE", "CAX", "CGAX", "STRI", "DC2D", "AC2D", "M3D", "SFM3D", "S"})
        if (dim == 0 && starts(candidate) && type.size() > candidate.size() && std::isdigit(type[candidate.size()]))
          {
            dim     = 2;
            n_nodes = type[candidate.size()] - '0';
          }
      for (const std::string candidate : {"T2D2", "T3D2", "B21", "B31", "R2D2", "RB2D2"})
        if (starts(candidate))
          {
            dim     = 1;
            n_nodes = 2;
          }
      if (dim == 2 && n_nodes != 3 && n_nodes != 4 && n_nodes != 6 && n_nodes != 8)
        fail("elements of type " + type + " are not known here");
      const std::string               set = key["ELSET"];
      std::vector<unsigned long long> data; // of one element, which may take several lines
      for_data([&](const std::vector<std::string> &parts) {
        for (const std::string &part : parts)
          data.push_back(number(part));
        if (dim == 0 || dim == 3)
          {
            MeshFile::Element element; // springs, masses and the like mean nothing here; volumes are refused later
            element.dim = 3;
            if (dim == 3 && mesh.groups.empty())
              mesh.groups.emplace_back();
            if (dim == 3)
              mesh.elements.push_back(element);
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
        element.n      = dim == 1 ? 2 : n_nodes % 3 == 0 ? 3 : 4;
        element.number = data[0];
        mesh.is_curved = mesh.is_curved || n_nodes > element.n;
        for (unsigned int k = 0; k < n_nodes; ++k)
          {
            const auto found = node_index.find(data[k + 1]);
            if (found == node_index.end())
              fail("element " + std::to_string(data[0]) + " has node " + std::to_string(data[k + 1]) +
                   ", which is not there");
            if (k < element.n)
              element.corners[k] = found->second;
            else
              mesh.keep_middle(element, k, found->second);
          }
        if (!element_index.emplace(data[0], mesh.elements.size()).second)
          fail("element " + std::to_string(data[0]) + " comes twice");
        mesh.elements.push_back(element);
        if (!set.empty())
          element_sets[named(set)].insert(data[0]);
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
      auto      &sets     = of_nodes ? node_sets : element_sets;
      auto      &set      = sets[named(name)];
      const bool generate = key.parameters.count("GENERATE") > 0;
      for_data([&](const std::vector<std::string> &parts) {
        if (generate)
          {
            if (parts.size() < 2)
              fail("GENERATE needs first, last and step");
            const auto step  = parts.size() > 2 ? number(parts[2]) : 1;
            const auto last  = number(parts[1]);
            const auto first = number(parts[0]);
            if (step == 0 || (last > first && (last - first) / step > most_generated))
              fail("GENERATE with step " + std::to_string(step) + " from " + parts[0] + " up to " + parts[1]);
            for (auto k = first; k <= last; k += step)
              set.insert(set.end(), k);
            return;
          }
        for (const std::string &part : parts)
          if (parse_number(part))
            set.insert(number(part));
          else if (const auto other = sets.find(upper(part)); other != sets.end())
            set.insert(other->second.begin(), other->second.end());
          else
            fail("there is no set '" + part + "' before this line");
      });
    }

    void AbaqusReader::read_surface(const Keyword &key)
    {
      auto &surface = surfaces[named(key["NAME"])];
      for_data([&](const std::vector<std::string> &parts) {
        if (parts.size() == 2 && parts[1].size() == 2 && upper(parts[1])[0] == 'S' && std::isdigit(parts[1][1]))
          surface.emplace_back(parts[0], parts[1][1] - '1');
      });
    }

    unsigned int AbaqusReader::group(const std::set<int> &physicals)
    {
      const auto [found, is_new] = index_of_group.emplace(physicals, mesh.groups.size());
      if (is_new)
        mesh.groups.emplace_back(physicals.begin(), physicals.end());
      return found->second;
    }

    /// Sets of elements name cells and lines; sets of nodes name the edges between them, and points; surfaces name
    /// sides of elements.
    void AbaqusReader::make_groups()
    {
      std::vector<std::set<int>> physicals(mesh.elements.size());
      for (const auto &[key, set] : element_sets)
        for (const auto tag : set)
          if (const auto found = element_index.find(tag); found != element_index.end())
            physicals[found->second].insert(physical_of.at(key));
      const auto n_elements = mesh.elements.size();
      for (std::size_t e = 0; e < n_elements; ++e)
        mesh.elements[e].group = group(physicals[e]);

      const auto add = [this](const unsigned int dim, const unsigned int a, const unsigned int b, const Key &key) {
        MeshFile::Element element;
        element.dim     = dim;
        element.n       = dim + 1;
        element.corners = {{a, b, 0, 0}};
        element.group   = group({physical_of.at(key)});
        mesh.elements.push_back(element);
      };
      for (const auto &[key, set] : node_sets)
        {
          std::set<unsigned int> nodes;
          for (const auto tag : set)
            if (const auto found = node_index.find(tag); found != node_index.end())
              nodes.insert(found->second);
          if (nodes.size() == 1)
            add(0, *nodes.begin(), 0, key);
          for (std::size_t e = 0; e < n_elements; ++e)
            if (const auto cell = mesh.elements[e]; cell.dim == 2)
              for (unsigned int k = 0; k < cell.n; ++k)
                if (nodes.count(cell.corners[k]) > 0 && nodes.count(cell.corners[(k + 1) % cell.n]) > 0)
                  add(1, cell.corners[k], cell.corners[(k + 1) % cell.n], key);
        }
      for (const auto &[key, sides] : surfaces)
        for (const auto &[of, side] : sides)
          {
            const auto set = element_sets.find(upper(of));
            for (const auto tag : set != element_sets.end() ? set->second : std::set<unsigned long long>{number(of)})
              if (const auto found = element_index.find(tag); found != element_index.end())
                if (const auto cell = mesh.elements[found->second]; cell.dim == 2 && side < int(cell.n) && side >= 0)
                  add(1, cell.corners[side], cell.corners[(side + 1) % cell.n], key);
          }
    }

    MeshFile AbaqusReader::read()
    {
      unsigned int n_parts = 0;
      next_line();
      while (!at_end)
        {
          if (line[0] != '*')
            fail("data that belong to no keyword, or no Abaqus input file");
          const Keyword key = keyword();
          if (key.name == "NODE")
            read_nodes(key);
          else if (key.name == "ELEMENT")
            read_elements(key);
          else if (key.name == "ELSET" || key.name == "NSET")
            read_set(key, key.name == "NSET");
          else if (key.name == "SURFACE")
            read_surface(key);
          else if (key.name == "INCLUDE" || (key.name == "PART" && ++n_parts > 1))
            fail("*" + key.name + (n_parts > 1 ? " (the second)" : "") + " cannot be read here");
          else
            for_data([](const std::vector<std::string> &) {});
        }
      make_groups();
      return std::move(mesh);
    }
  } // namespace

  MeshFile parse_abaqus(const std::string &file, const std::string &text)
  {
    return AbaqusReader(file, text).read();
  }
} // namespace slipstick::fem
