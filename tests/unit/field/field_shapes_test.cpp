// Bodies by formula, thin and hollow and pointed: signs, distances and the place of the surface.
#include <gtest/gtest.h>
#include <random>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"
#include "unit/field/charted_model.hpp"
#include "unit/field/field_measures.hpp"

namespace asperity {
namespace {

using namespace test_support;

vec3 same(const vec3& p) { return p; }

struct shape {
  const char* name;
  textured_model model;
  std::function<double(const vec3&)> depth;  ///< distance to the surface, positive inside
  body_field field{};
};

// Distance to a turned body's outline: its sides are many enough to be round.
double outline_depth(const std::vector<vec2>& outline, const vec3& p) {
  const vec2 q(std::hypot(p.x, p.y), p.z);
  double best = 1e9;
  bool in = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const vec2 a = outline[i], b = outline[(i + 1) % outline.size()], e = b - a;
    if ((a.y > q.y) != (b.y > q.y) && q.x < a.x + (q.y - a.y) / (b.y - a.y) * e.x) in = !in;
    if (i + 1 == outline.size()) break;  // the last side is the axis, no surface
    const double u = std::clamp(glm::dot(q - a, e) / glm::dot(e, e), 0.0, 1.0);
    best = std::min(best, glm::length(q - a - u * e));
  }
  return in ? best : -best;
}

shape turned(const char* name, const std::vector<vec2>& outline, std::uint32_t sides) {
  return {name, make_charted_model(turn_outline(outline, sides), 512, same),
          [outline](const vec3& p) { return outline_depth(outline, p); }};
}

shape box(const char* name, const vec3& half) {
  return {name, make_flat_box(half, 256), [half](const vec3& p) {
            const vec3 d = half - glm::abs(p);
            const vec3 out = glm::max(-d, vec3(0.0));
            const double away = glm::length(out);
            return away > 0.0 ? -away : std::min({d.x, d.y, d.z});
          }};
}

// Made once for all tests.
const std::vector<shape>& shapes() {
  static std::vector<shape> out;
  if (!out.empty()) return out;
  out.push_back(box("block", {0.02, 0.015, 0.01}));
  out.push_back(box("plate of 1 mm", {0.03, 0.03, 0.0005}));
  out.push_back(box("square rod of 4 mm", {0.03, 0.002, 0.002}));
  out.push_back(turned("rod of 4 mm", {{0, -0.03}, {0.002, -0.03}, {0.002, 0.03}, {0, 0.03}}, 96));
  out.push_back(turned("cone", {{0, -0.01}, {0.01, -0.01}, {0, 0.02}}, 96));
  out.push_back(
      turned("cup", {{0, -0.02}, {0.015, -0.02}, {0.015, 0.02}, {0.0125, 0.02}, {0.0125, -0.0175}, {0, -0.0175}}, 96));
  for (shape& s : out) {
    s.model.name = s.name;
    s.field = built_field(s.model).value();
  }
  return out;
}

// A turned body of n sides lies within its circle by this share of the radius.
constexpr double facets = 6e-4;

TEST(BodyFieldShapes, SignsAndDistances) {
  const std::uint64_t seed = fresh_seed("shapes", "25000 points each, 100000 at length");
  for (const shape& s : shapes()) {
    SCOPED_TRACE(s.name);
    const body_field& f = s.field;
    const double diagonal = s.model.box.diagonal(), pitch = f.smooth.pitch_m;
    const double slack = facets * 0.5 * diagonal;
    std::printf("  %s\n", to_text(s.name, f, measure_zero(f, s.model, 20000, seed)).c_str());
    std::mt19937_64 random(seed_of(seed, s.name));
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int far_off = 0, inner = 0;
    double largest = 0.0;
    for (int i = 0; i < extent(25'000, 100'000); ++i) {
      const vec3 p =
          0.5 * (s.model.box.low + s.model.box.high) +
          0.55 * vec3(unit(random), unit(random), unit(random)) * (s.model.box.high - s.model.box.low + 4.0 * pitch);
      const double d = s.depth(p), whole = f.read(p).value_m;
      const coarse_reading smooth = f.coarse(p);
      // A tip is a little blunt.
      const bool at_tip = s.model.name == "cone" && glm::length(p - vec3(0.0, 0.0, 0.02)) < 3.0 * pitch;
      if (std::fabs(d) > (at_tip ? 0.35 : 0.1) * pitch + slack && (d > 0.0) != (whole > 0.0)) {
        ADD_FAILURE() << "at " << p.x << ' ' << p.y << ' ' << p.z << " D is " << whole << ", depth " << d << ", S "
                      << smooth.value_m;
      }
      // Where the smooth part has a direction, it is the distance.
      if (d > 0.0 && glm::length(smooth.slope) > 0.96) {
        ++inner;
        const double e = std::fabs(smooth.value_m - d);
        largest = std::max(largest, e);
        far_off += e > 0.16 * pitch + slack ? 1 : 0;
      }
    }
    EXPECT_EQ(far_off, 0) << largest / pitch << " pitches, of " << inner;
    EXPECT_GT(inner, 100);
    std::printf("  %-18s largest error of S inside, away from where directions meet: %.3f pitches (%d points)\n",
                s.name, largest / pitch, inner);
  }
}

TEST(BodyFieldShapes, TheSurfaceIsWhereTheTextureIs) {
  const std::uint64_t seed = fresh_seed("zero", "20000 points each");
  for (const shape& s : shapes()) {
    SCOPED_TRACE(s.name);
    const body_field& f = s.field;
    const zero_errors e = measure_zero(f, s.model, 20000, seed);
    EXPECT_LE(e.median, 3e-5);
    EXPECT_LE(e.p99_off_edges, 1e-4);
    EXPECT_LE(e.p99_at_edges, 1e-3);
    EXPECT_LE(e.largest * s.model.box.diagonal(), 0.35 * f.smooth.pitch_m);
  }
}

TEST(BodyFieldShapes, ThinWallsAreFoundAndGetTheirPitch) {
  const body_field plate = built_field(make_flat_box({0.03, 0.03, 0.0005}, 64)).value();
  EXPECT_NEAR(plate.thickness_m, 1e-3, 1e-6);
  EXPECT_LE(plate.smooth.pitch_m, 1e-3 / 3.0 + 1e-9);
  EXPECT_GT(plate.coarse(vec3(0.0)).value_m, 0.3e-3);
  EXPECT_LE(plate.smooth.value.size(), 4'000'000U);
  const body_field rod = built_field(make_flat_box({0.03, 0.002, 0.002}, 64)).value();
  EXPECT_NEAR(rod.thickness_m, 4e-3, 1e-5);
  // A wedge is thin only at its edge, which is no reason for a finer grid.
  const body_field block = built_field(make_flat_box({0.03, 0.03, 0.03}, 64)).value();
  EXPECT_NEAR(block.smooth.pitch_m, 0.06 / 96.0, 1e-9);
}

// The same fine surface over three coarse meshes: the field is the surface's, not the mesh's.
TEST(BodyFieldShapes, CoarseTessellationDoesNotShow) {
  const double radius = 0.015;
  const auto on_ball = [&](const vec3& p) {
    const vec3 n = glm::normalize(p);
    return (radius + 20e-6 * std::sin(2.0 * std::numbers::pi * n.z * radius / 2e-3)) * n;
  };
  std::vector<body_field> fields;
  field_settings settings;
  settings.pitch_m = 0.3e-3;  // the box of the coarse mesh would choose slightly different ones
  settings.relief_pitch_m = 0.1e-3;
  for (const int times : {1, 2, 3}) {
    const textured_model ball = make_charted_model(make_icosphere(radius, times), 1024, on_ball);
    fields.push_back(built_field(ball, settings).value());
  }
  std::mt19937_64 random(seed_of(fresh_seed("tessellation", "20000 points"), "tessellation"));
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  // Near the surface, where a law presses; deep inside, valleys of the stripes compete for who is nearest.
  double smooth = 0.0, slope = 0.0, whole = 0.0, deep = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const vec3 n = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    const double depth = 4e-3 * unit(random) - 0.5e-3;
    const vec3 p = (radius - depth) * n;
    const coarse_reading a = fields[0].coarse(p);
    EXPECT_NEAR(a.value_m, depth, 20e-6 + 0.3 * settings.pitch_m);
    for (std::size_t k = 1; k < 3; ++k) {
      const coarse_reading b = fields[k].coarse(p);
      deep = std::max(deep, std::fabs(a.value_m - b.value_m));
      if (depth > 0.5e-3) continue;
      smooth = std::max(smooth, std::fabs(a.value_m - b.value_m));
      slope = std::max(slope, glm::length(a.slope - b.slope));
      whole = std::max(whole, std::fabs(fields[0].read(p).value_m - fields[k].read(p).value_m));
    }
  }
  std::printf("  between tessellations: S %.2f um, its slope %.4f, D %.2f um; S to 3.5 mm deep %.1f um\n", 1e6 * smooth,
              slope, 1e6 * whole, 1e6 * deep);
  EXPECT_LE(smooth, 0.04 * settings.pitch_m);
  EXPECT_LE(slope, 0.05);
  EXPECT_LE(whole, 0.04 * settings.pitch_m);
  EXPECT_LE(deep, 0.15 * settings.pitch_m);
}

}  // namespace
}  // namespace asperity
