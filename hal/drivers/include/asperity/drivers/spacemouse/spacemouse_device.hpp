// A SpaceMouse as a device: six degrees of freedom in, nothing out.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "asperity/core/export.hpp"
#include "asperity/device/device.hpp"
#include "asperity/drivers/spacemouse/motion.hpp"
#include "asperity/drivers/spacemouse/protocol.hpp"
#include "asperity/transport/hid_link.hpp"

namespace asperity {

/// Why a SpaceMouse is in fault, or left without one.
enum class spacemouse_fault : std::uint8_t {
  none,
  unplugged,    ///< its link is gone
  read_failed,  ///< its link answered with an error
  bad_command,  ///< a command in a wrong frame, or not finite
};

[[nodiscard]] constexpr const char* to_string(spacemouse_fault f) noexcept {
  switch (f) {
    case spacemouse_fault::none:
      return "none";
    case spacemouse_fault::unplugged:
      return "the SpaceMouse was unplugged, or its receiver";
    case spacemouse_fault::read_failed:
      return "reading from the SpaceMouse failed";
    case spacemouse_fault::bad_command:
      return "a command was in a wrong frame or not finite";
  }
  return "unknown fault";
}

struct spacemouse_settings {
  std::string_view name = "SpaceMouse";  ///< outlives the device
  spacemouse_motion_settings motion{};
  /// A cap that is pushed reports every 8 or 16 ms. After this time without a report the sample is left to grow old.
  std::int64_t silence_limit_ns = 100'000'000;
  /// A wrench up to this passes the gate and is kept in shown(), for a picture of it. Zero, as the device puts out
  /// none.
  double shown_force_n = 0.0;
  double shown_torque_n_m = 0.0;
};

/// Counts of the reports since open().
struct spacemouse_counts {
  std::uint64_t reports = 0;    ///< understood
  std::uint64_t unknown = 0;    ///< of a kind that is not used here
  std::uint64_t too_short = 0;  ///< counted in device_sample::lost as well
  std::uint64_t silences = 0;   ///< times that a pushed cap fell silent
};

/// Driver of the SpaceMouse family over any hid_link.
///
/// - The pose is made here from the cap's displacement: see spacemouse_motion. Every read() whose link answers makes a
///   new sample, with or without a report, because silence says something: a cap at rest sends nothing, and its pose is
///   known to be the last one. So rest never grows stale. A link that is gone or fails makes no sample, and read() says
///   so in the same tick.
/// - A cap that was pushed when the last report came and then falls silent is neither at rest nor known. It is taken as
///   let go after silence_limit_ns: the pose stands still, and samples stay as they are until a report comes, so that
///   they grow stale for whoever judges them. The family sends the zero of a release three times over, so that a lost
///   report or two does not lead here.
///   It cannot distinguish from rest: a wireless device that is out of range, and one that hangs, with the cap at rest.
/// - Nothing is actuated. write() keeps to the contract - states, frames, faults - and the wrench goes to shown() only.
///   Limits are zero, so the output gate lets none through, unless spacemouse_settings says what may be shown.
/// - `lost` counts axis reports that could not be used, and on classic devices one for every report 1 that follows on a
///   report 1 (or 2 on 2), for they take turns.
/// - Unplugged while ready: absent, and open() looks for it again, wherever it is by then. While armed: a fault.
/// @rt read, write and disarm are as safe as the link
class ASPERITY_API spacemouse_device {
 public:
  using policy_tag = device_tag;
  /// Finds the device where it is now and opens it. Called in open().
  using link_opener = std::function<result<std::unique_ptr<hid_link>>()>;

  explicit spacemouse_device(link_opener opener, const spacemouse_settings& settings = {});
  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }

  [[nodiscard]] result<void> open();
  [[nodiscard]] result<void> arm();
  [[nodiscard]] result<void> clear_fault();
  status disarm() noexcept;
  void close() noexcept;

  /// @return ok | not_ready (not open, unplugged, or in fault) | backend_failed (the link failed: a fault)
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept;

  /// @return ok | not_ready (not open, unplugged, or in fault) | not_finite (a fault)
  [[nodiscard]] status write(std::int64_t /*now_ns*/, const device_command& out) noexcept;

  /// Switches the light around the cap. Never in a tick: the kernel waits for the device.
  [[nodiscard]] result<void> set_light(bool on);

  /// The wrench that a device with motors would put on the hand now.
  [[nodiscard]] const wrench& shown() const noexcept { return shown_; }
  /// Why it is in fault or went away.
  [[nodiscard]] spacemouse_fault fault() const noexcept { return fault_; }
  [[nodiscard]] const spacemouse_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] const spacemouse_format& format() const noexcept { return format_; }
  /// The newest of every value that came in; has_battery says whether the device ever reported it.
  [[nodiscard]] const spacemouse_input& input() const noexcept { return input_; }

 private:
  // More than the kernel keeps: a device that sends faster than this cannot hold up a tick for ever.
  static constexpr int most_reports_per_read = 128;

  [[nodiscard]] bool measures() const noexcept { return link_ != nullptr && asperity::measures(machine_.state()); }

  [[nodiscard]] error refused(const char* what) const;
  void fail(spacemouse_fault why, device_event e) noexcept;
  [[nodiscard]] status drain(std::int64_t now_ns) noexcept;
  void take(std::int64_t now_ns, std::span<const std::uint8_t> report) noexcept;
  void judge_silence(std::int64_t now_ns) noexcept;
  void measure(std::int64_t now_ns) noexcept;
  void describe() noexcept;

  link_opener opener_;
  spacemouse_settings settings_;
  spacemouse_motion motion_;
  device_state_machine machine_;
  device_capabilities capabilities_{};
  std::unique_ptr<hid_link> link_;
  spacemouse_format format_ = spacemouse_format::by_length();
  spacemouse_input input_{};
  spacemouse_counts counts_{};
  wrench shown_{};
  device_sample newest_{};
  spacemouse_fault fault_ = spacemouse_fault::none;
  axis_mask last_axes_ = no_axes;
  bool started_ = false;
  bool silent_ = false;
  std::int64_t last_read_ns_ = 0;
  std::int64_t last_report_ns_ = 0;
};

static_assert(haptic_device<spacemouse_device>);

}  // namespace asperity
