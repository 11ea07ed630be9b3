#include <slipstick/base/nearest_name.h>
#include <slipstick/base/printable.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/listing.h>
#include <slipstick/scene/parameters.h>
#include <slipstick/scene/variables.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace slipstick::scene
{
  namespace
  {
    // Stand for all bodies and for the whole outline; not allowed as names.
    const std::vector<std::string> reserved_names = {"all", "*"};
    // Maximum length of lists in remedies.
    constexpr std::size_t longest_list = 400;

    /// "a/b/c" -> "a/b", "c"
    std::pair<std::string, std::string> split_path(const std::string &path)
    {
      const auto slash = path.rfind('/');
      return slash == std::string::npos ? std::make_pair(std::string(), path)
                                        : std::make_pair(path.substr(0, slash), path.substr(slash + 1));
    }

    /// The declared sections and parameters, for look-up and suggestions.
    class Declarations
    {
    public:
      Declarations(const dealii::ParameterHandler &prm, const std::vector<NamedKind> &named_kinds);

      /// Throws unless all sections of @p setting and its name exist.
      void check_name(const Setting &setting) const;

      /// The error for a value that is not allowed by the pattern of @p setting.
      InputError value_error(const Setting &setting) const;

    private:
      void check_section(const std::string &path, const Setting &setting) const;

      std::vector<std::string> children_of(const std::string &section, const bool sections) const;

      std::vector<NamedKind>                   kinds;
      std::vector<std::string>                 sections; // in order, all levels
      std::map<std::string, DeclaredParameter> parameters;
      std::vector<std::string>                 order; // paths of the parameters
    };

    Declarations::Declarations(const dealii::ParameterHandler &prm, const std::vector<NamedKind> &named_kinds)
      : kinds(named_kinds)
    {
      for (const DeclaredParameter &parameter : declared_parameters(prm))
        {
          parameters.emplace(parameter.path, parameter);
          order.push_back(parameter.path);
          for (auto slash = parameter.path.find('/'); slash != std::string::npos;
               slash      = parameter.path.find('/', slash + 1))
            {
                   const std::string section = parameter.path.substr(0, slash);
                   if (std::find(sections.begin(), sections.end(), section) == sections.end())
                sections.push_back(section);
            }
        }
    }

    std::vector<std::string> Declarations::children_of(const std::string &section, const bool of_sections) const
    {
      std::vector<std::string> children;
      for (const std::string &path : of_sections ? sections : order)
        if (split_path(path).first == section)
          children.push_back(split_path(path).second);
      return children;
    }

    void Declarations::check_section(const std::string &path, const Setting &setting) const
    {
      if (path.empty())
        return;
      const auto [parent, name] = split_path(path);
      check_section(parent, setting);
      if (std::find(sections.begin(), sections.end(), path) != sections.end())
        return;

      std::string remedy = suggest_name(name, children_of(parent, true));
      for (const NamedKind &kind : kinds)
        if (name == kind.kind)
          {
            remedy = "give its name, as in '" + kind.kind + " NAME', one of those in " + kind.list;
            break;
          }
        else if (name.compare(0, kind.kind.size() + 1, kind.kind + " ") == 0)
          {
            const std::string        own_name = name.substr(kind.kind.size() + 1);
            std::vector<std::string> declared;
            for (const std::string &section : children_of(parent, true))
              if (section.compare(0, kind.kind.size() + 1, kind.kind + " ") == 0 && section != "Contact search")
                declared.push_back(section.substr(kind.kind.size() + 1));
            remedy = "declare it: set " + kind.list + " = " +
                     shortened(join_names(declared) + (declared.empty() ? "" : ", ") + own_name, longest_list);
            if (const auto near = nearest_name(own_name, declared))
              remedy += "; or did you mean '" + kind.kind + " " + *near + "'?";
          }
      throw InputError(setting.where + ": there is no section '" + path + "'", remedy);
    }

    void Declarations::check_name(const Setting &setting) const
    {
      if (setting.is_section)
        return check_section(setting.path, setting);
      const auto [section, name] = split_path(setting.path);
      check_section(section, setting);
      if (parameters.count(setting.path) > 0)
        return;

      std::string remedy = suggest_name(name, children_of(section, false));
      for (const std::string &path : order)
        if (split_path(path).second == name)
          {
            remedy = "did you mean '" + path + "'?";
            break;
          }
      throw InputError(setting.where + ": there is no parameter '" + setting.path + "' (set to '" + setting.value +
                         "')",
                       remedy);
    }

    InputError Declarations::value_error(const Setting &setting) const
    {
      const DeclaredParameter &parameter = parameters.at(setting.path);
      const std::string        problem   = setting.where + ": " + setting.path + " = '" + setting.value + "' is not ";
      if (parameter.allowed.compare(0, choice_prefix.size(), choice_prefix) == 0)
        {
          const std::string words = parameter.allowed.substr(choice_prefix.size());
          const auto        near  = nearest_name(setting.value, split_list(words));
          return InputError(problem + "available; available: " + words,
                            near ? "did you mean '" + *near + "'?" : "choose one of these");
        }
      if (const auto number = parse_number(setting.value);
          number && (!is_usable(*number) || (*number > 0 && *number < smallest_number)))
        return InputError(problem + "allowed: numbers here lie between " + number_text(smallest_number) + " and " +
                            number_text(largest_number) + " in size",
                          "give " + parameter.allowed + " of that size, in other units if need be");
      return InputError(problem + "allowed; allowed: " + parameter.allowed,
                        "give " + parameter.allowed + " (" + parameter.meaning +
                          (parameter.unit.empty() ? "" : " [" + parameter.unit + "]") + ")");
    }
  } // namespace

  Parameters::Parameters(const std::string              &file_name,
                         const std::vector<std::string> &overrides,
                         const std::vector<NamedKind>   &named_kinds)
    : file(file_name)
    , kinds(named_kinds)
    , settings(read_settings(file_name, overrides))
  {
    expand_variables(settings);
  }

  const Setting *Parameters::find(const std::string &path) const
  {
    const auto found = std::find_if(settings.rbegin(), settings.rend(), [&path](const Setting &setting) {
      return setting.path == path;
    });
    return found == settings.rend() ? nullptr : &*found;
  }

  void Parameters::refuse_foreign(const dealii::ParameterHandler &here,
                                  const dealii::ParameterHandler &there,
                                  const std::string              &where_it_is) const
  {
    std::set<std::string> own, foreign;
    for (const DeclaredParameter &parameter : declared_parameters(here))
      own.insert(parameter.path);
    for (const DeclaredParameter &parameter : declared_parameters(there))
      foreign.insert(parameter.path);
    for (const Setting &setting : settings)
      if (!setting.is_section && own.count(setting.path) == 0 && foreign.count(setting.path) > 0)
        throw error(setting.path, "is available in " + where_it_is + " only", "remove it, or set Dimension");
  }

  bool Parameters::is_set(const std::string &path) const
  {
    const Setting *setting = find(path);
    return setting != nullptr && !setting->is_section;
  }

  bool Parameters::is_override(const std::string &path) const
  {
    return is_set(path) && find(path)->is_override;
  }

  bool Parameters::has_section(const std::string &path) const
  {
    return std::any_of(settings.begin(), settings.end(), [&path](const Setting &setting) {
      return setting.path == path || setting.path.compare(0, path.size() + 1, path + "/") == 0;
    });
  }

  std::optional<std::string> Parameters::value(const std::string &path) const
  {
    if (!is_set(path))
      return {};
    return find(path)->value;
  }

  std::optional<std::string> Parameters::find_file(const std::string &name) const
  {
    for (const auto &path : {std::filesystem::path(file).parent_path() / name, std::filesystem::path(name)})
      {
        std::error_code error; // a path that cannot be examined is not a regular file
        if (std::filesystem::is_regular_file(path, error))
          return std::filesystem::absolute(path).lexically_normal().string();
      }
    return {};
  }

  void Parameters::require(const std::string &path, const std::string &remedy) const
  {
    if (!is_set(path))
      throw InputError(locate(split_path(path).first) + ": " + split_path(path).second + " is not set", remedy);
  }

  std::string Parameters::locate(const std::string &path) const
  {
    const Setting *setting = find(path);
    return (setting != nullptr ? setting->where : file) + ": " + path;
  }

  InputError Parameters::error(const std::string &path, const std::string &reason, const std::string &remedy) const
  {
    return InputError(locate(path) + (is_set(path) ? " = '" + find(path)->value + "'" : "") + ": " + reason, remedy);
  }

  std::vector<std::string> Parameters::names(const NamedKind &kind) const
  {
    if (!is_set(kind.list))
      return {};
    std::vector<std::string> names = split_list(find(kind.list)->value);
    std::set<std::string>    seen;
    for (std::string &name : names)
      {
        name = collapse_blanks(name);
        if (name.empty() || name.find_first_of("/=") != std::string::npos)
          throw error(kind.list,
                      "'" + name + "' is not a valid name",
                      "separate names by commas; names must not contain / or =");
        if (std::find(reserved_names.begin(), reserved_names.end(), name) != reserved_names.end())
          throw error(kind.list,
                      "'" + name + "' is reserved: in place of a name it means all of them",
                      "choose another name for the " + kind.kind);
        if (!seen.insert(name).second)
          throw error(kind.list, "'" + name + "' is declared twice", "give every " + kind.kind + " its own name");
      }
    return names;
  }

  void set_value(dealii::ParameterHandler &prm, const std::string &path, const std::string &value)
  {
    const auto [section, name] = split_path(path);
    const auto levels          = split_list(section, '/');
    for (const std::string &level : levels)
      prm.enter_subsection(level);
    prm.set(name, value);
    for (unsigned int level = 0; level < levels.size(); ++level)
      prm.leave_subsection();
  }

  void Parameters::apply(dealii::ParameterHandler &prm) const
  {
    const Declarations declarations(prm, kinds);
    for (const Setting &setting : settings)
      {
        declarations.check_name(setting);
        if (setting.is_section)
          continue;
        try
          {
            set_value(prm, setting.path, setting.value);
          }
        catch (const dealii::ParameterHandler::ExcValueDoesNotMatchPattern &)
          {
            throw declarations.value_error(setting);
          }
      }

    // Names without a subsection are checked last, so that a misspelt subsection has already been reported as such.
    for (const NamedKind &kind : kinds)
      for (const std::string &name : names(kind))
        {
          const std::string section = kind.kind + " " + name;
          if (std::find(kind.known.begin(), kind.known.end(), name) == kind.known.end() && !has_section(section))
            throw error(kind.list, "no subsection describes '" + name + "'", "add a subsection " + section);
        }
  }
} // namespace slipstick::scene
