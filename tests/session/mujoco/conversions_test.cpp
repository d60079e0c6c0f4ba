// MuJoCo's numbers and ours, beside what MuJoCo itself makes of them.
#include "asperity/mujoco/conversions.hpp"

#include "session/mujoco/simulation.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

drawn draw_for(const char* test) { return drawn(seed_of(fresh_seed(test, "1000 rotations"), test)); }

TEST(mujoco_conversions, a_quaternion_turns_vectors_as_mujoco_turns_them) {
  drawn draw = draw_for("mujoco_conversions.quaternion");
  double worst = 0.0, worst_of_xyzw = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const quat q = drawn_rotation(draw);
    const vec3 v = draw.inside(1.0);
    std::array<double, 4> wxyz{};
    mujoco::quat_to_mujoco(q, wxyz);
    const std::array<double, 3> in{v.x, v.y, v.z};
    std::array<double, 3> out{};
    mju_rotVecQuat(out.data(), in.data(), wxyz.data());
    worst = std::max(worst, glm::length(q * v - vec3(out[0], out[1], out[2])));
    const quat back = mujoco::quat_from_mujoco(wxyz);
    EXPECT_EQ(to_xyzw(back), to_xyzw(q));
    // The control: read in our own order it is another rotation.
    worst_of_xyzw = std::max(worst_of_xyzw, glm::length(quat_from_xyzw(wxyz) * v - vec3(out[0], out[1], out[2])));
  }
  EXPECT_LT(worst, 1e-14);
  EXPECT_GT(worst_of_xyzw, 0.1);
}

TEST(mujoco_conversions, a_free_joints_numbers_are_the_pose_and_the_velocity_that_mujoco_has) {
  const simulation s(
      "<worldbody><body name='b'><freejoint/><geom size='.1' mass='1' pos='.1 .2 .3'/></body></worldbody>");
  drawn draw = draw_for("mujoco_conversions.free_joint");
  for (int i = 0; i < 1000; ++i) {
    const pose T{drawn_rotation(draw), draw.inside(1.0)};
    const twist v{draw.inside(1.0), draw.inside(5.0)};
    mujoco::pose_to_qpos(T, std::span<double, 7>(s.d().qpos, 7));
    mujoco::twist_to_qvel(T.rotation, v, std::span<double, 6>(s.d().qvel, 6));
    mj_forward(&s.m(), &s.d());
    const double* const xpos = s.d().xpos + 3 * s.body("b");
    const double* const xquat = s.d().xquat + 4 * s.body("b");
    const pose seen =
        mujoco::pose_from_mujoco(std::span<const double, 3>(xpos, 3), std::span<const double, 4>(xquat, 4));
    EXPECT_LT(glm::length(seen.position - T.position), 1e-15);
    EXPECT_GT(std::fabs(glm::dot(seen.rotation, T.rotation)), 1.0 - 1e-14);
    const pose read = mujoco::pose_from_qpos(std::span<const double, 7>(s.d().qpos, 7));
    EXPECT_EQ(read.position, T.position);
    std::array<double, 6> of_frame{};  // angular, linear
    mj_objectVelocity(&s.m(), &s.d(), mjOBJ_XBODY, s.body("b"), of_frame.data(), 0);
    EXPECT_LT(glm::length(v.angular - vec3(of_frame[0], of_frame[1], of_frame[2])), 1e-13);
    EXPECT_LT(glm::length(v.linear - vec3(of_frame[3], of_frame[4], of_frame[5])), 1e-13);
    const twist again = mujoco::twist_from_qvel(T.rotation, std::span<const double, 6>(s.d().qvel, 6));
    EXPECT_LT(glm::length(again.angular - v.angular) + glm::length(again.linear - v.linear), 1e-14);
  }
}

}  // namespace
