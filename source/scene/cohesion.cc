#include <slipstick/scene/contact_law.h>

namespace slipstick::scene
{
  template <int dim>
  LawKind<dim> cohesion_law()
  {
    return {"cohesion",
            "Coulomb friction with cohesion in shear (no tension) and a limit of the shear stress",
            {{"Cohesion",
              "MPa",
              "cohesion: shear stress that closed nodes bear without pressure; must be set",
              "",
              "set it in MPa, or set Law = Coulomb"},
             {"Friction coefficient",
              "-",
              "cohesion: increase of this shear stress per pressure; must be set",
              "",
              "set it, to 0 for none"},
             {"Shear limit", "MPa", "cohesion: the shear stress is nowhere larger; none is no limit", "none", ""}},
            [](const auto &numbers) {
              ContactLaw<dim> law;
              law.has_friction = true;
              law.fixed        = numbers[0];
              law.coefficient  = numbers[1];
              law.cap          = numbers[2];
              return law;
            }};
  }

  template LawKind<2> cohesion_law();
  template LawKind<3> cohesion_law();
} // namespace slipstick::scene
