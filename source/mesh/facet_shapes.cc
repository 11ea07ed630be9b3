#include <slipstick/mesh/facet_shapes.h>

namespace slipstick::mesh
{
  namespace
  {
    // Quadratic shape functions of the ends and the middle of the unit interval, and their derivatives.
    std::array<double, 3> on_interval(const double s)
    {
      return {{(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)}};
    }
    std::array<double, 3> derivatives_on_interval(const double s)
    {
      return {{4 * s - 3, 4 * s - 1, 4 - 8 * s}};
    }

    // For the nodes of a quadrilateral: index of the function in s and in t.
    constexpr std::array<std::array<unsigned int, 2>, 9> functions_of_node = {
      {{{0, 0}}, {{1, 0}}, {{1, 1}}, {{0, 1}}, {{2, 0}}, {{1, 2}}, {{2, 1}}, {{0, 2}}, {{2, 2}}}};
  } // namespace

  FacetShapes::Shape FacetShapes::linear(const unsigned int n_corners, const Place &s)
  {
    if (n_corners == 3)
      return {{1 - s[0] - s[1], s[0], s[1]}};
    return {{(1 - s[0]) * (1 - s[1]), s[0] * (1 - s[1]), s[0] * s[1], (1 - s[0]) * s[1]}};
  }

  FacetShapes::Shape FacetShapes::quadratic(const unsigned int n_corners, const Place &s)
  {
    Shape N{};
    if (n_corners == 3)
      {
        const Shape L = linear(3, s);
        for (unsigned int i = 0; i < 3; ++i)
          {
            N[i]     = L[i] * (2 * L[i] - 1);
            N[3 + i] = 4 * L[i] * L[(i + 1) % 3];
          }
        return N;
      }
    const auto a = on_interval(s[0]), b = on_interval(s[1]);
    for (unsigned int i = 0; i < functions_of_node.size(); ++i)
      N[i] = a[functions_of_node[i][0]] * b[functions_of_node[i][1]];
    return N;
  }

  FacetShapes::Derivatives FacetShapes::quadratic_derivatives(const unsigned int n_corners, const Place &s)
  {
    Derivatives result{};
    if (n_corners == 4)
      {
        const auto a = on_interval(s[0]), b = on_interval(s[1]), da = derivatives_on_interval(s[0]),
                   db = derivatives_on_interval(s[1]);
        for (unsigned int i = 0; i < functions_of_node.size(); ++i)
          result[i] = {{da[functions_of_node[i][0]] * b[functions_of_node[i][1]],
                        a[functions_of_node[i][0]] * db[functions_of_node[i][1]]}};
        return result;
      }
    const std::array<double, 3>                    L  = {{1 - s[0] - s[1], s[0], s[1]}};
    constexpr std::array<std::array<double, 2>, 3> dL = {{{{-1, -1}}, {{1, 0}}, {{0, 1}}}};
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int d = 0; d < 2; ++d)
        {
          const unsigned int j = (i + 1) % 3;
          result[i][d]         = (4 * L[i] - 1) * dL[i][d];
          result[3 + i][d]     = 4 * (L[i] * dL[j][d] + L[j] * dL[i][d]);
        }
    return result;
  }

  FacetShapes::Place FacetShapes::node(const unsigned int n_corners, const unsigned int i)
  {
    constexpr std::array<double, 3> ends_and_middle = {{0, 1, 0.5}};
    if (n_corners == 4)
      return {ends_and_middle[functions_of_node[i][0]], ends_and_middle[functions_of_node[i][1]]};
    constexpr std::array<std::array<double, 2>, 6> triangle = {
      {{{0, 0}}, {{1, 0}}, {{0, 1}}, {{0.5, 0}}, {{0.5, 0.5}}, {{0, 0.5}}}};
    return {triangle[i][0], triangle[i][1]};
  }
} // namespace slipstick::mesh
