// A session on the virtual clock against a body of known support planes, judged by the true poses and the true energy.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <utility>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_bodies.hpp"

namespace asperity::test_support {

struct plane_case {
  plane_body body{};
  simulated_settings hand{};
  control_settings control{};
  virtual_schedule schedule{};
  double length_s = 0.9;
  double settled_s = 0.6;  ///< from here on what moves is not meant
};

struct plane_outcome {
  double deepest_m = 0.0;  ///< of the probe in the body, at the ends of device periods
  double settled_deepest_m = 0.0;
  double step_n_per_ms = 0.0;  ///< fastest change of the force on the hand
  double settled_step_n_per_ms = 0.0;
  double surplus_j = 0.0;      ///< most energy that the hand received beyond what it had lent
  double shake_m_per_s = 0.0;  ///< root mean square of the settled handle's speed above 20 Hz
  double unbalanced_n = 0.0;   ///< largest residual of the solver
  int passes = 0;              ///< most passes of the solver
  vec3 force_n{0.0};           ///< mean on the hand, settled
  vec3 contact_n{0.0};         ///< mean on the probe, settled
  vec3 coupling_n{0.0};        ///< mean of the coupling on the probe, settled
  vec3 stretch_m{0.0};         ///< mean way from the probe to its target, settled
  double torque_n_m = 0.0;     ///< largest on the hand
  std::uint64_t not_ok = 0;
  pose T_wa{};  ///< of the probe at the end
};

/// A simulated device that can hold `newtons` for ever, so that no limit takes part in what is measured.
inline device_capabilities strong_device(double newtons) {
  device_capabilities c = simulated_capabilities();
  c.continuous_force_n = c.peak_force_n = 2.0 * newtons;
  c.continuous_torque_n_m = c.peak_torque_n_m = 5.0;
  c.force_slew_n_per_s = 1e5;
  c.torque_slew_n_m_per_s = 1e4;
  return c;
}

/// A hand that comes down from 2 mm above where the probe touches and then presses with this force.
inline simulated_settings hand_that_presses(double newtons, const vec3& touch_d, const vec3& direction_d,
                                            double coupling_n_per_m) {
  simulated_settings c;
  c.capabilities = strong_device(newtons);
  c.hand = {.stiffness_n_per_m = 600,
            .damping_n_s_per_m = 6,
            .stiffness_n_m_per_rad = 3,
            .damping_n_m_s_per_rad = 0.03,
            .tremor_m = 0};
  c.motion.kind = motion_kind::press;
  c.motion.direction_d = direction_d;
  c.motion.T_dh.position = touch_d - 0.002 * direction_d;
  c.motion.depth_m = 0.002 + newtons / 600.0 + newtons / coupling_n_per_m;
  c.motion.approach_s = 0.3;
  return c;
}

/// Of what two sessions told, as far as both go; infinite where there is nothing to compare.
inline double rms_difference(const std::vector<vec3>& a, const std::vector<vec3>& b) {
  double sum = 0.0;
  const std::size_t n = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < n; ++i) sum += glm::dot(a[i] - b[i], a[i] - b[i]);
  return n == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / static_cast<double>(n));
}

constexpr int hand_kinds = 3;

/// Draws a hand that comes down on what its handle touches at a height of 10 mm, and how it moves. The device stays.
/// @param kind 0: soft, 1: firm, each presses or scrubs; 2: of ordinary stiffness, taps
inline void draw_hand(simulated_settings& hand, int kind, drawn& d) {
  hand.seed = d.bits();
  hand.hand = kind == 0 ? soft_hand() : (kind == 1 ? firm_hand() : hand_settings{});
  motion_settings& m = hand.motion;
  const double heading = d.between(0.0, 6.283);
  const double tilt = d.between(0.0, 0.5);
  m.kind = kind == 2 ? motion_kind::tap : (d.between(0.0, 1.0) < 0.5 ? motion_kind::press : motion_kind::scrub);
  m.direction_d = {std::sin(tilt) * std::cos(heading), std::sin(tilt) * std::sin(heading), -std::cos(tilt)};
  m.sideways_d = glm::normalize(glm::cross(m.direction_d, any_orthogonal(m.direction_d)));
  m.T_dh = {exp_rotation(d.inside(0.1)), {0, 0, 0.01 + d.between(0.002, 0.005)}};
  m.depth_m = d.between(0.005, 0.02);
  m.approach_s = d.between(0.1, 0.25);
  m.amplitude_m = kind == 2 ? m.depth_m + d.between(0.0, 0.01) : d.between(0.002, 0.01);
  m.frequency_hz = kind == 2 ? d.between(3.0, 6.0) : d.between(0.5, 4.0);
}

inline plane_outcome run(const plane_case& c) {
  struct watch {
    session_record last;
    void operator()(const session_record& r) noexcept { last = r; }
  };
  simulated_device dev(c.hand);
  plane_outcome out;
  EXPECT_TRUE(dev.open() && dev.arm());
  virtual_session<plane_body, simulated_device, watch> session(c.body, {{pose{}}, vec3(0.0)}, dev, c.control,
                                                               c.schedule);
  const double period_s = 1e-9 * static_cast<double>(c.schedule.device_period_ns);
  const auto back = static_cast<std::size_t>(std::max(1.0, std::round(1e-3 / period_s)));
  const double slow_rate = 1.0 - std::exp(-6.283185307179586 * 20.0 * period_s);
  std::vector<vec3> forces;
  vec3 slow{0.0};
  double shake = 0.0;
  // What the coupling's springs hold at the device's peak wrench was lent, and is not made when it comes back.
  const auto& k = c.control.coupling;
  const double peak_n = simulated_capabilities().peak_force_n / c.control.map.scale;  // in the world
  const double peak_n_m = simulated_capabilities().peak_torque_n_m;
  const double credit_j =
      std::max(0.1, 0.5 * peak_n * peak_n / k.stiffness_n_per_m + 0.5 * peak_n_m * peak_n_m / k.stiffness_n_m_per_rad);
  double surplus = 0.0;
  double before = 0.0;
  double settled = 0.0;
  while (1e-9 * static_cast<double>(session.now_ns()) < c.length_s) {
    if (session.step() != status::ok) ++out.not_ok;
    const session_record& r = session.device().observer().last;
    const bool is_settled = 1e-9 * static_cast<double>(r.time_ns) > c.settled_s;
    const double depth = c.body.depth_m(r.T_wa);
    out.deepest_m = std::max(out.deepest_m, depth);
    out.unbalanced_n = std::max(out.unbalanced_n, r.unbalanced_n);
    out.passes = std::max(out.passes, session.device().pressed().passes);
    out.torque_n_m = std::max(out.torque_n_m, glm::length(r.on_hand_d.torque));
    forces.push_back(r.on_hand_d.force);
    double step = 0.0;
    if (forces.size() > back + 2) {
      step =
          glm::length(forces.back() - forces[forces.size() - 1 - back]) / (1e3 * period_s * static_cast<double>(back));
    }
    out.step_n_per_ms = std::max(out.step_n_per_ms, step);
    const double delivered = dev.delivered_j();
    surplus = std::max(-credit_j, surplus + delivered - before);
    before = delivered;
    out.surplus_j = std::max(out.surplus_j, surplus);
    const vec3 v = dev.true_velocity_d().linear;
    slow += slow_rate * (v - slow);
    if (!is_settled) continue;
    settled += 1.0;
    out.settled_deepest_m = std::max(out.settled_deepest_m, depth);
    out.settled_step_n_per_ms = std::max(out.settled_step_n_per_ms, step);
    shake += glm::dot(v - slow, v - slow);
    out.force_n += r.on_hand_d.force;
    out.contact_n += r.on_probe_w.force;
    const vec3 stretch = r.T_wa_target.position - r.T_wa.position;
    out.stretch_m += stretch;
    out.coupling_n += c.control.coupling.stiffness_n_per_m * stretch;
  }
  if (settled > 0.0) {
    for (vec3* mean : {&out.force_n, &out.contact_n, &out.stretch_m, &out.coupling_n}) *mean /= settled;
    out.shake_m_per_s = std::sqrt(shake / settled);
  }
  out.T_wa = session.device().observer().last.T_wa;
  return out;
}

}  // namespace asperity::test_support
