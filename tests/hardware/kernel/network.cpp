#include "hardware/kernel/network.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <string_view>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace asperity::network {
namespace {

/// One request about a link, built attribute by attribute. rtnetlink(7)
class link_request {
 public:
  link_request(std::uint16_t type, unsigned flags, int index) {
    nlmsghdr header{};
    header.nlmsg_type = type;
    header.nlmsg_flags = static_cast<std::uint16_t>(NLM_F_REQUEST | NLM_F_ACK | flags);
    ifinfomsg about{};
    about.ifi_index = index;
    put(&header, sizeof header);
    put(&about, sizeof about);
  }

  void text(std::uint16_t type, std::string_view value) { attribute(type, value.data(), value.size()); }
  void attribute(std::uint16_t type, const void* value, std::size_t size) {
    const std::size_t at = begin(type);
    put(value, size);
    end(at);
  }
  [[nodiscard]] std::size_t begin(std::uint16_t type) {
    const std::size_t at = size_;
    const rtattr head{0, type};
    put(&head, sizeof head);
    return at;
  }
  void end(std::size_t at) {
    const auto length = static_cast<std::uint16_t>(size_ - at);
    std::memcpy(&bytes_[at], &length, sizeof length);
    size_ = (size_ + 3) / 4 * 4;
  }

  [[nodiscard]] int ask() {
    const auto length = static_cast<std::uint32_t>(size_);
    std::memcpy(bytes_.data(), &length, sizeof length);
    const int fd = ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    if (fd < 0) return errno;
    int answer = 0;
    std::array<std::byte, 4096> reply{};
    if (::send(fd, bytes_.data(), size_, 0) < 0 || ::recv(fd, reply.data(), reply.size(), 0) < 0) {
      answer = errno;
    } else {
      nlmsgerr said{};
      std::memcpy(&said, &reply[sizeof(nlmsghdr)], sizeof said);
      answer = -said.error;
    }
    ::close(fd);
    return answer;
  }

 private:
  void put(const void* value, std::size_t size) {
    std::memcpy(&bytes_[size_], value, size);
    size_ += size;
  }

  std::array<std::byte, 512> bytes_{};
  std::size_t size_ = 0;
};

int index_of(const std::string& name) { return static_cast<int>(::if_nametoindex(name.c_str())); }

ifreq named(const std::string& name) {
  ifreq about{};
  name.copy(about.ifr_name, IFNAMSIZ - 1);
  return about;
}

int request(unsigned long what, ifreq& about) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return errno;
  const int answer = ::ioctl(fd, what, &about) < 0 ? errno : 0;
  ::close(fd);
  return answer;
}

}  // namespace

int add_vcan(const std::string& name) {
  link_request r(RTM_NEWLINK, NLM_F_CREATE | NLM_F_EXCL, 0);
  r.attribute(IFLA_IFNAME, name.c_str(), name.size() + 1);
  const std::size_t info = r.begin(IFLA_LINKINFO);
  r.text(IFLA_INFO_KIND, "vcan");
  r.end(info);
  return r.ask();
}

int remove(const std::string& name) {
  const int index = index_of(name);
  return index == 0 ? ENODEV : link_request(RTM_DELLINK, 0, index).ask();
}

int set_up(const std::string& name, bool up) {
  ifreq about = named(name);
  if (const int wrong = request(SIOCGIFFLAGS, about); wrong != 0) return wrong;
  const auto flags = static_cast<unsigned>(about.ifr_flags);
  about.ifr_flags = static_cast<short>(up ? flags | IFF_UP : flags & ~static_cast<unsigned>(IFF_UP));
  return request(SIOCSIFFLAGS, about);
}

int set_mtu(const std::string& name, int bytes) {
  ifreq about = named(name);
  about.ifr_mtu = bytes;
  return request(SIOCSIFMTU, about);
}

int set_queue(const std::string& name, int frames) {
  ifreq about = named(name);
  about.ifr_ifru.ifru_ivalue = frames;
  return request(SIOCSIFTXQLEN, about);
}

int set_bit_rate(const std::string& name, std::uint32_t bits_per_s) {
  can_bittiming timing{};
  timing.bitrate = bits_per_s;
  link_request r(RTM_NEWLINK, 0, index_of(name));
  const std::size_t info = r.begin(IFLA_LINKINFO);
  r.text(IFLA_INFO_KIND, "can");
  const std::size_t data = r.begin(IFLA_INFO_DATA);
  r.attribute(IFLA_CAN_BITTIMING, &timing, sizeof timing);
  r.end(data);
  r.end(info);
  return r.ask();
}

}  // namespace asperity::network
