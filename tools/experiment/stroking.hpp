// A stylus with a ball for its tip, stroked over relief on plates: what roughness and patterns have in common.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "experiment.hpp"
#include "trial.hpp"

namespace asperity::experiment {

/// A stylus whose tip is a ball of this radius, 0.5 to 3 mm. The coarse body is a shank of twelve triangles; the ball
/// is fine geometry under it, down to where it is as steep as 68 degrees, and a cone from there on.
[[nodiscard]] result<model_ptr> bake_stylus(workbench& bench, double radius_m);

/// A plate with its middle in the origin, 4 mm thick, and heights over its upper side at z = 0.
/// @param name tells it from every other model, its numbers included
[[nodiscard]] result<model_ptr> bake_plate(workbench& bench, const std::string& name, const vec2& size_m,
                                           std::uint32_t texture_size, std::function<double(const vec2&)> height_m);

/// A straight way of the hand, from where the last one ended.
struct stroke {
  vec2 to_m{0.0};
  double speed_m_per_s = 0.06;
  double push_n = 0.6;  ///< straight down, all the way
  int felt = -1;        ///< a number for what is felt on the way; negative: only to get there
};

/// How the hand strokes.
struct stroking {
  vec2 from_m{0.0};
  std::vector<stroke> strokes;
  std::int64_t contact_period_ns = 1'000'000;
  bool contact_one_period_late = false;
  bool hold_wrench = false;
};

/// One stroke as it was felt, sampled at the device's rate from a fifth of the way to near its end.
struct felt_stroke {
  int felt = 0;
  double sample_s = 1e-3;
  std::vector<double> x_m, z_m;                         ///< of the hand
  std::vector<double> along_m_per_s2, normal_m_per_s2;  ///< accelerations of the hand
  std::vector<double> along_n, normal_n;                ///< what the probe is pushed with by the plate
};

/// A hand and a handle of 100 g: drawn along by a soft spring, held across by a stiff one, pressed down by a weight.
[[nodiscard]] result<std::vector<felt_stroke>> stroke_plate(workbench& bench, const variant& kind,
                                                            const model_ptr& stylus, const model_ptr& plate,
                                                            const stroking& how);

/// Root of the mean square about the mean.
[[nodiscard]] double rms_about_mean(const std::vector<double>& values);

}  // namespace asperity::experiment
