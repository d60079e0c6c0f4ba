// Devices as the command finds them: the sample driver in the driver path, drivers that cannot be loaded, names that
// fit nothing.
#include <fstream>

#include "command_process.hpp"

namespace fault {
namespace {

using devices_command = command_test;

const std::string& block() {
  static const std::string file = (small_models() / "block.glb").string();
  return file;
}

process_options with_path(const std::string& folder) {
  process_options options;
  options.environment = {{"ASPERITY_DRIVER_PATH", folder}};
  return options;
}

json devices(const std::string& folder) {
  const outcome o = run({"devices", "--json"}, with_path(folder));
  EXPECT_EQ(o.exit_status, 0) << o.err;
  return json::parse(o.out);
}

TEST_F(devices_command, lists_what_a_driver_in_the_path_finds) {
  const json d = devices(ASPERITY_SAMPLE_DRIVER_DIR);
  EXPECT_NE(std::find(d["drivers"].begin(), d["drivers"].end(), "spring_handle"), d["drivers"].end()) << d["drivers"];
  const auto it = std::find_if(d["devices"].begin(), d["devices"].end(),
                               [](const json& each) { return each["driver"] == "spring_handle"; });
  ASSERT_NE(it, d["devices"].end()) << d.dump(1);
  EXPECT_EQ((*it)["maturity"], "simulated");
  EXPECT_TRUE((*it)["problem"].is_null());
  EXPECT_GT((*it)["peak_force"], 0.0);
}

TEST_F(devices_command, says_which_driver_cannot_be_loaded_and_lists_the_rest) {
  std::ofstream(path("broken.so")) << "not a shared object";
  const json d = devices(path("."));
  ASSERT_EQ(d["problems"].size(), 1U) << d["problems"];
  EXPECT_NE(d["problems"][0]["where"].get<std::string>().find("broken.so"), std::string::npos);
  EXPECT_FALSE(d["problems"][0]["problem"].get<std::string>().empty());
  EXPECT_EQ(d["devices"][0]["name"], "simulated");
}

TEST_F(devices_command, runs_a_session_with_a_device_behind_the_c_interface) {
  const std::string recording = path("felt.csv");
  const outcome o = run({"run", "--probe", block(), "--fixed", block(), "--device", "spring_handle", "--seconds", "0.3",
                         "--record", recording, "--json"},
                        with_path(ASPERITY_SAMPLE_DRIVER_DIR));
  ASSERT_EQ(o.exit_status, 0) << o.err;
  const json d = json::parse(o.out);
  EXPECT_EQ(d["device"], "spring_handle");
  EXPECT_EQ(d["clock"], "real");
  EXPECT_EQ(d["fault"], "none");
  EXPECT_GT(d["device_loop"]["ticks"], 100);
  EXPECT_GT(std::filesystem::file_size(recording), 10'000U);
}

TEST_F(devices_command, names_the_choices_where_no_device_fits) {
  const outcome o =
      run({"run", "--probe", block(), "--fixed", block(), "--device", "warp"}, with_path(ASPERITY_SAMPLE_DRIVER_DIR));
  EXPECT_EQ(o.exit_status, 1);
  EXPECT_NE(o.err.find("no device 'warp'"), std::string::npos) << o.err;
  EXPECT_NE(o.err.find("spring"), std::string::npos) << o.err;
}

TEST_F(devices_command, keeps_the_virtual_clock_for_the_simulated_device) {
  const outcome o =
      run({"run", "--probe", block(), "--fixed", block(), "--device", "spring_handle", "--clock", "virtual"},
          with_path(ASPERITY_SAMPLE_DRIVER_DIR));
  EXPECT_EQ(o.exit_status, 1);
  EXPECT_NE(o.err.find("--clock virtual is for the simulated device"), std::string::npos) << o.err;
}

}  // namespace
}  // namespace fault
