#include "hardware/kernel/slcan_adapter.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <net/if.h>
#include <poll.h>
#include <string_view>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "hardware/kernel/can_support.hpp"
#include "hardware/kernel/network.hpp"

namespace asperity::can_kernel_test {
namespace {

constexpr int slcan_discipline = 17;  // N_SLCAN of linux/tty.h

// The identifier of a standard frame's line, with bit 0x400 set; empty for any other line.
std::string echo_of(std::string_view line) {
  if (line.size() < 5 || line[0] != 't') return {};
  constexpr std::string_view digits = "0123456789ABCDEF";
  const std::size_t top = digits.find(line[1]);
  if (top == std::string_view::npos) return {};
  std::string out(line);
  out[1] = digits[top | 4U];
  return out + "\r";
}

}  // namespace

std::string slcan_adapter::plug_in(int queue_frames) {
  master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> path{};
  if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
      ::ptsname_r(master_, path.data(), path.size()) != 0) {
    return "no pseudo terminal could be made";
  }
  slave_ = ::open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (slave_ < 0 || ::tcgetattr(slave_, &settings) != 0) return "no pseudo terminal could be opened";
  ::cfmakeraw(&settings);
  static_cast<void>(::tcsetattr(slave_, TCSANOW, &settings));
  int discipline = slcan_discipline;
  if (::ioctl(slave_, TIOCSETD, &discipline) != 0) return "this kernel has no slcan driver (modprobe slcan)";
  ifreq about{};
  if (::ioctl(slave_, SIOCGIFNAME, &about) != 0) return "slcan does not tell its interface";
  interface_ = about.ifr_name;
  thread_ = std::thread([this] { serve(); });
  if (network::set_bit_rate(interface_, 500'000) != 0 || network::set_queue(interface_, queue_frames) != 0 ||
      network::set_up(interface_, true) != 0) {
    return "slcan's interface " + interface_ + " did not come up";
  }
  return {};
}

void slcan_adapter::unplug() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (master_ >= 0) ::close(master_);
  if (slave_ >= 0) ::close(slave_);
  master_ = slave_ = -1;
}

bool slcan_adapter::say(const std::string& line) const {
  return ::write(master_, line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

void slcan_adapter::serve() {
  std::string line;
  while (!stop_) {
    if (stalled_) {
      sleep_ms(1);
      continue;
    }
    pollfd p{master_, POLLIN, 0};
    if (::poll(&p, 1, 10) <= 0) continue;
    std::array<char, 256> bytes{};
    const ssize_t n = ::read(master_, bytes.data(), bytes.size());
    if (n <= 0) {
      sleep_ms(1);
      continue;
    }
    for (const char c : std::string_view(bytes.data(), static_cast<std::size_t>(n))) {
      if (c != '\r') {
        line += c;
        continue;
      }
      if (const std::string echo = echo_of(line); !echo.empty()) static_cast<void>(say(echo));
      line.clear();
    }
  }
}

}  // namespace asperity::can_kernel_test
