// A six-joint arm with everything around it: three buses of two fake drives, the mechanics, a hand, and a clock.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "asperity/hal/articulated/articulated_device.hpp"
#include "asperity/hal/canopen/canopen_master.hpp"
#include "asperity/hal/canopen/cia402_drive.hpp"
#include "asperity/hal/virtual/manual_clock.hpp"
#include "asperity/hal/virtual/virtual_can.hpp"
#include "hal/peers/fake_arm.hpp"
#include "hal/peers/fake_cia402.hpp"

namespace asperity::test_support {

inline constexpr std::size_t arm_joints = 6;
inline constexpr std::size_t arm_buses = 3;
inline constexpr double arm_gear = 10.0;
inline constexpr double arm_counts = 65536.0;
inline constexpr std::int64_t tick_ns = 1'000'000;

/// Two links of 0.25 m and a wrist; handle 80 mm beyond it. Peak torques of a size that a desk arm has.
[[nodiscard]] inline serial_chain desk_arm() {
  serial_chain c;
  const auto add = [&c](const vec3& at, const vec3& axis, double range, double torque, double mass, const vec3& centre,
                        double inertia) {
    static_cast<void>(c.joints.push_back({.T_parent = {quat(1.0, 0.0, 0.0, 0.0), at},
                                          .axis = axis,
                                          .lower_rad = -range,
                                          .upper_rad = range,
                                          .max_torque_n_m = torque,
                                          .link = {mass, centre, mat3(inertia)}}));
  };
  add({0.0, 0.0, 0.1}, {0, 0, 1}, 2.5, 12.0, 0.4, {0.0, 0.0, 0.05}, 4e-4);
  add({0.0, 0.0, 0.1}, {0, 1, 0}, 2.0, 12.0, 0.6, {0.1, 0.0, 0.0}, 1.5e-3);
  add({0.25, 0.0, 0.0}, {0, 1, 0}, 2.6, 12.0, 0.4, {0.1, 0.0, 0.0}, 1e-3);
  add({0.25, 0.0, 0.0}, {1, 0, 0}, 2.8, 3.0, 0.1, {0.0, 0.0, 0.0}, 1e-4);
  add({0.0, 0.0, 0.0}, {0, 1, 0}, 1.9, 3.0, 0.1, {0.02, 0.0, 0.0}, 1e-4);
  add({0.0, 0.0, 0.0}, {1, 0, 0}, 2.8, 3.0, 0.08, {0.06, 0.0, 0.0}, 5e-5);
  c.T_handle = {quat(1.0, 0.0, 0.0, 0.0), {0.08, 0.0, 0.0}};
  return c;
}

/// Elbow up, handle level: far from every singularity and every limit.
inline constexpr joint_vector arm_start_rad{0.1, -0.9, 1.7, 0.05, -0.7, 0.1};

struct rig_options {
  std::array<link_script, arm_buses> scripts{};  ///< of the host's end of each bus
  std::optional<motion_config> motion{};         ///< of the hand; none: it holds still at the start
  hand_config hand{};
  bool with_plant = true;  ///< without: the joints stand still, which costs no time
  articulated_config device{};
  cia402_config drive{};
  bool starts_in_fault = false;
};

class arm_rig {
 public:
  explicit arm_rig(rig_options options = {}) : with_plant_(options.with_plant) {
    fake_arm_config mechanics;
    mechanics.chain = desk_arm();
    mechanics.start_rad = arm_start_rad;
    for (std::size_t i = 0; i < arm_joints; ++i) {
      mechanics.reflected_kg_m2[i] = i < 3 ? 5e-3 : 1e-3;
      mechanics.friction_n_m_s_per_rad[i] = i < 3 ? 0.05 : 0.01;
    }
    mechanics.hand = options.hand;
    mechanics.motion = options.motion.value_or(motion_config{.depth_m = 0.0});
    if (!options.motion) mechanics.motion.T_dh = forward(mechanics.chain, arm_start_rad).T_dh;
    plant = std::make_unique<fake_arm>(mechanics);

    articulated_config c = options.device;
    c.chain = mechanics.chain;
    c.clock = &clock;
    c.rest_rad = arm_start_rad;
    for (std::size_t b = 0; b < arm_buses; ++b) {
      buses[b] = std::make_unique<virtual_can>(false);
      hosts[b] = std::make_unique<virtual_can_node>(*buses[b], std::move(options.scripts[b]));
      masters[b] = std::make_unique<canopen_master>();
      c.buses.push_back({hosts[b].get(), masters[b].get()});
    }
    for (std::size_t i = 0; i < arm_joints; ++i) {
      const std::size_t b = i / 2;
      const auto node = static_cast<std::uint8_t>(i + 1);
      const std::uint32_t rated_m_n_m = i < 3 ? 400 : 150;
      nodes[i] = std::make_unique<virtual_can_node>(*buses[b]);
      fakes[i] = std::make_unique<fake_cia402>(
          fake_cia402_config{
              .node = node, .rated_torque_m_n_m = rated_m_n_m, .starts_in_fault = options.starts_in_fault},
          *nodes[i]);
      cia402_config d = options.drive;
      d.node = node;
      d.rated_torque_n_m = 1e-3 * rated_m_n_m;
      d.peak_torque_n_m = i < 3 ? 12.0 : 3.0;
      d.counts_per_turn = arm_counts;
      d.gear_ratio = arm_gear;
      d.reversed = i == 1 || i == 4;
      d.zero_offset_rad = zero_rad(i);
      drives[i] = std::make_unique<cia402_drive>(d);
      c.joints.push_back({.drive = drives[i].get(),
                          .bus = b,
                          .continuous_torque_n_m = i < 3 ? 8.0 : 2.0,
                          .reflected_inertia_kg_m2 = mechanics.reflected_kg_m2[i]});
    }
    move_joints();
    clock.on_advance([this](std::int64_t now_ns) { pass(now_ns); });
    result<articulated_device> made = articulated_device::make(std::move(c));
    if (made) dev = std::make_unique<articulated_device>(std::move(*made));
  }
  ~arm_rig() { dev.reset(); }  // it closes with the drives still there
  arm_rig(const arm_rig&) = delete;
  arm_rig& operator=(const arm_rig&) = delete;

  /// One period of an application: time passes, read, write.
  status tick(const wrench& on_hand = {}, std::int64_t valid_ns = 20'000'000) {
    clock.advance_ns(tick_ns);
    read_status = dev->read(clock.now_ns(), sample);
    return dev->write(clock.now_ns(), {on_hand, wrench_frame::device_base, clock.now_ns() + valid_ns, ++sequence_});
  }

  /// Torque of every joint, as the motors put it out.
  [[nodiscard]] joint_vector motor_torques() const {
    joint_vector t{};
    for (std::size_t i = 0; i < arm_joints; ++i) {
      const double rated = i < 3 ? 0.4 : 0.15;
      t[i] = direction(i) * arm_gear * rated * fakes[i]->torque_permille() / 1000.0;
    }
    return t;
  }
  [[nodiscard]] bool all_at_zero() const {
    for (const auto& f : fakes) {
      if (f->torque_permille() != 0) return false;
    }
    return true;
  }
  [[nodiscard]] int enables() const {
    int n = 0;
    for (const auto& f : fakes) n += f->enables();
    return n;
  }

  manual_clock clock{};
  std::array<std::unique_ptr<virtual_can>, arm_buses> buses;
  std::array<std::unique_ptr<virtual_can_node>, arm_buses> hosts;
  std::array<std::unique_ptr<canopen_master>, arm_buses> masters;
  std::array<std::unique_ptr<virtual_can_node>, arm_joints> nodes;
  std::array<std::unique_ptr<fake_cia402>, arm_joints> fakes;
  std::array<std::unique_ptr<cia402_drive>, arm_joints> drives;
  std::unique_ptr<fake_arm> plant;
  std::unique_ptr<articulated_device> dev;
  device_sample sample{};
  status read_status = status::not_ready;

 private:
  [[nodiscard]] static double direction(std::size_t i) { return i == 1 || i == 4 ? -1.0 : 1.0; }
  [[nodiscard]] static double zero_rad(std::size_t i) { return 0.1 * static_cast<double>(i); }

  void pass(std::int64_t now_ns) {
    for (const auto& f : fakes) f->step(now_ns);
    if (!with_plant_) return;
    plant->set_torques(motor_torques());
    plant->advance(now_ns);
    move_joints();
  }
  void move_joints() {
    for (std::size_t i = 0; i < arm_joints; ++i) {
      const double counts_per_rad = direction(i) * arm_counts * arm_gear / (2.0 * std::numbers::pi);
      fakes[i]->set_motion(static_cast<std::int32_t>(std::lround((plant->q()[i] - zero_rad(i)) * counts_per_rad)),
                           static_cast<std::int32_t>(std::lround(plant->qd()[i] * counts_per_rad)));
    }
  }

  bool with_plant_;
  std::uint64_t sequence_ = 0;
};

}  // namespace asperity::test_support
