// A node shared by several subdomains, or subject to supports, foundations or contact.
#pragma once

#include <slipstick/mechanics/spaces.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

namespace slipstick::interface
{
  /// Tributary area and length of a node on the boundary of a pair: integrals of its shape function.
  struct Tributary
  {
    double area   = 0; // with thickness or circumference [mm^2]
    double length = 0; // [mm]

    Tributary &operator+=(const Tributary &other)
    {
      area += other.area;
      length += other.length;
      return *this;
    }

    bool operator<(const Tributary &other) const
    {
      return std::tie(area, length) < std::tie(other.area, other.length);
    }

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &area &length;
    }
  };

  /// One copy of a node, or (with several entries in `copies`) all its copies merged.
  template <int dim>
  struct InterfaceNode
  {
    /// A direction in which the displacement is prescribed.
    struct Held
    {
      std::array<double, dim> direction{}; // unit length
      double                  value = 0;   // [mm]
      unsigned int            which = 0;   // component, or dim + k for the k-th along a normal
      std::vector<unsigned int>
        by; // prescribed by: numbered as Side::condition, followed by contact pairs (bonds to obstacles), then the axis

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &direction &value &which &by;
      }
    };

    /// Contribution of one edge at the node to a support along the normal or to a foundation.
    struct Side
    {
      unsigned int            condition = 0; // index into Scene::supports, followed by Scene::foundations
      std::array<double, dim> normal{};      // outward
      double                  area = 0;      // tributary [mm^2]

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &condition &normal &area;
      }

      bool operator<(const Side &other) const
      {
        return std::tie(condition, normal, area) < std::tie(other.condition, other.normal, other.area);
      }
    };

    /// An elastic support of a node in one of its principal directions.
    struct Spring
    {
      dealii::Tensor<1, dim> direction;
      double                 stiffness = 0; // [N/mm], > 0
    };

    mechanics::NodeKey                                 key{{0, 0}};
    std::array<double, dim>                            position{};
    unsigned int                                       body = 0;
    std::vector<Held>                                  held;              // independent directions
    std::vector<std::pair<unsigned int, unsigned int>> copies;            // subdomain, node there; sorted
    std::vector<std::pair<unsigned int, Tributary>>    areas;             // by pair with an obstacle; sorted
    bool                                               is_paired = false; // occurs in the weights of a pair of bodies
    std::vector<Side>                                  sides;
    std::vector<Spring>                                springs; // made from the sides, at most dim

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &key &position &body &held &copies &areas &is_paired &sides;
    }

    dealii::Point<dim> point() const
    {
      dealii::Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = position[d];
      return x;
    }

    /// Whether an external force acts on it: from a support, a foundation or contact.
    bool is_acted_on() const
    {
      return !held.empty() || !areas.empty() || is_paired || !sides.empty();
    }

    /// The smallest displacement that takes the prescribed values [mm].
    dealii::Tensor<1, dim> held_displacement() const;

    /// The part of a displacement that supports do not prescribe.
    dealii::Tensor<1, dim> free_part(const dealii::Tensor<1, dim> &direction) const;
  };

  // A direction is held if its free part is shorter than this.
  constexpr double held_direction_tolerance = 1e-8;
} // namespace slipstick::interface
