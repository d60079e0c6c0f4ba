// The scene of the paper's Fig. 8: two identical striped blocks, interlocked, the upper one turned about the contact
// normal; and what geometry says must happen.
#pragma once

#include <cstdint>
#include <vector>

#include "striped_block.hpp"
#include "workbench.hpp"

namespace asperity::experiment {

/// How the upper block is turned.
struct turning {
  double reach_rad = 0.14;       ///< from 0 to +reach, to -reach and back to 0
  double speed_rad_per_s = 0.2;  ///< at the hand
  double parts = 4.0;            ///< how much of that way, reach by reach
  std::int64_t contact_period_ns = 2'000'000;
};

/// Force with which the hand presses the upper block down, N. It does not hold the block's height.
inline constexpr double turned_block_press_n = 1.0;

/// One device tick of a turn, once the block lies at rest.
struct turned_sample {
  double time_s = 0.0;
  double hand_rad = 0.0;    ///< how far the hand has turned
  double angle_rad = 0.0;   ///< how far the block has
  double rise_m = 0.0;      ///< of the block's centre, over its height at rest
  double force_n = 0.0;     ///< of the contact on the block, along z: away from the lower block
  double torque_n_m = 0.0;  ///< of the contact on the block, about z
};

/// Turns the striped block on its twin with this renderer. @param bodies  scene: block on block
[[nodiscard]] result<std::vector<turned_sample>> turn_block(any_renderer feel, const turning& how);

/// The scene: the block on a second one.
[[nodiscard]] result<scene> block_on_block(workbench& bench);
/// Where the upper block lies so that the coarse surfaces of both just meet, their ridges interlocked.
[[nodiscard]] pose upper_block();

/// Angle from which on somewhere two crests meet, lambda / (2 w), rad.
[[nodiscard]] double saturation_angle_rad() noexcept;
/// Torque per newton of normal force about n that geometry asks for, m: minus the slope of the rise. Closed form
/// a K w cos(K w theta / 2) up to saturation, then none; negative for a positive angle.
/// @source paper, Fig. 8; the bounds are ours
[[nodiscard]] double torque_arm_m(double angle_rad) noexcept;

/// Which depth of two surfaces a spring is compressed by.
enum class depth_kind : std::uint8_t {
  largest,  ///< the largest overlap
  soft,     ///< the paper's contacts with the soft maximum: tau ln of the mean of exp(overlap / tau)
  way_out,  ///< the default: the largest overlap as well, over relief that a way out takes from where it began
};
/// The one that a renderer of these options goes by.
[[nodiscard]] depth_kind depth_of(const command::render_options& options);

/// The rise of the upper block under a constant force, by brute force over both surfaces as the formulas of the
/// full-resolution block give them: no mesh, no texture, no window and nothing else of the library has a part in it.
/// The softness of the soft kind is the documented one, 2 % of the relief.
class rise_by_brute_force {
 public:
  explicit rise_by_brute_force(double reach_rad, depth_kind kind);
  /// m, interpolated between angles 2.5 mrad apart. @pre |angle| <= reach
  [[nodiscard]] double operator()(double angle_rad) const noexcept;
  /// Its slope by the angle, taken over `step_rad` to either side, m/rad. @pre |angle| + step <= reach
  [[nodiscard]] double slope(double angle_rad, double step_rad) const noexcept {
    return ((*this)(angle_rad + step_rad) - (*this)(angle_rad - step_rad)) / (2.0 * step_rad);
  }

 private:
  std::vector<double> rise_m_;
};

}  // namespace asperity::experiment
