// What every entry point of the C interface does: it checks handles and sizes, catches, and puts faults into words.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "asperity/c/answer.h"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"

namespace asperity::c {

[[nodiscard]] constexpr std::int32_t answer(status s) noexcept { return static_cast<std::int32_t>(s); }
[[nodiscard]] constexpr std::int32_t answer(error_code code) noexcept {
  return ASPERITY_ERROR_INVALID_ARGUMENT + static_cast<std::int32_t>(code);
}

static_assert(answer(status::gate_shut) == ASPERITY_STATUS_GATE_SHUT);
static_assert(answer(status::backend_failed) == ASPERITY_STATUS_BACKEND_FAILED);
static_assert(answer(error_code::invalid_argument) == ASPERITY_ERROR_INVALID_ARGUMENT);
static_assert(answer(error_code::busy) == ASPERITY_ERROR_BUSY);

/// First member of every handle: which kind it is, so that another kind is seen whatever the caller's language lets
/// through. A handle that is freed has none; that is a help and no promise.
template <std::uint32_t number>
struct handle_mark {
  static constexpr std::uint32_t kind = number;
  volatile std::uint32_t is = number;
  handle_mark() noexcept = default;
  handle_mark(const handle_mark&) = delete;
  handle_mark& operator=(const handle_mark&) = delete;
  ~handle_mark() { is = 0; }
};

/// The handle, or null where it is none of this kind. @rt safe
template <class Handle>
[[nodiscard]] Handle* checked(Handle* given) noexcept {
  if (given == nullptr || reinterpret_cast<std::uintptr_t>(given) % alignof(Handle) != 0) return nullptr;
  std::uint32_t is = 0;
  std::memcpy(&is, static_cast<const void*>(given), sizeof is);
  return is == Handle::kind ? given : nullptr;
}

inline constexpr std::uint32_t least_struct = 8, largest_struct = 4096;

/// Whether a struct of the caller can be read or filled in. @rt safe
template <class Struct>
[[nodiscard]] bool has_size(const Struct* given) noexcept {
  static_assert(std::is_trivially_copyable_v<Struct> && offsetof(Struct, size) == 0 && sizeof(Struct) % 8 == 0);
  return given != nullptr && given->size >= least_struct && given->size <= largest_struct && given->size % 8 == 0;
}

/// Takes a struct of settings: what the caller's lacks is zero. Null is all zero.
/// @return ok | invalid_argument (its size) | unsupported (it says something that this version does not know)   @rt safe
template <class Struct>
[[nodiscard]] std::int32_t take(const Struct* given, Struct& out) noexcept {
  std::memset(&out, 0, sizeof out);
  if (given == nullptr) return ASPERITY_STATUS_OK;
  if (!has_size(given)) return ASPERITY_ERROR_INVALID_ARGUMENT;
  std::memcpy(&out, given, std::min<std::size_t>(given->size, sizeof out));
  const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
  for (std::size_t i = sizeof out; i < given->size; ++i) {
    if (bytes[i] != 0) return ASPERITY_ERROR_UNSUPPORTED;
  }
  return ASPERITY_STATUS_OK;
}

/// Fills in what the caller's struct has room for; its size stays. @pre has_size(to)   @rt safe
template <class Struct>
void give(Struct* to, const Struct& full) noexcept {
  const std::size_t size = to->size, known = std::min(size, sizeof full);
  constexpr std::size_t after_size = sizeof full.size;
  auto* const bytes = reinterpret_cast<unsigned char*>(to);
  std::memcpy(bytes + after_size, reinterpret_cast<const unsigned char*>(&full) + after_size, known - after_size);
  std::memset(bytes + known, 0, size - known);
}

/// Writes the sentence where one is wanted. @return the code   @rt safe
inline std::int32_t refuse(asperity_error* why, std::int32_t code, std::string_view sentence) noexcept {
  if (!has_size(why)) return code;
  why->code = code;
  const std::size_t room = std::min<std::size_t>(why->size, sizeof *why) - offsetof(asperity_error, message);
  if (room == 0) return code;
  std::size_t length = std::min(sentence.size(), room - 1);
  // Not in the middle of a character.
  while (length < sentence.size() && length > 0 && (static_cast<unsigned char>(sentence[length]) & 0xc0U) == 0x80U)
    --length;
  std::memcpy(why->message, sentence.data(), length);
  std::memset(why->message + length, 0, room - length);
  return code;
}
inline std::int32_t refuse(asperity_error* why, const error& e) noexcept {
  return refuse(why, answer(e.code), e.message);
}
inline std::int32_t refuse_argument(asperity_error* why, std::string_view sentence) noexcept {
  return refuse(why, ASPERITY_ERROR_INVALID_ARGUMENT, sentence);
}
/// What take() answered, in words.
inline std::int32_t refuse_struct(asperity_error* why, std::int32_t taken) noexcept {
  return refuse(why, taken,
                taken == ASPERITY_ERROR_UNSUPPORTED
                    ? "the settings say something that this version of the library does not know: set what lies beyond "
                      "its struct to zero, or use a newer library"
                    : "the settings' size is not that of a struct: set its field size to sizeof the struct");
}

/// Runs what may throw. Nothing leaves.
template <class Work>
[[nodiscard]] std::int32_t guarded(asperity_error* why, Work&& work) noexcept {
  try {
    return std::forward<Work>(work)();
  } catch (const std::bad_alloc&) {
    return refuse(why, ASPERITY_ERROR_OUT_OF_MEMORY, "there is not enough memory: free what is not needed any more");
  } catch (const std::exception& e) {
    return refuse(why, ASPERITY_ERROR_UNEXPECTED, e.what());
  } catch (...) {
    return refuse(why, ASPERITY_ERROR_UNEXPECTED, "an exception of an unknown kind was caught");
  }
}

/// A pose of seven numbers, not checked. @rt safe
[[nodiscard]] inline pose pose_of(const double* n) noexcept {
  return {quat_from_xyzw({n[3], n[4], n[5], n[6]}), {n[0], n[1], n[2]}};
}
/// @rt safe
inline void put(const pose& T, double* out) noexcept {
  const auto q = to_xyzw(T.rotation);
  const double n[7] = {T.position.x, T.position.y, T.position.z, q[0], q[1], q[2], q[3]};
  std::copy(n, n + 7, out);
}
/// @rt safe
inline void put(const vec3& v, double* out) noexcept {
  const double n[3] = {v.x, v.y, v.z};
  std::copy(n, n + 3, out);
}
/// @rt safe
inline void put(const wrench& w, double* out) noexcept {
  put(w.force, out);
  put(w.torque, out + 3);
}
/// @rt safe
[[nodiscard]] inline vec3 vec3_of(const double* n) noexcept { return {n[0], n[1], n[2]}; }

/// A pose in settings, where all zeros stand for `usual`.
[[nodiscard]] inline pose pose_or(const double* given, const pose& usual) noexcept {
  return std::all_of(given, given + 7, [](double x) { return x == 0.0; }) ? usual : pose_of(given);
}

/// A number in settings, where 0 stands for `usual`.
[[nodiscard]] inline double or_usual(double given, double usual) noexcept { return given == 0.0 ? usual : given; }

/// Collects the first setting that is out of its range.
class range_check {
 public:
  range_check& within(const char* name, double x, double low, double high) {
    if (!fault_.empty() || (x >= low && x <= high)) return *this;
    fault_ = std::string(name) + " is out of range: give " + std::to_string(low) + " to " + std::to_string(high) +
             ", or 0 for the usual one";
    return *this;
  }
  range_check& holds(bool condition, const char* sentence) {
    if (fault_.empty() && !condition) fault_ = sentence;
    return *this;
  }
  [[nodiscard]] result<void> done() const {
    if (fault_.empty()) return {};
    return error{error_code::invalid_argument, fault_};
  }

 private:
  std::string fault_;
};

}  // namespace asperity::c
