// The time of a device loop, and how long its application has been silent.
#pragma once

#include <algorithm>
#include <cstdint>

namespace asperity {

/// A loop's own time: the steps forward of the session's clock, summed up. A clock that steps back stands still for one
/// tick, and the time goes on from there. @rt safe
class loop_clock {
 public:
  /// @param clock_ns the session's clock; the first one is where the time begins
  /// @return how far it went, ns; 0 in the first tick
  std::int64_t advance(std::int64_t clock_ns) noexcept {
    if (!started_) now_ns_ = last_clock_ns_ = clock_ns;
    const std::int64_t step_ns = std::max<std::int64_t>(0, clock_ns - last_clock_ns_);
    started_ = true;
    last_clock_ns_ = clock_ns;
    now_ns_ += step_ns;
    return step_ns;
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }

 private:
  bool started_ = false;
  std::int64_t last_clock_ns_ = 0;
  std::int64_t now_ns_ = 0;
};

/// Watches the beats of an application. The first look counts as a beat, because the application has just started the
/// session. A beat carries no time: one that is found after a long gap may have come at the end of it, so the whole gap
/// counts as silence. @rt safe
class heartbeat_watch {
 public:
  /// @param beats counted so far   @param limit_ns of silence; 0: any is allowed
  /// @return whether there was none for longer
  [[nodiscard]] bool is_silent(std::uint64_t beats, std::int64_t now_ns, std::int64_t limit_ns) noexcept {
    if (!heard_) beat_ns_ = now_ns;
    const bool silent = limit_ns > 0 && now_ns - beat_ns_ > limit_ns;
    if (beats != beats_) beat_ns_ = now_ns;
    beats_ = beats;
    heard_ = true;
    return silent;
  }
  /// Silence is counted from now on.
  void restart(std::int64_t now_ns) noexcept { beat_ns_ = now_ns; }

 private:
  std::uint64_t beats_ = 0;   // as last seen ...
  std::int64_t beat_ns_ = 0;  // ... to change at this time
  bool heard_ = false;
};

}  // namespace asperity
