// What is pressed: any rule from poses to wrenches, by name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "law/presses/press_pairs.hpp"
#include "law/presses/press_session.hpp"
#include "law/presses/rest_session.hpp"
#include "law/presses/run_press.hpp"

namespace asperity::presses {

/// A contact law: a renderer, or a formula to compare it with.
struct press_law {
  std::string name;
  /// For two bodies and the stiffness of a face, N/m.
  /// Empty where the law is for sessions only.
  std::function<result<step_function>(const press_body& probe, const press_body& fixed, double stiffness_n_per_m)> make;
  /// The same for sessions, with the stiffness J; empty where the law is no renderer.
  std::function<result<render_function>(const press_body& probe, const press_body& fixed, double stiffness_n_per_m)>
      render;
};

/// "least-motion": the default renderer.
[[nodiscard]] press_law least_motion_renderer_law();
/// "window": the paper's renderer.
[[nodiscard]] press_law window_renderer_law();
/// "planes": the renderer for control loops. In sessions only: it holds the probe by its support planes, and its force
/// is meant for a probe at the surface.
/// @param contact_period_s of the loop that its gaps reach far enough for
[[nodiscard]] press_law plane_renderer_law(double contact_period_s = 1e-3);
/// "exit": the force that the true depth of the originals has, k times the shortest way out that a search finds, along
/// it. It is right for every pair, and far too slow for a tick.
[[nodiscard]] press_law true_exit_law();
/// All of these.
[[nodiscard]] std::vector<press_law> known_laws(double contact_period_s = 1e-3);

/// Which presses of a pair.
struct press_choice {
  std::uint64_t seed = 1;
  int touches = 24;
  int first = 0;         ///< of the seed's touches, so many are found and left out
  double step_m = 1e-4;  ///< of a press, but at most a quarter of it
};

/// Presses one pair under one law.
[[nodiscard]] press_row press_one_pair(const press_pair& pair, const press_body& probe, const press_body& fixed,
                                       const step_function& step, const press_choice& which);

/// Sessions of one pair under a renderer.
[[nodiscard]] session_row press_sessions(const press_pair& pair, const press_body& probe, const press_body& fixed,
                                         const render_function& render, const press_choice& which,
                                         const session_rules& rules = {});

/// Hands at rest on one pair under a renderer, each by rules drawn anew.
/// @param plane_stiffness_n_per_m of the sessions' contact law
[[nodiscard]] rest_row rest_sessions(const press_pair& pair, const press_body& probe, const press_body& fixed,
                                     const render_function& render, const press_choice& which,
                                     double plane_stiffness_n_per_m = contact_law{}.stiffness_n_per_m);

}  // namespace asperity::presses
