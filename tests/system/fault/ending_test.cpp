// However a session ends, the wrench has gone to zero and the device was disarmed, or the command says that it was not.
#include <algorithm>
#include <chrono>
#include <fcntl.h>
#include <fstream>
#include <memory>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include "command_process.hpp"

namespace fault {
namespace {

class ending : public command_test {
 protected:
  // In contact from the first tick: the handle is taken up with the probe a millimetre in the other body.
  // What belongs to one session lies in a folder of its own, so that several can run at a time.
  [[nodiscard]] arguments session(const std::string& seconds = "600", const std::string& in = ".") const {
    static const std::string pin = (small_models() / "pin.glb").string();
    std::filesystem::create_directories(path(in));
    return {"run",
            "--probe",
            pin,
            "--fixed",
            pin,
            "--device",
            "noting",
            "--in-process",
            "noting_driver",
            "--seconds",
            seconds,
            "--probe-pose",
            "0 0 0.0193 0 0 0 1",
            "--record",
            path(in + "/felt.csv"),
            "--record-device",
            path(in + "/felt.dev"),
            "--json"};
  }
  [[nodiscard]] process_options noted(const std::string& in = ".", const std::string& block = {}) const {
    process_options options;
    options.environment = {{"ASPERITY_DRIVER_PATH", NOTING_DRIVER_DIR}, {"NOTING_FILE", path(in + "/notes")}};
    if (!block.empty()) options.environment.emplace_back("NOTING_BLOCK", block);
    return options;
  }
  [[nodiscard]] static arguments replay(const std::string& file) {
    const std::string pin = (small_models() / "pin.glb").string();
    return {"run", "--probe", pin, "--fixed", pin, "--device", "replay:" + file};
  }
  [[nodiscard]] static arguments with(arguments args, const std::string& old, const std::string& replacement) {
    std::replace(args.begin(), args.end(), old, replacement);
    return args;
  }
  [[nodiscard]] bool notes(const std::string& what, const std::string& in = ".") const {
    return read(in + "/notes").find(what) != std::string::npos;
  }
  [[nodiscard]] std::size_t rows(const std::string& name) const {
    const std::string text = read(name);
    EXPECT_TRUE(text.empty() || text.back() == '\n') << name << " ends within a row";
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }
  // The name that ends in .partial- and letters, if any.
  [[nodiscard]] std::string partial_of(const std::string& name) const {
    for (const std::string& file : files()) {
      if (file.find(name + ".partial-") != std::string::npos) return file;
    }
    return {};
  }
  static std::string last_line(const std::string& text) {
    const std::size_t end = text.find_last_not_of('\n');
    const std::size_t begin = text.rfind('\n', end);
    return text.substr(begin == std::string::npos ? 0 : begin + 1);
  }
  // The device was brought to rest: no force when it was disarmed, and disarmed before it was closed.
  void expect_rest(const std::string& in = ".") const {
    const std::string all = read(in + "/notes");
    const std::size_t disarmed = all.find("disarm after 0.000000 N"), closed = all.find("close");
    EXPECT_NE(disarmed, std::string::npos) << all;
    EXPECT_LT(disarmed, closed) << all;
    EXPECT_EQ(all.find("disarm after"), disarmed) << "first disarmed with a force on the hand\n" << all;
  }
};

constexpr std::pair<int, const char*> signals[] = {
    {SIGHUP, "SIGHUP"},       {SIGINT, "SIGINT"},       {SIGQUIT, "SIGQUIT"}, {SIGTERM, "SIGTERM"},
    {SIGPIPE, "SIGPIPE"},     {SIGALRM, "SIGALRM"},     {SIGUSR1, "SIGUSR1"}, {SIGUSR2, "SIGUSR2"},
    {SIGXCPU, "SIGXCPU"},     {SIGVTALRM, "SIGVTALRM"}, {SIGPROF, "SIGPROF"}, {SIGPOLL, "SIGPOLL"},
    {SIGSTKFLT, "SIGSTKFLT"}, {SIGPWR, "SIGPWR"},       {SIGTSTP, "SIGTSTP"},
};

TEST_F(ending, of_every_signal_is_at_rest) {
  std::vector<std::pair<int, std::string>> all(std::begin(signals), std::end(signals));
  all.emplace_back(SIGRTMIN + 3, "signal " + std::to_string(SIGRTMIN + 3));
  // Four at a time: their starts are what takes time.
  constexpr std::size_t at_a_time = 4;
  ASSERT_EQ(all.size() % at_a_time, 0U);
  for (std::size_t first = 0; first < all.size(); first += at_a_time) {
    std::vector<std::unique_ptr<running_command>> felt;
    for (std::size_t i = first; i < first + at_a_time; ++i) {
      felt.push_back(std::make_unique<running_command>(session("600", all[i].second), noted(all[i].second)));
    }
    for (std::size_t i = first; i < first + at_a_time; ++i) {
      const int number = all[i].first;
      const std::string& name = all[i].second;
      running_command& one = *felt[i - first];
      SCOPED_TRACE(name);
      ASSERT_TRUE(one.wait_until([&] { return notes("pushes", name); })) << one.finish(0.0).err;
      one.send(number);
      one.send(number);  // a second wish does not cut off what the first one began
      const outcome o = one.finish();
      EXPECT_EQ(o.exit_status, 128 + number);
      EXPECT_TRUE(last_line(o.err).starts_with("asperity: interrupted by " + name + " after ")) << o.err;
      const json d = json::parse(o.out, nullptr, false);
      ASSERT_TRUE(d.is_object()) << o.out;
      EXPECT_EQ(d["interrupted"], true);
      EXPECT_EQ(d["signal"], name);
      EXPECT_EQ(d["fault"], "none");
      expect_rest(name);
      EXPECT_GT(rows(name + "/felt.csv"), 2U);
      EXPECT_TRUE(files().contains(name + "/felt.dev"));
      EXPECT_EQ(partial_of("felt."), "");
    }
  }
}

TEST_F(ending, of_signals_in_a_storm_is_at_rest) {
  running_command felt(session(), noted());
  ASSERT_TRUE(felt.wait_until([&] { return notes("pushes"); })) << felt.finish().err;
  for (int i = 0; !felt.ended() && !notes("close") && i < 5000; ++i) {
    felt.send(i % 2 == 0 ? SIGTERM : SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(felt.finish().exit_status, 128 + SIGTERM);
  expect_rest();
}

TEST_F(ending, before_the_session_begins_arms_nothing) {
  for (const double after_s : {0.0, 0.01, 0.03, 0.06}) {
    static_cast<void>(std::filesystem::remove(path("notes")));
    process_options options = noted();
    options.interrupt_after_s = after_s;
    const outcome o = run(session(), options);
    EXPECT_EQ(o.exit_status, 130) << o.err;
    EXPECT_TRUE(last_line(o.err).starts_with("asperity: interrupted")) << o.err;
    EXPECT_TRUE(!notes("\narm\n") || notes("disarm")) << read("notes");
    EXPECT_EQ(partial_of("felt.csv") + partial_of("felt.dev"), "");
  }
}

TEST_F(ending, during_a_homing_arms_nothing) {
  process_options options = noted();
  options.environment.emplace_back("NOTING_OPEN_MS", "300");
  running_command felt(session(), options);
  ASSERT_TRUE(felt.wait_until([&] { return notes("open"); })) << felt.finish(0.0).err;
  felt.send(SIGTERM);
  const outcome o = felt.finish();
  EXPECT_EQ(o.exit_status, 128 + SIGTERM) << o.err;
  EXPECT_TRUE(last_line(o.err).starts_with("asperity: interrupted by SIGTERM before the session began")) << o.err;
  EXPECT_FALSE(notes("\narm\n")) << read("notes");
  EXPECT_TRUE(notes("close")) << read("notes");
  EXPECT_EQ(files(), std::set<std::string>{"notes"});
}

// What is told of the scheduling class, held against what the kernel says of the threads.
TEST_F(ending, of_a_session_in_real_time_reports_what_it_was_given) {
  running_command felt(session("0.5"), noted());
  std::set<std::string> priorities;  // of the threads with SCHED_FIFO
  ASSERT_TRUE(felt.wait_until([&] { return notes("pushes"); })) << felt.finish(0.0).err;
  const std::filesystem::path threads = "/proc/" + std::to_string(felt.process()) + "/task";
  for (const auto& thread : std::filesystem::directory_iterator(threads)) {
    std::ifstream about(thread.path() / "stat");
    std::vector<std::string> fields;
    for (std::string word; about >> word;) fields.push_back(word);
    if (fields.size() > 40 && fields[40] == "1") priorities.insert(fields[39]);  // proc(5): policy, rt_priority
  }
  const outcome o = felt.finish();
  ASSERT_EQ(o.exit_status, 0) << o.err;
  EXPECT_TRUE(o.err.starts_with("asperity: note: real time: device loop ")) << o.err;
  const json d = json::parse(o.out)["real_time"];
  for (const auto& [thread, wish] : {std::pair{"device_thread", "40"}, std::pair{"contact_thread", "20"}}) {
    const bool granted = d[thread]["scheduling"] == "granted";
    ASSERT_EQ(granted, d[thread]["priority"].is_number()) << d;
    const std::string reported = granted ? std::to_string(d[thread]["priority"].get<int>()) : wish;
    EXPECT_EQ(granted, priorities.contains(reported)) << d;
  }
  arguments quiet = session("0.1");
  quiet.emplace_back("--quiet");
  EXPECT_EQ(run(quiet, noted()).err, "");
}

TEST_F(ending, of_nohup_waits_for_the_time_to_be_over) {
  const arguments args = session("0.4");
  const auto before = std::signal(SIGHUP, SIG_IGN);
  running_command felt(args, noted());
  std::signal(SIGHUP, before);
  ASSERT_TRUE(felt.wait_until([&] { return notes("pushes"); })) << felt.finish().err;
  felt.send(SIGHUP);
  EXPECT_EQ(felt.finish().exit_status, 0);
  expect_rest();
}

TEST_F(ending, of_a_pipe_without_a_reader_is_at_rest) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  process_options options = noted();
  options.stdout_to = path("pipe");
  arguments args = with(session(), path("./felt.csv"), "/dev/stdout");
  args.pop_back();  // no document between the rows
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  running_command felt(args, options);
  std::string head;
  const bool seen = felt.wait_until([&] {
    char some[4096];
    const ssize_t n = ::read(reader, some, sizeof some);
    if (n > 0) head.append(some, static_cast<std::size_t>(n));
    return notes("pushes") && std::count(head.begin(), head.end(), '\n') > 1;
  });
  ::close(reader);
  const outcome o = felt.finish();
  EXPECT_TRUE(seen) << o.err << read("notes");
  EXPECT_EQ(o.exit_status, 1);
  EXPECT_TRUE(last_line(o.err).starts_with("asperity: cannot write /dev/stdout: Broken pipe")) << o.err;
  EXPECT_NE(o.err.find("the device is disarmed"), std::string::npos) << o.err;
  expect_rest();
}

TEST_F(ending, of_a_full_disk_is_at_rest) {
  for (const char* which : {"felt.csv", "felt.dev"}) {
    static_cast<void>(std::filesystem::remove(path("notes")));
    process_options options = noted();
    options.file_size_limit = 100'000;  // a few hundred ticks
    const outcome o = run(with(session(), path(std::string("./") + which), "/dev/null"), options);
    EXPECT_EQ(o.exit_status, 1);
    EXPECT_TRUE(last_line(o.err).starts_with("asperity: cannot write ")) << o.err;
    EXPECT_NE(o.err.find("the device is disarmed"), std::string::npos) << o.err;
    expect_rest();
    EXPECT_EQ(files(), (std::set<std::string>{"notes"}));
  }
}

TEST_F(ending, of_a_reader_who_takes_nothing_is_at_rest) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const arguments args = with(session(), path("./felt.csv"), path("pipe"));
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  running_command felt(args, noted());
  // The pipe is full after a moment: the program hangs in it, and the loop brings the wrench to zero by itself.
  EXPECT_TRUE(felt.wait_until([&] { return notes("disarm after"); })) << read("notes");
  felt.send(SIGINT);
  const outcome o = felt.finish(15.0);
  ::close(reader);
  EXPECT_TRUE(o.exit_status == 130 || o.exit_status == 1) << o.exit_status << o.err;
  expect_rest();
}

TEST_F(ending, of_a_wait_for_a_reader_opens_no_device) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const arguments args = with(session(), path("./felt.csv"), path("pipe"));
  process_options options = noted();
  options.interrupt_after_s = 0.1;
  EXPECT_EQ(run(args, options).exit_status, 130);
  EXPECT_EQ(read("notes"), "");
}

// What a driver that never returns leaves: a process that ends by itself, with what was recorded.
TEST_F(ending, of_a_driver_that_blocks_is_that_of_its_process) {
  struct blocked {
    const char* call;
    bool armed;     // nobody could disarm it
    bool recorded;  // the session had begun
    bool asked;     // a homing may take its time, and an end has to be asked for
  };
  const blocked all[] = {{"open", false, false, true},    {"arm", true, false, true},
                         {"read:100", true, true, false}, {"write:100", true, true, false},
                         {"disarm", true, true, true},    {"close", false, true, true}};
  std::vector<std::unique_ptr<running_command>> felt;
  for (const blocked& b : all) {
    felt.push_back(std::make_unique<running_command>(session("600", b.call), noted(b.call, b.call)));
  }
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const blocked& b = all[i];
    running_command& one = *felt[i];
    SCOPED_TRACE(b.call);
    const std::string in = b.call, call = in.substr(0, in.find(':'));
    const char* const reached = call == "disarm" || call == "close" ? "pushes" : "blocks in";
    ASSERT_TRUE(one.wait_until([&] { return notes(reached, in); })) << one.finish(0.0).err;
    const auto begin = std::chrono::steady_clock::now();
    if (b.asked) one.send(SIGINT);
    const outcome o = one.finish(20.0);
    EXPECT_EQ(o.exit_status, 1);
    EXPECT_TRUE(notes("blocks in " + call, in)) << read(in + "/notes");
    // One second is the limit; the rest is a busy machine's.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(8));
    const std::string line = last_line(o.err);
    EXPECT_TRUE(line.starts_with("asperity: the driver has not returned from " + call + "()")) << o.err;
    EXPECT_EQ(line.find("NOT disarmed") != std::string::npos, b.armed) << line;
    const json d = json::parse(o.out, nullptr, false);
    ASSERT_TRUE(d.is_object() && d.contains("error")) << o.out;
    EXPECT_EQ("asperity: " + d["error"].value("message", "") + "\n", line);
    EXPECT_EQ(partial_of(in + "/felt."), "");
    ASSERT_EQ(files().contains(in + "/felt.csv"), b.recorded);
    ASSERT_EQ(files().contains(in + "/felt.dev"), b.recorded);
    if (!b.recorded) continue;
    EXPECT_GT(rows(in + "/felt.csv"), 2U);
    EXPECT_GT(expect_document(replay(path(in + "/felt.dev")), "asperity.run/1")["replay"]["ticks"], 2);
  }
}

TEST_F(ending, of_a_killed_session_leaves_recordings_that_can_be_read) {
  running_command felt(session(), noted());
  ASSERT_TRUE(felt.wait_until([&] {
    const std::string dev = partial_of("felt.dev"), csv = partial_of("felt.csv");
    return !dev.empty() && !csv.empty() && read(dev).size() > 150'000 && read(csv).size() > 150'000;
  })) << felt.finish().err;
  EXPECT_EQ(felt.finish(0.0).exit_status, 137);
  const std::string dev = partial_of("felt.dev"), csv = partial_of("felt.csv");
  ASSERT_FALSE(dev.empty() || csv.empty());
  EXPECT_FALSE(files().contains("felt.dev") || files().contains("felt.csv"));

  const json d = expect_document(replay(path(dev)), "asperity.run/1");
  EXPECT_GT(d["replay"]["ticks"], 256);
  EXPECT_EQ(d["replay"]["cut"], true);
  EXPECT_EQ(d["fault"], "none");
  EXPECT_NE(run(replay(path(dev))).out.find("cut off before its end"), std::string::npos);

  // Whole rows, up to a last one that may be cut.
  std::string table = read(csv);
  table.resize(table.rfind('\n') + 1);
  const auto columns = std::count(table.begin(), table.begin() + static_cast<std::ptrdiff_t>(table.find('\n')), ',');
  std::size_t whole = 0;
  for (std::size_t at = 0, end = 0; (end = table.find('\n', at)) != std::string::npos; at = end + 1, ++whole) {
    ASSERT_EQ(std::count(table.begin() + static_cast<std::ptrdiff_t>(at),
                         table.begin() + static_cast<std::ptrdiff_t>(end), ','),
              columns);
  }
  EXPECT_GT(whole, 256U);

  // The next run, with the same names, is not kept from its work, and leaves what the dead one left.
  const std::string before = read(csv);
  EXPECT_EQ(run(session("0.2"), noted()).exit_status, 0);
  EXPECT_TRUE(files().contains("felt.csv") && files().contains("felt.dev"));
  EXPECT_EQ(read(csv), before);
}

}  // namespace
}  // namespace fault
