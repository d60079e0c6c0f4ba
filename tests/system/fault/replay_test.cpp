// Device sessions on record: the same bytes when they are felt again, and one clear sentence where they cannot be.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include <asperity/device/device_recording.hpp>

#include "command_process.hpp"

namespace fault {
namespace {

using asperity::device_recording;
using asperity::recorded_end;

class replay : public command_test {
 protected:
  [[nodiscard]] static arguments felt_with(const std::string& device, const arguments& more) {
    static const std::string pin = (small_models() / "pin.glb").string();
    arguments args{"run", "--probe", pin, "--fixed", pin, "--device", device, "--contact-rate", "500"};
    args.insert(args.end(), more.begin(), more.end());
    return args;
  }
  [[nodiscard]] static arguments again(const std::string& file, const arguments& more = {}) {
    return felt_with("replay:" + file, more);
  }

  /// A short session of the simulated device, recorded once for all tests.
  [[nodiscard]] static const device_recording& short_session() {
    static const device_recording recording = [] {
      const std::string file = (small_models() / "short-session.dev").string();
      const outcome o = run(felt_with("simulated", {"--seconds", "0.05", "--record-device", file}));
      EXPECT_EQ(o.exit_status, 0) << o.err;
      auto loaded = asperity::load_device_recording(file);
      if (!loaded) throw std::runtime_error(loaded.error().message);
      return std::move(loaded).value();
    }();
    return recording;
  }
  /// Writes a recording. @return its path
  [[nodiscard]] std::string written(const device_recording& recording) const {
    write("changed.dev", asperity::encode(recording));
    return path("changed.dev");
  }

  [[nodiscard]] std::vector<std::string> rows(const std::string& name) const {
    std::vector<std::string> out;
    std::string text = read(name);
    for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
      out.push_back(text.substr(at, end - at));
    }
    return out;
  }
  [[nodiscard]] static std::string first_columns(const std::string& row, int n) {
    std::size_t at = 0;
    for (int i = 0; i < n && at != std::string::npos; ++i) at = row.find(',', at + 1);
    return row.substr(0, at);
  }
};

TEST_F(replay, gives_a_session_of_the_virtual_clock_byte_for_byte) {
  const outcome first = run(
      felt_with("simulated", {"--seconds", "0.35", "--record", path("then.csv"), "--record-device", path("then.dev")}));
  ASSERT_EQ(first.exit_status, 0) << first.err;
  const json d = expect_document(
      again(path("then.dev"), {"--record", path("now.csv"), "--record-device", path("now.dev")}), "asperity.run/1");
  EXPECT_GT(rows("then.csv").size(), 350U);
  EXPECT_GT(d["max_depth"], 0.0);
  EXPECT_TRUE(read("then.csv") == read("now.csv"));
  EXPECT_TRUE(read("then.dev") == read("now.dev"));
  EXPECT_EQ(d["clock"], "virtual");
  EXPECT_EQ(d["device_recording"], path("now.dev"));
  EXPECT_EQ(d["replay"], json::parse(R"({"device": "simulated", "ticks": 350, "cut": false, "differences": 0,
                                         "first_difference": null})"));
  EXPECT_EQ(files(), (std::set<std::string>{"now.csv", "now.dev", "then.csv", "then.dev"}));
}

TEST_F(replay, reports_from_when_on_another_wrench_was_felt) {
  ASSERT_EQ(run(felt_with("simulated", {"--seconds", "0.35", "--record-device", path("then.dev")})).exit_status, 0);
  // Friction changes nothing before something is touched.
  const arguments other = again(path("then.dev"), {"--record", path("now.csv"), "--friction", "0.5"});
  const json d = expect_document(other, "asperity.run/1");
  EXPECT_GT(d["replay"]["differences"], 50);
  EXPECT_GT(d["replay"]["first_difference"], 0.1);
  EXPECT_LT(d["replay"]["first_difference"], 0.3);
  EXPECT_EQ(d["fault"], "none");
  const outcome reported = run(other);
  EXPECT_NE(reported.out.find("the commands are others than then"), std::string::npos) << reported.out;
  // Whatever the recording holds of its own last ticks, the wrench goes to zero.
  const std::string last = rows("now.csv").back();
  EXPECT_NE(last.find(",0,0,0,0,0,0,"), std::string::npos) << last;
}

// What was measured in real time, at the times when it was; the contacts are those of the virtual clock.
TEST_F(replay, takes_the_ticks_of_a_session_in_real_time) {
  process_options options;
  std::string device = "simulated";
  // Far from the other body: on a busy machine contacts would come too late, and the gate would rightly shut.
  const std::string away = "0 0 0.5 0 0 0 1";
  arguments session{
      "--clock",         "real",           "--probe-pose", away, "--seconds", "0.2", "--record", path("then.csv"),
      "--record-device", path("then.dev"), "--json"};
#ifdef ASPERITY_SAMPLE_DRIVER_DIR
  options.environment = {{"ASPERITY_DRIVER_PATH", ASPERITY_SAMPLE_DRIVER_DIR}};
  device = "spring_handle";  // whose first pose takes up the probe
  session.insert(session.end(), {"--in-process", device});
#endif
  const outcome o = run(felt_with(device, session), options);
  if (o.err.find("can be written by") != std::string::npos) GTEST_SKIP() << o.err;
  ASSERT_EQ(o.exit_status, 0) << o.err;
  const std::uint64_t ticks = json::parse(o.out)["device_loop"]["ticks"];
  const json d =
      expect_document(again(path("then.dev"), {"--probe-pose", away, "--record", path("once.csv")}), "asperity.run/1");
  ASSERT_EQ(run(again(path("then.dev"), {"--probe-pose", away, "--record", path("twice.csv")})).exit_status, 0);
  EXPECT_TRUE(read("once.csv") == read("twice.csv"));
  EXPECT_EQ(d["replay"]["ticks"], ticks);
  EXPECT_EQ(d["device_loop"]["ticks"], ticks);

  const auto then = rows("then.csv"), now = rows("once.csv");
  ASSERT_GT(ticks, 20U);
  ASSERT_GT(std::min(then.size(), now.size()), ticks);
  for (std::size_t i = 0; i <= ticks; ++i) ASSERT_EQ(first_columns(then[i], 8), first_columns(now[i], 8)) << i;
  EXPECT_EQ(first_columns(then[1], 15), first_columns(now[1], 15));  // the probe is taken up where it was
}

// A session whose gate shut disarmed its device. One that is felt otherwise ends there too, and finds nothing wrong.
TEST_F(replay, ends_where_the_device_was_disarmed) {
  device_recording other = short_session();
  other.calls.insert(other.calls.begin() + 41, {.call = asperity::device_call::disarm});
  const json d = expect_document(again(written(other)), "asperity.run/1");
  EXPECT_EQ(d["device_loop"]["ticks"], 20);
  EXPECT_EQ(d["fault"], "none");
}

TEST_F(replay, ends_as_an_interrupted_session_did) {
  const arguments away{"--probe-pose", "0 0 0.5 0 0 0 1", "--contacts", "window"};
  arguments first =
      felt_with("simulated", {"--seconds", "3000", "--record", path("then.csv"), "--record-device", path("then.dev")});
  first.insert(first.end(), away.begin(), away.end());
  // On a busy machine the models may not be loaded yet when the signal comes: a later one finds the session.
  process_options options;
  options.interrupt_after_s = 0.4;
  auto recording = asperity::decode("");
  for (int tries = 0; tries < 7 && (!recording || recording->writes_before_end == 0); ++tries) {
    EXPECT_EQ(run(first, options).exit_status, 130);
    recording = asperity::decode(read("then.dev"));
    *options.interrupt_after_s *= 2.0;
  }
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_GT(recording->writes_before_end, 0U);
  EXPECT_EQ(recording->end, recorded_end::interrupted);
  arguments second = again(path("then.dev"), {"--record", path("now.csv")});
  second.insert(second.end(), away.begin(), away.end());
  EXPECT_EQ(expect_document(second, "asperity.run/1")["interrupted"], false);
  EXPECT_TRUE(read("then.csv") == read("now.csv"));
}

TEST_F(replay, ends_the_gate_as_the_session_on_record_ended) {
  for (const auto& [end, word] :
       {std::pair{recorded_end::interrupted, ",interrupted"}, std::pair{recorded_end::stopped, ",stopped"}}) {
    device_recording other = short_session();
    other.end = end;
    other.writes_before_end = 20;
    ASSERT_EQ(run(again(written(other), {"--record", path("now.csv")})).exit_status, 0);
    const auto now = rows("now.csv");
    ASSERT_GT(now.size(), 21U);
    EXPECT_TRUE(now[20].ends_with(",none")) << now[20];
    EXPECT_TRUE(now[21].ends_with(word)) << now[21];
  }
}

TEST_F(replay, lasts_no_longer_than_it_is_asked_to) {
  const std::string file = written(short_session());
  EXPECT_EQ(expect_document(again(file, {"--seconds", "0.02"}), "asperity.run/1")["device_loop"]["ticks"], 20);
  EXPECT_EQ(expect_document(again(file, {"--seconds", "3"}), "asperity.run/1")["device_loop"]["ticks"], 50);
}

TEST_F(replay, refuses_what_is_no_recording) {
  EXPECT_NE(expect_failure(again(path("absent.dev")), 1, "io_failed").find("absent.dev: cannot be found"),
            std::string::npos);
  expect_failure(again(path("")), 1, "io_failed");
  expect_failure(again(""), 1, "invalid_argument");
  write("session.csv", "time_s,device_x_m\n0,0\n");
  EXPECT_NE(expect_failure(again(path("session.csv")), 1, "bad_format").find("no device recording"), std::string::npos);
  const std::string whole = asperity::encode(short_session());
  for (const std::size_t size : {whole.size() - 1, whole.size() / 2, std::size_t{40}, std::size_t{0}}) {
    write("cut.dev", whole.substr(0, size));
    const std::string message = expect_failure(again(path("cut.dev")), 1, "bad_format");
    EXPECT_NE(message.find("cut.dev"), std::string::npos) << message;
  }
}

TEST_F(replay, refuses_a_device_that_is_described_otherwise) {
  device_recording other = short_session();
  other.capabilities.peak_force_n = 12.0;
  const std::string message = expect_failure(again(written(other)), 1, "unsupported");
  EXPECT_NE(message.find("peak force: 12 there, 20 here"), std::string::npos) << message;
  other.capabilities.peak_force_n = std::numeric_limits<double>::quiet_NaN();
  expect_failure(again(written(other)), 1, "bad_format");
}

TEST_F(replay, refuses_calls_that_are_no_session) {
  device_recording other = short_session();
  other.calls.erase(other.calls.begin());  // arm()
  EXPECT_NE(expect_failure(again(written(other)), 1, "unsupported").find("never armed"), std::string::npos);
  other = short_session();
  other.calls.erase(other.calls.begin() + 6);  // a write
  --other.writes_before_end;
  EXPECT_NE(expect_failure(again(written(other)), 1, "unsupported").find("call 5 "), std::string::npos);
  other = short_session();
  other.calls[9].now_ns = other.calls[10].now_ns = 0;  // a tick
  expect_failure(again(written(other)), 1, "unsupported");
  other = short_session();
  for (std::size_t i = 21; i < other.calls.size(); ++i) other.calls[i].now_ns += 90'000'000'000'000;
  EXPECT_NE(expect_failure(again(written(other)), 1, "unsupported").find("a day"), std::string::npos);
}

TEST_F(replay, is_for_the_virtual_clock) {
  expect_failure(again(written(short_session()), {"--clock", "real"}), 1, "invalid_argument");
}

TEST_F(replay, recording_that_cannot_be_written) {
  const auto to = [](const std::string& file) {
    return felt_with("simulated", {"--seconds", "0.05", "--record-device", file});
  };
  EXPECT_NE(expect_failure(to(path("absent/session.dev")), 1, "io_failed").find("absent/session.dev"),
            std::string::npos);
  std::filesystem::create_symlink("/dev/full", path("full.dev"));
  expect_failure(to(path("full.dev")), 1, "io_failed");
  process_options small_disk;
  small_disk.file_size_limit = 4096;
  expect_failure(to(path("session.dev")), 1, "io_failed", small_disk);
  expect_failure(felt_with("simulated", {"--seconds", "4001", "--record-device", path("session.dev")}), 1,
                 "invalid_argument");
  const std::string file = written(short_session()), before = read("changed.dev");
  expect_failure(again(file, {"--record-device", file}), 1, "invalid_argument");
  EXPECT_EQ(read("changed.dev"), before);
}

}  // namespace
}  // namespace fault
