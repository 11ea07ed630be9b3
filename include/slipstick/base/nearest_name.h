// The valid name that a misspelt one most probably means.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace slipstick
{
  /// Number of single character insertions, deletions, replacements and swaps of neighbours that turn @p a into
  /// @p b (optimal string alignment), upper and lower case taken as equal.
  unsigned int edit_distance(const std::string &a, const std::string &b);

  /// The candidate with the smallest edit distance to @p name, the first among equals; none if there is no candidate or
  /// if so much would have to change (over half of the longer word) that a suggestion would mislead.
  std::optional<std::string> nearest_name(const std::string &name, const std::vector<std::string> &candidates);

  /// "did you mean X?" followed by all valid names, or "there are none" when @p candidates is empty: the usual
  /// remedy of an unknown name.
  std::string suggest_name(const std::string &name, const std::vector<std::string> &candidates);

  /// "a, b, c"
  std::string join_names(const std::vector<std::string> &names);
} // namespace slipstick
