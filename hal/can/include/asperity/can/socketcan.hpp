// CAN interfaces of a Linux kernel. Component asperity::can.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/transport/can_bus.hpp"

namespace asperity::can {

/// Lets frames through whose identifier agrees with `id` in the bits of `mask`.
struct id_filter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7FF;
  bool extended = false;  ///< frames with 29 bits; without, frames with 11
};

struct socketcan_settings {
  /// Sends and receives CAN FD as well. The interface has to be set up for it.
  bool fd = false;
  /// Frames that pass one of these filters are received, or all frames where there is none. Error frames always are.
  std::vector<id_filter> filters{};
  /// Bytes that the kernel buffers between two reads; a frame takes some 800 of them. Without privileges the kernel
  /// gives at most net.core.rmem_max.
  int receive_buffer_bytes = 1 << 20;
  /// After the kernel's queue was full, send() answers busy for this long without trying again. A timer, because the
  /// kernel calls such a socket writable all the while.
  std::int64_t busy_back_off_ns = 500'000;
};

/// Opens a CAN interface, which has to be up.
///
/// The bus that comes back never blocks. Frames carry the time at which the kernel took them from the driver. The
/// kernel gives it on the wall clock; it is brought to CLOCK_MONOTONIC by the difference of the two clocks, which is
/// measured here, once. A tick reads no clock. When somebody sets the wall clock, stamps leave the span between the
/// last read that found nothing and now_ns, by which it is noticed and corrected; between that and the correction a
/// stamp is off by no more than 2 ms and the time between two reads.
///
/// Its answers: a full queue is busy. Link down and bus-off are down, and end by themselves when the interface is up
/// again or the controller is restarted. A deleted interface and an unplugged adapter are gone, and stay so. Frames
/// that nobody read in time count in can_health::lost, as soon as a later one is read. Own frames do not come back;
/// other programs on this machine see them.
///
/// @return unsupported: the kernel has no CAN, this user may not use it, or FD is asked of an interface without |
///         invalid_argument: no such interface, or it is not CAN, or it is down | io_failed: anything else; the message
///         says how to mend it
[[nodiscard]] result<std::unique_ptr<can_bus>> open_socketcan(const std::string& interface,
                                                              const socketcan_settings& settings = {});

/// One CAN interface of this machine.
struct interface_state {
  std::string name;
  std::string driver;    ///< of the kernel, "kvaser_pci"; empty where there is no device behind it (vcan, slcan)
  bool up = false;       ///< set up and switched on
  bool running = false;  ///< up, and its controller is on the bus: not bus-off
  bool fd = false;       ///< set up for CAN FD
  std::string problem;   ///< why it cannot be used now, and what to type; empty where it can be
};

/// The CAN interfaces that there are, by name. Opens nothing.
/// @param sys_class_net where the kernel shows its network interfaces
[[nodiscard]] std::vector<interface_state> list_interfaces(
    const std::filesystem::path& sys_class_net = "/sys/class/net");

/// Whether this kernel has CAN sockets and lets this user have one; otherwise why not.
[[nodiscard]] result<void> check_support();

}  // namespace asperity::can
