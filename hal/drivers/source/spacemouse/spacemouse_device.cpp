#include "asperity/drivers/spacemouse/spacemouse_device.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

namespace asperity {

spacemouse_device::spacemouse_device(link_opener opener, const spacemouse_settings& settings)
    : opener_(std::move(opener)), settings_(settings), motion_(settings.motion), machine_(device_state::present) {
  describe();
}

result<void> spacemouse_device::open() {
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

result<void> spacemouse_device::arm() {
  if (!machine_.apply(device_event::armed)) return refused("arm");
  return {};
}

result<void> spacemouse_device::clear_fault() {
  if (!machine_.apply(device_event::cleared)) return refused("clear_fault");
  link_.reset();
  return {};
}

status spacemouse_device::disarm() noexcept {
  shown_ = {};
  return machine_.apply(device_event::disarmed) ? status::ok : status::not_ready;
}

void spacemouse_device::close() noexcept {
  shown_ = {};
  if (machine_.apply(device_event::closed)) link_.reset();
}

status spacemouse_device::read(std::int64_t now_ns, device_sample& in) noexcept {
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

status spacemouse_device::write(std::int64_t /*now_ns*/, const device_command& out) noexcept {
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

result<void> spacemouse_device::set_light(bool on) {
  if (!measures()) return refused("set_light");
  std::array<std::uint8_t, 64> bytes{};
  const std::span<const std::uint8_t> report = format_.encode_light(on, bytes);
  if (report.empty()) return error{error_code::unsupported, "this SpaceMouse says that it has no light"};
  const io_status s = link_->write(last_read_ns_, report);
  if (s == io_status::ok) return {};
  if (s == io_status::gone) fail(spacemouse_fault::unplugged, device_event::departed);
  return error{error_code::io_failed, std::string("the light of the SpaceMouse was not switched: ") + to_string(s)};
}

error spacemouse_device::refused(const char* what) const {
  return {error_code::invalid_argument,
          std::string(what) + "() is not possible while the SpaceMouse is " + to_string(machine_.state())};
}

void spacemouse_device::fail(spacemouse_fault why, device_event e) noexcept {
  shown_ = {};
  fault_ = why;
  machine_.apply(e);
}

status spacemouse_device::drain(std::int64_t now_ns) noexcept {
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

void spacemouse_device::take(std::int64_t now_ns, std::span<const std::uint8_t> report) noexcept {
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

void spacemouse_device::judge_silence(std::int64_t now_ns) noexcept {
  if (silent_ || motion_.at_rest() || now_ns - last_report_ns_ <= settings_.silence_limit_ns) return;
  silent_ = true;
  ++counts_.silences;
}

void spacemouse_device::measure(std::int64_t now_ns) noexcept {
  newest_.host_time_ns = now_ns;
  newest_.device_time_ns = last_report_ns_;
  ++newest_.sequence;
  newest_.T_dh = motion_.T_dh();
  newest_.velocity_d = motion_.velocity_d();
  newest_.buttons = input_.buttons;
  newest_.valid = sample_field::position | sample_field::rotation | sample_field::linear_velocity |
                  sample_field::angular_velocity | sample_field::buttons;
}

void spacemouse_device::describe() noexcept {
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

}  // namespace asperity
