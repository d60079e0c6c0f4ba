#include "asperity/device/replay_device.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace asperity {

bool same_bits(const device_command& a, const device_command& b) noexcept {
  const auto same = [](const vec3& u, const vec3& v) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    return bits(u.x) == bits(v.x) && bits(u.y) == bits(v.y) && bits(u.z) == bits(v.z);
  };
  return same(a.on_hand.force, b.on_hand.force) && same(a.on_hand.torque, b.on_hand.torque) && a.frame == b.frame &&
         a.valid_until_ns == b.valid_until_ns && a.sequence == b.sequence;
}

replay_device::replay_device(device_recording recording) : recording_(std::move(recording)), state_(recording_.before) {
  name_view();
}

replay_device& replay_device::operator=(replay_device&& from) noexcept {
  recording_ = std::move(from.recording_);
  state_ = from.state_;
  next_ = from.next_;
  differences_ = from.differences_;
  first_difference_ = from.first_difference_;
  name_view();
  return *this;
}

status replay_device::disarm() noexcept {
  const call_record* c = take(device_call::disarm, 0);
  return c == nullptr ? status::not_ready : c->answered;
}

status replay_device::read(std::int64_t now_ns, device_sample& in) noexcept {
  const call_record* c = take(device_call::read, now_ns);
  if (c == nullptr) return status::backend_failed;
  in = c->sample;
  return c->answered;
}

status replay_device::write(std::int64_t now_ns, const device_command& out) noexcept {
  const call_record* c = take(device_call::write, now_ns);
  if (c == nullptr) return status::backend_failed;
  if (!same_bits(out, c->command)) differs(next_ - 1);
  return c->answered;
}

void replay_device::differs(std::size_t at) noexcept {
  if (differences_++ == 0) first_difference_ = at;
}

const call_record* replay_device::take(device_call call, std::int64_t now_ns) noexcept {
  if (finished() || recording_.calls[next_].call != call || recording_.calls[next_].now_ns != now_ns) {
    differs(next_);
    return nullptr;
  }
  const call_record& c = recording_.calls[next_++];
  state_ = c.after;
  return &c;
}

result<void> replay_device::outside(device_call call, const char* name) {
  const call_record* c = take(call, 0);
  if (c == nullptr) {
    return error{error_code::invalid_argument, std::string(name) + "() is not what the recording holds as call " +
                                                   std::to_string(next_) +
                                                   ": replay it through the program that recorded it"};
  }
  if (c->answered == status::ok) return {};
  return error{error_code::io_failed, std::string(name) + "() failed when the session was recorded"};
}

}  // namespace asperity
