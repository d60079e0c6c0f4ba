// Devices as the command finds them: the sample driver in the driver path, drivers that cannot be loaded, names that
// fit nothing.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>

#include "command_process.hpp"

namespace fault {
namespace {

using devices_command = command_test;

const std::string& pin() {
  static const std::string file = (small_models() / "pin.glb").string();
  return file;
}

process_options with_path(const std::string& folder) {
  process_options options;
  options.environment = {{"ASPERITY_DRIVER_PATH", folder}};
  return options;
}
process_options with_broken(const std::string& way) {
  process_options options = with_path(std::string(ASPERITY_BROKEN_DRIVER_DIR) + ":" + ASPERITY_SAMPLE_DRIVER_DIR);
  options.environment.emplace_back("ASPERITY_BROKEN", way);
  return options;
}

json devices(const process_options& options, arguments more = {}) {
  arguments args{"devices", "--json"};
  args.insert(args.end(), more.begin(), more.end());
  const outcome o = run(args, options);
  EXPECT_EQ(o.exit_status, 0) << o.err;
  return json::parse(o.out);
}

json with_name(const json& list, const char* key, const std::string& name) {
  const auto it = std::find_if(list.begin(), list.end(), [&](const json& each) { return each[key] == name; });
  EXPECT_NE(it, list.end()) << list.dump(1);
  return it == list.end() ? json() : *it;
}

// Folders above the build that others may write to make every driver in it one that is refused.
#define NEEDS_TRUSTED_DRIVERS()                                                                               \
  if (const json f =                                                                                          \
          with_name(devices(with_path(ASPERITY_SAMPLE_DRIVER_DIR))["driver_files"], "name", "spring_handle"); \
      !f["problem"].is_null())                                                                                \
  GTEST_SKIP() << "the build folder is not this user's alone: " << f["problem"]

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

TEST_F(devices_command, lists_what_an_enabled_driver_in_the_path_finds) {
  NEEDS_TRUSTED_DRIVERS();
  for (const char* how : {"--enable", "--in-process"}) {
    SCOPED_TRACE(how);
    const json d = devices(with_path(ASPERITY_SAMPLE_DRIVER_DIR), {how, "spring_handle"});
    EXPECT_NE(std::find(d["drivers"].begin(), d["drivers"].end(), "spring_handle"), d["drivers"].end()) << d["drivers"];
    const json found = with_name(d["devices"], "driver", "spring_handle");
    EXPECT_EQ(found["maturity"], "simulated");
    EXPECT_TRUE(found["problem"].is_null());
    EXPECT_GT(found["peak_force"], 0.0);
  }
}

TEST_F(devices_command, runs_no_driver_that_nobody_asked_for) {
  NEEDS_TRUSTED_DRIVERS();
  process_options options = with_broken("tells");
  options.environment.emplace_back("ASPERITY_BROKEN_LOG", path("log"));
  const json d = devices(options);
  const json file = with_name(d["driver_files"], "name", "broken_driver");
  EXPECT_EQ(file["enabled"], false);
  EXPECT_TRUE(file["problem"].is_null());
  EXPECT_FALSE(std::filesystem::exists(path("log"))) << "its code ran";
  const outcome text = run({"devices"}, options);
  EXPECT_NE(text.out.find("asperity devices --enable broken_driver"), std::string::npos) << text.out;

  devices(options, {"--enable", "broken_driver"});
  EXPECT_TRUE(std::filesystem::exists(path("log"))) << "and this is how it would have been seen";
  EXPECT_EQ(expect_failure({"devices", "--enable", "warp"}, 1, "invalid_argument", options)
                .find("there is no driver 'warp' to enable; in the driver path there are: "),
            0U);
}

TEST_F(devices_command, lists_the_others_where_a_driver_breaks_or_hangs) {
  NEEDS_TRUSTED_DRIVERS();
  for (const char* way : {"crashes_when_loaded", "garbage_table", "crashes_in_list", "hangs_in_list"}) {
    SCOPED_TRACE(way);
    json d;
    // 2 s are stated for each driver; the rest is for a busy machine.
    EXPECT_LT(seconds_of([&] {
                d = devices(with_broken(way), {"--enable", "broken_driver", "--enable", "spring_handle"});
              }),
              8.0);
    with_name(d["devices"], "driver", "spring_handle");
    ASSERT_EQ(d["problems"].size(), 1U) << d["problems"];
    EXPECT_NE(d["problems"][0]["problem"].get<std::string>().find("broken_driver.so: the driver"), std::string::npos)
        << d["problems"];
  }
}

TEST_F(devices_command, says_which_driver_cannot_be_loaded_and_lists_the_rest) {
  std::ofstream(path("broken.so")) << "not a shared object";
  const json d = devices(with_path(path(".")));
  ASSERT_EQ(d["problems"].size(), 1U) << d["problems"];
  EXPECT_NE(d["problems"][0]["where"].get<std::string>().find("broken.so"), std::string::npos);
  EXPECT_NE(d["problems"][0]["problem"].get<std::string>().find("can be written by everybody"), std::string::npos)
      << "a folder below the one for temporary files: " << d["problems"];
  EXPECT_EQ(d["devices"][0]["name"], "simulated");
}

TEST_F(devices_command, runs_a_session_with_a_device_behind_the_c_interface) {
  NEEDS_TRUSTED_DRIVERS();
  const auto session = [&](const char* how, const std::string& recording) {
    return run({"run", "--probe", pin(), "--fixed", pin(), "--device", "spring_handle", how, "spring_handle",
                "--seconds", "0.3", "--record", recording, "--json"},
               with_path(ASPERITY_SAMPLE_DRIVER_DIR));
  };
  const std::string recording = path("felt.csv");
  // A machine that keeps the driver's process from the processor for 20 ms shuts the gate, rightly.
  outcome o = session("--enable", recording);
  for (int again = 0; again < 3 && o.exit_status != 0; ++again) {
    std::printf("the session ended early, once more: %s", o.err.c_str());
    o = session("--enable", recording);
  }
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(o.exit_status, 0) << o.err;
    const json d = json::parse(o.out);
    EXPECT_EQ(d["device"], "spring_handle");
    EXPECT_EQ(d["clock"], "real");
    EXPECT_EQ(d["fault"], "none");
    EXPECT_TRUE(d["driver_fault"].is_null());
    EXPECT_GT(d["device_loop"]["ticks"], 100);
    EXPECT_GT(std::filesystem::file_size(recording), 10'000U);
    o = session("--in-process", recording);
  }
}

TEST_F(devices_command, a_driver_that_breaks_in_a_session_ends_the_session_and_not_the_command) {
  NEEDS_TRUSTED_DRIVERS();
  const std::pair<const char*, const char*> ways[] = {{"crashes_later", "in read()"},
                                                      {"crashes_in_write", "in write()"},
                                                      {"hangs_in_read", "in read()"},
                                                      {"hangs_in_write", "in write()"}};
  for (const auto& [way, says] : ways) {
    SCOPED_TRACE(way);
    const process_options broken = with_broken(way);
    outcome o;
    const double taken_s = seconds_of([&] {
      o = run({"run", "--probe", pin(), "--fixed", pin(), "--device", "broken_driver", "--seconds", "30", "--record",
               path("felt.csv"), "--json"},
              broken);
    });
    EXPECT_LT(taken_s, 20.0);
    ASSERT_EQ(o.exit_status, 1) << o.err;
    const json d = json::parse(o.out);
    EXPECT_NE(d.value("fault", "none"), "none") << o.out;
    EXPECT_NE(d.value("driver_fault", "").find(says), std::string::npos) << o.out;
    EXPECT_NE(o.err.find(says), std::string::npos) << o.err;
    EXPECT_GT(std::filesystem::file_size(path("felt.csv")), 100U);
  }
}

TEST_F(devices_command, a_driver_that_does_not_come_back_from_open_is_interrupted) {
  NEEDS_TRUSTED_DRIVERS();
  process_options options = with_broken("hangs_in_open");
  options.interrupt_after_s = 0.3;
  outcome o;
  EXPECT_LT(seconds_of([&] {
              o = run({"run", "--probe", pin(), "--fixed", pin(), "--device", "broken_driver"}, options);
            }),
            10.0);
  EXPECT_EQ(o.exit_status, 130) << o.err;
}

TEST_F(devices_command, names_the_choices_where_no_device_fits) {
  const outcome o =
      run({"run", "--probe", pin(), "--fixed", pin(), "--device", "warp"}, with_path(ASPERITY_SAMPLE_DRIVER_DIR));
  EXPECT_EQ(o.exit_status, 1);
  EXPECT_NE(o.err.find("no device 'warp'"), std::string::npos) << o.err;
  EXPECT_NE(o.err.find("spring"), std::string::npos) << o.err;
}

TEST_F(devices_command, keeps_the_virtual_clock_for_the_simulated_device) {
  const outcome o = run({"run", "--probe", pin(), "--fixed", pin(), "--device", "spring_handle", "--clock", "virtual"},
                        with_path(ASPERITY_SAMPLE_DRIVER_DIR));
  EXPECT_EQ(o.exit_status, 1);
  EXPECT_NE(o.err.find("--clock virtual is for the simulated device"), std::string::npos) << o.err;
}

}  // namespace
}  // namespace fault
