#include <slipstick/mechanics/elasticity.h>

#include <algorithm>
#include <cmath>

namespace slipstick::mechanics
{
  LameCoefficients lame_coefficients(const scene::Material &material, const scene::PlaneState state)
  {
    const double E = material.young_modulus, nu = material.poisson_ratio;
    const double mu = E / (2 * (1 + nu));
    const double lambda =
      state == scene::PlaneState::plane_stress ? E * nu / (1 - nu * nu) : E * nu / ((1 + nu) * (1 - 2 * nu));
    return {lambda, mu};
  }

  ElasticLaw::ElasticLaw(const scene::Material &material, const scene::PlaneState state)
    : lame(lame_coefficients(material, state))
    , expansion(material.expansion)
    , is_revolution(state == scene::PlaneState::axisymmetric)
  {
    const bool is_strain = state == scene::PlaneState::plane_strain;
    volume_expansion     = (state == scene::PlaneState::plane_stress ? 2 : 3) * expansion;
    out_of_plane         = is_strain ? material.poisson_ratio : 0;
    out_of_plane_change  = is_strain ? -material.young_modulus * expansion : 0;
  }

  double ElasticLaw::energy(const Stress<2> &s) const
  {
    if (is_revolution)
      {
        const double trace = s[0] + s[1] + s[3];
        return (s[0] * s[0] + s[1] * s[1] + s[3] * s[3] + 2 * s[2] * s[2] -
                lame.lambda / (3 * lame.lambda + 2 * lame.mu) * trace * trace) /
               (2 * lame.mu);
      }
    const double mean = lame.lambda / (2 * (lame.lambda + lame.mu)) * (s[0] + s[1]);
    return (s[0] * (s[0] - mean) + s[1] * (s[1] - mean) + 2 * s[2] * s[2]) / (2 * lame.mu);
  }

  double ElasticLaw::energy(const Stress<3> &s) const
  {
    const double trace = s[0] + s[1] + s[3];
    return (s[0] * s[0] + s[1] * s[1] + s[3] * s[3] + 2 * (s[2] * s[2] + s[4] * s[4] + s[5] * s[5]) -
            lame.lambda / (3 * lame.lambda + 2 * lame.mu) * trace * trace) /
           (2 * lame.mu);
  }

  template <int dim>
  TemperatureOfBody<dim>::TemperatureOfBody(const scene::Scene<dim> &scene, const unsigned int body, const double t_)
    : t(t_)
  {
    for (const auto &temperature : scene.temperatures)
      if (std::find(temperature.bodies.begin(), temperature.bodies.end(), body) != temperature.bodies.end())
        changes.push_back(&temperature.change);
  }

  template <int dim>
  double TemperatureOfBody<dim>::operator()(const dealii::Point<dim> &x) const
  {
    double sum = 0;
    for (const auto *change : changes)
      sum += change->value(x, t);
    return sum;
  }

  double von_mises(const double xx, const double yy, const double xy, const double zz, const double xz, const double yz)
  {
    return std::sqrt(((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) / 2 + 3 * xy * xy +
                     3 * (xz * xz + yz * yz));
  }

  template class TemperatureOfBody<2>;
  template class TemperatureOfBody<3>;
} // namespace slipstick::mechanics
