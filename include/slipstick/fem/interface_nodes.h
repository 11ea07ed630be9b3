// Nodes that several subdomains share, or that supports or contact act on.
#pragma once

#include <slipstick/fem/spaces.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

namespace slipstick::fem
{
  /// One copy of a node, or (with several entries in `copies`) all that is known of it.
  template <int dim>
  struct InterfaceNode
  {
    NodeKey                                            key{{0, 0}};
    std::array<double, dim>                            position{};
    unsigned int                                       body = 0;
    unsigned int                                       held = 0;     // bit c: component c is prescribed
    std::array<double, dim>                            prescribed{}; // [mm]
    std::vector<std::pair<unsigned int, unsigned int>> copies;       // subdomain, node there; sorted
    std::vector<std::pair<unsigned int, double>>       areas;        // contact pair, tributary area [mm^2]; sorted

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &key &position &body &held &prescribed &copies &areas;
    }

    dealii::Point<dim> point() const
    {
      dealii::Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = position[d];
      return x;
    }
  };

  /// The interface nodes that this rank owns (the rank of their first copy), complete, sorted by key. Nodes with one
  /// copy that nothing acts on are left out. Collective.
  /// @throws InputError on all ranks when two supports prescribe different values for one component of a node.
  template <int dim>
  std::vector<InterfaceNode<dim>> interface_nodes(const scene::Scene<dim> &scene,
                                                  const Mesh<dim>         &mesh,
                                                  const Spaces<dim>       &spaces,
                                                  const double             t);
} // namespace slipstick::fem
