#include <slipstick/app/names.h>

namespace slipstick::app
{
  std::string name_of(const scene::Accuracy accuracy)
  {
    switch (accuracy)
      {
        case scene::Accuracy::draft:
          return "draft";
        case scene::Accuracy::engineering:
          return "engineering";
        case scene::Accuracy::reference:
          return "reference";
      }
    return "";
  }

  std::string name_of(const scene::PlaneState state)
  {
    switch (state)
      {
        case scene::PlaneState::plane_stress:
          return "plane stress";
        case scene::PlaneState::plane_strain:
          return "plane strain";
        case scene::PlaneState::axisymmetric:
          return "axisymmetric";
      }
    return "";
  }

  std::string name_of(const scene::DecompositionMethod method)
  {
    switch (method)
      {
        case scene::DecompositionMethod::automatic:
          return "auto";
        case scene::DecompositionMethod::blocks:
          return "blocks";
        case scene::DecompositionMethod::metis:
          return "METIS";
        case scene::DecompositionMethod::none:
          return "none";
      }
    return "";
  }

  std::string name_of(const scene::Algorithm algorithm)
  {
    switch (algorithm)
      {
        case scene::Algorithm::automatic:
          return "auto";
        case scene::Algorithm::smalbe:
          return "smalbe";
        case scene::Algorithm::semismooth_newton:
          return "semismooth newton";
        case scene::Algorithm::pcg:
          return "pcg";
      }
    return "";
  }

  std::string name_of(const tfeti::Preconditioner preconditioner)
  {
    switch (preconditioner)
      {
        case tfeti::Preconditioner::automatic:
          return "auto";
        case tfeti::Preconditioner::none:
          return "none";
        case tfeti::Preconditioner::lumped:
          return "lumped";
        case tfeti::Preconditioner::dirichlet:
          return "Dirichlet";
      }
    return "";
  }

  template <int dim>
  output::ContactNames contact_names(const scene::Scene<dim> &scene)
  {
    output::ContactNames names;
    for (const auto &pair : scene.contacts)
      {
        names.pairs.push_back(pair.name);
        names.slave_bodies.push_back(scene.bodies[pair.slave.body].name);
      }
    names.dimension = dim;
    return names;
  }

  template output::ContactNames contact_names(const scene::Scene<2> &);
  template output::ContactNames contact_names(const scene::Scene<3> &);
} // namespace slipstick::app
