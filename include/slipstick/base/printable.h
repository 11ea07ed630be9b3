// Text from files and command lines as it may stand in a message.
#pragma once

#include <string>

namespace slipstick
{
  /// Length of @p text up to its first byte that is no part of valid UTF-8 (RFC 3629); npos when all of it is valid.
  std::size_t first_invalid_utf8(const std::string &text);

  /// @p text with control characters and what is no UTF-8 escaped as \xNN, so that it neither colours nor cuts a message;
  /// line breaks are kept.
  std::string printable(const std::string &text);

  /// @p text when it has at most @p most characters, else its beginning and end around "...".
  std::string shortened(const std::string &text, const std::size_t most = 80);

  /// A message for the terminal: printable, values in quotation marks shortened to 80 characters, lines to 2000.
  std::string for_terminal(const std::string &message);
} // namespace slipstick
