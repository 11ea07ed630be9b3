// Generic layer around dealii::ParameterHandler: lists of names, values, error messages.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/scene/prm_file.h>

#include <deal.II/base/parameter_handler.h>

#include <optional>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// Subsections "KIND NAME" whose names are declared by the top-level parameter LIST: {"Body", "Bodies"}.
  struct NamedKind
  {
    std::string              kind;
    std::string              list;
    std::vector<std::string> known = {}; // names that need no subsection
  };

  /// Sets the declared parameter @p path, e.g. "Solver/Tolerance"; the value must be allowed.
  void set_value(dealii::ParameterHandler &prm, const std::string &path, const std::string &value);

  /// The settings of one .prm file with overrides. First call names() for every list, then apply() with a handler that
  /// declares all parameters.
  class Parameters
  {
  public:
    /// @throws InputError as read_settings() and expand_variables() do.
    Parameters(const std::string              &file,
               const std::vector<std::string> &overrides,
               const std::vector<NamedKind>   &named_kinds);

    /// The names declared in the list of @p kind, in its order.
    /// @throws InputError for a name that is empty, declared twice, contains '/' or '=', or has no subsection.
    std::vector<std::string> names(const NamedKind &kind) const;

    /// Sets in @p prm everything set by file and overrides.
    /// @throws InputError for an unknown section or parameter and for a value that is not allowed.
    void apply(dealii::ParameterHandler &prm) const;

    /// @throws InputError for the first parameter that is set and declared in @p there, but not in @p here.
    /// @param where_it_is describes what @p there belongs to: "the plane (Dimension = 2)".
    void refuse_foreign(const dealii::ParameterHandler &here,
                        const dealii::ParameterHandler &there,
                        const std::string              &where_it_is) const;

    bool is_set(const std::string &path) const;

    /// Whether --set sets the parameter.
    bool is_override(const std::string &path) const;

    /// Whether the file opens the subsection @p path, or anything in it is set.
    bool has_section(const std::string &path) const;

    /// The text to which the file or an override sets the parameter; nothing if it is not set.
    std::optional<std::string> value(const std::string &path) const;

    /// Absolute path of the existing file @p name: relative to the directory of the .prm, otherwise to the working
    /// directory. Nothing if there is no such regular file.
    std::optional<std::string> find_file(const std::string &name) const;

    /// @throws InputError if the parameter is not set. @p remedy says what to set.
    void require(const std::string &path, const std::string &remedy) const;

    /// Place and path for a message about the parameter or section: "prm/box.prm:12: Contact circle/Law".
    std::string locate(const std::string &path) const;

    /// The message "PLACE: PATH = 'VALUE': REASON" for a parameter that is set.
    InputError error(const std::string &path, const std::string &reason, const std::string &remedy) const;

  private:
    const Setting *find(const std::string &path) const; // the last setting of the path

    std::string            file;
    std::vector<NamedKind> kinds;
    std::vector<Setting>   settings;
  };
} // namespace slipstick::scene
