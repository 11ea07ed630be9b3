#include <slipstick/base/turned.h>
#include <slipstick/mechanics/inertia_relief.h>
#include <slipstick/mechanics/loads.h>
#include <slipstick/mechanics/rigid_modes.h>

#include <array>
#include <numeric>
#include <string>

namespace slipstick::mechanics
{
  namespace
  {
    /// The components of turned(x), as formulas.
    template <int dim>
    std::array<std::array<std::string, dim>, n_rotations<dim>> turned_formulas()
    {
      const std::array<std::string, 3>                           x{{"x", "y", "z"}};
      std::array<std::array<std::string, dim>, n_rotations<dim>> result;
      for (unsigned int k = 0; k < n_rotations<dim>; ++k)
        {
          result[k].fill("0");
          for (unsigned int d = 0; d < dim; ++d)
            {
              dealii::Tensor<1, dim> unit;
              unit[d]          = 1;
              const auto moved = turned(unit)[k];
              for (unsigned int c = 0; c < dim; ++c)
                if (moved[c] != 0)
                  result[k][c] = (moved[c] < 0 ? "-" : "") + x[d];
            }
        }
      return result;
    }
  } // namespace

  template <int dim>
  std::vector<Eigen::MatrixXd> rigid_body_forces(const scene::Scene<dim> &scene,
                                                 const mesh::Mesh<dim>   &mesh,
                                                 const Spaces<dim>       &spaces)
  {
    const mesh::Kinematics<dim>  kinematics(scene.plane_state);
    const auto                   frames = body_frames(scene, mesh);
    std::vector<unsigned int>    all(scene.bodies.size());
    std::vector<Eigen::MatrixXd> result;
    std::iota(all.begin(), all.end(), 0u);
    scene::Scene<dim> moved = scene;
    moved.tractions.clear();
    moved.point_loads.clear();
    moved.temperatures.clear();
    const auto take = [&](const unsigned int column, const std::array<std::string, dim> &force) {
      scene::BodyForce<dim> field;
      field.bodies = all;
      for (unsigned int d = 0; d < dim; ++d)
        field.force[d] = scene::Field<dim>(force[d], "rigid motion");
      moved.body_forces = {field};
      const auto loads  = assemble_loads(moved, mesh, spaces, 0.);
      for (unsigned int p = 0; p < loads.size(); ++p)
        {
          if (column == 0)
            result.emplace_back(loads[p].size(), kinematics.n_rigid_motions());
          result[p].col(column) = loads[p];
        }
    };
    const auto translation = [](const unsigned int d) {
      std::array<std::string, dim> unit;
      unit.fill("0");
      unit[d] = "1";
      return unit;
    };
    if (kinematics.is_revolution())
      {
        take(0, translation(1)); // along the axis
        return result;
      }
    for (unsigned int d = 0; d < dim; ++d)
      take(d, translation(d));
    const auto rotations = turned_formulas<dim>();
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      take(dim + k, rotations[k]);
    for (unsigned int p = 0; p < result.size(); ++p) // about the frame instead of the origin
      {
        const auto &frame  = frames[mesh.subdomains[p]->body];
        const auto  center = turned(dealii::Tensor<1, dim>(frame.center));
        for (unsigned int k = 0; k < n_rotations<dim>; ++k)
          {
            for (unsigned int d = 0; d < dim; ++d)
              result[p].col(dim + k) -= center[k][d] * result[p].col(d);
            result[p].col(dim + k) /= frame.length;
          }
      }
    return result;
  }

  template std::vector<Eigen::MatrixXd> rigid_body_forces(const scene::Scene<2> &,
                                                          const mesh::Mesh<2> &,
                                                          const Spaces<2> &);
  template std::vector<Eigen::MatrixXd> rigid_body_forces(const scene::Scene<3> &,
                                                          const mesh::Mesh<3> &,
                                                          const Spaces<3> &);
} // namespace slipstick::mechanics
