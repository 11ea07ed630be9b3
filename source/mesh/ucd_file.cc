// AVS' unstructured cell data, ASCII:
// https://dav.lbl.gov/archive/NERSC/Software/express/help6.1/help/reference/dvmac/UCD_Form.htm
#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/word_reader.h>

#include <unordered_map>

namespace slipstick::mesh
{
  MeshFile parse_ucd(const std::string &file, const std::string &text)
  {
    WordReader in(file,
                  text,
                  "write it again (.ucd in ASCII with pt, line, tri and quad cells), or convert it to Gmsh's .msh");
    MeshFile   mesh;
    mesh.file        = file;
    in.section       = "header";
    std::string word = in.word();
    while (!word.empty() && word[0] == '#')
      {
        in.line();
        word = in.word();
      }
    std::size_t n_nodes = 0;
    try
      {
        n_nodes = std::stoul(word);
      }
    catch (const std::exception &)
      {
        in.fail("is not a .ucd file: it does not start with the number of its nodes");
      }
    const auto n_cells = in.count(1);
    in.line(); // sizes of the data
    std::unordered_map<long long, unsigned int> index_of_node;
    in.section = "of nodes";
    for (std::size_t k = 0; k < n_nodes; ++k)
      {
        const auto number = in.integer();
        if (!index_of_node.emplace(number, mesh.nodes.size()).second)
          in.fail("node " + std::to_string(number) + " occurs twice");
        const double x = in.real(), y = in.real(), z = in.real();
        mesh.nodes.emplace_back(x, y, z);
      }
    in.section = "of cells";
    std::map<int, unsigned int> group_of;
    for (std::size_t c = 0; c < n_cells; ++c)
      {
        MeshFile::Element element;
        element.number      = in.integer();
        const auto material = in.integer();
        if (material < -1000000000 || material > 1000000000)
          in.fail_corrupt();
        const std::string type = in.word();
        if (type == "hex" || type == "tet" || type == "prism" || type == "pyr")
          {
            element.dim = 3;
            element.n   = type == "hex" ? 8 : type == "prism" ? 6 : type == "pyr" ? 5 : 4;
          }
        else if (type == "pt" || type == "line" || type == "tri" || type == "quad")
          {
            element.dim = type == "pt" ? 0 : type == "line" ? 1 : 2;
            element.n   = type == "quad" ? 4 : element.dim + 1;
          }
        else
          in.fail("cell " + std::to_string(element.number) + " is of type '" + type + "', which is not supported");
        for (unsigned int k = 0; k < element.n; ++k)
          {
            const auto node  = in.integer();
            const auto found = index_of_node.find(node);
            if (found == index_of_node.end())
              in.fail("cell " + std::to_string(element.number) + " has node " + std::to_string(node) +
                      ", which is not in the file");
            element.corners[k] = found->second;
          }
        const auto [found, is_new] = group_of.emplace(material, mesh.groups.size());
        if (is_new)
          mesh.groups.push_back({static_cast<int>(material)});
        element.group = found->second;
        mesh.elements.push_back(element);
      }
    if (!in.word().empty())
      mesh.remarks.push_back("mesh file " + file + ": the data after the cells are not used");
    mesh.add_outline();
    return mesh;
  }
} // namespace slipstick::mesh
