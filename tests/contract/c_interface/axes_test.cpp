// Left-handed engines: closed forms, and a lever that each engine turns by its own cross product.
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>

#include "asperity/c/asperity.h"
#include "asperity/core/pose.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity;
using seven = std::array<double, 7>;
using six = std::array<double, 6>;

struct engine {
  const char* name;
  std::int32_t (*pose_from)(const double*, double*);
  std::int32_t (*pose_to)(const double*, double*);
  std::int32_t (*wrench_from)(const double*, double*);
  std::int32_t (*wrench_to)(const double*, double*);
  std::int32_t (*twist_from)(const double*, double*);
  std::int32_t (*twist_to)(const double*, double*);
  mat3 mirror;  // ours to theirs, without units; GLM's columns
  double length, force, torque;
};

const engine engines[] = {{"unity", asperity_pose_from_unity, asperity_pose_to_unity, asperity_wrench_from_unity,
                           asperity_wrench_to_unity, asperity_twist_from_unity, asperity_twist_to_unity,
                           // x forward is z there, y left is -x, z up is y
                           mat3(vec3(0, 0, 1), vec3(-1, 0, 0), vec3(0, 1, 0)), 1.0, 1.0, 1.0},
                          {"unreal", asperity_pose_from_unreal, asperity_pose_to_unreal, asperity_wrench_from_unreal,
                           asperity_wrench_to_unreal, asperity_twist_from_unreal, asperity_twist_to_unreal,
                           // x forward is x there, y left is -y, z up is z
                           mat3(vec3(1, 0, 0), vec3(0, -1, 0), vec3(0, 0, 1)), 100.0, 100.0, 10000.0}};

vec3 three(const double* n) { return {n[0], n[1], n[2]}; }
seven to_seven(const pose& T) {
  const auto q = to_xyzw(T.rotation);
  return {T.position.x, T.position.y, T.position.z, q[0], q[1], q[2], q[3]};
}
pose to_pose(const seven& n) { return {quat_from_xyzw({n[3], n[4], n[5], n[6]}), three(n.data())}; }
// The formula is the same in a left-handed engine; only what it means is mirrored.
vec3 their_cross(const vec3& a, const vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
// As engines turn a vector by a quaternion x y z w: the formula knows no hands either.
vec3 their_turn(const double* q, const vec3& v) {
  const vec3 u = three(q);
  return v + 2.0 * q[3] * their_cross(u, v) + 2.0 * their_cross(u, their_cross(u, v));
}

class drawn {
 public:
  explicit drawn(std::uint64_t seed) : bits_(seed) {}
  vec3 vector(double size) {
    std::uniform_real_distribution<double> one(-size, size);
    const double x = one(bits_), y = one(bits_);
    return {x, y, one(bits_)};
  }
  pose any_pose() { return {exp_rotation(vector(2.5)), vector(1.0)}; }

 private:
  std::mt19937_64 bits_;
};

TEST(axes, mirrors_are_mirrors) {
  for (const engine& e : engines) EXPECT_DOUBLE_EQ(glm::determinant(e.mirror), -1.0) << e.name;
}

// Closed forms, by hand from each engine's manual.
TEST(axes, quarter_turns_by_hand) {
  const double h = std::sqrt(0.5);
  // One metre ahead, two to the left, three up; turned a quarter about the axis that points up: counter-clockwise from
  // above for us. In a left-handed engine a positive angle about "up" is clockwise from above, so the angle is negative.
  const seven ours{1, 2, 3, 0, 0, h, h};
  seven out{};
  ASSERT_EQ(asperity_pose_to_unity(ours.data(), out.data()), 0);
  EXPECT_EQ(out, (seven{-2, 3, 1, 0, -h, 0, h}));
  ASSERT_EQ(asperity_pose_to_unreal(ours.data(), out.data()), 0);
  EXPECT_EQ(out, (seven{100, -200, 300, 0, 0, -h, h}));
  // Nose down: a positive quarter turn about our left. Unity: a positive angle about its right is nose down.
  const seven nose_down{0, 0, 0, 0, h, 0, h};
  ASSERT_EQ(asperity_pose_to_unity(nose_down.data(), out.data()), 0);
  EXPECT_EQ(out, (seven{0, 0, 0, h, 0, 0, h}));
  const double ahead[3] = {0, 0, 1};
  EXPECT_LT(their_turn(out.data() + 3, three(ahead)).y, -0.99) << "the nose of Unity's object points up";
}

// A spanner: its end a quarter metre ahead of the bolt, pushed to the left with 4 N. Seen from above the bolt turns
// counter-clockwise, about the axis that points up, with 1 N m.
TEST(axes, a_spanner_turns_the_same_way_everywhere) {
  const six ours{0, 4, 0, 0, 0, 1};
  six out{};
  ASSERT_EQ(asperity_wrench_to_unity(ours.data(), out.data()), 0);
  // Unity: left is -x. Counter-clockwise from above is a negative torque about its up, y.
  EXPECT_EQ(out, (six{-4, 0, 0, 0, -1, 0}));
  EXPECT_EQ(three(out.data() + 3), their_cross({0, 0, 0.25}, three(out.data())));
  ASSERT_EQ(asperity_wrench_to_unreal(ours.data(), out.data()), 0);
  // Unreal: left is -y; 4 N are 400 kg cm/s^2, and 1 N m is 10000 kg cm^2/s^2.
  EXPECT_EQ(out, (six{0, -400, 0, 0, 0, -10000}));
  EXPECT_EQ(three(out.data() + 3), their_cross({25, 0, 0}, three(out.data())));
}

TEST(axes, levers_of_any_kind_turn_as_each_engine_turns_them) {
  drawn draw(test_support::seed_of(test_support::fresh_seed("axes.levers", "200 levers"), "axes.levers"));
  for (const engine& e : engines) {
    for (int i = 0; i < 100; ++i) {
      const vec3 lever = draw.vector(0.5), force = draw.vector(20.0), torque = glm::cross(lever, force);
      const six ours{force.x, force.y, force.z, torque.x, torque.y, torque.z};
      six theirs{}, back{};
      ASSERT_EQ(e.wrench_to(ours.data(), theirs.data()), 0);
      const vec3 their_lever = e.length * (e.mirror * lever);
      EXPECT_LT(glm::length(three(theirs.data()) - e.force * (e.mirror * force)), 1e-9);
      EXPECT_LT(glm::length(three(theirs.data() + 3) - their_cross(their_lever, three(theirs.data()))),
                1e-12 * e.torque)
          << e.name;
      // Power is the same in both, in its units: force . velocity + torque . turn.
      const vec3 v = draw.vector(1.0), w = draw.vector(3.0);
      const six moving{v.x, v.y, v.z, w.x, w.y, w.z};
      six their_twist{}, twist_back{};
      ASSERT_EQ(e.twist_to(moving.data(), their_twist.data()), 0);
      const double power = glm::dot(force, v) + glm::dot(torque, w);
      const double their_power = glm::dot(three(theirs.data()), three(their_twist.data())) +
                                 glm::dot(three(theirs.data() + 3), three(their_twist.data() + 3));
      EXPECT_NEAR(their_power, e.length * e.force * power, 1e-9 * e.torque);
      ASSERT_EQ(e.wrench_from(theirs.data(), back.data()), 0);
      ASSERT_EQ(e.twist_from(their_twist.data(), twist_back.data()), 0);
      for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(back[k], ours[k], 1e-13);
        EXPECT_NEAR(twist_back[k], moving[k], 1e-13);
      }
    }
  }
}

TEST(axes, a_point_of_a_body_is_the_same_point_in_the_engine) {
  drawn draw(test_support::seed_of(test_support::fresh_seed("axes.points", "200 poses"), "axes.points"));
  for (const engine& e : engines) {
    for (int i = 0; i < 100; ++i) {
      const pose T = draw.any_pose();
      const vec3 point = draw.vector(0.3);
      seven theirs{}, back{};
      ASSERT_EQ(e.pose_to(to_seven(T).data(), theirs.data()), 0);
      const vec3 where = three(theirs.data()) + their_turn(theirs.data() + 3, e.length * (e.mirror * point));
      EXPECT_LT(glm::length(where - e.length * (e.mirror * (T * point))), 1e-12 * e.length) << e.name;
      ASSERT_EQ(e.pose_from(theirs.data(), back.data()), 0);
      EXPECT_LT(glm::length(to_pose(back) * point - T * point), 1e-14);
      // One after the other is one after the other there as well.
      const pose other = draw.any_pose();
      seven second{}, both{};
      ASSERT_EQ(e.pose_to(to_seven(other).data(), second.data()), 0);
      ASSERT_EQ(e.pose_to(to_seven(T * other).data(), both.data()), 0);
      const vec3 chained = three(theirs.data()) + their_turn(theirs.data() + 3, three(second.data()));
      EXPECT_LT(glm::length(chained - three(both.data())), 1e-12 * e.length);
    }
  }
}

TEST(axes, may_write_where_it_reads) {
  for (const engine& e : engines) {
    seven T{0.1, 0.2, 0.3, 0.5, -0.5, 0.5, 0.5};
    const seven before = T;
    seven apart{};
    ASSERT_EQ(e.pose_to(T.data(), apart.data()), 0);
    ASSERT_EQ(e.pose_to(T.data(), T.data()), 0);
    EXPECT_EQ(T, apart);
    ASSERT_EQ(e.pose_from(T.data(), T.data()), 0);
    for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(T[k], before[k], 1e-16);
    six w{1, 2, 3, 4, 5, 6}, apart_w{};
    ASSERT_EQ(e.wrench_to(w.data(), apart_w.data()), 0);
    ASSERT_EQ(e.wrench_to(w.data(), w.data()), 0);
    EXPECT_EQ(w, apart_w);
  }
}

TEST(axes, refuses_null) {
  double n[7] = {};
  for (const engine& e : engines) {
    for (const auto f : {e.pose_from, e.pose_to, e.wrench_from, e.wrench_to, e.twist_from, e.twist_to}) {
      EXPECT_EQ(f(nullptr, n), ASPERITY_ERROR_INVALID_ARGUMENT);
      EXPECT_EQ(f(n, nullptr), ASPERITY_ERROR_INVALID_ARGUMENT);
    }
  }
}

}  // namespace
