// The host on a CANopen bus: SYNC for all drives, and the host's heartbeat.
#pragma once

#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/drivers/canopen/frames.hpp"
#include "asperity/drivers/joint/bus_service.hpp"

namespace asperity {

struct canopen_master_settings {
  std::uint8_t node = 127;                      ///< cia402_settings::host_node of every drive on the bus
  std::int64_t heartbeat_every_ns = 5'000'000;  ///< several within cia402_settings::host_silence_ms
  bool reset_when_finished = true;  ///< reset the communication of every node on the bus at the end of a session
};

/// Sends SYNC in every step, and a heartbeat when one is due. It has no clock and no thread of its own: an application
/// that stops ticking stops the heartbeat, and every drive on the bus then stops by itself (object 1016).
/// One per bus.
/// @rt safe
class ASPERITY_API canopen_master final : public bus_service {
 public:
  explicit canopen_master(const canopen_master_settings& settings = {}) noexcept : settings_(settings) {}

  [[nodiscard]] io_status step(std::int64_t now_ns, can_bus& bus) noexcept override;

  /// Ends the supervision of our heartbeat, which would otherwise find the end of a session to be a fault.
  void finish(std::int64_t now_ns, can_bus& bus) noexcept override;

 private:
  canopen_master_settings settings_;
  bool beaten_ = false;
  std::int64_t beat_ns_ = 0;
};

}  // namespace asperity
