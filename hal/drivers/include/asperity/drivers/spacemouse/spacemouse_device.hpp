// A SpaceMouse as a device: six degrees of freedom in, nothing out.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "asperity/device/device.hpp"
#include "asperity/drivers/hid/descriptor_parser.hpp"
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

/// What came in since open().
struct spacemouse_counts {
  std::uint64_t reports = 0;    ///< understood
  std::uint64_t unknown = 0;    ///< of a kind that is not ours
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
///   What cannot be told from rest: a wireless device that is out of range, and one that hangs, with the cap at rest.
/// - Nothing is actuated. write() keeps to the contract - states, frames, faults - and the wrench goes to shown() only.
///   Limits are zero, so the output gate lets none through, unless spacemouse_settings says what may be shown.
/// - `lost` counts axis reports that could not be used, and on classic devices one for every report 1 that follows on a
///   report 1 (or 2 on 2), for they take turns.
/// - Unplugged while ready: absent, and open() looks for it again, wherever it is by then. While armed: a fault.
/// @rt read, write and disarm are as safe as the link
class spacemouse_device {
 public:
  using policy_tag = device_tag;
  /// Finds the device where it is now and opens it. Called in open().
  using link_opener = std::function<result<std::unique_ptr<hid_link>>()>;

  explicit spacemouse_device(link_opener opener, const spacemouse_settings& settings = {})
      : opener_(std::move(opener)), settings_(settings), motion_(settings.motion), machine_(device_state::present) {
    describe();
  }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }

  [[nodiscard]] result<void> open() {
    if (!opener_) return error{error_code::invalid_argument, "the SpaceMouse was made without a way to open it"};
    const device_state s = machine_.state();
    if (s != device_state::absent && s != device_state::closed && s != device_state::present) return refused("open");
    link_.reset();
    result<std::unique_ptr<hid_link>> link = opener_();
    if (!link) return link.error();
    if (*link == nullptr) return error{error_code::io_failed, "the SpaceMouse could not be opened: there is no link"};
    link_ = std::move(*link);
    if (machine_.state() != device_state::present) machine_.apply(device_event::arrived);
    machine_.apply(device_event::opened);
    format_ = spacemouse_format::from(parse_report_descriptor(link_->report_descriptor()));
    describe();
    motion_.reset();
    input_ = {};
    counts_ = {};
    shown_ = {};
    newest_ = {};
    fault_ = spacemouse_fault::none;
    started_ = false;
    silent_ = false;
    last_axes_ = no_axes;
    machine_.apply(device_event::prepared);
    return {};
  }

  [[nodiscard]] result<void> arm() {
    if (!machine_.apply(device_event::armed)) return refused("arm");
    return {};
  }

  [[nodiscard]] result<void> clear_fault() {
    if (!machine_.apply(device_event::cleared)) return refused("clear_fault");
    link_.reset();
    return {};
  }

  status disarm() noexcept {
    shown_ = {};
    return machine_.apply(device_event::disarmed) ? status::ok : status::not_ready;
  }

  void close() noexcept {
    shown_ = {};
    if (machine_.apply(device_event::closed)) link_.reset();
  }

  /// @return ok | not_ready (not open, unplugged, or in fault) | backend_failed (the link failed: a fault)
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    if (!measures()) return status::not_ready;
    if (!started_) {
      started_ = true;
      last_read_ns_ = last_report_ns_ = now_ns;
    }
    const status s = drain(now_ns);
    if (s != status::ok) return s;
    judge_silence(now_ns);
    if (!silent_) {
      motion_.advance(now_ns - last_read_ns_);
      measure(now_ns);
    }
    last_read_ns_ = now_ns;
    in = newest_;
    return status::ok;
  }

  /// @return ok | not_ready (not open, unplugged, or in fault) | not_finite (a fault)
  [[nodiscard]] status write(std::int64_t /*now_ns*/, const device_command& out) noexcept {
    if (!measures()) return status::not_ready;
    shown_ = {};
    if (!may_put_out(machine_.state())) return status::ok;
    if (out.frame != wrench_frame::device_base || !is_finite(out.on_hand)) {
      fail(spacemouse_fault::bad_command, device_event::failed);
      return status::not_finite;
    }
    const bool zero = is_zero(out.on_hand);
    machine_.apply(zero ? device_event::released : device_event::engaged);
    shown_ = out.on_hand;
    return status::ok;
  }

  /// Switches the light around the cap. Never in a tick: the kernel waits for the device.
  [[nodiscard]] result<void> set_light(bool on) {
    if (!measures()) return refused("set_light");
    std::array<std::uint8_t, 64> bytes{};
    const std::span<const std::uint8_t> report = format_.encode_light(on, bytes);
    if (report.empty()) return error{error_code::unsupported, "this SpaceMouse says that it has no light"};
    const io_status s = link_->write(last_read_ns_, report);
    if (s == io_status::ok) return {};
    if (s == io_status::gone) fail(spacemouse_fault::unplugged, device_event::departed);
    return error{error_code::io_failed, std::string("the light of the SpaceMouse was not switched: ") + to_string(s)};
  }

  /// The wrench that a device with motors would put on the hand now.
  [[nodiscard]] const wrench& shown() const noexcept { return shown_; }
  /// Why it is in fault or went away.
  [[nodiscard]] spacemouse_fault fault() const noexcept { return fault_; }
  [[nodiscard]] const spacemouse_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] const spacemouse_format& format() const noexcept { return format_; }
  /// The newest of every value that came in; has_battery says whether the device ever told.
  [[nodiscard]] const spacemouse_input& input() const noexcept { return input_; }

 private:
  // More than the kernel keeps: a device that sends faster than this cannot hold up a tick for ever.
  static constexpr int most_reports_per_read = 128;

  [[nodiscard]] bool measures() const noexcept { return link_ != nullptr && asperity::measures(machine_.state()); }

  [[nodiscard]] error refused(const char* what) const {
    return {error_code::invalid_argument,
            std::string(what) + "() is not possible while the SpaceMouse is " + to_string(machine_.state())};
  }

  void fail(spacemouse_fault why, device_event e) noexcept {
    shown_ = {};
    fault_ = why;
    machine_.apply(e);
  }

  [[nodiscard]] status drain(std::int64_t now_ns) noexcept {
    std::array<std::uint8_t, 64> bytes{};
    for (int i = 0; i < most_reports_per_read; ++i) {
      hid_report report;
      const io_status s = link_->read(now_ns, bytes, report);
      if (s == io_status::nothing) return status::ok;
      if (s == io_status::gone) {
        fail(spacemouse_fault::unplugged, device_event::departed);
        return status::not_ready;
      }
      if (s != io_status::ok) {
        fail(spacemouse_fault::read_failed, device_event::failed);
        return status::backend_failed;
      }
      take(now_ns, std::span<const std::uint8_t>(bytes).first(std::min(report.size, bytes.size())));
    }
    return status::ok;
  }

  void take(std::int64_t now_ns, std::span<const std::uint8_t> report) noexcept {
    spacemouse_input got;
    switch (format_.decode(report, got)) {
      case spacemouse_decoding::unknown:
        ++counts_.unknown;
        return;
      case spacemouse_decoding::too_short:
        ++counts_.too_short;
        ++newest_.lost;
        return;
      case spacemouse_decoding::understood:
        break;
    }
    ++counts_.reports;
    if (got.has_buttons) {
      input_.has_buttons = true;
      input_.buttons = got.buttons;
    }
    if (got.has_battery) {
      input_.has_battery = true;
      input_.battery_percent = got.battery_percent;
      input_.charging = got.charging;
    }
    if (got.brought == no_axes) return;
    if (got.brought == last_axes_ && got.brought != format_.axes()) ++newest_.lost;
    last_axes_ = got.brought;
    std::array<double, 6> share{};
    for (std::size_t i = 0; i < 6; ++i) {
      if ((got.brought & (1U << i)) != 0) input_.counts[i] = got.counts[i];
      share[i] = static_cast<double>(input_.counts[i]) / format_.full_scale(i);
    }
    input_.brought = static_cast<axis_mask>(input_.brought | got.brought);
    motion_.displace(share);
    last_report_ns_ = now_ns;
    silent_ = false;
  }

  void judge_silence(std::int64_t now_ns) noexcept {
    if (silent_ || motion_.at_rest() || now_ns - last_report_ns_ <= settings_.silence_limit_ns) return;
    silent_ = true;
    ++counts_.silences;
  }

  void measure(std::int64_t now_ns) noexcept {
    newest_.host_time_ns = now_ns;
    newest_.device_time_ns = last_report_ns_;
    ++newest_.sequence;
    newest_.T_dh = motion_.T_dh();
    newest_.velocity_d = motion_.velocity_d();
    newest_.buttons = input_.buttons;
    newest_.valid = sample_field::position | sample_field::rotation | sample_field::linear_velocity |
                    sample_field::angular_velocity | sample_field::buttons;
  }

  void describe() noexcept {
    const spacemouse_motion_settings& m = motion_.settings();
    capabilities_ = {};
    capabilities_.name = settings_.name;
    capabilities_.maturity = driver_maturity::protocol_tested;
    capabilities_.sensed = format_.axes();
    capabilities_.actuated = no_axes;
    capabilities_.continuous_force_n = capabilities_.peak_force_n = settings_.shown_force_n;
    capabilities_.continuous_torque_n_m = capabilities_.peak_torque_n_m = settings_.shown_torque_n_m;
    capabilities_.force_slew_n_per_s = 1e3 * settings_.shown_force_n;
    capabilities_.torque_slew_n_m_per_s = 1e3 * settings_.shown_torque_n_m;
    capabilities_.workspace_low_d = m.workspace_low_d;
    capabilities_.workspace_high_d = m.workspace_high_d;
    capabilities_.nominal_rate_hz = 125.0;
    capabilities_.worst_latency_ns = 16'000'000;
  }

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
