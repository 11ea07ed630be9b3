// What a stage has to say about the scene or its files.
#pragma once

#include <string>
#include <utility>

namespace slipstick
{
  struct Remark
  {
    /// Implicit: a text alone is no warning.
    Remark(std::string text_, const bool is_warning_ = false)
      : text(std::move(text_))
      , is_warning(is_warning_)
    {}

    /// For the log.
    std::string line() const
    {
      return (is_warning ? "warning: " : "") + text;
    }

    std::string text; // of a warning: without "warning: "
    bool        is_warning;
  };
} // namespace slipstick
