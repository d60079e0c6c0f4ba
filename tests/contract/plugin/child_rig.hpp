// What the tests of drivers in a process of their own share: the broken driver behind one, and times.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/plugin/child_driver.hpp"
#include "module_files.hpp"

namespace asperity::plugin::child_tests {

using test_support::broken_way;

inline constexpr std::int64_t tick_ns = 1'000'000;

inline std::int64_t clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
inline double seconds_since(std::int64_t begin_ns) { return 1e-9 * static_cast<double>(clock_ns() - begin_ns); }

/// Patient on a busy machine, but with what is known to hang.
inline child_settings options_for(const std::string& way, child_pace pace = child_pace::lockstep) {
  const bool hangs = way.starts_with("hangs") || way.starts_with("prints");
  child_settings o;
  o.pace = pace;
  o.list_patience_ns = 10'000'000'000;
  o.call_patience_ns = o.open_patience_ns = hangs ? 200'000'000 : 10'000'000'000;
  o.silence_ns = 300'000'000;
  o.host_program = ASPERITY_DRIVER_HOST;
  return o;
}

inline result<std::unique_ptr<child_driver>> load(const std::filesystem::path& file,
                                                  child_settings o = options_for("nothing")) {
  return child_driver::load(file, std::move(o), file_trust::as_named);
}

/// A device of the broken driver, made, opened and armed, and the driver that it came from.
struct broken_device {
  std::unique_ptr<child_driver> driver{};
  std::optional<plugin_device> device{};

  broken_device(const std::string& way, child_settings o, bool armed = true) {
    const broken_way chosen(way);
    result<std::unique_ptr<child_driver>> loaded = load(test_support::broken_driver, std::move(o));
    EXPECT_TRUE(loaded) << loaded.error().message;
    if (!loaded) return;
    driver = std::move(loaded).value();
    const result<std::vector<device_listing>> listed = driver->list();
    EXPECT_TRUE(listed && listed->size() == 1);
    if (!listed) return;
    result<plugin_device> made = driver->make_plugin(listed->at(0));
    EXPECT_TRUE(made) << made.error().message;
    if (!made) return;
    device.emplace(std::move(made).value());
    if (!armed) return;
    const result<void> opened = device->open();
    EXPECT_TRUE(opened) << opened.error().message;
    const result<void> up = device->arm();
    EXPECT_TRUE(up) << up.error().message;
  }
};

inline device_command push(std::int64_t now_ns, const vec3& force) {
  return {.on_hand = {force, vec3(0.0)},
          .frame = wrench_frame::device_base,
          .valid_until_ns = now_ns + 20 * tick_ns,
          .sequence = 1};
}

inline bool wait_until(std::chrono::milliseconds longest, const std::function<bool()>& done) {
  const auto until = std::chrono::steady_clock::now() + longest;
  while (!done()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace asperity::plugin::child_tests
