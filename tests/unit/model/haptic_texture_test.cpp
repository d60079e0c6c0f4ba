#include "asperity/model/haptic_texture.hpp"

#include <gtest/gtest.h>

namespace {

using asperity::haptic_texture;
using asperity::vec2;
using asperity::vec3;

// Texels on a bilinear surface: sampling must give it back exactly between the outermost texel centres.
haptic_texture bilinear_texture(std::uint32_t width, std::uint32_t height) {
  haptic_texture t{width, height, {}};
  for (std::uint32_t j = 0; j < height; ++j) {
    for (std::uint32_t i = 0; i < width; ++i) t.texels.emplace_back(i, j, static_cast<float>(i * j));
  }
  return t;
}

TEST(haptic_texture, texel_centres_return_the_texel) {
  const auto t = bilinear_texture(5, 3);
  for (std::uint32_t j = 0; j < 3; ++j) {
    for (std::uint32_t i = 0; i < 5; ++i) {
      const vec3 p = t.sample({(i + 0.5) / 5.0, (j + 0.5) / 3.0});
      EXPECT_LE(glm::length(p - vec3(i, j, i * j)), 1e-12);
    }
  }
}

TEST(haptic_texture, is_bilinear_between_centres) {
  const auto t = bilinear_texture(8, 4);
  const vec3 p = t.sample({(2.5 + 0.3) / 8.0, (1.5 + 0.6) / 4.0});
  EXPECT_NEAR(p.x, 2.3, 1e-12);
  EXPECT_NEAR(p.y, 1.6, 1e-12);
  EXPECT_NEAR(p.z, 2.3 * 1.6, 1e-12);
}

TEST(haptic_texture, clamps_at_the_border) {
  const auto t = bilinear_texture(8, 4);
  EXPECT_EQ(t.sample({-3.0, -3.0}), vec3(0, 0, 0));
  EXPECT_EQ(t.sample({5.0, 5.0}), vec3(7, 3, 21));
  EXPECT_EQ(t.sample({1.0, 0.0}), vec3(7, 0, 0));
}

TEST(haptic_texture, one_texel_is_constant) {
  const auto t = bilinear_texture(1, 1);
  EXPECT_EQ(t.sample({0.9, 0.1}), vec3(0, 0, 0));
}

}  // namespace
