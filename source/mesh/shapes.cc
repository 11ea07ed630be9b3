#include <slipstick/mesh/shapes.h>

#include <cmath>
#include <functional>
#include <numeric>

namespace slipstick::mesh
{
  namespace
  {
    constexpr unsigned int automatic_cells_around = 64; // of a whole ring

    constexpr double core_corner =
      1.15; // quarter disc: outer corner of its core, relative to the other two: angles of 116 degrees

    /// Point of the unit circle at @p fraction of the whole circle; exact at multiples of a quarter.
    dealii::Tensor<1, 2> on_circle(const double fraction)
    {
      const double         turn    = fraction - std::floor(fraction);
      const int            quarter = static_cast<int>(std::lround(4 * turn));
      const double         angle   = 2 * dealii::numbers::PI * (turn - quarter / 4.); // within an eighth on either side
      const double         c = std::cos(angle), s = std::sin(angle);
      const double         x[4] = {c, -s, -c, s}, y[4] = {s, c, -s, -c};
      dealii::Tensor<1, 2> point;
      point[0] = x[quarter % 4];
      point[1] = y[quarter % 4];
      return point;
    }

    void number_vertices(MeshPiece<2> &piece)
    {
      piece.global_vertices.resize(piece.vertices.size());
      std::iota(piece.global_vertices.begin(), piece.global_vertices.end(), GlobalVertex(0));
    }

    /// Sets the arcs of the faces on boundary @p id, or the neglected sagitta if the outline is to be polygonal.
    void bend(MeshPiece<2> &piece, const scene::Body<2> &body, const dealii::types::boundary_id id)
    {
      for (auto &face : piece.boundary_faces)
        if (face.id == id)
          {
            const auto arc =
              EdgeCurve<2>::arc(piece.vertices[face.vertices[0]], piece.vertices[face.vertices[1]], body.center);
            if (body.has_smooth_outline)
              face.curve = arc;
            else
              face.curve.neglected_sagitta = sagitta(arc);
          }
    }

    /// A whole ring, or its quarter between the positive axes: inner 0, outer 1, start 2, end 3.
    MeshPiece<2> ring(const scene::Body<2> &body, const unsigned int refinements)
    {
      const bool   whole = body.shape == scene::Shape::ring;
      const double turn = whole ? 1 : .25, r = body.inner_radius, R = body.radius;
      unsigned int around = whole ? automatic_cells_around : automatic_cells_around / 4;
      const double h      = dealii::numbers::PI * turn * (r + R) / around;
      unsigned int across = static_cast<unsigned int>(std::max(1., std::round((R - r) / h)));
      if (body.cells)
        {
          around = (*body.cells)[0];
          across = (*body.cells)[1];
        }
      around <<= refinements;
      across <<= refinements;

      MeshPiece<2>       piece;
      const unsigned int n_rays = whole ? around : around + 1;
      const auto vertex = [&](const unsigned int i, const unsigned int j) { return (i % n_rays) * (across + 1) + j; };
      for (unsigned int i = 0; i < n_rays; ++i)
        for (unsigned int j = 0; j <= across; ++j)
          piece.vertices.push_back(body.center +
                                   (j == across ? R : r + (R - r) * j / across) * on_circle(turn * i / around));
      for (unsigned int i = 0; i < around; ++i)
        {
          for (unsigned int j = 0; j < across; ++j)
            piece.cells.push_back(
              quadrilateral<2>(vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)));
          piece.boundary_faces.push_back({{{vertex(i, 0), vertex(i + 1, 0)}}, 0});
          piece.boundary_faces.push_back({{{vertex(i, across), vertex(i + 1, across)}}, 1});
        }
      for (unsigned int j = 0; j < across && !whole; ++j)
        {
          piece.boundary_faces.push_back({{{vertex(0, j), vertex(0, j + 1)}}, 2});
          piece.boundary_faces.push_back({{{vertex(around, j), vertex(around, j + 1)}}, 3});
        }
      bend(piece, body, 0);
      bend(piece, body, 1);
      return piece;
    }

    /// A disc, or the half below its centre: arc 0, flat 1.
    MeshPiece<2> disc(const scene::Body<2> &body, const unsigned int refinements)
    {
      const bool   whole = body.shape == scene::Shape::disc;
      const double R     = body.radius;
      // The loop around the core: left side downwards, bottom, right side upwards and, for a whole disc, the top. Even
      // numbers of cells on the bottom (and the sides of a disc) give vertices on the axes.
      unsigned int n_side, n_bottom;
      if (whole)
        {
          const unsigned int quarter = body.cells_along_arc / 4;
          n_bottom                   = quarter + quarter % 2;
          n_side                     = 2 * quarter - n_bottom;
        }
      else
        {
          n_side   = body.cells_along_arc / 4;
          n_bottom = body.cells_along_arc - 2 * n_side;
        }
      unsigned int n_loop       = whole ? 2 * (n_side + n_bottom) : 2 * n_side + n_bottom;
      const double circle_cells = whole ? n_loop : 2. * n_loop;
      unsigned int n_layers     = static_cast<unsigned int>(
        std::max(1., std::round((1 - core_radius) / (1 + core_radius) * circle_cells / dealii::numbers::PI)));
      n_side <<= refinements;
      n_bottom <<= refinements;
      n_loop <<= refinements;
      n_layers <<= refinements;

      // points of the loop, by their index l
      const double turn  = whole ? 1. : .5;
      const double start = whole ? .5 - .5 * n_side / n_loop : .5; // fraction of the circle where the left side begins
      const auto   arc   = [&](const unsigned int l) { return on_circle(start + turn * l / n_loop); };
      const std::vector<unsigned int> ends = {0, n_side, n_side + n_bottom, 2 * n_side + n_bottom, n_loop}; // of sides
      const auto                      core = [&](const unsigned int l) {
        unsigned int side = 0;
        while (side < 3 && l > ends[side + 1])
          ++side;
        const unsigned int n = ends[side + 1] - ends[side];
        const double       s = double(l - ends[side]) / n;
        return core_radius *
               (core_bending * arc(l) + (1 - core_bending) * ((1 - s) * arc(ends[side]) + s * arc(ends[side + 1])));
      };

      MeshPiece<2> piece;
      // core: lattice of n_bottom x n_side cells from the top left corner, a Coons patch of its sides
      const auto place_on_loop = [&](const unsigned int i, const unsigned int j) -> int { // j counts downwards
        if (i == 0)
          return j;
        if (j == n_side)
          return n_side + i;
        if (i == n_bottom)
          return n_side + n_bottom + (n_side - j);
        if (j == 0 && whole)
          return 2 * n_side + n_bottom + (n_bottom - i);
        return -1;
      };
      const auto top = [&](const unsigned int i) {
        const double u = double(i) / n_bottom;
        return whole ? core((2 * n_side + n_bottom + (n_bottom - i)) % n_loop) : (1 - u) * core(0) + u * core(n_loop);
      };
      std::vector<unsigned int> loop_vertex(n_loop + 1);
      const auto lattice = [&](const unsigned int i, const unsigned int j) { return j * (n_bottom + 1) + i; };
      for (unsigned int j = 0; j <= n_side; ++j)
        for (unsigned int i = 0; i <= n_bottom; ++i)
          {
            const double u = double(i) / n_bottom, v = double(j) / n_side;
            const auto   left = core(j), right = core(2 * n_side + n_bottom - j), bottom = core(n_side + i);
            const auto   x = (1 - u) * left + u * right + (1 - v) * top(i) + v * bottom -
                           ((1 - u) * (1 - v) * core(0) + u * (1 - v) * core(2 * n_side + n_bottom) +
                            u * v * core(n_side + n_bottom) + (1 - u) * v * core(n_side));
            const int l = place_on_loop(i, j);
            if (l >= 0)
              loop_vertex[l] = piece.vertices.size();
            piece.vertices.push_back(body.center + R * (l >= 0 ? core(l) : x));
          }
      for (unsigned int j = 0; j < n_side; ++j)
        for (unsigned int i = 0; i < n_bottom; ++i)
          piece.cells.push_back(
            quadrilateral<2>(lattice(i, j + 1), lattice(i + 1, j + 1), lattice(i + 1, j), lattice(i, j)));

      // layers around it
      const unsigned int first  = piece.vertices.size();
      const unsigned int n_rays = whole ? n_loop : n_loop + 1;
      const auto         layer  = [&](const unsigned int l, const unsigned int k) {
        return k == 0 ? loop_vertex[l % n_rays] : first + (k - 1) * n_rays + l % n_rays;
      };
      for (unsigned int k = 1; k <= n_layers; ++k)
        for (unsigned int l = 0; l < n_rays; ++l)
          {
            const double s = double(k) / n_layers;
            piece.vertices.push_back(body.center + R * (k == n_layers ? arc(l) : (1 - s) * core(l) + s * arc(l)));
          }
      for (unsigned int l = 0; l < n_loop; ++l)
        {
          for (unsigned int k = 0; k < n_layers; ++k)
            piece.cells.push_back(quadrilateral<2>(layer(l, k), layer(l, k + 1), layer(l + 1, k + 1), layer(l + 1, k)));
          piece.boundary_faces.push_back({{{layer(l, n_layers), layer(l + 1, n_layers)}}, 0});
        }
      if (!whole)
        {
          for (unsigned int i = 0; i < n_bottom; ++i)
            piece.boundary_faces.push_back({{{lattice(i, 0), lattice(i + 1, 0)}}, 1});
          for (unsigned int k = 0; k < n_layers; ++k)
            for (const unsigned int l : {0u, n_loop})
              piece.boundary_faces.push_back({{{layer(l, k), layer(l, k + 1)}}, 1});
        }
      bend(piece, body, 0);
      return piece;
    }

    /// Half of the lower half disc: a lattice of n x n cells at the centre and layers around its two outer sides; n is
    /// half the number of edges on the arc.
    MeshPiece<2> quarter_disc(const scene::Body<2> &body, const unsigned int refinements)
    {
      const double       R = body.radius;
      const unsigned int n = (body.cells_along_arc / 2) << refinements, n_loop = 2 * n;
      const unsigned int n_layers =
        static_cast<unsigned int>(
          std::max(1.,
                   std::round((1 - core_radius) / (1 + core_radius) * 2 * body.cells_along_arc / dealii::numbers::PI)))
        << refinements;
      const auto arc = [&](const unsigned int l) { return on_circle(.75 + .25 * l / n_loop); }; // from the lowest point
      const auto core = [&](const unsigned int l) { // straight sides, the corner between them pulled outwards
        const auto         end   = [&](const unsigned int k) { return (k == n ? core_corner : 1.) * arc(k); };
        const unsigned int first = l < n ? 0 : n;
        const double       s     = double(l - first) / n;
        return core_radius * ((1 - s) * end(first) + s * end(first + n));
      };

      MeshPiece<2> piece;
      const auto   lattice = [n](const unsigned int i, const unsigned int j) { return j * (n + 1) + i; };
      for (unsigned int j = 0; j <= n; ++j) // downwards
        for (unsigned int i = 0; i <= n; ++i)
          {
            const double u = double(i) / n, v = double(j) / n;
            const auto   bottom = core(i), right = core(2 * n - j);
            piece.vertices.push_back(body.center +
                                     R * (i == n   ? right
                                          : j == n ? bottom
                                                   : u * right + v * bottom - u * v * core(n))); // top, left: straight
          }
      for (unsigned int j = 0; j < n; ++j)
        for (unsigned int i = 0; i < n; ++i)
          piece.cells.push_back(
            quadrilateral<2>(lattice(i, j + 1), lattice(i + 1, j + 1), lattice(i + 1, j), lattice(i, j)));

      const unsigned int first = piece.vertices.size();
      const auto         layer = [&](const unsigned int l, const unsigned int k) {
        return k > 0 ? first + (k - 1) * (n_loop + 1) + l : l <= n ? lattice(l, n) : lattice(n, n_loop - l);
      };
      for (unsigned int k = 1; k <= n_layers; ++k)
        for (unsigned int l = 0; l <= n_loop; ++l)
          {
            const double s = double(k) / n_layers;
            piece.vertices.push_back(body.center + R * (k == n_layers ? arc(l) : (1 - s) * core(l) + s * arc(l)));
          }
      for (unsigned int l = 0; l < n_loop; ++l)
        {
          for (unsigned int k = 0; k < n_layers; ++k)
            piece.cells.push_back(quadrilateral<2>(layer(l, k), layer(l, k + 1), layer(l + 1, k + 1), layer(l + 1, k)));
          piece.boundary_faces.push_back({{{layer(l, n_layers), layer(l + 1, n_layers)}}, 0});
        }
      for (unsigned int i = 0; i < n; ++i)
        {
          piece.boundary_faces.push_back({{{lattice(i, 0), lattice(i + 1, 0)}}, 1});
          piece.boundary_faces.push_back({{{lattice(0, i), lattice(0, i + 1)}}, 2});
        }
      for (unsigned int k = 0; k < n_layers; ++k)
        {
          piece.boundary_faces.push_back({{{layer(n_loop, k), layer(n_loop, k + 1)}}, 1});
          piece.boundary_faces.push_back({{{layer(0, k), layer(0, k + 1)}}, 2});
        }
      bend(piece, body, 0);
      return piece;
    }
  } // namespace

  template <int dim>
  std::array<unsigned int, dim> rectangle_cells(const scene::Scene<dim> &scene, const scene::Body<dim> &body)
  {
    std::array<unsigned int, dim> n;
    n.fill(scene.decomposition.blocks * scene.decomposition.cells_per_block);
    if (body.cells)
      n = *body.cells;
    for (unsigned int &k : n)
      k <<= scene.discretization.refinements + body.refinements;
    return n;
  }

  std::map<std::string, dealii::types::boundary_id> shape_boundary_ids(const scene::Shape shape, const unsigned int dim)
  {
    switch (shape)
      {
        case scene::Shape::rectangle:
          if (dim == 3)
            return {{"left", 0}, {"right", 1}, {"bottom", 2}, {"top", 3}, {"back", 4}, {"front", 5}};
          return {{"left", 0}, {"right", 1}, {"bottom", 2}, {"top", 3}};
        case scene::Shape::disc:
          return {{"arc", 0}};
        case scene::Shape::half_disc:
          return {{"arc", 0}, {"flat", 1}};
        case scene::Shape::quarter_disc:
          return {{"arc", 0}, {"flat", 1}, {"side", 2}};
        case scene::Shape::ring:
          return {{"inner", 0}, {"outer", 1}};
        case scene::Shape::quarter_ring:
          return {{"inner", 0}, {"outer", 1}, {"start", 2}, {"end", 3}};
        case scene::Shape::ball:
          return {{"surface", 0}};
        case scene::Shape::half_ball:
          return {{"surface", 0}, {"flat", 1}};
        case scene::Shape::cylinder:
          return {{"side", 0}, {"back", 1}, {"front", 2}};
        case scene::Shape::tube:
          return {{"inner", 0}, {"outer", 1}, {"back", 2}, {"front", 3}};
        case scene::Shape::mesh:
          return {};
      }
    return {};
  }

  template <>
  BodyMesh<2> body_from_shape(const scene::Scene<2> &scene, const scene::Body<2> &body)
  {
    const unsigned int refinements = scene.discretization.refinements + body.refinements;
    BodyMesh<2>        mesh;
    mesh.boundary_ids = shape_boundary_ids(body.shape);
    switch (body.shape)
      {
        case scene::Shape::rectangle:
          mesh.piece = rectangle_piece<2>(body, rectangle_cells(scene, body), {{1, 1}}, {{0, 0}});
          break;
        case scene::Shape::disc:
        case scene::Shape::half_disc:
          mesh.piece = disc(body, refinements);
          break;
        case scene::Shape::quarter_disc:
          mesh.piece = quarter_disc(body, refinements);
          break;
        case scene::Shape::ring:
        case scene::Shape::quarter_ring:
          mesh.piece = ring(body, refinements);
          break;
        case scene::Shape::ball: // not plane shapes
        case scene::Shape::half_ball:
        case scene::Shape::cylinder:
        case scene::Shape::tube:
        case scene::Shape::mesh:
          Assert(false, dealii::ExcInternalError());
      }
    number_vertices(mesh.piece);
    return mesh;
  }

  template std::array<unsigned int, 2> rectangle_cells<2>(const scene::Scene<2> &, const scene::Body<2> &);
  template std::array<unsigned int, 3> rectangle_cells<3>(const scene::Scene<3> &, const scene::Body<3> &);
} // namespace slipstick::mesh
