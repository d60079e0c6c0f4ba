// The bake report as the extension's JSON. The reader takes it apart again in textured_model_reader.cpp.
#pragma once

#include <tiny_gltf.h>

#include "asperity/model/bake_report.hpp"

namespace asperity::io {

/// All fields under the names of docs/reference/asset-format.md.
[[nodiscard]] tinygltf::Value::Object report_object(const bake_report& report);

/// False where a number is NaN or infinite: JSON has no such numbers.
[[nodiscard]] bool has_finite_figures(const bake_report& report);

}  // namespace asperity::io
