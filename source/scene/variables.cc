#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/variables.h>

#include <deal.II/base/numbers.h>

#include <muParser.h>

#include <algorithm>

namespace slipstick::scene
{
  namespace
  {
    const std::string list_name = "Variables";
    const std::string prefix    = list_name + "/";
    const std::string how_to    = "write: set Variables = d = 0.05; mu = 0.2, and use them as {mu} or {10 - d/2}";

    // These names have another meaning in formulas.
    const std::vector<std::string> reserved = {"x", "y", "z", "t", "pi"};

    struct Variable
    {
      std::string name, expression;
      double      value = 0;
    };

    InputError error(const Setting &setting, const std::string &reason, const std::string &remedy = how_to)
    {
      return InputError(setting.where + ": " + setting.path + " = '" + setting.value + "': " + reason, remedy);
    }

    std::vector<std::string> names_of(const std::vector<Variable> &variables)
    {
      std::vector<std::string> names;
      for (const Variable &variable : variables)
        names.push_back(variable.name);
      return names;
    }

    double evaluate(const std::string &expression, const std::vector<Variable> &variables, const Setting &setting)
    {
      double value = 0;
      try
        {
          mu::Parser parser;
          parser.DefineConst("pi", dealii::numbers::PI);
          for (const Variable &variable : variables)
            parser.DefineConst(variable.name, variable.value);
          parser.SetExpr(expression);
          value = parser.Eval();
          if (parser.GetNumResults() != 1)
            throw error(setting, "'" + expression + "' is more than one value (the decimal separator is the point)");
        }
      catch (const mu::Parser::exception_type &problem)
        {
          throw error(setting,
                      "'" + expression + "' cannot be evaluated: " + trim(problem.GetMsg()) +
                        (variables.empty() ? "" : " Variables here: " + join_names(names_of(variables))));
        }
      if (!is_usable(value))
        throw error(setting, "'" + expression + "' is not a finite number, or beyond " + number_text(largest_number));
      return value;
    }

    /// Parses "d = 0.05; mu = 0.2" into names and expressions.
    std::vector<Variable> parse(const Setting &setting)
    {
      std::vector<Variable> variables;
      for (const std::string &part : split_list(setting.value, ';'))
        {
          if (part.empty())
            continue;
          const auto     equals   = part.find('=');
          const Variable variable = {trim(part.substr(0, equals)),
                                     equals == std::string::npos ? "" : trim(part.substr(equals + 1))};
          const auto    &name     = variable.name;
          const bool     valid =
            !name.empty() && (std::isalpha(static_cast<unsigned char>(name[0])) || name[0] == '_') &&
            std::all_of(name.begin(), name.end(), [](const unsigned char c) { return std::isalnum(c) || c == '_'; });
          if (!valid || variable.expression.empty())
            throw error(setting, "'" + part + "' is not NAME = NUMBER");
          if (std::find(reserved.begin(), reserved.end(), name) != reserved.end())
            throw error(setting, "'" + name + "' has a meaning of its own in formulas", "choose another name");
          const auto names = names_of(variables);
          if (std::find(names.begin(), names.end(), name) != names.end())
            throw error(setting, "'" + name + "' is given twice", "give every variable once");
          variables.push_back(variable);
        }
      return variables;
    }

    /// Removes the overrides of single variables and applies the last one of each name.
    void override_single(std::vector<Setting> &settings, std::vector<Variable> &variables)
    {
      for (const Setting &setting : settings)
        if (!setting.is_section && setting.path.compare(0, prefix.size(), prefix) == 0)
          {
            const std::string name = setting.path.substr(prefix.size());
            const auto found = std::find_if(variables.begin(), variables.end(), [&name](const Variable &variable) {
              return variable.name == name;
            });
            if (found == variables.end())
              throw error(setting,
                          "the scene has no variable '" + name + "'",
                          variables.empty() ? how_to : suggest_name(name, names_of(variables)));
            found->expression = setting.value;
          }
      settings.erase(std::remove_if(settings.begin(),
                                    settings.end(),
                                    [](const Setting &setting) {
                                      return !setting.is_section && setting.path.compare(0, prefix.size(), prefix) == 0;
                                    }),
                     settings.end());
    }

    /// Whether an operator is adjacent to the braces at @p open and @p close; a negative value then needs parentheses
    /// (two signs, or -2 and ^2).
    bool is_operand(const std::string &text, const std::size_t open, const std::size_t close)
    {
      const auto before = open > 0 ? text.find_last_not_of(" \t", open - 1) : std::string::npos;
      const auto behind = text.find_first_not_of(" \t", close + 1);
      return (before != std::string::npos && std::string("+-*/^").find(text[before]) != std::string::npos) ||
             (behind != std::string::npos && text[behind] == '^');
    }

    std::string expanded(const Setting &setting, const std::vector<Variable> &variables)
    {
      std::string text;
      std::size_t next = 0;
      while (true)
        {
          const auto open = setting.value.find('{', next), close = setting.value.find('}', next);
          if (open == std::string::npos && close == std::string::npos)
            return text + setting.value.substr(next);
          if (open == std::string::npos || close == std::string::npos || close < open)
            throw error(setting, "a brace without its partner");
          text += setting.value.substr(next, open - next);
          const double value = evaluate(setting.value.substr(open + 1, close - open - 1), variables, setting);
          text +=
            value < 0 && is_operand(setting.value, open, close) ? "(" + number_text(value) + ")" : number_text(value);
          next = close + 1;
        }
    }
  } // namespace

  void expand_variables(std::vector<Setting> &settings)
  {
    const auto            list      = std::find_if(settings.rbegin(), settings.rend(), [](const Setting &setting) {
      return !setting.is_section && setting.path == list_name;
    });
    const Setting         given     = list != settings.rend() ? *list : Setting();
    std::vector<Variable> variables = parse(given);
    override_single(settings, variables);

    std::vector<Variable> known;
    std::string           text;
    for (Variable &variable : variables)
      {
        variable.value = evaluate(variable.expression, known, given);
        known.push_back(variable);
        text += (text.empty() ? "" : "; ") + variable.name + " = " + number_text(variable.value);
      }
    if (variables.empty())
      return;
    for (Setting &setting : settings)
      if (!setting.is_section)
        setting.value = setting.path == list_name ? text : expanded(setting, known);
  }
} // namespace slipstick::scene
