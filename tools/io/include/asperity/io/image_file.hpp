// Reading the images that describe a surface: height maps and normal maps. Component asperity::io.
#pragma once

#include <filesystem>
#include <functional>

#include "asperity/core/status.hpp"
#include "asperity/model/map_image.hpp"

namespace asperity::io {

/// Largest side of an image, pixels, and the most samples (pixels times channels) of one: 8192 x 8192 in grey.
inline constexpr std::uint32_t max_image_side = 16384;
inline constexpr std::size_t max_image_samples = std::size_t{1} << 26;

/// Image of a file, whose format is recognised by its first bytes:
/// - PNG: 1 to 16 bits per sample, grey, colour or palette, interlaced or not;
/// - TIFF: its first image, grey or RGB with the channels interleaved, 8 or 16 bits or float32, in strips or tiles,
///   uncompressed, LZW, Deflate or PackBits;
/// - OpenEXR: one flat part in scan lines or tiles, half or float, uncompressed, RLE, ZIP, ZIPS or PIZ;
/// - JPEG: grey or colour of 8 bits, baseline or progressive.
/// An alpha channel is left out; samples are taken as they stand, without any colour management.
/// Takes time in proportion to the file and the pixels that it holds, and memory for four times the file and 512 MiB at
/// the most.
/// @param keep_going asked at least ten times a second, on this thread; false ends the reading
/// @return io_failed | bad_format (truncated, damaged, not finite) | unsupported | limit_exceeded | cancelled, with the
///         fault
[[nodiscard]] result<map_image> load_image(const std::filesystem::path& file,
                                           const std::function<bool()>& keep_going = {});

}  // namespace asperity::io
