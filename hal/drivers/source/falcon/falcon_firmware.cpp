#include "falcon_firmware.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace asperity {
namespace {

constexpr std::size_t image_limit = std::size_t{1} << 20;

// The line as the boot program wants it: slow, and with a pulse on DTR.
constexpr std::array<ftdi_setting, 9> boot_settings = {{{ftdi_request::reset, ftdi_purge_receive},
                                                        {ftdi_request::reset, ftdi_purge_transmit},
                                                        {ftdi_request::latency, 16},
                                                        {ftdi_request::baud, 0x4138},  // 9600
                                                        {ftdi_request::data, ftdi_8n1},
                                                        {ftdi_request::flow, ftdi_no_flow_control},
                                                        {ftdi_request::modem, ftdi_rts_low},
                                                        {ftdi_request::modem, ftdi_dtr_low},
                                                        {ftdi_request::modem, ftdi_dtr_high}}};
// ... for the image, about 140 kBd.
constexpr std::array<ftdi_setting, 3> image_settings = {
    {{ftdi_request::modem, ftdi_dtr_low}, {ftdi_request::baud, 0x15}, {ftdi_request::reset, ftdi_purge_receive}}};

// Bytes over the line, with a deadline for each step.
class boot_line {
 public:
  boot_line(usb_link& link, io_clock& clock) noexcept : link_(&link), clock_(&clock) {}

  // @return ok | gone | busy (not taken in time) | failed ...
  [[nodiscard]] io_status send(std::span<const std::uint8_t> bytes, std::int64_t timeout_ns) noexcept {
    const std::int64_t due_ns = clock_->now_ns() + timeout_ns;
    for (;;) {
      const std::int64_t now_ns = clock_->now_ns();
      const io_status s = link_->write(now_ns, bytes);
      if (s != io_status::busy || now_ns >= due_ns) return s;
      clock_->wait_until_ns(now_ns + poll_ns);
    }
  }

  // Waits until `enough` answers true after a byte was taken in. @return ok | nothing (not in time) | gone | failed
  // ...
  template <class Enough>
  [[nodiscard]] io_status receive(std::int64_t timeout_ns, Enough&& enough) noexcept {
    const std::int64_t due_ns = clock_->now_ns() + timeout_ns;
    bool done = false;
    for (;;) {
      const std::int64_t now_ns = clock_->now_ns();
      usb_packet packet;
      io_status s = io_status::ok;
      while (!done && (s = link_->read(now_ns, buffer_, packet)) == io_status::ok) {
        const std::size_t size = std::min(packet.size, buffer_.size());
        for_each_ftdi_byte(std::span(buffer_).first(size), [&](std::uint8_t byte) { done = done || enough(byte); });
      }
      if (done) return io_status::ok;
      if (s != io_status::nothing || now_ns >= due_ns) return s;
      clock_->wait_until_ns(now_ns + poll_ns);
    }
  }

 private:
  static constexpr std::int64_t poll_ns = 1'000'000;
  usb_link* link_;
  io_clock* clock_;
  std::array<std::uint8_t, 512> buffer_{};
};

}  // namespace

result<std::vector<std::uint8_t>> read_falcon_image(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return error{error_code::io_failed, "the Falcon's firmware image '" + path + "' cannot be read; check the path"};
  }
  std::vector<std::uint8_t> image(image_limit + 1);
  file.read(reinterpret_cast<char*>(image.data()), static_cast<std::streamsize>(image.size()));
  image.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  if (image.empty() || image.size() > image_limit) {
    return error{error_code::bad_format, "'" + path + "' is no firmware image of a Falcon: it has " +
                                             (image.empty() ? "no bytes" : "more than 1 MiB")};
  }
  return image;
}

result<void> load_falcon_firmware(usb_link& link, io_clock& clock, std::span<const std::uint8_t> image) {
  constexpr std::int64_t answer_ns = 1'000'000'000;
  constexpr int greetings = 10;
  const auto failed = [](const std::string& step, io_status s) {
    const std::string why = s == io_status::nothing ? "no answer in time" : to_string(s);
    return error{error_code::io_failed, "loading the Falcon's firmware failed while " + step + ": " + why +
                                            "; unplug its power for five seconds and try again"};
  };

  boot_line line(link, clock);
  io_status s = apply_ftdi(link, boot_settings, falcon_control_timeout_ns);
  if (s != io_status::ok) return failed("setting the line up", s);

  constexpr std::array<std::uint8_t, 3> greeting = {0x0a, 0x43, 0x0d};
  constexpr std::array<std::uint8_t, 4> welcome = {0x0a, 0x44, 0x2c, 0x0d};  // a zero may come before it
  s = io_status::nothing;
  for (int i = 0; i < greetings && s == io_status::nothing; ++i) {
    s = line.send(greeting, answer_ns);
    if (s != io_status::ok) break;
    std::size_t matched = 0;
    s = line.receive(answer_ns / 5, [&](std::uint8_t byte) {
      matched = byte == welcome[matched] ? matched + 1 : (byte == welcome[0] ? 1 : 0);
      return matched == welcome.size();
    });
  }
  if (s != io_status::ok) return failed("greeting its boot program", s);

  s = apply_ftdi(link, image_settings, falcon_control_timeout_ns);
  if (s != io_status::ok) return failed("setting the line to the image's speed", s);
  constexpr std::array<std::uint8_t, 1> ready = {0x41};
  s = line.send(ready, answer_ns);
  if (s == io_status::ok) s = line.receive(answer_ns, [](std::uint8_t byte) { return byte == 0x41; });
  if (s != io_status::ok) return failed("announcing the image", s);

  for (std::size_t at = 0; at < image.size(); at += ftdi_payload_size) {
    const std::span<const std::uint8_t> piece = image.subspan(at, std::min(ftdi_payload_size, image.size() - at));
    const auto step = [&] { return "sending bytes " + std::to_string(at) + " and on of its image"; };
    s = line.send(piece, answer_ns);
    if (s != io_status::ok) return failed(step(), s);
    std::size_t echoed = 0;
    bool same = true;
    s = line.receive(answer_ns, [&](std::uint8_t byte) {
      same = same && byte == piece[echoed];
      return ++echoed == piece.size() || !same;
    });
    if (s != io_status::ok) return failed(step(), s);
    if (!same) {
      return error{error_code::io_failed, "the Falcon repeated byte " + std::to_string(at + echoed - 1) +
                                              " of its firmware wrongly; check the cable and try again"};
    }
  }
  return {};
}

}  // namespace asperity
