// Poses as they stand on the command line: "x y z qx qy qz qw", metres and a unit quaternion.
#pragma once

#include <array>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include "asperity/core/pose.hpp"
#include "asperity/core/status.hpp"

namespace asperity::command {

/// Seven numbers separated by blanks, or nothing where the text is anything else. NaN and infinity are numbers here:
/// "is it a pose?" is another question than "can it be read?".
[[nodiscard]] inline std::optional<std::array<double, 7>> read_seven_numbers(std::string_view text) {
  std::array<double, 7> numbers{};
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto skip_blanks = [&] {
    while (at != end && (*at == ' ' || *at == '\t')) ++at;
  };
  for (double& number : numbers) {
    skip_blanks();
    if (at != end && *at == '+') ++at;  // from_chars does not take a plus sign
    const auto [next, failed] = std::from_chars(at, end, number);
    if (failed != std::errc() || (next != end && *next != ' ' && *next != '\t')) return std::nullopt;
    at = next;
  }
  skip_blanks();
  if (at != end) return std::nullopt;
  return numbers;
}

/// For CLI11: empty where the text has the form of a pose, else what is wrong with it.
[[nodiscard]] inline std::string pose_form_error(const std::string& text) {
  if (read_seven_numbers(text)) return {};
  return "'" + text + "' is not a pose: give seven numbers in one argument, \"x y z qx qy qz qw\"";
}

/// The pose, or invalid_argument where a number is not finite or the quaternion is not of unit length.
/// @param option its name, for the message   @pre pose_form_error(text) is empty
[[nodiscard]] inline result<pose> read_pose(std::string_view option, std::string_view text) {
  const auto n = read_seven_numbers(text).value();
  for (const double x : n) {
    if (!std::isfinite(x)) {
      return error{error_code::invalid_argument,
                   std::string(option) + " holds NaN or infinity: every number of a pose must be finite"};
    }
  }
  pose T{quat_from_xyzw({n[3], n[4], n[5], n[6]}), {n[0], n[1], n[2]}};
  if (!is_valid(T)) {
    return error{error_code::invalid_argument, std::string(option) + " has a quaternion of length " +
                                                   std::to_string(glm::length(T.rotation)) +
                                                   " where 1 is needed (order x y z w): divide it by its length"};
  }
  // Within the tolerance a length still differs from 1; the rest of the library may assume that it does not.
  T.rotation = glm::normalize(T.rotation);
  return T;
}

}  // namespace asperity::command
