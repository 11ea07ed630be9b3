#include <slipstick/base/box_tree.h>
#include <slipstick/base/cross.h>
#include <slipstick/mesh/conformity.h>

#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace slipstick::mesh
{
  namespace
  {
    // A node closer to an edge than this fraction of the shorter edge is on it: some files have only six digits of
    // large coordinates, and no mesh has narrower features.
    constexpr double on_edge = 1e-4;
    // Sine of the angle below which edges from one place are parallel.
    constexpr double along = 1e-3;
    // Distance of coincident nodes in space, relative to the size of the body.
    constexpr double same_place = 1e-9;

    class OutlineCheck
    {
    public:
      using Fault = ConformityFault<2>;
      using Kind  = Fault::Kind;

      explicit OutlineCheck(const MeshPiece<2> &piece);

      std::optional<Fault> run();

    private:
      using Place = boost::geometry::model::point<double, 2, boost::geometry::cs::cartesian>;
      using Box   = boost::geometry::model::box<Place>;
      using Value = std::pair<Box, unsigned int>;

      struct Edge // the cell is on the left
      {
        unsigned int from, to, cell;
        bool         is_named;
      };

      const dealii::Point<2> &x(const unsigned int vertex) const
      {
        return piece.vertices[vertex];
      }

      dealii::Tensor<1, 2> direction(const Edge &edge) const
      {
        return x(edge.to) - x(edge.from);
      }

      double length(const Edge &edge) const
      {
        return direction(edge).norm();
      }

      static Box box(const dealii::Point<2> &a, const dealii::Point<2> &b, const double margin)
      {
        return {Place(std::min(a[0], b[0]) - margin, std::min(a[1], b[1]) - margin),
                Place(std::max(a[0], b[0]) + margin, std::max(a[1], b[1]) + margin)};
      }

      std::vector<unsigned int> near(const Box &where) const;
      std::optional<Fault>      fault_at(const unsigned int v);
      std::optional<Fault>      crossing_of(const unsigned int e) const;
      bool                      has_cell_on_the_right(const unsigned int e) const;

      Fault fault(const Kind kind, const dealii::Point<2> &place, const unsigned int e, const unsigned int f) const
      {
        return {kind, place, edges[e].cell, edges[f].cell};
      }

      const MeshPiece<2>                                                    &piece;
      std::vector<Edge>                                                      edges;
      std::map<unsigned int, std::vector<unsigned int>>                      edges_at; // by vertex
      std::vector<bool>                                                      is_flank; // of an intended slit
      boost::geometry::index::rtree<Value, boost::geometry::index::rstar<8>> tree;
    };

    OutlineCheck::OutlineCheck(const MeshPiece<2> &the_piece)
      : piece(the_piece)
    {
      std::set<MeshPiece<2>::Face> named;
      for (const auto &face : piece.boundary_faces)
        if (face.id != 0)
          named.insert(face.vertices);
      const auto faces = faces_with_cells(piece);
      for (std::size_t k = 0; k < faces.size(); ++k)
        {
          const auto &[face, c] = faces[k];
          if ((k > 0 && faces[k - 1].first == face) || (k + 1 < faces.size() && faces[k + 1].first == face))
            continue;
          const auto &cell = piece.cells[c];
          for (unsigned int f = 0; f < n_corners<2>(cell); ++f)
            if (face_of_cell<2>(cell, f) == face)
              edges.push_back({corner<2>(cell, f), corner<2>(cell, f + 1), c, named.count(face) > 0});
        }
      std::vector<Value> boxes;
      for (unsigned int e = 0; e < edges.size(); ++e)
        {
          edges_at[edges[e].from].push_back(e);
          edges_at[edges[e].to].push_back(e);
          boxes.emplace_back(box(x(edges[e].from), x(edges[e].to), on_edge * length(edges[e])), e);
        }
      is_flank.resize(edges.size(), false);
      tree = decltype(tree)(boxes);
    }

    std::vector<unsigned int> OutlineCheck::near(const Box &where) const
    {
      std::vector<unsigned int> result;
      for (auto found = tree.qbegin(boost::geometry::index::intersects(where)); found != tree.qend(); ++found)
        result.push_back(found->second);
      std::sort(result.begin(), result.end());
      return result;
    }

    /// Checks vertex @p v against edges it lies on, except its own.
    std::optional<ConformityFault<2>> OutlineCheck::fault_at(const unsigned int v)
    {
      const auto &own   = edges_at.at(v);
      double      least = std::numeric_limits<double>::max();
      for (const unsigned int g : own)
        least = std::min(least, length(edges[g]));
      for (const unsigned int e : near(box(x(v), x(v), 0)))
        {
          const Edge &edge = edges[e];
          if (edge.from == v || edge.to == v)
            continue;
          const auto   d = direction(edge);
          const double l = d.norm(), margin = on_edge * std::min(l, least);
          const double s = (x(v) - x(edge.from)) * d / l;
          if (s < -margin || s > l + margin || std::abs(cross(d, x(v) - x(edge.from))) / l > margin)
            continue;
          const bool at_from = s <= margin, at_to = s >= l - margin;
          const Kind kind = at_from || at_to ? Kind::twin_nodes : Kind::hanging_node;

          bool runs_along = false, has_named = false;
          for (const unsigned int g : own)
            {
              const bool leaves = edges[g].from == v;
              const auto away   = (leaves ? 1 : -1) * direction(edges[g]); // from v to the other end
              has_named         = has_named || edges[g].is_named;
              if (std::abs(cross(away, d)) > along * away.norm() * l || (at_from && away * d < 0) ||
                  (at_to && away * d > 0))
                continue;
              runs_along = true;
              if (direction(edges[g]) * d > 0) // both have their cells on the same side
                return fault(Kind::overlap, x(v), e, g);
              if (!edge.is_named || !edges[g].is_named)
                return fault(kind, x(v), e, g);
              is_flank[e] = is_flank[g] = true;
            }
          if (!runs_along && !(edge.is_named && has_named))
            {
              // the mouth of a slit: another edge from there has the same direction
              bool is_mouth = false;
              if (kind == Kind::twin_nodes)
                for (const unsigned int f : edges_at.at(at_from ? edge.from : edge.to))
                  for (const unsigned int g : own)
                    {
                      const auto a = (edges[f].from == (at_from ? edge.from : edge.to) ? 1 : -1) * direction(edges[f]);
                      const auto b = (edges[g].from == v ? 1 : -1) * direction(edges[g]);
                      is_mouth     = is_mouth || (std::abs(cross(a, b)) <= along * a.norm() * b.norm() && a * b > 0);
                    }
              if (!is_mouth)
                return fault(kind, x(v), e, own[0]);
            }
        }
      return {};
    }

    std::optional<ConformityFault<2>> OutlineCheck::crossing_of(const unsigned int e) const
    {
      const Edge &edge = edges[e];
      const auto  d    = direction(edge);
      for (const unsigned int f : near(box(x(edge.from), x(edge.to), 0)))
        {
          const Edge &other = edges[f];
          if (f <= e || other.from == edge.from || other.from == edge.to || other.to == edge.from ||
              other.to == edge.to)
            continue;
          const auto   g      = direction(other);
          const double margin = on_edge * std::min(d.norm(), g.norm());
          const double a      = cross(d, x(other.from) - x(edge.from)) / d.norm(),
                       b      = cross(d, x(other.to) - x(edge.from)) / d.norm();
          const double p      = cross(g, x(edge.from) - x(other.from)) / g.norm(),
                       q      = cross(g, x(edge.to) - x(other.from)) / g.norm();
          if (std::min(a, b) < -margin && std::max(a, b) > margin && std::min(p, q) < -margin &&
              std::max(p, q) > margin)
            return fault(Kind::overlap, x(edge.from) + p / (p - q) * d, e, f);
        }
      return {};
    }

    /// Uses the winding number of the outline at the middle of the edge, along the axis to which the edge is most
    /// perpendicular.
    bool OutlineCheck::has_cell_on_the_right(const unsigned int e) const
    {
      const auto         d      = direction(edges[e]);
      const auto         middle = x(edges[e].from) + .5 * d;
      const unsigned int ray = std::abs(d[1]) >= std::abs(d[0]) ? 0 : 1, level = 1 - ray;
      constexpr double   far = std::numeric_limits<double>::max();
      const Box          where(Place(middle[0], middle[1]), ray == 0 ? Place(far, middle[1]) : Place(middle[0], far));
      int                winding = 0;
      for (const unsigned int f : near(where))
        {
          const auto &a = x(edges[f].from), &b = x(edges[f].to);
          if (f == e || (a[level] <= middle[level]) == (b[level] <= middle[level]))
            continue;
          const double at = a[ray] + (middle[level] - a[level]) / (b[level] - a[level]) * (b[ray] - a[ray]);
          if (at > middle[ray])
            winding += (b[level] > a[level]) == (ray == 0) ? 1 : -1;
        }
      // the ray starts on the right of an edge that goes up (ray to the right) or to the left (ray up)
      const bool starts_right = ray == 0 ? d[1] > 0 : d[0] < 0;
      return winding != (starts_right ? 0 : 1);
    }

    std::optional<ConformityFault<2>> OutlineCheck::run()
    {
      for (const auto &[v, own] : edges_at)
        if (const auto found = fault_at(v))
          return found;
      for (unsigned int e = 0; e < edges.size(); ++e)
        if (const auto found = crossing_of(e))
          return found;
      for (unsigned int e = 0; e < edges.size(); ++e)
        if (!is_flank[e] && has_cell_on_the_right(e))
          return fault(Kind::overlap, x(edges[e].from) + .5 * direction(edges[e]), e, e);
      return {};
    }

    std::optional<ConformityFault<3>> twin_nodes(const MeshPiece<3> &piece)
    {
      std::set<unsigned int> outline, unnamed; // vertices
      for (const auto &face : piece.boundary_faces)
        for (const unsigned int v : face.vertices)
          if (v != MeshPiece<3>::no_vertex)
            {
              outline.insert(v);
              if (face.id == 0)
                unnamed.insert(v);
            }
      const auto               &x = piece.vertices;
      std::vector<unsigned int> by_x(outline.begin(), outline.end());
      dealii::Point<3>          low = x[by_x[0]], high = low;
      for (const unsigned int v : by_x)
        for (unsigned int d = 0; d < 3; ++d)
          {
            low[d]  = std::min(low[d], x[v][d]);
            high[d] = std::max(high[d], x[v][d]);
          }
      const double tolerance = same_place * low.distance(high);
      std::sort(by_x.begin(), by_x.end(), [&](const unsigned int a, const unsigned int b) {
        return x[a][0] < x[b][0];
      });
      const auto cell_at = [&](const unsigned int v) -> unsigned int {
        return std::find_if(piece.cells.begin(),
                            piece.cells.end(),
                            [&](const auto &cell) { return std::count(cell.begin(), cell.end(), v) > 0; }) -
               piece.cells.begin();
      };
      for (std::size_t i = 0; i < by_x.size(); ++i)
        for (std::size_t k = i + 1; k < by_x.size() && x[by_x[k]][0] - x[by_x[i]][0] <= tolerance; ++k)
          if (x[by_x[i]].distance(x[by_x[k]]) <= tolerance &&
              (unnamed.count(by_x[i]) > 0 || unnamed.count(by_x[k]) > 0))
            return ConformityFault<3>{ConformityFault<3>::Kind::twin_nodes,
                                      x[by_x[i]],
                                      cell_at(by_x[i]),
                                      cell_at(by_x[k])};
      return {};
    }

    /// Nodes of the outline of a solid that lie on faces of other cells, e.g. where one cell borders on several smaller
    /// ones.
    class HangingNodes
    {
    public:
      explicit HangingNodes(const MeshPiece<3> &piece)
        : piece(piece)
        , tree(boxes_of(piece))
      {
        for (const auto &face : piece.boundary_faces)
          for (const unsigned int v : vertices_of(face))
            {
              auto &shortest = least.emplace(v, std::numeric_limits<double>::max()).first->second;
              shortest       = std::min(shortest, shortest_side(face));
              if (face.id == 0)
                unnamed.insert(v);
            }
      }

      std::optional<ConformityFault<3>> first() const
      {
        for (const auto &[v, shortest] : least)
          for (const unsigned int f :
               tree.near(BoxTree<3>::widened(BoxTree<3>::box_around({x(v)}), on_edge * shortest)))
            {
              const auto &face = piece.boundary_faces[f];
              if ((face.id == 0 || unnamed.count(v) > 0) && // otherwise the flank of a slit
                  lies_on(v, face, on_edge * std::min(shortest, shortest_side(face))))
                return ConformityFault<3>{ConformityFault<3>::Kind::hanging_node,
                                          x(v),
                                          cell_with({v}),
                                          cell_with(vertices_of(face))};
            }
        return {};
      }

    private:
      using Face   = MeshPiece<3>::BoundaryFace;
      using Vector = dealii::Tensor<1, 3>;

      const dealii::Point<3> &x(const unsigned int vertex) const
      {
        return piece.vertices[vertex];
      }

      static std::vector<unsigned int> vertices_of(const Face &face)
      {
        std::vector<unsigned int> vertices;
        for (const unsigned int v : face.vertices)
          if (v != MeshPiece<3>::no_vertex)
            vertices.push_back(v);
        return vertices;
      }

      static std::vector<BoxTree<3>::Box> boxes_of(const MeshPiece<3> &piece)
      {
        std::vector<BoxTree<3>::Box> boxes;
        for (const auto &face : piece.boundary_faces)
          {
            std::vector<dealii::Point<3>> corners;
            for (const unsigned int v : vertices_of(face))
              corners.push_back(piece.vertices[v]);
            boxes.push_back(BoxTree<3>::box_around(corners));
          }
        return boxes;
      }

      /// Shortest distance between any two corners (diagonals are never the shortest).
      double shortest_side(const Face &face) const
      {
        const auto v        = vertices_of(face);
        double     shortest = std::numeric_limits<double>::max();
        for (unsigned int a = 0; a < v.size(); ++a)
          for (unsigned int b = 0; b < a; ++b)
            shortest = std::min(shortest, x(v[a]).distance(x(v[b])));
        return shortest;
      }

      /// Whether a vertex lies in one of the triangles formed by the corners (which cover the face in any order of the
      /// corners), but not at a corner.
      bool lies_on(const unsigned int vertex, const Face &face, const double margin) const
      {
        const auto v = vertices_of(face);
        for (const unsigned int corner : v)
          if (corner == vertex || x(corner).distance(x(vertex)) <= margin)
            return false;
        for (unsigned int a = 0; a < v.size(); ++a)
          for (unsigned int b = 0; b < a; ++b)
            for (unsigned int c = 0; c < b; ++c)
              if (is_in_triangle(x(vertex), {{x(v[a]), x(v[b]), x(v[c])}}, margin))
                return true;
        return false;
      }

      static bool is_in_triangle(const dealii::Point<3>                &x,
                                 const std::array<dealii::Point<3>, 3> &corners,
                                 const double                           margin)
      {
        Vector normal = cross_product_3d(corners[1] - corners[0], corners[2] - corners[0]);
        normal /= normal.norm();
        if (!(std::abs((x - corners[0]) * normal) <= margin))
          return false;
        for (unsigned int k = 0; k < 3; ++k)
          {
            const Vector along = corners[(k + 1) % 3] - corners[k];
            if (cross_product_3d(along, x - corners[k]) * normal < -margin * along.norm())
              return false;
          }
        return true;
      }

      unsigned int cell_with(const std::vector<unsigned int> &vertices) const
      {
        return std::find_if(piece.cells.begin(),
                            piece.cells.end(),
                            [&](const auto &cell) {
                              return std::all_of(vertices.begin(), vertices.end(), [&](const unsigned int v) {
                                return std::count(cell.begin(), cell.end(), v) > 0;
                              });
                            }) -
               piece.cells.begin();
      }

      const MeshPiece<3>            &piece;
      BoxTree<3>                     tree;    // of the bounding boxes of the faces
      std::map<unsigned int, double> least;   // shortest edge at a vertex
      std::set<unsigned int>         unnamed; // vertices of faces without a name
    };
  } // namespace

  template <>
  std::optional<ConformityFault<2>> find_fault(const MeshPiece<2> &piece)
  {
    return OutlineCheck(piece).run();
  }

  template <>
  std::optional<ConformityFault<3>> find_fault(const MeshPiece<3> &piece)
  {
    const auto twins = twin_nodes(piece);
    return twins ? twins : HangingNodes(piece).first();
  }
} // namespace slipstick::mesh
