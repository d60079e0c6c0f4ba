// Checks of option values that CLI11 does not have. Each returns an empty string, or what is wrong.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/control/friction.hpp"
#include "asperity/control/passivity_guard.hpp"
#include "asperity/control/virtual_coupling.hpp"

namespace asperity::command {

/// A finite number greater than zero.
[[nodiscard]] inline std::string positive_number_error(const std::string& text) {
  double value = 0.0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = failed == std::errc() && end == text.data() + text.size();
  if (whole && std::isfinite(value) && value > 0.0) return {};
  return "'" + text + "' is not a finite number greater than zero";
}

/// A rate that a loop of a session can be asked to keep.
[[nodiscard]] inline std::string loop_rate_error(const std::string& text) {
  constexpr double least_hz = 100.0, most_hz = 10'000.0;
  double value = 0.0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = failed == std::errc() && end == text.data() + text.size();
  if (whole && value >= least_hz && value <= most_hz) return {};
  return "'" + text + "' is not a rate from 100 to 10000 Hz";
}

/// Coefficients of friction, static and dynamic, with a comma between; of one alone both are.
[[nodiscard]] inline std::optional<friction_settings> friction_of(const std::string& text) {
  const auto number = [](std::string_view part, double& to) {
    const auto [end, failed] = std::from_chars(part.data(), part.data() + part.size(), to);
    return failed == std::errc() && end == part.data() + part.size();
  };
  friction_settings out;
  const std::size_t comma = text.find(',');
  if (!number(std::string_view(text).substr(0, comma), out.static_coefficient)) return std::nullopt;
  out.dynamic_coefficient = out.static_coefficient;
  if (comma != std::string::npos && !number(std::string_view(text).substr(comma + 1), out.dynamic_coefficient)) {
    return std::nullopt;
  }
  if (!asperity::check(out)) return std::nullopt;
  return out;
}
[[nodiscard]] inline std::string friction_error(const std::string& text) {
  if (friction_of(text)) return {};
  return "'" + text + "' is not STATIC or STATIC,DYNAMIC with 10 >= STATIC >= DYNAMIC >= 0";
}

/// Numbers with commas between; nothing where one is none, or there are more than `most` of them.
[[nodiscard]] inline std::vector<double> numbers_of(std::string_view text, std::size_t most) {
  std::vector<double> out;
  for (bool more = true; more;) {
    double value = 0.0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc() || !std::isfinite(value) || out.size() == most) return {};
    out.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    more = !text.empty();
    if (more && text.front() != ',') return {};
    if (more) text.remove_prefix(1);
  }
  return out;
}

/// Mass of a handle and, after commas, its centre of mass in the handle's frame: KG or KG,X,Y,Z.
[[nodiscard]] inline std::optional<weight_settings> weight_of(const std::string& text) {
  const std::vector<double> n = numbers_of(text, 4);
  if ((n.size() != 1 && n.size() != 4) || !(n[0] > 0.0)) return std::nullopt;
  weight_settings out{.mass_kg = n[0]};
  if (n.size() == 4) out.centre_h = {n[1], n[2], n[3]};
  return out;
}
[[nodiscard]] inline std::string weight_error(const std::string& text) {
  if (weight_of(text)) return {};
  return "'" + text + "' is not KG or KG,X,Y,Z with a mass above zero";
}

/// Transient of a first touch: AMPLITUDE[,HZ[,DECAY]], N for each m/s, Hz and s.
[[nodiscard]] inline std::optional<transient_settings> transient_of(const std::string& text) {
  const std::vector<double> n = numbers_of(text, 3);
  if (n.empty() || !(n[0] > 0.0)) return std::nullopt;
  transient_settings out{.amplitude_n_s_per_m = n[0]};
  if (n.size() > 1) out.frequency_hz = n[1];
  if (n.size() > 2) out.decay_s = n[2];
  if (!asperity::check(out)) return std::nullopt;
  return out;
}
[[nodiscard]] inline std::string transient_error(const std::string& text) {
  if (transient_of(text)) return {};
  return "'" + text + "' is not AMPLITUDE[,HZ[,DECAY]] with up to 100 N for each m/s, 20 to 1000 Hz, 0.001 to 0.2 s";
}

/// A whole number, zero or larger, that fits 64 bits.
[[nodiscard]] inline std::string whole_number_error(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed == std::errc() && end == text.data() + text.size()) return {};
  return "'" + text + "' is not a whole number from 0 to 18446744073709551615";
}

/// A file name with one of these extensions, lower or upper case.
[[nodiscard]] inline std::string extension_error(const std::string& text,
                                                 std::initializer_list<std::string_view> allowed) {
  std::string extension = std::filesystem::path(text).extension().string();
  std::string list;
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  for (const std::string_view one : allowed) {
    if (extension == one) return {};
    list += (list.empty() ? "" : " or ") + std::string(one);
  }
  return "'" + text + "' has to end in " + list;
}

}  // namespace asperity::command
