// What a tick answers, and what everything outside a tick answers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace asperity {

/// Answer of a function inside a tick. Anything but ok leaves a safe result (a zero wrench) behind.
enum class status : std::uint8_t {
  ok,
  capacity_reached,  ///< the result is usable but something did not fit; the counter beside it says what
  invalid_pose,      ///< NaN, infinity or a quaternion that is not of unit length
  not_finite,        ///< a stage produced NaN or infinity; its output was zeroed
  stale_input,       ///< the newest input is older than its limit
  not_ready,         ///< the object was not set up, or was closed
  backend_failed,    ///< a device or depth backend could not answer
  gate_shut,         ///< the output gate is shut: the wrench was zeroed, and stays zero until the gate is cleared
};

/// The status in words.
[[nodiscard]] constexpr const char* to_string(status s) noexcept {
  switch (s) {
    case status::ok:
      return "ok";
    case status::capacity_reached:
      return "capacity reached";
    case status::invalid_pose:
      return "invalid pose";
    case status::not_finite:
      return "not finite";
    case status::stale_input:
      return "stale input";
    case status::not_ready:
      return "not ready";
    case status::backend_failed:
      return "backend failed";
    case status::gate_shut:
      return "gate shut";
  }
  return "unknown status";
}

/// What kind of fault stopped a set-up step.
enum class error_code : std::uint8_t {
  invalid_argument,  ///< a parameter is outside its range
  io_failed,         ///< a file could not be read or written
  bad_format,        ///< a file is not what it claims to be
  unsupported,       ///< well-formed, but not something this build can handle
  bad_mesh,          ///< a mesh that cannot carry a haptic texture
  bad_texture,       ///< a haptic texture that cannot be used
  limit_exceeded,    ///< larger than a stated limit
  cancelled,
  busy,  ///< the same is still under way; try again later
};

/// The code as it stands in JSON documents.
[[nodiscard]] constexpr const char* to_string(error_code c) noexcept {
  switch (c) {
    case error_code::invalid_argument:
      return "invalid_argument";
    case error_code::io_failed:
      return "io_failed";
    case error_code::bad_format:
      return "bad_format";
    case error_code::unsupported:
      return "unsupported";
    case error_code::bad_mesh:
      return "bad_mesh";
    case error_code::bad_texture:
      return "bad_texture";
    case error_code::limit_exceeded:
      return "limit_exceeded";
    case error_code::cancelled:
      return "cancelled";
    case error_code::busy:
      return "busy";
  }
  return "unknown_error";
}

/// Code and one sentence: what is wrong, where, and how to mend it.
struct error {
  error_code code;
  std::string message;
};

/// A value, or the error that prevented it. Outside a tick only.
/// Named after std::expected's members, which C++20 does not have yet.
template <class T>
class [[nodiscard]] result {
 public:
  result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  result(asperity::error e) : state_(std::in_place_index<1>, std::move(e)) {}

  [[nodiscard]] bool has_value() const noexcept { return state_.index() == 0; }
  [[nodiscard]] explicit operator bool() const noexcept { return has_value(); }

  /// @pre has_value()
  [[nodiscard]] T& value() & noexcept { return *std::get_if<0>(&state_); }
  [[nodiscard]] const T& value() const& noexcept { return *std::get_if<0>(&state_); }
  [[nodiscard]] T&& value() && noexcept { return std::move(*std::get_if<0>(&state_)); }
  [[nodiscard]] T& operator*() & noexcept { return value(); }
  [[nodiscard]] const T& operator*() const& noexcept { return value(); }
  [[nodiscard]] T&& operator*() && noexcept { return std::move(*this).value(); }
  [[nodiscard]] T* operator->() noexcept { return &value(); }
  [[nodiscard]] const T* operator->() const noexcept { return &value(); }

  /// @pre !has_value()
  [[nodiscard]] const asperity::error& error() const noexcept { return *std::get_if<1>(&state_); }

 private:
  std::variant<T, asperity::error> state_;
};

/// Success without a value, or an error.
template <>
class [[nodiscard]] result<void> {
 public:
  result() = default;
  result(asperity::error e) : error_(std::move(e)) {}

  [[nodiscard]] bool has_value() const noexcept { return !error_.has_value(); }
  [[nodiscard]] explicit operator bool() const noexcept { return has_value(); }
  /// @pre !has_value()
  [[nodiscard]] const asperity::error& error() const noexcept { return *error_; }

 private:
  std::optional<asperity::error> error_;
};

}  // namespace asperity
