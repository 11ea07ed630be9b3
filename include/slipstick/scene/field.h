// A number or a formula of x, y and the load factor t, as written in a .prm.
#pragma once

#include <deal.II/base/point.h>

#include <memory>
#include <string>

namespace slipstick::scene
{
  /// A scalar function of position and load factor t, given as a number or as a muParser formula such as
  /// "-250*sin(pi*x/10)*t". Copies share the parsed formula. Evaluation is not thread safe. muParser is used
  /// directly: dealii::FunctionParser prints to standard error on a wrong formula and reads "1,5" as 5.
  template <int dim>
  class Field
  {
  public:
    /// The constant 0.
    Field();

    /// @throws InputError naming @p where (the path of the parameter) when @p formula does not parse, uses names
    /// other than x, y, t, pi and muParser's functions, or is a number that is not finite.
    Field(const std::string &formula, const std::string &where);

    /// @throws InputError (on the calling rank only) if the value is not a finite number.
    double value(const dealii::Point<dim> &x, const double t) const;

    /// Whether the formula is a plain number; value() is then free of cost.
    bool is_constant() const;

    const std::string &formula() const;

  private:
    struct Formula; // the parser with its variables

    std::string              text     = "0";
    double                   constant = 0;
    std::shared_ptr<Formula> parsed; // empty for a constant
  };
} // namespace slipstick::scene
