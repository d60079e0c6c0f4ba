// The Novint Falcon as a haptic device: three axes of force, a position, four buttons.
#pragma once

#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/device/device.hpp"
#include "asperity/drivers/falcon/falcon_settings.hpp"
#include "asperity/drivers/falcon/falcon_wire.hpp"
#include "asperity/transport/io_clock.hpp"
#include "asperity/transport/usb_finder.hpp"

namespace asperity {

/// One Falcon. open() wakes it: loads the firmware where it does not answer, then waits with red light until a person
/// has pushed the grip in and pulled it out. Blue: measures; green: may put out a force.
///
/// The device has no known watchdog and repeats the last command for as long as it has power. That is why a
/// command of zero goes out in every tick in which no force is allowed, and again in each one after a failure until the
/// link takes it. Where the USB link dies and the device keeps its power, nothing on this side can stop it.
class ASPERITY_API falcon_device {
 public:
  using policy_tag = device_tag;

  /// @param finder,clock outlive the device
  falcon_device(usb_finder& finder, io_clock& clock, usb_listing which, falcon_settings settings = {});
  falcon_device(falcon_device&&) noexcept = default;
  falcon_device& operator=(falcon_device&&) = delete;
  falcon_device(const falcon_device&) = delete;
  falcon_device& operator=(const falcon_device&) = delete;
  ~falcon_device() { close(); }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }
  /// Why it stopped; stays until clear_fault().
  [[nodiscard]] falcon_fault fault() const noexcept { return fault_; }

  [[nodiscard]] result<void> open();
  [[nodiscard]] result<void> arm();
  [[nodiscard]] result<void> clear_fault();

  /// @return ok | not_ready (not open, or in fault) | backend_failed (the zero did not go out: a fault)
  status disarm() noexcept;

  /// Sends zero and gives the handle back. Not inside a tick.
  void close() noexcept;

  /// Sends a frame as well where no write() has since the last call: without one the device does not answer.
  /// @return ok | not_ready (not open) | backend_failed (it just stopped; see fault())
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept;

  /// @return ok | not_finite (a fault: not finite, or a wrong frame) | not_ready (not open) | backend_failed (it just
  /// stopped; see fault())
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept;

  [[nodiscard]] const usb_listing& listing() const noexcept { return which_; }

 private:
  static constexpr std::int64_t tick_ns = 1'000'000;

  [[nodiscard]] static usb_pipes pipes() noexcept;

  // Where the device is now: at its path, or under its serial number somewhere else.
  [[nodiscard]] result<usb_listing> find();

  [[nodiscard]] error refused(const char* what) const;

  // A full pipe is given time to empty; the second frame is for the case that the first one is lost.
  void send_last_zero() noexcept;

  [[nodiscard]] bool measures() const noexcept { return asperity::measures(machine_.state()); }

  void measure() noexcept;

  // The one way out: a force where it is allowed and the position is known, zero everywhere else.
  status put_out(std::int64_t now_ns, const vec3& force_d) noexcept;

  // A device that may not put out anything is told so for as long as there is a link.
  status owe_zero(std::int64_t now_ns) noexcept;

  status stop(std::int64_t now_ns, io_status s) noexcept;
  status stop(std::int64_t now_ns, falcon_fault cause) noexcept;

  usb_finder* finder_;
  io_clock* clock_;
  usb_listing which_;
  falcon_settings settings_;
  device_capabilities capabilities_ = falcon_capabilities();
  device_state_machine machine_{};
  falcon_wire wire_{};
  falcon_fault fault_ = falcon_fault::none;
  device_command command_{};
  device_sample newest_{};
  std::int64_t last_now_ns_ = 0;
  int busy_ = 0;
  bool wrote_ = false;
};

}  // namespace asperity
