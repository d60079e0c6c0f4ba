// From a Falcon that has power to one whose position is known.
#pragma once

#include <cstdint>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/drivers/falcon/falcon_settings.hpp"
#include "asperity/drivers/falcon/falcon_wire.hpp"
#include "asperity/transport/io_clock.hpp"
#include "falcon_firmware.hpp"

namespace asperity {

/// Sets the line up, loads the firmware where it does not answer, waits for a person to home the legs and for positions
/// that are believed. All frames that it sends ask for zero. It ticks by itself: not inside a tick.
class falcon_bring_up {
 public:
  /// @param wire attached @param path of the device, for errors
  falcon_bring_up(falcon_wire& wire, io_clock& clock, const falcon_settings& settings, const std::string& path);

  [[nodiscard]] result<void> run();

  /// When the last frame was sent.
  [[nodiscard]] std::int64_t last_frame_ns() const noexcept { return last_frame_ns_; }

 private:
  static constexpr std::int64_t tick_ns = 1'000'000;

  [[nodiscard]] error lost(const std::string& step, io_status s) const;

  // One frame out and what has come in, then a millisecond.
  [[nodiscard]] io_status exchange(falcon_light light, bool home) noexcept;

  // Whether the firmware runs: it answers frames.
  [[nodiscard]] result<bool> is_awake();

  // Loads the image until the firmware answers. Published experience: it does not always do so the first time.
  [[nodiscard]] result<void> wake();

  [[nodiscard]] result<void> home();
  [[nodiscard]] result<void> settle();

  falcon_wire& wire_;
  io_clock& clock_;
  const falcon_settings& settings_;
  const std::string& path_;
  std::int64_t last_frame_ns_ = 0;
};

}  // namespace asperity
