// A six-joint arm with a tool, and its controller: motors that pull the tool towards a pose, as a spring and a damper would.
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <mujoco/mujoco.h>
#include <string>

#include <asperity/asperity.hpp>
#include <asperity/mujoco/conversions.hpp>

/// @param fixed_at of the workpiece's frame, m
inline std::string arm_mjcf(const asperity::vec3& fixed_at) {
  std::array<char, 96> at{};
  std::snprintf(at.data(), at.size(), "%.9g %.9g %.9g", fixed_at.x, fixed_at.y, fixed_at.z);
  return R"(<mujoco model="six-joint arm">
  <option timestep="0.001"/>
  <default>
    <joint damping="0.3" armature="0.02"/>
    <geom type="capsule" size="0.03" density="600" contype="0" conaffinity="0"/>
  </default>
  <worldbody>
    <body name="workpiece" pos=")" +
         std::string(at.data()) + R"("/>
    <body pos="0 0 .1"><joint axis="0 0 1"/><geom fromto="0 0 0 0 0 .1"/>
      <body pos="0 0 .1"><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 .3"/>
        <body pos="0 0 .3"><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 .25"/>
          <body pos="0 0 .25"><joint axis="0 0 1"/><geom fromto="0 0 0 0 0 .05"/>
            <body pos="0 0 .05"><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 .05" size="0.02"/>
              <body pos="0 0 .05"><joint axis="0 0 1"/><geom fromto="0 0 0 0 0 .02" size="0.02"/>
                <body name="tool" pos="0 0 .06" quat="0 1 0 0">
                  <inertial pos="0 0 0" mass="0.1" diaginertia="3e-5 3e-5 3e-5"/>
                </body></body></body></body></body></body></body>
  </worldbody>
</mujoco>)";
}

class arm {
 public:
  arm(const mjModel& m, mjData& d) : m_(m), d_(d), tool_(mj_name2id(&m, mjOBJ_BODY, "tool")) {
    const std::array<double, 6> bent{0.0, 0.5, 1.3, 0.0, 1.34, 0.0};
    mju_copy(d.qpos, bent.data(), 6);
    mj_forward(&m, &d);
  }
  [[nodiscard]] asperity::pose tool() const {
    return asperity::mujoco::pose_from_mujoco(std::span<const double, 3>(d_.xpos + std::ptrdiff_t{3} * tool_, 3),
                                              std::span<const double, 4>(d_.xquat + std::ptrdiff_t{4} * tool_, 4));
  }
  /// Bends the arm, at rest, until the tool is there.
  void place(const asperity::pose& T_wt) {
    for (int i = 0; i < 200; ++i) {
      const jacobian j = tool_jacobian();
      asperity::mat6 a;
      for (std::size_t r = 0; r < 6; ++r) {
        for (std::size_t c = 0; c < 6; ++c) {
          a(r, c) = r == c ? 1e-6 : 0.0;
          for (std::size_t k = 0; k < 6; ++k) a(r, c) += j[6 * r + k] * j[6 * c + k];
        }
      }
      asperity::vec6 x;
      if (!asperity::solve(a, asperity::pose_difference(T_wt, tool()), x)) return;
      for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t r = 0; r < 6; ++r) d_.qpos[k] += 0.5 * j[6 * r + k] * x[r];
      }
      mju_zero(d_.qvel, 6);
      mj_forward(&m_, &d_);
    }
  }
  /// Sets the motors' torques: the arm's own weight and Coriolis forces, and a spring and damper from the tool to the pose.
  /// Call it between mj_step1() and mj_step2(). @return force and torque of spring and damper on the tool, world axes
  asperity::wrench pull_to(const asperity::pose& T_wt) {
    constexpr double spring_n_per_m = 1500.0, damper_n_s_per_m = 60.0, spring_n_m = 40.0, damper_n_m_s = 1.0;
    const jacobian j = tool_jacobian();
    const asperity::vec6 way = asperity::pose_difference(T_wt, tool());
    std::array<double, 6> pull{};
    for (std::size_t r = 0; r < 6; ++r) {
      double v = 0.0;
      for (std::size_t k = 0; k < 6; ++k) v += j[6 * r + k] * d_.qvel[k];
      pull[r] = r < 3 ? spring_n_per_m * way[r] - damper_n_s_per_m * v : spring_n_m * way[r] - damper_n_m_s * v;
    }
    for (std::size_t k = 0; k < 6; ++k) {
      d_.qfrc_applied[k] = d_.qfrc_bias[k];
      for (std::size_t r = 0; r < 6; ++r) d_.qfrc_applied[k] += j[6 * r + k] * pull[r];
    }
    return {{pull[0], pull[1], pull[2]}, {pull[3], pull[4], pull[5]}};
  }

 private:
  using jacobian = std::array<double, 36>;  // rows: translation, rotation
  [[nodiscard]] jacobian tool_jacobian() const {
    jacobian out{};
    mj_jac(&m_, &d_, out.data(), out.data() + 18, d_.xpos + std::ptrdiff_t{3} * tool_, tool_);
    return out;
  }

  const mjModel& m_;
  mjData& d_;
  int tool_;
};
