#include "race.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <glm/geometric.hpp>
#include <malloc.h>
#include <memory>
#include <utility>

namespace asperity::rivals {
namespace {

double clock_s(clockid_t which) {
  timespec t{};
  clock_gettime(which, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Bytes that the program holds on its heap, large blocks that the system lends it included.
std::size_t heap_bytes_in_use() {
  const auto m = mallinfo2();
  return m.uordblks + m.hblkhd;
}

error cancelled() { return {error_code::cancelled, "the race was ended before it was over"}; }

}  // namespace

void judge(const felt& answer, double seconds, const judged_pose& pose, outcome& into) {
  const parting& truth = pose.truth;
  if (!answer.touches && truth.at_least_m > felt_from_m) ++into.missed;
  const double reported_m = answer.touches ? answer.depth_m : 0.0;
  into.depth_error_m.push_back(reported_m - truth.depth_m);
  into.outside_m.push_back(std::max({0.0, truth.at_least_m - reported_m, reported_m - truth.depth_m}));
  into.judged_s.push_back(seconds);
  const double force = glm::length(answer.force_w);
  if (pose.has_direction() && force > 0.0) {
    into.turned_rad.push_back(std::acos(std::clamp(-glm::dot(answer.force_w, truth.n_ab_w) / force, -1.0, 1.0)));
  }
}

result<race> run_race(const body_pair& bodies, std::span<const entry> contenders, const race_settings& settings,
                      const race_progress& told) {
  race out;
  out.pair = bodies.name;
  out.probe_triangles = bodies.probe.triangles.size();
  out.fixed_triangles = bodies.fixed.triangles.size();
  std::vector<pressed_pose> path;
  {
    if (!told(bodies.name + ", path", 0.0)) return cancelled();
    originals truth(bodies.probe, bodies.fixed);
    path = make_touching_path(truth, bodies.probe, bodies.fixed, settings.poses, settings.seed);
    out.poses = path.size();
    if (path.empty()) {
      return error{error_code::invalid_argument, "the bodies of " + bodies.name + " pass each other by at every pose"};
    }
    const std::size_t judged = std::min(settings.judged, path.size());
    for (std::size_t i = 0; i < judged; ++i) {
      if (!told(bodies.name + ", truth", static_cast<double>(i) / static_cast<double>(judged))) return cancelled();
      const std::size_t index = i * path.size() / judged;
      out.judged.push_back({index, truth.part(path[index].T_wa, path[index].press_m)});
    }
  }
  for (const entry& e : contenders) {
    if (!told(bodies.name + ", " + e.name, 0.0)) return cancelled();
    outcome& o = out.outcomes.emplace_back();
    o.name = e.name;
    o.ours = e.ours;
    const std::size_t held = heap_bytes_in_use();
    const double begun = clock_s(CLOCK_PROCESS_CPUTIME_ID);
    result<contender_ptr> made = e.make(bodies);
    o.made_s = clock_s(CLOCK_PROCESS_CPUTIME_ID) - begun;
    if (!made) {
      o.fault = made.error().message;
      continue;
    }
    contender& one = **made;
    static_cast<void>(one.feel(path.front().T_wa));
    // What a first pose makes a library take is part of what it holds.
    o.memory_bytes = heap_bytes_in_use() - std::min(held, heap_bytes_in_use());
    if (e.ours) o.memory_bytes += memory_bytes(bodies.baked);
    std::vector<felt> answers;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (!told(bodies.name + ", " + e.name, static_cast<double>(i) / static_cast<double>(path.size()))) {
        return cancelled();
      }
      const double from = clock_s(CLOCK_THREAD_CPUTIME_ID);
      answers.push_back(one.feel(path[i].T_wa));
      o.seconds.push_back(clock_s(CLOCK_THREAD_CPUTIME_ID) - from);
      o.contacts += static_cast<double>(answers.back().contacts) / static_cast<double>(path.size());
    }
    for (const judged_pose& j : out.judged) judge(answers[j.index], o.seconds[j.index], j, o);
  }
  return out;
}

}  // namespace asperity::rivals
