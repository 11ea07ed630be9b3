#include <slipstick/base/gather.h>
#include <slipstick/output/contact_displacement.h>

#include <deal.II/base/mpi.h>

#include <map>
#include <set>

namespace slipstick::output
{
  namespace
  {
    using Displacements = std::map<mechanics::NodeKey, std::array<double, 3>>;

    /// Displacements of the requested nodes in subdomains of this rank.
    template <int dim>
    Displacements own_displacement(const mesh::Mesh<dim>              &mesh,
                                   const mechanics::Spaces<dim>       &spaces,
                                   const std::vector<Eigen::VectorXd> &u,
                                   const std::set<mechanics::NodeKey> &wanted)
    {
      Displacements found;
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        spaces.for_each_outline_node(mesh,
                                     p,
                                     [&](const unsigned int        node,
                                         const mechanics::NodeKey &key,
                                         const dealii::Point<dim> &) {
                                       if (wanted.count(key) > 0)
                                         for (unsigned int d = 0; d < dim; ++d)
                                           found[key][d] = u[p][dim * node + d];
                                     });
      return found;
    }
  } // namespace

  template <int dim>
  std::vector<std::array<double, 3>> contact_displacement(const mesh::Mesh<dim>                 &mesh,
                                                          const mechanics::Spaces<dim>          &spaces,
                                                          const std::vector<Eigen::VectorXd>    &u,
                                                          const std::vector<mechanics::NodeKey> &nodes)
  {
    const auto                         wanted = dealii::Utilities::MPI::broadcast(mesh.comm, nodes, 0);
    std::vector<mechanics::NodeKey>    keys;
    std::vector<std::array<double, 3>> values;
    for (const auto &[key, value] : own_displacement(mesh, spaces, u, {wanted.begin(), wanted.end()}))
      {
        keys.push_back(key);
        values.push_back(value);
      }
    const auto    keys_of_ranks   = gather(mesh.comm, keys);
    const auto    values_of_ranks = gather(mesh.comm, values);
    Displacements found;
    for (std::size_t rank = 0; rank < keys_of_ranks.size(); ++rank)
      for (std::size_t i = 0; i < keys_of_ranks[rank].size(); ++i)
        found.emplace(keys_of_ranks[rank][i], values_of_ranks[rank][i]);
    std::vector<std::array<double, 3>> result;
    if (!found.empty())
      for (const auto &key : wanted)
        result.push_back(found.at(key));
    return result;
  }

  template std::vector<std::array<double, 3>> contact_displacement(const mesh::Mesh<2> &,
                                                                   const mechanics::Spaces<2> &,
                                                                   const std::vector<Eigen::VectorXd> &,
                                                                   const std::vector<mechanics::NodeKey> &);
  template std::vector<std::array<double, 3>> contact_displacement(const mesh::Mesh<3> &,
                                                                   const mechanics::Spaces<3> &,
                                                                   const std::vector<Eigen::VectorXd> &,
                                                                   const std::vector<mechanics::NodeKey> &);
} // namespace slipstick::output
