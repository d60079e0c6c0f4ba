// What a bus needs in every period besides its drives.
#pragma once

#include <cstdint>

#include "asperity/transport/can_bus.hpp"

namespace asperity {

/// The host's part in a protocol that belongs to a whole bus: a clock for all, a heartbeat. The owner of the bus calls
/// step() once in every period, after the drives' own step(). A protocol that needs nothing of the kind has none.
/// Nothing here blocks, allocates, locks, throws or reads a clock.
class bus_service {
 public:
  bus_service() = default;
  bus_service(const bus_service&) = delete;
  bus_service& operator=(const bus_service&) = delete;
  virtual ~bus_service() = default;

  /// Once per period, and only because the application ticked. @return the worst answer of the bus
  [[nodiscard]] virtual io_status step(std::int64_t now_ns, can_bus& bus) noexcept = 0;
  /// Ends the session on this bus in order. Failures are not reported, because no caller could act on them.
  virtual void finish(std::int64_t now_ns, can_bus& bus) noexcept = 0;
};

}  // namespace asperity
