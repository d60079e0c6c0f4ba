// The study of one pair of bodies: the same motions felt by the default and by the paper's.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "asperity/window/window_renderer.hpp"
#include "law/contact_study/jumps.hpp"

namespace asperity::contact_study {

/// What one formulation does from one touching pose.
struct pose_result {
  std::uint64_t index = 0;                      ///< of the pose, see find_touching_pose()
  std::array<jumps, all_motions.size()> moved;  ///< in the order of all_motions
  double loop = 0.0;                            ///< see loop_work()
};

/// All poses of a pair. The two lists go together entry by entry.
struct pair_result {
  std::string pair;
  std::vector<pose_result> least_motion, window;
  std::size_t passed_by = 0;  ///< seeded poses that met nothing
};

struct study_options {
  std::size_t poses = 60;
  std::uint64_t seed = 1;
  std::uint64_t first_index = 0;
  bool with_window = true;
  /// Told after each pose; returning false ends the study with what it has.
  std::function<bool(const pair_result&)> progress;
};

[[nodiscard]] inline pose_result study_pose(const feel_function& feel, const touching_pose& start, std::uint64_t index,
                                            double stiffness_n_per_m, bool look_closer) {
  pose_result out;
  out.index = index;
  for (std::size_t m = 0; m < all_motions.size(); ++m) {
    out.moved[m] = measure_jumps(feel, start, all_motions[m], stiffness_n_per_m, look_closer);
  }
  out.loop = loop_work(feel, start);
  return out;
}

/// The paper's formulation with room for every contact: where contacts are dropped, the force jumps for that alone.
[[nodiscard]] inline result<window_renderer> make_roomy_window_renderer(const scene& bodies) {
  window_renderer_settings settings;
  settings.limits = {.contacts = 128, .triangles = 262144};
  return make_window_renderer(bodies, settings);
}

/// Both renderers of a pair. The fixed body is the world.
class pair_of_renderers {
 public:
  /// @return what make_renderer() and make_window_renderer() refuse
  [[nodiscard]] static result<pair_of_renderers> make(const scene& bodies) {
    result<least_motion_renderer> least_motion = build_renderer(bodies);
    if (!least_motion) return least_motion.error();
    result<window_renderer> window = make_roomy_window_renderer(bodies);
    if (!window) return window.error();
    return pair_of_renderers(std::move(least_motion).value(), std::move(window).value());
  }

  [[nodiscard]] least_motion_renderer& least_motion() noexcept { return least_motion_; }
  [[nodiscard]] window_renderer& window() noexcept { return window_; }

 private:
  pair_of_renderers(least_motion_renderer least_motion, window_renderer window)
      : least_motion_(std::move(least_motion)), window_(std::move(window)) {}

  least_motion_renderer least_motion_;
  window_renderer window_;
};

[[nodiscard]] inline pair_result study_pair(const std::string& name, pair_of_renderers& renderers,
                                            const study_options& options) {
  pair_result out;
  out.pair = name;
  const feel_function feel_least_motion = feel_with(renderers.least_motion()),
                      feel_window = feel_with(renderers.window());
  const double k = renderers.least_motion().force().settings().stiffness_n_per_m;
  for (std::uint64_t index = options.first_index; out.least_motion.size() < options.poses; ++index) {
    const std::optional<touching_pose> start = find_touching_pose(renderers.least_motion(), options.seed, index);
    if (!start) {
      ++out.passed_by;
      continue;
    }
    out.least_motion.push_back(study_pose(feel_least_motion, *start, index, k, true));
    if (options.with_window) out.window.push_back(study_pose(feel_window, *start, index, k, false));
    if (options.progress && !options.progress(out)) break;
  }
  return out;
}

/// Middle and largest of some values.
struct spread {
  double median = 0.0, worst = 0.0;
};

[[nodiscard]] inline spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {values[values.size() / 2], values.back()};
}

/// One line of the table: one motion of one pair in one formulation.
struct motion_summary {
  spread force_1khz, force_10khz, force_ratio, torque_ratio;
  std::size_t over_limit = 0;  ///< motions with a ratio, of force or torque, above ratio_limit
  std::size_t with_steps = 0;  ///< motions that have a step
  double largest_step_n = 0.0;
  bool resolved = true;          ///< it was looked for steps in all of them
  std::uint64_t worst_pose = 0;  ///< where the ratio, of force or torque, is largest
  bool ok = true;                ///< every tick was
};

[[nodiscard]] inline motion_summary summarise(const std::vector<pose_result>& poses, motion m) {
  std::vector<double> force_1khz, force_10khz, force_ratio, torque_ratio;
  motion_summary out;
  double worst = 0.0;
  for (const pose_result& p : poses) {
    const jumps& j = p.moved[static_cast<std::size_t>(m)];
    force_1khz.push_back(j.at_1khz.force);
    force_10khz.push_back(j.at_10khz.force);
    force_ratio.push_back(j.force_ratio());
    torque_ratio.push_back(j.torque_ratio());
    const double ratio = std::max(j.force_ratio(), j.torque_ratio());
    if (j.over_limit()) ++out.over_limit;
    out.resolved = out.resolved && j.left;
    if (j.left && j.left->count > 0) ++out.with_steps;
    if (j.left) out.largest_step_n = std::max(out.largest_step_n, j.left->largest_n);
    if (ratio > worst) worst = ratio, out.worst_pose = p.index;
    out.ok = out.ok && j.at_1khz.ok && j.at_10khz.ok;
  }
  out.force_1khz = spread_of(std::move(force_1khz));
  out.force_10khz = spread_of(std::move(force_10khz));
  out.force_ratio = spread_of(std::move(force_ratio));
  out.torque_ratio = spread_of(std::move(torque_ratio));
  return out;
}

struct loop_summary {
  spread work;
  std::size_t over_limit = 0;
  std::uint64_t worst_pose = 0;
};

[[nodiscard]] inline loop_summary summarise_loops(const std::vector<pose_result>& poses) {
  loop_summary out;
  std::vector<double> work;
  for (const pose_result& p : poses) {
    if (p.loop > loop_limit) ++out.over_limit;
    if (work.empty() || p.loop > *std::max_element(work.begin(), work.end())) out.worst_pose = p.index;
    work.push_back(p.loop);
  }
  out.work = spread_of(std::move(work));
  return out;
}

}  // namespace asperity::contact_study
