// Makes text from files and command lines printable in messages.
#pragma once

#include <string>

namespace slipstick
{
  /// Length of @p text up to the first byte that is not part of valid UTF-8 (RFC 3629); npos if all of it is valid.
  std::size_t first_invalid_utf8(const std::string &text);

  /// @p text with control characters and invalid UTF-8 escaped as \xNN, so that it can neither colour nor truncate a
  /// message; line breaks are kept.
  std::string printable(const std::string &text);

  /// @p text if it has at most @p most characters, otherwise its start and end around "...".
  std::string shortened(const std::string &text, const std::size_t most = 80);

  /// A message for the terminal: printable, values in quotation marks shortened to 80 characters, lines to 2000.
  std::string for_terminal(const std::string &message);
} // namespace slipstick
