#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "checks.hpp"

namespace asperity::conformance {
namespace {

constexpr std::array<const char*, 7> every_command_check{
    "output.follows_command", "command.over_limit",  "command.nan",    "command.infinite",
    "command.wrong_frame",    "command.valid_until", "command.expired"};

std::string text_of(const wrench& w) {
  const auto vector = [](const vec3& v) {
    return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
  };
  return vector(w.force) + " N and " + vector(w.torque) + " N m";
}

void set(wrench& w, int component, double value) noexcept {
  (component < 3 ? w.force[component] : w.torque[component - 3]) = value;
}

// A wrench that is put out now, so that a refused command has something to end. @return false where it cannot be had
bool push(subject& device) {
  if (!device.reach(device_state::armed)) return false;
  static_cast<void>(device.tick(device.small_wrench()));
  return device.state() == device_state::active;
}

void check_followed(subject& device, ledger& found) {
  found.begin("a small command");
  if (!push(device)) return;
  for (int i = 0; i < 50; ++i) static_cast<void>(device.tick(device.small_wrench()));
  const wrench wanted = device.small_wrench();
  const std::optional<wrench> got = device.applied();
  if (!got) return;
  const double asked = glm::length(wanted.force) + glm::length(wanted.torque);
  const double off = glm::length(got->force - wanted.force) + glm::length(got->torque - wanted.torque);
  found.look("output.follows_command", off <= 0.1 * asked,
             [&] { return "asked for " + text_of(wanted) + " over 50 ticks and got " + text_of(*got); });
  static_cast<void>(device.disarm());
}

// No component of what leaves may point the other way than what was asked for.
bool turned_round(const vec3& asked, const vec3& got) noexcept {
  for (int i = 0; i < 3; ++i) {
    if (asked[i] * got[i] < 0.0 || (asked[i] == 0.0 && got[i] != 0.0)) return true;
  }
  return false;
}

void check_over_limit(subject& device, ledger& found) {
  found.begin("commands over the limits");
  const asperity_capabilities& c = device.capabilities();
  const std::array<double, 6> sizes{1.5, 10.0, 65.535, 1e6, 1e154, 1e300};
  for (const double size : sizes) {
    for (int component = 0; component < 7; ++component) {
      for (const double sign : {1.0, -1.0}) {
        wrench asked;
        for (int i = 0; i < 6; ++i) {
          if ((c.actuated >> i & 1U) == 0 || (component != 6 && component != i)) continue;
          set(asked, i, sign * size * (i < 3 ? c.peak_force_n : c.peak_torque_n_m));
        }
        if (is_zero(asked) || !device.reach(device_state::armed)) continue;
        static_cast<void>(device.tick(asked));
        if (const std::optional<wrench> got = device.applied()) {
          found.look("command.over_limit",
                     !turned_round(asked.force, got->force) && !turned_round(asked.torque, got->torque),
                     [&] { return "asked for " + text_of(asked) + " and got " + text_of(*got); });
        }
        static_cast<void>(device.tick({}));
      }
    }
  }
  if (device.state() == device_state::armed || device.state() == device_state::active) {
    static_cast<void>(device.disarm());
  }
}

void refused(subject& device, ledger& found, const char* check, const asperity_command& c, const std::string& what) {
  const std::int32_t code = device.write(c);
  if (const std::optional<wrench> got = device.applied()) {
    found.look(check, is_zero(*got), [&] { return what + " puts out " + text_of(*got); });
  }
  found.look(check, code != ASPERITY_OK, [&] { return what + " is answered with ASPERITY_OK"; });
}

void check_refused(subject& device, ledger& found) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), inf, -inf}) {
    const char* check = std::isnan(bad) ? "command.nan" : "command.infinite";
    found.begin(check);
    for (int i = 0; i < 6; ++i) {
      if (!push(device)) return;
      wrench w = device.small_wrench();
      set(w, i, bad);
      refused(device, found, check, device.command(w), std::to_string(bad) + " in component " + std::to_string(i));
    }
  }
  found.begin("command.wrong_frame");
  for (const std::uint32_t frame : {0U, 2U, 3U, 0xffffffffU}) {
    if (!push(device)) return;
    asperity_command c = device.command(device.small_wrench());
    c.frame = frame;
    refused(device, found, "command.wrong_frame", c, "frame " + std::to_string(frame));
  }
}

void check_times(subject& device, ledger& found) {
  found.begin("command.expired");
  for (const std::int64_t late_ns : {std::int64_t{1}, std::int64_t{1'000'000'000}}) {
    if (!push(device)) return;
    asperity_command c = device.command(device.small_wrench());
    c.valid_until_ns = device.clock().now_ns() - late_ns;
    static_cast<void>(device.write(c));
    if (const std::optional<wrench> got = device.applied()) {
      found.look("command.expired", is_zero(*got), [&] {
        return "a command that expired " + std::to_string(late_ns) + " ns ago puts out " + text_of(*got);
      });
    }
  }
  found.begin("command.valid_until");
  if ((device.capabilities().flags & ASPERITY_DEVICE_SIDE_WATCHDOG) == 0) {
    found.skip("command.valid_until", "the driver states no watchdog on the device's side");
    return;
  }
  if (!push(device)) return;
  asperity_command c = device.command(device.small_wrench());
  c.valid_until_ns = device.clock().now_ns() + 3 * device.period_ns();
  static_cast<void>(device.write(c));
  for (int i = 0; i < 4; ++i) device.clock().wait_ns(device.period_ns());
  for (int i = 0; i < 20; ++i) {
    if (const std::optional<wrench> got = device.applied()) {
      found.look("command.valid_until", is_zero(*got), [&] {
        return text_of(*got) + " are put out " + std::to_string(i + 1) + " periods after valid_until_ns";
      });
    }
    device.clock().wait_ns(device.period_ns());
    static_cast<void>(device.read());
  }
}

}  // namespace

void check_commands(subject& device, ledger& found) {
  const char* why = nullptr;
  if (!device.may_push) {
    why = "a wrench is put out with --hand-held only";
  } else if (is_zero(device.small_wrench())) {
    why = "the device puts out nothing";
  } else if (!device.reports_applied()) {
    why = "the driver has no applied(), so that nobody sees what it puts out";
  }
  if (why != nullptr) {
    for (const char* check : every_command_check) found.skip(check, why);
    return;
  }
  check_followed(device, found);
  check_over_limit(device, found);
  check_refused(device, found);
  check_times(device, found);
  device.look_at_capabilities();
}

}  // namespace asperity::conformance
