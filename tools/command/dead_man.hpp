// Whether a test force may be put out: only while somebody holds a button, and as long as that is heard of.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "asperity/control/rate_monitor.hpp"
#include "asperity/core/math.hpp"

namespace asperity::command {

/// What a page wants of the loop. A press is one holding of the button, from its first beat to its end.
struct force_wish {
  std::uint64_t press = 0;   ///< counts presses; 0: none yet
  std::uint64_t beats = 0;   ///< beats of this press so far
  bool released = false;     ///< the button was let go
  vec3 force_d{0.0};         ///< N on the hand, device base frame
  std::int64_t beat_ns = 0;  ///< when the newest beat arrived, for the record: nothing is decided by it
};

/// Why a press ended.
enum class press_end : std::uint8_t {
  none,        ///< it goes on
  released,    ///< the button was let go
  lost_beats,  ///< no beat in time
  not_begun,   ///< no first beat in time
  shut,        ///< the gate is shut, or the device may not put out anything
  refused,     ///< the force is no number, or more than may be
};

[[nodiscard]] constexpr const char* to_string(press_end e) noexcept {
  switch (e) {
    case press_end::none:
      return "held";
    case press_end::released:
      return "released";
    case press_end::lost_beats:
      return "lost beats";
    case press_end::not_begun:
      return "not begun";
    case press_end::shut:
      return "gate shut";
    case press_end::refused:
      return "refused";
  }
  return "unknown end";
}

struct dead_man_settings {
  std::int64_t longest_silence_ns = 100'000'000;  ///< between two beats
  std::int64_t first_beat_ns = 250'000'000;       ///< from the press to its first beat; nothing is put out before it
  std::int64_t rise_ns = 200'000'000;             ///< from nothing to the wanted force
  double most_n = 0.0;                            ///< largest force
};

/// The loop's side of a dead-man button. It times beats by the loop's own clock, so that nothing that hangs elsewhere can
/// prolong a press. An end is final: what is said of that press afterwards, beats too, changes nothing, and an older
/// press is never taken up again. Every press rises from zero.
/// @rt safe
class dead_man {
 public:
  explicit dead_man(const dead_man_settings& settings) noexcept : settings_(settings) {}

  /// The force that is wanted in this tick, before the gate.
  /// @param now_ns the loop's time
  /// @param may the gate is open, and the device may put out
  [[nodiscard]] vec3 wanted(std::int64_t now_ns, const force_wish& wish, bool may) noexcept {
    if (wish.press > press_) begin(now_ns, wish);
    if (end_ == press_end::none) end_ = ending(now_ns, wish, may);
    if (end_ != press_end::none || !begun_) return vec3(0.0);
    const auto held = static_cast<double>(now_ns - begun_ns_);
    const double rise =
        settings_.rise_ns > 0 ? std::clamp(held / static_cast<double>(settings_.rise_ns), 0.0, 1.0) : 1.0;
    return rise * force_d_;
  }

  /// Number of the newest press; 0 before the first.
  [[nodiscard]] std::uint64_t press() const noexcept { return press_; }
  /// Why the newest press ended; none while it is held.
  [[nodiscard]] press_end end() const noexcept { return end_; }
  /// Whether a press is held and its first beat has come.
  [[nodiscard]] bool holds() const noexcept { return begun_ && end_ == press_end::none; }
  /// Whether the newest press ever had a beat.
  [[nodiscard]] bool begun() const noexcept { return begun_; }
  [[nodiscard]] const vec3& force_d() const noexcept { return force_d_; }

 private:
  void begin(std::int64_t now_ns, const force_wish& wish) noexcept {
    press_ = wish.press;
    end_ = press_end::none;
    begun_ = false;
    pressed_ns_ = now_ns;
    force_d_ = wish.force_d;
    if (!(glm::length(force_d_) <= settings_.most_n)) end_ = press_end::refused;  // NaN too
  }

  [[nodiscard]] press_end ending(std::int64_t now_ns, const force_wish& wish, bool may) noexcept {
    if (wish.press != press_) return press_end::refused;  // the past is not taken up again
    if (wish.released) return press_end::released;
    if (!may) return press_end::shut;
    if (!begun_) {
      if (now_ns - pressed_ns_ > settings_.first_beat_ns) return press_end::not_begun;
      if (wish.beats == 0) return press_end::none;
      begun_ = true;
      begun_ns_ = now_ns;
      beats_ = heartbeat_watch();
    }
    // A beat that is found after a long gap may have come at the end of it: the whole gap counts as silence.
    return beats_.is_silent(wish.beats, now_ns, settings_.longest_silence_ns) ? press_end::lost_beats : press_end::none;
  }

  dead_man_settings settings_;
  std::uint64_t press_ = 0;
  press_end end_ = press_end::released;
  bool begun_ = false;
  std::int64_t pressed_ns_ = 0;
  std::int64_t begun_ns_ = 0;
  vec3 force_d_{0.0};
  heartbeat_watch beats_;
};

}  // namespace asperity::command
