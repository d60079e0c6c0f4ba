// A driver that does not return is noticed in its time, one that does return is left alone.
#include "driver_guard.hpp"

#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <mutex>
#include <string>
#include <thread>

namespace {

using namespace asperity::command;
using namespace std::chrono_literals;

class report_counter {
 public:
  void operator()(const std::string& what) {
    const std::lock_guard lock(mutex_);
    what_ = what;
    ++times_;
  }
  [[nodiscard]] std::string what() const {
    const std::lock_guard lock(mutex_);
    return what_;
  }
  [[nodiscard]] bool comes_within(std::chrono::milliseconds longest) const {
    for (const auto begin = std::chrono::steady_clock::now(); std::chrono::steady_clock::now() - begin < longest;) {
      if (!what().empty()) return true;
      std::this_thread::sleep_for(2ms);
    }
    return false;
  }
  [[nodiscard]] int times() const {
    const std::lock_guard lock(mutex_);
    return times_;
  }

 private:
  mutable std::mutex mutex_;
  std::string what_;
  int times_ = 0;
};

constexpr driver_limits short_limits{.tick = 150ms, .arm = 400ms, .asked = 150ms, .ending = 300ms};

TEST(driver_guard, reports_once_a_call_that_does_not_return) {
  for (const driver_call which : {driver_call::read, driver_call::write, driver_call::disarm, driver_call::close}) {
    driver_watch watch;
    report_counter it;
    watch.set_armed(which == driver_call::write);
    const driver_guard guard(
        watch, [&](const std::string& what) { it(what); }, short_limits);
    const driver_watch::call stuck(watch, which);
    ASSERT_TRUE(it.comes_within(5s)) << to_string(which);
    EXPECT_NE(it.what().find(to_string(which)), std::string::npos) << it.what();
    EXPECT_EQ(it.what().find("NOT disarmed") != std::string::npos, which == driver_call::write) << it.what();
    std::this_thread::sleep_for(60ms);
    EXPECT_EQ(it.times(), 1);
  }
}

TEST(driver_guard, leaves_calls_alone_that_return) {
  driver_watch watch;
  report_counter it;
  const driver_guard guard(watch, [&](const std::string& what) { it(what); }, {.tick = 600ms, .ending = 300ms});
  // The same call again and again is another call each time, however long it goes on; and so is no call at all.
  for (int i = 0; i < 50; ++i) {
    const driver_watch::call one(watch, driver_call::read);
    std::this_thread::sleep_for(20ms);
  }
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(it.what(), "");
}

TEST(driver_guard, waits_for_a_homing_and_longer_for_arm) {
  driver_watch watch;
  report_counter it;
  const driver_guard guard(
      watch, [&](const std::string& what) { it(what); }, short_limits);
  {
    const driver_watch::call homing(watch, driver_call::open);
    EXPECT_FALSE(it.comes_within(500ms)) << it.what();
  }
  const driver_watch::call arming(watch, driver_call::arm);
  EXPECT_TRUE(it.comes_within(5s));
  EXPECT_NE(it.what().find("arm()"), std::string::npos) << it.what();
}

// No call takes long, and yet the end would not come.
TEST(driver_guard, limits_the_end_as_a_whole) {
  driver_watch watch;
  report_counter it;
  driver_guard guard(
      watch, [&](const std::string& what) { it(what); }, short_limits);
  std::atomic<bool> over{false};
  std::thread crawling([&] {
    while (!over) {
      const driver_watch::call one(watch, driver_call::write);
      std::this_thread::sleep_for(10ms);
    }
  });
  std::this_thread::sleep_for(350ms);
  EXPECT_EQ(it.what(), "");  // nobody asked for the end yet
  {
    const driver_guard::ending ending(&guard);
    EXPECT_TRUE(it.comes_within(5s));
  }
  over = true;
  crawling.join();
  EXPECT_NE(it.what().find("has not ended"), std::string::npos) << it.what();
}

}  // namespace
