// The race: every contender feels the same poses in one process; some of the poses are judged by the originals.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "contender.hpp"
#include "originals.hpp"
#include "touching_path.hpp"

namespace asperity::rivals {

/// A pose with its truth.
struct judged_pose {
  std::size_t index = 0;  ///< in the path
  parting truth;

  /// Whether another direction, further away than `elsewhere_rad`, is not nearly as short: only then is the direction
  /// of the shortest way out one that can be missed.
  [[nodiscard]] bool has_direction() const noexcept { return truth.elsewhere_m > 1.1 * truth.depth_m; }
};

/// What became of one contender.
struct outcome {
  std::string name;
  bool ours = false;
  std::string fault;             ///< why it could not be made; empty: it was
  std::vector<double> seconds;   ///< of each pose, processor time of the thread
  double made_s = 0.0;           ///< processor time of all threads
  std::size_t memory_bytes = 0;  ///< what it holds, its bodies among it
  double contacts = 0.0;         ///< mean
  std::size_t missed = 0;        ///< judged poses where it feels nothing, and the originals overlap by `felt_from_m`
  // One of each judged pose; where it feels nothing, its depth is 0:
  std::vector<double> depth_error_m;  ///< reported depth less the shortest way out
  std::vector<double> outside_m;      ///< how far the reported depth is outside of [at_least_m, depth_m]
  std::vector<double> judged_s;       ///< the pose's time
  std::vector<double>
      turned_rad;  ///< force and shortest way out; only poses that have a direction, and where it feels a force
};
inline constexpr double felt_from_m = 50e-6;

/// One pair's race.
struct race {
  std::string pair;
  std::size_t probe_triangles = 0, fixed_triangles = 0;
  std::size_t poses = 0;
  std::vector<judged_pose> judged;
  std::vector<outcome> outcomes;
};

struct race_settings {
  std::size_t poses = 400;
  std::size_t judged = 40;  ///< evenly spread over the path
  std::uint64_t seed = 1;
};

/// Told of every stage and its share; false ends the race.
using race_progress = std::function<bool(std::string_view what, double done)>;

/// Contenders run one after another, each over the whole path, after one pose that is not timed.
/// @return cancelled. A contender that cannot be made says why in its outcome.
[[nodiscard]] result<race> run_race(const body_pair& bodies, std::span<const entry> contenders,
                                    const race_settings& settings, const race_progress& told);

/// How a contender's answer compares with the truth; added to the outcome.
void judge(const felt& answer, double seconds, const judged_pose& pose, outcome& into);

}  // namespace asperity::rivals
