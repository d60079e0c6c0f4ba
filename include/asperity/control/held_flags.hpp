// Flags that stay for a while, so that a slower reader sees each of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/render/tick_flag.hpp"

namespace asperity {

/// Holds each flag for a while after the tick that told it. The device thread takes the newest contact and may leave
/// out others; what those told must not be lost.
class held_flags {
 public:
  static constexpr std::int64_t hold_ns = 50'000'000;

  /// @param told of a tick at now_ns   @rt safe
  [[nodiscard]] tick_flag held(tick_flag told, std::int64_t now_ns) noexcept {
    tick_flag out = told;
    for (std::size_t i = 0; i < until_ns_.size(); ++i) {
      const auto flag = static_cast<tick_flag>(1U << i);
      if (has(told, flag)) {
        until_ns_[i] = now_ns + hold_ns;
      } else if (now_ns < until_ns_[i]) {
        out |= flag;
      }
    }
    return out;
  }

 private:
  std::array<std::int64_t, 8> until_ns_{};
};

}  // namespace asperity
