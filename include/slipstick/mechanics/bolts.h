// Bolt pretension: initial strains that shorten a body across a section.
#pragma once

#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/subdomain_matrices.h>

#include <deal.II/base/mpi.h>

#include <Eigen/Dense>

#include <vector>

namespace slipstick::mechanics
{
  /// A bolt that is cut by a section and shortened by s is free of stress for u = -s h, where h is its direction at the
  /// nodes above the section and 0 at those below: the elastic part of u is u + s h, the load -s K h, and the tension
  /// across the section h'K (u + s h). The cut runs through the cells between the two groups of nodes, so that the mesh
  /// need not have edges along it; the discrete equilibrium is exactly that of two parts pulled together.
  template <int dim>
  class Bolts
  {
  public:
    /// @param matrices of this rank's subdomains. Collective.
    /// @throws InputError on all ranks for a section that does not cut its body.
    Bolts(const scene::Scene<dim> &scene, const std::vector<tfeti::SubdomainMatrices> &matrices, const MPI_Comm comm);

    bool empty() const
    {
      return bolts.empty();
    }

    /// Axial stiffness of every bolt under uniform strain [N/mm], and its length [mm].
    std::vector<double> stiffnesses() const;
    std::vector<double> lengths() const;

    /// Adds -s K h of all bolts. @param shortening s [mm]. @param loads of this rank's subdomains [N].
    void add_loads(const std::vector<double> &shortening, std::vector<Eigen::VectorXd> &loads) const;

    /// u + s h, the part of the displacement that strains the bodies.
    std::vector<Eigen::VectorXd> elastic_part(std::vector<Eigen::VectorXd> u,
                                              const std::vector<double>   &shortening) const;

    /// h'(K (u + s h) - f) of every bolt [N]. @param thermal load f of the thermal strain only, by subdomain; empty: 0.
    /// Collective.
    std::vector<double> tensions(const std::vector<Eigen::VectorXd> &u,
                                 const std::vector<double>          &shortening,
                                 const std::vector<Eigen::VectorXd> &thermal) const;

    /// Twice the strain energy of every body minus u'K u [N mm], from this rank's subdomains.
    std::vector<double> initial_strain_energies(const std::vector<Eigen::VectorXd> &u,
                                                const std::vector<double>          &shortening,
                                                const unsigned int                  n_bodies) const;

  private:
    struct Part
    {
      unsigned int    p; // subdomain of this rank
      Eigen::VectorXd h, Kh;
    };
    struct Bolt
    {
      unsigned int      body      = 0;
      double            stiffness = 0; // [N/mm]
      double            length    = 0; // [mm]
      std::vector<Part> parts;
    };

    MPI_Comm          comm;
    std::vector<Bolt> bolts;
  };
} // namespace slipstick::mechanics
