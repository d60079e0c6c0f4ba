#include "fig9_frames.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>
#include <utility>

#include "asperity/window/convex_piece_finder.hpp"
#include "cpu_clock.hpp"
#include "trial.hpp"

namespace asperity::experiment {
namespace {

using models::benchmark;

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr std::int64_t frame_ns = 5'000'000;  // 200 Hz, the better end of the paper's
constexpr std::size_t frames = 500, frames_brief = 100;
constexpr std::size_t repeats = 3;

trial file_in_hole(std::size_t how_many) {
  trial t;
  // The blade's axis along the hole's; the middle of the blade in the part.
  const quat upright = exp_rotation({0.0, 0.5 * std::numbers::pi, 0.0});
  const vec3 hole(-28e-3, 0.0, 0.0);
  t.T_wa_start = {upright, hole};
  t.T_wb = {pose{}};
  t.script = [start = t.T_wa_start](double t_s) {
    const double aside_m = 2e-3 * std::clamp(t_s / 0.2, 0.0, 1.0), round = two_pi * 0.8 * t_s;
    hand_wish wish;
    wish.T_dh = start;
    wish.T_dh.rotation = exp_rotation(
        {0.02 * std::sin(two_pi * 0.9 * t_s), 0.02 * std::cos(two_pi * 0.7 * t_s), 0.1 * std::sin(two_pi * 0.5 * t_s)});
    wish.T_dh.position += vec3(aside_m * std::cos(round), aside_m * std::sin(round), 12e-3 * std::sin(two_pi * t_s));
    return wish;
  };
  t.contact_period_ns = frame_ns;
  t.seconds = 1e-9 * static_cast<double>(frame_ns) * static_cast<double>(how_many);
  return t;
}

// Each frame's median of a few runs: what else the machine does falls on single frames.
std::vector<double> frame_medians(std::vector<std::vector<double>>& runs) {
  std::vector<double> out;
  for (std::size_t i = 0; i < runs.front().size(); ++i) {
    std::vector<double> of_frame;
    for (const std::vector<double>& run : runs) of_frame.push_back(run[i]);
    std::sort(of_frame.begin(), of_frame.end());
    out.push_back(of_frame[of_frame.size() / 2]);
  }
  return out;
}

double frame_wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void time_collision(scrubbed& path, std::size_t how_often) {
  convex_piece_finder finder(path.bodies);
  contact_set found;
  const std::vector<pose> T_wb(1);
  std::vector<std::vector<double>> runs(how_often);
  for (std::vector<double>& run : runs) {
    path.contacts.clear();
    path.close_pairs.clear();
    for (const pose& T_wa : path.T_wa) {
      const double begin = command::cpu_seconds();
      static_cast<void>(finder.find({T_wa, T_wb}, found));
      run.push_back(command::cpu_seconds() - begin);
      path.contacts.push_back(static_cast<double>(found.size()));
      path.close_pairs.push_back(static_cast<double>(finder.statistics().close_pairs));
    }
  }
  path.collision_s = frame_medians(runs);
}

}  // namespace

std::string machine_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "a processor without a name";
}

result<scrubbed> scrub(workbench& bench) {
  result<model_ptr> file = bench.models().benchmark(benchmark::file);
  if (!file) return file.error();
  result<model_ptr> part = bench.models().benchmark(benchmark::cad_part);
  if (!part) return part.error();
  scrubbed path;
  path.bodies = {*file, {*part}};
  result<any_renderer> feel = bench.make_renderer(path.bodies, window_soft());
  if (!feel) return feel.error();
  const std::size_t wanted = bench.brief() ? frames_brief : frames;
  bench.progress("fig9, scrubbing", 0.0);
  const result<trial_log> log = run_trial(std::move(feel).value(), file_in_hole(wanted));
  if (!log) return log.error();
  constexpr std::size_t ticks_per_frame = frame_ns / device_period_ns;
  for (std::size_t i = 0; i < log->ticks.size(); i += ticks_per_frame) path.T_wa.push_back(log->ticks[i].T_wa);
  time_collision(path, repeats);
  return path;
}

result<timed_frames> time_frames(workbench& bench, const variant& kind, const scrubbed& path) {
  result<any_renderer> feel = bench.make_renderer(path.bodies, kind);
  if (!feel) return feel.error();
  const bool on_gpu = kind.may_be_missing;
  const std::size_t stride = on_gpu ? 25 : 1;
  const std::vector<pose> T_wb(1);
  std::vector<std::vector<double>> runs(on_gpu ? 1 : repeats);
  for (std::vector<double>& run : runs) {
    for (std::size_t i = 0; i < path.T_wa.size(); i += stride) {
      tick found;
      const double begin = on_gpu ? frame_wall_seconds() : command::cpu_seconds();
      static_cast<void>(feel->step({path.T_wa[i], T_wb}, found));
      run.push_back((on_gpu ? frame_wall_seconds() : command::cpu_seconds()) - begin);
    }
  }
  return timed_frames{kind, frame_medians(runs)};
}

}  // namespace asperity::experiment
