// Loads on the volume of a subdomain: body forces and thermal strain.
#pragma once

#include <slipstick/mechanics/load_resultant.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mesh/kinematics.h>

#include <Eigen/Dense>

#include <array>
#include <vector>

namespace slipstick::mechanics
{
  /// The volume of one subdomain at load factor t.
  template <int dim>
  class VolumeLoad
  {
  public:
    VolumeLoad(const scene::Scene<dim> &scene_,
               const mesh::Mesh<dim>   &mesh,
               const Spaces<dim>       &spaces,
               const unsigned int       p,
               const double             t_);

    /// @param load of the subdomain [N]. @param sums resultants of the tractions, unchanged, followed by those of the
    /// body forces.
    void add_to(Eigen::VectorXd &load, std::vector<LoadResultant> &sums) const;

    /// For body forces given by formulas: difference from a finer quadrature.
    std::vector<QuadratureDifference> differences() const;

  private:
    using Vector = dealii::Tensor<1, dim>;

    double weight(const dealii::Point<dim> &x) const;
    Vector vector(const std::array<scene::Field<dim>, dim> &fields, const dealii::Point<dim> &x) const;
    Vector body_force(const scene::BodyForce<dim> &load, const dealii::Point<dim> &x) const;
    void   add_body_forces(Eigen::VectorXd &load, std::vector<LoadResultant> &sums) const;
    void   add_thermal_strain(Eigen::VectorXd &load) const;

    const scene::Scene<dim>       &scene;
    const Element<dim>            &element;
    const dealii::DoFHandler<dim> &dof_handler;
    const unsigned int             number; // of the body
    const scene::Body<dim>        &body;
    const mesh::Kinematics<dim>    kinematics;
    const double                   t;
    std::vector<unsigned int>      body_forces; // on this body
  };
} // namespace slipstick::mechanics
