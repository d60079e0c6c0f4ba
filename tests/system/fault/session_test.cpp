// What a session leaves behind: the same bytes every time, and a closed recording when somebody stops it.
#include <algorithm>
#include <cmath>

#include "command_process.hpp"

namespace fault {
namespace {

class session : public command_test {
 protected:
  [[nodiscard]] arguments session_to(const std::string& recording, const arguments& more = {}) const {
    const std::string pin = (small_models() / "pin.glb").string();
    arguments args{"run", "--probe", pin, "--fixed", pin, "--record", path(recording)};
    args.insert(args.end(), more.begin(), more.end());
    return args;
  }
  [[nodiscard]] std::vector<std::vector<std::string>> table(const std::string& name) const {
    std::vector<std::vector<std::string>> rows{{""}};
    for (const char c : read(name)) {
      if (c == '\n') {
        rows.push_back({""});
      } else if (c == ',') {
        rows.back().emplace_back();
      } else {
        rows.back().back() += c;
      }
    }
    EXPECT_EQ(rows.back(), std::vector<std::string>{""}) << "the last line is not complete";
    rows.pop_back();
    return rows;
  }

  /// Runs a session and sends SIGINT once it has recorded some ticks, however long it took to start.
  [[nodiscard]] outcome interrupted(const arguments& args) const {
    running_command command(args);
    const auto has_recorded = [this] {
      const std::set<std::string> names = files();
      return std::any_of(names.begin(), names.end(),
                         [this](const std::string& name) { return read(name).size() > 4096; });
    };
    EXPECT_TRUE(command.wait_until(has_recorded));
    command.send(SIGINT);
    return command.finish();
  }
};

TEST_F(session, twice_gives_the_same_bytes) {
  for (const char* motion : {"scrub", "twist", "free"}) {
    const arguments more{"--seconds", "0.7", "--motion", motion, "--contact-rate", "500"};
    ASSERT_EQ(run(session_to("first.csv", more)).exit_status, 0);
    ASSERT_EQ(run(session_to("second.csv", more)).exit_status, 0);
    EXPECT_GT(read("first.csv").size(), 50000U);
    EXPECT_TRUE(read("first.csv") == read("second.csv")) << motion;
  }
  const arguments paper{"--seconds", "0.7", "--contacts", "window", "--grid", "24"};
  const std::string shared = read("first.csv");
  ASSERT_EQ(run(session_to("first.csv", paper)).exit_status, 0);
  ASSERT_EQ(run(session_to("second.csv", paper)).exit_status, 0);
  EXPECT_TRUE(read("first.csv") == read("second.csv"));
  EXPECT_FALSE(read("first.csv") == shared);
}

TEST_F(session, another_seed_is_another_hand) {
  ASSERT_EQ(run(session_to("first.csv", {"--seconds", "0.2", "--seed", "1"})).exit_status, 0);
  ASSERT_EQ(run(session_to("second.csv", {"--seconds", "0.2", "--seed", "2"})).exit_status, 0);
  EXPECT_FALSE(read("first.csv") == read("second.csv"));
}

TEST_F(session, recording_is_a_table_that_ends_with_no_wrench) {
  ASSERT_EQ(run(session_to("session.csv", {"--seconds", "0.8"})).exit_status, 0);
  const auto rows = table("session.csv");
  ASSERT_GT(rows.size(), 800U);
  for (const auto& row : rows) ASSERT_EQ(row.size(), rows.front().size());
  EXPECT_EQ(rows.front().front(), "time_s");
  const auto column = [&](const std::string& name) {
    const auto found = std::find(rows.front().begin(), rows.front().end(), name);
    EXPECT_NE(found, rows.front().end()) << name;
    return static_cast<std::size_t>(found - rows.front().begin());
  };
  double largest = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(std::stod(rows[i][0]), static_cast<double>(i - 1) / 1e3);
    largest = std::max(largest, std::stod(rows[i][column("hand_fz_n")]));
    // Written with every digit, a rotation is still one when it is read.
    double square = 0.0;
    for (const char* q : {"probe_qx", "probe_qy", "probe_qz", "probe_qw"})
      square += std::pow(std::stod(rows[i][column(q)]), 2);
    ASSERT_NEAR(square, 1.0, 1e-13);
  }
  EXPECT_GT(largest, 0.1);  // the hand was pushed up
  for (const char* component : {"hand_fx_n", "hand_fy_n", "hand_fz_n", "hand_tx_n_m", "hand_ty_n_m", "hand_tz_n_m"}) {
    EXPECT_EQ(std::stod(rows.back()[column(component)]), 0.0) << component;
  }
}

// A row for each device tick at its own rate, the same bytes again, and what the document says of both loops.
TEST_F(session, has_the_rates_that_it_is_given) {
  for (const auto& [device_hz, contact_hz] : {std::pair{200, 4000}, {1000, 200}, {4000, 1000}, {10000, 10000}}) {
    const arguments rates{
        "--seconds", "0.3", "--device-rate", std::to_string(device_hz), "--contact-rate", std::to_string(contact_hz)};
    const json document = expect_document(session_to("first.csv", rates), "asperity.run/1");
    ASSERT_EQ(run(session_to("second.csv", rates)).exit_status, 0);
    EXPECT_TRUE(read("first.csv") == read("second.csv")) << device_hz << ' ' << contact_hz;
    const auto rows = table("first.csv");
    ASSERT_GT(rows.size(), static_cast<std::size_t>(0.3 * device_hz));
    for (std::size_t i = 1; i < rows.size(); ++i) {
      ASSERT_NEAR(std::stod(rows[i][0]), static_cast<double>(i - 1) / device_hz, 1e-12);
    }
    const json &device = document["device_loop"], &contact = document["contact_loop"];
    EXPECT_EQ(device["rate"], device_hz);
    EXPECT_EQ(contact["rate"], contact_hz);
    EXPECT_EQ(device["ticks"], 3 * device_hz / 10);
    EXPECT_NEAR(contact["ticks"].get<double>(), 0.3 * std::min(device_hz, contact_hz), 2.0);
    EXPECT_EQ(contact["idle"].get<int>() > 10, contact_hz > device_hz);
    EXPECT_EQ(contact["late"], contact["over_period"]);
    EXPECT_TRUE(contact["kept"].is_boolean());
    EXPECT_EQ(document["fault"], "none");
    EXPECT_EQ(document["rates"]["lost_periods"], 0);
    const json& check = document["rate_check"];
    EXPECT_GE(check["tick_time"]["count"].get<int>(), 5);
    EXPECT_LE(check["tick_time"]["count"].get<int>(), 200);
    EXPECT_EQ(check["kept"].get<bool>(), check["tick_time"]["p99"].get<double>() <= 1.0 / contact_hz);
    EXPECT_TRUE(!check["kept"].get<bool>() || check["kept_rate"].is_null());
  }
}

TEST_F(session, says_before_it_begins_whether_the_rate_is_kept) {
  const arguments brief{"--seconds", "0.05"};
  const outcome told = run(session_to("session.csv", brief));
  EXPECT_EQ(told.exit_status, 0);
  EXPECT_EQ(told.err.find("asperity: note: contact loop: a tick takes "), 0U) << told.err;
  EXPECT_EQ(std::count(told.err.begin(), told.err.end(), '\n'), 1) << told.err;
  arguments quiet = session_to("session.csv", brief);
  quiet.insert(quiet.begin(), "--quiet");
  EXPECT_EQ(run(quiet).err, "");
  EXPECT_FALSE(expect_document(session_to("session.csv", brief), "asperity.run/1")["rate_check"].is_null());
}

TEST_F(session, interrupted_on_the_real_clock) {
  const outcome stopped = interrupted(session_to("session.csv", {"--seconds", "600", "--clock", "real", "--json"}));
  EXPECT_EQ(stopped.exit_status, 130);
  EXPECT_NE(stopped.err.find("\nasperity: interrupted by SIGINT after "), std::string::npos) << stopped.err;
  const json document = json::parse(stopped.out, nullptr, false);
  ASSERT_TRUE(document.is_object()) << stopped.out;
  EXPECT_EQ(document["schema"], "asperity.run/1");
  EXPECT_EQ(document["interrupted"], true);
  EXPECT_EQ(files(), std::set<std::string>{"session.csv"});
  const auto rows = table("session.csv");
  ASSERT_GT(rows.size(), 1U);
  for (const auto& row : rows) ASSERT_EQ(row.size(), rows.front().size());
}

TEST_F(session, interrupted_on_the_virtual_clock) {
  const outcome stopped = interrupted(session_to("session.csv", {"--seconds", "80000", "--contacts", "window"}));
  EXPECT_EQ(stopped.exit_status, 130);
  EXPECT_EQ(files(), std::set<std::string>{"session.csv"});
  EXPECT_GT(table("session.csv").size(), 1U);
}

TEST_F(session, more_poses_than_bodies) {
  expect_failure(session_to("session.csv", {"--fixed-pose", "0 0 0 0 0 0 1", "--fixed-pose", "0 0 0 0 0 0 1"}), 1,
                 "invalid_argument");
}

TEST_F(session, bad_poses) {
  expect_failure(session_to("session.csv", {"--probe-pose", "0 0 nan 0 0 0 1"}), 1, "invalid_argument");
  expect_failure(session_to("session.csv", {"--fixed-pose", "0 0 0 0 0 0 2"}), 1, "invalid_argument");
}

}  // namespace
}  // namespace fault
