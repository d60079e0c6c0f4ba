// The mechanics of an arm with a hand on its handle: rigid links, motors, joint friction, gravity.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "asperity/device/simulated/motion_script.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/drivers/articulated/chain_inertia.hpp"

namespace asperity::test_support {

/// Joint torques of a motion, by the recursion of Newton and Euler: link by link outwards, forces inwards. Independent
/// of what the library computes from Jacobians, and an oracle for it.
[[nodiscard]] inline joint_vector newton_euler(const serial_chain& chain, const joint_vector& q, const joint_vector& qd,
                                               const joint_vector& qdd) {
  const chain_pose at = forward(chain, q);
  const std::size_t n = chain.joints.size();
  std::array<vec3, most_joints> force{};
  std::array<vec3, most_joints> moment{};
  std::array<vec3, most_joints> arm{};
  vec3 w{0.0};
  vec3 alpha{0.0};
  vec3 a = -chain.gravity_d;
  vec3 origin = n > 0 ? at.T_dl[0].position : vec3(0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const vec3 r = at.T_dl[i].position - origin;
    a = a + glm::cross(alpha, r) + glm::cross(w, glm::cross(w, r));
    origin = at.T_dl[i].position;
    const vec3 z = at.axis_d[i];
    alpha = alpha + glm::cross(w, qd[i] * z) + qdd[i] * z;
    w = w + qd[i] * z;
    const link_mass& l = chain.joints[i].link;
    arm[i] = at.T_dl[i].rotation * l.centre;
    const mat3 rot = glm::mat3_cast(at.T_dl[i].rotation);
    const mat3 inertia = rot * l.inertia_kg_m2 * glm::transpose(rot);
    force[i] = l.mass_kg * (a + glm::cross(alpha, arm[i]) + glm::cross(w, glm::cross(w, arm[i])));
    moment[i] = inertia * alpha + glm::cross(w, inertia * w);
  }
  joint_vector out{};
  vec3 f{0.0};
  vec3 m{0.0};
  for (std::size_t i = n; i-- > 0;) {
    if (i + 1 < n) m += glm::cross(at.T_dl[i + 1].position - at.T_dl[i].position, f);
    m += moment[i] + glm::cross(arm[i], force[i]);
    f += force[i];
    out[i] = glm::dot(at.axis_d[i], m);
  }
  return out;
}

struct fake_arm_settings {
  serial_chain chain{};
  joint_vector start_rad{};
  joint_vector reflected_kg_m2{};
  joint_vector friction_n_m_s_per_rad{};
  hand_settings hand{};
  motion_settings motion{};
  std::uint64_t seed = 1;
  bool hand_holds = true;
  std::int64_t step_ns = 50'000;
};

/// Integrates in steps of one length: semi-implicit, dampers at the end of the step. Full rigid-body dynamics.
class fake_arm {
 public:
  explicit fake_arm(const fake_arm_settings& settings)
      : settings_(settings), motion_(settings.motion, settings.seed), q_(settings.start_rad) {
    at_ = forward(settings_.chain, q_);
  }

  void set_torques(const joint_vector& t) { torque_ = t; }
  /// The wrench that the device means to put on the hand now, for the book of what it puts on too much.
  void set_intended(const wrench& w) { intended_ = w; }

  void advance(std::int64_t now_ns) {
    if (!started_) {
      started_ = true;
      origin_ns_ = now_ns_ = now_ns;
    }
    while (now_ns_ + settings_.step_ns <= now_ns) step();
  }

  [[nodiscard]] const joint_vector& q() const { return q_; }
  [[nodiscard]] const joint_vector& qd() const { return qd_; }
  [[nodiscard]] const pose& T_dh() const { return at_.T_dh; }
  [[nodiscard]] twist velocity_d() const { return handle_velocity(settings_.chain, at_, qd_); }
  [[nodiscard]] const serial_chain& chain() const { return settings_.chain; }
  /// Work of the motors beyond what holds the links against gravity: what reaches the hand's side, J.
  [[nodiscard]] double delivered_j() const { return delivered_j_; }
  /// Integral of |motor torque - (J^T intended + gravity)| |speed|, J: the most that rounding, lag and delay can add.
  [[nodiscard]] double astray_j() const { return astray_j_; }
  [[nodiscard]] double kinetic_j() const {
    const joint_matrix m = inertia_of(settings_.chain, at_, settings_.reflected_kg_m2);
    double e = 0.0;
    for (std::size_t i = 0; i < n(); ++i) {
      for (std::size_t j = 0; j < n(); ++j) e += 0.5 * qd_[i] * m[i][j] * qd_[j];
    }
    return e;
  }

 private:
  [[nodiscard]] std::size_t n() const { return settings_.chain.joints.size(); }

  void step() {
    const double h = 1e-9 * static_cast<double>(settings_.step_ns);
    const hand_target hand = motion_.at(1e-9 * static_cast<double>(now_ns_ - origin_ns_));
    const hand_settings& g = settings_.hand;
    joint_matrix m = inertia_of(settings_.chain, at_, settings_.reflected_kg_m2);
    const joint_vector bias = newton_euler(settings_.chain, q_, qd_, {});
    const joint_vector weight = torques_against_gravity(settings_.chain, at_);
    std::array<vec6, most_joints> column{};
    for (std::size_t i = 0; i < n(); ++i) column[i] = jacobian_column(at_, i);

    vec6 pull;
    if (settings_.hand_holds) {
      pull.linear =
          g.stiffness_n_per_m * (hand.T_dh.position - at_.T_dh.position) + g.damping_n_s_per_m * hand.velocity_d.linear;
      pull.angular = g.stiffness_n_m_per_rad * log_rotation(hand.T_dh.rotation * glm::conjugate(at_.T_dh.rotation)) +
                     g.damping_n_m_s_per_rad * hand.velocity_d.angular;
    }
    joint_vector rhs{};
    for (std::size_t i = 0; i < n(); ++i) {
      for (std::size_t j = 0; j < n(); ++j) rhs[i] += m[i][j] * qd_[j];
      rhs[i] += h * (torque_[i] + dot(column[i], pull) - bias[i]);
    }
    for (std::size_t i = 0; i < n(); ++i) {
      m[i][i] += h * settings_.friction_n_m_s_per_rad[i];
      if (!settings_.hand_holds) continue;
      for (std::size_t j = 0; j < n(); ++j) {
        m[i][j] += h * (g.damping_n_s_per_m * glm::dot(column[i].linear, column[j].linear) +
                        g.damping_n_m_s_per_rad * glm::dot(column[i].angular, column[j].angular));
      }
    }
    static_cast<void>(solve(m, n(), rhs, qd_));
    for (std::size_t i = 0; i < n(); ++i) {
      delivered_j_ += h * (torque_[i] - weight[i]) * qd_[i];
      astray_j_ += h * std::fabs(torque_[i] - weight[i] - dot(column[i], to_vec6(intended_))) * std::fabs(qd_[i]);
      q_[i] += h * qd_[i];
    }
    at_ = forward(settings_.chain, q_);
    now_ns_ += settings_.step_ns;
  }

  fake_arm_settings settings_;
  motion_script motion_;
  joint_vector q_{};
  joint_vector qd_{};
  joint_vector torque_{};
  wrench intended_{};
  chain_pose at_{};
  bool started_ = false;
  std::int64_t origin_ns_ = 0;
  std::int64_t now_ns_ = 0;
  double delivered_j_ = 0.0;
  double astray_j_ = 0.0;
};

}  // namespace asperity::test_support
