// Programs that are killed or stopped: what their driver does in a process of its own.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "child_rig.hpp"

namespace asperity::plugin {
namespace {

using namespace child_tests;
using namespace std::chrono_literals;

// What the driver wrote down: a word, a value, ms on the clock, its process.
struct line_of_driver {
  std::string what;
  double value = 0.0;
  std::int64_t at_ms = 0;
  pid_t process = 0;
};
std::vector<line_of_driver> lines_of(const std::filesystem::path& log) {
  std::vector<line_of_driver> out;
  std::ifstream in(log);
  for (line_of_driver l; in >> l.what >> l.value >> l.at_ms >> l.process;) out.push_back(l);
  return out;
}

// Another program: it pushes with half a newton through a driver of its own until a signal ends or stops it.
// @return its process; `log` is what its driver is told
pid_t start_program(const std::filesystem::path& log, int exit_in_fault) {
  std::filesystem::remove(log);
  const pid_t program = ::fork();
  if (program != 0) return program;
  ::setenv("ASPERITY_BROKEN_LOG", log.c_str(), 1);
  broken_device b("tells", options_for("tells", child_pace::paced));
  if (!b.device) ::_exit(90);
  device_sample in;
  for (;;) {
    const std::int64_t now_ns = clock_ns();
    static_cast<void>(b.device->read(now_ns, in));
    static_cast<void>(b.device->write(now_ns, push(now_ns, {0.5, 0.0, 0.0})));
    if (b.device->state() == device_state::fault) {
      const bool silent = b.device->fault_text().find("silent for too long") != std::string::npos;
      b.device.reset();
      ::_exit(silent ? exit_in_fault : 91);
    }
    std::this_thread::sleep_for(1ms);
  }
}

bool pushes(const std::filesystem::path& log) {
  const std::vector<line_of_driver> lines = lines_of(log);
  return std::count_if(lines.begin(), lines.end(),
                       [](const line_of_driver& l) { return l.what == "write" && l.value == 0.5; }) > 20;
}
bool ends_with(const std::filesystem::path& log, const std::string& what) {
  const std::vector<line_of_driver> lines = lines_of(log);
  return !lines.empty() && lines.back().what == what;
}

// Gone, or over and not yet taken note of by whoever has to.
bool is_over(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  if (!std::getline(in, line)) return true;
  const std::size_t end = line.rfind(')');
  return end == std::string::npos || line.compare(end, 3, ") Z") == 0;
}

// From the last push on: zero, then disarmed. @return how long after the last push, ms
void look_at_silence(const std::vector<line_of_driver>& lines, std::int64_t& zero_ms, std::int64_t& disarmed_ms) {
  zero_ms = disarmed_ms = -1;
  std::int64_t last_push_ms = 0;
  for (const line_of_driver& l : lines) {
    if (l.what == "write" && l.value != 0.0) {
      last_push_ms = l.at_ms;
      zero_ms = disarmed_ms = -1;
    }
    if (l.what == "write" && l.value == 0.0 && zero_ms < 0) zero_ms = l.at_ms - last_push_ms;
    if (l.what == "disarm" && disarmed_ms < 0) disarmed_ms = l.at_ms - last_push_ms;
  }
}

TEST(child, a_program_that_is_killed_leaves_no_force_and_no_process_behind) {
  const std::filesystem::path log = test_support::driver_folder("killed") / "log";
  const pid_t program = start_program(log, 0);
  ASSERT_GT(program, 0);
  const bool pushed = wait_until(20s, [&] { return pushes(log); });
  ::kill(program, SIGKILL);
  ::waitpid(program, nullptr, 0);
  ASSERT_TRUE(pushed);
  EXPECT_TRUE(wait_until(10s, [&] { return ends_with(log, "close"); }));
  const std::vector<line_of_driver> lines = lines_of(log);
  std::int64_t zero_ms = 0;
  std::int64_t disarmed_ms = 0;
  look_at_silence(lines, zero_ms, disarmed_ms);
  EXPECT_GE(zero_ms, 0);
  EXPECT_GE(disarmed_ms, 0);
  std::printf("zero %ld ms and disarmed %ld ms after the last push of a program that was killed\n",
              static_cast<long>(zero_ms), static_cast<long>(disarmed_ms));
  EXPECT_LT(zero_ms, 2000);
  EXPECT_TRUE(wait_until(10s, [&] { return is_over(lines.back().process); })) << "the driver's process lives on";
}

TEST(child, a_program_that_is_stopped_is_disarmed_and_finds_its_device_in_fault) {
  const std::filesystem::path log = test_support::driver_folder("stopped") / "log";
  const pid_t program = start_program(log, 42);
  ASSERT_GT(program, 0);
  const bool pushed = wait_until(20s, [&] { return pushes(log); });
  ::kill(program, SIGSTOP);
  EXPECT_TRUE(pushed);
  EXPECT_TRUE(wait_until(10s, [&] { return ends_with(log, "disarm"); }));
  std::int64_t zero_ms = 0;
  std::int64_t disarmed_ms = 0;
  look_at_silence(lines_of(log), zero_ms, disarmed_ms);
  std::printf("zero %ld ms and disarmed %ld ms after the last push of a program that was stopped\n",
              static_cast<long>(zero_ms), static_cast<long>(disarmed_ms));
  EXPECT_GE(zero_ms, 15) << "its last command was good for 20 ms";
  EXPECT_LT(zero_ms, 2000);
  EXPECT_GE(disarmed_ms, zero_ms + 50);
  EXPECT_LT(disarmed_ms, 4000);
  ::kill(program, SIGCONT);
  int how = 0;
  ASSERT_TRUE(wait_until(10s, [&] { return ::waitpid(program, &how, WNOHANG) == program; }));
  EXPECT_TRUE(WIFEXITED(how));
  EXPECT_EQ(WEXITSTATUS(how), 42) << "91: the device was not in fault for its program's silence";
}

}  // namespace
}  // namespace asperity::plugin
