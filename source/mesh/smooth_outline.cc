#include <slipstick/base/cross.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/smooth_outline.h>

#include <deal.II/base/mpi.h>

#include <cmath>

namespace slipstick::mesh
{
  namespace
  {
    // Edges are in line if they meet at less than this angle [rad]: a circle of such edges has a sagitta of a ten
    // millionth of their length.
    constexpr double in_line = 1e-6;
    // A node is a corner if the edges meet at more than this factor times the angle at the neighbouring nodes.
    constexpr double outstanding = 3;
    // Coarse circles: neighbouring angles are below the limit [rad], and lengths differ by at most this fraction.
    constexpr double coarse_limit = 65 * M_PI / 180, regular = 0.1;
    // Parabolas through mid nodes that meet at this angle [rad] or more form a corner: those of a circle of eight edges
    // meet at 2 degrees.
    constexpr double corner_of_parabolas = 10 * M_PI / 180;
    // Conditions for a cubic instead of a parabola: its mid node is off the middle of the chord by at most this
    // fraction of it, and the speed at the ends differs by at most this fraction from that of an arc.
    constexpr double off_middle = 0.05, other_speed = 0.25;
    // Mid nodes are on the chord if their distance from it is at most this fraction of its length.
    constexpr double on_edge_chord = 1e-9;

    dealii::Tensor<1, 2> turned(const dealii::Tensor<1, 2> &v, const double angle)
    {
      dealii::Tensor<1, 2> w;
      w[0] = std::cos(angle) * v[0] - std::sin(angle) * v[1];
      w[1] = std::sin(angle) * v[0] + std::cos(angle) * v[1];
      return w;
    }

    class Reconstruction
    {
    public:
      using Piece  = MeshPiece<2>;
      using Curve  = EdgeCurve<2>;
      using Tensor = dealii::Tensor<1, 2>;

      Reconstruction(const scene::Body<2> &body, BodyMesh<2> &mesh)
        : body(body)
        , mesh(mesh)
        , limit(body.corner_angle * M_PI / 180)
      {
        find_edges();
        link();
      }

      void run();

    private:
      /// A boundary edge with the body on its left, and the node at its end.
      struct Edge
      {
        unsigned int from = 0, to = 0; // vertices
        unsigned int cell = 0, face = 0;
        Tensor       chord;
        double       length = 0;
        int          last = -1, next = -1; // adjacent edges; -1: not exactly two edges meet
        double       turn      = 0;        // angle to the next edge, positive to the left
        bool         is_corner = true;     // at its end
        bool         is_flat   = false;
        double       start = 0, end = 0; // angles between chord and curve at the ends, positive for a curve to the left
      };

      void find_edges();
      void link();
      void find_corners();
      void find_flats();
      void find_tangents();
      void follow_middles();
      void continue_to_corners();
      bool is_outstanding(const Edge &edge) const;
      bool is_inflection(const Edge &edge) const;
      bool is_coarse_circle(const Edge &edge) const;

      Curve spline(const Edge &edge) const;
      Curve parabola(const Edge &edge) const;
      Curve through_middle(const Edge &edge) const;
      bool  has_middles() const;

      const scene::Body<2> &body;
      BodyMesh<2>          &mesh;
      const double          limit; // [rad]
      std::vector<Edge>     edges;
    };

    void Reconstruction::find_edges()
    {
      const auto  boundary = ids_of_faces(mesh.piece);
      const auto &x        = mesh.piece.vertices;
      for (unsigned int c = 0; c < mesh.piece.cells.size(); ++c)
        for (unsigned int f = 0; f < n_corners<2>(mesh.piece.cells[c]); ++f)
          if (boundary.count(face_of_cell<2>(mesh.piece.cells[c], f)) > 0)
            {
              Edge edge;
              edge.from   = corner<2>(mesh.piece.cells[c], f);
              edge.to     = corner<2>(mesh.piece.cells[c], f + 1);
              edge.cell   = c;
              edge.face   = f;
              edge.chord  = x[edge.to] - x[edge.from];
              edge.length = edge.chord.norm();
              edges.push_back(edge);
            }
    }

    void Reconstruction::link()
    {
      std::map<unsigned int, std::vector<int>> starting, ending; // by vertex
      for (unsigned int e = 0; e < edges.size(); ++e)
        {
          starting[edges[e].from].push_back(e);
          ending[edges[e].to].push_back(e);
        }
      for (unsigned int e = 0; e < edges.size(); ++e)
        {
          auto &edge = edges[e];
          if (starting[edge.to].size() != 1 || ending[edge.to].size() != 1)
            continue;
          edge.next             = starting[edge.to][0];
          edges[edge.next].last = e;
          edge.turn = std::atan2(cross(edge.chord, edges[edge.next].chord), edge.chord * edges[edge.next].chord);
        }
    }

    /// Whether the angle at the end of an edge is much larger than at the neighbouring nodes (those that are not
    /// corners).
    bool Reconstruction::is_outstanding(const Edge &edge) const
    {
      const auto  &next   = edges[edge.next];
      const double length = 0.5 * (edge.length + next.length);
      double       beside = -1; // angle expected from the neighbours
      if (edge.last >= 0 && edges[edge.last].next >= 0 && std::abs(edges[edge.last].turn) < limit)
        beside = std::max(beside, std::abs(edges[edge.last].turn) * std::max(1., length / edge.length));
      if (next.next >= 0 && std::abs(next.turn) < limit)
        beside = std::max(beside, std::abs(next.turn) * std::max(1., length / next.length));
      return beside >= 0 && std::abs(edge.turn) > std::max(in_line, outstanding * beside);
    }

    void Reconstruction::find_corners()
    {
      for (auto &edge : edges)
        edge.is_corner = edge.next < 0 || std::abs(edge.turn) >= limit || is_outstanding(edge);
    }

    /// Whether the outline turns to opposite sides before and after the end of an edge.
    bool Reconstruction::is_inflection(const Edge &edge) const
    {
      const auto &next = edges[edge.next];
      if (edge.last < 0 || edges[edge.last].is_corner || next.is_corner)
        return false;
      const double before = edges[edge.last].turn, behind = next.turn;
      return before * behind < 0 && std::min(std::abs(before), std::abs(behind)) > in_line;
    }

    void Reconstruction::find_flats()
    {
      for (auto &edge : edges)
        if (!edge.is_corner && std::abs(edge.turn) <= in_line && !is_inflection(edge))
          edge.is_flat = edges[edge.next].is_flat = true;
      // neither end is a node inside a curve
      std::vector<bool> is_within(edges.size());
      for (unsigned int e = 0; e < edges.size(); ++e)
        is_within[e] = !edges[e].is_corner && !edges[e].is_flat && !edges[edges[e].next].is_flat;
      for (unsigned int e = 0; e < edges.size(); ++e)
        if (!is_within[e] && (edges[e].last < 0 || !is_within[edges[e].last]))
          edges[e].is_flat = true;
    }

    void Reconstruction::find_tangents()
    {
      for (auto &edge : edges)
        if (!edge.is_corner)
          {
            auto &next = edges[edge.next];
            if (edge.is_flat)
              next.start = edge.turn;
            else if (next.is_flat)
              edge.end = edge.turn;
            else // circle through three nodes
              {
                edge.end =
                  std::atan2(edge.length * std::sin(edge.turn), next.length + edge.length * std::cos(edge.turn));
                next.start = edge.turn - edge.end;
              }
          }
      continue_to_corners();
    }

    /// Angles at corners are set to those at the other end of the edge, as for an arc.
    void Reconstruction::continue_to_corners()
    {
      for (auto &edge : edges)
        {
          const bool from_corner = edge.last < 0 || edges[edge.last].is_corner;
          if (from_corner && !edge.is_corner)
            edge.start = edge.end;
          else if (!from_corner && edge.is_corner)
            edge.end = edge.start;
        }
    }

    EdgeCurve<2> Reconstruction::spline(const Edge &edge) const
    {
      if (edge.is_flat || std::max(std::abs(edge.start), std::abs(edge.end)) <= in_line)
        return {};
      // with this speed at the ends the cubic passes exactly through the middle of an arc
      const double half  = std::cos((std::abs(edge.start) + std::abs(edge.end)) / 4);
      const Tensor along = edge.chord / (half * half);
      return Curve::hermite(mesh.piece.vertices[edge.from],
                            turned(along, -edge.start),
                            turned(along, edge.end),
                            mesh.piece.vertices[edge.to]);
    }

    EdgeCurve<2> Reconstruction::parabola(const Edge &edge) const
    {
      const auto found = mesh.middles.find(face_of_cell<2>(mesh.piece.cells[edge.cell], edge.face));
      const auto start = mesh.piece.vertices[edge.from], end = mesh.piece.vertices[edge.to];
      if (found == mesh.middles.end() ||
          std::abs(cross(edge.chord, found->second - start)) <= on_edge_chord * edge.length * edge.length)
        return {};
      return Curve::parabola(start, found->second, end);
    }

    bool Reconstruction::has_middles() const
    {
      for (const auto &edge : edges)
        if (parabola(edge))
          return true;
      return false;
    }

    /// As find_corners(), find_flats() and find_tangents(), for edges with mid nodes: tangents are those of the circles
    /// through a node and the adjacent mid nodes.
    void Reconstruction::follow_middles()
    {
      std::vector<Curve> parabolas;
      for (auto &edge : edges)
        {
          parabolas.push_back(parabola(edge));
          edge.is_flat = !parabolas.back();
        }
      const auto angle   = [](const Tensor &a, const Tensor &b) { return std::atan2(cross(a, b), a * b); };
      const auto tangent = [&](const unsigned int e, const double s) {
        return parabolas[e] ? parabolas[e].tangent(s) : edges[e].chord;
      };
      for (unsigned int e = 0; e < edges.size(); ++e)
        {
          auto &edge     = edges[e];
          edge.is_corner = edge.next < 0 || std::abs(angle(tangent(e, 1), tangent(edge.next, 0))) >=
                                              std::min(limit, corner_of_parabolas);
          if (edge.is_corner)
            continue;
          auto &next = edges[edge.next];
          if (edge.is_flat || next.is_flat)
            {
              (edge.is_flat ? next.start : edge.end) = edge.turn;
              continue;
            }
          const auto   at     = mesh.piece.vertices[edge.to];
          const Tensor before = at - parabolas[e].point(0.5), behind = parabolas[edge.next].point(0.5) - at;
          const double turn = angle(before, behind);
          const double of_circle =
            std::atan2(before.norm() * std::sin(turn), behind.norm() + before.norm() * std::cos(turn));
          edge.end   = angle(edge.chord, before) + of_circle;
          next.start = turn - of_circle + angle(behind, next.chord);
        }
      continue_to_corners();
    }

    /// The cubic through the mid node with the tangents at the ends; the parabola if that would be a different curve.
    EdgeCurve<2> Reconstruction::through_middle(const Edge &edge) const
    {
      const auto through = parabola(edge);
      if (!through || ((edge.last < 0 || edges[edge.last].is_corner) && edge.is_corner))
        return through;
      const auto   middle = through.point(0.5) - mesh.piece.vertices[edge.from];
      const double half   = std::cos((std::abs(edge.start) + std::abs(edge.end)) / 4);
      const double height = cross(edge.chord, middle) / edge.length, sines = std::sin(edge.start) + std::sin(edge.end);
      const double speed = sines != 0 ? -8 * height / sines / edge.length : 0; // relative to the length
      if (std::abs(middle * edge.chord / (edge.length * edge.length) - 0.5) > off_middle ||
          std::abs(speed * half * half - 1) > other_speed)
        return through;
      return Curve::hermite(mesh.piece.vertices[edge.from],
                            turned(speed * edge.chord, -edge.start),
                            turned(speed * edge.chord, edge.end),
                            mesh.piece.vertices[edge.to]);
    }

    /// Whether edges of about equal lengths meet at about equal angles, which are clearly less than 90 degrees.
    bool Reconstruction::is_coarse_circle(const Edge &edge) const
    {
      if (edge.last < 0 || edge.next < 0)
        return false;
      const auto  &last = edges[edge.last], &next = edges[edge.next];
      const double turn = edge.turn;
      return std::abs(turn) >= limit && std::abs(turn) < coarse_limit &&
             std::abs(last.turn - turn) < regular * std::abs(turn) &&
             std::abs(last.length - edge.length) < regular * edge.length &&
             std::abs(next.length - edge.length) < regular * edge.length;
    }

    void Reconstruction::run()
    {
      const bool by_middles = has_middles();
      if (by_middles)
        follow_middles();
      else
        {
          find_corners();
          find_flats();
          find_tangents();
        }
      std::map<Piece::Face, Curve> curves;
      unsigned int                 n_bent = 0;
      for (const auto &edge : edges)
        {
          Curve curve = by_middles ? through_middle(edge) : spline(edge);
          if (!body.has_smooth_outline)
            {
              const double sagitta_   = sagitta(curve);
              curve                   = Curve();
              curve.neglected_sagitta = sagitta_;
            }
          else if (!curve && is_coarse_circle(edge))
            curve.neglected_sagitta = 0.5 * edge.length * std::tan(std::abs(edge.turn) / 4);
          n_bent += bool(curve);
          curves[{{edge.from, edge.to}}] = curve;
        }
      for (auto &face : mesh.piece.boundary_faces)
        {
          const auto found = curves.find(face.vertices);
          face.curve =
            found != curves.end() ? found->second : curves.at({{face.vertices[1], face.vertices[0]}}).reversed();
        }
      if (n_bent > 0)
        mesh.remarks.push_back("body " + body.name + ": " + std::to_string(n_bent) + " of " +
                               std::to_string(edges.size()) + " edges of its outline " +
                               (by_middles ? "are curved by their mid nodes"
                                           : "are treated as curves, as they meet at less than " +
                                               number_text(body.corner_angle) + " degrees") +
                               " (Outline = polygon: straight)");
    }
  } // namespace

  template <>
  void smooth_outline(const scene::Body<2> &body, BodyMesh<2> &mesh)
  {
    Reconstruction(body, mesh).run();
  }

  template <int dim>
  bool leaves_out_curves(const Mesh<dim> &mesh)
  {
    bool is_neglected = false;
    for (const auto &subdomain : mesh.subdomains)
      for (const auto &[vertices, curve] : subdomain->curves)
        is_neglected = is_neglected || curve.neglected_sagitta > 0;
    return dealii::Utilities::MPI::logical_or(is_neglected, mesh.comm);
  }

  template bool leaves_out_curves(const Mesh<2> &);
  template bool leaves_out_curves(const Mesh<3> &);
} // namespace slipstick::mesh
