// The scene: the contents of the .prm, checked and ready to use. Units: N, mm, MPa (any consistent set works).
#pragma once

#include <slipstick/qp/options.h>
#include <slipstick/scene/contact_law.h>
#include <slipstick/tfeti/options.h>

#include <deal.II/base/point.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slipstick::scene
{
  class TriangulatedSurface;

  /// What a plane section represents.
  enum class PlaneState
  {
    plane_stress,
    plane_strain,
    axisymmetric // half a section of a body of revolution: x is the radius, y the axis
  };

  /// Isotropic linear elasticity.
  struct Material
  {
    std::string name;
    double      young_modulus = 2.1e5; // [MPa], > 0
    double      poisson_ratio = 0.3;   // [-], -1 < nu < 0.5
    double      density       = 0;     // [t/mm^3], >= 0
    double      expansion     = 0;     // coefficient of thermal expansion [1/K]
  };

  enum class Shape
  {
    rectangle,    // left, right, bottom, top; in space a cuboid, also back and front (z)
    disc,         // arc
    half_disc,    // arc, flat; the half below its centre, flat side up
    quarter_disc, // arc, flat, side; the quarter below and to the right of its centre
    ring,         // inner, outer
    quarter_ring, // inner, outer, start (on the x axis), end (on the y axis)
    ball,         // in space: surface
    half_ball,    // in space: surface, flat; the half below its centre, flat side up
    cylinder,     // in space, along z: side, back, front
    tube,         // in space, along z: inner, outer, back, front
    mesh          // from a file; boundaries by the physical names there
  };

  /// Position of a body: first mirrored at an axis of its own coordinates, then rotated about their origin, then moved.
  template <int dim>
  struct Placement
  {
    bool                 mirror_x = false; // x -> -x
    bool                 mirror_y = false; // y -> -y
    double               rotation = 0;     // [degrees], counterclockwise; in space about ...
    dealii::Tensor<1, 3> axis;             // ... this axis (none: z), as seen against it
    dealii::Point<dim>   translation;      // [mm]

    /// The mapping of a point to its new position.
    std::function<void(dealii::Point<dim> &)> motion() const;
  };

  /// One elastic body, of a built-in shape or from a mesh file.
  template <int dim>
  struct Body
  {
    std::string                                  name;
    Shape                                        shape = Shape::rectangle;
    dealii::Point<dim>                           origin;            // rectangle: lower left (and front) corner [mm]
    dealii::Point<dim>                           size;              // rectangle: edge lengths [mm], > 0
    dealii::Point<dim>                           center;            // discs and rings [mm]
    double                                       radius       = 1;  // discs and rings: outer radius [mm], > 0
    double                                       inner_radius = .5; // rings [mm], 0 < inner < outer
    double                                       length       = 1;  // cylinder, tube: along z from the centre [mm], > 0
    std::optional<std::array<unsigned int, dim>> cells;             // rectangle: empty: blocks x cells per block of
                                                                    // `Decomposition`; rings: around, across
    unsigned int             cells_along_arc  = 32;                 // discs: edges on the arc; solids: around
    unsigned int             cells_along_axis = 0;                  // cylinder, tube; 0: cells are approximately cubes
    std::string              file;                                  // mesh: path as found
    std::string              part;                                  // mesh: physical name of the body; empty: all cells
    double                   scale              = 1;                // mesh: factor on coordinates, > 0 (1000: m to mm)
    bool                     has_smooth_outline = true; // edges represent arcs, curves through mid nodes, splines
    double                   corner_angle       = 35;   // mesh: edges at larger angles make corners [degrees], > 0
    Placement<dim>           placement;
    unsigned int             refinements = 0;          // uniform, on top of Discretization/Refinements
    std::vector<std::string> refined_boundaries;       // cells at these boundaries are refined further ...
    unsigned int             boundary_refinements = 0; // ... this many times
    unsigned int             material             = 0; // index into Scene::materials
    double                   thickness            = 1; // [mm], > 0; 1 for bodies of revolution
  };

  /// A boundary of a body, BODY/BOUNDARY in the .prm. For a body from a mesh file the name is checked when the mesh is
  /// read. `*` is the whole outline of the body.
  struct BoundaryName
  {
    unsigned int body = 0; // index into Scene::bodies
    std::string  boundary;
  };

  /// A point of a body: the mesh node nearest to coordinates, or a named point of the mesh file.
  template <int dim>
  struct PointName
  {
    unsigned int                      body = 0;    // index into Scene::bodies
    std::string                       point;       // physical name in the mesh file; empty: by coordinates
    std::optional<dealii::Point<dim>> coordinates; // [mm]; a node must lie within half a cell of it
  };

  /// Prescribed displacement of a boundary or a point, by component or along the outward normal; components not set are
  /// free.
  template <int dim>
  struct PrescribedDisplacement
  {
    std::string                                name;
    BoundaryName                               where;
    std::optional<PointName<dim>>              point;      // instead of the boundary
    std::array<std::optional<Field<dim>>, dim> components; // [mm]
    std::optional<Field<dim>>                  normal;     // outwards [mm]; boundaries only, then no components; 0 is a
                                                           // roller or a plane of symmetry

    /// The displacement of component @p which, or from dim on along the normal.
    const std::optional<Field<dim>> &displacement(const unsigned int which) const
    {
      return which < dim ? components[which] : normal;
    }
  };

  /// Elastic foundation: springs between a boundary and the ground, force per area and displacement.
  template <int dim>
  struct Foundation
  {
    std::string  name;
    BoundaryName where;
    double       normal_stiffness     = 0; // [MPa/mm], >= 0
    double       tangential_stiffness = 0; // [MPa/mm], >= 0
  };

  /// Traction in the axes of the scene plus pressure, force per undeformed area.
  template <int dim>
  struct Traction
  {
    std::string                 name;
    BoundaryName                where;
    std::array<Field<dim>, dim> components; // [MPa]
    Field<dim>                  pressure;   // [MPa], positive presses on the body
  };

  /// Force per volume on bodies: given directly, density times acceleration, and centrifugal force.
  template <int dim>
  struct BodyForce
  {
    std::string                 name;
    std::vector<unsigned int>   bodies;           // indices into Scene::bodies
    std::array<Field<dim>, dim> force;            // [N/mm^3]
    std::array<Field<dim>, dim> acceleration;     // [mm/s^2]; gravity is 0, -9810
    Field<dim>                  angular_velocity; // [1/s], about `axis`; axisymmetric: about the axis of revolution
    dealii::Point<dim>          axis;             // [mm], a point of it
    dealii::Tensor<1, dim>      axis_direction;   // in space; none: z
  };

  template <int dim>
  struct PointLoad
  {
    std::string                 name;
    PointName<dim>              where;
    std::array<Field<dim>, dim> force; // [N]
  };

  /// Change of temperature relative to the stress-free state.
  template <int dim>
  struct Temperature
  {
    std::string               name;
    std::vector<unsigned int> bodies; // indices into Scene::bodies
    Field<dim>                change; // [K]
  };

  /// A pretensioned bolt: the two parts of its body on both sides of the section through `point`, normal to
  /// `direction`, are pulled together until the bolt carries the force; afterwards its shortening is kept.
  template <int dim>
  struct Pretension
  {
    std::string            name;
    unsigned int           body = 0;            // index into Scene::bodies
    dealii::Point<dim>     point;               // [mm]
    dealii::Tensor<1, dim> direction;           // unit length: the axis of the bolt
    Field<dim>             force;               // [N], >= 0: tension; if 0 the length is kept
    double                 tightened_until = 1; // last load factor at which the force is prescribed
  };

  enum class ObstacleShape
  {
    circle,     // bodies are outside; in space a ball
    hole,       // circle with the bodies inside; in space a ball
    half_plane, // through `center`; bodies are on the side of `normal`; in space a half space
    cylinder,   // only in space: about the line through `center` along `normal`; bodies are outside
    bore,       // the same with the bodies inside
    polyline,   // bodies are to the left of the direction of travel
    function,   // bodies are above y = height(x), in space y = height(x, z)
    stl         // only in space: a closed surface from a file; bodies are on the side of its normals
  };

  /// A rigid obstacle without a mesh.
  template <int dim>
  struct Obstacle
  {
    std::string                     name;
    ObstacleShape                   shape = ObstacleShape::circle;
    dealii::Point<dim>              center;     // circle, hole; a point of the half plane [mm]
    double                          radius = 1; // circle, hole, cylinder [mm], > 0
    dealii::Tensor<1, dim>          normal;     // unit length; half plane: towards the bodies; cylinder: its axis
    std::vector<dealii::Point<dim>> points;     // polyline, at least two [mm]
    Field<dim>                      height;     // function [mm], of x (and z) and t
    double                          extent = 1; // function: size of the bodies that may touch it [mm], see obstacle.cc
    std::string                     file;       // stl: path as found

    /// stl: in its position; shared by copies
    std::shared_ptr<const TriangulatedSurface> surface;
  };

  /// A point or a straight line of a body where displacement and stress are reported.
  template <int dim>
  struct Probe
  {
    std::string                 name;
    unsigned int                body = 0;       // index into Scene::bodies
    std::vector<PointName<dim>> ends;           // one: a point
    unsigned int                n_points = 101; // on a line
  };

  enum class ContactDiscretization
  {
    automatic, // node to node if the meshes match, otherwise mortar
    node_to_node,
    mortar
  };

  /// Contact of a slave boundary with a rigid obstacle or the boundary of another body.
  template <int dim>
  struct ContactPair
  {
    std::string                 name;
    BoundaryName                slave;
    std::optional<BoundaryName> master;       // empty: the obstacle
    unsigned int                obstacle = 0; // index into Scene::obstacles
    ContactLaw<dim>             law;
    Field<dim>                  offset; // added to the geometric gap [mm]; negative: press fit
    std::optional<Field<dim>>   gap;    // [mm] replaces the geometric gap
    std::optional<double>       reach;  // [mm]: no contact at larger distances; empty: from the meshes
    ContactDiscretization       discretization = ContactDiscretization::automatic;
  };

  /// Contact pairs found among the declared bodies.
  template <int dim>
  struct ContactSearch
  {
    bool             automatic = false;
    double           reach     = 0; // boundaries closer than this make a pair [mm], >= 0
    ContactPair<dim> pair;          // law, bounds, offset and other properties of the pairs found
  };

  /// Fixed-point iteration of the slip bounds of laws that act on closed contact only.
  struct FrictionOptions
  {
    double       tolerance      = 1e-6; // relative change of the slip bounds
    unsigned int max_iterations = 100;
  };

  enum class DecompositionMethod
  {
    automatic, // blocks if all bodies are rectangles with Cells = auto, else METIS
    blocks,
    metis,
    none
  };

  struct Decomposition
  {
    DecompositionMethod method          = DecompositionMethod::blocks;
    unsigned int        blocks          = 4;  // N: N x N blocks of every rectangle, >= 1
    unsigned int        cells_per_block = 50; // per direction, >= 1
    unsigned int        subdomains      = 0;  // METIS: for all bodies together; 0 = auto
    unsigned int        seed            = 0;  // METIS: for its random numbers
  };

  enum class ElementKind
  {
    standard,
    nearly_incompressible // dilatation projected on polynomials of one degree less, to avoid locking
  };

  struct Discretization
  {
    unsigned int degree      = 1; // of the elements, 1 or 2
    ElementKind  element     = ElementKind::standard;
    unsigned int refinements = 0; // extra uniform refinements
  };

  /// Presets of the individual accuracy parameters, see source/scene/accuracy.cc.
  enum class Accuracy
  {
    draft,
    engineering,
    reference
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
    Algorithm          algorithm                     = Algorithm::automatic;
    double             tolerance                     = 1e-4;  // relative, of |gP| and |G x| to |P d|; the paper's eps
    bool               stops_at_discretization_error = false; // Tolerance = auto; `tolerance` is then the lower limit
    qp::SmalbeOptions  smalbe;
    qp::NewtonOptions  newton;
    qp::PcpgOptions    pcpg;
    tfeti::DualOptions dual;
    bool               prune_contact = true; // distant contact nodes get no multipliers unless they would penetrate
  };

  struct OutputOptions
  {
    bool vtu = true; // fields for ParaView
  };

  template <int dim>
  struct Scene
  {
    std::string                              name;  // file name of the .prm without ending
    std::string                              title; // one line, for readers
    PlaneState                               plane_state = PlaneState::plane_stress;
    Accuracy                                 accuracy    = Accuracy::engineering;
    std::vector<Material>                    materials;
    std::vector<Body<dim>>                   bodies;
    std::vector<PrescribedDisplacement<dim>> supports;
    std::vector<Foundation<dim>>             foundations;
    std::vector<Traction<dim>>               tractions;
    std::vector<BodyForce<dim>>              body_forces;
    std::vector<PointLoad<dim>>              point_loads;
    std::vector<Temperature<dim>>            temperatures;
    std::vector<Pretension<dim>>             pretensions;
    std::vector<Obstacle<dim>>               obstacles;
    std::vector<ContactPair<dim>>            contacts;
    ContactSearch<dim>                       contact_search;
    std::vector<Probe<dim>>                  probes;
    FrictionOptions                          friction;
    std::vector<double>                      load_factors{1}; // t of the load steps
    Decomposition                            decomposition;
    Discretization                           discretization;
    SolverOptions                            solver;
    OutputOptions                            output;
    std::string                              parameters; // the complete .prm as interpreted
    std::vector<std::string>                 warnings;   // about the .prm

    bool has_contact() const
    {
      return !contacts.empty() || contact_search.automatic;
    }
  };
} // namespace slipstick::scene
