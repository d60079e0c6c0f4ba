// What the bodies of a session feel of the probe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

/// The push of the probe on one body: the opposite of what the body does to the probe, friction included.
struct body_wrench {
  std::uint32_t body = 0;  ///< index in scene::fixed
  wrench on_body_w{};      ///< world axes, torque about the felt_bodies' point_w
};

/// What bodies felt in one device period, the mean over its substeps: times the period it is the impulse. A body that
/// is not listed felt nothing. For a body's own motion take the torque about its centre of mass c_B:
///
///     const wrench about_c_b = transport(felt.list[i].on_body_w, felt.point_w, c_b_w);
struct felt_bodies {
  static constexpr std::size_t most = 32;

  std::int64_t time_ns = 0;  ///< of the device tick, on the session's clock
  vec3 point_w{0.0};         ///< the probe's centre of mass c_A, which all torques are about
  fixed_vector<body_wrench, most> list;

  /// Adds to what a body feels. @return false where there is no more room   @rt safe
  bool add(std::uint32_t body, const wrench& on_body_w) noexcept {
    body_wrench* const known =
        std::find_if(list.begin(), list.end(), [&](const body_wrench& b) { return b.body == body; });
    if (known != list.end()) {
      known->on_body_w += on_body_w;
      return true;
    }
    return list.push_back({body, on_body_w});
  }
  /// What a body feels; zero where it is not listed. @rt safe
  [[nodiscard]] wrench on(std::uint32_t body) const noexcept {
    const body_wrench* const known =
        std::find_if(list.begin(), list.end(), [&](const body_wrench& b) { return b.body == body; });
    return known == list.end() ? wrench{} : known->on_body_w;
  }
};

}  // namespace asperity
