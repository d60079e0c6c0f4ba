// Where two bodies are close at a pose; the pivot of ways out is the middle of that.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/core/math.hpp"
#include "least_motion/field_bounds.hpp"
#include "least_motion/meeting.hpp"
#include "least_motion/pivot.hpp"

namespace asperity::exits {

/// Adds the close ones of the branches of a fixed size, as points. The branches are the same at every pose.
/// @param most_relief_m no sample has more   @param size_m of the branches   @param count of readings
/// @rt safe
inline void add_close(const meeting& m, const vec3& centre_w, double most_relief_m, double size_m, reading_count& count,
                      pivot_sum& sum) noexcept {
  const std::span<const branch> branches = m.of_x->marks.branches();
  if (branches.empty()) return;
  const detail::coarse_grid& grid = m.in_y->body->field.smooth;
  // By S alone: the slope that notches add does not depend on how close the bodies are.
  const double steepest = m.in_y->bounds.steepest_of_smooth();
  const mat3 to_w = glm::transpose(m.motion_y), turn_wx = glm::mat3_cast(m.T_wx.rotation);
  std::array<std::uint32_t, 64> waiting;
  std::size_t n = 0;
  waiting[n++] = 0;
  while (n > 0) {
    const std::uint32_t i = waiting[--n];
    const branch& b = branches[i];
    const double radius_m = static_cast<double>(b.radius_m);
    const double reach_m = 1.5 * steepest * std::max(size_m, radius_m) + most_relief_m;
    const vec3 c_y = m.turn_yx * vec3(b.centre_b) + m.shift_y;
    if (radius_m > size_m && b.right != 0) {
      if (m.in_y->bounds.most_by_table(c_y, radius_m) > -reach_m) {
        waiting[n++] = i + 1;
        waiting[n++] = b.right;
      }
      continue;
    }
    if (m.in_y->bounds.most_by_table(c_y, 0.0) <= -reach_m || grid.value_m(c_y) <= -reach_m) continue;
    ++count.spent;
    const coarse_reading s = grid.read(c_y);
    const double across_m = std::max(radius_m, 0.25 * size_m);
    sum.add(across_m * across_m, reach_m, s.value_m, to_w * s.slope,
            turn_wx * vec3(b.centre_b) + m.T_wx.position - centre_w, m.of_probe);
  }
}

}  // namespace asperity::exits
