#include "ledger.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace asperity::conformance {
namespace {

// Names are part of what a vendor publishes: add to them, do not rename them.
constexpr std::pair<const char*, const char*> every_check[] = {
    {"table.loads", "the file can be loaded"},
    {"table.entry", "it exports asperity_driver_entry, which answers with a table"},
    {"table.version", "it was made for this major version of the interface"},
    {"table.size", "struct_size of the table covers its mandatory part"},
    {"table.mandatory", "no mandatory function is missing"},
    {"table.texts", "name, version, licence and vendor are said"},
    {"process.survives", "no call ends the process or stays away for a minute"},
    {"border.nothing_thrown", "no exception comes across the interface"},
    {"border.sizes_respected", "nothing is written beyond the struct_size that the host gave"},
    {"list.answers", "list() answers, and finds the device"},
    {"list.texts", "identity, path and name are texts with an end"},
    {"capabilities.sound", "every number is finite and not negative, continuous is not above peak"},
    {"capabilities.constant", "capabilities do not change after open()"},
    {"units.workspace", "the workspace is between 1 mm and 10 m wide along every sensed axis"},
    {"units.efforts", "an actuated axis has limits above zero, below 1000 N and 100 N m, and a slew rate"},
    {"units.rates", "nominal rate between 10 Hz and 100 kHz, minimum rate not above it"},
    {"units.positions", "the handle is where the workspace says it can be"},
    {"states.known", "state() is one of the eight states"},
    {"states.present", "every call does what it should before open()"},
    {"states.ready", "every call does what it should in ready"},
    {"states.armed", "every call does what it should in armed"},
    {"states.active", "every call does what it should in active"},
    {"states.closed", "every call does what it should in closed"},
    {"states.fault", "every call does what it should in fault"},
    {"arming.only_by_arm", "nothing but arm() in ready allows output"},
    {"output.follows_command", "a command well inside the limits is put out"},
    {"output.within_limits", "no output is above the peak limits"},
    {"output.zero_unless_armed", "output is zero in every state but armed and active"},
    {"output.zero_after_disarm", "output is zero when disarm() returns"},
    {"output.zero_after_close", "output is zero when close() returns"},
    {"command.over_limit", "a command over the limits is shortened, never turned round"},
    {"command.nan", "a command with a NaN is refused, output zero"},
    {"command.infinite", "a command with an infinity is refused, output zero"},
    {"command.wrong_frame", "a command in another frame is refused, output zero"},
    {"command.expired", "a command past its valid_until_ns gives zero"},
    {"command.valid_until", "output ends at valid_until_ns when the host falls silent"},
    {"samples.finite", "every number of a sample is finite"},
    {"samples.unit_quaternion", "the rotation has unit length"},
    {"samples.validity", "a sample is valid in what the device senses"},
    {"samples.host_time", "host times are not in the future and never go back"},
    {"samples.device_time", "device times never go back"},
    {"samples.sequence", "sequence numbers never go back"},
    {"samples.same_sequence_same_sample", "the same sequence number means the same sample"},
    {"samples.new_is_new", "a new sequence number means a later measurement"},
    {"samples.untouched_on_failure", "a read() that fails leaves the sample as it was"},
    {"timing.rate", "measurements come at the minimum rate or faster"},
    {"timing.age", "no sample is older than the worst latency and two periods of the minimum rate"},
    {"timing.calls_fit_the_period", "half of all pairs of read() and write() take less than half a period"},
    {"rt.no_allocation", "read, write, disarm, state and applied take and give back no memory"},
    {"rt.no_lock", "they take no lock"},
    {"rt.no_wait", "they do not sleep or wait"},
    {"rt.no_clock", "they read no clock"},
    {"rt.no_print", "they print nothing"},
    {"rt.no_throw", "they throw nothing, also not inside"},
    {"fault.write_failure", "a write that fails says so, output zero"},
    {"fault.latched", "a fault stays until clear_fault()"},
    {"departure.armed_is_fault", "a device that leaves while it is armed is in fault, output zero"},
    {"departure.ready_is_absent", "a device that leaves while it is ready is absent"},
    {"departure.return_not_armed", "a device that returns is not armed"},
    {"reopen.ready", "a closed device opens again: ready, output zero"},
    {"reopen.after_destroy", "a device that was destroyed while active opens again: ready, output zero"},
};

}  // namespace

ledger::ledger() {
  for (const auto& [name, asks] : every_check) checks_.push_back({.name = name, .asks = asks, .reason = {}});
}

check_result& ledger::find(std::string_view check) {
  const auto it = std::find_if(checks_.begin(), checks_.end(), [&](const check_result& c) { return c.name == check; });
  if (it == checks_.end()) {
    std::fprintf(stderr, "asperity-conformance: there is no check %s\n", std::string(check).c_str());
    std::abort();
  }
  return *it;
}

void ledger::skip(std::string_view check, std::string_view why) {
  check_result& c = find(check);
  if (c.reason.empty()) c.reason = why;
}

void ledger::skip_rest(std::string_view why) {
  for (check_result& c : checks_) {
    if (c.result == outcome::not_applicable && c.reason.empty()) c.reason = why;
    if (c.result == outcome::passed) c.reason.clear();
  }
}

void ledger::measured(std::string name, double value, std::string unit) {
  figures_.push_back({std::move(name), value, std::move(unit)});
}

bool ledger::failed() const noexcept {
  return std::any_of(checks_.begin(), checks_.end(), [](const check_result& c) { return c.result == outcome::failed; });
}

}  // namespace asperity::conformance
