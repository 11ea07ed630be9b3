// Hexahedra for the built-in shapes of solids.
#include <slipstick/mesh/curved_faces.h>
#include <slipstick/mesh/shapes.h>
#include <slipstick/mesh/solid_middles.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipstick::mesh
{
  namespace
  {
    /// Surface of a face with the given corners in cyclic order, or only the neglected sagitta if the outline is
    /// polygonal.
    FaceSurface surface_or_polygon(const scene::Body<3>                &body,
                                   const FaceSurface                   &surface,
                                   const std::vector<dealii::Point<3>> &corners)
    {
      if (body.has_smooth_outline)
        return surface;
      FaceSurface none;
      none.neglected_sagitta = sagitta(surface, corners);
      return none;
    }

    /// The cylinder over an arc, or only the sagitta neglected by its edge.
    FaceSurface cylinder_over(const EdgeCurve<2> &arc)
    {
      FaceSurface none;
      none.neglected_sagitta = arc.neglected_sagitta;
      if (!arc)
        return none;
      const auto &center = arc.points[2];
      return FaceSurface::cylinder({center[0], center[1], 0},
                                   dealii::Tensor<1, 3>({0, 0, 1}),
                                   center.distance(arc.points[0]));
    }

    /// Hexahedra between @p n_layers + 1 copies of a plane mesh, from @p start along z; its boundary ids are kept, the
    /// two ends get the next ones.
    MeshPiece<3> extruded(const MeshPiece<2>              &section,
                          const double                     start,
                          const double                     length,
                          const unsigned int               n_layers,
                          const dealii::types::boundary_id back)
    {
      MeshPiece<3>       piece;
      const unsigned int n = section.vertices.size();
      for (unsigned int k = 0; k <= n_layers; ++k)
        for (const auto &x : section.vertices)
          piece.vertices.emplace_back(x[0], x[1], start + length * k / n_layers);
      for (unsigned int k = 0; k < n_layers; ++k)
        {
          const auto at = [&](const unsigned int v, const unsigned int layer) { return v + (k + layer) * n; };
          for (const auto &c : section.cells)
            piece.cells.push_back({{at(c[0], 0),
                                    at(c[1], 0),
                                    at(c[2], 0),
                                    at(c[3], 0),
                                    at(c[0], 1),
                                    at(c[1], 1),
                                    at(c[2], 1),
                                    at(c[3], 1)}});
          for (const auto &edge : section.boundary_faces)
            piece.boundary_faces.push_back(
              {{{at(edge.vertices[0], 0), at(edge.vertices[1], 0), at(edge.vertices[0], 1), at(edge.vertices[1], 1)}},
               edge.id,
               cylinder_over(edge.curve)});
        }
      for (const auto &c : section.cells)
        for (const unsigned int end : {0u, 1u})
          {
            const unsigned int first = end * n_layers * n;
            piece.boundary_faces.push_back({{{first + c[0], first + c[1], first + c[2], first + c[3]}}, back + end});
          }
      return piece;
    }

    /// A cylinder: side 0, back 1, front 2; or a tube: inner 0, outer 1, back 2, front 3.
    MeshPiece<3> round_bar(const scene::Scene<3> &scene, const scene::Body<3> &body)
    {
      const bool      is_tube = body.shape == scene::Shape::tube;
      const auto      cells   = round_bar_cells(body);
      scene::Scene<2> plane;
      scene::Body<2>  section;
      plane.discretization.refinements = scene.discretization.refinements;
      section.refinements              = body.refinements;
      section.shape                    = is_tube ? scene::Shape::ring : scene::Shape::disc;
      section.center                   = dealii::Point<2>(body.center[0], body.center[1]);
      section.radius                   = body.radius;
      section.inner_radius             = body.inner_radius;
      section.cells_along_arc          = body.cells_along_arc;
      section.has_smooth_outline       = body.has_smooth_outline;
      if (is_tube)
        section.cells = std::array<unsigned int, 2>{{body.cells_along_arc, cells.across}};
      return extruded(body_from_shape<2>(plane, section).piece,
                      body.center[2],
                      body.length,
                      cells.along << (scene.discretization.refinements + body.refinements),
                      is_tube ? 2 : 1);
    }

    /// A lattice with layers on its outer vertices: a ball, or the half below its centre. Surface 0, flat 1.
    class BallMesh
    {
    public:
      BallMesh(const scene::Body<3> &body_, const unsigned int refinements)
        : body(body_)
        , n((body.cells_along_arc / 4) << refinements)
        , n_up(body.shape == scene::Shape::ball ? n : n / 2)
        , n_layers(static_cast<unsigned int>(std::max(1.,
                                                      std::round((1 - core_radius) / (1 + core_radius) *
                                                                 body.cells_along_arc / dealii::numbers::PI)))
                   << refinements)
        , outer((n + 1) * (n_up + 1) * (n + 1), MeshPiece<3>::no_vertex)
      {
        add_vertices();
        add_core();
        for (unsigned int d = 0; d < 3; ++d)
          for (const unsigned int end : {0u, 1u})
            add_side(d, end);
      }

      MeshPiece<3> piece;

    private:
      using Place = std::array<unsigned int, 3>;

      unsigned int number(const Place &at) const
      {
        return (at[2] * (n_up + 1) + at[1]) * (n + 1) + at[0];
      }

      unsigned int size(const unsigned int d) const
      {
        return d == 1 ? n_up : n;
      }

      /// Whether a side of the lattice is on the cut plane of a half ball.
      bool is_flat(const unsigned int d, const unsigned int end) const
      {
        return d == 1 && end == 1 && n_up < n;
      }

      /// Points of the unit sphere and of the core; edges have about equal length.
      std::pair<dealii::Tensor<1, 3>, dealii::Tensor<1, 3>> points(const Place &at) const
      {
        dealii::Tensor<1, 3> flat, bent;
        double               largest = 0;
        for (unsigned int d = 0; d < 3; ++d)
          {
            const double angle = dealii::numbers::PI / 4 * (2. * at[d] / n - 1);
            flat[d]            = 2. * at[d] / n - 1;
            bent[d]            = 2 * at[d] == n ? 0. : std::tan(angle);
            largest            = std::max(largest, std::abs(flat[d]));
          }
        const double               length    = bent.norm();
        const dealii::Tensor<1, 3> direction = length > 0 ? bent / length : bent;
        return {direction,
                core_radius * (core_bending * largest * direction + (1 - core_bending) / std::sqrt(3.) * flat)};
      }

      void add_vertices()
      {
        Place at;
        for (at[2] = 0; at[2] <= n; ++at[2])
          for (at[1] = 0; at[1] <= n_up; ++at[1])
            for (at[0] = 0; at[0] <= n; ++at[0])
              piece.vertices.push_back(body.center + body.radius * points(at).second);
        for (at[2] = 0; at[2] <= n; ++at[2])
          for (at[1] = 0; at[1] <= n_up; ++at[1])
            for (at[0] = 0; at[0] <= n; ++at[0])
              {
                bool is_outer = false;
                for (unsigned int d = 0; d < 3; ++d)
                  is_outer = is_outer || at[d] == 0 || (at[d] == size(d) && !is_flat(d, 1));
                if (!is_outer)
                  continue;
                outer[number(at)]         = piece.vertices.size();
                const auto [sphere, core] = points(at);
                for (unsigned int k = 1; k <= n_layers; ++k)
                  {
                    const double s = double(k) / n_layers;
                    piece.vertices.push_back(body.center +
                                             body.radius * (k == n_layers ? sphere : (1 - s) * core + s * sphere));
                  }
              }
      }

      /// Layer 0 is the lattice.
      unsigned int vertex(const Place &at, const unsigned int layer) const
      {
        return layer == 0 ? number(at) : outer[number(at)] + layer - 1;
      }

      void add_core()
      {
        Place at;
        for (at[2] = 0; at[2] < n; ++at[2])
          for (at[1] = 0; at[1] < n_up; ++at[1])
            for (at[0] = 0; at[0] < n; ++at[0])
              {
                MeshPiece<3>::Cell cell;
                for (unsigned int v = 0; v < cell.size(); ++v)
                  cell[v] = number({{at[0] + (v & 1), at[1] + (v >> 1 & 1), at[2] + (v >> 2)}});
                piece.cells.push_back(cell);
              }
      }

      /// The layers on one side of the lattice, or the boundary there.
      void add_side(const unsigned int d, const unsigned int end)
      {
        const unsigned int a = (d + 1) % 3, b = (d + 2) % 3;
        for (unsigned int j = 0; j < size(b); ++j)
          for (unsigned int i = 0; i < size(a); ++i)
            {
              std::array<Place, 4> corners;
              for (unsigned int v = 0; v < 4; ++v)
                {
                  // such that a, b and the outward direction are right-handed
                  const unsigned int along_a = end == 1 ? v & 1 : v >> 1, along_b = end == 1 ? v >> 1 : v & 1;
                  corners[v][a] = i + along_a;
                  corners[v][b] = j + along_b;
                  corners[v][d] = end * size(d);
                }
              const auto face = [&](const unsigned int layer) {
                MeshPiece<3>::Face vertices;
                for (unsigned int v = 0; v < 4; ++v)
                  vertices[v] = vertex(corners[v], layer);
                return vertices;
              };
              if (is_flat(d, end))
                {
                  piece.boundary_faces.push_back({face(0), 1});
                  continue;
                }
              for (unsigned int k = 0; k < n_layers; ++k)
                {
                  const auto         inner = face(k), outside = face(k + 1);
                  MeshPiece<3>::Cell cell;
                  std::copy(inner.begin(), inner.end(), cell.begin());
                  std::copy(outside.begin(), outside.end(), cell.begin() + 4);
                  piece.cells.push_back(cell);
                  for (const auto &[v, w] : {std::pair(0, 1), {2, 3}, {0, 2}, {1, 3}})
                    add_rim(corners[v], corners[w], k);
                }
              std::vector<dealii::Point<3>> around;
              for (const unsigned int v : {0, 1, 3, 2})
                around.push_back(piece.vertices[vertex(corners[v], n_layers)]);
              piece.boundary_faces.push_back(
                {face(n_layers), 0, surface_or_polygon(body, FaceSurface::ball(body.center, body.radius), around)});
            }
      }

      /// Adds the face of a layer between two neighbouring corners if both are on the flat side of a half ball.
      void add_rim(const Place &p, const Place &q, const unsigned int layer)
      {
        if (n_up < n && p[1] == n_up && q[1] == n_up)
          piece.boundary_faces.push_back(
            {{{vertex(p, layer), vertex(q, layer), vertex(p, layer + 1), vertex(q, layer + 1)}}, 1});
      }

      const scene::Body<3>     &body;
      const unsigned int        n, n_up, n_layers; // of the lattice, horizontal and vertical; around it
      std::vector<unsigned int> outer;             // by vertex of the lattice: first vertex of the layers
    };
  } // namespace

  RoundBarCells round_bar_cells(const scene::Body<3> &body)
  {
    constexpr double most     = 1e9; // larger numbers are refused by check_size()
    const double     edge     = 2 * dealii::numbers::PI * body.radius / body.cells_along_arc;
    const auto       cells_on = [&](const double length) {
      return static_cast<unsigned int>(std::clamp(std::round(length / edge), 1., most));
    };
    return {body.shape == scene::Shape::tube ? cells_on(body.radius - body.inner_radius) : 0,
            body.cells_along_axis > 0 ? body.cells_along_axis : cells_on(body.length)};
  }

  template <>
  BodyMesh<3> body_from_shape(const scene::Scene<3> &scene, const scene::Body<3> &body)
  {
    BodyMesh<3> mesh;
    mesh.boundary_ids = shape_boundary_ids(body.shape, 3);
    switch (body.shape)
      {
        case scene::Shape::rectangle:
          mesh.piece = rectangle_piece<3>(body, rectangle_cells(scene, body), {{1, 1, 1}}, {{0, 0, 0}});
          return mesh;
        case scene::Shape::ball:
        case scene::Shape::half_ball:
          mesh.piece = BallMesh(body, scene.discretization.refinements + body.refinements).piece;
          break;
        case scene::Shape::cylinder:
        case scene::Shape::tube:
          mesh.piece = round_bar(scene, body);
          break;
        case scene::Shape::disc: // not solid shapes
        case scene::Shape::half_disc:
        case scene::Shape::quarter_disc:
        case scene::Shape::ring:
        case scene::Shape::quarter_ring:
        case scene::Shape::mesh:
          Assert(false, dealii::ExcInternalError());
      }
    bend_lines(mesh.piece);
    mesh.piece.global_vertices.resize(mesh.piece.vertices.size());
    std::iota(mesh.piece.global_vertices.begin(), mesh.piece.global_vertices.end(), GlobalVertex(0));
    return mesh;
  }
} // namespace slipstick::mesh
