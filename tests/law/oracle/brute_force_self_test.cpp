// The oracle itself against closed forms (O1 and O5): an oracle that errs would prove nothing.
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

#include "law/oracle/brute_force.hpp"

namespace {

using namespace asperity;

// Height field z = f(x, y) over |x|, |y| <= half, with its flat coarse partner at z = 0. Upward facing.
struct height_field {
  triangle_mesh full;
  coarse_mesh coarse;

  height_field(double half, int cells, const std::function<double(double, double)>& f) {
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        const double x = half * (2.0 * i / cells - 1.0);
        const double y = half * (2.0 * j / cells - 1.0);
        full.positions.emplace_back(x, y, f(x, y));
      }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (cells + 1) + i); };
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        full.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        full.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
    coarse.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
    coarse.triangles = {{{0, 1, 2}, {}}, {{0, 2, 3}, {}}};
  }
};

constexpr std::array<std::uint32_t, 2> both{0, 1};
const contact_window down{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}, 0.008};
const quat upside_down = exp_rotation({std::numbers::pi, 0, 0});  // A's outward side faces B

TEST(brute_force, sine_ridges_on_sine_ridges_agree_with_the_closed_form) {
  const double wavelength = 0.004;
  const double amplitude_a = 0.0005;
  const double amplitude_b = 0.0003;
  const double k = 2 * std::numbers::pi / wavelength;
  const height_field a(0.012, 600, [&](double x, double) { return amplitude_a * std::cos(k * x); });
  const height_field b(0.012, 600, [&](double x, double) { return amplitude_b * std::cos(k * x); });
  const double overlap = 0.0002;
  for (const double shift : {0.0, 0.0007, 0.0013, 0.002}) {
    const auto d = oracle::measure_brute_force({&a.full, &a.coarse, both, {upside_down, {shift, 0, -overlap}}, 0.001},
                                               {&b.full, &b.coarse, both, {}, 0.003}, down, 100, 5);
    const double expected = overlap + std::sqrt(amplitude_a * amplitude_a + amplitude_b * amplitude_b +
                                                2 * amplitude_a * amplitude_b * std::cos(k * shift));
    // 600 facets over 24 mm: a facet lies below the sine by at most amplitude (k h)^2 / 8
    EXPECT_NEAR(d.dense.depth_m, expected, (amplitude_a + amplitude_b) * std::pow(k * 0.024 / 600, 2) / 4) << shift;
    EXPECT_LE(d.grid.depth_m, d.dense.depth_m);
    EXPECT_GE(d.grid.depth_m,
              d.dense.depth_m - (amplitude_a + amplitude_b) * (1 - std::cos(k * 0.016 / 100 / 2)) - 1e-9);
  }
}

TEST(brute_force, sphere_on_sphere_agrees_with_the_closed_form) {
  const double ra = 0.03;
  const double rb = 0.05;
  const auto cap = [](double r) { return [r](double x, double y) { return std::sqrt(r * r - x * x - y * y) - r; }; };
  const height_field a(0.012, 400, cap(ra));
  const height_field b(0.012, 400, cap(rb));
  const vec3 offset{0.0008, -0.0005, -0.0002};  // of A's apex from B's apex
  const auto d = oracle::measure_brute_force({&a.full, &a.coarse, both, {upside_down, offset}, 0.003},
                                             {&b.full, &b.coarse, both, {}, 0.003}, down, 64, 5);
  const double horizontal2 = offset.x * offset.x + offset.y * offset.y;
  const double expected = std::sqrt((ra + rb) * (ra + rb) - horizontal2) - (ra + rb + offset.z);
  EXPECT_NEAR(d.dense.depth_m, expected, 2e-7);
}

TEST(brute_force, the_crossing_next_to_the_coarse_surface_counts_not_another_sheet) {
  height_field a(0.012, 40, [](double, double) { return 0.0001; });
  const auto far = static_cast<std::uint32_t>(a.full.positions.size());
  const std::size_t sheet = a.full.positions.size();
  for (std::size_t i = 0; i < sheet; ++i) a.full.positions.push_back(a.full.positions[i] + vec3(0, 0, 0.01));
  for (std::size_t t = 0, n = a.full.triangles.size(); t < n; ++t) {
    auto v = a.full.triangles[t];
    for (auto& i : v) i += far;
    a.full.triangles.push_back(v);
  }
  const height_field b(0.012, 40, [](double, double) { return 0.0; });
  const auto d = oracle::measure_brute_force({&a.full, &a.coarse, both, {upside_down, {0, 0, -0.0002}}, 0.001},
                                             {&b.full, &b.coarse, both, {}, 0.003}, down, 50, 3);
  EXPECT_NEAR(d.dense.depth_m, 0.0003, 1e-12);
}

}  // namespace
