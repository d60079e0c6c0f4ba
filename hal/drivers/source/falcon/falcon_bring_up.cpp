#include "falcon_bring_up.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

namespace asperity {

falcon_bring_up::falcon_bring_up(falcon_wire& wire, io_clock& clock, const falcon_settings& settings,
                                 const std::string& path)
    : wire_(wire), clock_(clock), settings_(settings), path_(path) {}

result<void> falcon_bring_up::run() {
  result<bool> answers = is_awake();
  if (!answers) return answers.error();
  if (!*answers) {
    const result<void> awake = wake();
    if (!awake) return awake;
  }
  const result<void> homed = home();
  if (!homed) return homed;
  return settle();
}

error falcon_bring_up::lost(const std::string& step, io_status s) const {
  return {error_code::io_failed, "the Falcon at " + path_ + " failed while " + step + ": " + to_string(s)};
}

io_status falcon_bring_up::exchange(falcon_light light, bool home) noexcept {
  const std::int64_t now_ns = clock_.now_ns();
  last_frame_ns_ = now_ns;
  io_status s = wire_.send(now_ns, {.motor_counts = {}, .light = light, .home = home});
  if (s != io_status::ok && s != io_status::busy) return s;
  clock_.wait_until_ns(now_ns + tick_ns);
  return wire_.receive(clock_.now_ns());
}

result<bool> falcon_bring_up::is_awake() {
  io_status s = apply_ftdi(*wire_.link(), falcon_normal_settings, falcon_control_timeout_ns);
  if (s != io_status::ok) return lost("setting its line up", s);
  const std::uint64_t before = wire_.reports();
  const std::int64_t due_ns = clock_.now_ns() + settings_.wake_ns;
  while (wire_.reports() == before && clock_.now_ns() < due_ns) {
    s = exchange(falcon_light::red, false);
    if (s != io_status::ok) return lost("waiting for its first report", s);
  }
  return wire_.reports() != before;
}

result<void> falcon_bring_up::wake() {
  if (settings_.firmware_path.empty()) {
    return error{error_code::invalid_argument,
                 "the Falcon at " + path_ +
                     " has no firmware yet and no image was given: name your copy of Novint's image as its firmware "
                     "path; asperity ships none, because its licence is Novint's own and noncommercial"};
  }
  const auto image = read_falcon_image(settings_.firmware_path);
  if (!image) return image.error();
  result<void> loaded;
  for (int i = 0; i < settings_.firmware_attempts; ++i) {
    loaded = load_falcon_firmware(*wire_.link(), clock_, *image);
    if (!loaded) continue;
    const result<bool> answers = is_awake();
    if (!answers) return answers.error();
    if (*answers) return {};
  }
  if (!loaded) return loaded;
  return error{error_code::io_failed, "the Falcon at " + path_ + " took the firmware image '" +
                                          settings_.firmware_path + "' and does not answer; is it the right image?"};
}

result<void> falcon_bring_up::home() {
  const std::int64_t due_ns = clock_.now_ns() + settings_.homing_timeout_ns;
  while (wire_.homed() != falcon_all_homed) {
    if (clock_.now_ns() >= due_ns) {
      return error{error_code::io_failed, "the Falcon at " + path_ +
                                              " was not homed in time: while its light is red, push the grip all "
                                              "the way in and pull it out again"};
    }
    const io_status s = exchange(falcon_light::red, true);
    if (s != io_status::ok) return lost("homing", s);
  }
  return {};
}

result<void> falcon_bring_up::settle() {
  wire_.demand_homing(true);
  wire_.forget_encoders();
  const std::uint64_t enough = wire_.positions() + static_cast<std::uint64_t>(std::max(settings_.settle_reports, 1));
  const std::int64_t due_ns = clock_.now_ns() + settings_.wake_ns;
  while (wire_.positions() < enough) {
    if (clock_.now_ns() >= due_ns) {
      return error{error_code::io_failed,
                   "the Falcon at " + path_ + " reports no position that can be believed; home it again"};
    }
    const io_status s = exchange(falcon_light::blue, false);
    if (s != io_status::ok) return lost("taking its first positions", s);
  }
  return {};
}

}  // namespace asperity
