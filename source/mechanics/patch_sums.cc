#include <slipstick/mechanics/patch_sums.h>

#include <deal.II/dofs/dof_accessor.h>

namespace slipstick::mechanics
{
  template <int dim>
  PatchSums<dim>::PatchSums(const dealii::DoFHandler<dim> &dof_handler, const std::vector<unsigned int> &shared_nodes)
    : n_vertices(dof_handler.get_triangulation().n_vertices())
    , row_of_node(dof_handler.n_dofs() / dim, -1)
  {
    std::vector<bool> is_shared(row_of_node.size()), is_found(n_vertices);
    for (const unsigned int node : shared_nodes)
      is_shared[node] = true;
    for (const auto &cell : dof_handler.active_cell_iterators())
      for (const unsigned int v : cell->vertex_indices())
        if (const unsigned int vertex = cell->vertex_index(v); !is_found[vertex])
          {
            is_found[vertex]        = true;
            const unsigned int node = cell->vertex_dof_index(v, 0) / dim;
            if (is_shared[node])
              row_of_node[node] = shared.size();
            (is_shared[node] ? shared : inner).push_back(vertex);
          }
  }

  template <int dim>
  void PatchSums<dim>::start(const unsigned int n_columns, const std::function<void(Sums &)> &sum, const Use &use)
  {
    Sums sums = Sums::Zero(n_vertices, n_columns);
    sum(sums);
    for (const unsigned int v : inner)
      use(v, sums.row(v));
    of_shared.resize(shared.size(), n_columns);
    for (unsigned int r = 0; r < shared.size(); ++r)
      of_shared.row(r) = sums.row(shared[r]);
    use_later = use;
  }

  template <int dim>
  void PatchSums<dim>::finish()
  {
    for (unsigned int r = 0; r < shared.size(); ++r)
      use_later(shared[r], of_shared.row(r));
  }

  template class PatchSums<2>;
  template class PatchSums<3>;
} // namespace slipstick::mechanics
