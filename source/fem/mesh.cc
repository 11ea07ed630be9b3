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

  template struct Mesh<2>;
} // namespace slipstick::fem
