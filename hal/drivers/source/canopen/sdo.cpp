#include "asperity/drivers/canopen/sdo.hpp"

#include <cstdint>

namespace asperity::canopen {

const char* abort_words(std::uint32_t code) noexcept {
  switch (code) {
    case abort_code::toggle:
      return "toggle bit not alternated";
    case abort_code::timed_out:
      return "protocol timed out";
    case abort_code::unknown_command:
      return "command not known";
    case abort_code::unsupported:
      return "access not supported";
    case abort_code::write_only:
      return "object can only be written";
    case abort_code::read_only:
      return "object can only be read";
    case abort_code::no_object:
      return "object does not exist";
    case abort_code::not_mappable:
      return "object cannot be mapped to a PDO";
    case abort_code::mapping_too_long:
      return "mapped objects are longer than a PDO";
    case 0x06040043:
      return "parameters are incompatible";
    case 0x06040047:
      return "device is internally incompatible";
    case 0x06060000:
      return "hardware error";
    case abort_code::wrong_length:
      return "data type or length does not match";
    case 0x06070012:
      return "data is too long";
    case 0x06070013:
      return "data is too short";
    case abort_code::no_sub:
      return "sub-index does not exist";
    case abort_code::bad_value:
      return "value is not valid";
    case abort_code::too_high:
      return "value is too high";
    case abort_code::too_low:
      return "value is too low";
    case 0x06090036:
      return "largest value is below the smallest";
    case 0x060a0023:
      return "resource is not available";
    case abort_code::general:
      return "general error";
    case abort_code::not_storable:
      return "data cannot be transferred or stored";
    case abort_code::local_control:
      return "data cannot be transferred because of local control";
    case abort_code::wrong_state:
      return "data cannot be transferred in the present state";
    default:
      return "reason not known";
  }
}

}  // namespace asperity::canopen
