// The cells of a mesh file that belong to one body.
#pragma once

#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/mesh_piece.h>
#include <slipstick/scene/scene.h>

#include <array>
#include <string>
#include <vector>

namespace slipstick::mesh
{
  /// Dimension-dependent words for messages.
  template <int dim>
  struct Words
  {
    static constexpr const char *face = dim == 2 ? "edge" : "face", *boundary = dim == 2 ? "line" : "face",
                                *physical = dim == 2 ? "Physical Surface" : "Physical Volume";
  };

  /// The cell of an element; @p number maps its nodes to vertices.
  template <int dim, class Number>
  typename MeshPiece<dim>::Cell cell_of(const MeshFile::Element &element, const Number &number)
  {
    typename MeshPiece<dim>::Cell v;
    v.fill(MeshPiece<dim>::no_vertex);
    for (unsigned int k = 0; k < element.n; ++k)
      v[k] = number(element.corners[k]);
    if (!is_simplex<dim>(v)) // from cyclic to lexicographic order
      for (unsigned int k = 2; k < element.n; k += 4)
        std::swap(v[k], v[k + 1]);
    return v;
  }

  /// The cells of Body::part, or all of the file, without duplicates, right-handed (counterclockwise in the plane),
  /// with positive Jacobians at all corners.
  template <int dim>
  class PartOfFile
  {
  public:
    using Element = MeshFile::Element;

    /// Both arguments must outlive this.
    /// @throws InputError for a missing part; a file without cells of this dimension; plane cells that are not in a
    /// plane z = constant; cells that are inverted (unless all are), degenerate or self-intersecting.
    PartOfFile(const scene::Body<dim> &body, const MeshFile &file);

    const std::vector<Element> &cells() const
    {
      return chosen;
    }

    /// "cell 7 at (1, 2)", with the number used in the file.
    std::string cell_text(unsigned int c) const;

    /// Throws an InputError that names body and file.
    [[noreturn]] void fail(const std::string &problem, const std::string &remedy) const;

  private:
    std::string plane_types() const;
    void        choose_cells();
    void        check_kinds(const std::array<std::size_t, 4> &n) const;
    void        check_plane() const;
    void        check_shapes();
    void        check_shapes_of_solids();
    void        fail_inverted(const std::vector<unsigned int> &inverted,
                              const std::string               &how,
                              const std::string               &remedy) const;

    const scene::Body<dim> &body;
    const MeshFile         &file;
    std::vector<Element>    chosen;
  };
} // namespace slipstick::mesh
