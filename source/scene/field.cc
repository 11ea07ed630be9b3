#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/field.h>

#include <deal.II/base/numbers.h>

#include <muParser.h>

#include <array>
#include <cctype>
#include <cmath>

namespace slipstick::scene
{
  namespace
  {
    const std::array<std::string, 3> coordinate_names = {{"x", "y", "z"}};

    template <int dim>
    InputError formula_error(const std::string &where, const std::string &formula, const std::string &reason)
    {
      return InputError(where + " = '" + formula + "': " + reason,
                        std::string("give a finite number or a formula of x, y, ") + (dim == 3 ? "z, " : "") +
                          "t and pi such as -250*sin(pi*x/10)*t");
    }

    /// In muParser "=" is an assignment: x=3 would overwrite the variable.
    bool has_assignment(const std::string &formula)
    {
      for (std::size_t i = formula.find('='); i != std::string::npos; i = formula.find('=', i + 1))
        {
          const bool second = i > 0 && std::string("=<>!").find(formula[i - 1]) != std::string::npos;
          const bool first  = i + 1 < formula.size() && formula[i + 1] == '=';
          if (!first && !second)
            return true;
        }
      return false;
    }

    /// The message of muParser; for an unknown name also the known ones.
    std::string explain(const mu::Parser::exception_type &error,
                        const mu::Parser                 &parser,
                        const std::vector<std::string>   &variables)
    {
      std::string message = error.GetMsg();
      while (!message.empty() && message.back() == '.')
        message.pop_back();
      const std::string &token = error.GetToken();
      if (error.GetCode() != mu::ecUNASSIGNABLE_TOKEN || token.empty() ||
          !std::isalpha(static_cast<unsigned char>(token[0])))
        return message;

      std::vector<std::string> names = variables;
      for (const auto &function : parser.GetFunDef())
        names.push_back(function.first);
      const auto near = nearest_name(token, names);
      return message + "; known are " + join_names(variables) + " and muParser's functions" +
             (near ? "; nearest: " + *near : "");
    }
  } // namespace

  template <int dim>
  struct Field<dim>::Formula
  {
    Formula(const std::string &formula, const std::string &path);

    double evaluate(const dealii::Point<dim> &x, const double t);

    std::string             where;
    mu::Parser              parser;
    std::array<double, dim> position    = {};
    double                  load_factor = 0;
  };

  template <int dim>
  Field<dim>::Formula::Formula(const std::string &formula, const std::string &path)
    : where(path)
  {
    if (has_assignment(formula))
      throw formula_error<dim>(where, formula, "'=' assigns; compare with '=='");
    std::vector<std::string> names;
    try
      {
        for (unsigned int d = 0; d < dim; ++d)
          {
            parser.DefineVar(coordinate_names[d], &position[d]);
            names.push_back(coordinate_names[d]);
          }
        parser.DefineVar("t", &load_factor);
        parser.DefineConst("pi", dealii::numbers::PI);
        names.insert(names.end(), {"t", "pi"});
        parser.SetExpr(formula);
        parser.Eval();
        if (parser.GetNumResults() != 1)
          throw formula_error<dim>(where,
                                   formula,
                                   "more than one value (the decimal separator is the point, not the comma)");
      }
    catch (const mu::Parser::exception_type &error)
      {
        throw formula_error<dim>(where, formula, explain(error, parser, names));
      }
    if (parser.GetUsedVar().empty() && !is_usable(parser.Eval()))
      throw formula_error<dim>(where, formula, "not a finite number, or beyond " + number_text(largest_number));
  }

  template <int dim>
  double Field<dim>::Formula::evaluate(const dealii::Point<dim> &x, const double t)
  {
    for (unsigned int d = 0; d < dim; ++d)
      position[d] = x[d];
    load_factor         = t;
    const double result = parser.Eval();
    if (!is_usable(result))
      {
        std::string at;
        for (unsigned int d = 0; d < dim; ++d)
          at += coordinate_names[d] + " = " + number_text(x[d]) + ", ";
        throw formula_error<dim>(where,
                                 trim(parser.GetExpr()), // muParser appends a blank
                                 number_text(result) + " at " + at + "t = " + number_text(t));
      }
    return result;
  }

  template <int dim>
  Field<dim>::Field() = default;

  template <int dim>
  Field<dim>::Field(const std::string &formula, const std::string &where)
    : text(trim(formula))
  {
    if (text.empty())
      throw formula_error<dim>(where, text, "empty");
    const auto number = parse_number(text);
    if (!number)
      parsed = std::make_shared<Formula>(text, where);
    else if (*number != 0 &&
             std::abs(*number) < smallest_number) // its square underflows, so that it would have no effect
      throw formula_error<dim>(where,
                               text,
                               "numbers here are 0, or at least " + number_text(smallest_number) + " in size");
    else if (is_usable(*number))
      constant = *number;
    else
      throw formula_error<dim>(where, text, "not a finite number, or beyond " + number_text(largest_number));
  }

  template <int dim>
  double Field<dim>::value(const dealii::Point<dim> &x, const double t) const
  {
    return parsed ? parsed->evaluate(x, t) : constant;
  }

  template <int dim>
  bool Field<dim>::is_constant() const
  {
    return !parsed;
  }

  template <int dim>
  const std::string &Field<dim>::formula() const
  {
    return text;
  }

  template class Field<2>;
  template class Field<3>;
} // namespace slipstick::scene
