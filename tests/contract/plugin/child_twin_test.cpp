// A driver in a process of its own beside the same one in this process: the same bits, and what it costs.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "asperity/device/driver_conversion.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/plugin/plugin_driver.hpp"
#include "child_rig.hpp"

namespace asperity::plugin {
namespace {

using namespace child_tests;
using namespace std::chrono_literals;

bool same_bits(const device_sample& a, const device_sample& b) {
  const asperity_sample bits_a = abi::to_abi(a);
  const asperity_sample bits_b = abi::to_abi(b);
  return std::memcmp(&bits_a, &bits_b, sizeof bits_a) == 0;
}

TEST(child, a_simulated_driver_has_the_same_bits_in_a_process_of_its_own) {
  result<std::unique_ptr<child_driver>> far = load(test_support::simulated_driver);
  ASSERT_TRUE(far) << far.error().message;
  result<std::unique_ptr<plugin_driver>> near =
      plugin_driver::load(test_support::simulated_driver, {}, file_trust::as_named);
  ASSERT_TRUE(near);
  EXPECT_EQ((*far)->name(), (*near)->name());
  EXPECT_EQ((*far)->maturity(), (*near)->maturity());
  const result<std::vector<device_listing>> listed_far = (*far)->list();
  const result<std::vector<device_listing>> listed_near = (*near)->list();
  ASSERT_TRUE(listed_far && listed_near);
  ASSERT_EQ(listed_far->size(), 1U);
  EXPECT_EQ(listed_far->at(0).identity, listed_near->at(0).identity);
  EXPECT_EQ(listed_far->at(0).capabilities.name, listed_near->at(0).capabilities.name);
  EXPECT_EQ(listed_far->at(0).capabilities.peak_force_n, listed_near->at(0).capabilities.peak_force_n);

  result<plugin_device> a = (*far)->make_plugin(listed_far->at(0));
  result<plugin_device> b = (*near)->make_plugin(listed_near->at(0));
  ASSERT_TRUE(a && b);
  EXPECT_FALSE(a->arm());
  ASSERT_TRUE(a->open() && b->open());
  ASSERT_TRUE(a->arm() && b->arm());
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::int64_t now_ns = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    now_ns += tick_ns + static_cast<std::int64_t>(random() % 1000);
    device_sample from_far;
    device_sample from_near;
    ASSERT_EQ(a->read(now_ns, from_far), b->read(now_ns, from_near));
    ASSERT_TRUE(same_bits(from_far, from_near)) << tick;
    // Zero, small, at the limit, far beyond it, and expired.
    const double strength[] = {0.0, 1e-3, 1.0, 20.0, 1e6};
    device_command c = push(now_ns, strength[tick / 100 % 5] * vec3(unit(random), unit(random), unit(random)));
    if (tick % 97 == 0) c.valid_until_ns = now_ns - 1;
    ASSERT_EQ(a->write(now_ns, c), b->write(now_ns, c)) << tick;
    ASSERT_EQ(a->state(), b->state()) << tick;
    if (tick % 1000 == 999) {
      ASSERT_EQ(a->disarm(), b->disarm());
      ASSERT_EQ(a->state(), device_state::ready);
      ASSERT_TRUE(a->arm() && b->arm());
    }
  }
  const device_command nan = push(now_ns, {std::nan(""), 0.0, 0.0});
  EXPECT_EQ(a->write(now_ns, nan), b->write(now_ns, nan));
  EXPECT_EQ(a->state(), device_state::fault);
  EXPECT_EQ(a->fault_text(), b->fault_text());
  a->close();
  EXPECT_EQ((*far)->what_happened(), "");
}

// Information, for docs/explanation/plugin-threats.md: one tick's read() and write(), in process and beside it, in
// turns.
TEST(child, DISABLED_cost_of_a_tick) {
  result<std::unique_ptr<child_driver>> far =
      load(test_support::simulated_driver, options_for("nothing", child_pace::paced));
  result<std::unique_ptr<plugin_driver>> near =
      plugin_driver::load(test_support::simulated_driver, {}, file_trust::as_named);
  ASSERT_TRUE(far && near);
  const device_listing which = (*near)->list()->at(0);
  result<plugin_device> devices[] = {(*near)->make_plugin(which), (*far)->make_plugin(which)};
  std::vector<double> times_us[2];
  int fresh[2] = {0, 0};
  std::uint64_t newest[2] = {0, 0};
  for (auto& d : devices) ASSERT_TRUE(d && d->open() && d->arm());
  constexpr int ticks = 10'000;
  for (int tick = 0; tick < ticks; ++tick) {
    for (std::size_t i = 0; i < 2; ++i) {
      const std::int64_t begin_ns = clock_ns();
      device_sample in;
      if (devices[i]->read(begin_ns, in) == status::ok && in.sequence != newest[i]) ++fresh[i];
      newest[i] = in.sequence;
      static_cast<void>(devices[i]->write(begin_ns, push(begin_ns, {0.5, 0.0, 0.0})));
      times_us[i].push_back(1e-3 * static_cast<double>(clock_ns() - begin_ns));
    }
    std::this_thread::sleep_for(1ms);
  }
  const auto at = [&](std::size_t i, double part) {
    std::sort(times_us[i].begin(), times_us[i].end());
    return times_us[i][static_cast<std::size_t>(part * (ticks - 1))];
  };
  for (const double part : {0.5, 0.99, 1.0}) {
    std::printf("p%g: in process %.2f us, beside it %.2f us, ratio %.1f\n", 100.0 * part, at(0, part), at(1, part),
                at(1, part) / at(0, part));
  }
  std::printf("new samples: in process %d, beside it %d of %d\n", fresh[0], fresh[1], ticks);
}

}  // namespace
}  // namespace asperity::plugin
