// The legs of a Falcon against published numbers, against each other, and from force to bytes.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "asperity/drivers/falcon/falcon_device.hpp"
#include "asperity/drivers/falcon/falcon_leg.hpp"

namespace {

using namespace asperity;

constexpr double deg = 3.141592653589793 / 180.0;

TEST(falcon_kinematics, encoders_and_angles_are_the_published_ones) {
  EXPECT_NEAR(falcon_angle_rad(0) / deg, 35.000, 5e-4);
  EXPECT_NEAR(falcon_angle_rad(1447) / deg, 87.721, 5e-4);
  EXPECT_NEAR(falcon_angle_rad(-1447) / deg, -17.721, 5e-4);
}

TEST(falcon_kinematics, angles_at_published_positions) {
  const struct {
    vec3 grip_d;
    falcon_angles angles_deg;
  } golden[] = {{{0.0, 0.0, 0.08}, {-11.800, -11.800, -11.800}},
                {{0.0, 0.0, 0.11}, {16.188, 16.188, 16.188}},
                {{0.0, 0.0, 0.15}, {47.243, 47.243, 47.243}},
                {{0.02, -0.01, 0.12}, {35.568, 11.492, 30.349}}};
  for (const auto& g : golden) {
    const auto angles = falcon_angles_at(g.grip_d);
    ASSERT_TRUE(angles);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((*angles)[i] / deg, g.angles_deg[i], 6e-4);
    const falcon_position back = falcon_position_at(*angles);
    EXPECT_TRUE(back.converged);
    EXPECT_LT(glm::length(back.grip_d - g.grip_d), 1e-9);
  }
}

// Seeded positions over the stated workspace and its corners.
template <class Look>
void everywhere(Look&& look) {
  const device_capabilities c = falcon_capabilities();
  std::mt19937_64 bits(3);
  const auto unit = [&] { return static_cast<double>(bits() >> 11) * 0x1.0p-53; };
  for (int i = 0; i < 4000; ++i) {
    vec3 share{unit(), unit(), unit()};
    if (i < 8) share = vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    look(c.workspace_low_d + share * (c.workspace_high_d - c.workspace_low_d), unit);
  }
}

TEST(falcon_kinematics, the_whole_workspace_is_reached_and_found_again) {
  int most = 0;
  everywhere([&](const vec3& p, auto&&) {
    const auto angles = falcon_angles_at(p);
    ASSERT_TRUE(angles);
    const falcon_position back = falcon_position_at(*angles);
    ASSERT_TRUE(back.converged);
    ASSERT_LT(glm::length(back.grip_d - p), 1e-9);
    most = std::max(most, back.iterations);
    for (const double a : *angles) ASSERT_LT(std::fabs((a - falcon_angle_at_zero_rad) / falcon_rad_per_count), 2200.0);
  });
  EXPECT_LE(most, 10);
}

TEST(falcon_kinematics, gradients_are_differences_and_resolution_is_as_stated) {
  double coarsest = 0.0;
  int places = 0, slopes = 0;
  everywhere([&](const vec3& p, auto&&) {
    ++places;
    const auto angles = falcon_angles_at(p);
    const auto gradients = falcon_angle_gradients(p, *angles);
    ASSERT_TRUE(gradients);
    constexpr double h = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      vec3 step{0.0};
      step[axis] = h;
      const auto up = falcon_angles_at(p + step);
      const auto down = falcon_angles_at(p - step);
      if (!up || !down) continue;
      ++slopes;
      for (std::size_t i = 0; i < 3; ++i) {
        const double slope = ((*up)[i] - (*down)[i]) / (2.0 * h);
        ASSERT_NEAR((*gradients)[static_cast<int>(i)][axis], slope, 1e-4 * (1.0 + std::fabs(slope)));
      }
    }
    falcon_angles one = *angles;
    one[0] += falcon_rad_per_count;
    coarsest = std::max(coarsest, glm::length(falcon_position_at(one, p).grip_d - p));
  });
  EXPECT_LE(coarsest, falcon_capabilities().position_resolution_m);
  EXPECT_GT(slopes, 5 * places / 2);  // of three axes at each
}

TEST(falcon_kinematics, work_of_torques_is_work_of_the_force) {
  int places = 0, judged = 0;
  everywhere([&](const vec3& p, auto&& unit) {
    ++places;
    const auto angles = falcon_angles_at(p);
    const vec3 force{4.0 * unit() - 2.0, 4.0 * unit() - 2.0, 4.0 * unit() - 2.0};
    const vec3 move = 1e-7 * vec3(unit() - 0.5, unit() - 0.5, unit() - 0.5);
    const auto torques = falcon_torques(p, *angles, force);
    const auto moved = falcon_angles_at(p + move);
    ASSERT_TRUE(torques);
    if (!moved) return;
    ++judged;
    double work = 0.0;
    for (std::size_t i = 0; i < 3; ++i) work += (*torques)[static_cast<int>(i)] * ((*moved)[i] - (*angles)[i]);
    ASSERT_NEAR(work, glm::dot(force, move), 1e-4 * glm::length(force) * glm::length(move));
  });
  EXPECT_GT(judged, places / 2);
}

TEST(falcon_kinematics, newton_ends_and_says_when_it_found_nothing) {
  std::mt19937_64 bits(11);
  int found = 0;
  for (int i = 0; i < 20000; ++i) {
    falcon_angles angles{};
    vec3 start{0.0};
    for (std::size_t k = 0; k < 3; ++k) {
      angles[k] = falcon_angle_rad(static_cast<std::int16_t>(bits()));
      const std::uint64_t raw = bits();
      double x = 0.0;
      std::memcpy(&x, &raw, sizeof x);
      start[static_cast<int>(k)] = i % 2 == 0 ? 0.1 : x;  // any pattern of bits
    }
    const falcon_position p = falcon_position_at(angles, start);
    ASSERT_LE(p.iterations, 15);
    if (!p.converged) continue;
    ++found;
    ASSERT_TRUE(is_finite(p.grip_d));
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(std::fabs(falcon_detail::look_at_leg(k, p.grip_d, angles[k]).miss_m2), 1e-9);
    }
  }
  EXPECT_GT(found, 0);
  EXPECT_LT(found, 20000);
  EXPECT_FALSE(falcon_position_at({NAN, 0.0, 0.0}).converged);
}

TEST(falcon_torque, one_newton_is_the_published_counts) {
  const vec3 p{0.0, 0.0, 0.11};
  const auto counts = falcon_counts_for(p, *falcon_angles_at(p), {1.0, 0.0, 0.0});
  EXPECT_EQ(std::max({std::abs(counts[0]), std::abs(counts[1]), std::abs(counts[2])}), 527);
}

// The force on the hand that counts stand for.
vec3 force_of(const std::array<std::int16_t, 3>& counts, const vec3& p) {
  const auto gradients = falcon_angle_gradients(p, *falcon_angles_at(p));
  vec3 force{0.0};
  for (int i = 0; i < 3; ++i) force += counts[static_cast<std::size_t>(i)] / falcon_counts_per_n_m * (*gradients)[i];
  return force;
}

TEST(falcon_torque, the_peak_force_is_possible_everywhere_in_the_workspace) {
  everywhere([&](const vec3& p, auto&& unit) {
    const vec3 way = glm::normalize(vec3(unit() - 0.5, unit() - 0.5, unit() - 0.5));
    const vec3 force = falcon_capabilities().peak_force_n * way;
    const auto counts = falcon_counts_for(p, *falcon_angles_at(p), force);
    ASSERT_LT(glm::length(force_of(counts, p) - force), 0.02) << p.x << ' ' << p.y << ' ' << p.z;
  });
}

TEST(falcon_torque, a_force_of_any_size_keeps_its_direction) {
  everywhere([&](const vec3& p, auto&& unit) {
    const vec3 way = glm::normalize(vec3(unit() - 0.5, unit() - 0.5, unit() - 0.5));
    for (const double size : {1.0, 20.0, 62.0, 1e3, 1e9, 1e200, 1e300, 1.7e308}) {
      for (const std::int16_t limit : {std::int16_t{4096}, std::int16_t{1000}, std::int16_t{32767}, std::int16_t{-5}}) {
        const auto counts = falcon_counts_for(p, *falcon_angles_at(p), size * way, limit);
        const int allowed = std::clamp<int>(limit, 0, 4096);
        for (const std::int16_t c : counts) ASSERT_LE(std::abs(c), allowed);
        if (allowed < 1000) continue;
        const vec3 got = force_of(counts, p);
        ASSERT_GT(glm::dot(got, way), 0.99 * glm::length(got));
        ASSERT_LE(glm::length(got), size + 0.02);
      }
    }
  });
}

TEST(falcon_torque, hostile_numbers_never_leave_as_more_than_the_limit_or_with_another_sign) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const double nasty[] = {0.0, -0.0, NAN, inf, -inf, 1e300, -1e300, 5e-324, 1.7976931348623157e308, -62.5, 1e-9};
  std::mt19937_64 bits(23);
  const auto any = [&](std::uint64_t kind) {
    if (kind % 3 == 0) return nasty[bits() % std::size(nasty)];
    const std::uint64_t raw = bits();
    double x = 0.0;
    std::memcpy(&x, &raw, sizeof x);
    return kind % 3 == 1 ? x : 40.0 * (static_cast<double>(raw >> 11) * 0x1.0p-53 - 0.5);
  };
  const vec3 here{0.01, 0.02, 0.12};
  const auto there = *falcon_angles_at(here);
  for (int i = 0; i < 200000; ++i) {
    const vec3 force{any(bits()), any(bits()), any(bits())};
    const bool strange_pose = i % 5 == 0;
    const vec3 p = strange_pose ? vec3(any(bits()), any(bits()), any(bits())) : here;
    const falcon_angles angles = strange_pose ? falcon_angles{any(bits()), any(bits()), any(bits())} : there;
    const auto counts = falcon_counts_for(p, angles, force);
    const auto sent = decode_falcon_command(encode_falcon({.motor_counts = counts}));
    ASSERT_TRUE(sent);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(sent->motor_counts[k], counts[k]);
      ASSERT_LE(std::abs(counts[k]), falcon_counts_limit);
    }
    if (!is_finite(force)) {
      ASSERT_EQ(counts, (std::array<std::int16_t, 3>{}));
    }
    if (strange_pose || !is_finite(force)) continue;
    const vec3 unit_force = force / std::max({std::fabs(force.x), std::fabs(force.y), std::fabs(force.z), 1e-300});
    const auto torques = falcon_torques(here, there, unit_force);
    for (int k = 0; k < 3; ++k) {
      const double wanted = falcon_counts_per_n_m * (*torques)[k];
      ASSERT_GE(wanted * counts[static_cast<std::size_t>(k)], 0.0);
    }
  }
}

}  // namespace
