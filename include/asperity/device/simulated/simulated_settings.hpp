// What a simulated device is made of, in numbers.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/device/capabilities.hpp"
#include "asperity/device/simulated/actuator.hpp"
#include "asperity/device/simulated/hand_lead.hpp"
#include "asperity/device/simulated/motion_script.hpp"

namespace asperity {

/// What can go wrong with a simulated device.
enum class device_fault : std::uint8_t {
  nan_pose,       ///< a coordinate is NaN
  infinite_pose,  ///< a coordinate is infinite
  bad_rotation,   ///< the quaternion has length 2
  stale,          ///< the last measurement is repeated: an encoder or a link that stands still
  drop,           ///< read() has no answer
  jump,           ///< the position is half a metre off
  refuse_write,   ///< write() fails
  depart,         ///< the device leaves its bus, and stays away after until_ns as well
  stuck_encoder,  ///< the first axis stands where it was when the fault began; the others go on
  slow_reply,     ///< a new measurement only every 8 ms
  loss,           ///< nine measurements of ten are lost on their way, as the counters say
  overheat,       ///< the device reports a fault of its own: its state is fault, its output zero
};

/// One fault and when.
struct scripted_fault {
  device_fault kind = device_fault::drop;
  std::int64_t from_ns = 0;
  std::int64_t until_ns = 0;  ///< not included
};

/// Buttons that the hand holds down, and when.
struct scripted_press {
  std::uint32_t buttons = 1;  ///< one bit per button
  std::int64_t from_ns = 0;   ///< session clock
  std::int64_t until_ns = 0;  ///< not included
};

/// The hand as a spring and damper to where it wants to be, and a tremor.
struct hand_settings {
  double stiffness_n_per_m = 300.0;
  double damping_n_s_per_m = 4.0;
  double stiffness_n_m_per_rad = 2.0;
  double damping_n_m_s_per_rad = 0.02;
  double tremor_m = 2e-5;  ///< amplitude of each of three seeded waves between 8 and 12 Hz, along each axis
};

/// A relaxed grip, two fingers and a thumb: gives way, damps little.
/// Measured hands differ by more than a factor of two at the same grip. These presets are the two ends of the range in
/// which measured fingers and wrists lie, not a model of anybody.
[[nodiscard]] ASPERITY_API hand_settings soft_hand() noexcept;

/// A firm grip with a stiff wrist; see soft_hand(). Tremor grows with grip force.
[[nodiscard]] ASPERITY_API hand_settings firm_hand() noexcept;

/// A light arm with six free axes, gravity balanced by default.
struct plant_settings {
  double mass_kg = 0.15;
  double damping_n_s_per_m = 1.0;
  double inertia_kg_m2 = 2e-4;
  double damping_n_m_s_per_rad = 2e-3;
  vec3 gravity_d{0.0};  ///< m/s^2, on the whole mass
  vec3 centre_h{0.0};   ///< of that mass, m
};

/// How the measurement reaches the host.
struct measurement_settings {
  double position_resolution_m = 1e-6;    ///< 0 for none
  double rotation_resolution_rad = 1e-5;  ///< of each component of the rotation vector; 0 for none
  std::int64_t delay_ns = 0;              ///< age of a measurement when the host receives it; at most 20 ms with jitter
  std::int64_t jitter_ns = 0;             ///< added to the delay, seeded, uniform
  double loss = 0.0;                      ///< probability that a measurement is lost on its way, seeded
};

/// Properties of the simulated device in the words of a data sheet.
[[nodiscard]] ASPERITY_API device_capabilities simulated_capabilities() noexcept;

struct simulated_settings {
  std::uint64_t seed = 1;
  motion_settings motion{};
  hand_settings hand{};
  plant_settings plant{};
  measurement_settings measurement{};
  actuator_settings actuator{};
  device_capabilities capabilities = simulated_capabilities();
  std::vector<scripted_fault> faults{};
  std::vector<scripted_press> presses{};  ///< empty: the device has no buttons
  std::shared_ptr<hand_lead> lead{};      ///< null: the motion leads the hand; otherwise this, from the motion's begin
};

}  // namespace asperity
