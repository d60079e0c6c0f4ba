// Which bodies touch which, and who is reached from whom.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "asperity/bodies/free_bodies.hpp"

namespace asperity::detail {

/// Movers that touch each other: the probe and all free bodies have a bit each.
class touch_graph {
 public:
  using group = std::array<bool, most_free_bodies + 1>;

  explicit touch_graph(std::size_t movers) noexcept : movers_(movers) {}

  void clear() noexcept { touches_.fill(0); }
  /// Notes that two bodies touch; what is no mover is passed over.
  void meet(std::uint32_t a, std::uint32_t b) noexcept {
    if (a >= movers_ || b >= movers_) return;
    touches_[a] |= std::uint64_t{1} << b;
    touches_[b] |= std::uint64_t{1} << a;
  }
  [[nodiscard]] bool touch(std::size_t a, std::size_t b) const noexcept { return ((touches_[a] >> b) & 1U) != 0; }

  /// Every mover for which starts() holds, whom they touch, and whom these touch in their turn.
  template <class Starts>
  [[nodiscard]] group reached_from(Starts&& starts) const noexcept {
    group out{};
    for (std::size_t m = 0; m < movers_; ++m) out[m] = starts(m);
    for (bool grows = true; grows;) {
      grows = false;
      for (std::size_t m = 0; m < movers_; ++m) {
        for (std::size_t n = 0; out[m] && n < movers_; ++n) {
          if (!out[n] && touch(m, n)) out[n] = grows = true;
        }
      }
    }
    return out;
  }

 private:
  std::size_t movers_;
  std::array<std::uint64_t, most_free_bodies + 1> touches_{};
};

}  // namespace asperity::detail
