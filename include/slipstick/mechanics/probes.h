// Displacement and stress at points of bodies.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/mechanics/stress.h>

namespace slipstick::mechanics
{
  /// What is found at one point.
  template <int dim>
  struct ProbePoint
  {
    double                 distance = 0; // from the beginning of its line [mm]
    dealii::Point<dim>     position;     // reference configuration [mm]
    dealii::Tensor<1, dim> displacement; // [mm]
    std::array<double, 6>  stress{};     // recovered: xx, yy, xy, zz, in space xz, yz [MPa]
  };

  /// The probes of a scene: where their points lie in the mesh. Points need not be nodes.
  template <int dim>
  class Probes
  {
  public:
    /// Finds the cell of every point. Collective. @p scene, @p mesh, @p spaces have to live as long as this.
    /// @throws InputError on all ranks if a point is off the body by more than a tenth of a cell.
    Probes(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh, const Spaces<dim> &spaces);

    /// By probe and point, on all ranks: displacements @p u (by subdomain of this rank) and recovered stress, both by
    /// the shape functions of the cell. Collective.
    std::vector<std::vector<ProbePoint<dim>>> values(const std::vector<Eigen::VectorXd> &u,
                                                     const StressResult                 &stress) const;

    /// By probe and point: distances and positions alone, on all ranks.
    const std::vector<std::vector<ProbePoint<dim>>> &positions() const
    {
      return points;
    }

    /// Loads, by subdomain of this rank, whose work is component @p d of the displacement at the first point of probe @p k.
    std::vector<Eigen::VectorXd> unit_force(const unsigned int k, const unsigned int d) const;

  private:
    /// Of one point: values are those at a point of a cell of this rank, or another's.
    struct Place
    {
      bool                                                   is_own = false;
      unsigned int                                           p      = 0; // subdomain of this rank
      typename dealii::DoFHandler<dim>::active_cell_iterator cell;
      dealii::Point<dim>                                     unit; // in the reference cell
    };

    /// The cell nearest to a point, of this rank's. @return its distance [mm] and diameter [mm].
    std::pair<double, double> find(const unsigned int body, const dealii::Point<dim> &x, Place &place) const;

    const mesh::Mesh<dim>                    &mesh;
    const Spaces<dim>                        &spaces;
    std::vector<std::vector<ProbePoint<dim>>> points; // distance and position
    std::vector<std::vector<Place>>           places;
  };
} // namespace slipstick::mechanics
