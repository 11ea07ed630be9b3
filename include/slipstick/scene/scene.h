// The scene: what the .prm describes, checked and ready to use. Units: N, mm, MPa (any consistent set works).
#pragma once

#include <slipstick/qp/options.h>
#include <slipstick/scene/field.h>
#include <slipstick/scene/list_format.h>
#include <slipstick/tfeti/options.h>

#include <deal.II/base/point.h>

#include <array>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace slipstick::scene
{
  enum class PlaneState
  {
    plane_stress,
    plane_strain
  };

  /// Isotropic linear elasticity.
  struct Material
  {
    std::string name;
    double      young_modulus = 2.1e5; // [MPa], > 0
    double      poisson_ratio = 0.3;   // [-], -1 < nu < 0.5
  };

  enum class Shape
  {
    rectangle
  };

  /// One elastic body of a built-in shape. Its boundaries are named left, right, bottom, top.
  template <int dim>
  struct Body
  {
    std::string                                  name;
    Shape                                        shape = Shape::rectangle;
    dealii::Point<dim>                           origin;        // lower left corner [mm]
    dealii::Point<dim>                           size;          // edge lengths [mm], > 0
    std::optional<std::array<unsigned int, dim>> cells;         // empty: blocks x cells per block of `Decomposition`
    unsigned int                                 material  = 0; // index into Scene::materials
    double                                       thickness = 1; // [mm], > 0
  };

  /// A boundary of a body, written BODY/BOUNDARY in the .prm.
  struct BoundaryName
  {
    unsigned int body = 0; // index into Scene::bodies
    std::string  boundary;
  };

  /// Prescribed displacement, by component; a component that is not set is free.
  template <int dim>
  struct PrescribedDisplacement
  {
    std::string                                name;
    BoundaryName                               where;
    std::array<std::optional<Field<dim>>, dim> components; // [mm]
  };

  /// Traction in the axes of the scene, force per undeformed area.
  template <int dim>
  struct Traction
  {
    std::string                 name;
    BoundaryName                where;
    std::array<Field<dim>, dim> components; // [MPa]
  };

  enum class ObstacleShape
  {
    circle
  };

  /// A rigid obstacle that needs no mesh.
  template <int dim>
  struct Obstacle
  {
    std::string        name;
    ObstacleShape      shape = ObstacleShape::circle;
    dealii::Point<dim> center;     // [mm]
    double             radius = 1; // [mm], > 0; bodies are outside
  };

  enum class ContactLaw
  {
    frictionless,
    tresca
  };

  /// Contact of a slave boundary with a rigid obstacle. The slip bound acts on the whole declared boundary, open
  /// nodes included (as in the paper).
  template <int dim>
  struct ContactPair
  {
    std::string  name;
    BoundaryName slave;
    unsigned int obstacle = 0; // index into Scene::obstacles
    ContactLaw   law      = ContactLaw::frictionless;
    Field<dim>   slip_bound; // [MPa], >= 0; Tresca only
  };

  enum class DecompositionMethod
  {
    blocks,
    metis,
    none
  };

  struct Decomposition
  {
    DecompositionMethod method          = DecompositionMethod::blocks;
    unsigned int        blocks          = 4;  // N: N x N blocks of every rectangle, >= 1
    unsigned int        cells_per_block = 50; // per direction, >= 1
    unsigned int        subdomains      = 0;  // METIS: over all bodies; 0 = auto
  };

  struct Discretization
  {
    unsigned int degree      = 1; // of the elements, 1 or 2
    unsigned int refinements = 0; // extra uniform refinements
  };

  enum class Algorithm
  {
    automatic,
    smalbe,
    semismooth_newton,
    pcg
  };

  struct SolverOptions
  {
    Algorithm          algorithm = Algorithm::automatic;
    double             tolerance = 1e-4; // relative, of |gP| and |G x| to |P d|; the paper's eps
    qp::SmalbeOptions  smalbe;
    qp::NewtonOptions  newton;
    qp::PcpgOptions    pcpg;
    tfeti::DualOptions dual;
  };

  struct OutputOptions
  {
    bool vtu = true; // fields for ParaView
  };

  template <int dim>
  struct Scene
  {
    std::string                              name;  // file name of the .prm without ending
    std::string                              title; // one line for people
    PlaneState                               plane_state = PlaneState::plane_stress;
    std::vector<Material>                    materials;
    std::vector<Body<dim>>                   bodies;
    std::vector<PrescribedDisplacement<dim>> supports;
    std::vector<Traction<dim>>               tractions;
    std::vector<Obstacle<dim>>               obstacles;
    std::vector<ContactPair<dim>>            contacts;
    Decomposition                            decomposition;
    Discretization                           discretization;
    SolverOptions                            solver;
    OutputOptions                            output;
    std::string                              parameters; // the complete .prm as understood

    bool has_contact() const
    {
      return !contacts.empty();
    }
  };

  /// Reads and checks the scene that @p file describes, with @p overrides "Section/Sub/Name=value". Prints nothing,
  /// knows no MPI: every rank reads and comes to the same scene or error.
  /// @throws InputError for whatever is wrong with it.
  Scene<2> read_scene(const std::string &file, const std::vector<std::string> &overrides = {});

  /// Writes every parameter with default, unit, range and meaning, one named subsection of each kind as example. As
  /// prm it is a scene that runs.
  void list_parameters(std::ostream &out, const ListFormat format);
} // namespace slipstick::scene
