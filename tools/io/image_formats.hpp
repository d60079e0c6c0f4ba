// One decoder per image format. Each gets the file's bytes, its name for messages, and whom to ask whether to go on.
// Each reads row by row, or piece by piece, and throws rejection where the watch does.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/model/map_image.hpp"
#include "reading_watch.hpp"

namespace asperity::io {

[[nodiscard]] result<map_image> decode_png(std::string_view bytes, const std::filesystem::path& file,
                                           reading_watch& watch);
[[nodiscard]] result<map_image> decode_tiff(std::string_view bytes, const std::filesystem::path& file,
                                            reading_watch& watch);
[[nodiscard]] result<map_image> decode_exr(std::string_view bytes, const std::filesystem::path& file,
                                           reading_watch& watch);
[[nodiscard]] result<map_image> decode_jpeg(std::string_view bytes, const std::filesystem::path& file,
                                            reading_watch& watch);

/// One byte a pixel, grey, as PNG, row by row. @pre bytes.size() == width * height, neither of them 0
[[nodiscard]] std::string encode_grey_png(std::uint32_t width, std::uint32_t height, std::string_view bytes);

/// The image in these bytes, whose first ones tell its format.
[[nodiscard]] result<map_image> decode_image(std::string_view bytes, const std::filesystem::path& file,
                                             reading_watch watch = {});

/// An image without samples yet, where its size is within the limits and `bytes` bytes of file can hold it. The last is
/// asked because a size in a header costs nothing to write: memory is taken only for what can be there.
/// @param most_per_byte samples that one byte of the format can stand for, at its best compression
/// @return bad_format (no pixels, or more than the file can hold) | limit_exceeded
[[nodiscard]] result<map_image> sized_image(std::size_t width, std::size_t height, std::uint32_t channels,
                                            std::size_t bytes, std::size_t most_per_byte,
                                            const std::filesystem::path& file);

/// Makes room for the samples of further rows: twice as much each time, never more than the whole image takes. A file
/// that ends early has taken no memory for what it does not hold.
void reserve_row(map_image& image, std::size_t samples);

/// @return bad_format where a floating-point sample is not finite, with its place
[[nodiscard]] result<map_image> finite_image(map_image&& image, const std::filesystem::path& file);

/// A reason as a library gives it, as it may stand in a message: one printable line.
[[nodiscard]] std::string plain_reason(std::string_view text);

}  // namespace asperity::io
