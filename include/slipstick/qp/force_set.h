// The admissible forces of contact laws as a feasible set: polygons for nodes, bounds for all other entries.
//
// The operations are those of box.h: projection, its derivative, Farkas certificate.
#pragma once

#include <slipstick/qp/box.h>
#include <slipstick/qp/pressure_bounds.h>

#include <vector>

namespace slipstick::qp
{
  /// The entries of nodes have no bounds in the box.
  template <typename Vector>
  struct ForceSet
  {
    Box<Vector>                box;
    std::vector<PressureBound> nodes; // discs without a normal entry: only the radius is used
  };

  namespace detail
  {
    /// Forces of a node in space in terms of the magnitude of the tangential force, whose direction c, s is fixed.
    class DiscPoint
    {
    public:
      template <typename Iterator>
      DiscPoint(const PressureBound &node_, const Iterator x)
        : node(node_)
        , size(std::hypot(x[node.tangential], x[node.second]))
        , normal(node.normal == no_entry ? 0. : x[node.normal])
      {
        c = size > 0 ? x[node.tangential] / size : 1.;
        s = size > 0 ? x[node.second] / size : 0.;
        projected(near_size, near_normal);
      }

      template <typename Iterator>
      void project(const Iterator x) const
      {
        x[node.tangential] = c * near_size;
        x[node.second]     = s * near_size;
        if (node.normal != no_entry)
          x[node.normal] = near_normal;
      }

      /// p := derivative of the projection, times p: transverse to the force, p is scaled by the ratio of the
      /// forces' lengths.
      template <typename Iterator>
      void multiply_derivative(const Iterator p) const
      {
        double along  = c * p[node.tangential] + s * p[node.second],
               across = c * p[node.second] - s * p[node.tangential], dn = node.normal == no_entry ? 0. : p[node.normal];
        across *= size > 0 ? near_size / size : 1.;
        if (node.normal == no_entry)
          along = size < node.forces.closed_radius(0) ? along : 0.;
        else
          node.forces.multiply_derivative(size, normal, along, dn);
        p[node.tangential] = c * along - s * across;
        p[node.second]     = s * along + c * across;
        if (node.normal != no_entry)
          p[node.normal] = dn;
      }

    private:
      void projected(double &t, double &n) const
      {
        t = size;
        n = normal;
        if (node.normal == no_entry)
          t = std::min(t, node.forces.closed_radius(0));
        else
          node.forces.project(t, n);
      }

      const PressureBound &node;
      const double         size, normal;
      double               c = 1, s = 0, near_size = 0, near_normal = 0;
    };
  } // namespace detail

  /// x := projection of x on the set.
  template <typename Vector>
  void project(const ForceSet<Vector> &set, Vector &x)
  {
    project(set.box, x);
    const auto xi = x.begin();
    for (const PressureBound &node : set.nodes)
      if (node.is_disc())
        detail::DiscPoint(node, xi).project(xi);
      else
        node.forces.project(xi[node.tangential], xi[node.normal]);
  }

  /// p := derivative of the projection at y, times p.
  template <typename Vector>
  void multiply_derivative(const ForceSet<Vector> &set, const Vector &y, Vector &p)
  {
    multiply_derivative(set.box, y, p);
    const auto yi = y.begin();
    const auto pi = p.begin();
    for (const PressureBound &node : set.nodes)
      if (node.is_disc())
        detail::DiscPoint(node, yi).multiply_derivative(pi);
      else
        node.forces.multiply_derivative(yi[node.tangential], yi[node.normal], pi[node.tangential], pi[node.normal]);
  }

  template <typename Vector>
  double n_contradictions(const ForceSet<Vector> &set)
  {
    return n_contradictions(set.box);
  }

  /// See box.h; a node is unbounded along the projection of r on the recession cone of its set.
  template <typename Vector, typename Reduction>
  bool is_farkas_certificate(const ForceSet<Vector> &set,
                             const Vector           &r,
                             const Vector           &x_e,
                             const double            radius,
                             const double            rounding,
                             const Reduction        &reduction)
  {
    std::array<double, 3> s  = detail::farkas_sums(set.box, r, x_e);
    const auto            ri = r.begin();
    for (const PressureBound &node : set.nodes)
      {
        const double t       = node.is_disc() ? std::hypot(ri[node.tangential], ri[node.second]) : ri[node.tangential];
        const double n       = node.normal == no_entry ? 0. : ri[node.normal];
        const auto   support = node.forces.support(t, n);
        s[0] -= support.value;
        s[1] += support.unbounded - (t * t + n * n); // farkas_sums() treated both entries as unbounded
        s[2] += std::abs(support.value);
      }
    s = reduction.sum(s);
    return s[0] > std::sqrt(std::max(0., s[1])) * radius + rounding * s[2];
  }
} // namespace slipstick::qp
