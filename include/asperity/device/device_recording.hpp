// A device session as bytes: docs/reference/device-recording.md in code. Never inside a tick.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "asperity/core/export.hpp"
#include "asperity/device/replay_device.hpp"

namespace asperity {

/// Turns calls into the bytes of a recording, piece by piece: begin, then every call in order, then end.
/// After every 256 calls comes a mark with a check sum: bytes that were written up to a mark can be read again,
/// whatever became of the rest.
class ASPERITY_API recording_encoder {
 public:
  recording_encoder() noexcept;
  [[nodiscard]] std::string begin(const device_capabilities& c, device_state before);
  [[nodiscard]] std::string call(const call_record& c);

  /// Whole blocks so far.
  [[nodiscard]] std::uint64_t blocks() const noexcept;

  /// @param writes_before_end see device_recording
  [[nodiscard]] std::string end(recorded_end why = recorded_end::not_reported, std::uint64_t writes_before_end = 0);

 private:
  std::string mark();
  std::string counted(std::string bytes);

  std::string last_seen_;
  bool gripper_ = false;
  std::uint64_t calls_ = 0;
  std::uint64_t sum_;
};

/// The bytes of a whole recording.
[[nodiscard]] ASPERITY_API std::string encode(const device_recording& recording);

/// The recording in `bytes`, of at most 8,388,608 calls. Memory grows with the calls that are there, whatever their
/// number is said to be, and takes at most four times the bytes and 512 MiB: a recording of so many short calls that
/// they would need more is no session. Bytes that end before the recording does, as those of a program that was killed,
/// give the calls up to the last whole block, and `cut` says so.
/// @param keep_going asked on the way; false ends the reading
/// @return bad_format for anything that encode() does not write, and for a cut before the first whole block's end |
/// limit_exceeded | cancelled
[[nodiscard]] ASPERITY_API result<device_recording> decode(const std::string& bytes,
                                                           const std::function<bool()>& keep_going = {});

/// Reads a recording from a file of at most 1 GiB.
/// @return io_failed | bad_format | limit_exceeded | cancelled
[[nodiscard]] ASPERITY_API result<device_recording> load_device_recording(const std::filesystem::path& file,
                                                                          const std::function<bool()>& keep_going = {});

}  // namespace asperity
