// The generic part around dealii::ParameterHandler: lists of names, values, diagnosis.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/scene/prm_file.h>

#include <deal.II/base/parameter_handler.h>

#include <optional>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// Subsections "KIND NAME" whose names the top level parameter LIST declares: {"Body", "Bodies"}.
  struct NamedKind
  {
    std::string              kind;
    std::string              list;
    std::vector<std::string> known = {}; // names that need no subsection
  };

  /// Sets the declared parameter @p path, "Solver/Tolerance", whose value must be allowed.
  void set_value(dealii::ParameterHandler &prm, const std::string &path, const std::string &value);

  /// What one .prm file with overrides sets. First names() of every list, then apply() to a handler that
  /// declares everything.
  class Parameters
  {
  public:
    /// @throws InputError as read_settings() and expand_variables() do.
    Parameters(const std::string              &file,
               const std::vector<std::string> &overrides,
               const std::vector<NamedKind>   &named_kinds);

    /// The names that the list of @p kind declares, in its order.
    /// @throws InputError for a name that is empty, declared twice, holds '/' or '=', or has no subsection.
    std::vector<std::string> names(const NamedKind &kind) const;

    /// Sets in @p prm all that file and overrides set.
    /// @throws InputError for an unknown section or parameter and for a value that is not allowed.
    void apply(dealii::ParameterHandler &prm) const;

    /// @throws InputError for the first parameter that is set and that @p there declares, but @p here does not.
    /// @param where_it_is of what @p there declares: "the plane (Dimension = 2)".
    void refuse_foreign(const dealii::ParameterHandler &here,
                        const dealii::ParameterHandler &there,
                        const std::string              &where_it_is) const;

    bool is_set(const std::string &path) const;

    /// Whether the file opens the subsection @p path, or anything in it is set.
    bool has_section(const std::string &path) const;

    /// The text that the file or an override sets the parameter to; nothing when it is not set.
    std::optional<std::string> value(const std::string &path) const;

    /// The existing file that a scene means by @p name: relative to the directory of the .prm, else to the working
    /// directory; an absolute path. Nothing when there is no such regular file.
    std::optional<std::string> find_file(const std::string &name) const;

    /// @throws InputError when nothing sets the parameter. @p remedy says what to set.
    void require(const std::string &path, const std::string &remedy) const;

    /// Place and path for a message about the parameter or section: "prm/box.prm:12: Contact circle/Law".
    std::string locate(const std::string &path) const;

    /// The message "PLACE: PATH = 'VALUE': REASON" for a parameter that is set.
    InputError error(const std::string &path, const std::string &reason, const std::string &remedy) const;

  private:
    const Setting *find(const std::string &path) const; // the last one

    std::string            file;
    std::vector<NamedKind> kinds;
    std::vector<Setting>   settings;
  };
} // namespace slipstick::scene
