// Random scenes, small and valid, each made from its seed alone.
#pragma once

#include <string>
#include <vector>

namespace slipstick::random
{
  struct GeneratedScene
  {
    std::string                                      family; // obstacle, two, stack, wall, fit, roller, groove
    std::string                                      law;    // frictionless, Tresca, Coulomb, bonded, mixed
    std::string                                      prm;
    std::vector<std::pair<std::string, std::string>> meshes;         // file name, content
    std::vector<std::vector<std::string>>            decompositions; // overrides of two runs
  };

  GeneratedScene generate(const unsigned int seed);
} // namespace slipstick::random
