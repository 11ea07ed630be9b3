// Hooke's law in the plane and of bodies of revolution, with thermal strain.
#pragma once

#include <slipstick/scene/scene.h>

#include <deal.II/base/tensor.h>

#include <Eigen/Dense>

namespace slipstick::mechanics
{
  /// Lame coefficients that make sigma = lambda tr(eps) I + 2 mu eps hold in the plane, and with hoop strain in bodies
  /// of revolution [MPa]. In plane stress lambda is the condensed one, 2 lambda mu / (lambda + 2 mu).
  struct LameCoefficients
  {
    double lambda, mu;
  };
  LameCoefficients lame_coefficients(const scene::Material &material, const scene::PlaneState state);

  /// What Hooke's law goes by: solids have the coefficients of plane strain, in all directions.
  template <int dim>
  scene::PlaneState state_of(const scene::Scene<dim> &scene)
  {
    return dim == 3 ? scene::PlaneState::plane_strain : scene.plane_state;
  }

  /// sigma = lambda (div - e_V T) I + 2 mu (eps - e T I) of the displacement gradient and the change of temperature T;
  /// e = alpha, e_V = 3 alpha in plane strain (the strain along z is held too) and in bodies of revolution (whose hoop
  /// strain is part of div), 2 alpha in plane stress. The two parts are kept apart because the nearly incompressible
  /// element projects the first.
  struct ElasticLaw
  {
    ElasticLaw(const scene::Material &material, const scene::PlaneState state);

    LameCoefficients lame;
    double           expansion;           // e [1/K]
    double           volume_expansion;    // e_V [1/K]
    double           out_of_plane;        // sigma_zz over xx + yy: nu in plane strain, 0 in plane stress
    double           out_of_plane_change; // and -E alpha T in plane strain [MPa/K]

    /// xx, yy, xy and (of bodies of revolution) hoop stress [MPa] of a displacement gradient, a hoop strain, a
    /// dilatation (trace and hoop strain, or a projection of it, less e_V T) and T [K].
    template <int dim>
    Eigen::Array4d stress(const dealii::Tensor<2, dim> &gradient,
                          const double                  hoop,
                          const double                  dilatation,
                          const double                  temperature) const
    {
      static_assert(dim == 2, "components of the plane");
      const double mean = lame.lambda * dilatation - 2 * lame.mu * expansion * temperature;
      return {mean + 2 * lame.mu * gradient[0][0],
              mean + 2 * lame.mu * gradient[1][1],
              lame.mu * (gradient[0][1] + gradient[1][0]),
              mean + 2 * lame.mu * hoop};
    }

    /// sigma_zz in the plane [MPa]
    double zz(const double xx, const double yy, const double temperature) const
    {
      return out_of_plane * (xx + yy) + out_of_plane_change * temperature;
    }

    /// sigma : C^-1 : sigma of xx, yy, xy, with C of the plane, or with the hoop stress [MPa].
    double energy(const Eigen::Array4d &sigma) const;

  private:
    bool is_revolution;
  };

  /// Change of temperature of one body [K]: the sum of all Temperature sections that name it.
  template <int dim>
  class TemperatureOfBody
  {
  public:
    TemperatureOfBody(const scene::Scene<dim> &scene, const unsigned int body, const double t);

    bool is_zero() const
    {
      return changes.empty();
    }

    double operator()(const dealii::Point<dim> &x) const;

  private:
    std::vector<const scene::Field<dim> *> changes; // of the scene
    double                                 t;
  };

  /// Von Mises stress of xx, yy, xy and zz [MPa].
  double von_mises(const double xx, const double yy, const double xy, const double zz);
} // namespace slipstick::mechanics
