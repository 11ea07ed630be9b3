// Sets and surfaces of an Abaqus input file, and the groups of a mesh that they define.
#pragma once

#include <slipstick/mesh/mesh_file.h>

#include <array>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

namespace slipstick::mesh
{
  /// Members of a set: numbers, and ranges of GENERATE, which are checked against the existing numbers before they are
  /// expanded.
  struct AbaqusSet
  {
    using Range = std::array<unsigned long long, 4>; // first, last, step, line in the file

    std::set<unsigned long long> members;
    std::set<Range>              ranges;
    unsigned int                 line = 0; // of its first keyword

    void add(const AbaqusSet &other)
    {
      members.insert(other.members.begin(), other.members.end());
      ranges.insert(other.ranges.begin(), other.ranges.end());
    }
  };

  /// A side of an element, or of all elements of a set.
  struct AbaqusSide
  {
    std::string  of, label; // S1, SPOS, ..; empty: all sides with one cell
    unsigned int line;      // in the file
  };

  struct AbaqusSets
  {
    using Key   = std::string; // name of a set in capitals, since Abaqus is not case-sensitive
    using Index = std::unordered_map<unsigned long long, unsigned int>; // by number in the file

    static constexpr unsigned int no_element = -1; // index of elements that are recognised but not stored

    Index                                  node_index, element_index;
    std::map<Key, int>                     physical_of;
    std::map<Key, AbaqusSet>               node_sets, element_sets;
    std::map<Key, std::vector<AbaqusSide>> surfaces;
  };

  /// Element sets define cells and lines (for solids: faces); node sets define the edges or faces between them, and
  /// points; surfaces define sides of elements.
  /// @param mesh has nodes, elements and names.
  /// @throws InputError for members that are not in the file.
  void add_groups(const AbaqusSets &sets, MeshFile &mesh);
} // namespace slipstick::mesh
