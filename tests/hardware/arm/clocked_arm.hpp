// The arm of a rig as a device whose world moves on when it is read.
#pragma once

#include <cstdint>

#include "hardware/arm/arm_rig.hpp"

namespace asperity::test_support {

/// For sessions: mechanics, drives and buses run up to the time of each read().
class clocked_arm {
 public:
  using policy_tag = device_tag;

  explicit clocked_arm(arm_rig& rig) : rig_(&rig) {}

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return rig_->dev->capabilities(); }
  [[nodiscard]] device_state state() const noexcept { return rig_->dev->state(); }
  [[nodiscard]] result<void> open() { return rig_->dev->open(); }
  [[nodiscard]] result<void> arm() { return rig_->dev->arm(); }
  [[nodiscard]] result<void> clear_fault() { return rig_->dev->clear_fault(); }
  status disarm() noexcept { return rig_->dev->disarm(); }
  void close() noexcept { rig_->dev->close(); }
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    rig_->clock.wait_until_ns(now_ns);
    return rig_->dev->read(now_ns, in);
  }
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    const status s = rig_->dev->write(now_ns, out);
    rig_->plant->set_intended(rig_->dev->torques().scale * out.on_hand);
    return s;
  }

 private:
  arm_rig* rig_;
};

}  // namespace asperity::test_support
