// A symmetric tip pressed straight into a plate pushes straight back, wherever it lies between the window's samples.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "asperity/collision/convex_piece_finder.hpp"
#include "asperity/depth/cpu_depth.hpp"
#include "contact_meter.hpp"
#include "support/fresh_seed.hpp"
#include "support/random_hulls.hpp"

namespace asperity::contacts_test {
namespace {

/// A pencil that points down: a cone of `sides` sides with its tip at the origin, and a shaft above it.
polyhedron pencil(std::size_t sides, double radius, double slope, double shaft) {
  const std::vector<vec2> ring = regular_polygon(sides, radius);
  const double top = radius * slope;
  polyhedron out;
  std::vector<vec3> cap;
  for (std::size_t i = 0; i < sides; ++i) {
    const vec2 &p = ring[i], &q = ring[(i + 1) % sides];
    out.add({vec3(0.0), vec3(q, top), vec3(p, top)});
    out.add({vec3(p, top), vec3(q, top), vec3(q, top + shaft), vec3(p, top + shaft)});
    cap.emplace_back(p, top + shaft);
  }
  out.add(cap);
  return out;
}

/// A pencil in the plate, as the finder reports it, and where the window may lie beside that.
struct pressed_tip {
  scene bodies;
  pose T_wa;
  contact_set found;

  pressed_tip(scene s, const quat& turn, double depth_m) : bodies(std::move(s)) {
    convex_piece_finder finder(bodies);
    const std::array<pose, 1> fixed{};
    // From the touch to the depth, so that a deep tip has a direction to hold.
    const int steps = 1 + static_cast<int>(depth_m / (0.25 * mm));
    for (int i = 0; i <= steps; ++i) {
      T_wa = {turn, vec3(0.0, 0.0, -depth_m * i / steps)};
      if (finder.find({T_wa, fixed}, found) != status::ok) throw std::runtime_error("the finder failed");
    }
    if (found.size() != 1) throw std::runtime_error("a tip is one contact");
  }

  [[nodiscard]] const contact& only() const { return found.contacts().front(); }

  /// The depth through a window that is moved by (du, dv) samples and turned about n.
  template <class Backend>
  [[nodiscard]] penetration measure(Backend& backend, double du, double dv, double turn_rad, double tip_slope) const {
    contact c = only();
    contact_window& w = c.window;
    const double pitch_m = 2.0 * w.half_size_m / backend.settings().grid;
    w.centre_w += pitch_m * (du * w.u_w + dv * w.v_w);
    const vec3 u = std::cos(turn_rad) * w.u_w + std::sin(turn_rad) * w.v_w;
    w.v_w = glm::cross(w.n_ab_w, u);
    w.u_w = u;
    c.tip_slope = tip_slope;
    contact_set one({.contacts = 1, .triangles = found.limits().triangles});
    static_cast<void>(one.add(c, found.patch_a(only()), found.patch_b(only())));
    const std::array<pose, 1> fixed{};
    penetration out;
    if (backend.measure({T_wa, fixed}, one, std::span(&out, 1)) != status::ok) throw std::runtime_error("no depth");
    return out;
  }
};

/// Sideways part of the gradient over its normal one.
double sideways(const penetration& p) { return glm::length(vec2(p.gradient.linear)) / std::fabs(p.gradient.linear.z); }

/// Largest push of one pencil at many places of its tip between the samples, and how far its depth is read wrong.
struct seen {
  double worst = 0.0, worst_by_old_law = 0.0, error_m = 0.0;
};

seen look(const pressed_tip& tip, cpu_depth& backend, double depth_m, test::uniform_source& random) {
  seen out;
  for (int k = 0; k < 24; ++k) {
    const double du = random(-0.5, 0.5), dv = random(-0.5, 0.5), turn = random(-3.0, 3.0);
    const penetration now = tip.measure(backend, du, dv, turn, tip.only().tip_slope);
    out.worst = std::max(out.worst, sideways(now));
    out.error_m = std::max(out.error_m, std::fabs(now.soft_depth_m - depth_m));
    out.worst_by_old_law = std::max(out.worst_by_old_law, sideways(tip.measure(backend, du, dv, turn, 0.0)));
  }
  return out;
}

TEST(tip, a_symmetric_tip_is_not_pushed_sideways) {
  const std::uint64_t seed = test_support::fresh_seed("tip", "12 pencils, 5 depths, 24 places each");
  std::array<double, 2> worst{};
  for (std::uint64_t i = 0; i < 12; ++i) {
    test::uniform_source random(test_support::seed_of(seed, "pencil", i));
    // Half angles from 63 degrees to 12.5. The window is too small for the softness that the steeper half asks for.
    const bool steep = i % 2 == 1;
    const double slope = steep ? random(2.0, 4.5) : random(0.5, 2.0);
    const double radius = mm * random(2.0, 5.0), shaft = mm * random(10.0, 30.0);
    const auto sides = static_cast<std::size_t>(random(64.0, 128.9));
    const scene bodies{make_model(pencil(sides, radius, slope, shaft), {}), {make_model(slab(), {})}};
    cpu_depth backend(bodies);
    // The plate is 10 mm thick.
    for (const double depth : {0.05 * mm, 0.3 * mm, 1.0 * mm, 3.0 * mm, 5.0 * mm}) {
      SCOPED_TRACE(testing::Message() << "pencil " << i << " of slope " << slope << ", " << sides << " sides, "
                                      << 1e3 * depth << " mm deep");
      const pressed_tip tip(bodies, exp_rotation({0.0, 0.0, random(-3.0, 3.0)}), depth);
      EXPECT_NEAR(tip.only().tip_slope, slope, 0.03 * slope);
      const seen s = look(tip, backend, depth, random);
      EXPECT_LT(s.worst, steep ? 0.025 : 0.01);
      EXPECT_LT(s.error_m, 0.25 * mm);
      // Without the rule one sample decides: the push is that of a flank.
      EXPECT_GT(s.worst_by_old_law, 0.5 * slope);
      worst[steep ? 1 : 0] = std::max(worst[steep ? 1 : 0], s.worst);
    }
  }
  std::printf("  sideways at most %.2f %% of the normal force, %.2f %% where the slope is above 2\n", 100.0 * worst[0],
              100.0 * worst[1]);
}

TEST(tip, a_face_and_a_ridge_are_no_tips) {
  const std::uint64_t seed = test_support::fresh_seed("ridge", "40 poses");
  test::uniform_source random(test_support::seed_of(seed, "ridge"));
  const scene on_face{make_model(block_mm(6, 5, 8), {}), {make_model(slab(), {})}};
  convex_piece_finder finder(on_face);
  contact_set found;
  const std::array<pose, 1> fixed{};
  for (int i = 0; i < 40; ++i) {
    // Lying on a face, or tipped about an edge that stays level.
    const double tilt = i % 2 == 0 ? 0.0 : random(0.02, 1.5);
    const double low = 6.0 * std::sin(tilt) + 8.0 * std::cos(tilt);
    const pose T = pose_mm({random(-5, 5), random(-5, 5), low - random(0.0, 0.5)}, {0.0, tilt, 0.0});
    ASSERT_EQ(finder.find({T, fixed}, found), status::ok);
    ASSERT_GE(found.size(), 1U);
    for (const contact& c : found.contacts()) EXPECT_LT(c.tip_slope, 1e-6) << "tilt " << tilt;
  }
}

TEST(tip, the_softness_goes_over_without_a_step_and_keeps_what_it_was_told) {
  const asperity::detail::pair_scale pair{.tau_m = 2e-6, .reference_area_m2 = 1e-7};
  const std::uint64_t seed = test_support::fresh_seed("softness", "1000 slopes and pitches");
  test::uniform_source random(test_support::seed_of(seed, "softness"));
  for (int i = 0; i < 1000; ++i) {
    const double pitch = std::exp(random(std::log(1e-6), std::log(1e-3))), slope = std::exp(random(-12.0, 2.3));
    const asperity::detail::pair_scale at = asperity::detail::scale_at({}, pair, pitch, slope);
    const asperity::detail::pair_scale beside = asperity::detail::scale_at({}, pair, pitch, 1.0001 * slope);
    EXPECT_GE(at.tau_m, pair.tau_m);
    EXPECT_NEAR(beside.tau_m, at.tau_m, 2e-4 * at.tau_m);
    EXPECT_NEAR(beside.reference_area_m2, at.reference_area_m2, 2e-3 * at.reference_area_m2);
    EXPECT_EQ(asperity::detail::scale_at({.tau_m = 1e-6}, pair, pitch, slope).tau_m, pair.tau_m);
    EXPECT_EQ(asperity::detail::scale_at({.reference_area_m2 = 1e-7}, pair, pitch, slope).reference_area_m2,
              pair.reference_area_m2);
  }
  EXPECT_EQ(asperity::detail::scale_at({}, pair, 1e-3, 0.0).tau_m, pair.tau_m);
}

}  // namespace
}  // namespace asperity::contacts_test
