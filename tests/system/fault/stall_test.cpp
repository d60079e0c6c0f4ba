// A session on the real clock that is stopped and continued, or has to share one core with busy neighbours: what was
// sent, as the recording tells it, against the same session on the virtual clock.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <sched.h>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "command_process.hpp"

namespace fault {
namespace {

// Of the simulated device, and of a command.
constexpr double slew_n_per_s = 5000.0;
constexpr double longest_slew_s = 0.004;
constexpr double valid_s = 0.020;
constexpr double settle_s = 0.050;

struct sent_tick {
  double time_s = 0.0;
  std::array<double, 3> force_n{};
  [[nodiscard]] double length() const { return std::hypot(force_n[0], force_n[1], force_n[2]); }
};

std::vector<sent_tick> sent(const std::string& table) {
  std::istringstream lines(table);
  std::string line;
  std::getline(lines, line);
  std::vector<std::string> names;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) names.push_back(name);
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const std::array<std::size_t, 4> wanted{column("time_s"), column("hand_fx_n"), column("hand_fy_n"),
                                          column("hand_fz_n")};
  std::vector<sent_tick> out;
  while (std::getline(lines, line)) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::strtod(cell.c_str(), nullptr));
    if (row.size() != names.size()) break;
    out.push_back({row[wanted[0]], {row[wanted[1]], row[wanted[2]], row[wanted[3]]}});
  }
  return out;
}

double peak_n(const std::vector<sent_tick>& ticks) {
  double most = 0.0;
  for (const sent_tick& t : ticks) most = std::max(most, t.length());
  return most;
}

/// Every step is within the slew, from zero where the command before had expired; after that nothing for a while.
void expect_no_steps(const std::vector<sent_tick>& ticks) {
  double quiet_until_s = 0.0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const double gap_s = ticks[i].time_s - ticks[i - 1].time_s;
    const bool expired = gap_s > valid_s + 1e-9;
    if (expired) quiet_until_s = ticks[i].time_s + settle_s;
    std::array<double, 3> change{};
    for (std::size_t k = 0; k < 3; ++k) {
      change[k] = ticks[i].force_n[k] - (expired ? 0.0 : ticks[i - 1].force_n[k]);
    }
    // The last tick may disarm the device, which then puts out zero at once.
    if (ticks[i].length() > 0.0) {
      EXPECT_LE(std::hypot(change[0], change[1], change[2]), slew_n_per_s * std::min(gap_s, longest_slew_s) + 1e-9)
          << ticks[i].time_s << " s";
      ASSERT_GE(ticks[i].time_s, quiet_until_s - 1e-9);
    }
  }
}

class stalled_session : public command_test {
 protected:
  [[nodiscard]] static arguments session(const char* seconds) {
    const std::string pin = (small_models() / "pin.glb").string();
    return {"run", "--probe", pin, "--fixed", pin, "--seconds", seconds};
  }

  /// What the same hand feels where nothing is late.
  [[nodiscard]] double unstalled_peak_n() const {
    arguments args = session("2.5");
    args.insert(args.end(), {"--record", path("virtual.csv")});
    EXPECT_EQ(run(args).exit_status, 0);
    return peak_n(sent(read("virtual.csv")));
  }

  /// Starts the command on the real clock, on one core where `pinned`.
  [[nodiscard]] pid_t start(const char* seconds, bool pinned) const {
    arguments args = session(seconds);
    args.insert(args.end(), {"--clock", "real", "--record", path("real.csv")});
    args.insert(args.begin(), ASPERITY_COMMAND);
    std::filesystem::remove(path("text"));  // of a command before
    const pid_t child = fork();
    if (child != 0) return child;
    const int out = open(path("text").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    if (pinned) pin();
    std::vector<char*> argv;
    for (std::string& a : args) argv.push_back(a.data());
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(126);
  }

  static void pin() {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(0, &one);
    sched_setaffinity(0, sizeof one, &one);
  }

  static void sleep_s(double s) { std::this_thread::sleep_for(std::chrono::duration<double>(s)); }

  /// Until the command says what its threads got, which is when both run: what comes before takes as long as it takes.
  void wait_for_both_loops() const {
    for (int i = 0; i < 6000 && read("text").find("real time") == std::string::npos; ++i) sleep_s(0.01);
  }

  /// 0, or 1 where the gate shut. Anything else is a failure of its own.
  void expect_ended(pid_t child) const {
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status)) << read("text");
    EXPECT_LE(WEXITSTATUS(status), 1) << read("text");
  }

  void expect_bounds(double unstalled_n) const {
    const std::vector<sent_tick> ticks = sent(read("real.csv"));
    ASSERT_GT(ticks.size(), 100U) << read("text");
    // The hand is held back by less while nothing pushes: it then lies deeper when the force returns.
    EXPECT_LE(peak_n(ticks), 1.5 * unstalled_n) << read("text");
    EXPECT_GT(peak_n(ticks), 0.2 * unstalled_n) << "nothing was felt before the stalls: " << read("text");
    expect_no_steps(ticks);
  }
};

TEST_F(stalled_session, stopped_and_continued) {
  const double unstalled_n = unstalled_peak_n();
  for (const double stop_s : {0.03, 0.15, 0.6}) {
    const pid_t child = start("1.7", false);
    wait_for_both_loops();
    sleep_s(0.5);
    for (int i = 0; i < 2; ++i) {
      kill(child, SIGSTOP);
      sleep_s(stop_s);
      kill(child, SIGCONT);
      sleep_s(0.35);
    }
    expect_ended(child);
    expect_bounds(unstalled_n);
    const bool shut = read("text").find("device loop stalled") != std::string::npos;
    EXPECT_TRUE(shut || stop_s < 0.3) << read("text");
  }
}

TEST_F(stalled_session, with_busy_neighbours_on_one_core) {
  const double unstalled_n = unstalled_peak_n();
  std::array<pid_t, 6> busy{};
  for (pid_t& neighbour : busy) {
    neighbour = fork();
    if (neighbour != 0) continue;
    pin();
    alarm(20);
    for (volatile bool busily = true; busily;) {
    }
  }
  const pid_t child = start("1.5", true);
  expect_ended(child);
  for (const pid_t neighbour : busy) {
    kill(neighbour, SIGKILL);
    waitpid(neighbour, nullptr, 0);
  }
  expect_bounds(unstalled_n);
}

}  // namespace
}  // namespace fault
