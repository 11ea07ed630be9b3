// A number or a formula of x, y and the load factor t, as it stands in a .prm.
#pragma once

#include <deal.II/base/point.h>

#include <memory>
#include <string>

namespace dealii
{
  template <int dim>
  class FunctionParser;
}

namespace slipstick::scene
{
  /// A scalar function of position and load factor t, given as a number or as a muParser formula such as
  /// "-250*sin(pi*x/10)*t". Copies share the parsed formula. Evaluation is not thread safe.
  template <int dim>
  class Field
  {
  public:
    /// The constant 0.
    Field();

    /// @throws InputError naming @p where (the path of the parameter) when @p formula does not parse.
    Field(const std::string &formula, const std::string &where);

    double value(const dealii::Point<dim> &x, const double t) const;

    /// True when the formula is a plain number; then value() costs nothing.
    bool is_constant() const;

    const std::string &formula() const;

  private:
    std::string                                  text;
    double                                       constant = 0;
    std::shared_ptr<dealii::FunctionParser<dim>> parser; // empty for a constant
  };
} // namespace slipstick::scene
