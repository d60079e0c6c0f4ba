#include <algorithm>
#include <cerrno>
#include <cstring>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sockios.h>
#include <net/if_arp.h>
#include <system_error>
#include <utility>
#include <vector>

#include "asperity/can/socketcan.hpp"
#include "asperity/can/socketcan_bus.hpp"

namespace asperity::can {
namespace {

std::string words(int negative_errno) { return std::generic_category().message(-negative_errno); }

/// Closes the descriptor unless it was handed on.
class open_socket {
 public:
  explicit open_socket(socket_calls& calls) noexcept : calls_(calls), fd_(calls.open()) {}
  ~open_socket() {
    if (fd_ >= 0) calls_.close(fd_);
  }
  open_socket(const open_socket&) = delete;
  open_socket& operator=(const open_socket&) = delete;

  [[nodiscard]] int fd() const noexcept { return fd_; }
  [[nodiscard]] int release() noexcept { return std::exchange(fd_, -1); }

 private:
  socket_calls& calls_;
  int fd_;
};

error no_socket(int answer) {
  if (answer == -EAFNOSUPPORT || answer == -EPROTONOSUPPORT) {
    return {error_code::unsupported,
            "This kernel has no raw CAN sockets (" + words(answer) + "); as root try: modprobe can-raw"};
  }
  if (answer == -EPERM || answer == -EACCES) {
    return {error_code::unsupported, "This user may not open CAN sockets (" + words(answer) +
                                         "); a container or sandbox that forbids it has to let socket(AF_CAN) through"};
  }
  return {error_code::io_failed, "A CAN socket could not be opened: " + words(answer) + "."};
}

error no_interface(const std::string& name) {
  return {error_code::invalid_argument,
          "There is no network interface \"" + name + "\"; `asperity devices` lists the CAN interfaces."};
}

/// The number of an interface that is CAN, up, and takes FD where that is asked for.
result<int> usable_interface(socket_calls& calls, int fd, const std::string& name, bool with_fd) {
  if (name.empty() || name.size() >= IFNAMSIZ || name.find('\0') != std::string::npos) return no_interface(name);
  const auto ask = [&](unsigned long request, ifreq& about) {
    about = {};
    std::memcpy(about.ifr_name, name.data(), name.size());
    return calls.ask(fd, request, about);
  };
  const auto failed = [&](const char* what, int answer) -> error {
    if (answer == -ENODEV || answer == -ENXIO) return no_interface(name);
    return {error_code::io_failed,
            std::string("The kernel does not tell ") + what + " of " + name + ": " + words(answer) + "."};
  };

  ifreq about{};
  if (const int answer = ask(SIOCGIFINDEX, about); answer < 0) return failed("the number", answer);
  const int index = about.ifr_ifindex;
  if (const int answer = ask(SIOCGIFHWADDR, about); answer < 0) return failed("the kind", answer);
  if (about.ifr_hwaddr.sa_family != ARPHRD_CAN) {
    return error{error_code::invalid_argument,
                 name + " is a network interface, but not CAN; `asperity devices` lists those that are."};
  }
  if (const int answer = ask(SIOCGIFFLAGS, about); answer < 0) return failed("the state", answer);
  if ((static_cast<unsigned>(about.ifr_flags) & IFF_UP) == 0) {
    return error{error_code::invalid_argument, name + " is down; " + how_to_bring_up(name, with_fd)};
  }
  if (const int answer = ask(SIOCGIFMTU, about); answer < 0) return failed("the frame size", answer);
  if (with_fd && about.ifr_mtu < static_cast<int>(fd_frame_bytes)) {
    return error{
        error_code::unsupported,
        name + " is set up for classic CAN, and CAN FD was asked for; if its controller has FD, set it down and, " +
            how_to_bring_up(name, true)};
  }
  return index;
}

std::vector<::can_filter> kernel_filters(const std::vector<id_filter>& filters) {
  std::vector<::can_filter> out;
  out.reserve(filters.size());
  for (const id_filter& f : filters) {
    const std::uint32_t bits = f.extended ? CAN_EFF_MASK : CAN_SFF_MASK;
    out.push_back(
        {.can_id = (f.id & bits) | (f.extended ? CAN_EFF_FLAG : 0U), .can_mask = (f.mask & bits) | CAN_EFF_FLAG});
  }
  return out;
}

/// Everything that is set before the socket is bound. The buffer may be refused, the rest may not.
result<void> set_options(socket_calls& calls, int fd, const socketcan_settings& settings) {
  const auto set = [&](int level, int name, const auto& value) {
    return calls.set_option(fd, level, name, &value, sizeof value);
  };
  const auto failed = [](const char* what, int answer) -> error {
    return {answer == -ENOPROTOOPT ? error_code::unsupported : error_code::io_failed,
            std::string("The kernel refuses ") + what + " on a CAN socket: " + words(answer) + "."};
  };

  const int on = 1;
  if (settings.fd) {
    if (const int answer = set(SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on); answer < 0) return failed("CAN FD frames", answer);
  }
  const can_err_mask_t every_error = CAN_ERR_MASK;
  if (const int answer = set(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, every_error); answer < 0) {
    return failed("error frames", answer);
  }
  if (!settings.filters.empty()) {
    const std::vector<::can_filter> filters = kernel_filters(settings.filters);
    const int answer = calls.set_option(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                        static_cast<socklen_t>(filters.size() * sizeof filters[0]));
    if (answer < 0) return failed("these identifier filters", answer);
  }
  if (const int answer = set(SOL_SOCKET, SO_TIMESTAMPNS, on); answer < 0) return failed("times of arrival", answer);
  if (const int answer = set(SOL_SOCKET, SO_RXQ_OVFL, on); answer < 0) return failed("a count of lost frames", answer);
  // Beyond the system's maximum with privileges, up to it without. A smaller buffer is no fault: losses are counted.
  if (set(SOL_SOCKET, SO_RCVBUFFORCE, settings.receive_buffer_bytes) < 0) {
    static_cast<void>(set(SOL_SOCKET, SO_RCVBUF, settings.receive_buffer_bytes));
  }
  return {};
}

}  // namespace

std::string how_to_bring_up(const std::string& name, bool with_fd) {
  const std::string set = "ip link set " + name;
  if (name.starts_with("vcan")) return "as root: " + set + (with_fd ? " mtu 72 up" : " up");
  return "as root, with the bit rate of the bus: " + set + " up type can bitrate 1000000" +
         (with_fd ? " dbitrate 5000000 fd on" : "");
}

result<std::unique_ptr<can_bus>> open_socketcan(const std::string& interface, const socketcan_settings& settings,
                                                socket_calls& calls) {
  open_socket socket(calls);
  if (socket.fd() < 0) return no_socket(socket.fd());
  const result<int> index = usable_interface(calls, socket.fd(), interface, settings.fd);
  if (!index) return index.error();
  if (const result<void> set = set_options(calls, socket.fd(), settings); !set) return set.error();

  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = *index;
  if (const int answer = calls.bind(socket.fd(), address); answer < 0) {
    if (answer == -ENODEV || answer == -ENXIO) return no_interface(interface);
    return error{error_code::io_failed, interface + " could not be opened: " + words(answer) + "."};
  }
  const std::int64_t back_off_ns = std::max<std::int64_t>(settings.busy_back_off_ns, 0);
  return std::unique_ptr<can_bus>(
      std::make_unique<socketcan_bus>(calls, socket.release(), *index, settings.fd, back_off_ns));
}

result<std::unique_ptr<can_bus>> open_socketcan(const std::string& interface, const socketcan_settings& settings) {
  return open_socketcan(interface, settings, system_socket_calls());
}

result<void> check_support(socket_calls& calls) {
  const open_socket socket(calls);
  if (socket.fd() < 0) return no_socket(socket.fd());
  return {};
}

result<void> check_support() { return check_support(system_socket_calls()); }

}  // namespace asperity::can
