// The haptic texture as an image: what each texel holds, and which texels hold nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/model/textured_model.hpp"
#include "picture/canvas.hpp"
#include "picture/colour.hpp"
#include "picture/surface_panels.hpp"

namespace asperity::picture {

enum class texel_use : std::uint8_t {
  unused,  ///< no surface maps to it
  gutter,  ///< holds a surface point for lookups at the edge of a chart, and lies outside of every chart
  chart,
};

inline constexpr colour unused_texel{0.50F, 0.50F, 0.49F};
inline constexpr colour gutter_texel{0.055F, 0.060F, 0.075F};

/// Every texel of a haptic texture, row-major like the texture.
struct texel_map {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<texel_use> use;
  std::vector<float> heights;  ///< of chart texels over their coarse triangle, along its normal, m; else 0

  [[nodiscard]] std::size_t count(texel_use what) const noexcept;
};

[[nodiscard]] texel_map map_texels(const textured_model& model);

/// A rectangle of texels.
struct texel_window {
  std::size_t left = 0;
  std::size_t top = 0;
  std::size_t width = 0;
  std::size_t height = 0;
};

/// The square of this side (or less, where the texture is smaller) that shows most of all three uses, and relief in
/// many colours of the range.
[[nodiscard]] texel_window informative_window(const texel_map& map, std::size_t side, const value_range& range);

/// The window as an image, first texel at the upper left: heights in colours, gutter and unused texels in greys.
[[nodiscard]] pixmap draw_texels(const texel_map& map, const texel_window& window, const value_range& range,
                                 const colour_scale& scale, std::size_t width, std::size_t height);

}  // namespace asperity::picture
