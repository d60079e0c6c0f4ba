// The simulated device, and a notebook of everything that was said to it and that it answered.
#pragma once

#include <cstdint>
#include <utility>

#include "asperity/device/simulated/simulated_device.hpp"
#include "session/simulation/scenario.hpp"

namespace asperity::simulation {

/// Passes every call on. What the checker knows of the device it has from here, not from the loop.
class watched_device {
 public:
  using policy_tag = device_tag;

  explicit watched_device(simulated_settings settings) : device_(std::move(settings)) {}

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return device_.capabilities(); }
  [[nodiscard]] device_state state() const noexcept { return device_.state(); }
  [[nodiscard]] result<void> open() { return device_.open(); }
  [[nodiscard]] result<void> arm() {
    result<void> done = device_.arm();
    if (done) ++arms_;
    return done;
  }
  [[nodiscard]] result<void> clear_fault() { return device_.clear_fault(); }
  [[nodiscard]] status disarm() noexcept { return device_.disarm(); }
  void close() noexcept { device_.close(); }

  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    read_status_ = device_.read(now_ns, in);
    if (read_status_ == status::ok && falsify_stamp_) in.host_time_ns = false_stamp_ns_;
    if (read_status_ == status::ok) sample_ = in;
    read_at_ns_ = now_ns;
    return read_status_;
  }

  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    output_allowed_ = may_put_out(device_.state());
    command_ = out;
    written_at_ns_ = now_ns;
    return write_status_ = device_.write(now_ns, out);
  }

  /// From now on samples carry this time; or their own again.
  void falsify_stamp(std::int64_t stamp_ns) noexcept {
    falsify_stamp_ = true;
    false_stamp_ns_ = stamp_ns;
  }
  void keep_stamp() noexcept { falsify_stamp_ = false; }
  void plug_in() noexcept { device_.plug_in(); }

  [[nodiscard]] std::uint64_t arms() const noexcept { return arms_; }
  [[nodiscard]] status read_status() const noexcept { return read_status_; }
  [[nodiscard]] status write_status() const noexcept { return write_status_; }
  [[nodiscard]] const device_sample& sample() const noexcept { return sample_; }
  [[nodiscard]] const device_command& command() const noexcept { return command_; }
  /// Whether the device was armed or active when the last command came.
  [[nodiscard]] bool output_allowed() const noexcept { return output_allowed_; }
  [[nodiscard]] std::int64_t read_at_ns() const noexcept { return read_at_ns_; }
  [[nodiscard]] std::int64_t written_at_ns() const noexcept { return written_at_ns_; }

 private:
  simulated_device device_;
  bool falsify_stamp_ = false;
  std::int64_t false_stamp_ns_ = 0;
  std::uint64_t arms_ = 0;
  status read_status_ = status::not_ready;
  status write_status_ = status::not_ready;
  device_sample sample_{};
  device_command command_{};
  bool output_allowed_ = false;
  std::int64_t read_at_ns_ = 0;
  std::int64_t written_at_ns_ = 0;
};

static_assert(haptic_device<watched_device>);

}  // namespace asperity::simulation
