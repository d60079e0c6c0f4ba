// A Falcon as seen from its USB plug: boot program, firmware, homing, and the way an FTDI chip cuts bytes into packets.
//
// It knows no transport: bytes and control requests go in, transfers come out, so that it stands behind a virtual cable
// and behind a kernel's alike. Its encoders follow a position that the test sets; the driver's own kinematics turn it
// into angles, and are held against published numbers elsewhere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "asperity/drivers/falcon/falcon_torque.hpp"
#include "asperity/drivers/falcon/ftdi_line.hpp"

namespace asperity::test_support {

struct fake_falcon_settings {
  std::vector<std::uint8_t> image{};  ///< what it wants before it runs
  bool awake = false;                 ///< the firmware runs from the start
  bool homed = false;
  int frames_to_home = 12;  ///< until a person has homed it, from the first request on
  bool split = false;       ///< reports are cut into seeded pieces and melt together
  long wrong_echo_at = -1;  ///< byte of the image that is repeated wrongly
  int wrong_echoes = 1;     ///< so many times
  std::uint64_t seed = 1;
};

class fake_falcon {
 public:
  explicit fake_falcon(fake_falcon_settings settings = {}) : settings_(std::move(settings)), bits_(settings_.seed) {
    power_on();
  }

  /// As after plugging the power in.
  void power_on() {
    mode_ = settings_.awake ? mode::running : mode::asleep;
    homed_ = settings_.homed ? falcon_all_homed : 0;
    homing_frames_ = 0;
    applied_ = {};
    stored_.clear();
    waiting_.clear();
    frames_ = {};
    baud_ = 0;
  }

  void set_position(const vec3& grip_d) { position_ = grip_d; }
  void set_buttons(std::uint8_t buttons) { buttons_ = buttons; }
  /// The next reports say these encoders, whatever the position.
  void force_encoders(std::array<std::int16_t, 3> counts) { forced_ = {true, counts}; }
  void free_encoders() { forced_.first = false; }
  void forget_homing() {
    homed_ = 0;
    settings_.frames_to_home = 1 << 30;
  }
  void fall_silent(bool silent) { silent_ = silent; }

  /// What the motors do now.
  [[nodiscard]] const std::array<std::int16_t, 3>& applied() const { return applied_; }
  [[nodiscard]] bool at_rest() const { return applied_ == std::array<std::int16_t, 3>{}; }
  /// Largest number that a motor was ever sent.
  [[nodiscard]] int largest_applied() const { return largest_; }
  /// The force of the motors on the hand, N, as far as the counts tell.
  [[nodiscard]] vec3 force_d() const {
    const auto angles = falcon_angles_at(position_);
    const auto gradients = falcon_angle_gradients(position_, *angles);
    vec3 force{0.0};
    for (int i = 0; i < 3; ++i) {
      force += applied_[static_cast<std::size_t>(i)] / falcon_counts_per_n_m * (*gradients)[i];
    }
    return force;
  }
  [[nodiscard]] bool running() const { return mode_ == mode::running; }
  [[nodiscard]] std::uint64_t commands() const { return commands_; }
  [[nodiscard]] falcon_light light() const { return light_; }
  [[nodiscard]] int boots() const { return boots_; }

  // --- the plug ---

  io_status control(const usb_setup& setup, std::span<std::uint8_t>, std::size_t& done) {
    done = 0;
    if (setup.request_type != 0x40) return io_status::refused;
    switch (static_cast<ftdi_request>(setup.request)) {
      case ftdi_request::reset:
        if (setup.value == ftdi_purge_receive) waiting_.clear();
        break;
      case ftdi_request::baud:
        set_baud(setup.value);
        break;
      case ftdi_request::modem:
        if (setup.value == ftdi_dtr_low) dtr_ = false;
        if (setup.value == ftdi_dtr_high && !std::exchange(dtr_, true) && baud_ == 0x4138) restart();
        break;
      case ftdi_request::flow:
      case ftdi_request::data:
      case ftdi_request::latency:
        break;
      default:
        return io_status::refused;
    }
    return io_status::ok;
  }

  void receive(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) take(byte);
  }

  /// The next transfer to the host, at most 512 bytes. @return its size: at least the chip's two bytes of status
  std::size_t transmit(std::span<std::uint8_t> transfer) {
    std::size_t payload = std::min<std::size_t>(waiting_.size(), 5 * ftdi_payload_size);
    if (settings_.split && payload > 0) payload = bits_() % (payload + 1);
    std::size_t size = 0;
    do {
      transfer[size++] = 0x01;
      transfer[size++] = 0x60;
      for (std::size_t i = 0; i < ftdi_payload_size && payload > 0; ++i, --payload) {
        transfer[size++] = waiting_.front();
        waiting_.pop_front();
      }
    } while (payload > 0);
    return size;
  }

  /// Whether there is more to say than the chip's status.
  [[nodiscard]] bool has_payload() const { return !waiting_.empty(); }

 private:
  enum class mode { asleep, greeting, announced, loading, running };

  void restart() {
    ++boots_;
    mode_ = mode::greeting;
    greeting_ = 0;
    stored_.clear();
    applied_ = {};
  }

  void set_baud(std::uint16_t divisor) {
    baud_ = divisor;
    if (divisor == 2 && mode_ == mode::loading && !stored_.empty()) {
      mode_ = stored_ == settings_.image ? mode::running : mode::asleep;
    }
  }

  void say(std::span<const std::uint8_t> bytes) { waiting_.insert(waiting_.end(), bytes.begin(), bytes.end()); }

  void take(std::uint8_t byte) {
    constexpr std::array<std::uint8_t, 3> greeting = {0x0a, 0x43, 0x0d};
    constexpr std::array<std::uint8_t, 5> welcome = {0x00, 0x0a, 0x44, 0x2c, 0x0d};
    if (mode_ == mode::greeting && baud_ == 0x4138) {
      greeting_ = byte == greeting[greeting_] ? greeting_ + 1 : 0;
      if (greeting_ < greeting.size()) return;
      mode_ = mode::announced;
      say(welcome);
    } else if (mode_ == mode::announced && baud_ == 0x15 && byte == 0x41) {
      mode_ = mode::loading;
      say(std::span(&byte, 1));
    } else if (mode_ == mode::loading && baud_ == 0x15) {
      const bool wrong = static_cast<long>(stored_.size()) == settings_.wrong_echo_at && settings_.wrong_echoes > 0;
      if (wrong) --settings_.wrong_echoes;
      stored_.push_back(byte);
      const auto echo = static_cast<std::uint8_t>(wrong ? byte ^ 0x10 : byte);
      say(std::span(&echo, 1));
    } else if (mode_ == mode::running && baud_ == 2) {
      const auto frame = frames_.push(byte);
      const auto command = frame ? decode_falcon_command(*frame) : std::nullopt;
      if (command) obey(*command);
    }
  }

  void obey(const falcon_command& command) {
    ++commands_;
    applied_ = command.motor_counts;
    light_ = command.light;
    for (const std::int16_t c : applied_) largest_ = std::max(largest_, std::abs(static_cast<int>(c)));
    if (command.home && ++homing_frames_ >= settings_.frames_to_home) homed_ = falcon_all_homed;
    if (silent_) return;
    falcon_report report{.encoder_counts = {}, .buttons = buttons_, .homed = homed_};
    if (forced_.first) {
      report.encoder_counts = forced_.second;
    } else if (const auto angles = falcon_angles_at(position_)) {
      for (std::size_t i = 0; i < 3; ++i) {
        report.encoder_counts[i] =
            static_cast<std::int16_t>(std::lround(((*angles)[i] - falcon_angle_at_zero_rad) / falcon_rad_per_count));
      }
    }
    say(encode_falcon_report(report));
  }

  fake_falcon_settings settings_;
  std::mt19937_64 bits_;
  mode mode_ = mode::asleep;
  std::uint16_t baud_ = 0;
  bool dtr_ = false;
  std::size_t greeting_ = 0;
  std::vector<std::uint8_t> stored_{};
  std::deque<std::uint8_t> waiting_{};
  falcon_deframer frames_{};
  vec3 position_{0.0, 0.0, 0.11};
  std::uint8_t buttons_ = 0;
  std::uint8_t homed_ = 0;
  int homing_frames_ = 0;
  int boots_ = 0;
  bool silent_ = false;
  std::pair<bool, std::array<std::int16_t, 3>> forced_{};
  std::array<std::int16_t, 3> applied_{};
  int largest_ = 0;
  falcon_light light_ = falcon_light::none;
  std::uint64_t commands_ = 0;
};

}  // namespace asperity::test_support
