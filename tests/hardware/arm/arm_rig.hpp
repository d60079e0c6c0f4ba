// A six-joint arm with everything around it: three buses of two fake drives, the mechanics, a hand, and a clock.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "asperity/drivers/articulated/articulated_device.hpp"
#include "asperity/drivers/canopen/canopen_master.hpp"
#include "asperity/drivers/canopen/cia402_drive.hpp"
#include "asperity/transport/virtual/manual_clock.hpp"
#include "asperity/transport/virtual/virtual_can.hpp"
#include "hardware/arm/arm_parts.hpp"

namespace asperity::test_support {

inline constexpr std::int64_t tick_ns = 1'000'000;

struct rig_options {
  std::array<link_script, arm_buses> scripts{};  ///< of the host's end of each bus
  std::optional<motion_settings> motion{};       ///< of the hand; none: it holds still at the start
  hand_settings hand{};
  bool with_plant = true;  ///< without: the joints stand still, which costs no time
  articulated_settings device{};
  cia402_settings drive{};
  bool starts_in_fault = false;
};

class arm_rig {
 public:
  explicit arm_rig(rig_options options = {}) : with_plant_(options.with_plant) {
    fake_arm_settings mechanics = arm_mechanics();
    mechanics.hand = options.hand;
    mechanics.motion = options.motion.value_or(motion_settings{.depth_m = 0.0});
    if (!options.motion) mechanics.motion.T_dh = forward(mechanics.chain, arm_start_rad).T_dh;
    plant = std::make_unique<fake_arm>(mechanics);

    articulated_settings c = options.device;
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
      nodes[i] = std::make_unique<virtual_can_node>(*buses[i / 2]);
      fakes[i] = std::make_unique<fake_cia402>(fake_cia402_settings{.node = arm_node(i),
                                                                    .rated_torque_m_n_m = arm_rated_m_n_m(i),
                                                                    .starts_in_fault = options.starts_in_fault},
                                               *nodes[i]);
      drives[i] = std::make_unique<cia402_drive>(arm_motor(i, options.drive));
      c.joints.push_back(arm_joint_of(i, *drives[i]));
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
    for (std::size_t i = 0; i < arm_joints; ++i) t[i] = joint_torque(*fakes[i], i);
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
  void pass(std::int64_t now_ns) {
    for (const auto& f : fakes) f->step(now_ns);
    if (!with_plant_) return;
    plant->set_torques(motor_torques());
    plant->advance(now_ns);
    move_joints();
  }
  void move_joints() {
    for (std::size_t i = 0; i < arm_joints; ++i) move_encoder(*fakes[i], i, plant->q()[i], plant->qd()[i]);
  }

  bool with_plant_;
  std::uint64_t sequence_ = 0;
};

}  // namespace asperity::test_support
