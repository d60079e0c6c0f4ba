// A device session on record, felt again on the virtual clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asperity/device/any_device.hpp"
#include "asperity/device/device_recording.hpp"
#include "session.hpp"

namespace asperity::command {

/// How a replay went.
struct replay_outcome {
  std::string device;                        ///< name of the recorded one
  std::size_t ticks = 0;                     ///< on record until that session was told to end
  std::uint64_t differences = 0;             ///< calls and commands that were not those on record
  std::optional<double> first_difference_s;  ///< when; nothing without differences
  bool cut = false;                          ///< the recording ended before its session did
};

/// The first armed session of a recording: its device, the pose in which it was taken up, and the times of its ticks.
///
/// The hand on record moves as it moved then, whatever it is told now: the loop is open. Where every command is the one
/// of then, that is the session itself; where commands differ, replay_outcome says from when on.
class device_replay {
 public:
  /// Reads a recording and makes its calls up to the first arm().
  /// @return io_failed | bad_format | limit_exceeded | unsupported where its calls are not those of a session of ticks
  [[nodiscard]] static result<device_replay> open(const std::filesystem::path& file);

  /// The recorded device, as it was before it was armed. The replay can be asked as long as it lives.
  [[nodiscard]] any_device device() const;

  /// The handle's pose with which the probe was taken up; nothing of the simulated device, which needs none.
  [[nodiscard]] const std::optional<pose>& T_dh_start() const noexcept { return T_dh_start_; }
  [[nodiscard]] const given_ticks& ticks() const noexcept { return ticks_; }
  /// How long the session was, s.
  [[nodiscard]] double seconds(std::int64_t device_period_ns) const noexcept;
  /// What has happened up to now.
  [[nodiscard]] replay_outcome outcome() const;

 private:
  device_replay() = default;

  std::shared_ptr<replay_device> on_record_;
  std::vector<std::int64_t> call_times_ns_;  // of every call, or of the next one that has a time
  std::optional<pose> T_dh_start_;
  given_ticks ticks_;
  bool cut_ = false;
};

}  // namespace asperity::command
