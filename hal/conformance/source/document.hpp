// The report as text and as JSON.
#pragma once

#include <string>

#include "kit.hpp"

namespace asperity::conformance {

[[nodiscard]] std::string to_text(const report& r);
/// Schema asperity.conformance/1; docs/reference/conformance.md.
[[nodiscard]] std::string to_json(const report& r);

}  // namespace asperity::conformance
