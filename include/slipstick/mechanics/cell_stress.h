// Stresses of displacements at points of cells.
#pragma once

#include <slipstick/mechanics/cell_values.h>
#include <slipstick/mechanics/dilatation.h>
#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mesh/kinematics.h>

#include <Eigen/Dense>

#include <optional>
#include <vector>

namespace slipstick::mechanics
{
  /// The data on which the stresses of one subdomain depend, except its displacement.
  template <int dim>
  struct StressModel
  {
    /// Keeps references to all arguments. @param p subdomain of this rank. @param t load factor.
    StressModel(const scene::Scene<dim> &scene,
                const mesh::Mesh<dim>   &mesh,
                const Spaces<dim>       &spaces,
                const unsigned int       p,
                const double             t);

    const Element<dim>            &element;
    const dealii::DoFHandler<dim> &dof_handler;
    double                         thickness;
    mesh::Kinematics<dim>          kinematics;
    ElasticLaw                     law;
    TemperatureOfBody<dim>         temperature;
    bool                           project;      // the dilatation
    unsigned int                   n_components; // xx, yy, xy, of bodies of revolution hoop; in space all six
  };

  /// Stresses at the points of a rule, cell by cell.
  template <int dim>
  class CellStress
  {
  public:
    CellStress(const StressModel<dim> &on, const dealii::Quadrature<dim> &points);

    /// @param u displacement at the nodes of the cell, dim x nodes [mm]. @return points x components [MPa].
    const Eigen::MatrixXd &reinit(const typename CellValues<dim>::Cell &cell, const Eigen::MatrixXd &u);

    /// Weight of point q in integrals over the cell, in the plane over its area [mm^dim].
    double JxW(const unsigned int q) const
    {
      return (*values).JxW(q);
    }

    /// JxW times thickness or circumference.
    double weight(const unsigned int q) const
    {
      const double in_plane = (*values).JxW(q) * on.thickness;
      return on.kinematics.is_revolution() ? in_plane * on.kinematics.measure(values.point(q)) : in_plane;
    }

  private:
    dealii::UpdateFlags flags() const;

    double hoop_strain_at(const CellValues<dim> &at, const unsigned int q, const Eigen::MatrixXd &u) const;

    /// Projects the dilatation as in the stiffness: from the points of the stiffness rule, evaluated at those of this
    /// rule.
    void project_dilatation(const typename CellValues<dim>::Cell &cell, const Eigen::MatrixXd &u);

    const StressModel<dim>         &on;
    CellValues<dim>                 values;
    std::optional<CellValues<dim>>  all_values; // at the points of the stiffness rule, for the projection
    DilatationProjection<dim>       projection;
    Eigen::MatrixXd                 stress;
    Eigen::VectorXd                 dilatation, temperature;
    dealii::Quadrature<dim>         rule; // of the stiffness
    Eigen::VectorXd                 of_projection;
    std::vector<dealii::Point<dim>> real_points;
  };

  /// Displacement at @p nodes, dim x nodes.
  template <int dim>
  Eigen::MatrixXd displacement_at(const std::vector<unsigned int> &nodes, const Eigen::VectorXd &u);
} // namespace slipstick::mechanics
