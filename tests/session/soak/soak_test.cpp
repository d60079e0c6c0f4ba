// A minute of the session that `./dev soak` runs for a day, and the faults that it is there to find.
#include "session/soak/soak.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/sanitizers.hpp"

namespace {

using namespace asperity;

constexpr std::int64_t second = 1'000'000'000;

template <class Device>
std::vector<std::string> soaked(Device& dev, std::int64_t length_ns) {
  const soak::options options{.length_ns = length_ns};
  const result<soak::report> r = soak::run(options, dev, [](std::int64_t) { return true; });
  if (!r) return {r.error().message};
  std::printf("port %.1e, plant %.1e, probe %.1e of the turnover; %+lld pages, %+lld bytes\n", r->port.relative(),
              r->plant.relative(), r->probe.relative(),
              static_cast<long long>(r->after.resident_pages - r->before.resident_pages),
              static_cast<long long>(r->after.heap_bytes - r->before.heap_bytes));
  return soak::faults_of(*r, options);
}

bool names(const std::vector<std::string>& faults, const char* what) {
  for (const std::string& f : faults) {
    if (f.find(what) != std::string::npos) return true;
  }
  return false;
}

TEST(soak, keeps_time_does_not_grow_and_closes_its_books) {
  simulated_device dev(soak::tapping_hand());
  EXPECT_EQ(soaked(dev, 60 * second), std::vector<std::string>{});
}

// Negative controls: devices that do not do what they are told.

struct strong_device : simulated_device {
  using simulated_device::simulated_device;
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    device_command more = out;
    more.on_hand = 1.01 * out.on_hand;
    return simulated_device::write(now_ns, more);
  }
};

struct late_device : simulated_device {
  using simulated_device::simulated_device;
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    device_command before = out;
    before.on_hand = std::exchange(last, out.on_hand);
    return simulated_device::write(now_ns, before);
  }
  wrench last{};
};

TEST(soak, finds_a_device_one_percent_too_strong) {
  strong_device dev(soak::tapping_hand());
  EXPECT_TRUE(names(soaked(dev, 10 * second), "book of the port"));
}

TEST(soak, finds_a_device_one_sample_late) {
  late_device dev(soak::tapping_hand());
  EXPECT_TRUE(names(soaked(dev, 10 * second), "book of the port"));
}

// Five blocks a second of 24 bytes each. (One such block alone could come from what the allocator keeps for reuse,
// which counts as in use; tests/session/rt looks at every single one.)
struct hoarding_device : simulated_device {
  using simulated_device::simulated_device;
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    if (++writes % 200 == 0 && held < hoard.size()) hoard[held++] = std::make_unique<char[]>(24);
    return simulated_device::write(now_ns, out);
  }
  std::array<std::unique_ptr<char[]>, 100> hoard;
  std::size_t held = 0;
  int writes = 0;
};

TEST(soak, finds_blocks_that_are_not_given_back) {
  if (ASPERITY_ADDRESS_SANITIZER) GTEST_SKIP() << "the sanitizer's heap does not count for mallinfo2";
  hoarding_device dev(soak::tapping_hand());
  EXPECT_TRUE(names(soaked(dev, 10 * second), "heap grew"));
}

}  // namespace
