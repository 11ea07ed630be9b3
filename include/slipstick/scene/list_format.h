// Formats in which all parameters can be listed.
#pragma once

namespace slipstick::scene
{
  enum class ListFormat
  {
    text,
    prm,
    json,
    latex
  };
} // namespace slipstick::scene
