// What a controller's error frames say about the bus.
#pragma once

#include <cstdint>
#include <linux/can.h>
#include <linux/can/error.h>

#include "asperity/transport/can_bus.hpp"

namespace asperity::can {

/// Not in the headers of kernels before 5.19, which tell no counters in this way.
inline constexpr std::uint32_t error_has_counters = 0x00000200U;

/// Takes an error frame into account.
/// @source linux/can/error.h (Linux 6.1)   @rt safe
inline void apply_error_frame(std::uint32_t id, const std::uint8_t (&data)[CAN_ERR_DLC], can_health& health) noexcept {
  if ((id & CAN_ERR_RESTARTED) != 0) {
    health.bus_off = false;
    health.error_passive = false;
    health.transmit_errors = 0;
    health.receive_errors = 0;
  }
  if ((id & CAN_ERR_CRTL) != 0) {
    constexpr unsigned passive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
    constexpr unsigned milder = CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING | CAN_ERR_CRTL_ACTIVE;
    const unsigned state = data[1];
    if ((state & passive) != 0) {
      health.error_passive = true;
    } else if ((state & milder) != 0) {
      health.error_passive = false;
    }
    if ((state & CAN_ERR_CRTL_ACTIVE) != 0) health.bus_off = false;
    if ((state & CAN_ERR_CRTL_RX_OVERFLOW) != 0) ++health.lost;  // the controller does not say how many
  }
  if ((id & error_has_counters) != 0) {
    health.transmit_errors = data[6];
    health.receive_errors = data[7];
  }
  if ((id & CAN_ERR_BUSOFF) != 0) health.bus_off = true;  // last: it stands whatever else the frame says
}

}  // namespace asperity::can
