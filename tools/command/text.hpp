// Numbers and lines for people and for recordings.
#pragma once

#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>

#include "asperity/core/printable.hpp"

namespace asperity::command {

/// Appends the shortest decimal that reads back as the same double: recordings are exact and compare byte by byte.
inline void append_number(std::string& out, double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  out.append(digits, end);
}

/// Three significant digits.
[[nodiscard]] std::string brief(double value);

/// A length in metres in the unit that suits its size, as in "12.3 mm".
[[nodiscard]] std::string length_text(double metres);

/// A duration in seconds in the unit that suits its size, as in "12.3 us".
[[nodiscard]] std::string time_text(double seconds);

/// An amount of memory, as in "12.7 MB", in powers of ten.
[[nodiscard]] std::string memory_text(std::size_t bytes);

/// "  label ........ value" with the values in one column, one line whatever the two hold (printable()).
[[nodiscard]] std::string row(std::string_view label, std::string_view value);

}  // namespace asperity::command
