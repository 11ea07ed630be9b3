#include <slipstick/base/text.h>
#include <slipstick/scene/material_library.h>

namespace slipstick::scene
{
  namespace
  {
    struct Entry
    {
      std::string name;
      double      young_modulus; // [MPa]
      double      poisson_ratio;
      double      density;   // [t/mm^3]
      double      expansion; // [1/K]
    };

    /// Typical values at room temperature, rounded: alloys and grades differ by a few percent, plastics and concrete by
    /// more.
    const std::vector<Entry> &library()
    {
      static const std::vector<Entry> entries = {{"steel", 2.1e5, 0.3, 7.85e-9, 1.2e-5},
                                                 {"stainless steel", 2.0e5, 0.3, 7.9e-9, 1.6e-5},
                                                 {"cast iron", 1.1e5, 0.26, 7.2e-9, 1.05e-5},
                                                 {"aluminium", 7.0e4, 0.33, 2.7e-9, 2.3e-5},
                                                 {"titanium", 1.1e5, 0.34, 4.5e-9, 8.6e-6},
                                                 {"copper", 1.2e5, 0.34, 8.96e-9, 1.65e-5},
                                                 {"brass", 1.0e5, 0.35, 8.5e-9, 1.9e-5},
                                                 {"bronze", 1.1e5, 0.34, 8.8e-9, 1.8e-5},
                                                 {"magnesium", 4.5e4, 0.29, 1.8e-9, 2.6e-5},
                                                 {"glass", 7.0e4, 0.22, 2.5e-9, 9e-6},
                                                 {"concrete", 3.0e4, 0.2, 2.4e-9, 1e-5},
                                                 {"polyamide", 2.5e3, 0.39, 1.14e-9, 8e-5},
                                                 {"acrylic", 3.0e3, 0.37, 1.18e-9, 7e-5}};
      return entries;
    }
  } // namespace

  std::vector<std::string> library_names()
  {
    std::vector<std::string> names;
    for (const Entry &entry : library())
      names.push_back(entry.name);
    return names;
  }

  void apply_library(const Parameters &parameters, const std::vector<std::string> &names, dealii::ParameterHandler &prm)
  {
    for (const std::string &name : names)
      {
        const std::string section = "Material " + name;
        const auto        wanted  = parameters.value(section + "/Library");
        for (const Entry &entry : library()) // a word that is not in the library is rejected by apply()
          if (wanted ? entry.name == *wanted : entry.name == name && !parameters.has_section(section))
            {
              set_value(prm, section + "/Library", entry.name);
              set_value(prm, section + "/Young modulus", number_text(entry.young_modulus));
              set_value(prm, section + "/Poisson ratio", number_text(entry.poisson_ratio));
              set_value(prm, section + "/Density", number_text(entry.density));
              set_value(prm, section + "/Thermal expansion", number_text(entry.expansion));
            }
      }
  }
} // namespace slipstick::scene
