// Every call to a session's device and every answer, on their way into a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "asperity/device/any_device.hpp"
#include "asperity/device/device_recording.hpp"
#include "output_file.hpp"

namespace asperity::command {

/// Device ticks of the longest session whose calls fit into one recording: 4000 s at 1 kHz.
inline constexpr double most_recorded_ticks = 4e6;

/// Calls come from the device's thread and wait in a ring; drain() writes them. The file appears with commit().
class device_recorder {
 public:
  /// Opens the file. @return io_failed
  [[nodiscard]] static result<std::unique_ptr<device_recorder>> create(const std::filesystem::path& file);

  /// The device with every call written down.
  /// @param device open and not armed; outlives what comes back, and so does the recorder, which is asked once
  [[nodiscard]] any_device around(any_device& device);

  /// Writes what has been called since. Not in a tick; one thread at a time. @return io_failed
  [[nodiscard]] result<void> drain();

  /// Writes the end. @param ticks device ticks before the session was told to end
  /// @return io_failed | limit_exceeded where calls were made faster than they could be written
  [[nodiscard]] result<void> finish(recorded_end why, std::uint64_t ticks);

  /// Makes the file appear. @pre finish() succeeded. @return io_failed
  [[nodiscard]] result<void> commit() { return file_.commit(); }

 private:
  static constexpr std::size_t ring_size = std::size_t{1} << 14;  // eight seconds at 1 kHz

  explicit device_recorder(output_file file) : file_(std::move(file)), ring_(ring_size) {}

  output_file file_;
  call_ring ring_;
  recording_encoder encoder_;
  std::string pending_;
  std::uint64_t written_blocks_ = 0;
};

}  // namespace asperity::command
