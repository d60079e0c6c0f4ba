// Version and answers in words.
#include "asperity/c/answer.h"

#include "asperity/version.hpp"
#include "c/entry.hpp"

namespace {

const char* in_words(asperity::error_code code) noexcept {
  using asperity::error_code;
  switch (code) {
    case error_code::invalid_argument:
      return "invalid argument";
    case error_code::io_failed:
      return "a file could not be read or written";
    case error_code::bad_format:
      return "a file is not what it claims to be";
    case error_code::unsupported:
      return "not supported";
    case error_code::bad_mesh:
      return "a mesh that cannot carry a haptic texture";
    case error_code::bad_texture:
      return "a haptic texture that cannot be used";
    case error_code::limit_exceeded:
      return "larger than a limit";
    case error_code::cancelled:
      return "cancelled";
    case error_code::busy:
      return "in use";
  }
  return "unknown answer";
}

}  // namespace

const char* asperity_version(void) { return ASPERITY_VERSION_STRING; }

std::uint32_t asperity_version_number(void) {
  return ASPERITY_VERSION_MAJOR * 10'000U + ASPERITY_VERSION_MINOR * 100U + ASPERITY_VERSION_PATCH;
}

const char* asperity_describe(std::int32_t answer) {
  if (answer == ASPERITY_ERROR_OUT_OF_MEMORY) return "not enough memory";
  if (answer == ASPERITY_ERROR_UNEXPECTED) return "an exception that nobody foresaw";
  if (answer >= ASPERITY_STATUS_OK && answer <= ASPERITY_STATUS_GATE_SHUT)
    return to_string(static_cast<asperity::status>(answer));
  if (answer >= ASPERITY_ERROR_INVALID_ARGUMENT && answer <= ASPERITY_ERROR_BUSY)
    return in_words(static_cast<asperity::error_code>(answer - ASPERITY_ERROR_INVALID_ARGUMENT));
  return "unknown answer";
}
