#include <slipstick/base/termination.h>
#include <slipstick/mesh/metis_parts.h>

#include <metis.h>

#include <cmath>
#include <numeric>
#include <tuple>

namespace slipstick::mesh
{
  namespace
  {
    // In the plane larger numbers of parts are cut k-way, which keeps each part connected. Bisection gives rounder
    // parts (METIS manual, section 5.1); parts of solids that are not connected become several.
    constexpr unsigned int most_bisected_in_plane = 8;

    // METIS uses integer weights and sums them in 32 bits.
    constexpr double weight_of_mean_face = 100, largest_sum = 1e9;

    // Bisection: allowed excess of the largest part over the mean, in thousandths; METIS' default for k-way partitions.
    // With METIS' default for bisection (1) more cells protrude from the parts.
    constexpr idx_t imbalance_of_solids = 30;

    /// Part of the surface of a cell.
    template <std::size_t n>
    struct Side
    {
      std::array<unsigned int, n> vertices; // ascending
      unsigned int                cell;
      double                      weight;
    };

    struct Link
    {
      unsigned int a, b; // cells
      double       weight;
    };

    template <int dim>
    double size_of(const MeshPiece<dim> &piece, const typename MeshPiece<dim>::Face &face)
    {
      const auto x = [&](const unsigned int k) { return piece.vertices[face[k]]; };
      if constexpr (dim == 2)
        return x(0).distance(x(1));
      else
        {
          const auto area =
            [&](const unsigned int a, const unsigned int b, const unsigned int c, const unsigned int d) {
              return dealii::cross_product_3d(x(b) - x(a), x(d) - x(c)).norm() / 2;
            };
          if (face.back() == MeshPiece<dim>::no_vertex)
            return area(0, 1, 0, 2);
          // half the product of the diagonals; vertices are sorted, and other pairings give less
          return std::max({area(0, 1, 2, 3), area(0, 2, 1, 3), area(0, 3, 1, 2)});
        }
    }

    /// The faces of a cell, their weights relative to the geometric mean of their sizes.
    template <int dim>
    std::vector<Side<MeshPiece<dim>::vertices_per_face>> faces_of_cell(const MeshPiece<dim> &piece,
                                                                       const unsigned int    cell)
    {
      std::vector<Side<MeshPiece<dim>::vertices_per_face>> faces;
      double                                               mean = 0; // logarithm
      for (unsigned int f = 0; f < n_faces<dim>(piece.cells[cell]); ++f)
        {
          const auto   face = face_of_cell<dim>(piece.cells[cell], f);
          const double size = std::max(size_of(piece, face), std::numeric_limits<double>::min());
          faces.push_back({face, cell, size});
          mean += std::log(size) / n_faces<dim>(piece.cells[cell]);
        }
      for (auto &face : faces)
        face.weight /= std::exp(mean);
      return faces;
    }

    /// Adds the edges of a cell, weighted by the smaller of the two faces there times its ratio to the larger one, and
    /// reweights the faces, so that a face together with its edges counts by its size.
    template <class Faces>
    void add_edges(const MeshPiece<3> &piece, Faces &faces_of_cell, std::vector<Side<2>> &edges)
    {
      const unsigned int cell     = faces_of_cell[0].cell;
      auto               weighted = faces_of_cell;
      for (const auto &edge : lines_of_cell(piece.cells[cell]))
        {
          std::vector<unsigned int> around; // the two faces
          for (unsigned int f = 0; f < faces_of_cell.size(); ++f)
            if (const auto &face = faces_of_cell[f].vertices;
                std::includes(face.begin(), face.end(), edge.begin(), edge.end()))
              around.push_back(f);
          const auto [smaller, larger] =
            std::minmax(faces_of_cell[around.at(0)].weight, faces_of_cell[around.at(1)].weight);
          const double weight = smaller * smaller / larger;
          edges.push_back({edge, cell, weight});
          for (const unsigned int f : around)
            weighted[f].weight += faces_of_cell[f].weight - weight;
        }
      faces_of_cell = std::move(weighted);
    }

    /// Adds a link for every pair of cells that share a side. In a lattice one other cell is opposite an edge; if there
    /// are more, they share its weight.
    template <std::size_t n>
    void add_links(std::vector<Side<n>> sides, std::vector<Link> &links)
    {
      std::sort(sides.begin(), sides.end(), [](const auto &s, const auto &t) {
        return std::tie(s.vertices, s.cell) < std::tie(t.vertices, t.cell);
      });
      for (std::size_t k = 0, end; k < sides.size(); k = end)
        {
          for (end = k; end < sides.size() && sides[end].vertices == sides[k].vertices;)
            ++end;
          const double n_opposite = end - k > 4 ? end - k - 3. : 1.;
          for (std::size_t i = k; i < end; ++i)
            for (std::size_t j = i + 1; j < end; ++j)
              links.push_back(
                {sides[i].cell, sides[j].cell, std::sqrt(sides[i].weight * sides[j].weight) / n_opposite});
        }
    }

    template <int dim>
    std::vector<Link> weighted_links(const MeshPiece<dim> &piece)
    {
      std::vector<Side<MeshPiece<dim>::vertices_per_face>> faces;
      std::vector<Side<2>>                                 edges;
      for (unsigned int c = 0; c < piece.cells.size(); ++c)
        {
          auto of_cell = faces_of_cell(piece, c);
          if constexpr (dim == 3)
            add_edges(piece, of_cell, edges);
          faces.insert(faces.end(), of_cell.begin(), of_cell.end());
        }
      std::vector<Link> links;
      add_links(std::move(faces), links);
      if constexpr (dim == 3)
        {
          add_links(std::move(edges), links);
          // one link per pair of cells: a face weighs at least as much as its edges
          std::sort(links.begin(), links.end(), [](const Link &s, const Link &t) {
            return std::tie(s.a, s.b, t.weight) < std::tie(t.a, t.b, s.weight);
          });
          links.erase(std::unique(links.begin(),
                                  links.end(),
                                  [](const Link &s, const Link &t) { return s.a == t.a && s.b == t.b; }),
                      links.end());
        }
      return links;
    }
  } // namespace

  template <int dim>
  std::vector<unsigned int> metis_parts(const MeshPiece<dim> &piece,
                                        const unsigned int    n_parts,
                                        const unsigned int    seed)
  {
    const unsigned int        n_cells = piece.cells.size();
    std::vector<unsigned int> part(n_cells, 0);
    if (n_parts <= 1)
      return part;
    if (n_parts >= n_cells)
      {
        std::iota(part.begin(), part.end(), 0);
        return part;
      }

    const bool is_bisected = dim == 3 || n_parts <= most_bisected_in_plane;

    // linked cells, in METIS' compressed row format
    const auto         links = weighted_links(piece);
    std::vector<idx_t> first(n_cells + 1, 0);
    double             sum = 0;
    for (const Link &link : links)
      {
        ++first[link.a + 1];
        ++first[link.b + 1];
        sum += 2 * link.weight;
      }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<idx_t> neighbours(first.back()), weights(first.back()), next(first.begin(), first.end() - 1);
    const double       scale = std::min(weight_of_mean_face, largest_sum / sum);
    const auto         add   = [&](const unsigned int c, const unsigned int other, const double weight) {
      weights[next[c]]      = std::max(1., std::round(scale * weight));
      neighbours[next[c]++] = other;
    };
    for (const Link &link : links)
      {
        add(link.b, link.a, link.weight);
        add(link.a, link.b, link.weight);
      }

    idx_t options[METIS_NOPTIONS];
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_NUMBERING] = 0;
    options[METIS_OPTION_SEED]      = seed;
    if (dim == 3)
      options[METIS_OPTION_UFACTOR] = imbalance_of_solids;
    options[METIS_OPTION_CONTIG] = is_bisected ? 0 : 1; // connected parts
    idx_t              n = n_cells, n_weights = 1, parts = n_parts, n_cut = 0;
    std::vector<idx_t> result(n_cells);
    const auto         partition = is_bisected ? METIS_PartGraphRecursive : METIS_PartGraphKway;
    const int          status    = partition(&n,
                                 &n_weights,
                                 first.data(),
                                 neighbours.data(),
                                 nullptr,
                                 nullptr,
                                 weights.data(),
                                 &parts,
                                 nullptr,
                                 nullptr,
                                 options,
                                 &n_cut,
                                 result.data());
    raise_termination(status == METIS_ERROR);
    AssertThrow(status == METIS_OK, dealii::ExcMessage("METIS failed with status " + std::to_string(status)));
    part.assign(result.begin(), result.end());
    return part;
  }

  template std::vector<unsigned int> metis_parts(const MeshPiece<2> &, const unsigned int, const unsigned int);
  template std::vector<unsigned int> metis_parts(const MeshPiece<3> &, const unsigned int, const unsigned int);
} // namespace slipstick::mesh
