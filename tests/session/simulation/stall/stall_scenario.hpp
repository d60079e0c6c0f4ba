// One session with stalls, drawn from its seed before it begins.
#pragma once

#include <cstdint>
#include <vector>

#include "asperity/control/control_settings.hpp"
#include "session/simulation/dice.hpp"
#include "session/simulation/stall/scripted_device.hpp"
#include "session/simulation/stall/terrain.hpp"

namespace asperity::simulation {

enum class stalled_thread : std::uint8_t { device, contact, both };
enum class stall_pattern : std::uint8_t { single, periodic, random, overload };

/// A time in which a thread does nothing.
struct stall {
  std::int64_t from_ns = 0;
  std::int64_t until_ns = 0;
};

struct stall_scenario {
  std::uint64_t seed = 0;
  hand_script hand{};
  terrain ground{};
  device_capabilities capabilities{};
  control_settings control{};
  stalled_thread who = stalled_thread::both;
  stall_pattern pattern = stall_pattern::single;
  std::vector<stall> stalls{};        ///< in order, apart
  std::int64_t contact_takes_ns = 0;  ///< from the pose to the hand-over of each contact
  std::int64_t device_period_ns = 1'000'000;
  std::int64_t contact_period_ns = 1'000'000;
  std::int64_t length_ns = 0;
};

namespace detail {

inline void draw_stalls(dice& d, stall_scenario& s) {
  constexpr double ms = 1e6;
  const auto length_ns = [&](double most_ms) { return static_cast<std::int64_t>(ms * d.log_between(1.0, most_ms)); };
  std::int64_t at_ns = d.between_ns(150.0, 400.0);
  const auto add = [&](std::int64_t lasts_ns) {
    s.stalls.push_back({at_ns, at_ns + lasts_ns});
    at_ns += lasts_ns;
  };
  if (s.pattern == stall_pattern::single) {
    add(length_ns(10'000.0));
  } else if (s.pattern == stall_pattern::periodic) {
    const std::int64_t lasts_ns = length_ns(300.0);
    const std::int64_t between_ns = length_ns(100.0);
    for (std::size_t i = 0, n = 2 + d.below(20); i < n; ++i) {
      add(lasts_ns);
      at_ns += between_ns;
    }
  } else if (s.pattern == stall_pattern::overload) {
    const double most_ms = d.log_between(2.0, 30.0);
    const std::int64_t until_ns = at_ns + d.between_ns(500.0, 2500.0);
    while (at_ns < until_ns) {
      add(length_ns(most_ms));
      at_ns += length_ns(3.0);
    }
  } else {
    for (std::size_t i = 0, n = 2 + d.below(20); i < n; ++i) {
      add(length_ns(d.chance(0.1) ? 1000.0 : 60.0));
      at_ns += length_ns(100.0);
    }
  }
  s.length_ns = at_ns + d.between_ns(200.0, 500.0);
}

}  // namespace detail

[[nodiscard]] inline stall_scenario make_stall_scenario(std::uint64_t seed) {
  dice d(seed ^ 0x7374616c6c000000ULL);
  stall_scenario s;
  s.seed = seed;
  s.who = static_cast<stalled_thread>(d.below(3));
  s.pattern = static_cast<stall_pattern>(d.below(4));

  // From a touch to the middle of a body, and hands from slow to as fast as a stroke.
  s.hand.above_m = d.between(0.0, 0.004);
  s.hand.depth_m = d.log_between(0.0005, 0.04);
  s.hand.press_hz = d.log_between(0.2, 3.0);
  s.hand.scrub_m = d.between(0.0, 0.03);
  s.hand.scrub_hz = d.log_between(0.2, 3.0);
  s.hand.axis = d.direction();
  s.hand.turn_rad = d.between(0.0, 0.3);
  s.hand.turn_hz = d.log_between(0.2, 3.0);

  s.ground.stiffness_n_per_m = d.log_between(200.0, 5000.0);
  s.ground.arm_m = d.chance(0.5) ? d.between(0.0, 0.02) : 0.0;
  s.ground.wave_m = d.log_between(0.02, 0.2);
  s.ground.hill_m = d.chance(0.5) ? d.between(0.0, 0.03) * s.ground.wave_m : 0.0;

  device_capabilities& c = s.capabilities;
  c.peak_force_n = d.log_between(1.0, 40.0);
  c.continuous_force_n = c.peak_force_n;
  c.force_slew_n_per_s = d.log_between(100.0, 20'000.0);
  c.peak_torque_n_m = d.log_between(0.05, 2.0);
  c.continuous_torque_n_m = c.peak_torque_n_m;
  c.torque_slew_n_m_per_s = d.log_between(10.0, 1000.0);
  c.device_side_watchdog = true;
  s.control.guard.enabled = d.chance(0.5);  // its scaling can hide what the gap law has to hold by itself

  s.contact_takes_ns = d.chance(0.5) ? d.between_ns(0.0, 10.0) : 0;
  s.contact_period_ns = static_cast<std::int64_t>(d.log_between(1e6, 1e7));
  detail::draw_stalls(d, s);
  return s;
}

}  // namespace asperity::simulation
