// A device behind the C interface, not trusted.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/device/device.hpp"
#include "asperity/device/driver_abi.h"
#include "asperity/plugin/driver_module.hpp"

namespace asperity::plugin {

/// A fault that a driver caused or reported. Latched until clear_fault().
enum class plugin_fault : std::uint8_t {
  none,
  device_fault,      ///< the driver reports a fault
  departed,          ///< the device left while it was armed
  unknown_state,     ///< the driver reports a state that is none
  unexpected_state,  ///< the driver reports a state that cannot follow
  armed_itself,      ///< the driver reports output without arm() having been called
  threw,             ///< an exception came across the C interface
  bad_command,       ///< the host was given a wrench that is not finite or in a wrong frame
};

[[nodiscard]] const char* to_string(plugin_fault f) noexcept;

/// haptic_device over a driver's handle.
///
/// The host keeps its own state: nothing but arm() on this object arms, whatever the driver reports. A driver that says
/// that it puts out while the host did not arm it is disarmed and closed, and the fault is latched. Commands are
/// checked, saturated to the peak limits and zeroed where they may not leave before the driver sees them; limits are
/// those that the driver stated at open(), and do not move. Samples that are not finite or have no unit quaternion are
/// refused. It cannot protect against a driver that writes outside its own memory, or does not return.
class plugin_device {
 public:
  using policy_tag = device_tag;

  /// Takes over a handle that the module's make() gave.
  [[nodiscard]] static result<plugin_device> adopt(std::shared_ptr<const driver_module> module,
                                                   asperity_device* handle);

  plugin_device(plugin_device&&) noexcept;
  plugin_device& operator=(plugin_device&&) noexcept;
  ~plugin_device();

  [[nodiscard]] const device_capabilities& capabilities() const noexcept;
  [[nodiscard]] device_state state() const noexcept;
  [[nodiscard]] result<void> open();
  [[nodiscard]] result<void> arm();
  [[nodiscard]] result<void> clear_fault();
  status disarm() noexcept;
  void close() noexcept;
  /// @return ok | not_finite, invalid_pose (a sample that cannot be; `in` is untouched) | what the driver answers
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept;
  /// @return ok | not_finite (not a wrench in base frame) | stale_input (expired) | what the driver answers
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept;

  /// Why state() is fault.
  [[nodiscard]] plugin_fault fault() const noexcept;
  /// The same in a sentence, with what the driver says about it. Outside a tick.
  [[nodiscard]] std::string fault_text() const;

 private:
  class body;
  explicit plugin_device(std::unique_ptr<body> b) noexcept;

  std::unique_ptr<body> body_;
};

static_assert(haptic_device<plugin_device>);

}  // namespace asperity::plugin
