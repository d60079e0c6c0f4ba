// A picture of the relief, so that a viewer that knows nothing of haptics still shows what is on the surface.
#pragma once

#include <string>

#include "asperity/model/textured_model.hpp"

namespace asperity::io {

/// Grey PNG in the model's texture coordinates: mid grey on the coarse surface, lighter above it, darker below; at most
/// 256 pixels a side. @pre validate(model)
[[nodiscard]] std::string relief_png(const textured_model& model);

}  // namespace asperity::io
