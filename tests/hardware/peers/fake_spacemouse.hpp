// A SpaceMouse that is made of numbers: sends what the real ones were recorded to send, when they do.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "hardware/peers/hid_items.hpp"

namespace asperity::test_support {

enum class spacemouse_kind { classic, combined };

/// The far end of a HID device. A pushed cap reports every 8 ms (classic: shifts and turns in turns) or 16 ms; after a
/// release come three zeros of every kind; then nothing.
class fake_spacemouse {
 public:
  using sender = std::function<void(std::int64_t now_ns, std::span<const std::uint8_t> report)>;

  fake_spacemouse(spacemouse_kind kind, sender send) : kind_(kind), send_(std::move(send)) {}

  [[nodiscard]] static std::vector<std::uint8_t> descriptor(spacemouse_kind kind) {
    return kind == spacemouse_kind::classic ? space_navigator_descriptor() : spacemouse_wireless_descriptor();
  }

  /// The hand pushes the cap: counts of x y z and of the turns about them, device axes.
  void push(const std::array<std::int16_t, 6>& counts) noexcept {
    counts_ = counts;
    zeros_ = counts == std::array<std::int16_t, 6>{} ? zeros_ : zero_reports();
  }
  void release() noexcept { counts_ = {}; }

  void press(std::int64_t now_ns, std::uint16_t buttons) {
    const std::array<std::uint8_t, 3> r{3, static_cast<std::uint8_t>(buttons), static_cast<std::uint8_t>(buttons >> 8)};
    send_(now_ns, r);
  }
  void report_battery(std::int64_t now_ns, std::uint8_t percent, bool charging) {
    const std::array<std::uint8_t, 3> r{0x17, percent, static_cast<std::uint8_t>(charging ? 1 : 0)};
    send_(now_ns, r);
  }

  /// What the host sent.
  void take(std::span<const std::uint8_t> report) {
    if (report.size() == 2 && report[0] == 4) {
      light_ = (report[1] & 1U) != 0;
    } else {
      ++not_understood_;
    }
  }

  /// Sends what is due by now.
  void step(std::int64_t now_ns) {
    if (!started_) next_ns_ = now_ns;
    started_ = true;
    while (next_ns_ <= now_ns) {
      const bool pushed = counts_ != std::array<std::int16_t, 6>{};
      if (pushed || zeros_ > 0) {
        if (!pushed) --zeros_;
        send_axes(now_ns);
      }
      next_ns_ += period_ns();
    }
  }

  [[nodiscard]] std::int64_t period_ns() const noexcept {
    return kind_ == spacemouse_kind::classic ? 8'000'000 : 16'000'000;
  }
  [[nodiscard]] bool light() const noexcept { return light_; }
  [[nodiscard]] int not_understood() const noexcept { return not_understood_; }

 private:
  [[nodiscard]] int zero_reports() const noexcept { return kind_ == spacemouse_kind::classic ? 6 : 3; }

  void send_axes(std::int64_t now_ns) {
    const bool both = kind_ == spacemouse_kind::combined;
    const std::size_t first = !both && turns_next_ ? 3 : 0;
    const std::size_t n = both ? 6 : 3;
    std::array<std::uint8_t, 13> r{};
    r[0] = first == 3 ? 2 : 1;
    for (std::size_t i = 0; i < n; ++i) {
      const auto bits = static_cast<std::uint16_t>(counts_[first + i]);
      r[1 + 2 * i] = static_cast<std::uint8_t>(bits);
      r[2 + 2 * i] = static_cast<std::uint8_t>(bits >> 8);
    }
    turns_next_ = !turns_next_;
    send_(now_ns, std::span<const std::uint8_t>(r).first(1 + 2 * n));
  }

  spacemouse_kind kind_;
  sender send_;
  std::array<std::int16_t, 6> counts_{};
  int zeros_ = 0;
  bool turns_next_ = false;
  bool started_ = false;
  std::int64_t next_ns_ = 0;
  bool light_ = false;
  int not_understood_ = 0;
};

}  // namespace asperity::test_support
