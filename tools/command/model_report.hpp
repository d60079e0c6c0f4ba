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

[[nodiscard]] inline json to_json(const vec3& v) { return json::array({v.x, v.y, v.z}); }

}  // namespace asperity::command
