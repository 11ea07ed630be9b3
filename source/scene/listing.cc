#include <slipstick/scene/listing.h>

#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>

#include <ostream>
#include <sstream>

namespace slipstick::scene
{
  namespace
  {
    using Style = dealii::ParameterHandler::OutputStyle;

    void collect(const boost::property_tree::ptree &tree,
                 const std::string                 &prefix,
                 std::vector<DeclaredParameter>    &parameters)
    {
      for (const auto &[name, node] : tree)
        {
          if (node.find("pattern_description") == node.not_found())
            {
              collect(node, prefix + name + "/", parameters);
              continue;
            }
          const auto documentation = node.get<std::string>("documentation");
          const auto unit_end      = documentation[0] == '[' ? documentation.find("] ") : std::string::npos;
          const bool has_unit      = unit_end != std::string::npos;
          parameters.push_back({prefix + name,
                                node.get<std::string>("value"),
                                node.get<std::string>("default_value"),
                                node.get<std::string>("pattern_description"),
                                has_unit ? documentation.substr(1, unit_end - 1) : "",
                                has_unit ? documentation.substr(unit_end + 2) : documentation});
        }
    }

    void write_text(std::ostream &out, const std::vector<DeclaredParameter> &parameters)
    {
      for (const DeclaredParameter &parameter : parameters)
        out << parameter.path << " = " << parameter.value << (parameter.unit.empty() ? "" : " [" + parameter.unit + "]")
            << "\n    " << parameter.meaning << "\n    allowed: " << parameter.allowed
            << "\n    default: " << (parameter.default_value.empty() ? "empty" : parameter.default_value) << "\n\n";
    }

    void write_json(std::ostream &out, const std::vector<DeclaredParameter> &parameters)
    {
      boost::property_tree::ptree list;
      for (const DeclaredParameter &parameter : parameters)
        {
          boost::property_tree::ptree entry;
          entry.put("name", parameter.path);
          entry.put("value", parameter.value);
          entry.put("default", parameter.default_value);
          entry.put("unit", parameter.unit);
          entry.put("allowed", parameter.allowed);
          entry.put("meaning", parameter.meaning);
          list.push_back(std::make_pair("", entry));
        }
      boost::property_tree::ptree root;
      root.add_child("parameters", list);
      boost::property_tree::write_json(out, root);
    }
  } // namespace

  std::vector<DeclaredParameter> declared_parameters(const dealii::ParameterHandler &prm)
  {
    std::stringstream json;
    prm.print_parameters(json, Style(Style::JSON | Style::KeepDeclarationOrder));
    boost::property_tree::ptree tree;
    boost::property_tree::read_json(json, tree);
    std::vector<DeclaredParameter> parameters;
    collect(tree, "", parameters);
    return parameters;
  }

  void write_parameters(std::ostream &out, const dealii::ParameterHandler &prm, const ListFormat format)
  {
    switch (format)
      {
        case ListFormat::text:
          return write_text(out, declared_parameters(prm));
        case ListFormat::json:
          return write_json(out, declared_parameters(prm));
        case ListFormat::prm:
          prm.print_parameters(out, Style(Style::PRM | Style::KeepDeclarationOrder));
          return;
        case ListFormat::latex:
          prm.print_parameters(out, Style(Style::LaTeX | Style::KeepDeclarationOrder));
          return;
      }
  }

  std::string print_values(const dealii::ParameterHandler &prm)
  {
    std::ostringstream text;
    prm.print_parameters(text, Style(Style::ShortPRM | Style::KeepDeclarationOrder));
    return text.str();
  }
} // namespace slipstick::scene
