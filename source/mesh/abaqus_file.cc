// Abaqus input files: *NODE, *ELEMENT, *ELSET, *NSET, *SURFACE, the keywords that describe a mesh.
#include <slipstick/base/text.h>
#include <slipstick/mesh/abaqus_element.h>
#include <slipstick/mesh/abaqus_lines.h>
#include <slipstick/mesh/abaqus_sets.h>
#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/solid_nodes.h>

#include <cmath>
#include <set>
#include <utility>

namespace slipstick::mesh
{
  namespace
  {
    // Keywords that only structure the file, and those that would change the mesh and are not supported.
    const std::set<std::string> framing =
      {"HEADING", "PREPRINT", "PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE"};
    const std::set<std::string> changing =
      {"INCLUDE", "IMPORT", "SYSTEM", "NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "MANIFEST"};

    class AbaqusReader
    {
    public:
      AbaqusReader(const std::string &file, const std::string &text)
        : in(file, text)
      {
        mesh.file = file;
      }

      MeshFile read();

    private:
      AbaqusSets::Key named(const std::string &name);

      /// Element whose nodes are known; keeps its mid nodes in the mesh. @param data its number and those of its nodes.
      MeshFile::Element element_of(const AbaqusElement &kind, const std::vector<unsigned long long> &data);

      void list_ignored();
      void read_nodes(const AbaqusKeyword &key);
      void read_elements(const AbaqusKeyword &key);
      void read_set(const AbaqusKeyword &key, const bool of_nodes);
      void read_surface(const AbaqusKeyword &key);

      AbaqusLines                         in;
      MeshFile                            mesh;
      AbaqusSets                          sets;
      std::map<std::string, unsigned int> ignored; // keywords and types of elements: their number
    };

    AbaqusSets::Key AbaqusReader::named(const std::string &name)
    {
      const AbaqusSets::Key key = upper(name);
      if (const auto [found, is_new] = sets.physical_of.emplace(key, sets.physical_of.size() + 1); is_new)
        for (const int dim : {0, 1, 2, 3})
          mesh.names[{dim, found->second}] = name;
      return key;
    }

    void AbaqusReader::read_nodes(const AbaqusKeyword &key)
    {
      if (key.has("INPUT") || (!key["SYSTEM"].empty() && upper(key["SYSTEM"]) != "R"))
        in.fail("*NODE with INPUT, or in a system other than R, is not supported");
      const std::string set = key["NSET"];
      in.for_data([&](const std::vector<std::string> &parts) {
        if (parts.size() < 3)
          in.fail("a node needs a number and coordinates");
        std::array<double, 3> x = {{0, 0, 0}};
        for (unsigned int d = 0; d < 3 && d + 1 < parts.size(); ++d)
          {
            const auto value = parse_number(parts[d + 1]);
            if (!value || !std::isfinite(*value))
              in.fail("'" + parts[d + 1] + "' is not a coordinate");
            x[d] = *value;
          }
        const auto tag = in.number(parts[0]);
        if (!sets.node_index.emplace(tag, mesh.nodes.size()).second)
          in.fail("node " + parts[0] + " occurs twice");
        mesh.nodes.emplace_back(x[0], x[1], x[2]);
        if (!set.empty())
          sets.node_sets[named(set)].members.insert(tag);
      });
    }

    MeshFile::Element AbaqusReader::element_of(const AbaqusElement &kind, const std::vector<unsigned long long> &data)
    {
      const auto       &of_solid = middles_of_solid(NodeOrder::abaqus, kind.dim == 3 ? kind.n_nodes : 0);
      MeshFile::Element element;
      element.dim    = kind.dim;
      element.n      = kind.n_corners;
      element.number = data[0];
      mesh.is_curved = mesh.is_curved || kind.n_nodes > element.n;
      for (unsigned int k = 0; k < kind.n_nodes; ++k)
        {
          const auto found = sets.node_index.find(data[k + 1]);
          if (found == sets.node_index.end())
            in.fail("element " + std::to_string(data[0]) + " has node " + std::to_string(data[k + 1]) +
                    ", which is not there");
          if (k < element.n || kind.dim == 1)
            element.corners[k] = found->second;
          else if (kind.dim == 2)
            mesh.keep_middle(element, k, found->second);
          else if (k - element.n < of_solid.size())
            mesh.keep_middle_of_solid(element, of_solid[k - element.n], found->second);
        }
      if (kind.dim == 1 && kind.n_nodes == 3) // the middle node comes second or last: it is the one between the others
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
      return element;
    }

    void AbaqusReader::read_elements(const AbaqusKeyword &key)
    {
      const std::string type = upper(key["TYPE"]);
      const auto starts = [&type](const std::string &prefix) { return type.compare(0, prefix.size(), prefix) == 0; };
      if (type.empty() || key.has("INPUT"))
        in.fail(type.empty() ? "*ELEMENT without TYPE" : "*ELEMENT with INPUT is not supported");
      const AbaqusElement kind = abaqus_element(type);
      if (!kind.problem.empty())
        in.fail(kind.problem);
      const unsigned int dim = kind.dim, n_nodes = kind.n_nodes;
      if (dim == 0)
        ++ignored["*ELEMENT, TYPE=" + type];
      if (starts("CPS"))
        mesh.plane_stress_types.insert(type);
      if (starts("CPE"))
        mesh.plane_strain_types.insert(type);
      if (starts("CAX"))
        mesh.axisymmetric_types.insert(type);
      const std::string               set = key["ELSET"];
      std::vector<unsigned long long> data; // of one element, which may take several lines
      in.for_data([&](const std::vector<std::string> &parts) {
        for (const std::string &part : parts)
          data.push_back(in.number(part));
        if (dim == 0)
          {
            sets.element_index.emplace(data.empty() ? 0 : data[0], AbaqusSets::no_element);
            data.clear();
            return;
          }
        if (data.size() < n_nodes + 1)
          return;
        if (data.size() > n_nodes + 1)
          in.fail("element " + std::to_string(data[0]) + " has more than the " + std::to_string(n_nodes) +
                  " nodes of " + type);
        const MeshFile::Element element = element_of(kind, data);
        if (!sets.element_index.emplace(data[0], mesh.elements.size()).second)
          in.fail("element " + std::to_string(data[0]) + " occurs twice");
        mesh.elements.push_back(element);
        if (!set.empty())
          sets.element_sets[named(set)].members.insert(data[0]);
        data.clear();
      });
      if (!data.empty())
        in.fail("the last element of type " + type + " lacks nodes");
    }

    void AbaqusReader::read_set(const AbaqusKeyword &key, const bool of_nodes)
    {
      const std::string name = key[of_nodes ? "NSET" : "ELSET"];
      if (name.empty())
        in.fail("a set without a name");
      if (of_nodes && key.has("ELSET"))
        in.fail("*NSET with ELSET is not supported; name the nodes, or the sides of the elements (*SURFACE)");
      auto &known = of_nodes ? sets.node_sets : sets.element_sets;
      auto &set   = known[named(name)];
      if (set.line == 0)
        set.line = in.place().line;
      const bool generate = key.has("GENERATE");
      in.for_data([&](const std::vector<std::string> &parts) {
        if (generate)
          {
            if (parts.size() < 2)
              in.fail("GENERATE needs first, last and step");
            const auto step = parts.size() > 2 ? in.number(parts[2]) : 1;
            if (step == 0 || in.number(parts[1]) < in.number(parts[0]))
              in.fail("GENERATE with step " + std::to_string(step) + " from " + parts[0] + " up to " + parts[1]);
            set.ranges.insert(AbaqusSet::Range{{in.number(parts[0]), in.number(parts[1]), step, in.place().line}});
            return;
          }
        for (const std::string &part : parts)
          if (parse_number(part))
            set.members.insert(in.number(part));
          else if (const auto other = known.find(upper(part)); other != known.end())
            set.add(other->second);
          else
            in.fail("there is no set '" + part + "' before this line");
      });
    }

    void AbaqusReader::read_surface(const AbaqusKeyword &key)
    {
      if (key["NAME"].empty())
        in.fail("a surface without a name");
      const std::string type = upper(key["TYPE"]);
      if ((type != "" && type != "ELEMENT" && type != "NODE") || key.has("COMBINE") || key.has("CROP"))
        in.fail("*SURFACE of this kind is not supported, only those of elements with their sides, and of nodes");
      const AbaqusSets::Key name = named(key["NAME"]);
      in.for_data([&](const std::vector<std::string> &parts) {
        const std::string side = parts.size() < 2 ? "" : upper(parts[1]);
        if (parts.empty() || parts[0].empty())
          in.fail("*SURFACE of everything is not supported; name sets of elements and their sides");
        if (type != "NODE")
          sets.surfaces[name].push_back({parts[0], side, in.place().line});
        else if (const auto set = sets.node_sets.find(upper(parts[0])); set != sets.node_sets.end())
          sets.node_sets[name].add(set->second);
        else
          sets.node_sets[name].members.insert(in.number(parts[0]));
      });
    }

    void AbaqusReader::list_ignored()
    {
      std::string all;
      for (const auto &[name, n] : ignored)
        all += (all.empty() ? "" : ", ") + name + (n > 1 ? " (" + std::to_string(n) + ")" : "");
      if (!all.empty())
        mesh.remarks.emplace_back(
          "mesh file " + mesh.file +
            ": only its mesh is used; materials, supports, loads and steps come from the scene. Not used: " + all,
          true);
    }

    MeshFile AbaqusReader::read()
    {
      unsigned int n_parts = 0, n_instances = 0;
      while (!in.at_end())
        {
          if (!in.is_keyword())
            in.fail("data without a keyword, or not an Abaqus input file");
          const AbaqusKeyword key = in.keyword();
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
            in.fail("*" + key.name + (n_parts > 1 || n_instances > 1 ? " (the second)" : "") + " is not supported");
          else
            {
              const bool is_placed = key.name == "INSTANCE";
              if (framing.count(key.name) == 0)
                ++ignored["*" + key.name];
              in.for_data([&](const std::vector<std::string> &) {
                if (is_placed)
                  in.fail("*INSTANCE with a translation or rotation is not supported");
              });
            }
        }
      add_groups(sets, mesh);
      list_ignored();
      return std::move(mesh);
    }
  } // namespace

  MeshFile parse_abaqus(const std::string &file, const std::string &text)
  {
    return AbaqusReader(file, text).read();
  }
} // namespace slipstick::mesh
