#include "asperity/drivers/mit/mit_codec.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace asperity::mit {

bool ranges::usable() const noexcept {
  const auto fine = [](double x) { return std::isfinite(x) && x > 1e-3 && x < 1e5; };
  return fine(position_rad) && fine(velocity_rad_per_s) && fine(torque_n_m) && fine(stiffness_n_m_per_rad) &&
         fine(damping_n_m_s_per_rad);
}

command decode_command(const command_bytes& b, const ranges& r) noexcept {
  const auto join = [](int high, int low) { return static_cast<std::uint16_t>(high << 8 | low); };
  const auto gain = [](std::uint16_t u, double most) { return most * static_cast<double>(u) / 4095.0; };
  const auto v = static_cast<std::uint16_t>(join(b[2], b[3]) >> 4U);
  const auto kp = static_cast<std::uint16_t>(join(b[3], b[4]) & 0xfffU);
  const auto kd = static_cast<std::uint16_t>(join(b[5], b[6]) >> 4U);
  const auto t = static_cast<std::uint16_t>(join(b[6], b[7]) & 0xfffU);
  return {.position_rad = symmetric_field(r.position_rad, 16).decode(join(b[0], b[1])),
          .velocity_rad_per_s = symmetric_field(r.velocity_rad_per_s, 12).decode(v),
          .stiffness_n_m_per_rad = gain(kp, r.stiffness_n_m_per_rad),
          .damping_n_m_s_per_rad = gain(kd, r.damping_n_m_s_per_rad),
          .torque_n_m = symmetric_field(r.torque_n_m, 12).decode(t)};
}

bool decode_reply(std::span<const std::uint8_t> b, const ranges& r, reply& out) noexcept {
  if (b.size() < 6 || b.size() > 8) return false;
  out = {};
  out.id = b[0];
  out.size = static_cast<std::uint8_t>(b.size());
  out.position_counts = static_cast<std::uint16_t>(b[1] << 8 | b[2]);
  out.velocity_rad_per_s =
      symmetric_field(r.velocity_rad_per_s, 12).decode(static_cast<std::uint16_t>(b[3] << 4 | b[4] >> 4));
  out.torque_n_m = symmetric_field(r.torque_n_m, 12).decode(static_cast<std::uint16_t>((b[4] & 0xf) << 8 | b[5]));
  if (b.size() == 7) out.voltage_counts = b[6];
  if (b.size() == 8) {
    out.temperature_c = b[6];
    out.error = b[7];
  }
  return true;
}

std::size_t encode_reply(const reply& a, const ranges& r, command_bytes& b) noexcept {
  const std::uint32_t v = symmetric_field(r.velocity_rad_per_s, 12).encode(a.velocity_rad_per_s);
  const std::uint32_t t = symmetric_field(r.torque_n_m, 12).encode(a.torque_n_m);
  const auto byte = [](std::uint32_t x) { return static_cast<std::uint8_t>(x & 0xffU); };
  const std::uint32_t p = a.position_counts;
  b = {a.id, byte(p >> 8U), byte(p), byte(v >> 4U), byte((v & 0xfU) << 4U | t >> 8U), byte(t), 0, 0};
  if (a.size == 7) b[6] = a.voltage_counts;
  if (a.size == 8) {
    b[6] = a.temperature_c;
    b[7] = a.error;
  }
  return a.size;
}

const char* to_string_error(std::uint8_t code) noexcept {
  switch (code) {
    case 0:
      return "none";
    case 1:
      return "the drive reports an over-temperature of the motor";
    case 2:
      return "the drive reports an over-current";
    case 3:
      return "the drive reports an over-voltage";
    case 4:
      return "the drive reports an under-voltage";
    case 5:
      return "the drive reports a fault of its encoder";
    case 6:
      return "the drive reports unbalanced phases or hot transistors";
    default:
      return "the drive reports an error that its documents do not list";
  }
}

}  // namespace asperity::mit
