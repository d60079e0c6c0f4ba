// Kinematics of chains against closed forms, tables of known arms, differences, and the conservation of power.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <vector>

#include "asperity/drivers/articulated/chain_inertia.hpp"
#include "asperity/drivers/articulated/joint_torques.hpp"
#include "hardware/arm/arm_rig.hpp"
#include "hardware/peers/fake_arm.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;
constexpr double pi = std::numbers::pi;

struct dice {
  std::mt19937_64 bits;
  explicit dice(std::uint64_t seed) : bits(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1.0p-53);
  }
  vec3 vector(double size) { return {between(-size, size), between(-size, size), between(-size, size)}; }
};

/// Any chain: tilted axes, masses off their joints.
serial_chain random_chain(dice& d, std::size_t joints) {
  serial_chain c;
  for (std::size_t i = 0; i < joints; ++i) {
    chain_joint j;
    j.T_parent = {exp_rotation(d.vector(1.5)), d.vector(0.3)};
    j.axis = glm::normalize(d.vector(1.0) + vec3(0.0, 0.0, 0.01));
    j.lower_rad = -2.0;
    j.upper_rad = 2.0;
    const mat3 a{d.between(0.5, 1.0),
                 d.between(-0.2, 0.2),
                 d.between(-0.2, 0.2),
                 0.0,
                 d.between(0.5, 1.0),
                 d.between(-0.2, 0.2),
                 0.0,
                 0.0,
                 d.between(0.5, 1.0)};
    j.link = {d.between(0.1, 1.0), d.vector(0.1), 1e-3 * (a * glm::transpose(a))};
    static_cast<void>(c.joints.push_back(j));
  }
  c.T_handle = {exp_rotation(d.vector(1.5)), d.vector(0.2)};
  return c;
}

joint_vector random_joints(dice& d, std::size_t n, double size) {
  joint_vector q{};
  for (std::size_t i = 0; i < n; ++i) q[i] = d.between(-size, size);
  return q;
}

double rotation_between(const quat& a, const quat& b) { return glm::length(log_rotation(a * glm::conjugate(b))); }

TEST(serial_chain, planar_arm_of_two_links_is_its_closed_form) {
  constexpr double l1 = 0.3;
  constexpr double l2 = 0.2;
  constexpr double m1 = 0.7;
  constexpr double m2 = 0.4;
  // Point masses at the middle of each link, which turns in the vertical plane x z about -y.
  const link_mass first{m1, {-l1 / 2, 0.0, 0.0}, mat3(0.0)};
  const link_mass second{m2, {-l2 / 2, 0.0, 0.0}, mat3(0.0)};
  const std::vector<dh_row> rows{{.a_m = l1, .link = first}, {.a_m = l2, .link = second}};
  const auto made = chain_from_dh(rows, dh_convention::classic, {exp_rotation({pi / 2, 0.0, 0.0}), vec3(0.0)});
  ASSERT_TRUE(made) << made.error().message;
  dice d(1);
  for (int k = 0; k < 1000; ++k) {
    const joint_vector q = random_joints(d, 2, pi);
    const chain_pose at = forward(*made, q);
    const double s1 = std::sin(q[0]);
    const double c1 = std::cos(q[0]);
    const double s12 = std::sin(q[0] + q[1]);
    const double c12 = std::cos(q[0] + q[1]);
    EXPECT_NEAR(at.T_dh.position.x, l1 * c1 + l2 * c12, 1e-12);
    EXPECT_NEAR(at.T_dh.position.z, l1 * s1 + l2 * s12, 1e-12);
    EXPECT_NEAR(at.T_dh.position.y, 0.0, 1e-12);
    const vec6 j1 = jacobian_column(at, 0);
    const vec6 j2 = jacobian_column(at, 1);
    EXPECT_NEAR(j1.linear.x, -l1 * s1 - l2 * s12, 1e-12);
    EXPECT_NEAR(j1.linear.z, l1 * c1 + l2 * c12, 1e-12);
    EXPECT_NEAR(j2.linear.x, -l2 * s12, 1e-12);
    EXPECT_NEAR(j2.linear.z, l2 * c12, 1e-12);
    const double g = 9.80665;
    const joint_vector weight = torques_against_gravity(*made, at);
    EXPECT_NEAR(weight[0], g * (m1 * l1 / 2 * c1 + m2 * (l1 * c1 + l2 / 2 * c12)), 1e-12);
    EXPECT_NEAR(weight[1], g * m2 * l2 / 2 * c12, 1e-12);
    const joint_matrix m = inertia_of(*made, at);
    const double c2 = std::cos(q[1]);
    const double r2 = l2 / 2;
    EXPECT_NEAR(m[0][0], m1 * l1 * l1 / 4 + m2 * (l1 * l1 + r2 * r2 + 2 * l1 * r2 * c2), 1e-12);
    EXPECT_NEAR(m[0][1], m2 * (r2 * r2 + l1 * r2 * c2), 1e-12);
    EXPECT_NEAR(m[1][1], m2 * r2 * r2, 1e-12);
  }
}

// Universal Robots' published table of the UR5, classic convention.
std::vector<dh_row> ur5() {
  return {
      {.alpha_rad = pi / 2, .d_m = 0.089159}, {.a_m = -0.425}, {.a_m = -0.39225}, {.alpha_rad = pi / 2, .d_m = 0.10915},
      {.alpha_rad = -pi / 2, .d_m = 0.09465}, {.d_m = 0.0823}};
}

TEST(serial_chain, ur5_stands_where_its_table_says) {
  const auto made = chain_from_dh(ur5(), dh_convention::classic);
  ASSERT_TRUE(made);
  // Stretched along -x at zero: sums of the table's lengths.
  const pose zero = forward(*made, {}).T_dh;
  EXPECT_NEAR(zero.position.x, -0.425 - 0.39225, 1e-12);
  EXPECT_NEAR(zero.position.y, -(0.10915 + 0.0823), 1e-12);
  EXPECT_NEAR(zero.position.z, 0.089159 - 0.09465, 1e-12);
  // Upright: the two links stand above the shoulder.
  const pose upright = forward(*made, {0.0, -pi / 2, 0.0, -pi / 2, 0.0, 0.0}).T_dh;
  EXPECT_NEAR(upright.position.x, 0.0, 1e-12);
  EXPECT_NEAR(upright.position.y, -0.10915 - 0.0823, 1e-12);
  EXPECT_NEAR(upright.position.z, 0.089159 + 0.425 + 0.39225 + 0.09465, 1e-12);
  // The tool looks along -y; its x axis points along -x.
  EXPECT_LT(glm::length(upright.rotation * vec3(0, 0, 1) - vec3(0, -1, 0)), 1e-12);
  EXPECT_LT(glm::length(upright.rotation * vec3(1, 0, 0) - vec3(-1, 0, 0)), 1e-12);
}

TEST(serial_chain, both_conventions_give_one_arm) {
  // The same arm: a classic row i has the alpha and a that the modified table writes one row later.
  const std::vector<dh_row> classic = ur5();
  std::vector<dh_row> modified(6);
  for (std::size_t i = 0; i < 6; ++i) {
    modified[i].d_m = classic[i].d_m;
    modified[i].theta_rad = classic[i].theta_rad;
    if (i > 0) modified[i].a_m = classic[i - 1].a_m;
    if (i > 0) modified[i].alpha_rad = classic[i - 1].alpha_rad;
  }
  const auto a = chain_from_dh(classic, dh_convention::classic);
  const auto b = chain_from_dh(modified, dh_convention::modified);
  ASSERT_TRUE(a && b);
  dice d(2);
  for (int k = 0; k < 200; ++k) {
    const joint_vector q = random_joints(d, 6, pi);
    const pose one = forward(*a, q).T_dh;
    const pose two = forward(*b, q).T_dh;
    EXPECT_LT(glm::length(one.position - two.position), 1e-12);
    EXPECT_LT(rotation_between(one.rotation, two.rotation), 1e-12);
  }
}

TEST(serial_chain, jacobian_is_the_derivative_of_the_pose) {
  dice d(3);
  for (int k = 0; k < 200; ++k) {
    const std::size_t n = 1 + static_cast<std::size_t>(d.bits() % most_joints);
    const serial_chain c = random_chain(d, n);
    const joint_vector q = random_joints(d, n, 2.0);
    const chain_pose at = forward(c, q);
    for (std::size_t i = 0; i < n; ++i) {
      constexpr double h = 1e-5;
      joint_vector plus = q;
      joint_vector minus = q;
      plus[i] += h;
      minus[i] -= h;
      const pose a = forward(c, plus).T_dh;
      const pose b = forward(c, minus).T_dh;
      const vec6 column = jacobian_column(at, i);
      EXPECT_LT(glm::length((a.position - b.position) / (2 * h) - column.linear), 1e-8);
      EXPECT_LT(glm::length(log_rotation(a.rotation * glm::conjugate(b.rotation)) / (2 * h) - column.angular), 1e-8);
    }
  }
}

TEST(serial_chain, power_is_the_same_at_joints_and_handle) {
  dice d(4);
  double worst = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const std::size_t n = 1 + static_cast<std::size_t>(d.bits() % most_joints);
    const serial_chain c = random_chain(d, n);
    const chain_pose at = forward(c, random_joints(d, n, 2.0));
    const joint_vector rates = random_joints(d, n, 1.0);
    const wrench w{d.vector(1.0), d.vector(1.0)};
    const joint_vector t = torques_for(c, at, w);
    double joints = 0.0;
    for (std::size_t i = 0; i < n; ++i) joints += t[i] * rates[i];
    worst = std::max(worst, std::fabs(joints - dot(to_vec6(w), to_vec6(handle_velocity(c, at, rates)))));
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(serial_chain, gravity_and_inertia_are_those_of_newton_and_euler) {
  dice d(5);
  for (int k = 0; k < 200; ++k) {
    const std::size_t n = 1 + static_cast<std::size_t>(d.bits() % most_joints);
    serial_chain c = random_chain(d, n);
    c.gravity_d = d.vector(10.0);
    const joint_vector q = random_joints(d, n, 2.0);
    const chain_pose at = forward(c, q);
    const joint_vector weight = torques_against_gravity(c, at);
    const joint_vector held = newton_euler(c, q, {}, {});
    const joint_matrix m = inertia_of(c, at);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(weight[i], held[i], 1e-12);
      joint_vector unit{};
      unit[i] = 1.0;
      const joint_vector column = newton_euler(c, q, {}, unit);
      for (std::size_t j = 0; j < n; ++j) EXPECT_NEAR(m[j][i], column[j] - held[j], 1e-12);
    }
    joint_vector x{};
    ASSERT_TRUE(solve(m, n, weight, x));
    for (std::size_t i = 0; i < n; ++i) {
      double b = 0.0;
      for (std::size_t j = 0; j < n; ++j) b += m[i][j] * x[j];
      EXPECT_NEAR(b, weight[i], 1e-9);
    }
  }
}

TEST(serial_chain, felt_inertia_is_below_that_of_every_direction) {
  dice d(6);
  const serial_chain c = desk_arm();
  for (int k = 0; k < 100; ++k) {
    const chain_pose at = forward(c, random_joints(d, 6, 1.5));
    const apparent_inertia felt = felt_at_handle(c, at);
    ASSERT_GT(felt.mass_kg, 0.0);
    const joint_matrix m = inertia_of(c, at);
    for (int t = 0; t < 20; ++t) {
      const vec3 u = glm::normalize(d.vector(1.0));
      const joint_vector row = torques_for(c, at, {u, vec3(0.0)});
      joint_vector x{};
      ASSERT_TRUE(solve(m, 6, row, x));
      double a = 0.0;
      for (std::size_t i = 0; i < 6; ++i) a += row[i] * x[i];
      EXPECT_LE(felt.mass_kg, 1.0 / a * (1 + 1e-9));
    }
  }
}

TEST(serial_chain, masses_add_up) {
  // Two halves of a rod of 1 m and 2 kg are the rod: m l^2 / 12 about its middle.
  const double half = 1.0 * 0.5 * 0.5 / 12.0;
  link_mass rod{1.0, {-0.25, 0.0, 0.0}, mat3(0.0)};
  rod.inertia_kg_m2[1][1] = rod.inertia_kg_m2[2][2] = half;
  link_mass other = rod;
  other.centre = {0.0, 0.25, 0.0};
  std::swap(other.inertia_kg_m2[0][0], other.inertia_kg_m2[1][1]);
  rod.add(other, {exp_rotation({0.0, 0.0, -pi / 2}), vec3(0.0)});  // y becomes x
  EXPECT_DOUBLE_EQ(rod.mass_kg, 2.0);
  EXPECT_LT(glm::length(rod.centre), 1e-15);
  EXPECT_NEAR(rod.inertia_kg_m2[0][0], 0.0, 1e-15);
  EXPECT_NEAR(rod.inertia_kg_m2[1][1], 2.0 / 12.0, 1e-15);
  EXPECT_NEAR(rod.inertia_kg_m2[2][2], 2.0 / 12.0, 1e-15);
}

TEST(serial_chain, what_cannot_be_computed_with_is_refused_by_name) {
  const auto refused = [](auto change) {
    serial_chain c = desk_arm();
    change(c);
    const result<void> r = check(c);
    return r ? std::string() : r.error().message;
  };
  EXPECT_EQ(refused([](serial_chain&) {}), "");
  EXPECT_NE(refused([](serial_chain& c) { c.joints.clear(); }).find("no joint"), std::string::npos);
  EXPECT_NE(refused([](serial_chain& c) { c.joints[2].axis *= 2.0; }).find("joint 3"), std::string::npos);
  EXPECT_NE(refused([](serial_chain& c) { c.joints[1].lower_rad = 3.0; }).find("limits"), std::string::npos);
  EXPECT_NE(refused([](serial_chain& c) { c.joints[1].upper_rad = INFINITY; }).find("limits"), std::string::npos);
  EXPECT_NE(refused([](serial_chain& c) { c.joints[0].link.mass_kg = -1.0; }).find("mass"), std::string::npos);
  EXPECT_NE(refused([](serial_chain& c) { c.T_handle.position.x = NAN; }).find("handle"), std::string::npos);
  const std::vector<dh_row> many(9, dh_row{.a_m = 0.1});
  const auto made = chain_from_dh(many, dh_convention::classic);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, error_code::limit_exceeded);
}

TEST(joint_torques, no_wrench_puts_a_joint_over_its_limit_and_all_keep_their_direction) {
  const serial_chain c = desk_arm();
  joint_vector limits{};
  for (std::size_t i = 0; i < 6; ++i) limits[i] = c.joints[i].max_torque_n_m;
  dice d(7);
  const double sizes[] = {0.0, 1e-300, 1e-3, 1.0, 10.0, 1e4, 1e150, 1e300, 1.7e308, NAN, INFINITY, -INFINITY};
  int scaled = 0;
  int refused = 0;
  for (int k = 0; k < 50'000; ++k) {
    const chain_pose at = forward(c, random_joints(d, 6, 2.0));
    wrench w{d.vector(1.0), d.vector(1.0)};
    for (int a = 0; a < 3; ++a) {
      w.force[a] *= sizes[d.bits() % std::size(sizes)];
      w.torque[a] *= sizes[d.bits() % std::size(sizes)];
    }
    joint_vector own = torques_against_gravity(c, at);
    if (k % 7 == 0) own[static_cast<std::size_t>(k % 6)] = sizes[d.bits() % std::size(sizes)];
    const joint_vector wanted = torques_for(c, at, w);
    const shared_torques out = share_torques(6, own, wanted, limits);
    for (std::size_t i = 0; i < 6; ++i) {
      ASSERT_TRUE(std::isfinite(out.torque_n_m[i]));
      ASSERT_LE(std::fabs(out.torque_n_m[i]), limits[i]);
    }
    if (!out.finite) {
      ++refused;
      for (const double t : out.torque_n_m) ASSERT_EQ(t, 0.0);
      continue;
    }
    ASSERT_GE(out.scale, 0.0);
    ASSERT_LE(out.scale, 1.0);
    if (out.scale < 1.0) ++scaled;
    for (std::size_t i = 0; i < 6; ++i) {  // one scale for all, to rounding
      const double held = std::clamp(own[i], -limits[i], limits[i]);
      ASSERT_NEAR(out.torque_n_m[i], held + out.scale * wanted[i], 1e-12 * limits[i]);
      ASSERT_GE((out.torque_n_m[i] - held) * wanted[i], 0.0) << "sign";
    }
  }
  EXPECT_GT(scaled, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(joint_torques, the_scale_is_no_smaller_than_it_has_to_be) {
  const joint_vector own{1.0, -1.0};
  const joint_vector limits{2.0, 2.0};
  EXPECT_DOUBLE_EQ(share_torques(2, own, {4.0, 0.0}, limits).scale, 0.25);
  EXPECT_DOUBLE_EQ(share_torques(2, own, {-4.0, 0.0}, limits).scale, 0.75);
  EXPECT_DOUBLE_EQ(share_torques(2, own, {1.0, 3.0}, limits).scale, 1.0);
  EXPECT_DOUBLE_EQ(share_torques(2, {5.0, 0.0}, {1.0, 1.0}, limits).scale, 0.0);
  EXPECT_DOUBLE_EQ(share_torques(2, {5.0, 0.0}, {1.0, 1.0}, limits).torque_n_m[0], 2.0);
  EXPECT_DOUBLE_EQ(share_torques(2, {5.0, 0.0}, {-1.0, 1.0}, limits).scale, 1.0);
}

TEST(joint_torques, stated_capabilities_hold_in_every_pose_and_direction) {
  arm_rig rig({.with_plant = false});
  ASSERT_TRUE(rig.dev);
  const device_capabilities& can = rig.dev->capabilities();
  EXPECT_GT(can.peak_force_n, 5.0);
  EXPECT_GT(can.peak_torque_n_m, 1.0);
  EXPECT_GT(can.continuous_force_n, 0.0);
  EXPECT_LE(can.continuous_force_n, can.peak_force_n);
  EXPECT_TRUE(can.device_side_watchdog);
  const serial_chain& c = rig.plant->chain();
  const chain_bounds bounds = bounds_of(c);
  joint_vector limits{};
  for (std::size_t i = 0; i < 6; ++i) limits[i] = c.joints[i].max_torque_n_m;
  dice d(8);
  double least_room = 1e9;
  for (int k = 0; k < 20'000; ++k) {
    const joint_vector q = random_joints(d, 6, pi);
    const chain_pose at = forward(c, q);
    const joint_vector weight = torques_against_gravity(c, at);
    const wrench both{can.peak_force_n * glm::normalize(d.vector(1.0)),
                      can.peak_torque_n_m * glm::normalize(d.vector(1.0))};
    EXPECT_GE(share_torques(6, weight, torques_for(c, at, both), limits).scale, 1.0 - 1e-12);
    const wrench_room room = room_for_wrench(c, at, weight, limits);
    least_room = std::min(least_room, room.force_n);
    for (std::size_t i = 0; i < 6; ++i) {
      ASSERT_LE(std::fabs(weight[i]), bounds.weight_n_m[i] * (1 + 1e-12) + 1e-12);
      ASSERT_LE(glm::length(jacobian_column(at, i).linear), bounds.lever_m[i] * (1 + 1e-12));
    }
    // The room is what it says: full in every direction, and not in every one of a little more.
    const vec3 u = glm::normalize(d.vector(1.0));
    EXPECT_GE(share_torques(6, weight, torques_for(c, at, {room.force_n * u, vec3(0.0)}), limits).scale, 1.0 - 1e-12);
    for (int a = 0; a < 3; ++a) {
      EXPECT_GE(at.T_dh.position[a], can.workspace_low_d[a]);
      EXPECT_LE(at.T_dh.position[a], can.workspace_high_d[a]);
    }
  }
  EXPECT_GT(least_room, can.peak_force_n);
}

}  // namespace
