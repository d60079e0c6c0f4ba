// The window seen from a body, and the grid of samples in it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asperity/core/pose.hpp"
#include "asperity/render/contact.hpp"

namespace asperity::detail {

/// Maps body coordinates to window coordinates (u, v, h): position across the window and height along n, metres,
/// all from the window's centre.
struct window_map {
  vec3 u_b, v_b, n_b;  ///< window axes in the body frame
  vec3 origin;         ///< window coordinates of the body's origin

  window_map(const contact_window& w, const pose& T_wb) noexcept {
    const quat to_body = glm::conjugate(T_wb.rotation);
    u_b = to_body * w.u_w;
    v_b = to_body * w.v_w;
    n_b = to_body * w.n_ab_w;
    const vec3 offset = T_wb.position - w.centre_w;
    origin = {glm::dot(w.u_w, offset), glm::dot(w.v_w, offset), glm::dot(w.n_ab_w, offset)};
  }

  [[nodiscard]] vec3 point(const vec3& p_b) const noexcept { return origin + direction(p_b); }
  [[nodiscard]] vec3 direction(const vec3& d_b) const noexcept {
    return {glm::dot(u_b, d_b), glm::dot(v_b, d_b), glm::dot(n_b, d_b)};
  }
};

/// World point of window coordinates.
[[nodiscard]] inline vec3 to_world(const contact_window& w, const vec3& uvh) noexcept {
  return w.centre_w + uvh.x * w.u_w + uvh.y * w.v_w + uvh.z * w.n_ab_w;
}

/// World direction of a direction in window coordinates.
[[nodiscard]] inline vec3 direction_to_world(const contact_window& w, const vec3& uvh) noexcept {
  return uvh.x * w.u_w + uvh.y * w.v_w + uvh.z * w.n_ab_w;
}

/// N x N samples at the centres of the cells that tile the window. They are fixed in the world while the probe moves,
/// so that every depth is a function of the pose alone.
/// @source science, section 2
struct sample_grid {
  std::uint32_t side;  ///< samples per side
  double half_m;       ///< half size of the window
  double pitch_m;      ///< distance between samples

  sample_grid(std::uint32_t samples, double half_size_m) noexcept
      : side(samples), half_m(half_size_m), pitch_m(2.0 * half_size_m / samples) {}

  [[nodiscard]] double coordinate(std::size_t i) const noexcept {
    return (static_cast<double>(i) + 0.5) * pitch_m - half_m;
  }
  [[nodiscard]] std::size_t index(std::size_t column, std::size_t row) const noexcept { return row * side + column; }
  [[nodiscard]] vec2 position(std::size_t index) const noexcept {
    return {coordinate(index % side), coordinate(index / side)};
  }
  [[nodiscard]] std::size_t size() const noexcept { return std::size_t{side} * side; }
  [[nodiscard]] double cell_m2() const noexcept { return pitch_m * pitch_m; }

  /// First sample at or beyond x, at least 0 and at most `side`.
  [[nodiscard]] std::size_t first_at(double x) const noexcept { return clamp(std::ceil((x + half_m) / pitch_m - 0.5)); }
  /// One past the last sample at or before x, at least 0 and at most `side`.
  [[nodiscard]] std::size_t end_at(double x) const noexcept {
    return clamp(std::floor((x + half_m) / pitch_m - 0.5) + 1.0);
  }

 private:
  [[nodiscard]] std::size_t clamp(double i) const noexcept {
    return i > 0.0 ? (i < side ? static_cast<std::size_t>(i) : side) : 0;
  }
};

}  // namespace asperity::detail
