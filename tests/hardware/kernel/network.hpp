// Makes, sets and removes network interfaces, as root.
#pragma once

#include <cstdint>
#include <string>

namespace asperity::network {

// Each does what the line of `ip` does, without starting a program, which in an emulated machine takes a third of a
// second. @return 0, or an errno value.

/// ip link add NAME type vcan
[[nodiscard]] int add_vcan(const std::string& name);
/// ip link del NAME
int remove(const std::string& name);
/// ip link set NAME up|down
[[nodiscard]] int set_up(const std::string& name, bool up);
/// ip link set NAME mtu BYTES. @pre it is down
[[nodiscard]] int set_mtu(const std::string& name, int bytes);
/// ip link set NAME txqueuelen FRAMES
[[nodiscard]] int set_queue(const std::string& name, int frames);
/// ip link set NAME type can bitrate BITS. @pre it is down
[[nodiscard]] int set_bit_rate(const std::string& name, std::uint32_t bits_per_s);

}  // namespace asperity::network
