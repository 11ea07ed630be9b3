// The parameters declared in a dealii::ParameterHandler, as data and as text in several formats.
#pragma once

#include <slipstick/scene/list_format.h>

#include <deal.II/base/parameter_handler.h>

#include <iosfwd>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// A declared parameter. Allowed values and meaning are texts for users.
  struct DeclaredParameter
  {
    std::string path; // "Contact circle/Law"
    std::string value;
    std::string default_value;
    std::string allowed;
    std::string unit; // empty for none
    std::string meaning;
  };

  /// All parameters declared in @p prm, in the order of declaration.
  std::vector<DeclaredParameter> declared_parameters(const dealii::ParameterHandler &prm);

  /// Writes all parameters declared in @p prm with value, unit, range and meaning. Throws no exceptions of its own.
  void write_parameters(std::ostream &out, const dealii::ParameterHandler &prm, const ListFormat format);

  /// The values in @p prm alone, in a form that gives the same values when read again.
  std::string print_values(const dealii::ParameterHandler &prm);
} // namespace slipstick::scene
