// What a tick or a session says of a press that its planes do not answer, and how long it stays said.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace asperity {

/// Flags of a tick, of a contact on its way to the device thread, and of a device tick. None of them changes what is
/// put out. None is set while planes hold a probe that a hand presses with up to 20 N; anything set is worth showing to
/// the person who sets the scene up.
enum class tick_flag : std::uint8_t {
  none = 0,
  /// Deeper than a depth field can answer: nine tenths of half the body's thickness, or a place half way through where
  /// no way out is the shortest.
  beyond_field = 1,
  passed = 2,           ///< a point that touched has gone past half way through a body, or out on its far side
  not_held = 4,         ///< the overlap is beyond deepest_held_m
  planes_left_out = 8,  ///< near samples, or the support planes of a whole direction, did not fit
  unbalanced = 16,  ///< the contact solver left more than most_unbalanced_n, or found no solution; device ticks only
  /// A body was pressed without friction, because as many as can be rubbed on at once were; device ticks only.
  friction_left_out = 32,
  /// A moving body was told of no more, or what was told of it is no motion of a body, or there were too many: it stands
  /// still. Or one was told of that the scene does not have any more. Device ticks only.
  body_lost = 64,
  /// A body of a changing scene came where the probe is: its surface is felt further in, until the probe has left it.
  stands_back = 128,
};

/// Overlap beyond which planes do not hold the probe, m: the load of one plane of the usual 200 N/mm is 200 N there.
inline constexpr double deepest_held_m = 1e-3;
/// Force out of balance in one plane above which a device tick tells it, N: a tenth of what a hand can feel.
inline constexpr double most_unbalanced_n = 1e-3;

[[nodiscard]] constexpr tick_flag operator|(tick_flag a, tick_flag b) noexcept {
  return static_cast<tick_flag>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}
constexpr tick_flag& operator|=(tick_flag& a, tick_flag b) noexcept { return a = a | b; }
[[nodiscard]] constexpr bool has(tick_flag set, tick_flag bit) noexcept {
  return (static_cast<std::uint8_t>(set) & static_cast<std::uint8_t>(bit)) != 0;
}

/// Holds each flag for a while after the tick that reported it. The device thread takes the newest contact and may
/// leave out others, whose flags must not be lost.
class held_flags {
 public:
  static constexpr std::int64_t hold_ns = 50'000'000;

  /// @param reported flags of a tick at now_ns   @rt safe
  [[nodiscard]] tick_flag held(tick_flag reported, std::int64_t now_ns) noexcept {
    tick_flag out = reported;
    for (std::size_t i = 0; i < until_ns_.size(); ++i) {
      const auto flag = static_cast<tick_flag>(1U << i);
      if (has(reported, flag)) {
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
