// Assembly of the rows of B from meshes, supports and contact pairs.
#pragma once

#include <slipstick/interface/body_contact.h>
#include <slipstick/tfeti/constraints.h>

#include <Eigen/Dense>

namespace slipstick::interface
{
  /// The rows of B, and the rows of contact nodes that were omitted because the gap is large.
  struct ContactRows
  {
    tfeti::Constraints  active;
    tfeti::Constraints  pruned; // rows, blocks, kind, c of the omitted normal rows
    tfeti::HeldContacts held;
  };

  /// As contact_constraints(), but without rows for contact nodes whose gap exceeds the smallest gap of their pair by
  /// more than both @p part of the length of its slave boundary and two mesh sizes; pairs whose law acts on open nodes
  /// keep all rows.
  /// @param contacts result of pair_bodies(), which depends on neither t nor part.
  template <int dim>
  ContactRows contact_rows(const scene::Scene<dim>      &scene,
                           const mesh::Mesh<dim>        &mesh,
                           const mechanics::Spaces<dim> &spaces,
                           const BodyContacts<dim>      &contacts,
                           const double                  t,
                           const double                  part);

  /// Largest penetration [mm] of the pruned nodes at the displacements @p u of this rank's subdomains; 0 for none.
  /// Collective.
  double largest_penetration(const tfeti::Constraints           &pruned,
                             const std::vector<Eigen::VectorXd> &u,
                             const MPI_Comm                      comm);

  /// Gluing, bonds, prescribed displacements (at load factor @p t), foundations and contact of the scene, distributed
  /// over the ranks. Copies of a node are matched on a rank determined by its key; the only global data, stored on
  /// every rank, are the outlines of bodies in contact with each other. Gluing rows are non-redundant chains over the
  /// copies; rows that share a node are owned by one rank. RowBuilder decides which rows a node has; mortar_rows() and
  /// contact_with() provide their coefficients. Collective.
  /// @throws InputError on all ranks when supports contradict each other, or the sides of a contact pair do not meet.
  template <int dim>
  tfeti::Constraints contact_constraints(const scene::Scene<dim>      &scene,
                                         const mesh::Mesh<dim>        &mesh,
                                         const mechanics::Spaces<dim> &spaces,
                                         const double                  t);
} // namespace slipstick::interface
