// The host's share of the heights, in double precision: coarse triangles become records of numbers around the window,
// cut to the window's tile.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/model/scene.hpp"
#include "asperity/window/window_depth_settings.hpp"
#include "displacement_bounds.hpp"
#include "window/height_field.hpp"
#include "window/pair_scale.hpp"

namespace asperity::gl {

/// A triangle as height_vertex.glsl reads it. Lengths in half sizes of the window.
struct triangle_record {
  std::array<std::array<float, 2>, 7> corner;  ///< outline within the tile, pixels
  std::array<float, 2> tile;                   ///< first pixel of the tile
  std::array<float, 4> edge_0, edge_1, edge_2, texel_x, texel_y, axis, near;
};
static_assert(sizeof(triangle_record) == 44 * sizeof(float));

/// Records of triangles in mapped memory. Writing past the end is counted, not done.
struct record_list {
  std::span<triangle_record> memory;
  std::size_t used = 0;
  void add(const triangle_record& r) noexcept {
    if (used < memory.size()) memory[used] = r;
    ++used;
  }
  [[nodiscard]] bool overflowed() const noexcept { return used > memory.size(); }
};

/// Heights that a patch can reach in a window, m.
struct height_range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void include(double a, double b) noexcept {
    low = std::min(low, a);
    high = std::max(high, b);
  }
};

class tile_writer {
 public:
  /// Takes all memory that a tick needs. @pre cpu_depth finds nothing wrong with scene and settings
  /// @param margin  samples around the window that tiles have
  tile_writer(scene s, const window_depth_settings& settings, std::uint32_t margin, bool packed);

  [[nodiscard]] const scene& bodies() const noexcept { return scene_; }
  [[nodiscard]] const window_depth_settings& settings() const noexcept { return settings_; }
  [[nodiscard]] const detail::pair_scale& pair(std::size_t body) const noexcept { return pairs_[body]; }
  /// True where the probe or this fixed body has a texel that is no position.
  [[nodiscard]] bool has_bad_texels(std::size_t body) const noexcept { return bad_[0] || bad_[body + 1]; }
  [[nodiscard]] std::uint32_t margin() const noexcept { return margin_; }
  /// Samples per side of a tile of heights, margin included.
  [[nodiscard]] std::uint32_t tile_samples() const noexcept { return settings_.grid + 2 * margin_; }
  /// Quarters that are drawn one after the other: 4 where tiles are packed.
  [[nodiscard]] std::size_t quarters() const noexcept { return packed_ ? 4 : 1; }

  /// Adds the triangles of a patch that the window sees, to a list per quarter.
  /// @param body_index  0 the probe, then the fixed bodies
  /// @return heights that were added   @rt safe
  height_range add(std::span<record_list> lists, std::size_t body_index, std::span<const std::uint32_t> patch,
                   const contact_window& window, const pose& T_w_body, std::array<std::uint32_t, 2> tile) noexcept;

  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  void write(std::span<record_list> lists, const detail::projected_triangle& t, const triangle_record& common,
             detail::layer which, double half_m) const noexcept;
  [[nodiscard]] bool include(height_range& to, const detail::projected_triangle& t,
                             const displacement_box& displacement, const vec3& n_b, double reach_m) const noexcept;

  scene scene_;
  window_depth_settings settings_;
  std::uint32_t margin_;
  bool packed_;
  std::vector<detail::surface_index> indices_;                ///< the probe, then the fixed bodies
  std::vector<std::vector<displacement_box>> displacements_;  ///< likewise
  std::vector<char> bad_;                                     ///< likewise
  std::vector<detail::pair_scale> pairs_;                     ///< probe against each fixed body
  detail::patch_projection patch_;
};

}  // namespace asperity::gl
