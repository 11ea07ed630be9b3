#include <slipstick/base/gather.h>
#include <slipstick/mechanics/creases.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace slipstick::mechanics
{
  namespace
  {
    using Ends = std::array<NodeKey, 2>; // in ascending order

    /// One facet at an edge.
    struct HalfCrease
    {
      unsigned int                         body = 0;
      Ends                                 keys{};
      std::array<std::array<double, 3>, 2> at{};
      Crease::Side                         side;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &body &keys &at &side;
      }

      bool operator<(const HalfCrease &other) const
      {
        return std::tie(body, keys) < std::tie(other.body, other.keys);
      }

      bool is_at_same_edge(const HalfCrease &other) const
      {
        return body == other.body && keys == other.keys;
      }
    };

    HalfCrease half_crease(const SurfaceFacet &facet, const unsigned int a, const unsigned int b)
    {
      HalfCrease half;
      half.body          = facet.body;
      half.side.boundary = facet.boundary;
      half.side.normal   = facet.outline_normal(a) + facet.outline_normal(b);
      half.side.normal /= half.side.normal.norm();
      half.side.along = facet.node(b) - facet.node(a);
      half.keys       = {{facet.keys[a], facet.keys[b]}};
      half.at         = {{facet.at[a], facet.at[b]}};
      if (half.keys[1] < half.keys[0])
        {
          std::swap(half.keys[0], half.keys[1]);
          std::swap(half.at[0], half.at[1]);
        }
      return half;
    }

    /// Joins the halves of edges, sorts the creases of interest into @p found, and keeps the halves without a partner.
    template <class F>
    void join(std::vector<HalfCrease> &halves, const F &is_of_interest, std::vector<Crease> &found)
    {
      std::sort(halves.begin(), halves.end());
      std::vector<HalfCrease> single;
      for (std::size_t i = 0, end = 0; i < halves.size(); i = end)
        {
          while (end < halves.size() && halves[end].is_at_same_edge(halves[i]))
            ++end;
          if (end == i + 1)
            single.push_back(halves[i]);
          else if (end == i + 2) // otherwise parts of a body touch along an edge only
            if (const Crease crease{halves[i].body, halves[i].at, {{halves[i].side, halves[i + 1].side}}};
                is_of_interest(crease))
              found.push_back(crease);
        }
      halves = std::move(single);
    }
  } // namespace

  double Crease::turn() const
  {
    const auto &n = sides[0].normal, &m = sides[1].normal, &along = sides[0].along;
    return std::atan2(cross_product_3d(n, m) * along / along.norm(), n * m);
  }

  std::vector<Crease> creases(const mesh::Mesh<3> &mesh, const Spaces<3> &spaces, const double least_turn)
  {
    const auto is_of_interest = [&](const Crease &crease) {
      return crease.sides[0].boundary != crease.sides[1].boundary || crease.turn() <= -least_turn;
    };
    std::vector<HalfCrease> halves;
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
        for (const unsigned int f : cell->face_indices())
          if (mesh::is_on_outline(cell->face(f)))
            {
              const auto facet = surface_part(*mesh.subdomains[p], spaces, cell, f);
              for (unsigned int i = 0; i < facet.n_corners(); ++i)
                halves.push_back(half_crease(facet, i, (i + 1) % facet.n_corners()));
            }
    std::vector<Crease> own, all;
    join(halves, is_of_interest, own); // the others are at cuts between ranks
    std::vector<HalfCrease> at_cuts;
    for (const auto &list : all_gather(mesh.comm, halves))
      at_cuts.insert(at_cuts.end(), list.begin(), list.end());
    for (const auto &list : all_gather(mesh.comm, own))
      all.insert(all.end(), list.begin(), list.end());
    join(at_cuts, is_of_interest, all);
    std::sort(all.begin(), all.end(), [](const Crease &a, const Crease &b) {
      return std::tie(a.body, a.at) < std::tie(b.body, b.at);
    });
    return all;
  }
} // namespace slipstick::mechanics
