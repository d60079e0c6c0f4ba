// How far the memory of this process goes while something runs.
#pragma once

#include <cstddef>
#include <cstdio>
#include <cstring>
#include <malloc.h>

#include "support/sanitizers.hpp"

namespace asperity::hostile {

/// Peak of the resident memory since begin(), beyond what was there then. Linux; blocks of 64 KiB and more come from
/// the system and go back to it, so that a run does not hide in what an earlier one left.
class peak_memory {
 public:
  peak_memory() {
    ::mallopt(M_MMAP_THRESHOLD, 1 << 16);
    ::mallopt(M_TRIM_THRESHOLD, 1 << 16);
    begin();
  }
  void begin() {
    if (std::FILE* const refs = std::fopen("/proc/self/clear_refs", "w"); refs != nullptr) {
      works_ = std::fputs("5", refs) >= 0;
      works_ = std::fclose(refs) == 0 && works_;
    }
    at_begin_ = status_bytes("VmRSS");
  }
  [[nodiscard]] std::size_t bytes() const {
    const std::size_t peak = status_bytes("VmHWM");
    return peak > at_begin_ ? peak - at_begin_ : 0;
  }
  /// Address space in use, bytes; 0 where the system does not tell.
  [[nodiscard]] static std::size_t mapped_bytes() { return status_bytes("VmSize"); }
  /// False where the system does not tell, and under a sanitizer, whose heap keeps what was freed.
  [[nodiscard]] bool works() const { return works_ && !sanitized; }

 private:
  static constexpr bool sanitized = ASPERITY_ADDRESS_SANITIZER || ASPERITY_THREAD_SANITIZER;

  static std::size_t status_bytes(const char* key) {
    unsigned long kb = 0;
    if (std::FILE* const status = std::fopen("/proc/self/status", "r"); status != nullptr) {
      char line[256];
      while (std::fgets(line, sizeof line, status) != nullptr) {
        if (std::strncmp(line, key, std::strlen(key)) == 0) std::sscanf(line + std::strlen(key), ": %lu", &kb);
      }
      std::fclose(status);
    }
    return 1024 * std::size_t{kb};
  }

  std::size_t at_begin_ = 0;
  bool works_ = false;
};

}  // namespace asperity::hostile
