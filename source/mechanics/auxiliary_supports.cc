#include <slipstick/base/gather.h>
#include <slipstick/mechanics/auxiliary_supports.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <cmath>
#include <tuple>

namespace slipstick::mechanics
{
  namespace
  {
    // Nodes on an outline are used only if the amount at interior nodes is less than this fraction of theirs.
    constexpr double least_part_inside = 0.1;
    // Amounts that differ by less than this fraction are equal: then the place decides, independent of the number of
    // ranks.
    constexpr double same_amount = 1e-9;

    /// One displacement component of one node.
    template <int dim>
    struct StillNode
    {
      double                  amount    = 0; // its displacement under the remaining motions
      unsigned int            body      = 0;
      unsigned int            component = 0;
      std::array<double, dim> position{};

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &amount &body &component &position;
      }

      bool comes_before(const StillNode &other) const
      {
        if (std::abs(amount - other.amount) > same_amount * std::max(amount, other.amount))
          return amount > other.amount;
        return std::tie(body, position, component) < std::tie(other.body, other.position, other.component);
      }
    };

    /// Displacement component of a place of a body under every motion.
    template <int dim>
    Eigen::VectorXd displacements(const std::vector<Eigen::VectorXd>  &motions,
                                  const std::vector<tfeti::BodyFrame> &frames,
                                  const StillNode<dim>                &at)
    {
      const unsigned int k     = motions.front().size() / frames.size(); // amplitudes per body
      const auto        &frame = frames[at.body];
      Eigen::VectorXd    values(motions.size());
      if (k == 1) // a body of revolution, along its axis
        {
          for (unsigned int m = 0; m < motions.size(); ++m)
            values[m] = at.component == 1 ? motions[m][at.body] : 0.;
          return values;
        }
      for (unsigned int m = 0; m < motions.size(); ++m)
        values[m] = motions[m][at.body * k + at.component];
      for (unsigned int r = 0; r + dim < k; ++r) // rotations from axis a to axis b
        {
          const unsigned int a = dim == 2 ? 0 : (r + 1) % dim, b = dim == 2 ? 1 : (r + 2) % dim;
          if (at.component != a && at.component != b)
            continue;
          const double turn = at.component == a ? frame.center[b] - at.position[b] : at.position[a] - frame.center[a];
          for (unsigned int m = 0; m < motions.size(); ++m)
            values[m] += motions[m][at.body * k + dim + r] * turn / frame.length;
        }
      return values;
    }

    /// Nodes of this rank: interior ones, then those on outlines.
    template <int dim>
    std::array<std::vector<StillNode<dim>>, 2> nodes_of(const mesh::Mesh<dim> &mesh, const Spaces<dim> &spaces)
    {
      std::array<std::vector<StillNode<dim>>, 2> result;
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        {
          const auto            &subdomain = *mesh.subdomains[p];
          std::set<unsigned int> on_outline;
          spaces.for_each_outline_node(mesh,
                                       p,
                                       [&](const unsigned int node, const NodeKey &, const dealii::Point<dim> &) {
                                         on_outline.insert(node);
                                       });
          std::vector<dealii::types::global_dof_index> dofs;
          std::vector<unsigned int>                    nodes;
          for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
            {
              spaces.of(p).nodes_of(cell, dofs, nodes);
              for (const unsigned int v : cell->vertex_indices()) // the vertices come first
                for (unsigned int d = 0; d < dim; ++d)
                  {
                    StillNode<dim> one;
                    one.body      = subdomain.body;
                    one.component = d;
                    for (unsigned int e = 0; e < dim; ++e)
                      one.position[e] = cell->vertex(v)[e];
                    result[on_outline.count(nodes[v])].push_back(one);
                  }
            }
        }
      return result;
    }
  } // namespace

  template <int dim>
  std::vector<scene::PrescribedDisplacement<dim>> auxiliary_supports(const mesh::Mesh<dim>               &mesh,
                                                                     const Spaces<dim>                   &spaces,
                                                                     const std::vector<Eigen::VectorXd>  &motions,
                                                                     const std::vector<tfeti::BodyFrame> &frames)
  {
    auto                                            nodes = nodes_of(mesh, spaces);
    Eigen::MatrixXd                                 left  = Eigen::MatrixXd::Identity(motions.size(), motions.size());
    std::vector<scene::PrescribedDisplacement<dim>> supports;
    while (left.cols() > 0)
      {
        std::vector<StillNode<dim>> best(2); // interior, on an outline
        for (unsigned int k = 0; k < 2; ++k)
          for (auto &candidate : nodes[k])
            {
              candidate.amount = (left.transpose() * displacements(motions, frames, candidate)).norm();
              if (candidate.comes_before(best[k]))
                best[k] = candidate;
            }
        for (const auto &of_rank : all_gather(mesh.comm, best))
          for (unsigned int k = 0; k < 2; ++k)
            if (of_rank[k].comes_before(best[k]))
              best[k] = of_rank[k];
        const auto &chosen = best[best[0].amount > least_part_inside * best[1].amount ? 0 : 1];

        scene::PrescribedDisplacement<dim> support;
        support.name       = "still point " + std::to_string(supports.size() + 1);
        support.where.body = chosen.body;
        support.point.emplace();
        support.point->body = chosen.body;
        support.point->coordinates.emplace();
        for (unsigned int d = 0; d < dim; ++d)
          (*support.point->coordinates)[d] = chosen.position[d];
        support.components[chosen.component].emplace();
        supports.push_back(support);

        // remaining motions: combinations that do not move it
        const Eigen::VectorXd moved = left.transpose() * displacements(motions, frames, chosen);
        const Eigen::MatrixXd q     = Eigen::HouseholderQR<Eigen::MatrixXd>(moved).householderQ();
        left                        = (left * q.rightCols(left.cols() - 1)).eval();
      }
    return supports;
  }

  template std::vector<scene::PrescribedDisplacement<2>> auxiliary_supports(const mesh::Mesh<2> &,
                                                                            const Spaces<2> &,
                                                                            const std::vector<Eigen::VectorXd> &,
                                                                            const std::vector<tfeti::BodyFrame> &);
  template std::vector<scene::PrescribedDisplacement<3>> auxiliary_supports(const mesh::Mesh<3> &,
                                                                            const Spaces<3> &,
                                                                            const std::vector<Eigen::VectorXd> &,
                                                                            const std::vector<tfeti::BodyFrame> &);
} // namespace slipstick::mechanics
