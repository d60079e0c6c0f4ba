#include "hardware/kernel/usbip_device.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace asperity::test_support {

namespace {

// The USB/IP protocol of Linux (Documentation/usb/usbip_protocol.rst): a header of 48 bytes, numbers big-endian.
constexpr std::size_t header_size = 48;
constexpr std::uint32_t command_submit = 1;
constexpr std::uint32_t command_unlink = 2;
constexpr std::uint32_t answer_submit = 3;
constexpr std::uint32_t answer_unlink = 4;

constexpr const char* attach_file = "/sys/devices/platform/vhci_hcd.0/attach";
constexpr int full_speed = 2;

std::uint32_t number_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return (std::uint32_t{bytes[at]} << 24) | (std::uint32_t{bytes[at + 1]} << 16) | (std::uint32_t{bytes[at + 2]} << 8) |
         bytes[at + 3];
}

void put_number(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t number) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(number >> (24 - 8 * i));
}

std::uint8_t low(unsigned n) { return static_cast<std::uint8_t>(n & 0xff); }
std::uint8_t high(unsigned n) { return static_cast<std::uint8_t>(n >> 8); }

}  // namespace

std::string usbip_device::missing() {
  if (::access(attach_file, W_OK) == 0) return {};
  std::string why = "no USB/IP host controller to plug into: ";
  why += attach_file;
  why += ": ";
  why += std::strerror(errno);
  why += " (needs the module vhci-hcd, and root)";
  return why;
}

std::string usbip_device::plug_in(int port) {
  unplug();
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) return std::strerror(errno);
  socket_ = ends[0];
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%d %d %d %d", port, ends[1], 0x10002 + port, full_speed);
  const std::string line = text.data();
  std::string problem;
  // A port from which something was just pulled is not free at once.
  for (int tries = 0; tries < 200; ++tries) {
    const int file = ::open(attach_file, O_WRONLY | O_CLOEXEC);
    const ssize_t written = file < 0 ? -1 : ::write(file, line.data(), line.size());
    problem = written < 0 ? std::strerror(errno) : "";
    if (file >= 0) ::close(file);
    if (problem.empty()) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ::close(ends[1]);
  if (!problem.empty()) {
    ::close(std::exchange(socket_, -1));
    return problem;
  }
  plugged_ = true;
  server_ = std::thread([this] { serve(); });
  ticker_ = std::thread([this] { count_milliseconds(); });
  return {};
}

void usbip_device::unplug() {
  if (socket_ < 0) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    plugged_ = false;
  }
  ::shutdown(socket_, SHUT_RDWR);
  server_.join();
  ticker_.join();
  ::close(std::exchange(socket_, -1));
  waiting_in_.clear();
  waiting_out_.clear();
}

void usbip_device::serve() {
  std::array<std::uint8_t, header_size> header{};
  while (receive_all(header)) {
    const std::uint32_t command = number_at(header, 0);
    const std::uint32_t length = number_at(header, 24);
    std::vector<std::uint8_t> bytes;
    if (command == command_submit && number_at(header, 12) == 0) {
      bytes.resize(length);
      if (!receive_all(bytes)) return;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    if (command == command_submit) submitted(header, std::move(bytes));
    if (command == command_unlink) taken_back(number_at(header, 4), number_at(header, 20));
    move_waiting();
  }
}

void usbip_device::count_milliseconds() {
  auto due = std::chrono::steady_clock::now();
  for (;;) {
    due += std::chrono::milliseconds(1);
    std::this_thread::sleep_until(due);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!plugged_) return;
    function_.tick();
    move_waiting();
  }
}

void usbip_device::submitted(std::span<const std::uint8_t> header, std::vector<std::uint8_t> bytes) {
  const std::uint32_t number = number_at(header, 4);
  const bool to_host = number_at(header, 12) != 0;
  const std::uint32_t endpoint = number_at(header, 16);
  const std::uint32_t room = number_at(header, 24);
  if (endpoint == 0) {
    answer_control(number, header.subspan(40, 8), std::move(bytes), room, to_host);
  } else if (to_host) {
    waiting_in_.push_back({number, room, {}});
  } else {
    waiting_out_.push_back({number, room, std::move(bytes)});
  }
}

void usbip_device::taken_back(std::uint32_t number, std::uint32_t which) {
  ++taken_back_;
  std::int32_t status = 0;  // it had ended already
  for (std::deque<request>* queue : {&waiting_in_, &waiting_out_}) {
    const auto found = std::find_if(queue->begin(), queue->end(), [&](const request& r) { return r.number == which; });
    if (found == queue->end()) continue;
    queue->erase(found);
    status = -ECONNRESET;
  }
  std::array<std::uint8_t, header_size> answer{};
  put_number(answer, 0, answer_unlink);
  put_number(answer, 4, number);
  put_number(answer, 20, static_cast<std::uint32_t>(status));
  send_all(answer);
}

void usbip_device::answer_control(std::uint32_t number, std::span<const std::uint8_t> setup,
                                  std::vector<std::uint8_t> bytes, std::size_t room, bool to_host) {
  const std::uint8_t type = setup[0];
  const std::uint8_t what = setup[1];
  std::size_t done = bytes.size();
  bool stalled = false;
  if (type == 0x80 && what == 6) {
    stalled = !descriptor(setup[3], setup[2], bytes);
    done = bytes.size();
  } else if ((type & 0x60) == 0) {  // the rest of what every device answers: addresses, configurations, halts
    if (type == 0x02 && what == 1) function_.halt_cleared();
    if (to_host) bytes.assign(what == 0 ? 2 : 1, 0);
    done = bytes.size();
  } else {
    bytes.resize(std::max(bytes.size(), room));
    const usb_setup asked{type, what, static_cast<std::uint16_t>(setup[2] | (setup[3] << 8)),
                          static_cast<std::uint16_t>(setup[4] | (setup[5] << 8))};
    stalled = function_.control(asked, bytes, done) != io_status::ok;
    if (!to_host) done = room;
  }
  if (stalled) return reply(number, -EPIPE, {}, 0);
  done = std::min(done, room);
  if (to_host) {
    bytes.resize(std::max(bytes.size(), done));
    reply(number, 0, std::span(bytes).first(done), done);
  } else {
    reply(number, 0, {}, done);
  }
}

bool usbip_device::descriptor(std::uint8_t kind, std::uint8_t index, std::vector<std::uint8_t>& out) const {
  const usb_identity& id = identity_;
  if (kind == 1) {
    out = {18, 1, 0, 2, 0xff, 0, 0, 64, low(id.vendor), high(id.vendor), low(id.product), high(id.product),
           0,  1, 1, 2, 3,    1};
    return true;
  }
  if (kind == 2) {
    out = {9, 2, 32,   0, 1,  1,    0, 0x80, 50,  // configuration
           9, 4, 0,    0, 2,  0xff, 0, 0,    0,   // interface
           7, 5, 0x81, 2, 64, 0,    0,            // bulk to the host
           7, 5, 0x02, 2, 64, 0,    0};           // bulk to the device
    return true;
  }
  if (kind != 3 || index > 3) return false;
  out = {4, 3, 9, 4};
  if (index == 0) return true;
  const std::string& text = index == 1 ? id.maker : (index == 2 ? id.name : id.serial);
  out = {static_cast<std::uint8_t>(2 + 2 * text.size()), 3};
  for (const char c : text) {
    out.push_back(static_cast<std::uint8_t>(c));
    out.push_back(0);
  }
  return true;
}

void usbip_device::move_waiting() {
  while (!waiting_out_.empty() && function_.take(waiting_out_.front().bytes)) {
    const request r = std::move(waiting_out_.front());
    waiting_out_.pop_front();
    reply(r.number, 0, {}, r.bytes.size());
  }
  while (!waiting_in_.empty()) {
    std::vector<std::uint8_t> room(waiting_in_.front().room);
    std::size_t size = 0;
    const usb_function::answer answer = function_.give(room, size);
    if (answer == usb_function::answer::nothing) return;
    const std::uint32_t number = waiting_in_.front().number;
    waiting_in_.pop_front();
    const bool good = answer == usb_function::answer::data;
    const std::int32_t trouble = answer == usb_function::answer::stall ? -EPIPE : -EPROTO;
    reply(number, good ? 0 : trouble, std::span(room).first(good ? size : 0), good ? size : 0);
  }
}

void usbip_device::reply(std::uint32_t number, std::int32_t status, std::span<const std::uint8_t> bytes,
                         std::size_t done) {
  std::vector<std::uint8_t> out(header_size);
  put_number(out, 0, answer_submit);
  put_number(out, 4, number);
  put_number(out, 20, static_cast<std::uint32_t>(status));
  put_number(out, 24, static_cast<std::uint32_t>(done));
  out.insert(out.end(), bytes.begin(), bytes.end());
  send_all(out);
}

void usbip_device::send_all(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n <= 0) return;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

bool usbip_device::receive_all(std::span<std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::read(socket_, bytes.data(), bytes.size());
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace asperity::test_support
