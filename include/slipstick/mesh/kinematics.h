// Kinematics of a plane section: strains of a displacement, measure of an area, rigid motions.
#pragma once

#include <slipstick/scene/scene.h>

#include <deal.II/base/numbers.h>
#include <deal.II/base/point.h>

#include <cmath>

namespace slipstick::mesh
{
  /// Encapsulates the differences between bodies of revolution and plane bodies. In a plane section (of some thickness)
  /// every point represents itself; in half a section of a body of revolution, x the radius and y the axis, it
  /// represents the circle 2 pi x. The hoop strain u_x / x replaces the strain along z. Integrals over the section or
  /// its outline are weighted with measure(), and with the thickness of the body, which is 1 for bodies of revolution;
  /// forces are those of the whole circumference.
  template <int dim>
  class Kinematics
  {
  public:
    /// Plane kinematics.
    Kinematics() = default;

    explicit Kinematics(const scene::PlaneState state)
      : is_revolved(state == scene::PlaneState::axisymmetric)
    {}

    bool is_revolution() const
    {
      return is_revolved;
    }

    /// 1, or the circumference at @p x [mm].
    double measure(const dealii::Point<dim> &x) const
    {
      return is_revolved ? 2 * dealii::numbers::PI * x[0] : 1.;
    }

    /// Hoop strain at @p x due to a displacement @p u_x there; 0 in the plane. Not defined on the axis.
    double hoop_strain(const double u_x, const dealii::Point<dim> &x) const
    {
      return is_revolved ? u_x / x[0] : 0.;
    }

    /// Vector from the axis of a rotation to @p x [mm]; bodies of revolution rotate about their own axis. In space the
    /// axis passes through @p axis along @p direction (not given: z).
    dealii::Tensor<1, dim> arm(const dealii::Point<dim>     &x,
                               const dealii::Point<dim>     &axis,
                               const dealii::Tensor<1, dim> &direction = dealii::Tensor<1, dim>()) const;

    /// xx, yy, xy and, if it is not a function of these, the hoop stress; in space all six.
    unsigned int n_stress_components() const
    {
      return dim == 3 ? 6 : is_revolved ? 4 : 3;
    }

    /// Per body: two translations and a rotation, or only the translation along the axis (a radial motion strains every
    /// ring).
    unsigned int n_rigid_motions() const
    {
      return is_revolved ? 1 : dim * (dim + 1) / 2;
    }

    /// Whether @p x is on the axis of revolution, where the radial displacement is 0. @param size of the body [mm].
    bool is_on_axis(const dealii::Point<dim> &x, const double size) const
    {
      return is_revolved && std::abs(x[0]) <= on_axis * size;
    }

    // Relative to the size of a body: files give coordinates with about seven digits, placements add rounding.
    static constexpr double on_axis = 1e-7;

  private:
    bool is_revolved = false;
  };
} // namespace slipstick::mesh
