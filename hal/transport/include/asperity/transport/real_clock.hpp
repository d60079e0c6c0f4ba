// The clock of a session in the real world.
#pragma once

#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/transport/io_clock.hpp"

namespace asperity {

/// The monotonic clock that a real_session runs on.
class ASPERITY_API real_clock final : public io_clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override;
  void wait_until_ns(std::int64_t due_ns) noexcept override;
};

}  // namespace asperity
