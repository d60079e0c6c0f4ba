// What one device tick did, as plain numbers for whoever watches.
#pragma once

#include <concepts>
#include <cstdint>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/device/device_state.hpp"
#include "asperity/device/output_gate.hpp"
#include "asperity/device/sample_check.hpp"
#include "asperity/render/tick_flag.hpp"

namespace asperity {

/// One device tick. Wrenches in world axes unless the name says otherwise; everything SI.
struct session_record {
  std::int64_t time_ns = 0;
  pose T_dh{};                      ///< handle in the device's base frame: the last sample that was accepted
  pose T_wa_target{};               ///< where the handle wants the probe's body frame
  pose T_wa{};                      ///< where the probe's body frame is
  wrench on_hand_d{};               ///< what left the gate: axes of d, torque about the handle's origin
  wrench on_probe_w{};              ///< contact wrench on the probe, about its centre of mass
  double max_depth_m = 0.0;         ///< deepest contact of the contact in use
  std::uint32_t contacts = 0;       ///< contacts with depth > 0 in it
  std::uint32_t planes = 0;         ///< support planes of it
  double unbalanced_n = 0.0;        ///< residual of the contact solver in the last substep; 0 without planes
  double overlap_m = 0.0;           ///< of the deepest plane at the beginning of the last substep; 0 without planes
  std::int64_t contact_age_ns = 0;  ///< age of the contact in use; 0 before the first
  double delivered_j = 0.0;         ///< energy delivered to the hand since the start
  double from_bodies_j = 0.0;       ///< work that moving bodies did on the probe since it was placed
  double raised_j = 0.0;            ///< of delivered_j, work that the handle's weight was held up with
  double transient_j = 0.0;         ///< work on the hand that first touches rang with; see contact_transient
  std::uint32_t first_touches = 0;  ///< that rang, so far
  double weight_share = 0.0;        ///< how much of the handle's weight the motors hold
  double surplus_j = 0.0;           ///< what the passivity guard acts on
  double guard_alpha_per_s = 0.0;   ///< damping rate that the guard added
  double guard_scale = 1.0;         ///< factor that the guard put on the wrench
  double rate_scale = 1.0;          ///< factor that late loops put on the wrench
  bool pulling = false;             ///< the linear contact would have pulled and was set to zero
  std::uint32_t buttons = 0;        ///< of the device, as last told; one bit per button
  bool buttons_told = false;        ///< the sample in use says which buttons are held down
  double gripper_m = 0.0;           ///< opening of the device's gripper, as last told
  bool gripper_told = false;        ///< the sample in use has one
  double clutch_ratio = 1.0;  ///< share of the handle's motion that the probe is given, and of its wrench the hand
  velocity_source velocity = velocity_source::poses;  ///< that the coupling's damper was given
  bool velocity_refused = false;                      ///< the device told a velocity that does not go with its poses
  sample_verdict sample = sample_verdict::accepted;
  tick_flag flags = tick_flag::none;          ///< what planes did not answer, in this tick or in the 50 ms before it
  status contact_status = status::not_ready;  ///< the renderer's answer behind the contact in use
  status probe_status = status::ok;
  device_state device = device_state::absent;
  gate_fault fault = gate_fault::none;
};

/// Something that wants to see every device tick. It runs inside the tick and keeps its rules: no allocation, no lock.
template <class O>
concept session_observer = requires(O& observer, const session_record& record) {
  { observer(record) }
  noexcept;
};

/// Watches nothing.
struct no_observer {
  void operator()(const session_record&) const noexcept {}
};

}  // namespace asperity
