// A fake Falcon on a virtual cable, the clock that drives it, and the real driver at the other end.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include "asperity/drivers/falcon/falcon_device.hpp"
#include "asperity/transport/virtual/manual_clock.hpp"
#include "asperity/transport/virtual/virtual_usb.hpp"
#include "hardware/peers/fake_falcon.hpp"

namespace asperity::test_support {

/// Bytes that stand for a firmware image, and the file they are in while this lives.
class fake_image {
 public:
  explicit fake_image(std::size_t size = 150) {
    for (std::size_t i = 0; i < size; ++i) bytes_.push_back(static_cast<std::uint8_t>(i * 37 + 11));
    static int count = 0;
    path_ = "falcon-image-" + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".bin";
    std::ofstream file(path_, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes_.data()), static_cast<std::streamsize>(size));
  }
  ~fake_image() { std::remove(path_.c_str()); }
  fake_image(const fake_image&) = delete;
  fake_image& operator=(const fake_image&) = delete;

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::string path_;
};

/// Short waits, so that thousands of openings take no time.
[[nodiscard]] inline falcon_settings quick_settings() {
  falcon_settings c;
  c.wake_ns = 20'000'000;
  c.homing_timeout_ns = 200'000'000;
  c.settle_reports = 5;
  return c;
}

struct falcon_rig {
  explicit falcon_rig(fake_falcon_settings fake = {}, link_script script = {},
                      falcon_settings settings = quick_settings(), std::int64_t clock_step_ns = 250'000)
      : clock(1'000'000'000, clock_step_ns), cable(std::move(script)), peer(std::move(fake)) {
    bus.attach(cable, listing());
    cable.on_control([this](const usb_setup& setup, std::span<std::uint8_t> data, std::size_t& done) {
      return peer.control(setup, data, done);
    });
    clock.on_advance([this](std::int64_t now_ns) { step(now_ns); });
    device = std::make_unique<falcon_device>(bus, clock, listing(), std::move(settings));
  }

  [[nodiscard]] static usb_listing listing() {
    return {.vendor = falcon_vendor, .product = falcon_product, .serial = "F1", .path = "1-2", .name = "Novint Falcon"};
  }

  void step(std::int64_t now_ns) {
    std::array<std::uint8_t, 512> buffer{};
    while (const std::size_t size = cable.take(now_ns, buffer)) peer.receive(std::span(buffer).first(size));
    if (!cable.plugged()) peer.power_on();  // it is fed by its own supply, but a person pulls both
    const bool status_due = now_ns - last_given_ns >= 1'000'000;
    if (!cable.is_open() || !(peer.has_payload() || status_due)) return;
    const std::size_t size = peer.transmit(buffer);
    cable.give(now_ns, std::span(buffer).first(size));
    last_given_ns = now_ns;
  }

  /// One tick of a session: read, write, and a millisecond passes. @return the worse of both answers
  status tick(const vec3& force_d) {
    const std::int64_t now_ns = clock.now_ns();
    const status got = device->read(now_ns, seen);
    const status put = device->write(now_ns, command(force_d));
    clock.advance_ns(1'000'000);
    return got != status::ok ? got : put;
  }

  [[nodiscard]] device_command command(const vec3& force_d) {
    return {.on_hand = {force_d, vec3(0.0)},
            .frame = wrench_frame::device_base,
            .valid_until_ns = clock.now_ns() + 20'000'000,
            .sequence = ++sequence};
  }

  manual_clock clock;
  virtual_usb cable;
  virtual_usb_bus bus{};
  fake_falcon peer;
  std::unique_ptr<falcon_device> device{};
  device_sample seen{};
  std::int64_t last_given_ns = 0;
  std::uint64_t sequence = 0;
};

}  // namespace asperity::test_support
