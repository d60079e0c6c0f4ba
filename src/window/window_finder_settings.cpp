#include <algorithm>

#include "asperity/window/convex_piece_finder.hpp"

namespace asperity {

window_finder_settings resolve(window_finder_settings s, const textured_model& a, const textured_model& b) noexcept {
  const double diagonal = std::min(a.box.diagonal(), b.box.diagonal());
  const auto thinnest = [](const bounds& box) {
    const vec3 size = box.high - box.low;
    return std::min(size.x, std::min(size.y, size.z));
  };
  if (s.tolerance_m <= 0.0) {
    s.tolerance_m = a.report.max_displacement_m + b.report.max_displacement_m + 0.005 * diagonal;
  }
  if (s.max_depth_m <= 0.0) s.max_depth_m = std::min(0.5 * (thinnest(a.box) + thinnest(b.box)), 0.1 * diagonal);
  if (s.min_half_size_m <= 0.0) s.min_half_size_m = s.tolerance_m;
  if (s.max_half_size_m <= 0.0) s.max_half_size_m = std::max(0.5 * diagonal, s.min_half_size_m);
  return s;
}

}  // namespace asperity
