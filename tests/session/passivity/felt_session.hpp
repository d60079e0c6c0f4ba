// Seeded sessions of a hand on a surface, for the passivity tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "session/passivity/energy_bound.hpp"
#include "support/held_force.hpp"
#include "support/kept_bodies.hpp"
#include "support/small_models.hpp"
#include "unit/control/analytic_wall.hpp"

namespace asperity::test_support {

enum class hand_model : std::uint8_t {
  soft,     ///< soft_hand() that presses or scrubs
  firm,     ///< firm_hand() that presses or scrubs
  tapping,  ///< the default hand, between the two, that taps 3 to 6 times a second
};

/// One seeded case: everything but how the contact is handed over and whether the guard is on.
struct felt_case {
  simulated_settings device{};
  virtual_schedule schedule{};
  double stiffness_n_per_m = 2000.0;
  bool textured = false;  ///< two ridged boxes under the real renderer; false: the analytic wall
  std::int64_t length_ns = 550'000'000;
};

/// Stiffness is log-uniform from 0.5 to 20 N/mm: from moderate to four times what control-loop.md calls quiet at every
/// rate, because what goes wrong there is what the guard is for.
[[nodiscard]] inline felt_case draw_case(std::uint64_t seed, hand_model hand, std::int64_t contact_period_ns, bool late,
                                         bool textured) {
  std::mt19937_64 bits(seed);
  const auto between = [&bits](double low, double high) {
    return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1.0p-53);
  };
  const bool taps = hand == hand_model::tapping;
  felt_case c;
  c.textured = textured;
  c.stiffness_n_per_m = 500.0 * std::pow(40.0, between(0.0, 1.0));
  c.schedule = {.contact_period_ns = contact_period_ns, .contact_one_period_late = late};
  c.device.seed = bits();
  if (hand == hand_model::soft) c.device.hand = soft_hand();
  if (hand == hand_model::firm) c.device.hand = firm_hand();

  const double tilt = between(0.0, 0.5);
  const double heading = between(0.0, 6.283185307179586);
  motion_settings& m = c.device.motion;
  m.kind = (bits() & 1U) != 0 ? motion_kind::scrub : motion_kind::press;
  if (taps) m.kind = motion_kind::tap;
  m.direction_d = {std::sin(tilt) * std::cos(heading), std::sin(tilt) * std::sin(heading), -std::cos(tilt)};
  m.sideways_d = glm::normalize(glm::cross(m.direction_d, any_orthogonal(m.direction_d)));
  m.depth_m = between(0.005, 0.02);
  m.approach_s = between(0.1, 0.25);
  m.amplitude_m = taps ? m.depth_m + between(0.0, 0.01) : between(0.002, 0.01);
  m.frequency_hz = taps ? between(3.0, 6.0) : between(0.5, 4.0);
  for (int i = 0; i < 3; ++i) m.T_dh.position[i] = between(-0.005, 0.005);
  m.T_dh.position.z = between(0.001, 0.004);
  vec3 turn{0.0};
  for (int i = 0; i < 3; ++i) turn[i] = between(-0.1, 0.1);
  m.T_dh.rotation = exp_rotation(turn);
  return c;
}

/// The bodies of the textured cases: a small cube with ridges over a plate with coarser ridges.
struct ridged_boxes {
  model_ptr cube =
      std::make_shared<const textured_model>(make_textured_box({0.006, 0.006, 0.006}, 48, ridges(0.0002, 0.003)));
  model_ptr plate =
      std::make_shared<const textured_model>(make_textured_box({0.04, 0.04, 0.01}, 96, ridges(0.0003, 0.01)));
};

struct felt_result {
  double stiffness_n_per_m = 0.0;
  double largest_gain_j = 0.0;
  double gain_bound_j = 0.0;
  double largest_surplus_j = 0.0;
  double surplus_bound_j = 0.0;
  double true_minus_observed_j = 0.0;  ///< true energy minus the guard's book
  double observed_gap_j = 0.0;         ///< the same by the errors of the measurement
  std::uint64_t ticks = 0;
  std::uint64_t acted = 0;     ///< ticks in which the guard changed the wrench
  std::uint64_t touching = 0;  ///< ticks with a contact
  std::uint64_t not_ok = 0;    ///< ticks that did not end ok
};

/// How a case is run.
struct felt_options {
  bool held = false;  ///< the contact's wrench is held, its stiffness J dropped
  bool guard = true;
};

template <contact_renderer Renderer>
[[nodiscard]] felt_result run_case(const felt_case& c, Renderer renderer, scene_placement placement,
                                   const control_settings& control) {
  struct watch {
    session_record last;
    std::uint64_t acted = 0;
    std::uint64_t touching = 0;
    void operator()(const session_record& r) noexcept {
      last = r;
      if (r.guard_alpha_per_s != 0.0 || r.guard_scale != 1.0) ++acted;
      if (r.contacts > 0) ++touching;
    }
  };
  simulated_device dev(c.device);
  if (!dev.open() || !dev.arm()) return {};
  virtual_session<Renderer, simulated_device, watch> session(std::move(renderer), std::move(placement), dev, control,
                                                             c.schedule);
  energy_bound book(control.guard, session.device().gate().limits(),
                    1e-9 * static_cast<double>(c.schedule.device_period_ns));
  felt_result out;
  while (session.now_ns() < c.length_ns) {
    if (session.step() != status::ok) ++out.not_ok;
    book.observe(dev.delivered_j(), dev.true_T_dh(), dev.true_velocity_d(), session.device().observer().last);
  }
  out.stiffness_n_per_m = c.stiffness_n_per_m;
  out.largest_gain_j = book.largest_gain_j();
  out.gain_bound_j = book.gain_bound_j();
  out.largest_surplus_j = book.largest_surplus_j();
  out.surplus_bound_j = book.surplus_bound_j();
  out.true_minus_observed_j = dev.delivered_j() - session.device().guard().delivered_j();
  out.observed_gap_j = book.observed_gap_j();
  out.ticks = session.device_ticks();
  out.acted = session.device().observer().acted;
  out.touching = session.device().observer().touching;
  return out;
}

template <contact_renderer Renderer>
[[nodiscard]] felt_result run_case(const felt_case& c, Renderer renderer, scene_placement placement, bool guard) {
  control_settings control;
  control.guard.enabled = guard;
  return run_case(c, std::move(renderer), std::move(placement), control);
}

/// Runs a case against the analytic wall, or with the real renderer on ridged boxes. No ticks: it could not be set up.
[[nodiscard]] inline felt_result feel(const felt_case& c, const ridged_boxes& boxes, const felt_options& how) {
  const auto run = [&how](const felt_case& one, auto renderer, const scene_placement& placement) {
    return how.held ? run_case(one, held_force(std::move(renderer)), placement, how.guard)
                    : run_case(one, std::move(renderer), placement, how.guard);
  };
  if (!c.textured) {
    return run(c, analytic_wall{.stiffness_n_per_m = c.stiffness_n_per_m, .arm_m = 0.006}, {{pose{}}, vec3(0.0)});
  }
  least_motion_renderer_settings settings;
  settings.force.stiffness_n_per_m = c.stiffness_n_per_m;
  result<least_motion_renderer> made = build_renderer({boxes.cube, {boxes.plate}}, settings);
  if (!made) return {};
  felt_case raised = c;  // so that the cube's lower face begins where the wall's points do
  raised.device.motion.T_dh.position.z += 0.0065;
  const pose T_wb{quat(1.0, 0.0, 0.0, 0.0), {0.0, 0.0, -0.0103}};
  return run(raised, std::move(*made), {{T_wb}, boxes.cube->mass.centre_of_mass});
}

}  // namespace asperity::test_support
