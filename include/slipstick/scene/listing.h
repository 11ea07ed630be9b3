// What a dealii::ParameterHandler declares, as data and as text in several formats.
#pragma once

#include <slipstick/scene/list_format.h>

#include <deal.II/base/parameter_handler.h>

#include <iosfwd>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// A parameter as declared. Allowed values and meaning are for people.
  struct DeclaredParameter
  {
    std::string path; // "Contact circle/Law"
    std::string value;
    std::string default_value;
    std::string allowed;
    std::string unit; // empty for none
    std::string meaning;
  };

  /// All that @p prm declares, in the order of declaration.
  std::vector<DeclaredParameter> declared_parameters(const dealii::ParameterHandler &prm);

  /// Writes all that @p prm declares with value, unit, range and meaning. Throws nothing of its own.
  void write_parameters(std::ostream &out, const dealii::ParameterHandler &prm, const ListFormat format);

  /// The values of @p prm alone, such that reading them again gives the same values.
  std::string print_values(const dealii::ParameterHandler &prm);
} // namespace slipstick::scene
