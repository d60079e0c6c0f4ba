#include <algorithm>
#include <charconv>
#include <fstream>
#include <linux/can.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <optional>
#include <string_view>
#include <system_error>

#include "asperity/can/socketcan.hpp"
#include "asperity/can/socketcan_bus.hpp"

namespace asperity::can {
namespace {

namespace fs = std::filesystem;

/// The first line of one of the kernel's files; empty where it cannot be read, as while an interface vanishes.
std::string line_of(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// A number as the kernel writes it: decimal, or 0x and hexadecimal.
std::optional<unsigned> number_of(const fs::path& file) {
  const std::string line = line_of(file);
  std::string_view digits = line;
  const bool hex = digits.starts_with("0x");
  if (hex) digits.remove_prefix(2);
  unsigned value = 0;
  const auto [end, wrong] = std::from_chars(digits.data(), digits.data() + digits.size(), value, hex ? 16 : 10);
  if (wrong != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

interface_state state_of(const fs::path& folder) {
  interface_state s;
  s.name = folder.filename().string();
  std::error_code none;
  s.driver = fs::read_symlink(folder / "device/driver", none).filename().string();
  s.fd = number_of(folder / "mtu").value_or(0) >= fd_frame_bytes;
  s.up = (number_of(folder / "flags").value_or(0) & IFF_UP) != 0;
  s.running = s.up && line_of(folder / "carrier") == "1";
  if (!s.up) {
    s.problem = "it is down; as root, with the bit rate of the bus: " + line_that_brings_up(s.name, s.fd);
  } else if (!s.running) {
    s.problem =
        "its controller is not on the bus, bus-off most likely; see to wiring, termination and bit rate, then as "
        "root: ip link set " +
        s.name + " down && ip link set " + s.name + " up";
  }
  return s;
}

}  // namespace

std::vector<interface_state> list_interfaces(const fs::path& sys_class_net) {
  std::vector<interface_state> out;
  std::error_code wrong;
  for (fs::directory_iterator at(sys_class_net, wrong), end; !wrong && at != end; at.increment(wrong)) {
    if (number_of(at->path() / "type") == unsigned{ARPHRD_CAN}) out.push_back(state_of(at->path()));
  }
  std::sort(out.begin(), out.end(), [](const interface_state& a, const interface_state& b) { return a.name < b.name; });
  return out;
}

}  // namespace asperity::can
