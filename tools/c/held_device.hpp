// A device that a handle and a session may share.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "asperity/c/device.h"
#include "asperity/device/any_device.hpp"
#include "c/entry.hpp"

namespace asperity::c {

/// Closed when nobody has it any more.
struct held_device {
  explicit held_device(any_device made) : device(std::move(made)), state(read_state()) {}
  held_device(const held_device&) = delete;
  held_device& operator=(const held_device&) = delete;
  ~held_device() {
    static_cast<void>(device.disarm());
    device.close();
  }

  /// For who asks while a session has the device on another thread.
  void keep_state() noexcept { state.store(read_state(), std::memory_order_relaxed); }
  [[nodiscard]] std::uint32_t read_state() const noexcept { return static_cast<std::uint32_t>(device.state()); }

  any_device device;
  std::atomic<std::uint32_t> state;
  std::atomic<bool> in_session{false};
  std::int64_t used_until_ns = -1;  ///< latest time that it was told; -1: none yet
};

}  // namespace asperity::c

// NOLINTBEGIN(readability-identifier-naming): names of the C header
struct asperity_haptic_device : asperity::c::handle_mark<0x44617370U> {
  explicit asperity_haptic_device(std::shared_ptr<asperity::c::held_device> made) : inside(std::move(made)) {}
  std::shared_ptr<asperity::c::held_device> inside;
};
// NOLINTEND(readability-identifier-naming)
