#include "asperity/drivers/falcon/falcon_device.hpp"

#include <cstdint>
#include <string>
#include <utility>

#include "asperity/drivers/falcon/falcon_torque.hpp"
#include "falcon_bring_up.hpp"

namespace asperity {

falcon_device::falcon_device(usb_finder& finder, io_clock& clock, usb_listing which, falcon_settings settings)
    : finder_(&finder), clock_(&clock), which_(std::move(which)), settings_(std::move(settings)) {}

result<void> falcon_device::open() {
  if (machine_.state() == device_state::absent || machine_.state() == device_state::closed) {
    machine_.apply(device_event::arrived);
  }
  if (machine_.state() != device_state::present) return refused("open");
  wire_.detach();
  result<usb_listing> where = find();
  if (!where) return where.error();
  which_ = *where;
  auto link = finder_->open(which_, pipes());
  if (!link) return link.error();
  wire_.attach(std::move(*link));
  machine_.apply(device_event::opened);
  fault_ = falcon_fault::none;
  command_ = {};
  busy_ = 0;
  wrote_ = false;
  falcon_bring_up bring_up(wire_, *clock_, settings_, which_.path);
  result<void> ready = bring_up.run();
  if (!ready) {
    close();
    return ready;
  }
  last_now_ns_ = bring_up.last_frame_ns();
  measure();
  machine_.apply(device_event::prepared);
  return {};
}

result<void> falcon_device::arm() {
  if (!machine_.apply(device_event::armed)) return refused("arm");
  command_ = {};
  return {};
}

result<void> falcon_device::clear_fault() {
  if (!machine_.apply(device_event::cleared)) return refused("clear_fault");
  fault_ = falcon_fault::none;
  wire_.detach();
  return {};
}

status falcon_device::disarm() noexcept {
  command_ = {};
  const bool possible = machine_.apply(device_event::disarmed);
  const status sent = put_out(last_now_ns_, vec3(0.0));
  return possible ? sent : status::not_ready;
}

void falcon_device::close() noexcept {
  command_ = {};
  if (wire_.link() != nullptr) {
    send_last_zero();
    wire_.detach();
  }
  machine_.apply(device_event::closed);
}

status falcon_device::read(std::int64_t now_ns, device_sample& in) noexcept {
  last_now_ns_ = now_ns;
  if (!measures()) return owe_zero(now_ns);
  const io_status s = wire_.receive(now_ns);
  if (wire_.fresh()) measure();
  if (s != io_status::ok) return stop(now_ns, s);
  if (wire_.silence_ns(now_ns) > settings_.silent_after_ns) return stop(now_ns, falcon_fault::silent);
  if (wire_.doubted_in_a_row() >= settings_.doubt_limit) {
    const bool homing = wire_.doubt() == falcon_doubt::not_homed;
    return stop(now_ns, homing ? falcon_fault::homing_lost : falcon_fault::not_believable);
  }
  if (!std::exchange(wrote_, false)) {
    const status polled = put_out(now_ns, now_ns <= command_.valid_until_ns ? command_.on_hand.force : vec3(0.0));
    wrote_ = false;
    if (polled != status::ok) return polled;
  }
  in = newest_;
  return status::ok;
}

status falcon_device::write(std::int64_t now_ns, const device_command& out) noexcept {
  last_now_ns_ = now_ns;
  if (!measures()) return owe_zero(now_ns);
  if (!may_put_out(machine_.state())) return put_out(now_ns, vec3(0.0));
  if (out.frame != wrench_frame::device_base || !is_finite(out.on_hand)) {
    stop(now_ns, falcon_fault::bad_command);
    return status::not_finite;
  }
  command_ = out;
  machine_.apply(out.on_hand.force == vec3(0.0) ? device_event::released : device_event::engaged);
  return put_out(now_ns, now_ns <= out.valid_until_ns ? out.on_hand.force : vec3(0.0));
}

usb_pipes falcon_device::pipes() noexcept {
  return {.interface = 0, .in = 0x81, .out = 0x02, .transfer_bytes = 512, .in_transfers = 8, .out_transfers = 4};
}

result<usb_listing> falcon_device::find() {
  const auto found = finder_->list(falcon_vendor, falcon_product);
  if (!found) return found.error();
  for (const usb_listing& l : *found) {
    if (l.path == which_.path && l.serial == which_.serial) return l;
  }
  for (const usb_listing& l : *found) {
    if (!which_.serial.empty() && l.serial == which_.serial) return l;
  }
  return error{error_code::io_failed,
               "the Falcon that was at " + which_.path + " is not plugged in; connect it and open it again"};
}

error falcon_device::refused(const char* what) const {
  std::string why = std::string(what) + "() is not possible while the Falcon is " + to_string(machine_.state());
  if (fault_ != falcon_fault::none) why += std::string(", because ") + to_string(fault_);
  return {error_code::invalid_argument, why};
}

void falcon_device::send_last_zero() noexcept {
  int zeros = 2;
  for (int tries = 0; tries < 20 && zeros > 0; ++tries) {
    const std::int64_t now_ns = clock_->now_ns();
    const io_status s = wire_.send(now_ns, {});
    if (s == io_status::gone) return;
    if (s == io_status::ok) --zeros;
    if (zeros > 0) clock_->wait_until_ns(now_ns + tick_ns);
  }
}

void falcon_device::measure() noexcept {
  newest_.host_time_ns = wire_.report_ns();
  newest_.device_time_ns = wire_.report_ns();  // it has no clock of its own
  newest_.sequence = wire_.positions();
  newest_.lost = wire_.lost();
  newest_.T_dh = {quat(1.0, 0.0, 0.0, 0.0), wire_.grip_d()};
  newest_.buttons = wire_.report().buttons;
  newest_.valid = sample_field::position | sample_field::buttons;
}

status falcon_device::put_out(std::int64_t now_ns, const vec3& force_d) noexcept {
  if (wire_.link() == nullptr) return status::not_ready;
  falcon_command frame{.light = falcon_light::blue};
  if (may_put_out(machine_.state())) {
    frame.light = falcon_light::green;
    const bool placed = now_ns - wire_.report_ns() <= settings_.silent_after_ns;
    if (placed && force_d != vec3(0.0)) {
      frame.motor_counts = falcon_counts_for(wire_.grip_d(), wire_.angles(), force_d, settings_.limit_counts);
    }
  } else if (machine_.state() == device_state::fault) {
    frame.light = falcon_light::red;
  }
  wrote_ = true;
  const io_status s = wire_.send(now_ns, frame);
  if (s == io_status::busy && ++busy_ <= settings_.busy_limit) return status::ok;
  if (s != io_status::ok) return stop(now_ns, s);
  busy_ = 0;
  return status::ok;
}

status falcon_device::owe_zero(std::int64_t now_ns) noexcept {
  if (wire_.link() != nullptr) static_cast<void>(wire_.send(now_ns, {.light = falcon_light::red}));
  return status::not_ready;
}

status falcon_device::stop(std::int64_t now_ns, io_status s) noexcept {
  if (s == io_status::gone) return stop(now_ns, falcon_fault::unplugged);
  return stop(now_ns, s == io_status::busy ? falcon_fault::link_full : falcon_fault::link_failed);
}

status falcon_device::stop(std::int64_t now_ns, falcon_fault cause) noexcept {
  if (fault_ == falcon_fault::none) fault_ = cause;
  command_ = {};
  machine_.apply(cause == falcon_fault::unplugged ? device_event::departed : device_event::failed);
  static_cast<void>(owe_zero(now_ns));
  return status::backend_failed;
}

}  // namespace asperity
