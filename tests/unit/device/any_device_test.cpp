#include <bit>
#include <gtest/gtest.h>
#include <utility>

#include <asperity/device/any_device.hpp>
#include <asperity/device/simulated/simulated_device.hpp>

namespace {

using namespace asperity;

constexpr std::int64_t ms = 1'000'000;

simulated_settings wandering() {
  simulated_settings c;
  c.motion = {.kind = motion_kind::free};
  c.measurement.jitter_ns = 2 * ms;
  c.faults = {{device_fault::drop, 100 * ms, 103 * ms}, {device_fault::depart, 400 * ms, 401 * ms}};
  return c;
}

// Every answer of the device, folded into one number.
template <haptic_device Device>
std::uint64_t trace(Device& d) {
  std::uint64_t h = 1469598103934665603ULL;
  const auto add = [&](std::uint64_t bits) { h = (h ^ bits) * 1099511628211ULL; };
  add(static_cast<std::uint64_t>(d.open().has_value()));
  add(static_cast<std::uint64_t>(d.arm().has_value()));
  device_sample s;
  for (int i = 0; i < 500; ++i) {
    add(static_cast<std::uint64_t>(d.read(i * ms, s)));
    add(std::bit_cast<std::uint64_t>(s.T_dh.position.x));
    add(std::bit_cast<std::uint64_t>(s.T_dh.rotation.z));
    add(static_cast<std::uint64_t>(s.host_time_ns));
    const device_command c{
        {{-50.0 * s.T_dh.position.x, 0, 0}, vec3(0.0)}, wrench_frame::device_base, (i + 5) * ms, s.sequence};
    add(static_cast<std::uint64_t>(d.write(i * ms, c)));
    add(static_cast<std::uint64_t>(d.state()));
  }
  add(static_cast<std::uint64_t>(d.clear_fault().has_value()));
  add(static_cast<std::uint64_t>(d.disarm()));
  d.close();
  add(static_cast<std::uint64_t>(d.state()));
  return h;
}

TEST(any_device, answers_as_the_device_inside_to_the_bit) {
  simulated_device plain(wandering());
  any_device erased{simulated_device(wandering())};
  EXPECT_EQ(erased.capabilities().name, plain.capabilities().name);
  EXPECT_EQ(trace(erased), trace(plain));
}

TEST(any_device, moves_with_what_it_owns) {
  any_device first{simulated_device(wandering())};
  ASSERT_TRUE(first.open());
  any_device second = std::move(first);
  EXPECT_EQ(second.state(), device_state::ready);
  first = any_device{simulated_device(wandering())};
  EXPECT_EQ(first.state(), device_state::absent);
}

struct counts_its_life : simulated_device {
  int* alive;
  explicit counts_its_life(int* a) : alive(a) { ++*alive; }
  counts_its_life(counts_its_life&& o) noexcept : simulated_device(std::move(o)), alive(o.alive) { ++*alive; }
  ~counts_its_life() { --*alive; }
};

TEST(any_device, destroys_what_it_owns) {
  int alive = 0;
  {
    const any_device d{counts_its_life(&alive)};
    EXPECT_EQ(alive, 1);
  }
  EXPECT_EQ(alive, 0);
}

}  // namespace
