// Stresses at one point of a body, and loads whose work is a weighted sum of them.
#pragma once

#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mechanics/stress.h>

#include <Eigen/Dense>

#include <optional>
#include <vector>

namespace slipstick::mechanics
{
  /// A point of a body, with the cells that contain it: one, or several if it is on their boundaries.
  template <int dim>
  class StressPoint
  {
  public:
    /// @p scene, @p mesh and @p spaces must outlive this. @param x in the body, or on its true outline. @param t load
    /// factor. Collective.
    StressPoint(const scene::Scene<dim>  &scene,
                const mesh::Mesh<dim>    &mesh,
                const Spaces<dim>        &spaces,
                const unsigned int        body,
                const dealii::Point<dim> &x,
                const double              t);

    /// Recovered stress, interpolated between the nodes. Collective.
    Stress<dim> recovered(const StressResult &stress) const;

    /// Value at the point of the polynomial of one degree more than the elements that best fits the computed stresses
    /// at the superconvergent points of three layers of cells around it. Nothing if the cells do not determine it.
    /// @param u displacements by subdomain of this rank. Collective.
    std::optional<Stress<dim>> fitted(const std::vector<Eigen::VectorXd> &u) const;

    /// Positions of the nodes of the cells of this rank that contain the point, and recovered stresses there.
    std::vector<std::pair<dealii::Point<dim>, Stress<dim>>> nodes_around(const StressResult &stress) const;

    /// Loads, by subdomain of this rank, whose work is the sum of @p weights times the mean computed stresses of the
    /// cells.
    std::vector<Eigen::VectorXd> loads(const Stress<dim> &weights) const;

  private:
    struct Place
    {
      unsigned int                                           p = 0;
      typename dealii::DoFHandler<dim>::active_cell_iterator cell;
      dealii::Point<dim>                                     unit;
    };

    /// Columns: edges of a parallelepiped shaped like one of the cells, the same on all ranks [mm]. Collective.
    Eigen::Matrix<double, dim, dim> shape_of_cells() const;

    /// Positions relative to the point (dim numbers, in edges of cells) and stresses of the superconvergent points
    /// around it on this rank.
    std::vector<double> samples(const std::vector<Eigen::VectorXd> &u) const;

    const scene::Scene<dim> &scene;
    const mesh::Mesh<dim>   &mesh;
    const Spaces<dim>       &spaces;
    const double             t;
    const unsigned int       body;
    const dealii::Point<dim> x;
    const unsigned int       n_components;
    std::vector<Place>       places; // of this rank
    double                   n_all   = 0;
    double                   measure = 0; // of the cells on all ranks [mm^dim]
  };

  /// Derivatives of the von Mises stress with respect to the components; zero where it vanishes.
  template <int dim>
  Stress<dim> von_mises_derivatives(const Stress<dim> &s);
} // namespace slipstick::mechanics
