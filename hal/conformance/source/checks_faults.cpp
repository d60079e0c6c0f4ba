#include <string>

#include "checks.hpp"

namespace asperity::conformance {
namespace {

constexpr int ticks_to_notice = 10;

std::string is(const subject& device) { return std::string("the device is ") + to_string(device.state()); }

bool rests(subject& device) {
  const std::optional<wrench> w = device.applied();
  return !w || is_zero(*w);
}

// As far up as may be: active where a wrench may be put out, armed otherwise.
bool at_work(subject& device) {
  if (device.may_push && device.reach(device_state::active)) return true;
  return device.reach(device_state::armed);
}

void check_latched(subject& device, ledger& found) {
  found.begin("a latched fault");
  if (!device.reach(device_state::fault)) {
    found.skip("fault.latched", "the kit has no means to cause a fault: the driver has no provoke()");
    return;
  }
  for (int i = 0; i < 20; ++i) static_cast<void>(device.tick(device.may_push ? device.small_wrench() : wrench{}));
  static_cast<void>(device.disarm());
  device.close();
  static_cast<void>(device.open());
  found.look("fault.latched", device.state() == device_state::fault,
             [&] { return is(device) + " after writes, disarm(), close() and open() in fault"; });
}

void check_write_failure(subject& device, ledger& found) {
  found.begin("a write that fails");
  if (!at_work(device) || device.provoke(ASPERITY_PROVOKE_WRITE_FAILURE) != ASPERITY_OK) {
    found.skip("fault.write_failure", "the driver cannot be made to fail a write");
    return;
  }
  const std::int32_t code = device.tick(device.may_push ? device.small_wrench() : wrench{});
  found.look("fault.write_failure", code != ASPERITY_OK, [] { return "the write is answered with ASPERITY_OK"; });
  found.look("fault.write_failure", rests(device), [] { return "something is put out after it"; });
}

void check_departures(subject& device, ledger& found) {
  found.begin("a departure while armed");
  if (!at_work(device) || device.provoke(ASPERITY_PROVOKE_DEPARTURE) != ASPERITY_OK) {
    for (const char* check : {"departure.armed_is_fault", "departure.ready_is_absent", "departure.return_not_armed"}) {
      found.skip(check, "the driver cannot be made to lose its device");
    }
    return;
  }
  const wrench w = device.may_push ? device.small_wrench() : wrench{};
  for (int i = 0; i < ticks_to_notice && device.state() != device_state::fault; ++i) static_cast<void>(device.tick(w));
  found.look("departure.armed_is_fault", device.state() == device_state::fault,
             [&] { return is(device) + " ten ticks after it left"; });
  found.look("departure.armed_is_fault", rests(device), [] { return "something is put out after it left"; });

  found.begin("a return");
  static_cast<void>(device.provoke(ASPERITY_PROVOKE_RETURN));
  for (int i = 0; i < ticks_to_notice; ++i) {
    static_cast<void>(device.tick(w));
    found.look("departure.return_not_armed", !may_put_out(device.state()) && rests(device), [&] {
      return is(device) +
             (rests(device) ? " after it returned, and nobody armed it" : " and puts something out after it returned");
    });
  }

  found.begin("a departure while ready");
  if (!device.reach(device_state::ready) || device.provoke(ASPERITY_PROVOKE_DEPARTURE) != ASPERITY_OK) return;
  for (int i = 0; i < ticks_to_notice && device.state() != device_state::absent; ++i)
    static_cast<void>(device.tick({}));
  found.look("departure.ready_is_absent", device.state() == device_state::absent,
             [&] { return is(device) + " ten ticks after it left"; });
  static_cast<void>(device.provoke(ASPERITY_PROVOKE_RETURN));
  found.look("departure.return_not_armed", !may_put_out(device.state()),
             [&] { return is(device) + " after it returned"; });
}

void check_reopening(subject& device, ledger& found) {
  found.begin("closing and opening again");
  if (at_work(device)) {
    device.close();
    static_cast<void>(device.open());
    static_cast<void>(device.tick({}));
    found.look("reopen.ready", device.state() == device_state::ready && rests(device), [&] {
      return is(device) + " after close() and open()" + (rests(device) ? "" : ", and puts something out");
    });
  }
  found.begin("destroying and making again");
  if (at_work(device)) {
    static_cast<void>(device.make_anew());
    static_cast<void>(device.open());
    static_cast<void>(device.tick({}));
    found.look("reopen.after_destroy", device.state() == device_state::ready && rests(device), [&] {
      return is(device) + " after destroy(), make() and open()" + (rests(device) ? "" : ", and puts something out");
    });
  }
}

}  // namespace

void check_faults(subject& device, ledger& found) {
  check_latched(device, found);
  check_write_failure(device, found);
  check_departures(device, found);
  check_reopening(device, found);
  device.look_at_capabilities();
}

}  // namespace asperity::conformance
