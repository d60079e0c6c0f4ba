// The memory that a program shares with the process of a driver. Both sides are built from this file; each judges what
// it reads, because the other may be broken.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "asperity/device/driver_abi.h"
#include "asperity/plugin/shared_slot.hpp"

namespace asperity::plugin {

inline constexpr std::size_t most_listed = 64;

/// What the driver's process is about. Written by it, shown by the program where it did not come to an end.
enum class child_phase : std::uint32_t {
  starting,
  loading,
  idle,
  list,
  make,
  destroy,
  capabilities,
  open,
  arm,
  clear_fault,
  disarm,
  close,
  read,
  write,
  fault_text,
  ending,
};
inline constexpr std::uint32_t child_phase_count = 16;

/// What can be asked outside a tick.
enum class child_call : std::uint32_t {
  load,
  list,
  make,
  destroy,
  capabilities,
  open,
  arm,
  clear_fault,
  close,
  fault_text,
  quit,
};
inline constexpr std::uint32_t child_call_count = 11;

/// Asked in a tick. One struct with the newest of each kind, so that a measurement that is asked for never takes the
/// place of a command that was not put out yet.
struct tick_request {
  std::uint64_t reads = 0;  ///< of each kind, how many were asked so far
  std::uint64_t writes = 0;
  std::uint64_t disarms = 0;
  std::int64_t read_ns = 0;  ///< session clock
  std::int64_t write_ns = 0;
  asperity_command command{};
};

struct tick_answer {
  std::uint64_t stamp = 0;  ///< grows with every answer of either kind: which state is the newer one
  std::uint64_t reads = 0;  ///< the last of each kind that was answered
  std::uint64_t writes = 0;
  std::uint64_t disarms = 0;
  std::int32_t read_code = ASPERITY_FAILED;
  std::int32_t write_code = ASPERITY_OK;
  std::int32_t disarm_code = ASPERITY_OK;
  std::int32_t state = ASPERITY_STATE_ABSENT;
  std::uint64_t silences = 0;  ///< how often the device was disarmed because the program was silent
  asperity_sample sample{};
};

struct call_request {
  std::uint64_t number = 0;
  std::uint32_t call = 0;
  std::uint32_t reserved = 0;
  asperity_listing which{};
};

struct call_answer {
  std::uint64_t stamp = 0;
  std::uint64_t number = 0;
  std::int32_t code = ASPERITY_FAILED;
  std::int32_t state = ASPERITY_STATE_ABSENT;
  std::uint32_t count = 0;     ///< of list()
  std::uint32_t maturity = 0;  ///< of the driver
  char text[ASPERITY_TEXT_SIZE] = "";
  char name[ASPERITY_TEXT_SIZE] = "";
  char version[ASPERITY_TEXT_SIZE] = "";
  char licence[ASPERITY_TEXT_SIZE] = "";
  char vendor[ASPERITY_TEXT_SIZE] = "";
  asperity_capabilities capabilities{};
};

struct listed_item {
  asperity_listing listing{};  ///< its pointer means nothing here
  asperity_capabilities capabilities{};
  std::uint64_t has_capabilities = 0;
};

/// Laid out once by the program; the driver's process finds it behind a descriptor that can neither grow nor shrink.
struct child_page {
  static constexpr std::uint64_t layout = 0x61737065'00000002;

  std::uint64_t version = layout;
  std::uint64_t size = sizeof(child_page);
  std::uint64_t paced = 0;           ///< 1: the session is on CLOCK_MONOTONIC, and its silence means something
  std::int64_t disarm_after_ns = 0;  ///< of silence, counted from when the last command expired
  std::atomic<std::uint32_t> host_bell{0};
  std::atomic<std::uint32_t> child_bell{0};
  std::atomic<std::uint32_t> phase{0};
  shared_slot<tick_request> request{};
  shared_slot<tick_answer> answer{};
  shared_slot<call_request> call{};
  shared_slot<call_answer> called{};
  std::array<shared_slot<listed_item>, most_listed> listed{};
};

// Descriptors that the driver's process begins with.
inline constexpr int child_page_descriptor = 3;
inline constexpr int child_driver_descriptor = 4;

[[nodiscard]] constexpr const char* to_string(child_phase p) noexcept {
  constexpr std::array<const char*, child_phase_count> names{"while its process was started",
                                                             "while it was loaded",
                                                             "between two calls",
                                                             "in list()",
                                                             "in make()",
                                                             "in destroy()",
                                                             "in capabilities()",
                                                             "in open()",
                                                             "in arm()",
                                                             "in clear_fault()",
                                                             "in disarm()",
                                                             "in close()",
                                                             "in read()",
                                                             "in write()",
                                                             "in fault_text()",
                                                             "while its process ended"};
  const auto i = static_cast<std::uint32_t>(p);
  return i < child_phase_count ? names[i] : "in a call that does not exist";
}

}  // namespace asperity::plugin
