// What happens in one simulated session, drawn from its seed before the session begins.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "asperity/control/device_loop.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "session/simulation/dice.hpp"
#include "session/simulation/scenes.hpp"

namespace asperity::simulation {

/// What can go wrong outside the device, which has a script of its own (device_fault).
enum class trouble_kind : std::uint8_t {
  nan_wrench,        ///< the renderer answers NaN
  infinite_wrench,   ///< ... or infinity
  enormous_wrench,   ///< ... or 1e300 N
  leaping_wrench,    ///< ... or a new wrench of up to 100 N in every tick
  growing_contact,   ///< ... or a stiffness of the wrong sign: the contact pulls the harder the farther the probe is
  refusing,          ///< ... or that it cannot answer
  contact_stalled,   ///< the contact thread does nothing
  contact_withheld,  ///< the contact thread computes and hands nothing over
  stamp_zero,        ///< samples say that they are from the beginning of time
  stamp_future,      ///< ... from an hour ahead
  stamp_lowest,      ///< ... from as long ago as a number can say
  stamp_highest,     ///< ... from as far ahead
};
inline constexpr std::size_t trouble_kind_count = 12;
inline constexpr std::size_t device_fault_kind_count = 8;

/// A trouble and when, in time since the session's beginning.
struct trouble {
  trouble_kind kind = trouble_kind::refusing;
  std::int64_t from_ns = 0;
  std::int64_t until_ns = 0;  ///< not included
};

/// How punctual the device thread is, and how good its clock.
struct clock_manners {
  double late = 0.0;  ///< probability that a tick comes late, by up to 60 periods
  double twin = 0.0;  ///< ... that it comes at the same time as the one before
  double back = 0.0;  ///< ... that the clock was set back, by up to 200 ms
};

struct scenario {
  std::uint64_t seed = 0;
  simulated_settings device{};
  control_settings control{};
  std::int64_t start_ns = 0;  ///< what the clock says at the beginning
  std::int64_t length_ns = 1'000'000'000;
  std::int64_t device_period_ns = 1'000'000;
  std::int64_t contact_period_ns = 1'000'000;
  bool contact_one_period_late = false;
  clock_manners clock{};
  std::vector<trouble> troubles{};
  double person_looks = 0.0;    ///< probability per tick that a person mends what is wrong
  double person_meddles = 0.0;  ///< ... that a person stops, disarms or closes without need
  bool textured = false;        ///< textured models; otherwise the analytic wall
  std::size_t textured_scene = 0;
  double stiffness_n_per_m = 2000.0;
  double arm_m = 0.0;      ///< of the analytic wall
  bool linearised = true;  ///< of the analytic wall
};

namespace detail {

inline void draw_contact(dice& d, scenario& s) {
  s.textured = d.chance(0.15);
  s.textured_scene = d.below(textured_scene_count);
  s.stiffness_n_per_m = d.log_between(200.0, s.textured ? 4000.0 : 20000.0);
  s.arm_m = d.between(0.0, 0.03);
  s.linearised = d.chance(0.7);
}

inline void draw_hand(dice& d, scenario& s) {
  constexpr std::array kinds{motion_kind::press, motion_kind::scrub, motion_kind::twist, motion_kind::free};
  motion_settings& m = s.device.motion;
  m.kind = kinds[d.below(kinds.size())];
  const double gap = d.between(-0.001, 0.004);
  m.T_dh.position = {d.between(-0.01, 0.01), d.between(-0.01, 0.01),
                     (s.textured ? touch_height_m(s.textured_scene) : 0.0) + gap};
  m.depth_m = d.between(0.001, 0.02);
  m.approach_s = d.between(0.02, 0.4);
  m.amplitude_m = d.between(0.0, 0.01);
  m.amplitude_rad = d.between(0.0, 0.3);
  m.frequency_hz = d.log_between(0.5, 12.0);

  hand_settings& h = s.device.hand;
  const bool firm = d.chance(0.5);
  h.stiffness_n_per_m = firm ? d.log_between(500.0, 5000.0) : d.log_between(20.0, 500.0);
  h.damping_n_s_per_m = firm ? d.between(5.0, 40.0) : d.between(0.2, 8.0);
  h.stiffness_n_m_per_rad = firm ? d.between(1.0, 10.0) : d.between(0.05, 2.0);
  h.damping_n_m_s_per_rad = d.log_between(1e-3, 0.1);
  h.tremor_m = d.chance(0.7) ? d.log_between(1e-6, 1e-3) : 0.0;
}

inline void draw_device(dice& d, scenario& s) {
  plant_settings& p = s.device.plant;
  p.mass_kg = d.log_between(0.05, 0.5);
  p.inertia_kg_m2 = d.log_between(5e-5, 1e-3);
  p.damping_n_s_per_m = d.log_between(0.1, 5.0);

  device_capabilities& c = s.device.capabilities;
  c.moving_mass_kg = p.mass_kg * d.between(0.5, 1.0);  // a data sheet that says too much would make damping unstable
  c.moving_inertia_kg_m2 = p.inertia_kg_m2 * d.between(0.5, 1.0);
  c.peak_force_n = d.log_between(1.0, 40.0);
  c.continuous_force_n = c.peak_force_n * d.between(0.2, 1.0);
  c.force_slew_n_per_s = d.log_between(300.0, 20000.0);
  c.peak_torque_n_m = d.log_between(0.02, 2.0);
  c.continuous_torque_n_m = c.peak_torque_n_m * d.between(0.2, 1.0);
  c.torque_slew_n_m_per_s = d.log_between(20.0, 1000.0);

  measurement_settings& m = s.device.measurement;
  m.position_resolution_m = d.chance(0.8) ? d.log_between(1e-7, 5e-5) : 0.0;
  m.rotation_resolution_rad = d.chance(0.8) ? d.log_between(1e-6, 1e-3) : 0.0;
  if (d.chance(0.4)) {
    m.delay_ns = d.between_ns(0.05, 3.0);
    m.jitter_ns = d.between_ns(0.0, 1.0);
  }
}

inline void draw_loops(dice& d, scenario& s) {
  s.device_period_ns = static_cast<std::int64_t>(d.log_between(500'000.0, 5'000'000.0));
  s.contact_period_ns = static_cast<std::int64_t>(d.log_between(500'000.0, 5'000'000.0));
  s.contact_one_period_late = d.chance(0.5);
  if (d.chance(0.3)) {
    s.clock.late = d.log_between(1e-3, 0.05);
    s.clock.twin = d.log_between(1e-3, 0.05);
    s.clock.back = d.chance(0.5) ? d.log_between(1e-3, 0.02) : 0.0;
  }
  s.start_ns = d.chance(0.5) ? 0 : static_cast<std::int64_t>(d.below(std::size_t{1} << 60));
  s.length_ns = d.between_ns(600.0, 1400.0);

  control_settings& c = s.control;
  c.coupling.stiffness_n_per_m = d.log_between(100.0, 1500.0);
  c.coupling.stiffness_n_m_per_rad = d.log_between(0.3, 5.0);
  c.probe.mass_kg = d.log_between(0.004, 0.04);
  c.substeps = 1 + static_cast<int>(d.below(6));
  if (d.chance(0.5)) {
    c.limits.peak_force_n = d.log_between(0.5, 20.0);
    c.limits.peak_torque_n_m = d.log_between(0.02, 1.0);
    c.limits.force_slew_n_per_s = d.log_between(300.0, 20000.0);
  }
}

inline void draw_faults(dice& d, scenario& s) {
  const auto when = [&] {
    const std::int64_t from_ns = d.between_ns(0.0, 1e-6 * static_cast<double>(s.length_ns));
    return std::array{from_ns, from_ns + d.between_ns(0.1, d.chance(0.5) ? 4.0 : 150.0)};
  };
  if (d.chance(0.6)) {
    const std::size_t n = 1 + d.below(4);
    for (std::size_t i = 0; i < n; ++i) {
      const auto kind = static_cast<device_fault>(d.below(device_fault_kind_count));
      const auto [from_ns, until_ns] = when();
      s.device.faults.push_back({kind, s.start_ns + from_ns, s.start_ns + until_ns});
    }
  }
  if (d.chance(0.6)) {
    const std::size_t n = 1 + d.below(4);
    for (std::size_t i = 0; i < n; ++i) {
      const auto kind = static_cast<trouble_kind>(d.below(trouble_kind_count));
      const auto [from_ns, until_ns] = when();
      s.troubles.push_back({kind, from_ns, until_ns});
    }
  }
  s.person_looks = d.chance(0.7) ? d.log_between(0.003, 0.1) : 0.0;
  s.person_meddles = d.chance(0.2) ? d.log_between(0.001, 0.02) : 0.0;
}

}  // namespace detail

/// Everything about the session of this seed.
[[nodiscard]] inline scenario make_scenario(std::uint64_t seed) {
  dice d(seed);
  scenario s;
  s.seed = seed;
  s.device.seed = d.bits();
  detail::draw_contact(d, s);
  detail::draw_hand(d, s);
  detail::draw_device(d, s);
  detail::draw_loops(d, s);
  detail::draw_faults(d, s);
  return s;
}

}  // namespace asperity::simulation
