// An image that describes a surface: a height map or a normal map, as it comes from a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace asperity {

/// Pixels of a map, row by row from the image's first row, which is v = 0 (glTF convention). Pixel (i, j) is centred at
/// texture coordinates ((i + 1/2) / width, (j + 1/2) / height).
struct map_image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t channels = 0;  ///< 1: grey, 3: red, green, blue
  std::uint32_t bits = 0;      ///< per sample in the file; 0 where it held floating-point numbers
  /// channels * width * height samples. Whole numbers of a file are mapped to [0, 1]; floating-point ones stay.
  std::vector<float> samples;

  [[nodiscard]] float at(std::uint32_t i, std::uint32_t j, std::uint32_t channel) const noexcept {
    return samples[(std::size_t{j} * width + i) * channels + channel];
  }
};

/// What a map shows beyond its border.
enum class map_wrap : std::uint8_t {
  repeat,    ///< the map again; what mesh formats mean where they do not say
  clamp,     ///< the nearest pixel of its border
  mirrored,  ///< the map again, mirrored in every second tile
};

}  // namespace asperity
