#include <slipstick/mesh/mesh.h>

#include <algorithm>

namespace slipstick::mesh
{
  template <int dim>
  unsigned int Mesh<dim>::rank_of_subdomain(const unsigned int subdomain) const
  {
    AssertIndexRange(subdomain, n_subdomains());
    return std::upper_bound(first_subdomain.begin(), first_subdomain.end(), subdomain) - first_subdomain.begin() - 1;
  }

  template <int dim>
  bool Mesh<dim>::on_boundary(const scene::BoundaryName &where, const dealii::types::boundary_id id) const
  {
    AssertIndexRange(where.body, boundary_ids.size());
    if (where.boundary == "*" || id == cut_id)
      return id != cut_id;
    const auto named = boundary_ids[where.body].at(where.boundary);
    if (id == named)
      return true;
    if (combined_ids.empty())
      return false;
    const auto combined = combined_ids[where.body].find(id);
    return combined != combined_ids[where.body].end() && combined->second.count(named) > 0;
  }

  template struct Mesh<2>;
  template struct Mesh<3>;
} // namespace slipstick::mesh
