// The planes that the plane renderer tells, against closed forms; and what it refuses.
#include "asperity/planes/plane_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "asperity/field/field_body.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

const vec3 probe_half(0.006, 0.005, 0.004), fixed_half(0.03, 0.03, 0.01);

scene two_boxes() {
  return {std::make_shared<const textured_model>(make_flat_box(probe_half, 192)),
          {std::make_shared<const textured_model>(make_flat_box(fixed_half, 384))}};
}

std::shared_ptr<const field_scene> fields_of(const scene& bodies) {
  static const auto made = std::make_shared<const field_scene>(make_field_scene(two_boxes()).value());
  static_cast<void>(bodies);
  return made;
}

plane_renderer make_boxes() {
  scene bodies = two_boxes();
  auto fields = fields_of(bodies);
  return make_plane_renderer(std::move(bodies), std::move(fields)).value();
}

struct drawn_pose {
  std::mt19937_64 bits;
  double unit() { return std::uniform_real_distribution<double>(-1.0, 1.0)(bits); }
  vec3 vector() { return {unit(), unit(), unit()}; }
  quat rotation() { return glm::normalize(quat(unit(), unit(), unit(), unit())); }
};

const support_plane* deepest_of(const tick& t) {
  const auto at = std::max_element(t.planes.begin(), t.planes.end(),
                                   [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
  return at == t.planes.end() ? nullptr : &*at;
}

// How deep a box turned by q lies in the half space z < fixed_half.z.
double lowest_corner(const pose& T_wa) {
  double lowest = 1e30;
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0, (corner & 4) != 0 ? 1.0 : -1.0);
    lowest = std::min(lowest, (T_wa * (sign * probe_half)).z);
  }
  return lowest;
}

// A box with a corner, an edge or a face down, this deep in the face of the large box.
pose lowered(drawn_pose& draw, double depth_m) {
  pose T_wa{draw.rotation(), {0.012 * draw.unit(), 0.012 * draw.unit(), 0.0}};
  T_wa.position.z = fixed_half.z - depth_m - lowest_corner(T_wa);
  return T_wa;
}

TEST(FieldRenderer, TellsDepthAndDirectionDeepDown) {
  drawn_pose draw{std::mt19937_64(fresh_seed("FieldRenderer.TellsDepthAndDirection", "300 poses"))};
  plane_renderer feel = make_boxes();
  const std::vector<pose> T_wb{pose{}};
  tick t;
  for (int n = 0; n < 300; ++n) {
    const double depth = 1.5e-3 * (1.0 + draw.unit());  // the middle of the fixed box is 10 mm deep
    ASSERT_EQ(feel.step({lowered(draw, depth), T_wb}, t), status::ok);
    const support_plane* const p = deepest_of(t);
    ASSERT_NE(p, nullptr) << "depth " << depth;
    EXPECT_NEAR(p->depth_m, depth, 4e-6) << "pose " << n;
    EXPECT_GT(glm::dot(p->n_ab_w, vec3(0.0, 0.0, -1.0)), 0.9999) << "pose " << n << ", depth " << depth;
    EXPECT_EQ(p->body, 0U);
    ASSERT_FALSE(t.contacts.empty());
    EXPECT_EQ(t.depths[0].depth_m, p->depth_m);
    EXPECT_EQ(t.contacts[0].window.n_ab_w, p->n_ab_w);
  }
}

// A control loop keeps the probe this near, and there a spring on the deepest plane of each direction is the force. The
// face has one direction. Where an edge of the probe lies beside points of the face, its own field has another one.
TEST(FieldRenderer, PushesByItsSpringsAtTheSurface) {
  drawn_pose draw{std::mt19937_64(fresh_seed("FieldRenderer.PushesByItsSpringsAtTheSurface", "200 poses"))};
  plane_renderer feel = make_boxes();
  const std::vector<pose> T_wb{pose{}};
  tick t;
  for (int n = 0; n < 200; ++n) {
    const double depth = 1e-4 * draw.unit();
    ASSERT_EQ(feel.step({lowered(draw, depth), T_wb}, t), status::ok);
    const double k = feel.force().settings().stiffness_n_per_m;
    double by_face_n = 0.0, by_others_n = 0.0;  // along the face's normal
    for (std::size_t i = 0; i < t.contacts.size(); ++i) {
      const double pushes_n = -k * std::max(0.0, t.depths[i].depth_m) * t.depths[i].gradient.linear.z;
      (t.contacts[i].window.n_ab_w.z < -0.999 ? by_face_n : by_others_n) += pushes_n;
    }
    EXPECT_NEAR(by_face_n, k * std::max(0.0, depth), k * 8e-6) << "pose " << n;
    EXPECT_NEAR(t.force.on_probe_w.force.z, by_face_n + by_others_n, 1e-9) << "pose " << n;
  }
}

// Beside a sharp corner a smooth distance is less than the true one by a part of the field's pitch.
TEST(FieldRenderer, TellsGapsTooSmallRatherThanTooLarge) {
  drawn_pose draw{std::mt19937_64(fresh_seed("FieldRenderer.TellsGapsTooSmall", "200 poses"))};
  plane_renderer feel = make_boxes();
  const double pitch = fields_of(feel.scene())->probe->field.smooth.pitch_m;
  const std::vector<pose> T_wb{pose{}};
  tick t;
  for (int n = 0; n < 200; ++n) {
    const double gap = 0.85e-3 * (1.0 + draw.unit());
    ASSERT_EQ(feel.step({lowered(draw, -gap), T_wb}, t), status::ok);
    const support_plane* const p = deepest_of(t);
    ASSERT_NE(p, nullptr) << "gap " << gap;
    EXPECT_GT(p->depth_m, -gap - 4e-6) << "pose " << n;
    EXPECT_LT(p->depth_m, -gap + 4e-6 + 0.6 * pitch) << "pose " << n;
  }
}

TEST(FieldRenderer, PlanesFollowTheProbe) {
  drawn_pose draw{std::mt19937_64(fresh_seed("FieldRenderer.PlanesFollowTheProbe", "200 poses"))};
  plane_renderer feel = make_boxes();
  const std::vector<pose> T_wb{{draw.rotation(), 0.3 * draw.vector()}};
  const vec3 c_a = feel.scene().probe->mass.centre_of_mass;
  tick t;
  for (int n = 0; n < 200; ++n) {
    const pose T_wa = T_wb[0] * lowered(draw, 5e-4);
    ASSERT_EQ(feel.step({T_wa, T_wb}, t), status::ok);
    const support_plane before = *deepest_of(t);
    const vec6 q{2e-6 * draw.vector(), 2e-5 * draw.vector()};
    const vec3 c_w = T_wa * c_a;
    const quat turn = exp_rotation(q.angular);
    const pose moved{glm::normalize(turn * T_wa.rotation), c_w + q.linear + turn * (T_wa.position - c_w)};
    ASSERT_EQ(feel.step({moved, T_wb}, t), status::ok);
    EXPECT_NEAR(deepest_of(t)->depth_m - before.depth_m, dot(before.gradient, q), 2e-8) << "pose " << n;
  }
}

TEST(FieldRenderer, TellsGapsUpToItsReachOnly) {
  const scene bodies = two_boxes();
  for (const double reach : {0.5e-3, 2e-3, 5e-3}) {
    plane_renderer_settings s;
    s.reach_m = reach;
    plane_renderer feel = make_plane_renderer(bodies, fields_of(bodies), s).value();
    const std::vector<pose> T_wb{pose{}};
    tick t;
    ASSERT_EQ(feel.step({{quat(1, 0, 0, 0), {0.0, 0.0, 0.014 + 0.9 * reach}}, T_wb}, t), status::ok);
    EXPECT_FALSE(t.planes.empty());
    for (const support_plane& p : t.planes) EXPECT_GT(p.depth_m, -reach);
    EXPECT_EQ(t.force.on_probe_w.force, vec3(0.0));
    ASSERT_EQ(feel.step({{quat(1, 0, 0, 0), {0.0, 0.0, 0.014 + 1.1 * reach}}, T_wb}, t), status::ok);
    EXPECT_TRUE(t.planes.empty());
  }
}

// Samples of the fixed body count as well: a large face that comes down on a small body meets it between its own.
TEST(FieldRenderer, FeelsASmallFixedBodyUnderALargeFace) {
  const scene given = two_boxes();
  const scene swapped{given.fixed[0], {given.probe}};
  plane_renderer feel = make_plane_renderer(swapped).value();
  const std::vector<pose> T_wb{{glm::normalize(quat(0.9, 0.3, 0.2, 0.1)), vec3(0.0)}};
  double highest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0, (corner & 4) != 0 ? 1.0 : -1.0);
    highest = std::max(highest, (T_wb[0] * (sign * probe_half)).z);
  }
  tick t;
  ASSERT_EQ(feel.step({{quat(1, 0, 0, 0), {0.0, 0.0, highest + fixed_half.z - 3e-4}}, T_wb}, t), status::ok);
  const support_plane* const p = deepest_of(t);
  ASSERT_NE(p, nullptr);
  EXPECT_NEAR(p->depth_m, 3e-4, 4e-6);
  EXPECT_GT(glm::dot(p->n_ab_w, vec3(0.0, 0.0, -1.0)), 0.9999);
  EXPECT_GT(t.force.on_probe_w.force.z, 0.0);
}

TEST(FieldRenderer, SaysWhenItsListIsFull) {
  const scene bodies = two_boxes();
  plane_renderer_settings s;
  s.limits.leaves = 5;
  plane_renderer feel = make_plane_renderer(bodies, fields_of(bodies), s).value();
  const std::vector<pose> T_wb{pose{}};
  tick t;
  EXPECT_EQ(feel.step({{quat(1, 0, 0, 0), {0.0, 0.0, 0.0139}}, T_wb}, t), status::capacity_reached);
  EXPECT_GT(t.dropped_contacts, 0U);
  EXPECT_LE(t.planes.size(), 5U);
}

TEST(FieldRenderer, RefusesWhatItCannotRender) {
  const scene bodies = two_boxes();
  EXPECT_EQ(make_plane_renderer(scene{bodies.probe, {}}).error().code, error_code::invalid_argument);
  EXPECT_EQ(make_plane_renderer(scene{nullptr, bodies.fixed}).error().code, error_code::invalid_argument);
  EXPECT_EQ(make_plane_renderer(scene{bodies.probe, {nullptr}}).error().code, error_code::invalid_argument);
  EXPECT_EQ(make_plane_renderer(bodies, nullptr).error().code, error_code::invalid_argument);
  const scene more{bodies.probe, {bodies.fixed[0], bodies.fixed[0]}};
  EXPECT_EQ(make_plane_renderer(more, fields_of(bodies)).error().code, error_code::invalid_argument);
  for (const double reach : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    plane_renderer_settings s;
    s.reach_m = reach;
    EXPECT_EQ(make_plane_renderer(bodies, fields_of(bodies), s).error().code, error_code::invalid_argument);
  }
  plane_renderer_settings s;
  s.springs.same_direction = 1.5;
  EXPECT_EQ(make_plane_renderer(bodies, fields_of(bodies), s).error().code, error_code::invalid_argument);
  s = {};
  s.bodies.sample_pitch_m = -1.0;
  EXPECT_EQ(make_plane_renderer(bodies, s).error().code, error_code::invalid_argument);
}

TEST(FieldRenderer, CountsItsFieldsAsItsMemory) {
  const scene bodies = two_boxes();
  const plane_renderer feel = make_plane_renderer(bodies, fields_of(bodies)).value();
  const std::size_t fields = fields_of(bodies)->heap_bytes();
  EXPECT_GT(fields, 1'000'000U);
  EXPECT_GT(feel.memory_bytes(), fields + near_sample_limits{}.leaves * (sizeof(near_leaf) + sizeof(near_plane)));
  EXPECT_LT(feel.memory_bytes(), fields + 20'000'000U);
}

TEST(FieldRenderer, RefusesPosesThatAreNone) {
  plane_renderer feel = make_boxes();
  const std::vector<pose> T_wb{pose{}};
  tick t;
  EXPECT_EQ(feel.step({{quat(2, 0, 0, 0), vec3(0.0)}, T_wb}, t), status::invalid_pose);
  EXPECT_TRUE(t.planes.empty());
  EXPECT_EQ(feel.step({pose{}, {}}, t), status::not_ready);
}

// Where bodies are left out as a whole, none of their samples is near.
TEST(FieldRenderer, DoesNotLookIntoFarBodies) {
  drawn_pose draw{std::mt19937_64(fresh_seed("FieldRenderer.DoesNotLookIntoFarBodies", "300 poses"))};
  const scene alone = two_boxes();
  scene many{alone.probe, {}};
  const auto fields = fields_of(alone);
  field_scene fields_of_many{fields->probe, {}};
  std::vector<pose> T_wb;
  constexpr std::size_t near = 37;
  for (std::size_t i = 0; i < 101; ++i) {
    many.fixed.push_back(alone.fixed.front());
    fields_of_many.fixed.push_back(fields->fixed.front());
    const vec3 far_m = glm::normalize(draw.vector() + vec3(0.0, 0.0, 1e-3)) * (0.7 + 0.5 * draw.unit());
    T_wb.push_back(i == near ? pose{} : pose{draw.rotation(), far_m});
  }
  plane_renderer with =
      make_plane_renderer(many, std::make_shared<const field_scene>(std::move(fields_of_many))).value();
  plane_renderer without = make_boxes();
  const std::vector<pose> T_wb_alone{pose{}};
  std::size_t planes = 0;
  for (int i = 0; i < 100; ++i) {
    const pose T_wa = lowered(draw, 5e-4 * draw.unit());
    tick found, expected;
    ASSERT_EQ(with.step({T_wa, T_wb}, found), without.step({T_wa, T_wb_alone}, expected));
    EXPECT_EQ(with.finder().near_bodies(), 1U);
    EXPECT_EQ(with.depth().work().listed, without.depth().work().listed);
    EXPECT_EQ(found.flags, expected.flags);
    ASSERT_EQ(found.planes.size(), expected.planes.size());
    for (std::size_t p = 0; p < found.planes.size(); ++p) {
      EXPECT_EQ(found.planes[p].body, near);
      EXPECT_EQ(found.planes[p].depth_m, expected.planes[p].depth_m);
      EXPECT_EQ(found.planes[p].gradient.angular, expected.planes[p].gradient.angular);
    }
    planes += found.planes.size();
  }
  EXPECT_GT(planes, 100U);

  // At the distance where spheres decide: what is left out has no ball that could be near.
  const auto root_of = [](const field_body& body) {
    sample_ball root;
    body.samples.query(
        [&](const sample_ball& all, bool) noexcept {
          root = all;
          return sample_tree::branch_answer::away;
        },
        [](const sample_ball&, std::span<const field_sample>) noexcept {});
    return root;
  };
  const field_body &A = *fields->probe, &B = *fields->fixed.front();
  const sample_ball ball_a = root_of(A), ball_b = root_of(B);
  constexpr double reach_m = 0.002;
  plane_finder finder(fields, reach_m);
  near_samples listed;
  std::size_t left_out = 0, looked_into = 0;
  for (int i = 0; i < 200; ++i) {
    const vec3 way = glm::normalize(draw.vector() + vec3(0.0, 0.0, 1e-3));
    const pose T_wa{draw.rotation(), (0.11 + 0.05 * draw.unit()) * way};
    static_cast<void>(finder.find({T_wa, T_wb_alone}, listed));
    if (finder.near_bodies() > 0) {
      ++looked_into;
      continue;
    }
    ++left_out;
    EXPECT_EQ(listed.size(), 0U);
    EXPECT_LE(B.field.most_near(T_wa * ball_a.centre_b, ball_a.radius_m), -reach_m);
    EXPECT_LE(A.field.most_near(inverse(T_wa) * ball_b.centre_b, ball_b.radius_m), -reach_m);
  }
  EXPECT_GT(left_out, 20U);
  EXPECT_GT(looked_into, 20U);
}

}  // namespace
}  // namespace asperity
