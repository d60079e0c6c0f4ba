// The kit passes our own drivers, and fails each broken one for what is broken in it and nothing else.
#include <array>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <sys/wait.h>

#include "contract/plugin/module_files.hpp"

namespace asperity {
namespace {

using json = nlohmann::json;
using names = std::set<std::string>;
using test_support::broken_way;

struct outcome {
  int exit_status = -1;
  std::string out;
};

outcome examine(const std::filesystem::path& driver, const std::string& options) {
  const std::string line = std::string("'") + ASPERITY_CONFORMANCE + "' '" + driver.string() + "' " + options +
                           " --ticks 300 --patience 1 2>/dev/null";
  outcome o;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(line.c_str(), "r"), [](FILE*) { return 0; });
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe.get())) o.out.append(buffer.data(), n);
  const int end = ::pclose(pipe.get());
  o.exit_status = WIFEXITED(end) ? WEXITSTATUS(end) : -1;
  return o;
}

names with_result(const json& document, const char* result) {
  names out;
  for (const json& check : document.at("checks")) {
    if (check.at("result") == result) out.insert(check.at("name"));
  }
  return out;
}

json document_of(const outcome& o) {
  json d = json::parse(o.out, nullptr, false);
  EXPECT_FALSE(d.is_discarded()) << o.out;
  EXPECT_EQ(d.value("schema", ""), "asperity.conformance/1");
  EXPECT_EQ(o.exit_status, d.at("conforms") == true ? 0 : 1);
  return d;
}

// Under a sanitizer nobody sees what a call in a tick does.
bool calls_are_watched(const json& report) { return with_result(report, "not_applicable").count("rt.no_lock") == 0; }

TEST(conformance, our_own_drivers_conform) {
  {
    const json d = document_of(examine(test_support::sample_driver, "--json --date 2026-11-21"));
    EXPECT_EQ(with_result(d, "fail"), names{});
    if (calls_are_watched(d)) {
      EXPECT_EQ(with_result(d, "not_applicable"), names{});
    }
    EXPECT_EQ(d.at("driver").at("name"), "spring_handle");
    EXPECT_EQ(d.at("date"), "2026-11-21");
    EXPECT_EQ(d.at("clock"), "virtual");
    EXPECT_EQ(d.at("figures").at(1).at("name"), "new_samples_per_s");
    EXPECT_NEAR(d.at("figures").at(1).at("value").get<double>(), 1000.0, 5.0);
  }
  const json d = document_of(examine(test_support::simulated_driver, "--json"));
  EXPECT_EQ(with_result(d, "fail"), names{});
  if (calls_are_watched(d)) {
    EXPECT_EQ(with_result(d, "not_applicable"), names{"fault.write_failure"});
  }
}

struct broken_case {
  const char* way;
  names fails;
};

TEST(conformance, every_broken_driver_fails_for_what_is_broken) {
  const broken_case cases[] = {
      {"nothing", {}},
      {"older", {}},
      {"newer", {}},
      {"no_table", {"table.entry"}},
      {"wrong_abi_major", {"table.version"}},
      {"wrong_struct_size", {"table.size"}},
      {"no_disarm", {"table.mandatory"}},
      {"no_name", {"table.texts"}},
      {"crashes", {"process.survives"}},
      {"exits", {"process.survives"}},
      {"hangs_in_open", {"process.survives"}},
      {"throws_in_open", {"states.present"}},
      {"throws_in_read",
       {"border.nothing_thrown", "states.ready", "states.armed", "states.active", "timing.rate", "rt.no_throw"}},
      {"writes_beyond", {"border.sizes_respected"}},
      {"fails_to_list", {"list.answers"}},
      {"nothing_plugged_in", {"list.answers"}},
      {"list_without_end", {"list.texts"}},
      {"negative_limit", {"capabilities.sound"}},
      {"moves_limits", {"capabilities.constant", "output.within_limits"}},
      {"workspace_in_mm", {"units.workspace"}},
      {"no_slew", {"units.efforts"}},
      {"nominal_below_minimum", {"units.rates", "timing.rate"}},
      {"millimetres", {"units.positions"}},
      {"unknown_state", {"states.known", "states.present"}},
      {"arms_when_armed", {"states.armed", "states.active"}},
      {"open_arms", {"states.present", "arming.only_by_arm"}},
      {"rearms_after_clear_fault", {"states.fault", "arming.only_by_arm"}},
      {"returns_armed", {"arming.only_by_arm", "departure.return_not_armed", "reopen.ready"}},
      {"weak", {"output.follows_command"}},
      {"limits_below_saturation", {"output.within_limits"}},
      {"pushes_in_ready",
       {"output.zero_unless_armed", "output.zero_after_disarm", "reopen.ready", "reopen.after_destroy"}},
      {"keeps_output_after_disarm", {"output.zero_unless_armed", "output.zero_after_disarm", "reopen.ready"}},
      {"keeps_output_after_close", {"output.zero_unless_armed", "output.zero_after_close"}},
      {"wraps_round", {"output.within_limits", "command.over_limit", "command.expired", "command.valid_until"}},
      {"takes_nan", {"command.nan", "command.infinite"}},
      {"takes_any_frame", {"command.wrong_frame"}},
      {"ignores_valid_until", {"command.expired", "command.valid_until"}},
      {"hides_write_failure",
       {"states.present", "states.closed", "command.nan", "command.infinite", "command.wrong_frame",
        "fault.write_failure"}},
      {"nan", {"samples.finite"}},
      {"long_quaternion", {"samples.unit_quaternion"}},
      {"claims_rotation", {"samples.validity"}},
      {"from_the_future", {"samples.host_time"}},
      {"times_go_back", {"samples.host_time"}},
      {"device_time_goes_back", {"samples.device_time", "samples.new_is_new"}},
      {"repeats_sequence", {"samples.same_sequence_same_sample"}},
      {"stale_as_new", {"samples.new_is_new"}},
      {"spoils_sample", {"samples.untouched_on_failure"}},
      {"stops_measuring", {"timing.rate", "timing.age"}},
      {"slow_write", {"timing.calls_fit_the_period"}},
      {"allocates_in_read", {"rt.no_allocation"}},
      {"locks", {"rt.no_lock"}},
      {"sleeps_in_write", {"rt.no_wait"}},
      {"reads_clock", {"rt.no_clock"}},
      {"prints", {"rt.no_print"}},
      {"throws_inside_read", {"rt.no_throw"}},
  };
  bool watched = true;
  for (const broken_case& each : cases) {
    SCOPED_TRACE(each.way);
    const broken_way chosen(each.way);
    const json d = document_of(examine(test_support::broken_driver, "--json"));
    if (std::string(each.way) == "nothing") watched = calls_are_watched(d);
    names expected = each.fails;
    if (!watched) std::erase_if(expected, [](const std::string& name) { return name.starts_with("rt."); });
    EXPECT_EQ(with_result(d, "fail"), expected);
    for (const json& check : d.at("checks")) {
      if (check.at("result") != "pass") {
        EXPECT_NE(check.value("reason", ""), "") << check;
      }
      if (check.at("result") == "pass") {
        EXPECT_GT(check.at("looks"), 0U) << check;
      }
    }
  }
}

TEST(conformance, a_driver_that_does_not_say_what_it_puts_out_is_not_praised_for_it) {
  const broken_way chosen("nothing_optional");
  const json d = document_of(examine(test_support::broken_driver, "--json"));
  EXPECT_EQ(with_result(d, "fail"), names{});
  const names unseen = with_result(d, "not_applicable");
  for (const char* check : {"output.within_limits", "output.zero_unless_armed", "output.zero_after_disarm",
                            "command.over_limit", "command.valid_until", "departure.armed_is_fault"}) {
    EXPECT_EQ(unseen.count(check), 1U) << check;
  }
}

TEST(conformance, hardware_that_nobody_holds_is_never_pushed) {
  {
    const broken_way chosen("real");  // a command other than zero would end the process
    const json d = document_of(examine(test_support::broken_driver, "--json"));
    EXPECT_EQ(with_result(d, "fail"), names{});
    EXPECT_EQ(d.at("clock"), "real");
    const names not_tried = with_result(d, "not_applicable");
    for (const char* check : {"states.active", "command.nan", "command.over_limit", "output.follows_command"}) {
      EXPECT_EQ(not_tried.count(check), 1U) << check;
    }
    const json held = document_of(examine(test_support::broken_driver, "--json --hand-held"));
    EXPECT_EQ(with_result(held, "fail"), names{"process.survives"});
  }
  const broken_way chosen("real_and_held");
  const json d = document_of(examine(test_support::broken_driver, "--json --hand-held"));
  EXPECT_EQ(with_result(d, "not_applicable").count("command.nan"), 0U);
  EXPECT_EQ(with_result(d, "pass").count("states.active"), 1U);
  EXPECT_EQ(with_result(d, "fail").count("command.nan"), 0U);
}

TEST(conformance, text_and_usage) {
  const outcome text = examine(test_support::sample_driver, "");
  EXPECT_EQ(text.exit_status, 0);
  EXPECT_NE(text.out.find("pass            arming.only_by_arm"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find(" 0 failed, "), std::string::npos);

  const json d = document_of(examine(test_support::sample_driver, "--json --device nobody"));
  EXPECT_EQ(with_result(d, "fail"), names{"list.answers"});
  EXPECT_EQ(examine(test_support::sample_driver, "--no-such-option").exit_status, 2);
  EXPECT_EQ(with_result(document_of(examine("/nowhere.so", "--json")), "fail"), names{"table.loads"});
}

}  // namespace
}  // namespace asperity
