#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/mesh/refinement.h>

#include <algorithm>

namespace slipstick::mesh
{
  namespace
  {
    /// One pass over all levels. @return whether @p refined was complete; if not, missing parents have been added.
    template <int dim>
    bool refine_by_levels(AdaptedPiece<dim> &mesh, std::vector<bool> &is_regular, std::set<CellPath> &refined)
    {
      std::size_t deepest = 0;
      for (const auto &path : refined)
        deepest = std::max(deepest, path.size());
      for (std::size_t level = 1; level <= deepest; ++level)
        {
          std::vector<bool> marked(mesh.paths.size());
          for (unsigned int c = 0; c < marked.size(); ++c)
            marked[c] = is_regular[c] && mesh.paths[c].size() == level && refined.count(mesh.paths[c]) > 0;
          if (std::find(marked.begin(), marked.end(), true) == marked.end())
            continue;
          const auto            finer = refined_at(mesh.piece, marked);
          std::vector<CellPath> paths;
          std::vector<bool>     regular;
          bool                  is_complete = true;
          for (const auto &origin : finer.origins)
            {
              const CellPath &parent = mesh.paths[origin.parent];
              if (!origin.is_parent && !is_regular[origin.parent])
                is_complete = !refined.insert(parent).second && is_complete;
              paths.push_back(parent);
              if (!origin.is_parent && origin.is_regular)
                paths.back().push_back(origin.child);
              regular.push_back(origin.is_parent ? is_regular[origin.parent] : origin.is_regular);
            }
          if (!is_complete)
            return false;
          mesh.piece = finer.piece;
          mesh.paths = std::move(paths);
          is_regular = std::move(regular);
        }
      return true;
    }
  } // namespace

  CellKey cell_key(std::vector<GlobalVertex> vertices)
  {
    CellKey key;
    Assert(vertices.size() <= key.size(), dealii::ExcIndexRange(vertices.size(), 0, key.size() + 1));
    key.fill(std::numeric_limits<GlobalVertex>::max());
    std::sort(vertices.begin(), vertices.end());
    std::copy(vertices.begin(), vertices.end(), key.begin());
    return key;
  }

  template <int dim>
  AdaptedPiece<dim> adapted(const MeshPiece<dim> &whole, std::set<CellPath> &refined)
  {
    for (;;)
      {
        AdaptedPiece<dim> mesh{whole, {}};
        for (std::uint32_t c = 0; c < whole.cells.size(); ++c)
          mesh.paths.push_back({c});
        std::vector<bool> is_regular(whole.cells.size(), true);
        if (refine_by_levels(mesh, is_regular, refined))
          return mesh;
      }
  }

  template AdaptedPiece<2> adapted(const MeshPiece<2> &, std::set<CellPath> &);
  template AdaptedPiece<3> adapted(const MeshPiece<3> &, std::set<CellPath> &);
} // namespace slipstick::mesh
