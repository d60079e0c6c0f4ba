// The configuration that is written into a CiA 402 drive, and read back, before it is started.
#pragma once

#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/drivers/canopen/cia402.hpp"
#include "asperity/drivers/canopen/sdo.hpp"

namespace asperity {

/// One drive and the motor, gear and encoder behind it. Members without a default have to be set.
struct cia402_settings {
  std::uint8_t node = 1;          ///< 1 to 127
  std::uint8_t host_node = 127;   ///< the number under which our own heartbeat is sent; no drive has it
  double rated_torque_n_m = 0.0;  ///< of the motor: object 6076; a drive that says another is refused
  double peak_torque_n_m = 0.0;   ///< at the joint; saturates what is sent, and goes into the drive as object 6072
  double counts_per_turn = 0.0;   ///< of the motor: unit of objects 6064 and 606C
  double gear_ratio = 1.0;        ///< turns of the motor for one turn of the joint
  bool reversed = false;          ///< the joint turns against the motor
  double zero_offset_rad = 0.0;   ///< angle of the joint where the drive counts 0

  std::uint16_t host_silence_ms = 20;           ///< object 1016: the drive faults when the host is silent for longer
  std::uint16_t drive_heartbeat_ms = 10;        ///< object 1017
  std::int64_t drive_silence_ns = 50'000'000;   ///< longest time without a heartbeat, or without process data
  std::int64_t boot_limit_ns = 3'000'000'000;   ///< from the reset to the end of the configuration
  std::int64_t answer_limit_ns = 50'000'000;    ///< of one request, which is then repeated ...
  int answer_tries = 3;                         ///< ... so often in all
  std::int64_t state_limit_ns = 1'000'000'000;  ///< of each change of the drive's state; brakes take time
  bool quick_stop_on_fault = false;             ///< brake on a fault with the drive's own ramp, instead of letting go
};

namespace canopen {

/// One step of the configuration.
struct setup_step {
  enum class kind : std::uint8_t {
    write,
    write_if_there,  ///< an object that drives need not have
    expect,          ///< read back; another value is a fault
    torque_modes,    ///< object 6502: cyclic synchronous torque has to be among them
    rated_torque,    ///< object 6076: has to be the configured one
  };
  kind what = kind::write;
  object_address at{};
  std::uint32_t value = 0;
  std::uint8_t size = 4;
};
using setup_steps = fixed_vector<setup_step, 64>;

/// Largest command of a drive, thousandths of its rated torque; 0 where the configuration makes no sense.
[[nodiscard]] ASPERITY_API std::int16_t torque_limit_permille(const cia402_settings& c) noexcept;

/// The whole configuration, in the order in which it is written. Zero torque comes before everything that could let a
/// torque through, and what stops the drive when the host falls silent is read back.
[[nodiscard]] ASPERITY_API setup_steps setup_of(const cia402_settings& c);

}  // namespace canopen
}  // namespace asperity
