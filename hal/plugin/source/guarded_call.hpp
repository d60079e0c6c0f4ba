// Calls into a driver. A driver promises not to throw; this is for the one that does.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>

#include "asperity/device/driver_abi.h"

namespace asperity::plugin {

/// Answer of a call that threw: no driver can give it.
inline constexpr std::int32_t call_threw = INT32_MIN;

/// Costs nothing where nothing is thrown. @return the call's answer, ASPERITY_OK for one without, call_threw
template <class Call>
[[nodiscard]] std::int32_t guarded_call(Call&& call) noexcept {
  try {
    if constexpr (std::is_void_v<decltype(call())>) {
      call();
      return ASPERITY_OK;
    } else {
      return call();
    }
  } catch (...) {
    return call_threw;
  }
}

/// One sentence about a call that failed, from what the driver left in its buffer.
template <std::size_t N>
[[nodiscard]] std::string driver_error(std::int32_t code, char (&text)[N]) {
  if (code == call_threw) return "the driver threw an exception across its C interface, which it must not";
  text[N - 1] = '\0';  // whatever the driver did
  std::string out(text);
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20U || c == '\x7f') c = ' ';
  }
  return out.empty() ? "the driver gives no reason (code " + std::to_string(code) + ")" : out;
}

}  // namespace asperity::plugin
