// One struct per kind of subsection of the .prm: it declares the parameters, then reads those that refer to other
// names. Its members are bound to the ParameterHandler by reference, so it must not be moved or destroyed before the
// last value is set.
#pragma once

#include <slipstick/scene/parameters.h>
#include <slipstick/scene/scene.h>

#include <deal.II/base/parameter_handler.h>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// Names of the boundaries of @p shape; none for a mesh, whose file defines them.
  std::vector<std::string> boundary_names(const Shape shape, const unsigned int dim);

  /// The body and boundary given by the parameter @p path, "BODY/BOUNDARY". `*` is the whole outline; for a body from a
  /// mesh file every name is accepted here and checked when the mesh is made.
  /// @throws InputError for an unknown body or boundary.
  template <int dim>
  BoundaryName read_boundary(const std::string            &text,
                             const std::string            &path,
                             const Parameters             &parameters,
                             const std::vector<Body<dim>> &bodies);

  /// The body given by the parameter @p path. @throws InputError if it is unknown.
  template <int dim>
  unsigned int read_body(const std::string            &text,
                         const std::string            &path,
                         const Parameters             &parameters,
                         const std::vector<Body<dim>> &bodies);

  /// The bodies given by the parameter @p path: `all`, or names separated by commas.
  /// @throws InputError if there is none, one is unknown or named twice.
  template <int dim>
  std::vector<unsigned int> read_bodies(const std::string            &text,
                                        const std::string            &path,
                                        const Parameters             &parameters,
                                        const std::vector<Body<dim>> &bodies);

  /// The point @p of of body number @p body, given by the parameter @p path: coordinates, or for a body from a mesh
  /// file a name (checked when the mesh is made). @throws InputError if it is neither.
  template <int dim>
  PointName<dim> read_point(const std::string &text,
                            const std::string &path,
                            const Parameters  &parameters,
                            const unsigned int body,
                            const Body<dim>   &of);

  /// Every read() returns the checked value and throws InputError for faults in its own section; names are looked up in
  /// the part of the scene that has been read already.
  struct MaterialSection
  {
    explicit MaterialSection(const std::string &name);

    std::string name;
    std::string library = "none";
    Material    material;

    void     declare(dealii::ParameterHandler &prm);
    Material read() const;
  };

  template <int dim>
  struct BodySection
  {
    explicit BodySection(const std::string &name);

    enum class Mirror
    {
      none,
      x,
      y
    };

    std::string name;
    std::string material;
    std::string refined_boundaries; // separated by commas
    Mirror      mirror = Mirror::none;
    Body<dim>   body;

    dealii::Point<dim> rotation_axis; // in space

    void declare(dealii::ParameterHandler &prm);

    /// Also locates the mesh file, relative to the directory of the .prm or the working directory.
    Body<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;

  private:
    void declare_geometry(dealii::ParameterHandler &prm);
    void declare_file(dealii::ParameterHandler &prm);
    void declare_refinement(dealii::ParameterHandler &prm);
    void check_parameters_fit(const Parameters &parameters) const;

    std::map<std::string, std::string> defaults; // text of every parameter that is not set
  };

  template <int dim>
  struct ObstacleSection
  {
    explicit ObstacleSection(const std::string &name);

    std::string        name;
    Obstacle<dim>      obstacle;
    dealii::Point<dim> point;  // of a half plane
    dealii::Point<dim> normal; // as given
    dealii::Point<dim> axis;   // of a cylinder, as given
    std::string        points;
    std::string        height;
    std::string        file;          // of an stl
    double             scale = 1;     // of it
    Placement<dim>     placement;     // of it
    dealii::Point<dim> rotation_axis; // as given

    void          declare(dealii::ParameterHandler &prm);
    Obstacle<dim> read(const Parameters &parameters) const;

  private:
    void declare_geometry(dealii::ParameterHandler &prm);
    void declare_placement(dealii::ParameterHandler &prm);
    void read_surface(const Parameters &parameters, Obstacle<dim> &result) const;

    std::map<std::string, std::string> defaults; // text of every parameter that is not set
  };

  template <int dim>
  struct SupportSection
  {
    explicit SupportSection(const std::string &name);

    std::string                  name;
    std::string                  boundary;
    std::string                  body;
    std::string                  point;
    std::array<std::string, dim> components;
    std::string                  normal = "free";

    void                        declare(dealii::ParameterHandler &prm);
    PrescribedDisplacement<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;

  private:
    void read_place(const Parameters &parameters, const Scene<dim> &scene, PrescribedDisplacement<dim> &support) const;
  };

  template <int dim>
  struct FoundationSection
  {
    explicit FoundationSection(const std::string &name);

    std::string     name;
    std::string     boundary;
    Foundation<dim> foundation;

    void            declare(dealii::ParameterHandler &prm);
    Foundation<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;
  };

  template <int dim>
  struct TractionSection
  {
    explicit TractionSection(const std::string &name);

    std::string                  name;
    std::string                  boundary;
    std::array<std::string, dim> components;
    std::string                  pressure = "0";

    void          declare(dealii::ParameterHandler &prm);
    Traction<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;
  };

  template <int dim>
  struct BodyForceSection
  {
    explicit BodyForceSection(const std::string &name);

    std::string                  name;
    std::string                  bodies = "all";
    std::array<std::string, dim> force;
    std::array<std::string, dim> acceleration;
    std::string                  angular_velocity = "0";
    dealii::Point<dim>           axis;
    dealii::Point<dim>           axis_direction; // in space

    void           declare(dealii::ParameterHandler &prm);
    BodyForce<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;
  };

  template <int dim>
  struct PointLoadSection
  {
    explicit PointLoadSection(const std::string &name);

    std::string                  name;
    std::string                  body;
    std::string                  point;
    std::array<std::string, dim> force;

    void           declare(dealii::ParameterHandler &prm);
    PointLoad<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;
  };

  template <int dim>
  struct ProbeSection
  {
    explicit ProbeSection(const std::string &name);

    std::string  name;
    std::string  body;
    std::string  point;
    std::string  from, to;
    unsigned int n_points = Probe<dim>().n_points;

    void       declare(dealii::ParameterHandler &prm);
    Probe<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;
  };

  template <int dim>
  struct TemperatureSection
  {
    explicit TemperatureSection(const std::string &name);

    std::string name;
    std::string bodies = "all";
    std::string change = "0";

    void             declare(dealii::ParameterHandler &prm);
    Temperature<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;
  };

  template <int dim>
  struct PretensionSection
  {
    explicit PretensionSection(const std::string &name);

    std::string        name;
    std::string        body;
    dealii::Point<dim> point, direction;
    std::string        force = "0";
    std::string        until = "auto";

    void            declare(dealii::ParameterHandler &prm);
    Pretension<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;
  };

  /// Contact law and offset, for a contact pair and for the pairs found by the search.
  template <int dim>
  struct ContactLawSection
  {
    std::string                        law = "frictionless";
    std::map<std::string, std::string> numbers; // of all laws, by parameter
    bool                               only_closed = false;
    std::string                        offset      = "0";

    /// Declares the parameters in the subsection that is open.
    void declare(dealii::ParameterHandler &prm);

    /// Sets law and offset of @p pair. @p section: path of the subsection.
    void read(const Parameters &parameters, const std::string &section, ContactPair<dim> &pair) const;

    /// Warnings about parameters that are set but belong to other laws. None where --set changes the law of a file.
    std::vector<std::string> without_effect(const Parameters &parameters, const std::string &section) const;
  };

  template <int dim>
  struct ContactSection
  {
    explicit ContactSection(const std::string &name);

    std::string            name;
    std::string            slave;
    std::string            master;
    ContactLawSection<dim> law;
    std::string            gap            = "geometry";
    std::string            reach          = "auto";
    ContactDiscretization  discretization = ContactDiscretization::automatic;

    void             declare(dealii::ParameterHandler &prm);
    ContactPair<dim> read(const Parameters &parameters, const Scene<dim> &scene) const;

  private:
    void read_master(const Parameters &parameters, const Scene<dim> &scene, ContactPair<dim> &pair) const;
  };

  template <int dim>
  struct ContactSearchSection
  {
    bool                   automatic = false;
    double                 reach     = 0;
    ContactLawSection<dim> law;

    void               declare(dealii::ParameterHandler &prm);
    ContactSearch<dim> read(const Parameters &parameters) const;
  };

  // Topics without named subsections; each declares its own subsection.
  void declare(dealii::ParameterHandler &prm, Decomposition &decomposition);
  void declare(dealii::ParameterHandler &prm, Discretization &discretization);
  void declare(dealii::ParameterHandler &prm, SolverOptions &solver);
  void declare(dealii::ParameterHandler &prm, FrictionOptions &friction);
  void declare(dealii::ParameterHandler &prm, OutputOptions &output);
  void declare_load_steps(dealii::ParameterHandler &prm, std::vector<double> &factors);
} // namespace slipstick::scene
