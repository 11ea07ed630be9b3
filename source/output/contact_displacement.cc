#include <slipstick/output/contact_displacement.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace slipstick::output
{
  namespace
  {
    // Copies of a node lie together within this part of the extent of the contact nodes.
    constexpr double copy_distance = 1e-9;

    /// Where a displacement is wanted, in order of body and x.
    struct Target
    {
      unsigned int          body = 0, number = 0;
      std::array<double, 3> position{};

      bool operator<(const Target &other) const
      {
        return std::tie(body, position) < std::tie(other.body, other.position);
      }
    };

    double extent(const std::vector<Target> &targets)
    {
      double size = 0;
      for (const Target &target : targets)
        for (unsigned int d = 0; d < 3; ++d)
          size = std::max(size, std::abs(target.position[d] - targets.front().position[d]));
      return size;
    }

    /// Calls f(target) for those at a place.
    template <int dim, class F>
    void for_each_at(const std::vector<Target> &targets,
                     const unsigned int         body,
                     const dealii::Point<dim>  &x,
                     const double               tolerance,
                     const F                   &f)
    {
      Target least;
      least.body = body;
      least.position.fill(std::numeric_limits<double>::lowest());
      least.position[0] = x[0] - tolerance;
      for (auto target = std::lower_bound(targets.begin(), targets.end(), least);
           target != targets.end() && target->body == body && target->position[0] <= x[0] + tolerance;
           ++target)
        {
          bool is_here = true;
          for (unsigned int d = 1; d < dim; ++d)
            is_here = is_here && std::abs(target->position[d] - x[d]) <= tolerance;
          if (is_here)
            f(*target);
        }
    }

    /// Of the subdomains of this rank: number of the target, three components, and so on.
    template <int dim>
    std::vector<double> own_displacement(const mesh::Mesh<dim>              &mesh,
                                         const mechanics::Spaces<dim>       &spaces,
                                         const std::vector<Eigen::VectorXd> &u,
                                         const std::vector<Target>          &targets)
    {
      const double        tolerance = copy_distance * extent(targets);
      std::vector<double> found;
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
          for (const unsigned int f : cell->face_indices())
            if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() != mesh::cut_id)
              spaces.for_each_face_node(
                *mesh.subdomains[p],
                cell->face(f),
                [&](const unsigned int node, const mechanics::NodeKey &, const dealii::Point<dim> &x) {
                  for_each_at(targets, mesh.subdomains[p]->body, x, tolerance, [&](const Target &target) {
                    found.push_back(target.number);
                    for (unsigned int d = 0; d < 3; ++d)
                      found.push_back(d < dim ? u[p][dim * node + d] : 0.);
                  });
                });
      return found;
    }
  } // namespace

  template <int dim>
  std::vector<std::array<double, 3>> contact_displacement(const scene::Scene<dim>                 &scene,
                                                          const mesh::Mesh<dim>                   &mesh,
                                                          const mechanics::Spaces<dim>            &spaces,
                                                          const std::vector<Eigen::VectorXd>      &u,
                                                          const std::vector<contact::ContactNode> &nodes)
  {
    std::vector<double> wanted; // body, position
    for (const auto &node : nodes)
      {
        wanted.push_back(scene.contacts[node.pair].slave.body);
        wanted.insert(wanted.end(), node.position.begin(), node.position.end());
      }
    wanted = dealii::Utilities::MPI::broadcast(mesh.comm, wanted, 0);
    std::vector<Target> targets;
    for (unsigned int k = 0; 4 * k < wanted.size(); ++k)
      targets.push_back(
        {static_cast<unsigned int>(wanted[4 * k]), k, {{wanted[4 * k + 1], wanted[4 * k + 2], wanted[4 * k + 3]}}});
    std::sort(targets.begin(), targets.end());
    const std::vector<double> found = own_displacement(mesh, spaces, u, targets);
    std::array<double, 3>     nowhere;
    nowhere.fill(std::numeric_limits<double>::quiet_NaN());
    std::vector<std::array<double, 3>> result(nodes.size(), nowhere);
    for (const auto &of_rank : dealii::Utilities::MPI::gather(mesh.comm, found))
      for (std::size_t k = 0; k < of_rank.size(); k += 4)
        if (auto &here = result[of_rank[k]]; std::isnan(here[0]))
          here = {{of_rank[k + 1], of_rank[k + 2], of_rank[k + 3]}};
    return result;
  }

  template std::vector<std::array<double, 3>> contact_displacement(const scene::Scene<2> &,
                                                                   const mesh::Mesh<2> &,
                                                                   const mechanics::Spaces<2> &,
                                                                   const std::vector<Eigen::VectorXd> &,
                                                                   const std::vector<contact::ContactNode> &);
  template std::vector<std::array<double, 3>> contact_displacement(const scene::Scene<3> &,
                                                                   const mesh::Mesh<3> &,
                                                                   const mechanics::Spaces<3> &,
                                                                   const std::vector<Eigen::VectorXd> &,
                                                                   const std::vector<contact::ContactNode> &);
} // namespace slipstick::output
