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

/// A point of a surface that a plane stands for.
struct support_point {
  std::uint32_t body = 0, sample = 0;
};
using support_points = fixed_vector<support_point, most_support_planes>;

/// The contacts of one mover with bodies that come after it: other movers first to last, then what stands.
struct mover_contacts {
  std::vector<std::uint32_t> others;  ///< support_plane::body is an index into it; movers, then standing bodies
  contact_laws laws{};                ///< by the same index
  linear_contact contact{};           ///< planes and poses as last told ...
  std::vector<pose> T_wb;             ///< ... with the others here
  std::array<double, most_support_planes> lambda_n{};  ///< of its planes, in the last step
};

}  // namespace asperity::detail
