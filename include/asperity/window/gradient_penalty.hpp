// The paper's force model: a spring along the gradient of the penetration depth.
#pragma once

#include <cstdint>
#include <numbers>

#include "asperity/core/export.hpp"
#include "asperity/render/force_model.hpp"

namespace asperity {

/// Which depth the spring is compressed by.
enum class depth_value : std::uint8_t {
  soft,  ///< the potential that the gradient belongs to: conserves energy
  hard,  ///< the deepest sample: no bias, for measurements; loops gain or lose 0.1 to 2 %
};

struct gradient_penalty_settings {
  double stiffness_n_per_m = 2000.0;
  depth_value value = depth_value::soft;
  double same_direction_rad = 25.0 * std::numbers::pi / 180.0;   ///< contacts within this angle share one spring
  double other_direction_rad = 60.0 * std::numbers::pi / 180.0;  ///< beyond this angle each has its own
};

/// Wrench and stiffness of contacts as springs along their depth gradients:
///
///     W = sum_i s_i (-k d_i g_i),   J = sum_i s_i (-k (g_i g_i^T + d_i C_i)),   d_i = max(depth of contact i, 0).
///
/// The shares s_i keep the stiffness of a face the same into however many contacts the finder cuts it. Contacts with
/// the same direction on the same body share one spring, contacts with clearly different directions have one each:
///
///     s_i = M_i / sum_j K_ij M_j,   M_i = area_i d_i^2,
///
/// K_ij falls smoothly from 1 to 0 as the angle between n_i and n_j grows from 25 to 60 degrees, and is 0 for different
/// bodies. M_i goes to zero with the square of the depth, so a contact that appears or vanishes at zero depth, or at
/// zero area, does so without a jump. One contact alone has share 1, which is the paper's model. J leaves out how the
/// shares change with the pose: that term has no definite sign, and is zero for one contact.
/// @rt safe   @source paper Eqs. 3 to 6; science, sections 3.3 and 3.4 (the shares are ours, the paper adds springs up)
class ASPERITY_API gradient_penalty {
 public:
  using policy_tag = force_tag;

  explicit gradient_penalty(const gradient_penalty_settings& settings = {}) noexcept : settings_(settings) {}

  /// Adds up the contacts. @pre depths.size() >= contacts.size()
  /// @return ok | not_ready (sizes do not fit) | not_finite (NaN or infinity in a depth); the last two leave zeros
  [[nodiscard]] status accumulate(const scene_pose&, const contact_set& contacts, std::span<const penetration> depths,
                                  force_report& out) const noexcept;

  [[nodiscard]] const gradient_penalty_settings& settings() const noexcept { return settings_; }

 private:
  gradient_penalty_settings settings_;
};

static_assert(force_model<gradient_penalty>);

}  // namespace asperity
