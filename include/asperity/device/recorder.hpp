// Every call to a device and every answer, kept for later: an envelope around any device.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/device/device.hpp"

namespace asperity {

/// Which of a device's operations was called.
enum class device_call : std::uint8_t { open, arm, clear_fault, disarm, close, read, write };
inline constexpr int device_call_count = 7;

/// One call and its answer.
struct call_record {
  device_call call = device_call::read;
  status answered = status::ok;  ///< of open, arm and clear_fault: ok, or not_ready where they gave an error
  device_state after = device_state::absent;
  std::int64_t now_ns = 0;   ///< argument of read and write; 0 of the others
  device_sample sample{};    ///< what read left behind
  device_command command{};  ///< argument of write
};

/// Ring of calls with one writer, the device's thread, and one reader. What does not fit is counted, not kept.
/// @rt push() is safe
class call_ring {
 public:
  /// @param capacity calls kept until somebody drains them; all memory is taken here
  explicit call_ring(std::size_t capacity) : calls_(std::max<std::size_t>(capacity, 1) + 1) {}

  void push(const call_record& call) noexcept {
    const std::size_t at = written_.load(std::memory_order_relaxed);
    const std::size_t next = (at + 1) % calls_.size();
    if (next == taken_.load(std::memory_order_acquire)) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    calls_[at] = call;
    written_.store(next, std::memory_order_release);
  }

  /// Takes the oldest call. @return false where there is none
  [[nodiscard]] bool pop(call_record& out) noexcept {
    const std::size_t at = taken_.load(std::memory_order_relaxed);
    if (at == written_.load(std::memory_order_acquire)) return false;
    out = calls_[at];
    taken_.store((at + 1) % calls_.size(), std::memory_order_release);
    return true;
  }

  /// Calls that found no room. A recording with a gap cannot be replayed.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  std::vector<call_record> calls_;
  std::atomic<std::size_t> written_{0};
  std::atomic<std::size_t> taken_{0};
  std::atomic<std::uint64_t> lost_{0};
};

/// Passes every call on to a device, and what was asked and answered to a ring.
/// @rt as safe as the device
template <haptic_device Device>
class recorded_device {
 public:
  using policy_tag = device_tag;

  /// @param dev and calls outlive it
  recorded_device(Device& dev, call_ring& calls) noexcept : device_(&dev), calls_(&calls) {}

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return device_->capabilities(); }
  [[nodiscard]] device_state state() const noexcept { return device_->state(); }

  [[nodiscard]] result<void> open() { return note(device_call::open, device_->open()); }
  [[nodiscard]] result<void> arm() { return note(device_call::arm, device_->arm()); }
  [[nodiscard]] result<void> clear_fault() { return note(device_call::clear_fault, device_->clear_fault()); }
  status disarm() noexcept {
    const status s = device_->disarm();
    note({.call = device_call::disarm, .answered = s});
    return s;
  }
  void close() noexcept {
    device_->close();
    note({.call = device_call::close});
  }
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    const status s = device_->read(now_ns, in);
    note({.call = device_call::read, .answered = s, .now_ns = now_ns, .sample = in});
    return s;
  }
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    const status s = device_->write(now_ns, out);
    note({.call = device_call::write, .answered = s, .now_ns = now_ns, .command = out});
    return s;
  }

 private:
  void note(call_record call) noexcept {
    call.after = device_->state();
    calls_->push(call);
  }
  result<void> note(device_call call, result<void> done) noexcept {
    note({.call = call, .answered = done ? status::ok : status::not_ready});
    return done;
  }

  Device* device_;
  call_ring* calls_;
};

}  // namespace asperity
