// Hooke's law in the plane, for bodies of revolution and in space, with thermal strain.
#pragma once

#include <slipstick/scene/scene.h>

#include <deal.II/base/tensor.h>

#include <Eigen/Dense>

namespace slipstick::mechanics
{
  /// Lame coefficients for sigma = lambda tr(eps) I + 2 mu eps in the plane, with the hoop strain in bodies of
  /// revolution [MPa]. In plane stress lambda is the condensed one, 2 lambda mu / (lambda + 2 mu).
  struct LameCoefficients
  {
    double lambda, mu;
  };
  LameCoefficients lame_coefficients(const scene::Material &material, const scene::PlaneState state);

  /// Stress components: xx, yy, xy, zz (hoop), in space also xz, yz.
  template <int dim>
  using Stress = Eigen::Array<double, 2 * dim, 1>;

  /// Coefficients of Hooke's law; for solids those of plane strain, in all directions.
  template <int dim>
  scene::PlaneState state_of(const scene::Scene<dim> &scene)
  {
    return dim == 3 ? scene::PlaneState::plane_strain : scene.plane_state;
  }

  /// sigma = lambda (div - e_V T) I + 2 mu (eps - e T I) for the displacement gradient and the change of temperature T;
  /// e = alpha, e_V = 3 alpha in plane strain (the strain along z is prevented) and in bodies of revolution (whose hoop
  /// strain is part of div), 2 alpha in plane stress. The two parts are kept separate because the nearly incompressible
  /// element projects the first.
  struct ElasticLaw
  {
    ElasticLaw(const scene::Material &material, const scene::PlaneState state);

    LameCoefficients lame;
    double           expansion;           // e [1/K]
    double           volume_expansion;    // e_V [1/K]
    double           out_of_plane;        // sigma_zz over (xx + yy): nu in plane strain, 0 in plane stress
    double           out_of_plane_change; // additional sigma_zz per T: -E alpha in plane strain [MPa/K]

    /// Stresses xx, yy, xy and (for bodies of revolution) hoop, in space zz, xz, yz [MPa] from a displacement gradient,
    /// a hoop strain, a dilatation (trace plus hoop strain, or its projection, minus e_V T) and T [K].
    template <int dim>
    Stress<dim> stress(const dealii::Tensor<2, dim> &gradient,
                       const double                  hoop,
                       const double                  dilatation,
                       const double                  temperature) const
    {
      const double mean = lame.lambda * dilatation - 2 * lame.mu * expansion * temperature;
      Stress<dim>  s;
      s[0] = mean + 2 * lame.mu * gradient[0][0];
      s[1] = mean + 2 * lame.mu * gradient[1][1];
      s[2] = lame.mu * (gradient[0][1] + gradient[1][0]);
      if constexpr (dim == 2)
        s[3] = mean + 2 * lame.mu * hoop;
      else
        {
          s[3] = mean + 2 * lame.mu * gradient[2][2];
          s[4] = lame.mu * (gradient[0][2] + gradient[2][0]);
          s[5] = lame.mu * (gradient[1][2] + gradient[2][1]);
        }
      return s;
    }

    /// sigma_zz in the plane [MPa]
    double zz(const double xx, const double yy, const double temperature) const
    {
      return out_of_plane * (xx + yy) + out_of_plane_change * temperature;
    }

    /// sigma : C^-1 : sigma for xx, yy, xy in the plane, with the hoop stress, or for all six components [MPa].
    double energy(const Stress<2> &sigma) const;
    double energy(const Stress<3> &sigma) const;

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

  /// Von Mises stress [MPa].
  double von_mises(const double xx,
                   const double yy,
                   const double xy,
                   const double zz,
                   const double xz = 0,
                   const double yz = 0);

  /// The same of components in the order of Stress<dim>.
  template <int dim, class Components>
  double von_mises(const Components &s)
  {
    if constexpr (dim == 2)
      return von_mises(s[0], s[1], s[2], s[3]);
    else
      return von_mises(s[0], s[1], s[2], s[3], s[4], s[5]);
  }
} // namespace slipstick::mechanics
