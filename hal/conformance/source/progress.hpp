// What the checking process is about, readable by the one that waits for it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace asperity::conformance {

struct progress {
  std::atomic<std::uint64_t> calls{0};
  char call[32] = "";
  char stage[96] = "";

  void enter(const char* name, std::string_view during) noexcept {
    put(call, name);
    put(stage, during);
    calls.fetch_add(1, std::memory_order_release);
  }

 private:
  template <std::size_t N>
  static void put(char (&field)[N], std::string_view text) noexcept {
    const std::size_t n = std::min(N - 1, text.size());
    std::copy_n(text.data(), n, field);
    field[n] = '\0';
  }
};

}  // namespace asperity::conformance
