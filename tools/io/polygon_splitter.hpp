// Splits polygons into triangles, in a time that grows with their corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "corner_grid.hpp"
#include "reading_watch.hpp"

namespace asperity::io {

/// Cuts ears: every corner stays used and every side of the polygon is a side of one triangle, whatever its shape.
class polygon_splitter {
 public:
  /// @pre the positions outlive the splitter
  explicit polygon_splitter(const std::vector<vec3>& positions) noexcept : positions_(positions) {}

  /// @return false for a concave polygon whose ears are so hard to find that the work would not stay in proportion to
  ///         its corners: long spirals, and polygons that cross themselves all over
  [[nodiscard]] bool split(std::span<const std::uint32_t> polygon, reading_watch& watch);

  /// Of the last polygon, as places in it (not vertices).
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& triangles() const noexcept { return triangles_; }

 private:
  void project(std::span<const std::uint32_t> polygon);
  [[nodiscard]] bool is_convex() const noexcept;
  [[nodiscard]] bool cut_ears(reading_watch& watch);
  [[nodiscard]] bool is_ear(std::uint32_t corner);
  void use_grid(std::uint32_t any_corner);
  [[nodiscard]] std::vector<std::uint32_t> ring(std::uint32_t any_corner) const;

  const std::vector<vec3>& positions_;
  std::vector<vec2> flat_;                      // of the polygon, in its plane, counter-clockwise
  std::vector<std::uint32_t> next_, previous_;  // of the corners that are left, round the polygon
  std::size_t left_ = 0;
  std::vector<std::uint32_t> to_look_at_;
  corner_grid grid_;  // of corners, those that were left when it was made
  std::size_t in_grid_ = 0;
  std::size_t work_ = 0;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace asperity::io
