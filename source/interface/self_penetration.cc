#include <slipstick/base/box_tree.h>
#include <slipstick/base/cross.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/interface/part_pieces.h>
#include <slipstick/interface/self_penetration.h>

#include <algorithm>
#include <cmath>

namespace slipstick::interface
{
  namespace
  {
    // Rays are followed in pieces of this many chords: many of them are long but hit something near.
    constexpr double piece_of_ray = 4;
    // Flanks of a slit may coincide: rays start this fraction of a chord below the surface.
    constexpr double below_surface = 1e-6;

    template <int dim>
    struct Hit
    {
      double                  distance = 0; // along the ray [mm]
      std::array<double, dim> shares{};     // of the nodes of the piece
    };

    /// Where the ray from x along the unit vector n meets a piece from outside.
    std::optional<Hit<2>> meet(const dealii::Point<2>                &x,
                               const dealii::Tensor<1, 2>            &n,
                               const std::array<dealii::Point<2>, 2> &piece)
    {
      const dealii::Tensor<1, 2> along = piece[1] - piece[0], to = piece[0] - x;
      const double               facing = cross(n, along); // normal of the piece times n, times its length
      if (facing >= 0)
        return {};
      const double s = cross(to, n) / facing;
      if (s < 0 || s > 1)
        return {};
      return Hit<2>{cross(to, along) / facing, {{1 - s, s}}};
    }

    std::optional<Hit<3>> meet(const dealii::Point<3>                &x,
                               const dealii::Tensor<1, 3>            &n,
                               const std::array<dealii::Point<3>, 3> &piece)
    {
      const dealii::Tensor<1, 3> a = piece[1] - piece[0], b = piece[2] - piece[0], area = cross_product_3d(a, b);
      const double               facing = n * area;
      if (facing >= 0)
        return {};
      const dealii::Tensor<1, 3> to = x - piece[0], turned = cross_product_3d(to, n);
      const double               s = b * turned / -facing, t = a * turned / facing;
      if (s < 0 || t < 0 || s + t > 1)
        return {};
      return Hit<3>{-(to * area) / facing, {{1 - s - t, s, t}}};
    }

    template <class Part>
    bool share_a_node(const Part &a, const Part &b)
    {
      return std::any_of(a.keys.begin(), a.keys.begin() + a.n_nodes, [&](const auto &key) {
        return std::find(b.keys.begin(), b.keys.begin() + b.n_nodes, key) != b.keys.begin() + b.n_nodes;
      });
    }
  } // namespace

  template <int dim>
  std::optional<Penetration> self_penetration(const std::vector<mechanics::BoundaryPart<dim>> &before,
                                              const std::vector<mechanics::BoundaryPart<dim>> &now,
                                              const std::set<unsigned int>                    &exempt)
  {
    // the size of the body and displacements without their mean limit the length of the rays
    dealii::Tensor<1, dim>                  mean;
    double                                  n_nodes = 0;
    std::vector<typename BoxTree<dim>::Box> boxes;
    const auto u = [&](const unsigned int e, const unsigned int i) { return now[e].node(i) - before[e].node(i); };
    for (unsigned int e = 0; e < before.size(); ++e)
      {
        std::vector<dealii::Point<dim>> nodes;
        for (unsigned int i = 0; i < before[e].n_nodes; ++i)
          {
            mean += u(e, i);
            nodes.push_back(before[e].node(i));
          }
        n_nodes += before[e].n_nodes;
        boxes.push_back(BoxTree<dim>::box_around(nodes));
      }
    mean /= n_nodes;
    double largest = 0;
    for (unsigned int e = 0; e < before.size(); ++e)
      for (unsigned int i = 0; i < before[e].n_nodes; ++i)
        largest = std::max(largest, (u(e, i) - mean).norm());

    std::optional<Penetration> deepest;
    const BoxTree<dim>         tree(boxes);
    const double               reach = std::min(2 * largest, extent(before));
    for (unsigned int e = 0; e < before.size(); ++e)
      {
        if (exempt.count(e) > 0)
          continue;
        const auto   x     = before[e].middle();
        const auto   n     = mechanics::middle_normal(before[e]);
        const double start = -below_surface * before[e].chord();
        const double own   = (now[e].middle() - x) * n;
        // the nearest place that x sees, and by how much it has come nearer
        double nearest = reach, closing = 0, chord = 0, to = 0;
        for (double from = start; from < nearest; from = to)
          {
            to = from + piece_of_ray * before[e].chord();
            for (const unsigned int f : tree.near(
                   BoxTree<dim>::box_around({dealii::Point<dim>(x + from * n), dealii::Point<dim>(x + to * n)})))
              if (f != e && !share_a_node(before[e], before[f]))
                for (const auto &piece : flat_pieces(before[f]))
                  {
                    std::array<dealii::Point<dim>, dim> corners;
                    for (unsigned int k = 0; k < dim; ++k)
                      corners[k] = before[f].node(piece[k]);
                    const auto hit = meet(x, n, corners);
                    if (!hit || hit->distance < start || hit->distance > nearest)
                      continue;
                    nearest = hit->distance;
                    chord   = before[f].chord();
                    closing = own;
                    for (unsigned int k = 0; k < dim; ++k)
                      closing -= hit->shares[k] * (u(f, piece[k]) * n);
                  }
          }
        take_deeper(deepest, closing - std::max(0., nearest), x, std::min(before[e].chord(), chord), 0.);
      }
    return deepest;
  }

  template std::optional<Penetration> self_penetration<2>(const std::vector<mechanics::BoundaryPart<2>> &,
                                                          const std::vector<mechanics::BoundaryPart<2>> &,
                                                          const std::set<unsigned int> &);
  template std::optional<Penetration> self_penetration<3>(const std::vector<mechanics::BoundaryPart<3>> &,
                                                          const std::vector<mechanics::BoundaryPart<3>> &,
                                                          const std::set<unsigned int> &);
} // namespace slipstick::interface
