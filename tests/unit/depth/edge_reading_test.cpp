// Two wedges that cross: what is read of their edges, and how it changes with the pose.
#include "asperity/depth/edge_reading.hpp"

#include <gtest/gtest.h>
#include <numbers>

#include "support/motion.hpp"
#include "support/random_hulls.hpp"

namespace asperity {
namespace {

using detail::dual3;
using detail::dual6;
using test_support::derivative;
using test_support::displaced;
using test_support::largest;

constexpr double lever = 0.01;
constexpr double length = 0.02;

/// A body with one edge along x from -1 cm to 1 cm whose faces hang down at 45 degrees.
surface_cells wedge() {
  surface_cells body;
  body.settings.taper_m = 2e-3;
  body.settings.depth_limit_m = 1e-3;
  body.settings.feature_pitch_m = 1e-4;
  sharp_edge e;
  e.from_b = {-0.5 * length, 0.0, 0.0};
  e.length_m = length;
  e.face_b[0] = vec3(0, 1, -1) / std::sqrt(2.0);
  e.face_b[1] = vec3(0, -1, -1) / std::sqrt(2.0);
  body.edges.push_back(e);
  return body;
}

/// The same edge with a fine surface that waves about it.
surface_cells rough_wedge() {
  surface_cells body = wedge();
  constexpr std::uint32_t nodes = 21;
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const double s = 0.7 * i;
    body.edge_relief.emplace_back(vec3(1e-5 * std::cos(s), 3e-5 * std::sin(1.3 * s), 6e-5 * std::sin(s)));
  }
  body.edges[0].relief = nodes;
  return body;
}

shared_settings with_tau(double tau = 2e-5) {
  shared_settings s;
  s.tau_m = tau;
  return s;
}

/// The probe's edge turned over, across the fixed one, `depth` inside it.
pose across(double depth, double angle = 0.5 * std::numbers::pi) {
  return {exp_rotation({0, 0, angle}) * quat(0, 1, 0, 0), {0.0, 0.0, -depth}};
}

const surface_cells probe_wedge = wedge(), fixed_wedge = wedge(), rough = rough_wedge();
const vec3 c_a{0.003, -0.002, 0.004};  // centre of mass, body frame

cell_reading read(const pose& T_wa, const shared_settings& s = with_tau(), const surface_cells& a = probe_wedge,
                  const surface_cells& b = fixed_wedge) {
  return detail::read_edges(a, T_wa, b, {}, T_wa * c_a, {.body = 3}, s);
}

TEST(Dual6, FollowsTheRulesOfDifferentiation) {
  test::uniform_source random(1);
  const vec3 p = random.in_box(1.0), q = random.in_box(1.0), c = random.in_box(1.0), d = random.direction();
  // The same formula in dual and in plain numbers.
  const auto formula = [](const auto& x, const auto& y, const auto& z, auto&& root, auto&& step, auto one) {
    return step((x * y - z) / (one + z * z)) * root(one + x * x) + y / (one + one);
  };
  const dual3 a = detail::moving(p, c), e = detail::turning(d);
  const dual6 value = formula(
      a.x, dot(a - dual3(q), e), cross_product(a, e).z, [](const dual6& v) { return detail::square_root(v); },
      [](const dual6& v) { return detail::smooth_step(v); }, dual6(1.0));
  const auto plain = [&](const vec6& m) {
    const quat turn = exp_rotation(m.angular);
    const vec3 at = c + m.linear + turn * (p - c), dir = turn * d;
    return formula(
        at.x, glm::dot(at - q, dir), glm::cross(at, dir).z, [](double v) { return std::sqrt(v); },
        [](double v) { return smoothstep(v); }, 1.0);
  };
  EXPECT_NEAR(value.value, plain({}), 1e-15);
  EXPECT_LT(largest(value.slope - derivative(plain, 1e-6, 1.0), 1.0), 1e-9);
  EXPECT_GT(largest(value.slope, 1.0), 0.1);
  const dual6 product = dual6(2.0) * a.y;
  EXPECT_EQ(product.slope.linear, vec3(0, 2, 0));
}

TEST(EdgeReading, ThatTouchHaveTheDepthAndDirectionOfTheirCrossing) {
  for (const double angle : {0.5 * std::numbers::pi, 1.0, 2.0, -0.9}) {
    for (const double depth : {-1e-4, 0.0, 1e-5, 2e-4}) {
      const cell_reading r = read(across(depth, angle));
      ASSERT_EQ(r.samples, 1U) << depth;
      EXPECT_EQ(r.body, 3U);
      EXPECT_LT(glm::distance(r.n_ab_w, vec3(0, 0, -1)), 1e-12);
      EXPECT_NEAR(r.mass, 1e-8, 1e-20);  // no fade: the product of the two pitches
      EXPECT_FALSE(r.too_deep);
      EXPECT_LT(glm::length(vec2(r.witness_w)), 1e-12);
      EXPECT_NEAR(r.witness_w.z, -depth, 1e-15);
      EXPECT_LT(glm::distance(r.centre_w, vec3(0, 0, -0.5 * depth)), 1e-12);
      // 1 cm from all four ends a depth of 0.2 mm has faded by (1/50)^4 / 2 times four.
      EXPECT_NEAR(r.depth_m, depth, 4e-7 * std::fabs(depth) + 1e-18);
      EXPECT_EQ(r.reference_m, r.depth_m);
      EXPECT_DOUBLE_EQ(r.moment / r.mass, r.depth_m);
      EXPECT_EQ(r.overlap > 0.0, depth > 0.0);
      EXPECT_EQ(r.area_m2 > 0.0, depth > 0.0);
    }
  }
}

// Coarse edges say where they cross, their fine surface there how deep: it adds what it stands out along the normal.
TEST(EdgeReading, IsAsDeepAsTheFineSurfacesAtTheCrossing) {
  for (const double shift : {-6e-3, 0.0, 2.3e-3}) {
    pose T = across(1e-4, 1.1);
    T.position.x += shift;
    T.position.y += 1e-3;
    const cell_reading plain = read(T), a_rough = read(T, with_tau(), rough),
                       b_rough = read(T, with_tau(), wedge(), rough);
    ASSERT_EQ(plain.samples, 1U);
    vec3 slope;
    const double at_a = (inverse(T) * plain.witness_w).x + 0.5 * length, at_b = plain.witness_w.x + 0.5 * length;
    const vec3 relief_a = T.rotation * detail::read_edge_relief(rough, rough.edges[0], at_a, slope);
    const vec3 relief_b = detail::read_edge_relief(rough, rough.edges[0], at_b, slope);
    const double expected_a = glm::dot(plain.n_ab_w, relief_a), expected_b = glm::dot(-plain.n_ab_w, relief_b);
    EXPECT_GT(std::max(std::fabs(expected_a), std::fabs(expected_b)), 5e-6);  // or this would show nothing
    EXPECT_NEAR(a_rough.depth_m - plain.depth_m, expected_a, 1e-9);
    EXPECT_NEAR(b_rough.depth_m - plain.depth_m, expected_b, 1e-9);
    EXPECT_EQ(a_rough.n_ab_w, plain.n_ab_w);
  }
}

TEST(EdgeReading, DoesNotDependOnWhichWayAnEdgeIsNamed) {
  surface_cells reversed = probe_wedge;
  sharp_edge& e = reversed.edges[0];
  e.from_b += e.length_m * e.along_b;
  e.along_b = -e.along_b;
  std::swap(e.face_b[0], e.face_b[1]);
  const pose T = displaced(across(1e-4, 0.7), {}, {{1e-3, 2e-3, 0.0}, {0.05, 0.02, 0.0}});
  const cell_reading a = read(T), b = read(T, with_tau(), reversed);
  EXPECT_LT(glm::distance(a.n_ab_w, b.n_ab_w), 1e-12);
  EXPECT_NEAR(a.depth_m, b.depth_m, 1e-15);
  EXPECT_NEAR(a.mass, b.mass, 1e-12 * a.mass);
  EXPECT_LT(glm::distance(a.witness_w, b.witness_w), 1e-12);
}

TEST(EdgeReading, NothingWhereTheyDoNotCrossAsEdges) {
  const auto nothing = [](const cell_reading& r) { return r.samples == 0 && r.mass == 0.0 && r.overlap == 0.0; };
  ASSERT_FALSE(nothing(read(across(1e-4))));
  // Parallel, and nearly.
  EXPECT_TRUE(nothing(read(across(1e-4, 0.0))));
  EXPECT_TRUE(nothing(read(across(1e-4, std::asin(0.0999)))));
  EXPECT_FALSE(nothing(read(across(1e-4, std::asin(0.1005)))));
  // Past an end of either.
  for (const double way : {-1.0, 1.0}) {
    for (const vec3& along : {vec3(1, 0, 0), vec3(0, 1, 0)}) {
      pose T = across(1e-4);
      T.position += way * (0.5 * length + 1e-6) * along;
      EXPECT_TRUE(nothing(read(T)));
      T.position -= 2e-5 * way * along;
      EXPECT_FALSE(nothing(read(T)));
    }
  }
  // Out of reach.
  EXPECT_TRUE(nothing(read(across(-20.001 * 2e-5))));
  EXPECT_FALSE(nothing(read(across(-19.999 * 2e-5))));
  // The wrong side: the probe's wedge stands upright below the other, its faces do not lead back along the crossing.
  EXPECT_TRUE(nothing(read({exp_rotation({0, 0, 0.5 * std::numbers::pi}), {0.0, 0.0, -1e-4}})));
  // Lying on a side: one of its faces leads into the other body.
  EXPECT_TRUE(nothing(read(displaced(across(1e-4), {}, {{}, {0.0, 1.0, 0.0}}))));
}

TEST(EdgeReading, FadesOutAsAFaceOfEitherBeginsToLeadIn) {
  // A turn about the probe's own edge leans its faces; a turn about the fixed edge leans the crossing over that one's.
  for (const vec3& axis : {vec3(0, 1, 0), vec3(1, 0, 0)}) {
    const auto weight_at = [&](double leads_in) {
      const double turn = 0.25 * std::numbers::pi + std::asin(leads_in);
      return read(displaced(across(0.0), {}, {{}, turn * axis})).mass;
    };
    const double full = weight_at(-0.01);
    EXPECT_NEAR(full, 1e-8, 1e-18);
    EXPECT_NEAR(weight_at(0.5 * 0.17), 0.5 * full, 1e-6 * full);
    EXPECT_LT(weight_at(0.169), 1e-3 * full);
    EXPECT_GT(weight_at(0.169), 0.0);
    EXPECT_EQ(weight_at(0.171), 0.0);
  }
}

TEST(EdgeReading, TooDeepIsSaidAndHasNoWeight) {
  const cell_reading r = read(across(1.001e-3));
  EXPECT_TRUE(r.too_deep);
  EXPECT_EQ(r.samples, 0U);
  EXPECT_EQ(r.mass, 0.0);
  const cell_reading before = read(across(0.999e-3));
  EXPECT_FALSE(before.too_deep);
  EXPECT_GT(before.mass, 0.0);
  EXPECT_LT(before.mass, 1e-3 * read(across(1e-4)).mass);
}

TEST(EdgeReading, AnExtensionReachesPastTheEnd) {
  surface_cells longer = probe_wedge;
  longer.edges[0].extension_m[1] = 1e-3;
  pose T = across(1e-4);
  T.position.y -= 0.5 * length + 5e-4;  // the crossing 0.5 mm past one end of the probe's edge
  pose other = across(1e-4);
  other.position.y += 0.5 * length + 5e-4;
  EXPECT_EQ(read(T).samples + read(other).samples, 0U);
  EXPECT_EQ(read(T, with_tau(), longer).samples + read(other, with_tau(), longer).samples, 1U);
}

/// Numbers of a reading that have a slope, at a fixed reference.
double number(const cell_reading& r, int which, double reference, double tau) {
  const double s = r.samples == 0 ? 0.0 : std::exp((r.reference_m - reference) / tau);
  return which == 0 ? s * r.mass : (which == 1 ? s * r.moment : r.overlap);
}

TEST(EdgeReading, SlopesAreTheDerivativesThroughAllFades) {
  const shared_settings s = with_tau();
  test::uniform_source random(2);
  int shallow = 0, deep = 0, near_end = 0, nearly_parallel = 0, leaning = 0, outside = 0, tested = 0;
  double worst = 0.0;
  for (int n = 0; n < 3000; ++n) {
    const double depth = random(-1e-4, 0.95e-3), angle = random(0.1, n % 2 == 0 ? 0.3 : 1.57);
    const pose T = displaced(across(depth, angle), {0, 0, -depth},
                             {{random(-0.01, 0.01), random(-0.01, 0.01), 0.0}, 0.7 * random.in_box(1.0)});
    const vec3 c_w = T * c_a;
    const surface_cells &a = n % 3 == 0 ? rough : probe_wedge, &b = n % 5 == 0 ? rough : fixed_wedge;
    const cell_reading r = read(T, s, a, b);
    if (r.samples == 0 || r.mass < 1e-12) continue;
    ++tested;
    outside += r.depth_m < 0.0 ? 1 : 0;
    shallow += r.depth_m > 0.0 && r.depth_m < 2.0 * s.tau_m ? 1 : 0;
    deep += r.depth_m > 0.5e-3 ? 1 : 0;
    const vec3 e_a = T.rotation * vec3(1, 0, 0);
    nearly_parallel += glm::length(glm::cross(e_a, vec3(1, 0, 0))) < s.crossing_full ? 1 : 0;
    near_end += 0.5 * length - std::fabs(r.witness_w.x) < 1e-3 ? 1 : 0;
    for (const vec3& f : probe_wedge.edges[0].face_b) leaning += glm::dot(T.rotation * f, r.n_ab_w) > 0.0 ? 1 : 0;

    const vec6 given[3] = {r.mass_slope, r.moment_slope, r.overlap_slope};
    for (int which = 0; which < 3; ++which) {
      const vec6 expected = derivative(
          [&](const vec6& q) { return number(read(displaced(T, c_w, q), s, a, b), which, r.reference_m, s.tau_m); },
          1e-9, lever);
      const double size = std::max(largest(expected, lever), number(r, which, r.reference_m, s.tau_m) / s.tau_m);
      const double error = size > 0.0 ? largest(given[which] - expected, lever) / size : 0.0;
      worst = std::max(worst, error);
      EXPECT_LT(error, 1e-4) << "number " << which << " at depth " << r.depth_m;
    }
    for (int k = 0; k < 3; ++k) {  // and the direction's
      const vec6 expected =
          derivative([&](const vec6& q) { return read(displaced(T, c_w, q), s, a, b).n_ab_w[k]; }, 1e-7, 1.0);
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(r.turn[j][k], expected.angular[j], 1e-6);
    }
  }
  std::printf(
      "%d poses, worst error of a slope %.1g; %d outside, %d shallow, %d deep, %d near an end, %d nearly parallel, "
      "%d leaning\n",
      tested, worst, outside, shallow, deep, near_end, nearly_parallel, leaning);
  for (const int count : {outside, shallow, deep, near_end, nearly_parallel, leaning}) EXPECT_GE(count, 20);
}

TEST(EdgeReading, SlopeSumsAreThoseOfTheDepth) {
  const shared_settings s = with_tau();
  const pose T = displaced(across(3e-4, 1.0), {}, {{1e-3, 2e-3, 0.0}, {0.1, -0.1, 0.0}});
  const vec3 c_w = T * c_a;
  const cell_reading r = read(T, s);
  ASSERT_EQ(r.samples, 1U);
  const vec6 by_difference = derivative(
      [&](const vec6& q) {
        const cell_reading at = read(displaced(T, c_w, q), s);
        return at.moment / at.mass;
      },
      1e-9, lever);
  EXPECT_LT(largest((1.0 / r.mass) * r.slope_sum - by_difference, lever), 1e-6);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      EXPECT_NEAR(r.slope_product(i, j), r.slope_sum[i] * r.slope_sum[j] / r.mass, 1e-15 * r.mass);
    }
  }
}

}  // namespace
}  // namespace asperity
