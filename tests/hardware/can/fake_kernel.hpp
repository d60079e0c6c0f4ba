// A kernel with one CAN interface, in this process, in which every call can be made to fail.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <limits>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <optional>
#include <string_view>
#include <sys/socket.h>

#include "asperity/can/socket_calls.hpp"

namespace asperity::can_test {

enum class call_kind : std::uint8_t { open, set_option, ask, bind, send, receive };

/// A message that waits in the socket.
struct message {
  canfd_frame frame{};
  std::size_t size = can::classic_frame_bytes;
  std::int64_t wall_ns = 0;                ///< 0: without a stamp
  std::optional<std::uint32_t> dropped{};  ///< the socket's count
  int flags = 0;
};

/// Takes no memory, so that a test can count what the transport takes.
class fake_kernel final : public can::socket_calls {
 public:
  // The interface.
  std::string_view name = "can0";
  int index = 3;
  int kind = ARPHRD_CAN;
  unsigned flags = IFF_UP | IFF_RUNNING;
  int mtu = static_cast<int>(can::fd_frame_bytes);
  std::int64_t wall_ahead_ns = 1'700'000'000'000'000'000;

  // Faults: the n-th call of all answers fail_with; from then on every call of a kind can answer always_with.
  std::uint64_t fail_call = std::numeric_limits<std::uint64_t>::max();
  std::int64_t fail_with = -EIO;
  std::array<std::int64_t, 6> always_with{};

  // What was asked of it.
  std::uint64_t calls = 0;
  std::array<std::uint64_t, 6> calls_of{};
  std::optional<call_kind> failed_kind;
  int open_descriptors = 0;
  bool bound = false;
  std::size_t filter_count = 0;
  std::array<::can_filter, 4> filters{};
  std::uint64_t sends = 0;
  canfd_frame last_sent{};
  std::size_t last_size = 0;

  /// Puts a message into the socket. @pre fewer than 256 wait
  void deliver(const message& m) {
    waiting_[(first_ + count_) % waiting_.size()] = m;
    ++count_;
  }
  void deliver_frame(std::uint32_t id, std::int64_t wall_ns = 0, std::uint8_t first_byte = 0) {
    message m;
    m.frame.can_id = id;
    m.frame.len = 8;
    m.frame.data[0] = first_byte;
    m.wall_ns = wall_ns;
    deliver(m);
  }
  [[nodiscard]] std::size_t waiting() const { return count_; }
  void set_always(call_kind k, std::int64_t answer) { always_with[static_cast<std::size_t>(k)] = answer; }

  [[nodiscard]] int open() noexcept override {
    if (const auto a = failing(call_kind::open)) return static_cast<int>(*a);
    ++open_descriptors;
    return 7;
  }
  [[nodiscard]] int set_option(int, int level, int option, const void* value, socklen_t size) noexcept override {
    if (level == SOL_CAN_RAW && option == CAN_RAW_FILTER) {
      filter_count = size / sizeof(::can_filter);
      std::memcpy(filters.data(), value, std::min<std::size_t>(size, sizeof filters));
    }
    return static_cast<int>(failing(call_kind::set_option).value_or(0));
  }
  [[nodiscard]] int ask(int, unsigned long request, ifreq& about) noexcept override {
    if (const auto a = failing(call_kind::ask)) return static_cast<int>(*a);
    if (request == SIOCGIFNAME) {
      if (about.ifr_ifindex != index) return -ENODEV;
      name.copy(about.ifr_name, IFNAMSIZ - 1);
      return 0;
    }
    if (name != about.ifr_name) return -ENODEV;
    switch (request) {
      case SIOCGIFINDEX:
        about.ifr_ifindex = index;
        return 0;
      case SIOCGIFHWADDR:
        about.ifr_hwaddr.sa_family = static_cast<sa_family_t>(kind);
        return 0;
      case SIOCGIFFLAGS:
        about.ifr_flags = static_cast<short>(flags);
        return 0;
      case SIOCGIFMTU:
        about.ifr_mtu = mtu;
        return 0;
      default:
        return -EINVAL;
    }
  }
  [[nodiscard]] int bind(int, const sockaddr_can& address) noexcept override {
    if (const auto a = failing(call_kind::bind)) return static_cast<int>(*a);
    bound = address.can_family == AF_CAN && address.can_ifindex == index;
    return bound ? 0 : -ENODEV;
  }
  [[nodiscard]] std::int64_t send(int, const void* bytes, std::size_t size) noexcept override {
    if (const auto a = failing(call_kind::send)) return *a;
    ++sends;
    last_size = size;
    std::memcpy(&last_sent, bytes, std::min(size, sizeof last_sent));
    return static_cast<std::int64_t>(size);
  }
  [[nodiscard]] std::int64_t receive(int, msghdr& into) noexcept override {
    if (const auto a = failing(call_kind::receive)) return *a;
    if (count_ == 0) return -EAGAIN;
    const message& m = waiting_[first_];
    first_ = (first_ + 1) % waiting_.size();
    --count_;
    std::memcpy(into.msg_iov->iov_base, &m.frame, std::min(m.size, into.msg_iov->iov_len));
    into.msg_flags = m.flags;
    std::size_t used = 0;
    if (m.wall_ns != 0) {
      const timespec at{m.wall_ns / 1'000'000'000, m.wall_ns % 1'000'000'000};
      used += beside(into, used, SO_TIMESTAMPNS, &at, sizeof at);
    }
    if (m.dropped) used += beside(into, used, SO_RXQ_OVFL, &*m.dropped, sizeof *m.dropped);
    into.msg_controllen = used;
    return static_cast<std::int64_t>(m.size);
  }
  void close(int) noexcept override { --open_descriptors; }
  [[nodiscard]] std::int64_t wall_offset_ns() noexcept override { return wall_ahead_ns; }

 private:
  [[nodiscard]] std::optional<std::int64_t> failing(call_kind k) noexcept {
    ++calls_of[static_cast<std::size_t>(k)];
    if (calls++ == fail_call) {
      failed_kind = k;
      return fail_with;
    }
    const std::int64_t always = always_with[static_cast<std::size_t>(k)];
    return always == 0 ? std::nullopt : std::optional(always);
  }

  // Writes one ancillary message, if there is room for it. @return its size
  static std::size_t beside(msghdr& into, std::size_t used, int type, const void* value, std::size_t size) noexcept {
    if (used + CMSG_SPACE(size) > into.msg_controllen) return 0;
    cmsghdr head{};
    head.cmsg_level = SOL_SOCKET;
    head.cmsg_type = type;
    head.cmsg_len = CMSG_LEN(size);
    std::byte* const at = static_cast<std::byte*>(into.msg_control) + used;
    std::memcpy(at, &head, sizeof head);
    std::memcpy(at + CMSG_LEN(0), value, size);
    return CMSG_SPACE(size);
  }

  std::array<message, 256> waiting_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace asperity::can_test
