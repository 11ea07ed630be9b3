#include <slipstick/base/text.h>
#include <slipstick/scene/boundary_part.h>
#include <slipstick/scene/checks.h>

#include <map>
#include <utility>

namespace slipstick::scene
{
  namespace
  {
    using Boundary = std::pair<unsigned int, std::string>;

    Boundary boundary_of(const BoundaryName &name)
    {
      return {name.body, name.boundary};
    }

    template <int dim>
    void check_bodies_held(const Scene<dim> &scene, const Parameters &parameters)
    {
      if (scene.bodies.empty())
        throw InputError(parameters.locate("Bodies") + " declares no body",
                         "declare one, for example: set Bodies = box, and describe it in a subsection Body box");
      for (unsigned int body = 0; body < scene.bodies.size(); ++body)
        {
          bool held = scene.contact_search.automatic;
          for (const auto &support : scene.supports)
            held = held || support.where.body == body;
          for (const auto &foundation : scene.foundations)
            held = held || foundation.where.body == body;
          for (const auto &contact : scene.contacts)
            held = held || contact.slave.body == body || (contact.master && contact.master->body == body);
          if (!held)
            throw InputError(
              parameters.locate("Body " + scene.bodies[body].name) + ": nothing holds body '" +
                scene.bodies[body].name + "'",
              "add a support, a foundation or a contact pair on one of its boundaries (lists Supports, Foundations, Contacts)");
        }
    }

    template <int dim>
    void check_boundaries_used_once(const Scene<dim> &scene, const Parameters &parameters)
    {
      // for two bodies the pair is the same whichever side is the slave
      std::map<std::pair<Boundary, Boundary>, std::string> contacts;
      for (const auto &contact : scene.contacts)
        {
          const Boundary slave       = boundary_of(contact.slave);
          const Boundary other       = contact.master ? boundary_of(*contact.master)
                                                      : Boundary(scene.bodies.size(), scene.obstacles[contact.obstacle].name);
          const auto [first, is_new] = contacts.emplace(std::minmax(slave, other), contact.name);
          if (!is_new)
            throw parameters.error("Contact " + contact.name + "/Slave",
                                   "Contact " + first->second + " joins the same two sides",
                                   "keep one of the two, or choose another boundary");
        }

      std::map<std::pair<Boundary, unsigned int>, std::string> supports;
      for (const auto &support : scene.supports)
        for (unsigned int d = 0; d < dim; ++d)
          if (support.components[d] && !support.point)
            {
              const auto [first, is_new] =
                supports.emplace(std::make_pair(boundary_of(support.where), d), support.name);
              if (!is_new)
                throw parameters.error("Support " + support.name + "/Boundary",
                                       std::string("Support ") + first->second + " prescribes the displacement along " +
                                         "xyz"[d] + " there already",
                                       "set one of the two to free, or choose another boundary");
            }
    }

    template <int dim>
    void check_decomposition(const Scene<dim> &scene, const Parameters &parameters)
    {
      if (scene.decomposition.method != DecompositionMethod::blocks)
        return;
      const unsigned int blocks = scene.decomposition.blocks;
      for (const auto &[user, where] : used_boundaries(scene))
        if (!part_of_boundary(where.boundary).condition.empty())
          throw parameters.error("Decomposition/Method",
                                 "does not support parts of boundaries, but " + user + " has one, '" + where.boundary +
                                   "'",
                                 "set it to METIS or auto");
      for (const Body<dim> &body : scene.bodies)
        {
          if (body.shape != Shape::rectangle)
            throw parameters.error("Decomposition/Method",
                                   "cuts rectangles only, but body '" + body.name + "' is not one",
                                   "set it to METIS or auto");
          if (body.boundary_refinements > 0 && !body.refined_boundaries.empty())
            throw parameters.error("Decomposition/Method",
                                   "cuts equal cells only, and Body " + body.name + " is refined towards a boundary",
                                   "set it to METIS or auto");
        }
      for (const Body<dim> &body : scene.bodies)
        if (body.cells)
          for (const unsigned int n : *body.cells)
            if (n % blocks != 0)
              throw parameters.error("Body " + body.name + "/Cells",
                                     std::to_string(n) +
                                       " cells cannot be divided by Decomposition/Blocks = " + std::to_string(blocks),
                                     "give a multiple of " + std::to_string(blocks) + ", or set Cells = auto");
    }

    template <int dim>
    void check_algorithm(const Scene<dim> &scene, const Parameters &parameters)
    {
      const Algorithm algorithm = scene.solver.algorithm;
      if (algorithm == Algorithm::pcg && scene.has_contact())
        throw parameters.error("Solver/Algorithm",
                               "solves linear scenes only, but this one has contact",
                               "set it to auto");
      if ((algorithm == Algorithm::smalbe || algorithm == Algorithm::semismooth_newton) && !scene.has_contact())
        throw parameters.error("Solver/Algorithm", "needs contact, but this scene has none", "set it to auto");
      const auto preconditioner = scene.solver.dual.preconditioner;
      if (algorithm == Algorithm::smalbe && preconditioner != tfeti::Preconditioner::automatic &&
          preconditioner != tfeti::Preconditioner::none)
        throw parameters.error("Solver/Preconditioner",
                               "would change the bounds that SMALBE works with",
                               "set it to auto, or Solver/Algorithm to semismooth newton");
    }

    // Poisson's ratio above which standard elements in plane strain or axisymmetry are much too stiff (ratio of bulk to
    // shear modulus: 100).
    constexpr double locking_poisson_ratio = 0.495;

    template <int dim>
    void check_element(const Scene<dim> &scene, const Parameters &parameters)
    {
      if (scene.discretization.element == ElementKind::nearly_incompressible &&
          scene.plane_state == PlaneState::plane_stress)
        throw parameters.error("Discretization/Element",
                               "is for plane strain; there is no locking in plane stress",
                               "set it to standard, or Plane state = plane strain");
    }

    /// Rejects parameters that have no meaning for bodies of revolution.
    template <int dim>
    void check_revolution(const Scene<dim> &scene, const Parameters &parameters)
    {
      if (scene.plane_state != PlaneState::axisymmetric)
        return;
      for (const Body<dim> &body : scene.bodies)
        if (body.thickness != 1)
          throw parameters.error("Body " + body.name + "/Thickness",
                                 "has no meaning where Plane state = axisymmetric: the section is revolved, and forces "
                                 "are those over the whole circumference",
                                 "remove it, or set another Plane state");
      for (const BodyForce<dim> &load : scene.body_forces)
        if (load.axis.norm() > 0)
          throw parameters.error("Body force " + load.name + "/Axis",
                                 "has no meaning where Plane state = axisymmetric: bodies of revolution rotate about "
                                 "their axis, x = 0",
                                 "remove it");
    }
  } // namespace

  template <int dim>
  void check_scene(const Scene<dim> &scene, const Parameters &parameters)
  {
    check_bodies_held(scene, parameters);
    check_boundaries_used_once(scene, parameters);
    check_decomposition(scene, parameters);
    check_algorithm(scene, parameters);
    check_element(scene, parameters);
    check_revolution(scene, parameters);
  }

  template <int dim>
  std::vector<std::string> warnings(const Scene<dim> &scene)
  {
    std::vector<std::string> texts = scene.warnings;
    if (scene.plane_state != PlaneState::plane_stress && scene.discretization.element == ElementKind::standard)
      for (const Material &material : scene.materials)
        if (material.poisson_ratio > locking_poisson_ratio)
          texts.push_back(std::string("standard elements lock ") +
                          (dim == 3                                        ? "in solids"
                           : scene.plane_state == PlaneState::plane_strain ? "in plane strain"
                                                                           : "in bodies of revolution") +
                          " with Poisson ratio " + number_text(material.poisson_ratio) + " (Material " + material.name +
                          "): displacements will be too small; set Discretization/Element = nearly incompressible");
    return texts;
  }

  template void                     check_scene(const Scene<2> &, const Parameters &);
  template void                     check_scene(const Scene<3> &, const Parameters &);
  template std::vector<std::string> warnings(const Scene<2> &);
  template std::vector<std::string> warnings(const Scene<3> &);
} // namespace slipstick::scene
