// Displacement and stress at points of bodies.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/mechanics/stress.h>

namespace slipstick::mechanics
{
  /// Results at one point.
  template <int dim>
  struct ProbePoint
  {
    double                 distance = 0; // from the start of its line [mm]
    dealii::Point<dim>     position;     // reference configuration [mm]
    dealii::Tensor<1, dim> displacement; // [mm]
    std::array<double, 6>  stress{};     // recovered: xx, yy, xy, zz, in space xz, yz [MPa]
  };

  /// The probes of a scene, located in the mesh. Points need not be nodes.
  template <int dim>
  class Probes
  {
  public:
    /// Finds the cell of every point. @p scene, @p mesh, @p spaces must outlive this. Collective.
    /// @throws InputError on all ranks if a point is outside the body by more than a tenth of a cell.
    Probes(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh, const Spaces<dim> &spaces);

    /// Displacements @p u (by subdomain of this rank) and recovered stress, both interpolated by the shape functions of
    /// the cell; by probe and point, on all ranks. Collective.
    std::vector<std::vector<ProbePoint<dim>>> values(const std::vector<Eigen::VectorXd> &u,
                                                     const StressResult                 &stress) const;

    /// Only distances and positions, by probe and point, on all ranks.
    const std::vector<std::vector<ProbePoint<dim>>> &positions() const
    {
      return points;
    }

    /// Loads whose work is component @p d of the displacement at the first point of probe @p k, by subdomain of this
    /// rank.
    std::vector<Eigen::VectorXd> unit_force(const unsigned int k, const unsigned int d) const;

  private:
    /// Location of one point: in a cell of this rank, or on another rank.
    struct Place
    {
      bool                                                   is_own = false;
      unsigned int                                           p      = 0; // subdomain of this rank
      typename dealii::DoFHandler<dim>::active_cell_iterator cell;
      dealii::Point<dim>                                     unit; // in the reference cell
    };

    /// Finds the cell of this rank nearest to a point. @return its distance [mm] and diameter [mm].
    std::pair<double, double> find(const unsigned int body, const dealii::Point<dim> &x, Place &place) const;

    const mesh::Mesh<dim>                    &mesh;
    const Spaces<dim>                        &spaces;
    std::vector<std::vector<ProbePoint<dim>>> points; // distance and position
    std::vector<std::vector<Place>>           places;
  };
} // namespace slipstick::mechanics
