#include "asperity/drivers/canopen/cia402_setup.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>

namespace asperity::canopen {
namespace {

// A process-data object, redefined as CiA 301 asks for: switched off, emptied, filled, switched on.
void add_pdo(setup_steps& to, std::uint16_t communication, std::uint32_t id,
             std::initializer_list<std::uint32_t> mapped) {
  constexpr std::uint32_t off = 0x80000000U;
  using enum setup_step::kind;
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  const auto count = static_cast<std::uint32_t>(mapped.size());
  static_cast<void>(to.push_back({write, {communication, 1}, id | off, 4}));
  static_cast<void>(to.push_back({write, {mapping, 0}, 0, 1}));
  static_cast<void>(to.push_back({write, {communication, 2}, 1, 1}));  // at every SYNC
  std::uint8_t sub = 0;
  for (const std::uint32_t object : mapped) static_cast<void>(to.push_back({write, {mapping, ++sub}, object, 4}));
  static_cast<void>(to.push_back({write, {mapping, 0}, count, 1}));
  static_cast<void>(to.push_back({write, {communication, 1}, id, 4}));
  static_cast<void>(to.push_back({expect, {mapping, 0}, count, 1}));
}

}  // namespace

std::int16_t torque_limit_permille(const cia402_settings& c) noexcept {
  if (!(c.rated_torque_n_m > 0.0) || !(c.gear_ratio > 0.0) || !(c.peak_torque_n_m > 0.0)) return 0;
  // 3 N m of 1.5 N m rated is 2000, not the 1999 that rounding can make of it.
  const double permille = std::floor(c.peak_torque_n_m / c.gear_ratio / c.rated_torque_n_m * 1000.0 * (1.0 + 1e-12));
  return static_cast<std::int16_t>(std::clamp(permille, 0.0, 32767.0));
}

setup_steps setup_of(const cia402_settings& c) {
  constexpr std::uint32_t off = 0x80000000U;
  constexpr std::uint32_t no_remote = 0x40000000U;  // a TPDO that answers no remote frames: many drives insist
  using enum setup_step::kind;
  setup_steps s;
  const auto add = [&s](setup_step::kind what, object_address at, std::uint32_t value, std::uint8_t size) {
    static_cast<void>(s.push_back({what, at, value, size}));
  };
  add(torque_modes, {0x6502, 0}, 0, 4);
  add(rated_torque, {0x6076, 0}, 0, 4);
  add(write, {0x6071, 0}, 0, 2);
  add(write_if_there, {0x60b2, 0}, 0, 2);  // torque offset
  add(write, {0x6072, 0}, static_cast<std::uint32_t>(torque_limit_permille(c)), 2);
  add(write, {0x6060, 0}, static_cast<std::uint32_t>(canopen::torque_mode), 1);

  const std::uint32_t watched_host = (std::uint32_t{c.host_node} << 16) | c.host_silence_ms;
  add(write, {0x1016, 1}, watched_host, 4);
  add(expect, {0x1016, 1}, watched_host, 4);
  add(write_if_there, {0x6007, 0}, 1, 2);  // a silent host is a fault
  add(write, {0x1017, 0}, c.drive_heartbeat_ms, 2);

  add_pdo(s, 0x1400, rpdo1_id + c.node, {0x60400010, 0x60600008, 0x60710010});
  add_pdo(s, 0x1800, (tpdo1_id + c.node) | no_remote, {0x60410010, 0x60610008, 0x60770010});
  add_pdo(s, 0x1801, (tpdo2_id + c.node) | no_remote, {0x60640020, 0x606c0020});
  // What a drive may send and take by default would only fill the bus.
  add(write_if_there, {0x1401, 1}, (rpdo2_id + c.node) | off, 4);
  add(write_if_there, {0x1402, 1}, (rpdo3_id + c.node) | off, 4);
  add(write_if_there, {0x1403, 1}, (rpdo4_id + c.node) | off, 4);
  add(write_if_there, {0x1802, 1}, (tpdo3_id + c.node) | no_remote | off, 4);
  add(write_if_there, {0x1803, 1}, (tpdo4_id + c.node) | no_remote | off, 4);
  return s;
}

}  // namespace asperity::canopen
