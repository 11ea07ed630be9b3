// Suggestions for misspelt names.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace slipstick
{
  /// Number of insertions, deletions, replacements and transpositions of characters that turn @p a into @p b (optimal
  /// string alignment), not case-sensitive.
  unsigned int edit_distance(const std::string &a, const std::string &b);

  /// The candidate with the smallest edit distance to @p name, the first of several; nothing if there is no candidate
  /// or if more than half of the longer word would have to change.
  std::optional<std::string> nearest_name(const std::string &name, const std::vector<std::string> &candidates);

  /// The usual remedy for an unknown name: "did you mean X?" followed by all valid names, or "there are none" if @p
  /// candidates is empty.
  std::string suggest_name(const std::string &name, const std::vector<std::string> &candidates);

  /// "a, b, c"
  std::string join_names(const std::vector<std::string> &names);
} // namespace slipstick
