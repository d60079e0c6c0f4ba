// A contact on its way through a tick.
#pragma once

#include <array>
#include <cstdint>

#include "asperity/core/pose.hpp"
#include "tile_writer.hpp"

namespace asperity::gl {

/// Levels of a depth buffer of so many bits, and what they say.
struct depth_levels {
  static constexpr std::uint32_t none = 0;   ///< no sample
  static constexpr std::uint32_t below = 1;  ///< below the range
  static constexpr std::uint32_t first = 2;  ///< the range's lowest difference
  std::uint32_t bits = 16;
  [[nodiscard]] std::uint32_t top() const noexcept { return (1U << bits) - 1; }  ///< above the range
  [[nodiscard]] std::uint32_t last() const noexcept { return top() - 1; }        ///< the range's highest difference
};

/// The eleven configurations of the paper, the probe at rest first, and the same again without the outermost samples.
inline constexpr std::size_t configurations = 11;
inline constexpr std::size_t searches = configurations + 1;

struct contact_slot {
  std::uint32_t contact = 0;    ///< index in the call
  double half_m = 0.0;          ///< half size of its window
  height_range a{}, b{};        ///< heights that the tiles can hold
  bool visible = false;         ///< something may be seen of both bodies
  std::uint32_t outermost = 0;  ///< rings of samples, from the window's border, until one has a sample of both bodies
  std::uint32_t samples = 0;    ///< that both bodies have; 0: no overlap
  bool bad_texel = false;
  double step_m = 0.0, step_rad = 0.0;
  double low_m = 0.0, quantum_m = 0.0;  ///< difference of depth_levels::first, and between two levels
  std::array<std::uint32_t, searches> level{};
};

}  // namespace asperity::gl
