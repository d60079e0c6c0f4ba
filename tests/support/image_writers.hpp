// Image files for tests, made in memory by the formats' own libraries.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace asperity::test_support {

/// A grey PNG, compressed, of 8 or 16 bits: a bumpy surface.
[[nodiscard]] std::string compressed_png_bytes(std::uint32_t width, std::uint32_t height, bool deep);

/// A grey PNG of 8 or 16 bits, high byte first. @param row  the bytes of a row, asked for once per pass
[[nodiscard]] std::string grey_png_bytes(std::uint32_t width, std::uint32_t height, bool deep, bool interlaced,
                                         const std::function<const unsigned char*(std::uint32_t)>& row);

/// A PNG in one grey of 8 or 16 bits: a thousandth of its pixels in bytes.
[[nodiscard]] std::string flat_png_bytes(std::uint32_t width, std::uint32_t height, bool deep, bool interlaced = false);

/// How a TIFF keeps its samples; heights of a bumpy surface.
struct tiff_layout {
  std::uint32_t width = 40, height = 24;
  std::uint16_t bits = 16;        ///< 8, 16; 32 is float
  std::uint16_t channels = 1;     ///< 1 or 3
  std::uint16_t compression = 1;  ///< as TIFF numbers them: 1 none, 5 LZW, 8 deflate, 32773 PackBits
  std::uint32_t tile = 0;         ///< side of a tile, a multiple of 16; 0: strips of 8 rows
  bool big_endian = false;
};
[[nodiscard]] std::string tiff_bytes(const tiff_layout& layout);

/// An EXR of float channels with these names, interleaved values; `compression` as OpenEXR numbers them (0 none, 3
/// ZIP).
[[nodiscard]] std::string exr_bytes(int width, int height, const std::vector<std::string>& channels,
                                    const std::vector<float>& values, int compression = 3);

/// A colour ramp: red 128, green the column, blue 250.
[[nodiscard]] std::string jpeg_bytes(int width, int height, int quality, bool progressive = false, bool grey = false);

}  // namespace asperity::test_support
