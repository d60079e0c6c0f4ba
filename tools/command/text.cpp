#include "text.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace asperity::command {
namespace {

struct scale {
  double factor;
  const char* unit;
};

template <std::size_t N>
std::string scaled(double value, const std::array<scale, N>& units) {
  const double size = std::fabs(value);
  for (const scale& s : units) {
    if (size >= s.factor) return brief(value / s.factor) + ' ' + s.unit;
  }
  return brief(value / units.back().factor) + ' ' + units.back().unit;
}

}  // namespace

std::string brief(double value) {
  char text[32];
  const double size = std::fabs(value);
  // %g would print 1234 as 1.23e+03.
  const bool whole = size >= 1000.0 && size < 1e7;
  std::snprintf(text, sizeof text, whole ? "%.0f" : "%.3g", value);
  return text;
}

std::string length_text(double metres) {
  if (std::fabs(metres) < 1e-12) return "0 m";  // rounding, not a length
  return scaled(metres, std::array<scale, 4>{{{1.0, "m"}, {1e-3, "mm"}, {1e-6, "um"}, {1e-9, "nm"}}});
}

std::string time_text(double seconds) {
  if (seconds == 0.0) return "0 s";
  return scaled(seconds, std::array<scale, 4>{{{1.0, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}}});
}

std::string memory_text(std::size_t bytes) {
  return scaled(static_cast<double>(bytes), std::array<scale, 4>{{{1e9, "GB"}, {1e6, "MB"}, {1e3, "kB"}, {1.0, "B"}}});
}

std::string row(std::string_view label, std::string_view value) {
  std::string line = "  ";
  const std::string name = printable(label);
  line += name;
  line.append(name.size() < 24 ? 24 - name.size() : 1, ' ');
  line += printable(value);
  line += '\n';
  return line;
}

}  // namespace asperity::command
