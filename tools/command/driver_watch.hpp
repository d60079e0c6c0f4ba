// Which call into a driver is under way, for somebody who cannot wait for its return.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "asperity/device/any_device.hpp"

namespace asperity::command {

/// What a driver is asked. `find` is everything before there is a device: loading drivers, listing, making.
enum class driver_call : std::uint8_t { none, find, open, arm, clear_fault, read, write, disarm, close };

[[nodiscard]] constexpr const char* to_string(driver_call c) noexcept {
  constexpr const char* names[] = {
      "nothing", "the search for devices", "open()", "arm()", "clear_fault()", "read()", "write()", "disarm()",
      "close()"};
  return names[static_cast<std::size_t>(c)];
}

/// Written by whoever calls the driver, one thread at a time; read by any. Reads no clock.
class driver_watch {
 public:
  /// A call that is under way as long as it lives. @rt safe
  class call {
   public:
    call(driver_watch& watch, driver_call which) noexcept : watch_(&watch) {
      watch.which_.store(which, std::memory_order_relaxed);
      watch.steps_.fetch_add(1, std::memory_order_release);
    }
    call(const call&) = delete;
    call& operator=(const call&) = delete;
    ~call() { watch_->steps_.fetch_add(1, std::memory_order_release); }

   private:
    driver_watch* watch_;
  };

  /// A moment: the same number twice is the same call, or the same pause between two.
  struct moment {
    std::uint64_t number = 0;
    driver_call inside = driver_call::none;  ///< none between calls
    driver_call last = driver_call::none;    ///< the call that is under way, or the one before
  };
  [[nodiscard]] moment now() const noexcept {
    const std::uint64_t steps = steps_.load(std::memory_order_acquire);
    const driver_call which = which_.load(std::memory_order_relaxed);
    return {steps, steps % 2 == 1 ? which : driver_call::none, which};
  }

  /// Whether arm() has been called and no disarm() after it has come back.
  [[nodiscard]] bool armed() const noexcept { return armed_.load(std::memory_order_relaxed); }
  void set_armed(bool armed) noexcept { armed_.store(armed, std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> steps_{0};  // odd inside a call
  std::atomic<driver_call> which_{driver_call::none};
  std::atomic<bool> armed_{false};
};

/// A device whose calls are watched, its destruction included.
/// @rt as safe as the device
class watched_device {
 public:
  using policy_tag = device_tag;

  /// @param watch outlives it
  watched_device(any_device device, driver_watch& watch) noexcept : device_(std::move(device)), watch_(&watch) {}
  watched_device(watched_device&&) noexcept = default;
  watched_device& operator=(watched_device&&) noexcept = default;
  ~watched_device() {
    const driver_watch::call closing(*watch_, driver_call::close);
    device_.reset();
  }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return device_->capabilities(); }
  [[nodiscard]] device_state state() const noexcept { return device_->state(); }
  [[nodiscard]] result<void> open() {
    const driver_watch::call c(*watch_, driver_call::open);
    return device_->open();
  }
  [[nodiscard]] result<void> arm() {
    watch_->set_armed(true);  // from now on nobody knows, until disarm() has come back
    const driver_watch::call c(*watch_, driver_call::arm);
    result<void> done = device_->arm();
    watch_->set_armed(may_put_out(device_->state()));
    return done;
  }
  [[nodiscard]] result<void> clear_fault() {
    const driver_watch::call c(*watch_, driver_call::clear_fault);
    return device_->clear_fault();
  }
  status disarm() noexcept {
    const driver_watch::call c(*watch_, driver_call::disarm);
    const status s = device_->disarm();
    watch_->set_armed(may_put_out(device_->state()));
    return s;
  }
  void close() noexcept {
    const driver_watch::call c(*watch_, driver_call::close);
    device_->close();
  }
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    const driver_watch::call c(*watch_, driver_call::read);
    return device_->read(now_ns, in);
  }
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    const driver_watch::call c(*watch_, driver_call::write);
    return device_->write(now_ns, out);
  }

 private:
  std::optional<any_device> device_;
  driver_watch* watch_;
};

static_assert(haptic_device<watched_device>);

}  // namespace asperity::command
