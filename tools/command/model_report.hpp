// A textured model in numbers: what bake and inspect tell about it.
#pragma once

#include <string>
#include <vector>

#include "asperity/model/textured_model.hpp"
#include "cli.hpp"

namespace asperity::command {

/// Counts, sizes, mass properties and the bake's report. SI.
[[nodiscard]] json describe(const textured_model& model);

/// The same for a person.
[[nodiscard]] std::string describe_text(const textured_model& model);

/// What deserves a second look before the model is used, one sentence each.
[[nodiscard]] std::vector<std::string> warnings(const textured_model& model);

/// Lines of warnings for a person; empty where there are none.
[[nodiscard]] std::string warnings_text(const std::vector<std::string>& warnings);

/// Is a diagonal within what a body to be felt may measure? What is not is a mix-up of units, most likely.
[[nodiscard]] constexpr bool is_sensible_size(double diagonal_m) noexcept {
  return diagonal_m >= 1e-3 && diagonal_m <= 10.0;
}

/// The same range in words.
[[nodiscard]] inline const char* sensible_sizes() noexcept { return "1 mm to 10 m"; }

[[nodiscard]] inline json to_json(const vec3& v) { return json::array({v.x, v.y, v.z}); }

}  // namespace asperity::command
