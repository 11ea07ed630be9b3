#include <slipstick/fem/mesh.h>

#include <algorithm>

namespace slipstick::fem
{
  template <int dim>
  unsigned int Mesh<dim>::rank_of_subdomain(const unsigned int subdomain) const
  {
    AssertIndexRange(subdomain, n_subdomains());
    return std::upper_bound(first_subdomain.begin(), first_subdomain.end(), subdomain) - first_subdomain.begin() - 1;
  }

  template <int dim>
  bool on_boundary(const Mesh<dim>                 &mesh,
                   const unsigned int               body,
                   const std::string               &name,
                   const dealii::types::boundary_id id)
  {
    if (id == cut_id)
      return false;
    return name == "*" || mesh.boundary_ids[body].at(name) == id;
  }

  template struct Mesh<2>;
  template bool on_boundary(const Mesh<2> &, const unsigned int, const std::string &, const dealii::types::boundary_id);
} // namespace slipstick::fem
