// A recorded session as a device: the same questions get the same answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/device/recorder.hpp"

namespace asperity {

/// Why a session on record came to its end, as the program reported that recorded it.
enum class recorded_end : std::uint8_t {
  not_reported,
  stopped,      ///< it had lasted long enough, or its gate had shut
  interrupted,  ///< a signal asked for it
};
inline constexpr int recorded_end_count = 3;

/// A device session on record.
struct device_recording {
  std::string name;                            ///< of the device
  device_capabilities capabilities{};          ///< its name is that of `name`
  device_state before = device_state::absent;  ///< the first call
  std::vector<call_record> calls;
  recorded_end end = recorded_end::not_reported;
  /// Writes until then; those after it take the wrench to zero. 0 where it was not reported.
  std::uint64_t writes_before_end = 0;
  bool cut = false;  ///< its bytes ended before it did: these are the calls up to its last whole block
};

/// Whether two commands are the same to the bit.
[[nodiscard]] ASPERITY_API bool same_bits(const device_command& a, const device_command& b) noexcept;

/// Answers call by call what was recorded. Where it is asked something else than was asked then (another operation,
/// another time, another command), it counts a difference; a read or a write at the wrong place fails.
/// There is no hardware behind it: no command leaves the program.
/// @rt safe after construction
class ASPERITY_API replay_device {
 public:
  using policy_tag = device_tag;

  explicit replay_device(device_recording recording);
  replay_device(replay_device&& from) noexcept { *this = std::move(from); }
  replay_device& operator=(replay_device&& from) noexcept;
  replay_device(const replay_device&) = delete;
  replay_device& operator=(const replay_device&) = delete;
  ~replay_device() = default;

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return recording_.capabilities; }
  [[nodiscard]] device_state state() const noexcept { return state_; }

  [[nodiscard]] result<void> open() { return outside(device_call::open, "open"); }
  [[nodiscard]] result<void> arm() { return outside(device_call::arm, "arm"); }
  [[nodiscard]] result<void> clear_fault() { return outside(device_call::clear_fault, "clear_fault"); }
  status disarm() noexcept;
  void close() noexcept { static_cast<void>(take(device_call::close, 0)); }

  /// @return what was answered then; backend_failed where the recording holds no such call here
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept;
  /// @return what was answered then; backend_failed where the recording holds no such call here
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept;

  /// Calls, or commands, that were not those of the recording.
  [[nodiscard]] std::uint64_t differences() const noexcept { return differences_; }
  /// Number of the first call that differed. @pre differences() > 0
  [[nodiscard]] std::size_t first_difference() const noexcept { return first_difference_; }
  /// Whether every recorded call was made.
  [[nodiscard]] bool finished() const noexcept { return next_ == recording_.calls.size(); }
  [[nodiscard]] std::size_t calls_made() const noexcept { return next_; }

 private:
  // The capabilities carry a view of the name, which moves with the recording.
  void name_view() noexcept { recording_.capabilities.name = recording_.name; }

  void differs(std::size_t at) noexcept;

  // Only the call that comes next is answered: an answer out of turn would be another session's.
  [[nodiscard]] const call_record* take(device_call call, std::int64_t now_ns) noexcept;

  result<void> outside(device_call call, const char* name);

  device_recording recording_;
  device_state state_ = device_state::absent;
  std::size_t next_ = 0;
  std::uint64_t differences_ = 0;
  std::size_t first_difference_ = 0;
};

static_assert(haptic_device<replay_device>);

}  // namespace asperity
