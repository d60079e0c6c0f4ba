#include <array>
#include <string>

#include "checks.hpp"

namespace asperity::conformance {
namespace {

enum class call : std::uint8_t { open, arm, clear_fault, disarm, close, read, write_zero };
constexpr std::array<call, 7> every_call{call::open,  call::arm,  call::clear_fault, call::disarm,
                                         call::close, call::read, call::write_zero};

enum class answer : std::uint8_t { ok, refused, any };

// What device.hpp says of a call in a state: its answer, and the state after it.
struct expectation {
  answer wanted;
  device_state after;
};

const char* name_of(call c) noexcept {
  switch (c) {
    case call::open:
      return "open()";
    case call::arm:
      return "arm()";
    case call::clear_fault:
      return "clear_fault()";
    case call::disarm:
      return "disarm()";
    case call::close:
      return "close()";
    case call::read:
      return "read()";
    case call::write_zero:
      return "write() of zero";
  }
  return "?";
}

expectation expected(device_state s, call c) noexcept {
  const bool measures = asperity::measures(s);
  switch (c) {
    case call::open:
      return s == device_state::present || s == device_state::closed ? expectation{answer::ok, device_state::ready}
                                                                     : expectation{answer::refused, s};
    case call::arm:
      return s == device_state::ready ? expectation{answer::ok, device_state::armed} : expectation{answer::refused, s};
    case call::clear_fault:
      return s == device_state::fault ? expectation{answer::ok, device_state::closed} : expectation{answer::refused, s};
    case call::disarm:
      return measures ? expectation{answer::ok, device_state::ready} : expectation{answer::any, s};
    case call::close:
      return {answer::any, measures ? device_state::closed : s};
    case call::read:
      return {measures ? answer::ok : (s == device_state::fault ? answer::any : answer::refused), s};
    case call::write_zero:
      return {measures ? answer::ok : (s == device_state::fault ? answer::any : answer::refused),
              s == device_state::active ? device_state::armed : s};
  }
  return {answer::any, s};
}

std::int32_t make_call(subject& device, call c) {
  switch (c) {
    case call::open:
      return device.open();
    case call::arm:
      return device.arm();
    case call::clear_fault:
      return device.clear_fault();
    case call::disarm:
      return device.disarm();
    case call::close:
      device.close();
      return ASPERITY_OK;
    case call::read:
      device.clock().wait_ns(device.period_ns());
      return device.read();
    case call::write_zero:
      return device.write(wrench{});
  }
  return ASPERITY_FAILED;
}

void check_state(subject& device, ledger& found, device_state s, const char* check) {
  for (const call c : every_call) {
    found.begin(std::string(check) + ", " + name_of(c));
    if (!device.reach(s)) {
      if (s == device_state::fault) {
        found.skip(check, "the kit has no means to cause a fault: the driver has no provoke()");
      } else if (s == device_state::active && (!device.may_push || !(device.small_wrench().force != vec3(0.0) ||
                                                                     device.small_wrench().torque != vec3(0.0)))) {
        found.skip(check,
                   device.may_push ? "the device puts out nothing" : "a wrench is put out with --hand-held only");
      } else {
        found.look(check, false,
                   [&] { return std::string("the state is not reached; it is ") + to_string(device.state()); });
      }
      return;
    }
    const expectation e = expected(s, c);
    // A device that was made and has left since is absent, and behaves as if present.
    const device_state before = device.state();
    const device_state after = e.after == s ? before : e.after;
    const std::int32_t code = make_call(device, c);
    const bool answered = e.wanted == answer::any || (code == ASPERITY_OK) == (e.wanted == answer::ok);
    found.look(check, answered && device.state() == after, [&] {
      return std::string(name_of(c)) + " answered " + std::to_string(code) + " and led to " +
             to_string(device.state()) + "; expected " + (e.wanted == answer::ok ? "0" : "a refusal or anything") +
             " and " + to_string(after);
    });
    if (code != ASPERITY_OK && e.wanted == answer::refused &&
        (c == call::open || c == call::arm || c == call::clear_fault)) {
      found.look(check, !device.last_error().empty(),
                 [&] { return std::string(name_of(c)) + " was refused without a word"; });
    }
  }
  device.look_at_capabilities();
}

}  // namespace

void check_states(subject& device, ledger& found) {
  check_state(device, found, device_state::present, "states.present");
  check_state(device, found, device_state::ready, "states.ready");
  check_state(device, found, device_state::armed, "states.armed");
  check_state(device, found, device_state::active, "states.active");
  check_state(device, found, device_state::closed, "states.closed");
  check_state(device, found, device_state::fault, "states.fault");
}

}  // namespace asperity::conformance
