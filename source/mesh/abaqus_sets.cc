#include <slipstick/mesh/abaqus_lines.h>
#include <slipstick/mesh/abaqus_sets.h>

namespace slipstick::mesh
{
  namespace
  {
    class GroupsOfSets
    {
    public:
      GroupsOfSets(const AbaqusSets &sets_, MeshFile &mesh_)
        : sets(sets_)
        , mesh(mesh_)
        , dim_of_cells(mesh_.dimension())
      {}

      void add_element_sets();
      void add_node_sets();
      void add_surfaces();

    private:
      using Key     = AbaqusSets::Key;
      using Numbers = std::set<unsigned long long>;

      unsigned int group(const std::set<int> &physicals);

      /// Members with expanded ranges. @throws InputError for one that is not in @p index.
      Numbers written_out(const Key               &key,
                          const AbaqusSet         &set,
                          const AbaqusSets::Index &index,
                          const std::string       &what) const;

      /// @param n_cells by side: a surface without labels consists of all sides with one cell. Lines of plane meshes and
      /// faces of solids are sides themselves.
      void add_side(const MeshFile::Element                      &cell,
                    const AbaqusSide                             &side,
                    const Key                                    &key,
                    const std::map<MeshFile::Side, unsigned int> &n_cells);

      AbaqusPlace place(const unsigned int line) const
      {
        return {mesh.file, line};
      }

      const AbaqusSets                     &sets;
      MeshFile                             &mesh;
      const unsigned int                    dim_of_cells;
      std::map<Key, Numbers>                elements_of; // element sets
      std::map<std::set<int>, unsigned int> index_of_group;
    };

    unsigned int GroupsOfSets::group(const std::set<int> &physicals)
    {
      const auto [found, is_new] = index_of_group.emplace(physicals, mesh.groups.size());
      if (is_new)
        mesh.groups.emplace_back(physicals.begin(), physicals.end());
      return found->second;
    }

    GroupsOfSets::Numbers GroupsOfSets::written_out(const Key               &key,
                                                    const AbaqusSet         &set,
                                                    const AbaqusSets::Index &index,
                                                    const std::string       &what) const
    {
      Numbers all = set.members;
      for (const auto &[first, last, step, line] : set.ranges)
        {
          if ((last - first) / step >= index.size())
            place(line).fail("GENERATE with step " + std::to_string(step) + " from " + std::to_string(first) +
                             " up to " + std::to_string(last) + ": there are " + std::to_string(index.size()) + " " +
                             what + "s only");
          for (auto k = first; k <= last; k += step)
            all.insert(k);
        }
      for (const auto tag : all)
        if (index.count(tag) == 0)
          place(set.line).fail("set '" + key + "' has " + what + " " + std::to_string(tag) +
                               ", which is not in the file");
      return all;
    }

    void GroupsOfSets::add_element_sets()
    {
      std::vector<std::set<int>> physicals(mesh.elements.size());
      for (const auto &[key, set] : sets.element_sets)
        for (const auto tag : elements_of[key] = written_out(key, set, sets.element_index, "element"))
          if (const auto e = sets.element_index.at(tag); e != AbaqusSets::no_element)
            physicals[e].insert(sets.physical_of.at(key));
      for (std::size_t e = 0; e < physicals.size(); ++e)
        mesh.elements[e].group = group(physicals[e]);
    }

    void GroupsOfSets::add_node_sets()
    {
      for (const auto &[key, set] : sets.node_sets)
        {
          const std::string name  = mesh.name_of(0, sets.physical_of.at(key));
          auto             &nodes = mesh.node_sets[name];
          for (const auto tag : written_out(key, set, sets.node_index, "node"))
            nodes.push_back(sets.node_index.at(tag));
          if (nodes.empty())
            mesh.node_sets.erase(name);
          else
            mesh.add_sides_of_node_set(name, group({sets.physical_of.at(key)}));
        }
    }

    void GroupsOfSets::add_surfaces()
    {
      std::map<MeshFile::Side, unsigned int> n_cells;
      for (const auto &cell : mesh.elements)
        if (cell.dim == dim_of_cells)
          for (const auto &side : sides_of(cell))
            ++n_cells[side.sorted()];
      for (const auto &[key, sides] : sets.surfaces)
        for (const AbaqusSide &side : sides)
          {
            const auto set = elements_of.find(upper(side.of));
            for (const auto tag : set != elements_of.end() ? set->second : Numbers{place(side.line).number(side.of)})
              {
                const auto found = sets.element_index.find(tag);
                if (found == sets.element_index.end() || found->second == AbaqusSets::no_element)
                  place(side.line).fail("surface '" + key + "' has element " + std::to_string(tag) +
                                        ", which is not in the file");
                add_side(MeshFile::Element(mesh.elements[found->second]), // a copy, since elements are added
                         side,
                         key,
                         n_cells);
              }
          }
    }

    void GroupsOfSets::add_side(const MeshFile::Element                      &cell,
                                const AbaqusSide                             &side,
                                const Key                                    &key,
                                const std::map<MeshFile::Side, unsigned int> &n_cells)
    {
      const std::string &label = side.label;
      const auto         fail  = [&](const std::string &which_has) {
        place(side.line).fail("surface '" + key + "' has side " + label + " of element " + std::to_string(cell.number) +
                              ", which has sides " + which_has);
      };
      const auto add = [&](MeshFile::Element element) {
        element.number = cell.number;
        element.group  = group({sets.physical_of.at(key)});
        mesh.elements.push_back(element);
      };
      if (cell.dim < dim_of_cells)
        {
          if (!label.empty() && label != "SPOS" && label != "SNEG")
            fail("SPOS and SNEG");
          return add(cell);
        }
      const auto  of_cell = sides_of(cell);
      std::size_t which   = of_cell.size();
      if (label.size() == 2 &&
          (label[0] == 'S' || (label[0] == 'E' && cell.dim == 2))) // sides of cells, edges of shells
        which = label[1] - '1';
      if (!label.empty() && which >= of_cell.size())
        fail("S1 to S" + std::to_string(of_cell.size()));
      for (std::size_t k = 0; k < of_cell.size(); ++k)
        if (label.empty() ? n_cells.at(of_cell[k].sorted()) == 1 : k == which)
          add(of_cell[k].element());
    }
  } // namespace

  void add_groups(const AbaqusSets &sets, MeshFile &mesh)
  {
    GroupsOfSets groups(sets, mesh);
    groups.add_element_sets();
    groups.add_node_sets();
    groups.add_surfaces();
  }
} // namespace slipstick::mesh
