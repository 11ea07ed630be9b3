#include <slipstick/mesh/hexahedron_templates.h>

#include <algorithm>

namespace slipstick::mesh
{
  namespace
  {
    using Tensor = dealii::Tensor<1, 3>;

    constexpr unsigned int n_corners_of_cell = 8;

    using Quad = std::array<Place, 4>; // corners in cyclic order

    // Transition from three segments below (height 1) to one above (height 3): (along, height) in thirds of an edge.
    constexpr std::array<std::array<std::array<unsigned int, 2>, 4>, 4> three_to_one = {
      {{{{{0, 1}}, {{1, 1}}, {{1, 2}}, {{0, 3}}}},
       {{{{1, 1}}, {{2, 1}}, {{2, 2}}, {{1, 2}}}},
       {{{{2, 1}}, {{3, 1}}, {{3, 3}}, {{2, 2}}}},
       {{{{1, 2}}, {{2, 2}}, {{3, 3}}, {{0, 3}}}}}};

    /// The hexahedron between two quadrilaterals.
    Hexahedron between(const Quad &p, const Quad &q)
    {
      Tensor up, along, across;
      for (unsigned int k = 0; k < 4; ++k)
        up += vector_of(q[k]) - vector_of(p[k]);
      for (const Quad &face : {p, q})
        {
          along += vector_of(face[1]) + vector_of(face[2]) - vector_of(face[0]) - vector_of(face[3]);
          across += vector_of(face[3]) + vector_of(face[2]) - vector_of(face[0]) - vector_of(face[1]);
        }
      const bool  is_upright = cross_product_3d(along, across) * up > 0;
      const Quad &low = is_upright ? p : q, &high = is_upright ? q : p;
      return {{low[0], low[1], low[3], low[2], high[0], high[1], high[3], high[2]}};
    }

    Hexahedron small_cube(const unsigned int i, const unsigned int j, const unsigned int k)
    {
      const auto square = [&](const unsigned int z) {
        return Quad{
          {{{2 * i, 2 * j, z}}, {{2 * i + 2, 2 * j, z}}, {{2 * i + 2, 2 * j + 2, z}}, {{2 * i, 2 * j + 2, z}}}};
      };
      return between(square(2 * k), square(2 * k + 2));
    }

    Template at_corner()
    {
      Template cells = {small_cube(0, 0, 0)};
      for (unsigned int d = 0; d < 3; ++d)
        {
          const auto square = [d](const unsigned int size) {
            Quad quad;
            for (unsigned int k = 0; k < 4; ++k)
              {
                quad[k][d]           = size;
                quad[k][(d + 1) % 3] = k == 1 || k == 2 ? size : 0;
                quad[k][(d + 2) % 3] = k >= 2 ? size : 0;
              }
            return quad;
          };
          cells.push_back(between(square(2), square(n_parts)));
        }
      return cells;
    }

    // Marked edge along x at y = z = 0. The cells at this edge meet on the plane y = z.
    Template at_edge()
    {
      Template cells;
      for (unsigned int i = 0; i < 3; ++i)
        cells.push_back(small_cube(i, 0, 0));
      for (const unsigned int across : {1, 2})
        for (const auto &corners : three_to_one)
          {
            Quad outside, inside;
            for (unsigned int k = 0; k < 4; ++k)
              {
                const unsigned int x = 2 * corners[k][0], height = 2 * corners[k][1];
                outside[k]         = {{x, 0, 0}};
                outside[k][across] = height;
                inside[k]          = {{x, height, height}};
              }
            cells.push_back(between(outside, inside));
          }
      return cells;
    }

    // Marked face at z = 0: nine cubes, above them three times the transition from three segments along y to one, which
    // leaves three segments along x for the last cell.
    Template at_face()
    {
      Template cells;
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int i = 0; i < 3; ++i)
          cells.push_back(small_cube(i, j, 0));
      // heights 1, 2, 3 of the transition, in columns of constant x
      constexpr std::array<std::array<unsigned int, 3>, 4> heights = {
        {{{2, 4, 6}}, {{2, 3, 4}}, {{2, 3, 4}}, {{2, 4, 6}}}};
      for (unsigned int i = 0; i < 3; ++i)
        for (const auto &corners : three_to_one)
          {
            const auto on_column = [&](const unsigned int column) {
              Quad quad;
              for (unsigned int k = 0; k < 4; ++k)
                quad[k] = {{2 * column, 2 * corners[k][0], heights[column][corners[k][1] - 1]}};
              return quad;
            };
            cells.push_back(between(on_column(i), on_column(i + 1)));
          }
      const auto last = [](const unsigned int y) { return Quad{{{{2, y, 4}}, {{4, y, 4}}, {{6, y, 6}}, {{0, y, 6}}}}; };
      cells.push_back(between(last(0), last(n_parts)));
      return cells;
    }

    Template everywhere()
    {
      Template cells;
      for (unsigned int k = 0; k < 3; ++k)
        for (unsigned int j = 0; j < 3; ++j)
          for (unsigned int i = 0; i < 3; ++i)
            cells.push_back(small_cube(i, j, k));
      return cells;
    }

    std::map<Marks, Template> made_templates()
    {
      std::map<Marks, Template> result;
      for (const auto &[marks, cells] : {std::pair<Marks, Template>(0x01, at_corner()),
                                         {0x03, at_edge()},
                                         {0x0f, at_face()},
                                         {all_corners, everywhere()}})
        {
          std::array<unsigned int, 3> axes = {{0, 1, 2}};
          do // all rotations and reflections
            for (unsigned int mirrored = 0; mirrored < n_corners_of_cell; ++mirrored)
              {
                const auto moved = [&, &axes = axes](const Place &place) {
                  Place at;
                  for (unsigned int d = 0; d < 3; ++d)
                    at[axes[d]] = mirrored >> d & 1 ? n_parts - place[d] : place[d];
                  return at;
                };
                Marks now = 0;
                for (unsigned int c = 0; c < n_corners_of_cell; ++c)
                  if (marks >> c & 1)
                    {
                      const Place at = moved({{n_parts * (c & 1), n_parts * (c >> 1 & 1), n_parts * (c >> 2 & 1)}});
                      now |= 1u << (at[0] / n_parts + 2 * (at[1] / n_parts) + 4 * (at[2] / n_parts));
                    }
                if (result.count(now) > 0)
                  continue;
                for (const auto &cell : cells)
                  {
                    const auto face = [&](const unsigned int first) {
                      return Quad{
                        {moved(cell[first]), moved(cell[first + 1]), moved(cell[first + 3]), moved(cell[first + 2])}};
                    };
                    result[now].push_back(between(face(0), face(4)));
                  }
              }
          while (std::next_permutation(axes.begin(), axes.end()));
        }
      return result;
    }
  } // namespace

  dealii::Tensor<1, 3> vector_of(const Place &place)
  {
    return Tensor({double(place[0]), double(place[1]), double(place[2])});
  }

  const std::map<Marks, Template> &templates_by_marks()
  {
    static const std::map<Marks, Template> templates = made_templates();
    return templates;
  }

  Marks convex(const Marks marks)
  {
    Marks all = n_corners_of_cell - 1, any = 0; // coordinates that are 1 at all corners, at any corner
    for (unsigned int c = 0; c < n_corners_of_cell; ++c)
      if (marks >> c & 1)
        {
          all &= c;
          any |= c;
        }
    Marks result = 0;
    for (unsigned int c = 0; c < n_corners_of_cell && marks != 0; ++c)
      if ((c & all) == all && (c | any) == any)
        result |= 1u << c;
    return result;
  }
} // namespace slipstick::mesh
