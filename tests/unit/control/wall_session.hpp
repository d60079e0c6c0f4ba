// A session on the virtual clock with a wall that is known in closed form, and everything that it told.
#pragma once

#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "unit/control/analytic_wall.hpp"

namespace asperity::test_support {

inline constexpr std::int64_t ms = 1'000'000;

struct keep_all {
  std::vector<session_record>* to;
  void operator()(const session_record& r) noexcept { to->push_back(r); }
};

/// A hand that presses onto the wall at z = 0 and reaches it after about 0.2 s.
inline simulated_settings pressing_hand() {
  simulated_settings c;
  c.motion = {.T_dh = {quat(1, 0, 0, 0), {0, 0, 0.005}}, .depth_m = 0.015, .approach_s = 0.4};
  return c;
}

struct wall_session {
  std::vector<session_record> log;
  simulated_device dev;
  virtual_session<analytic_wall, simulated_device, keep_all> session;

  explicit wall_session(const simulated_settings& hand, const control_settings& control = {},
                        const analytic_wall& wall = {})
      : dev(hand), session(wall, {{pose{}}, vec3(0.0)}, opened(dev), control, {}, keep_all{&log}) {}

  static simulated_device& opened(simulated_device& d) {
    EXPECT_TRUE(d.open() && d.arm());
    return d;
  }
  void run_ms(int n) {
    for (int i = 0; i < n; ++i) static_cast<void>(session.step());
  }
  [[nodiscard]] const session_record& last() const { return log.back(); }
};

inline double force_of(const session_record& r) { return glm::length(r.on_hand_d.force); }

}  // namespace asperity::test_support
