// Reading the images that describe a surface: height maps and normal maps. Component asperity::io.
#pragma once

#include <filesystem>

#include "asperity/core/status.hpp"
#include "asperity/model/map_image.hpp"

namespace asperity::io {

/// Largest side of an image, pixels, and the most samples (pixels times channels) of one.
inline constexpr std::uint32_t max_image_side = 16384;
inline constexpr std::size_t max_image_samples = std::size_t{1} << 27;

/// Image of a PNG (1 to 16 bits per sample, palettes too), TIFF (8 and 16 bits, float32), OpenEXR (half, float) or JPEG
/// file, told apart by its first bytes. An alpha channel is left out; samples are taken as they stand, without any
/// colour management.
/// @return io_failed | bad_format (truncated, damaged, not finite) | unsupported | limit_exceeded, with the fault
[[nodiscard]] result<map_image> load_image(const std::filesystem::path& file);

}  // namespace asperity::io
