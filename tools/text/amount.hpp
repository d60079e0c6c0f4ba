// Amounts for people: three digits, and the unit that suits their size.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <span>
#include <string>

namespace asperity::text {

/// Three significant digits.
[[nodiscard]] inline std::string brief(double value) {
  char digits[32];
  const double size = std::fabs(value);
  // %g would print 1234 as 1.23e+03.
  const bool whole = size >= 1000.0 && size < 1e7;
  std::snprintf(digits, sizeof digits, whole ? "%.0f" : "%.3g", value);
  return digits;
}

struct unit {
  double size;  ///< in the unit of the value
  const char* name;
};

/// In the largest of the units that the value holds at least once, or in the last. @pre at least one, largest first
[[nodiscard]] inline std::string in_units(double value, std::span<const unit> units) {
  for (const unit& u : units) {
    if (std::fabs(value) >= u.size) return brief(value / u.size) + ' ' + u.name;
  }
  return brief(value / units.back().size) + ' ' + units.back().name;
}

/// A length in metres, as in "12.3 mm".
[[nodiscard]] inline std::string length_text(double metres) {
  constexpr unit units[]{{1.0, "m"}, {1e-3, "mm"}, {1e-6, "um"}, {1e-9, "nm"}};
  return std::fabs(metres) < 1e-12 ? "0 m" : in_units(metres, units);  // less is rounding, not a length
}

/// A duration in seconds, as in "12.3 us".
[[nodiscard]] inline std::string time_text(double seconds) {
  constexpr unit units[]{{1.0, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}};
  return seconds == 0.0 ? "0 s" : in_units(seconds, units);
}

/// A rate in hertz, as in "1.25 kHz".
[[nodiscard]] inline std::string rate_text(double hertz) {
  constexpr unit units[]{{1e3, "kHz"}, {1.0, "Hz"}};
  return in_units(hertz, units);
}

/// An amount of memory, as in "12.7 MB", in powers of ten.
[[nodiscard]] inline std::string memory_text(std::size_t bytes) {
  constexpr unit units[]{{1e9, "GB"}, {1e6, "MB"}, {1e3, "kB"}, {1.0, "B"}};
  return in_units(static_cast<double>(bytes), units);
}

}  // namespace asperity::text
