// Cells at contact pairs that are refined: masters with their slaves, and contacts that are not resolved.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/mesh/mesh.h>
#include <slipstick/scene/scene.h>

#include <map>
#include <string>
#include <vector>

namespace slipstick::app
{
  /// Adds the master cells to @p refinement whose faces in the contact zone are much longer than those of the slave
  /// will be. A slave that is finer than its master follows the edges of the master's faces: its nodal pressures
  /// alternate, which no estimate on that mesh contains (doc/decisions/0129). Only for pairs of two bodies of which
  /// pressures or tractions are goals. Collective.
  /// @param nodes of all ranks, on rank 0. @return number of cells added.
  template <int dim>
  std::size_t mark_coarse_masters(const scene::Scene<dim>                 &scene,
                                  const mesh::Mesh<dim>                   &mesh,
                                  const std::vector<contact::ContactNode> &nodes,
                                  const std::vector<std::string>          &goals,
                                  mesh::Refinement                        &refinement);

  /// Warnings for pairs whose slave is much stiffer than the master and finer: its nodes between two master nodes follow
  /// the master's edges, so that pressures and tractions alternate and their status is decided by the small strains of
  /// the stiff side, which takes the solver many steps. Keys are "finer" and the name of the pair. Collective.
  template <int dim>
  std::map<std::string, std::string> finer_slave_warnings(const scene::Scene<dim>  &scene,
                                                          const mesh::Mesh<dim>    &mesh,
                                                          const tfeti::Constraints &constraints);

  /// Adds the cells of both sides to @p refinement that have a face at a closed node of these pairs. Collective.
  /// @param nodes of all ranks, on rank 0. @return number of cells added.
  template <int dim>
  std::size_t mark_contact_zones(const scene::Scene<dim>                 &scene,
                                 const mesh::Mesh<dim>                   &mesh,
                                 const std::vector<contact::ContactNode> &nodes,
                                 const std::vector<unsigned int>         &pairs,
                                 mesh::Refinement                        &refinement);
} // namespace slipstick::app
