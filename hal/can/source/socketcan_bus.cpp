#include "asperity/can/socketcan_bus.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <ctime>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/sockios.h>
#include <sys/uio.h>

#include "asperity/can/error_frames.hpp"
#include "asperity/transport/can_length.hpp"

namespace asperity::can {
namespace {

static_assert(offsetof(::can_frame, data) == offsetof(canfd_frame, data) && CAN_ERR_DLC == 8);

canfd_frame to_kernel(const asperity::can_frame& frame) noexcept {
  canfd_frame out{};
  out.can_id = frame.id;
  if (frame.extended) out.can_id |= CAN_EFF_FLAG;
  if (frame.remote) out.can_id |= CAN_RTR_FLAG;
  out.len = frame.size;
  if (frame.bit_rate_switch) out.flags = CANFD_BRS;
  if (!frame.remote) std::memcpy(out.data, frame.data.data(), frame.size);
  return out;
}

}  // namespace

struct socketcan_bus::received {
  canfd_frame frame{};
  iovec bytes{&frame, sizeof frame};
  // Room for the stamp and the count of dropped frames; what else may come does not fit and is not wanted.
  alignas(cmsghdr) std::byte beside[CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))]{};
  msghdr message{};

  received() noexcept {
    message.msg_iov = &bytes;
    message.msg_iovlen = 1;
    message.msg_control = beside;
    message.msg_controllen = sizeof beside;
  }
  received(const received&) = delete;
  received& operator=(const received&) = delete;
};

io_status socketcan_bus::send(std::int64_t now_ns, const asperity::can_frame& frame) noexcept {
  if (gone_) return io_status::gone;
  if (!is_possible(frame, takes_fd_)) return io_status::refused;
  if (health_.bus_off) {
    ask_about_link(now_ns);
    if (gone_) return io_status::gone;
    if (health_.bus_off) return io_status::down;
  }
  if (now_ns < busy_until_ns_) return io_status::busy;

  const canfd_frame out = to_kernel(frame);
  const std::size_t size = frame.fd ? fd_frame_bytes : classic_frame_bytes;
  const std::int64_t answer = calls_.send(fd_, &out, size);
  if (answer == static_cast<std::int64_t>(size)) {
    link_down_ = false;
    return io_status::ok;
  }
  if (answer >= 0) return io_status::too_short;
  switch (-answer) {
    case ENOBUFS:
    case EAGAIN:
    case EINTR:
      errno_ = static_cast<int>(-answer);
      busy_until_ns_ = now_ns + back_off_ns_;
      return io_status::busy;
    case EINVAL:
    case EMSGSIZE:
      errno_ = static_cast<int>(-answer);
      return io_status::refused;
    default:
      return failed_with(answer, now_ns);
  }
}

io_status socketcan_bus::receive(std::int64_t now_ns, asperity::can_frame& frame) noexcept {
  if (gone_) return io_status::gone;
  for (int errors = 0; errors < most_error_frames; ++errors) {
    received in;
    const std::int64_t answer = calls_.receive(fd_, in.message);
    if (answer == -EAGAIN || answer == -EINTR) return nothing_there(now_ns);
    if (answer < 0) return failed_with(answer, now_ns);
    const io_status taken = take(in, answer, now_ns, frame);
    if (taken != io_status::nothing) return taken;
  }
  return io_status::nothing;
}

// One message. `nothing` where it was an error frame.
io_status socketcan_bus::take(received& in, std::int64_t size, std::int64_t now_ns,
                              asperity::can_frame& frame) noexcept {
  std::int64_t arrived_ns = now_ns;
  for (cmsghdr* c = CMSG_FIRSTHDR(&in.message); c != nullptr; c = CMSG_NXTHDR(&in.message, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SO_TIMESTAMPNS && c->cmsg_len >= CMSG_LEN(sizeof(timespec))) {
      timespec at{};
      std::memcpy(&at, CMSG_DATA(c), sizeof at);
      arrived_ns = stamps_.session_ns(std::int64_t{at.tv_sec} * 1'000'000'000 + at.tv_nsec, now_ns);
    } else if (c->cmsg_type == SO_RXQ_OVFL && c->cmsg_len >= CMSG_LEN(sizeof(std::uint32_t))) {
      std::uint32_t dropped = 0;
      std::memcpy(&dropped, CMSG_DATA(c), sizeof dropped);
      health_.lost += std::uint32_t{dropped - dropped_};
      dropped_ = dropped;
    }
  }

  const canfd_frame& k = in.frame;
  const bool fd = size == fd_frame_bytes;
  if ((!fd && size != classic_frame_bytes) || (in.message.msg_flags & MSG_TRUNC) != 0) return io_status::too_short;
  if (k.len > (fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN)) return io_status::failed;
  if ((k.can_id & CAN_ERR_FLAG) != 0) {
    std::uint8_t data[CAN_ERR_DLC];
    std::memcpy(data, k.data, sizeof data);
    apply_error_frame(k.can_id, data, health_);
    return io_status::nothing;
  }

  frame.extended = (k.can_id & CAN_EFF_FLAG) != 0;
  frame.id = k.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.remote = !fd && (k.can_id & CAN_RTR_FLAG) != 0;
  frame.fd = fd;
  frame.bit_rate_switch = fd && (k.flags & CANFD_BRS) != 0;
  frame.size = k.len;
  frame.data.fill(0);
  std::memcpy(frame.data.data(), k.data, k.len);
  frame.host_time_ns = arrived_ns;
  return io_status::ok;
}

io_status socketcan_bus::nothing_there(std::int64_t now_ns) noexcept {
  stamps_.empty_at(now_ns);
  if (!link_down_ && !health_.bus_off) return io_status::nothing;
  ask_about_link(now_ns);
  if (gone_) return io_status::gone;
  return link_down_ || health_.bus_off ? io_status::down : io_status::nothing;
}

io_status socketcan_bus::failed_with(std::int64_t answer, std::int64_t now_ns) noexcept {
  errno_ = static_cast<int>(-answer);
  switch (errno_) {
    case ENETDOWN:
      // Said of an interface that was switched off, and of one that is being deleted.
      link_down_ = true;
      controller_started();
      ask_at_ns_ = now_ns;
      ask_about_link(now_ns);
      return gone_ ? io_status::gone : io_status::down;
    case ENODEV:
    case ENXIO:
      gone_ = true;
      return io_status::gone;
    default:
      return io_status::failed;
  }
}

// Whether the interface is there, and works again. The number is asked for first: a new interface can have the old
// name.
void socketcan_bus::ask_about_link(std::int64_t now_ns) noexcept {
  if (now_ns < ask_at_ns_) return;
  ask_at_ns_ = now_ns + ask_every_ns;
  ifreq about{};
  about.ifr_ifindex = index_;
  int answer = calls_.ask(fd_, SIOCGIFNAME, about);
  if (answer >= 0) answer = calls_.ask(fd_, SIOCGIFFLAGS, about);
  if (answer < 0) {
    errno_ = -answer;
    gone_ = errno_ == ENODEV || errno_ == ENXIO;
    return;
  }
  const auto flags = static_cast<unsigned>(about.ifr_flags);
  link_down_ = (flags & IFF_UP) == 0;
  if (link_down_) controller_started();
}

// A controller that was switched off begins anew.
void socketcan_bus::controller_started() noexcept {
  health_.bus_off = false;
  health_.error_passive = false;
  health_.transmit_errors = 0;
  health_.receive_errors = 0;
}

}  // namespace asperity::can
