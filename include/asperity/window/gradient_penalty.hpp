// The paper's force model: a spring along the gradient of the penetration depth.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "asperity/render/force_model.hpp"
#include "asperity/window/direction_sameness.hpp"

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
/// The shares s_i keep the stiffness of a face what it is however many contacts the finder cuts it into. Contacts with
/// the same direction on the same body share one spring, contacts with clearly different directions have one each:
///
///     s_i = M_i / sum_j K_ij M_j,   M_i = area_i d_i^2,
///
/// K_ij falls smoothly from 1 to 0 as the angle between n_i and n_j grows from 25 to 60 degrees, and is 0 for different
/// bodies. M_i goes to zero with the square of the depth, so a contact that appears or vanishes at zero depth, or at
/// zero area, does so without a jump. One contact alone has share 1, which is the paper's model. J leaves out how the
/// shares change with the pose: that term has no definite sign, and is zero for one contact.
/// @rt safe   @source paper Eqs. 3 to 6; spec sections 3.3 and 3.4 (the shares are ours, the paper adds springs up)
class gradient_penalty {
 public:
  using policy_tag = force_tag;

  explicit gradient_penalty(const gradient_penalty_settings& settings = {}) noexcept
      : settings_(settings), sameness_(settings.same_direction_rad, settings.other_direction_rad) {}

  /// Adds up the contacts. @pre depths.size() >= contacts.size()
  /// @return ok | not_ready (sizes do not fit) | not_finite (NaN or infinity in a depth); the last two leave zeros
  [[nodiscard]] status accumulate(const contact_set& contacts, std::span<const penetration> depths,
                                  contact_force& out) const noexcept {
    out = {};
    if (depths.size() < contacts.size()) return status::not_ready;
    const std::span<const contact> list = contacts.contacts();
    contact_force sum;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const penetration& p = depths[i];
      if (!std::isfinite(depth(p)) || !std::isfinite(p.area_m2) || !is_finite(p.gradient)) return status::not_finite;
      const double own = share_mass(p);
      if (!(own > 0.0)) continue;
      double all = 0.0;
      for (std::size_t j = 0; j < list.size(); ++j) {
        if (list[j].body == list[i].body) {
          all += sameness_(list[i].window.n_ab_w, list[j].window.n_ab_w) * share_mass(depths[j]);
        }
      }
      const double k = settings_.stiffness_n_per_m * own / all;
      sum.on_probe_w += to_wrench(-k * depth(p) * p.gradient);
      add_outer(sum.stiffness, -k, p.gradient);
      sum.stiffness += -k * depth(p) * p.curvature;
    }
    if (!is_finite(sum.on_probe_w)) return status::not_finite;
    for (const double x : sum.stiffness.m) {
      if (!std::isfinite(x)) return status::not_finite;
    }
    out = sum;
    return status::ok;
  }

  [[nodiscard]] const gradient_penalty_settings& settings() const noexcept { return settings_; }

 private:
  [[nodiscard]] double depth(const penetration& p) const noexcept {
    const double d = settings_.value == depth_value::soft ? p.soft_depth_m : p.depth_m;
    return d <= 0.0 || has(p.flags, depth_flag::no_overlap) ? 0.0 : d;  // a NaN stays one, to be reported
  }
  [[nodiscard]] double share_mass(const penetration& p) const noexcept { return p.area_m2 * depth(p) * depth(p); }

  gradient_penalty_settings settings_;
  detail::direction_sameness sameness_;
};

static_assert(force_model<gradient_penalty>);

}  // namespace asperity
