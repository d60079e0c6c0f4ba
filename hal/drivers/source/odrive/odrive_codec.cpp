#include "asperity/drivers/odrive/odrive_codec.hpp"

#include <cstdint>

namespace asperity::odrive {

const char* to_string_error(std::uint32_t error, firmware v) noexcept {
  const auto has = [error](std::uint32_t bit) { return (error & bit) != 0; };
  if (v == firmware::v0_5) {
    if (has(0x800)) return "the drive's watchdog expired";
    if (has(0x4000)) return "the drive was stopped by an emergency stop";
    if (has(0x40)) return "the drive reports a fault of its motor";
    if (has(0x100)) return "the drive reports a fault of its encoder";
    if (has(0x200)) return "the drive reports a fault of its controller";
    if (has(0x3000)) return "the drive reports that an end stop is pressed";
    if (has(0x80000)) return "the drive reports that it knows no position";
    if (has(0x1)) return "the drive refused a state: it is not calibrated";
    return "the drive reports an error";
  }
  if (has(0x1000000)) return "the drive's watchdog expired";
  if (has(0x2000000)) return "the drive was stopped by an emergency stop";
  if (has(0x100)) return "the drive reports an over-voltage";
  if (has(0x200)) return "the drive reports an under-voltage";
  if (has(0xc00)) return "the drive reports an over-current of its supply";
  if (has(0x1000)) return "the drive reports a current over its limit";
  if (has(0x6000)) return "the drive reports an over-temperature";
  if (has(0x18000)) return "the drive reports a velocity or position over its limit";
  if (has(0x8)) return "the drive reports that it has no estimate of position";
  if (has(0x20)) return "the drive reports a fault of its gate driver";
  if (has(0x4000000)) return "the drive reports that its motor spins out";
  if (has(0x10000000)) return "the drive reports that a thermistor is disconnected";
  if (has(0x40000010)) return "the drive reports that it is not configured or not calibrated";
  return "the drive reports an error";
}

}  // namespace asperity::odrive
