// The obvious ways to break a renderer.
#pragma once

#include <array>
#include <cstdint>

namespace broken {

enum class mutation : std::uint8_t {
  none,
  no_transport,    ///< the torque about the contact is handed on as if it were about the centre of mass
  flipped_normal,  ///< n from B to A: its component of every gradient has the wrong sign
  nearest_texel,   ///< the haptic texture is read at its nearest texel instead of between four
  one_sided,       ///< (depth ahead - depth here) / step instead of the central difference
  no_curvature,    ///< the stiffness has the gradient's outer product alone
};

inline constexpr std::array mutations{mutation::no_transport, mutation::flipped_normal, mutation::nearest_texel,
                                      mutation::one_sided, mutation::no_curvature};

[[nodiscard]] inline const char* to_string(mutation m) noexcept {
  switch (m) {
    case mutation::none:
      return "none";
    case mutation::no_transport:
      return "transport term dropped";
    case mutation::flipped_normal:
      return "n flipped";
    case mutation::nearest_texel:
      return "nearest-texel lookup";
    case mutation::one_sided:
      return "one-sided difference";
    case mutation::no_curvature:
      return "curvature omitted";
  }
  return "unknown";
}

}  // namespace broken
