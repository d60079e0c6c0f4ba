#include "asperity/model/mass_properties.hpp"

#include <gtest/gtest.h>

#include "asperity/core/pose.hpp"

namespace {

using namespace asperity;

coarse_mesh box_mesh(const vec3& half, const pose& T) {
  coarse_mesh m;
  for (int i = 0; i < 8; ++i) {
    m.positions.push_back(
        T * vec3((i & 1) != 0 ? half.x : -half.x, (i & 2) != 0 ? half.y : -half.y, (i & 4) != 0 ? half.z : -half.z));
  }
  constexpr std::array<std::array<std::uint32_t, 3>, 12> faces{{{0, 2, 1},
                                                                {1, 2, 3},
                                                                {4, 5, 6},
                                                                {5, 7, 6},
                                                                {0, 1, 4},
                                                                {1, 5, 4},
                                                                {2, 6, 3},
                                                                {3, 6, 7},
                                                                {0, 4, 2},
                                                                {2, 4, 6},
                                                                {1, 3, 5},
                                                                {3, 7, 5}}};
  for (const auto& f : faces) m.triangles.push_back({f, {}});
  return m;
}

TEST(mass_properties, of_a_box_are_the_textbook_ones) {
  const vec3 half{0.02, 0.03, 0.05};
  const auto p = compute_mass_properties(box_mesh(half, {}));
  EXPECT_NEAR(p.volume_m3, 8 * 0.02 * 0.03 * 0.05, 1e-18);
  EXPECT_LE(glm::length(p.centre_of_mass), 1e-16);
  EXPECT_NEAR(p.inertia_per_mass[0][0], (half.y * half.y + half.z * half.z) / 3, 1e-16);
  EXPECT_NEAR(p.inertia_per_mass[1][1], (half.x * half.x + half.z * half.z) / 3, 1e-16);
  EXPECT_NEAR(p.inertia_per_mass[2][2], (half.x * half.x + half.y * half.y) / 3, 1e-16);
  EXPECT_NEAR(p.inertia_per_mass[0][1], 0.0, 1e-18);
}

TEST(mass_properties, move_and_turn_with_the_body_even_far_from_the_origin) {
  const vec3 half{0.02, 0.03, 0.05};
  const pose T{exp_rotation({0.4, -1.0, 0.3}), {1000.0, -2000.0, 500.0}};
  const auto p = compute_mass_properties(box_mesh(half, T));
  EXPECT_NEAR(p.volume_m3, 8 * 0.02 * 0.03 * 0.05, 1e-13);
  EXPECT_LE(glm::length(p.centre_of_mass - T.position), 1e-9);
  const mat3 R = glm::mat3_cast(T.rotation);
  const mat3 expected = R * compute_mass_properties(box_mesh(half, {})).inertia_per_mass * glm::transpose(R);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(p.inertia_per_mass[i][j], expected[i][j], 1e-10);
  }
}

TEST(mass_properties, of_an_inside_out_mesh_have_a_negative_volume) {
  auto m = box_mesh({1, 1, 1}, {});
  for (auto& t : m.triangles) std::swap(t.vertex[0], t.vertex[1]);
  EXPECT_LT(compute_mass_properties(m).volume_m3, 0.0);
}

}  // namespace
