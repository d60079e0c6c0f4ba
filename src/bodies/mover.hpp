// A rigid body as the joint step sees it, and what its contacts are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/linear_contact.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity::detail {

/// The probe or a free body. Its frame c has its origin in the centre of mass and the body's axes.
struct mover {
  double mass_kg = 1.0;
  mat3 inertia_kg_m2{1.0};  // about the centre of mass, body axes
  vec3 centre_b{0.0};       // centre of mass in the body frame
  double radius_m = 0.0;    // of the body about it
  pose T_wc{};
  vec6 velocity{};  // of the centre of mass, world axes
  wrench push_w{};  // by push()
  bool sleeps = false;
  double quiet_s = 0.0;
  double known_m = 0.0;  // so far its points may go before the next contacts are known
  pose known_from_T_wc{};

  [[nodiscard]] pose T_wb() const noexcept { return T_wc * pose{quat(1.0, 0.0, 0.0, 0.0), -centre_b}; }
  /// No point of the body is faster, m/s.
  [[nodiscard]] double speed() const noexcept {
    return glm::length(velocity.linear) + radius_m * glm::length(velocity.angular);
  }
  /// No point of the body has gone further since its contacts were told, m.
  [[nodiscard]] double way_m(const pose& now_T_wc) const noexcept {
    const vec6 far = pose_difference(now_T_wc, known_from_T_wc);
    return glm::length(far.linear) + radius_m * glm::length(far.angular);
  }
};

/// Whose sample a plane stands for: its number is odd or even.
inline constexpr std::uint32_t of_mover = 1, of_other = 2;

/// A body that a mover may touch.
struct other_body {
  std::uint32_t number = 0;     ///< movers, then standing bodies
  std::uint32_t lies_back = 0;  ///< of_mover or of_other: those samples lie further back; 0: none
};

/// What the springs of all planes between two bodies hold, J.
struct pair_springs {
  double held_j = 0.0;  ///< at the end of the last step
  double now_j = 0.0;   ///< at the beginning of this one
  double made_j = 0.0;  ///< gained by planes that were told anew, and not yet taken out again
};

/// The contacts of one mover with bodies that come after it: other movers first to last, then what stands.
struct mover_contacts {
  std::vector<other_body> others;                      ///< support_plane::body is an index into it
  contact_laws laws{};                                 ///< by the same index
  std::vector<pair_springs> springs;                   ///< by the same index
  linear_contact contact{};                            ///< planes and poses as last told ...
  std::vector<pose> T_wb;                              ///< ... with the others here
  std::array<double, most_support_planes> lambda_n{};  ///< of its planes, in the last step
};

/// A plane of a mover with another mover that has gone from where it was when the plane was told: it goes with both, which
/// is exact for planes. Its depth is at a_T_wc.
/// @param then_T_wc, then_T_wb of the mover and the body frame of the other, then
/// @rt safe
[[nodiscard]] inline support_plane carried(support_plane p, const pose& a_T_wc, const pose& then_T_wc, const pose& T_wb,
                                           const pose& then_T_wb) noexcept {
  const pose X = T_wb * inverse(then_T_wb);
  p.depth_m += dot(p.gradient, pose_difference(inverse(X) * a_T_wc, then_T_wc));
  p.gradient = {X.rotation * p.gradient.linear, X.rotation * p.gradient.angular};
  p.n_ab_w = X.rotation * p.n_ab_w;
  p.r_w = X.rotation * p.r_w;
  return p;
}

}  // namespace asperity::detail
