// asperity_soak [--hours H]: a day of virtual time in one session; its clock, its memory and its energy books.
// An interrupt (Ctrl-C) ends it early, with the report of the time that was run.
#include "session/soak/soak.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using namespace asperity;

volatile std::sig_atomic_t stop_asked = 0;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double hours(std::int64_t ns) { return 1e-9 / 3600.0 * static_cast<double>(ns); }

/// Where it is, twenty times, and whether to go on.
class progress_lines {
 public:
  explicit progress_lines(const soak::options& o) : options_(o) {}

  [[nodiscard]] bool operator()(std::int64_t now_ns) {
    const double done = static_cast<double>(now_ns) / static_cast<double>(options_.length_ns);
    if (++calls_ % 50 == 0) {
      const double wall_s = seconds_since(start_);
      std::printf("%6.2f of %.2f h, %5.0f s; about %.0f s to go\n", hours(now_ns), hours(options_.length_ns), wall_s,
                  wall_s / done - wall_s);
      std::fflush(stdout);
    }
    return stop_asked == 0;
  }

 private:
  soak::options options_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  int calls_ = 0;
};

void print(const soak::report& r, double wall_s) {
  const auto line = [](const char* name, const soak::book& b) {
    std::printf("%-8s residual %.3g J of a turnover of %.6g J: %.2g\n", name, b.residual_j, b.turnover_j, b.relative());
  };
  std::printf("\n%.3f h of virtual time in %.0f s, %.2f us per device tick\n", hours(r.length_ns), wall_s,
              1e6 * wall_s / static_cast<double>(r.device_ticks));
  std::printf(
      "ticks    %llu device, %llu contact; %.1f %% of the device ticks in contact, %llu off beat, %llu not ok\n",
      static_cast<unsigned long long>(r.device_ticks), static_cast<unsigned long long>(r.contact_ticks),
      100.0 * static_cast<double>(r.touching) / static_cast<double>(r.device_ticks),
      static_cast<unsigned long long>(r.off_beat), static_cast<unsigned long long>(r.not_ok));
  std::printf("memory   resident %lld pages, then %lld; heap %lld bytes, then %lld\n",
              static_cast<long long>(r.before.resident_pages), static_cast<long long>(r.after.resident_pages),
              static_cast<long long>(r.before.heap_bytes), static_cast<long long>(r.after.heap_bytes));
  line("port", r.port);
  line("plant", r.plant);
  line("probe", r.probe);
  std::printf(
      "energy   the hand put in %.6g J: %.6g J damped in the handle, %.6g J between handle and probe, %.6g J in the "
      "contact, %.6g J in the implicit steps\n",
      r.plant_parts.by_hand_j, r.plant_parts.damped_j, r.between_j, -r.probe_parts.by_contact_j,
      r.plant_parts.numerical_j + r.probe_parts.numerical_j);
}

}  // namespace

int main(int argc, char** argv) {
  double length_h = 24.0;
  if (argc == 3 && std::strcmp(argv[1], "--hours") == 0) {
    length_h = std::strtod(argv[2], nullptr);
  } else if (argc != 1) {
    length_h = 0.0;
  }
  if (!(length_h >= 0.01 && length_h <= 1000.0)) {
    std::fprintf(stderr, "usage: asperity_soak [--hours H], H from 0.01 to 1000\n");
    return 2;
  }
  soak::options options;
  options.length_ns = static_cast<std::int64_t>(length_h * 3600.0 * 1e3) * options.device_period_ns;

  // A short session first: how fast this machine is.
  soak::options trial;
  trial.length_ns = 20'000'000'000;
  auto start = std::chrono::steady_clock::now();
  simulated_device trial_device(soak::tapping_hand());
  if (const auto tried = soak::run(trial, trial_device, [](std::int64_t) { return true; }); !tried) {
    std::fprintf(stderr, "soak: %s\n", tried.error().message.c_str());
    return 1;
  }
  const double rate = static_cast<double>(trial.length_ns) * 1e-9 / seconds_since(start);
  std::printf("%.2f h of virtual time at %.0f times real time: about %.0f s\n", length_h, rate,
              length_h * 3600.0 / rate);
  std::fflush(stdout);

  start = std::chrono::steady_clock::now();
  std::signal(SIGINT, [](int) { stop_asked = 1; });
  simulated_device device(soak::tapping_hand());
  const result<soak::report> report = soak::run(options, device, progress_lines(options));
  if (!report) {
    std::fprintf(stderr, "soak: %s\n", report.error().message.c_str());
    return 1;
  }
  print(*report, seconds_since(start));
  const std::vector<std::string> faults = soak::faults_of(*report, options);
  for (const std::string& f : faults) std::printf("FAULT    %s\n", f.c_str());
  std::printf("%s\n", faults.empty() ? "soak: passed" : "soak: failed");
  return faults.empty() ? 0 : 1;
}
