#include <slipstick/base/cross.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/part_of_file.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace slipstick::mesh
{
  namespace
  {
    constexpr double       flat_tolerance = 1e-8; // of z, over the size of the body
    constexpr double       least_sine     = 1e-6; // of the angles of a cell, in space of their volumes
    constexpr unsigned int named_cells    = 3;    // maximum number in messages
  }                                               // namespace

  template <int dim>
  PartOfFile<dim>::PartOfFile(const scene::Body<dim> &body, const MeshFile &file)
    : body(body)
    , file(file)
  {
    choose_cells();
    check_plane();
    check_shapes();
  }

  template <int dim>
  void PartOfFile<dim>::fail(const std::string &problem, const std::string &remedy) const
  {
    throw InputError("Body " + body.name + ": mesh file " + file.file + " " + problem, remedy);
  }

  template <int dim>
  std::string PartOfFile<dim>::cell_text(const unsigned int c) const
  {
    const Element   &cell = chosen[c];
    dealii::Point<3> center;
    for (unsigned int k = 0; k < cell.n; ++k)
      center += (file.nodes[cell.corners[k]] - dealii::Point<3>()) / cell.n;
    return "cell " + std::to_string(cell.number) + " at " + point_text(center, dim);
  }

  /// Types of plane elements, which are faces in files with solids.
  template <int dim>
  std::string PartOfFile<dim>::plane_types() const
  {
    std::string all;
    for (const auto *types : {&file.plane_stress_types, &file.plane_strain_types, &file.axisymmetric_types})
      for (const std::string &type : *types)
        all += (all.empty() ? " (" : ", ") + type;
    return all.empty() ? all : all + ")";
  }

  template <int dim>
  void PartOfFile<dim>::choose_cells()
  {
    std::set<std::array<unsigned int, 8>> seen; // version 2 lists a cell once for every physical name
    std::set<std::string>                 parts;
    std::array<std::size_t, 4>            n = {{0, 0, 0, 0}}; // by dimension
    for (const Element &element : file.elements)
      {
        ++n[element.dim];
        if (element.dim != dim)
          continue;
        for (const int physical : file.groups[element.group])
          parts.insert(file.name_of(dim, physical));
        if (!file.is_in(element, body.part))
          continue;
        auto key = element.corners;
        std::fill(key.begin() + element.n, key.end(), MeshPiece<dim>::no_vertex);
        std::sort(key.begin(), key.end());
        if (seen.insert(key).second)
          chosen.push_back(element);
      }
    check_kinds(n);
    if (chosen.empty())
      fail("has no part '" + body.part + "'",
           suggest_name(body.part, std::vector<std::string>(parts.begin(), parts.end())) +
             (parts.empty() ? std::string(dim == 2 ? "; name its surfaces (" : "; name its volumes (") +
                                Words<dim>::physical + "), or omit Part to take all cells"
                            : "") +
             file.about_names);
    for (const Element &cell : chosen)
      if (dim == 3 && cell.n != 4 && cell.n != 8)
        fail("has a " + std::string(cell.n == 6 ? "wedge" : "pyramid") + ", cell " + std::to_string(cell.number),
             "mesh with tetrahedra or hexahedra alone");
  }

  /// @param n elements of the file, by dimension.
  template <int dim>
  void PartOfFile<dim>::check_kinds(const std::array<std::size_t, 4> &n) const
  {
    if (dim == 2 && n[3] > 0)
      fail("is three-dimensional, it has " + std::to_string(n[3]) + " cells with a volume",
           "give a plane mesh of triangles and quadrilaterals: gmsh -2 part.geo");
    if (dim == 2 && n[2] == 0)
      fail("has no cells, only " + std::to_string(n[1]) + " lines and " + std::to_string(n[0]) + " points",
           "mesh the surfaces, and if physical names are used, name them too: Physical Surface(\"part\") = {1}; gmsh "
           "-2 part.geo");
    if (dim == 3 && n[3] == 0)
      fail("has no solid cells, only " + std::to_string(n[2]) + " faces" + plane_types() + ", " + std::to_string(n[1]) +
             " lines and " + std::to_string(n[0]) + " points",
           "mesh the volumes, and if physical names are used, name them too: Physical Volume(\"part\") = {1}; gmsh -3 "
           "part.geo; or set Dimension = 2");
  }

  template <int dim>
  void PartOfFile<dim>::check_plane() const
  {
    if (dim == 3)
      return;
    std::array<double, 3> low, high;
    low.fill(std::numeric_limits<double>::max());
    high.fill(-std::numeric_limits<double>::max());
    for (const Element &cell : chosen)
      for (unsigned int k = 0; k < cell.n; ++k)
        for (unsigned int d = 0; d < 3; ++d)
          {
            low[d]  = std::min(low[d], file.nodes[cell.corners[k]][d]);
            high[d] = std::max(high[d], file.nodes[cell.corners[k]][d]);
          }
    const double size = std::max(high[0] - low[0], high[1] - low[1]);
    if (high[2] - low[2] > flat_tolerance * std::max(size, high[2] - low[2]))
      fail("does not lie in a plane z = constant: z goes from " + number_text(low[2]) + " to " + number_text(high[2]),
           "give the mesh in the x, y plane");
  }

  template <int dim>
  void PartOfFile<dim>::fail_inverted(const std::vector<unsigned int> &inverted,
                                      const std::string               &how,
                                      const std::string               &remedy) const
  {
    std::string some;
    for (unsigned int k = 0; k < inverted.size() && k < named_cells; ++k)
      some += (k > 0 ? ", " : "") + cell_text(inverted[k]);
    fail("has " + std::to_string(inverted.size()) + " of " + std::to_string(chosen.size()) + " cells " + how + ": " +
           some + (inverted.size() > named_cells ? ", ..." : ""),
         remedy);
  }

  /// Checks for positive Jacobians at all corners.
  template <int dim>
  void PartOfFile<dim>::check_shapes_of_solids()
  {
    // at every corner the nodes along its three edges, right-handed
    constexpr std::array<std::array<unsigned int, 3>, 4> of_tetrahedron = {
      {{{1, 2, 3}}, {{2, 0, 3}}, {{0, 1, 3}}, {{0, 2, 1}}}};
    constexpr std::array<std::array<unsigned int, 3>, 8> of_hexahedron = {
      {{{1, 3, 4}}, {{2, 0, 5}}, {{3, 1, 6}}, {{0, 2, 7}}, {{7, 5, 0}}, {{4, 6, 1}}, {{5, 7, 2}}, {{6, 4, 3}}}};
    std::vector<unsigned int> inverted;
    for (unsigned int c = 0; c < chosen.size(); ++c)
      {
        const Element &cell  = chosen[c];
        unsigned int   right = 0, left = 0;
        for (unsigned int k = 0; k < cell.n; ++k)
          {
            const auto                         &ends = cell.n == 4 ? of_tetrahedron[k] : of_hexahedron[k];
            std::array<dealii::Tensor<1, 3>, 3> edge;
            for (unsigned int d = 0; d < 3; ++d)
              edge[d] = file.nodes[cell.corners[ends[d]]] - file.nodes[cell.corners[k]];
            const double volume = cross_product_3d(edge[0], edge[1]) * edge[2];
            const double scale  = edge[0].norm() * edge[1].norm() * edge[2].norm();
            right += volume > least_sine * scale;
            left += volume < -least_sine * scale;
          }
        if (right != cell.n && left != cell.n)
          fail(std::string("has a degenerate cell: ") + cell_text(c) +
                 (left > 0 && right > 0 ? " is turned inside out at some of its corners"
                                        : " has no volume at a corner"),
               "mesh again, or repair the geometry there (doubled or nearly equal points)");
        if (left > 0)
          inverted.push_back(c);
      }
    if (!inverted.empty() && inverted.size() < chosen.size())
      fail_inverted(inverted, "turned inside out", "give all cells the same orientation");
    for (const unsigned int c : inverted) // all cells are inverted
      if (auto &v = chosen[c].corners; chosen[c].n == 4)
        std::swap(v[0], v[1]);
      else
        std::swap_ranges(v.begin(), v.begin() + 4, v.begin() + 4);
  }

  /// Orients cells counterclockwise and checks that angles are in (0, 180) degrees.
  template <int dim>
  void PartOfFile<dim>::check_shapes()
  {
    if (dim == 3)
      return check_shapes_of_solids();
    // orientation from the sum over the corners; self-intersecting or non-convex cells have corners of both signs
    std::vector<unsigned int> clockwise;
    for (unsigned int c = 0; c < chosen.size(); ++c)
      {
        const Element &cell = chosen[c];
        const auto     edge = [&](const unsigned int k) {
          const auto d = file.nodes[cell.corners[(k + 1) % cell.n]] - file.nodes[cell.corners[k % cell.n]];
          return dealii::Tensor<1, 2>(dealii::Point<2>(d[0], d[1]));
        };
        unsigned int left = 0, right = 0;
        for (unsigned int k = 0; k < cell.n; ++k)
          {
            const auto   a = edge(k), b = edge(k + 1);
            const double area = cross(a, b), smallest = least_sine * a.norm() * b.norm();
            left += area > smallest;
            right += area < -smallest;
          }
        if (left != cell.n && right != cell.n)
          fail(std::string("has a degenerate cell: ") + cell_text(c) + " " +
                 (left > 0 && right > 0 ? "intersects itself or is not convex"
                  : left + right == 0   ? "has no area"
                                        : "has a corner of 0 or 180 degrees"),
               "mesh again, or repair the geometry there (doubled or nearly equal points)");
        if (right > 0)
          clockwise.push_back(c);
      }
    if (!clockwise.empty() && clockwise.size() < chosen.size())
      fail_inverted(
        clockwise,
        "with clockwise orientation",
        "give all cells the same orientation (in Gmsh: Recombine after Coherence, or ReverseMesh on the surface)");
    for (const unsigned int c : clockwise) // all cells are clockwise
      std::reverse(chosen[c].corners.begin(), chosen[c].corners.begin() + chosen[c].n);
  }

  template class PartOfFile<2>;
  template class PartOfFile<3>;
} // namespace slipstick::mesh
