// What is pressed: any rule from poses to wrenches, by name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "presses/press_pairs.hpp"
#include "presses/run_press.hpp"

namespace asperity::presses {

/// A contact law: a renderer, or a formula to compare it with.
struct press_law {
  std::string name;
  /// For two bodies and the stiffness of a face, N/m.
  std::function<result<step_function>(const press_body& probe, const press_body& fixed, double stiffness_n_per_m)> make;
};

/// The default renderer.
[[nodiscard]] press_law default_renderer_law();
/// The force that the true depth of the originals has: k times the shortest way out that a search finds, along it. It
/// is right for every pair, and far too slow for a tick.
[[nodiscard]] press_law true_exit_law();

/// Presses one pair under one law `touches` times, the touches of the day's seed.
/// @param originals, finder of the pair
/// @param step_m of the press
[[nodiscard]] press_row press_one_pair(const press_pair& pair, const press_body& probe, const press_body& fixed,
                                       const step_function& step, std::uint64_t seed, int touches, double step_m);

}  // namespace asperity::presses
