// Texture finer than a texel: what each filter makes of it, by what a ball feels of it.
#include "asperity/bake/texel_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "asperity/bake/bake.hpp"
#include "shapes.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::bake {
namespace {

constexpr double side_m = 0.02;
constexpr double top_m = 0.004;
constexpr double amplitude_m = 2e-5;
constexpr std::array filters{texel_filter::point, texel_filter::mean, texel_filter::highest};

// A slab with waves on its sides, in closed form.
struct waves {
  vec2 k;  // rad/m
  double phase = 0.0;
  [[nodiscard]] double height(double x, double y) const { return amplitude_m * std::sin(k.x * x + k.y * y + phase); }
};

triangle_mesh slab() {
  triangle_mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back((i & 1) != 0 ? 0.5 * side_m : -0.5 * side_m,
                                (i & 2) != 0 ? 0.5 * side_m : -0.5 * side_m, (i & 4) != 0 ? top_m : -top_m);
  constexpr std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

textured_model baked(const waves& on_top, texel_filter filter) {
  bake_settings settings;
  settings.name = "waves";
  settings.texture_size = 160;
  settings.threads = 2;
  settings.texels = filter;
  settings.relief.height_m = [on_top](const relief_point& p) {
    return p.normal.z > 0.5 ? on_top.height(p.position.x, p.position.y) : 0.0;
  };
  return bake(slab(), settings).value();
}

// The textured top as points a quarter of a texel apart.
std::vector<vec3> top_points(const textured_model& model) {
  std::vector<vec3> out;
  for (const coarse_triangle& t : model.mesh.triangles) {
    const vec2 a = t.uv[1] - t.uv[0], b = t.uv[2] - t.uv[0];
    const double texels = std::max(glm::length(a), glm::length(b)) * model.texture.width;
    const int n = static_cast<int>(std::ceil(4.0 * texels));
    const vec3 middle = model.texture.sample(t.uv[0] + (a + b) / 3.0);
    if (middle.z < 0.5 * top_m || std::max(std::abs(middle.x), std::abs(middle.y)) > 0.49 * side_m) continue;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        out.push_back(
            model.texture.sample(t.uv[0] + (static_cast<double>(i) / n) * a + (static_cast<double>(j) / n) * b));
  }
  return out;
}

// Height of a ball's lowest point where it comes down on a surface at (x, y).
class coming_down {
 public:
  coming_down(const vec2& at, double radius_m) : at_(at), radius_m_(radius_m) {}
  void on(const vec3& p) noexcept {
    const double x = p.x - at_.x, y = p.y - at_.y, left = radius_m_ * radius_m_ - x * x - y * y;
    if (left > 0.0) height_m_ = std::max(height_m_, p.z + std::sqrt(left) - radius_m_);
  }
  [[nodiscard]] double height_m() const noexcept { return height_m_; }

 private:
  vec2 at_;
  double radius_m_, height_m_ = -1.0;
};

double height_on(const waves& truth, const vec2& at, double radius_m, double step_m) {
  coming_down ball(at, radius_m);
  const double reach = 1.2 * std::sqrt(4.0 * radius_m * amplitude_m);
  for (double x = -reach; x <= reach; x += step_m)
    for (double y = -reach; y <= reach; y += step_m)
      ball.on({at.x + x, at.y + y, top_m + truth.height(at.x + x, at.y + y)});
  return ball.height_m();
}

struct miss {
  double rms = 0.0;   // of a ball's height, in amplitudes
  double mean = 0.0;  // above 0: the ball comes to rest too high
};

// Waves of that many texels in drawn directions, under balls of two to six texels' radius.
std::array<miss, 3> misses(double shortest_texels, double longest_texels, int draws, shapes::dice& d) {
  std::array<miss, 3> out{};
  constexpr int places = 40;
  const double texel_m = baked({{1e3, 0.0}, 0.0}, texel_filter::point).report.quality->texel_m;
  for (int k = 0; k < draws; ++k) {
    const double length_m = texel_m * shortest_texels * std::pow(longest_texels / shortest_texels, d());
    const double turn = d(0.0, 2.0 * std::numbers::pi);
    const waves truth{2.0 * std::numbers::pi / length_m * vec2{std::cos(turn), std::sin(turn)}, d(0.0, 6.28)};
    std::array<std::vector<vec3>, 3> points;
    for (std::size_t f = 0; f < filters.size(); ++f) points[f] = top_points(baked(truth, filters[f]));
    for (int i = 0; i < places; ++i) {
      const vec2 at{d(-0.4, 0.4) * side_m, d(-0.4, 0.4) * side_m};
      const double radius_m = d(2.0, 6.0) * texel_m;
      const double is_m = height_on(truth, at, radius_m, std::min(length_m / 12.0, texel_m / 4.0));
      for (std::size_t f = 0; f < filters.size(); ++f) {
        coming_down ball(at, radius_m);
        for (const vec3& p : points[f]) ball.on(p);
        const double off = (ball.height_m() - is_m) / amplitude_m;
        out[f].rms += off * off / (draws * places);
        out[f].mean += off / (draws * places);
      }
    }
  }
  for (miss& m : out) m.rms = std::sqrt(m.rms);
  return out;
}

std::array<miss, 3> printed_misses(double shortest, double longest, int draws, shapes::dice& d) {
  const auto m = misses(shortest, longest, draws, d);
  std::printf(
      "  waves of %.2f to %.2f texels: a ball's height misses by (rms, mean; amplitudes) point %.2f, %+.2f; mean "
      "%.2f, %+.2f; highest %.2f, %+.2f\n",
      shortest, longest, m[0].rms, m[0].mean, m[1].rms, m[1].mean, m[2].rms, m[2].mean);
  return m;
}

TEST(TexelFilter, HighestIsWhatABallRestsOn) {
  shapes::dice d(test_support::fresh_seed("TexelFilter", "4 waves of each length, 24 at length"));
  const int draws = test_support::extent(4, 24);
  const auto finer = printed_misses(0.4, 1.1, draws, d);
  EXPECT_LT(finer[2].rms, 0.8 * finer[0].rms) << "detail finer than a texel: the highest is better than a point";
  EXPECT_LT(finer[2].rms, 0.5 * finer[1].rms) << "and than the mean, which lies lower";
  printed_misses(1.1, 2.0, draws, d);
  printed_misses(2.0, 5.0, draws, d);
  const auto coarser = printed_misses(8.0, 16.0, draws, d);
  EXPECT_LT(coarser[0].rms, coarser[2].rms) << "detail that texels can show: a point is right";
  EXPECT_LT(coarser[0].rms, 0.1);
}

// The highest of a footprint is not below its mean, and on a plane all three are the same.
TEST(TexelFilter, OrdersHeightsAndKeepsPlanes) {
  shapes::dice d(test_support::fresh_seed("TexelFilter.order", "one wave"));
  const waves truth{vec2{d(2e4, 6e4), d(2e4, 6e4)}, d(0.0, 6.28)};
  const textured_model mean = baked(truth, texel_filter::mean), highest = baked(truth, texel_filter::highest);
  ASSERT_EQ(mean.texture.texels.size(), highest.texture.texels.size());
  double most_m = 0.0;
  std::size_t above = 0;
  for (std::size_t i = 0; i < mean.texture.texels.size(); ++i) {
    const glm::vec3 &low = mean.texture.texels[i], &high = highest.texture.texels[i];
    if (!(low.z > 0.9F * static_cast<float>(top_m)) || std::abs(low.x) > 0.0095F || std::abs(low.y) > 0.0095F) continue;
    EXPECT_GE(high.z, low.z - 1e-9F);
    above += high.z > low.z ? 1 : 0;
    most_m = std::max(most_m, static_cast<double>(high.z));
  }
  EXPECT_GT(above, 1000U);
  EXPECT_LE(most_m, top_m + amplitude_m + 1e-8) << "no filter goes above the original";
  const waves flat{{0.0, 0.0}, 0.0};
  const textured_model point = baked(flat, texel_filter::point);
  for (const texel_filter filter : {texel_filter::mean, texel_filter::highest}) {
    const textured_model other = baked(flat, filter);
    for (std::size_t i = 0; i < point.texture.texels.size(); ++i) {
      const glm::vec3 &p = point.texture.texels[i], &q = other.texture.texels[i];
      if (std::isnan(p.x)) continue;  // of no chart
      EXPECT_LE(glm::length(p - q), 2e-8F) << i;
    }
  }
}

}  // namespace
}  // namespace asperity::bake
