// Numbers and lines for people and for recordings.
#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "asperity/core/printable.hpp"
#include "text/amount.hpp"

namespace asperity::command {

using text::brief;
using text::length_text;
using text::memory_text;
using text::rate_text;
using text::time_text;

/// Appends the shortest decimal that reads back as the same double: recordings are exact and compare byte by byte.
inline void append_number(std::string& out, double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  out.append(digits, end);
}

/// "  label ........ value" with the values in one column, one line whatever the two hold (printable()).
[[nodiscard]] inline std::string row(std::string_view label, std::string_view value) {
  std::string line = "  " + printable(label);
  line.append(line.size() < 26 ? 26 - line.size() : 1, ' ');
  return line + printable(value) + '\n';
}

}  // namespace asperity::command
