// What a device can do, as part of a document.
#pragma once

#include "asperity/device/capabilities.hpp"
#include "cli.hpp"

namespace asperity::command {

/// SI.
[[nodiscard]] json to_json(const device_capabilities& c);

}  // namespace asperity::command
