// Recovery of stresses on a subdomain of elements of degree 1.
#pragma once

#include <slipstick/mechanics/patch_sums.h>

#include <unordered_map>

namespace slipstick::mechanics
{
  /// Superconvergent patch recovery (Zienkiewicz, Zhu 1992): around every vertex a linear function is fitted to the
  /// stresses at the points of Element::stress of the adjacent cells.
  ///
  /// The cells of a vertex on the boundary of the body do not determine the slope towards it. Its slope is therefore
  /// the mean slope of those vertices of its cells that are on the fewest sides of the body, if fewer than the vertex
  /// itself: vertices inside are on no side; in a plate of one layer of cells, those on a face are on one, those at its
  /// edges on two. The mean over the vertex's own cells is kept, except on triangles and tetrahedra, where only means
  /// over whole patches are superconvergent: there the mean of the functions of these vertices is used. Other slopes
  /// that the points do not determine are zero.
  template <int dim>
  class LinearPatches
  {
  public:
    /// @p n_components of the stress. @p shared as for PatchSums.
    LinearPatches(const dealii::DoFHandler<dim>   &dof_handler,
                  const Element<dim>              &element,
                  const unsigned int               n_components,
                  const std::vector<unsigned int> &shared);

    /// First step: fits the functions around all vertices; complete after sums.finish().
    void start_fit(const StressSamples<dim> &samples);

    /// Next steps, for @p sides from 0 to dim - 1: vertices on more sides take the functions of those on this number of
    /// sides, unless they have already taken some.
    void start_taking(const unsigned int sides);

    /// Recovered stresses, nodes x components.
    Eigen::MatrixXd nodal() const;

    PatchSums<dim> sums;

  private:
    using Vector = Eigen::Matrix<double, dim, 1>;
    using Slopes = Eigen::Matrix<double, dim, Eigen::Dynamic, 0, dim, 2 * dim>;

    Slopes slopes_of(const unsigned int vertex) const;
    void   set_slopes(const unsigned int vertex, const Slopes &slopes);

    const dealii::DoFHandler<dim> &dof_handler;
    const Element<dim>            &element;
    const unsigned int             n_components;

    // by vertex
    typename PatchSums<dim>::Sums values,
      slopes;                           // vertices x components; vertices x (dim x components), column by column
    std::vector<unsigned char> n_sides; // of the body at the vertex
    std::vector<bool>          has_simplices, has_taken;

    std::unordered_map<unsigned int, Vector> mean_place; // of the points around vertices on the boundary
  };
} // namespace slipstick::mechanics
