// Scenes that change: whom handles name, what is refused, and that a version that is taken feels as a scene of its own.
#include "asperity/planes/scene_editor.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "asperity/control/exchange.hpp"
#include "asperity/field/field_body.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"
#include "unit/control/drawn.hpp"

namespace asperity {
namespace {

using namespace test_support;

const vec3 tool_half(0.006, 0.005, 0.004), table_half(0.03, 0.03, 0.01), cube_half(0.012);
constexpr field_body_settings coarse{.sample_pitch_m = 3e-4};

model_ptr box(const vec3& half, std::uint32_t texels) {
  return std::make_shared<const textured_model>(make_flat_box(half, texels));
}

/// The models and their fields, made once.
struct box_set {
  model_ptr tool = box(tool_half, 192), table = box(table_half, 256), cube = box(cube_half, 192);
  std::shared_ptr<const field_scene> made =
      std::make_shared<const field_scene>(make_field_scene({tool, {table, cube}}, coarse).value());
  [[nodiscard]] field_body_ptr field_of(const model_ptr& m) const { return made->fixed[m == table ? 0 : 1]; }
};
const box_set& boxes() {
  static const box_set made;
  return made;
}

scene_editor editor_of(std::size_t slots) {
  return scene_editor::make(boxes().tool, {.bodies = slots}, coarse).value();
}

quat drawn_turn(drawn& d) { return exp_rotation(d.inside(3.0)); }

constexpr double reach_m = 0.0015;
const pose far_away{quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, 9.0)};

TEST(SceneEditor, TellsABodyFromTheOneInItsSlotBefore) {
  const box_set& of = boxes();
  scene_editor editor = editor_of(2);
  const body_handle a = editor.add(of.table, of.field_of(of.table), pose{}).value();
  const body_handle b = editor.add(of.cube, of.field_of(of.cube), far_away).value();
  EXPECT_NE(a.slot, b.slot);
  EXPECT_EQ(editor.bodies(), 2U);
  ASSERT_TRUE(editor.remove(a));
  EXPECT_FALSE(editor.has(a));
  EXPECT_TRUE(editor.has(b));
  const body_handle c = editor.add(of.cube, of.field_of(of.cube), pose{}).value();
  EXPECT_EQ(c.slot, a.slot);
  EXPECT_GT(c.generation, a.generation);
  EXPECT_EQ(editor.in_slot(c.slot), c);
  EXPECT_FALSE(editor.in_slot(7).has_value());

  const std::shared_ptr<const plane_scene> version = editor.prepare();
  EXPECT_TRUE(version->has(c));
  EXPECT_FALSE(version->has(a));
  EXPECT_FALSE(version->has({}));
  EXPECT_FALSE(version->has({9, 1}));
  // One model, one field.
  EXPECT_EQ(version->fields->fixed[b.slot], version->fields->fixed[c.slot]);
}

TEST(SceneEditor, MakesTheFieldOfAModelOnce) {
  scene_editor editor = editor_of(4);
  const model_ptr cube = box(cube_half, 96);
  const body_handle a = editor.add(cube, pose{}).value();
  const body_handle b = editor.add(cube, far_away).value();
  ASSERT_TRUE(editor.exchange(b, boxes().cube, boxes().field_of(boxes().cube)));
  const body_handle c = editor.add(cube, far_away).value();
  const auto version = editor.prepare();
  EXPECT_EQ(version->fields->fixed[a.slot], version->fields->fixed[c.slot]);
  EXPECT_NE(version->fields->fixed[a.slot], version->fields->fixed[b.slot]);
  EXPECT_EQ(version->bodies.fixed[b.slot], boxes().cube);
}

TEST(SceneEditor, RefusesWithASentence) {
  const box_set& of = boxes();
  const auto says = [](const auto& r, error_code code, const char* part) {
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, code) << r.error().message;
    EXPECT_NE(r.error().message.find(part), std::string::npos) << r.error().message;
  };
  says(scene_editor::make(nullptr), error_code::invalid_argument, "no probe");
  says(scene_editor::make(of.tool, {.bodies = 0}), error_code::invalid_argument, "scene_limits::bodies");
  says(scene_editor::make(of.tool, {.balls = 0}), error_code::invalid_argument, "scene_limits::balls");

  scene_editor editor = editor_of(1);
  says(editor.add(nullptr, pose{}), error_code::invalid_argument, "no model");
  const pose none{quat(2.0, 0.0, 0.0, 0.0), vec3(0.0)};
  says(editor.add(of.cube, none), error_code::invalid_argument, "unit quaternion");
  const body_handle a = editor.add(of.table, of.field_of(of.table), pose{}).value();
  says(editor.add(of.cube, pose{}), error_code::limit_exceeded, "scene_limits::bodies");
  says(editor.place(a, {quat(1.0, 0.0, 0.0, 0.0), vec3(std::numeric_limits<double>::quiet_NaN())}),
       error_code::invalid_argument, "finite numbers");
  says(editor.exchange(a, nullptr), error_code::invalid_argument, "no model");
  says(editor.remove({}), error_code::invalid_argument, "a handle that add() returned");
  says(editor.remove({5, 1}), error_code::invalid_argument, "slot 5");
  says(editor.place({a.slot, a.generation + 1}, pose{}), error_code::invalid_argument, "a handle that add() returned");
  ASSERT_TRUE(editor.remove(a));
  says(editor.remove(a), error_code::invalid_argument, "was removed");
  says(editor.place(a, pose{}), error_code::invalid_argument, "was removed");
  says(editor.exchange(a, of.cube), error_code::invalid_argument, "was removed");

  scene_editor small = scene_editor::make(of.tool, {.bodies = 2, .balls = 100}).value();
  says(small.add(of.table, of.field_of(of.table), pose{}), error_code::limit_exceeded, "scene_limits::balls");
  EXPECT_EQ(small.bodies(), 0U);

  says(make_plane_renderer(editor, {.reach_m = -1.0}), error_code::invalid_argument, "reach_m");
}

TEST(SceneEditor, WaitsForTheLastChangeToBeTaken) {
  const box_set& of = boxes();
  scene_editor editor = editor_of(2);
  scene_hand_over<plane_scene> way;
  std::shared_ptr<const plane_scene> used;
  const auto take = [&] {
    const bool taken = way.take(
        [&](std::shared_ptr<const plane_scene> next) noexcept { return std::exchange(used, std::move(next)); });
    EXPECT_TRUE(way.give_back());
    return taken;
  };
  EXPECT_FALSE(take());
  EXPECT_EQ(editor.commit(way).value(), 1U);
  const body_handle a = editor.add(of.cube, of.field_of(of.cube), pose{}).value();
  const auto refused = editor.commit(way);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, error_code::busy);
  ASSERT_TRUE(take());
  EXPECT_EQ(used->version, 1U);
  EXPECT_FALSE(used->has(a));
  // What was refused is not lost, and nothing is sent where nothing has changed.
  EXPECT_EQ(editor.commit(way).value(), 2U);
  ASSERT_TRUE(take());
  EXPECT_TRUE(used->has(a));
  const std::weak_ptr<const plane_scene> last = used;
  EXPECT_EQ(editor.commit(way).value(), 2U);
  EXPECT_FALSE(take());
  // What was replaced comes back, and is freed by the editor.
  ASSERT_TRUE(editor.remove(a));
  EXPECT_EQ(editor.commit(way).value(), 3U);
  ASSERT_TRUE(take());
  EXPECT_FALSE(last.expired());
  EXPECT_TRUE(editor.commit(way));
  EXPECT_TRUE(last.expired());
  // One that comes before the old one is given back would have to wait for it for ever.
  ASSERT_TRUE(editor.add(of.cube, of.field_of(of.cube), pose{}));
  ASSERT_TRUE(editor.commit(way));
  EXPECT_TRUE(way.take([&](std::shared_ptr<const plane_scene> next) noexcept {
    EXPECT_TRUE(editor.add(of.cube, of.field_of(of.cube), pose{}));
    EXPECT_FALSE(editor.commit(way));
    return std::exchange(used, std::move(next));
  }));
  EXPECT_TRUE(way.give_back());
  EXPECT_EQ(editor.commit(way).value(), 5U);
  EXPECT_TRUE(take());
}

/// The bodies of an editor's scene as one that never changes.
struct still_scene {
  std::vector<std::uint32_t> slots;
  std::vector<pose> T_wb;
  plane_renderer feel;
};
still_scene still(const plane_scene& of) {
  scene bodies{of.bodies.probe, {}};
  field_scene fields{of.fields->probe, {}};
  std::vector<std::uint32_t> slots;
  std::vector<pose> T_wb;
  for (std::uint32_t b = 0; b < of.T_wb.size(); ++b) {
    if (!of.bodies.fixed[b]) continue;
    bodies.fixed.push_back(of.bodies.fixed[b]);
    fields.fixed.push_back(of.fields->fixed[b]);
    slots.push_back(b);
    T_wb.push_back(of.T_wb[b]);
  }
  return {std::move(slots), std::move(T_wb),
          make_plane_renderer(std::move(bodies), std::make_shared<const field_scene>(std::move(fields)),
                              {.reach_m = reach_m})
              .value()};
}

void expect_same(const support_plane& a, const support_plane& b, std::uint32_t body) {
  EXPECT_EQ(a.body, body);
  EXPECT_EQ(a.sample, b.sample);
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.gradient.linear, b.gradient.linear);
  EXPECT_EQ(a.gradient.angular, b.gradient.angular);
  EXPECT_EQ(a.n_ab_w, b.n_ab_w);
  EXPECT_EQ(a.r_w, b.r_w);
}

// To the bit: planes, planes near by and how far the probe may move, with the tree of bodies and with a look at each.
TEST(ChangingScene, FeelsAsASceneThatNeverChanged) {
  const box_set& of = boxes();
  drawn d(fresh_seed("ChangingScene.FeelsAsASceneThatNeverChanged", "60 versions of up to 40 bodies, 6 poses each"));
  scene_editor editor = editor_of(40);
  std::vector<body_handle> there;
  const auto somewhere = [&] { return pose{drawn_turn(d), d.inside(0.15)}; };
  for (int i = 0; i < 15; ++i) {
    there.push_back(editor.add(of.cube, of.field_of(of.cube), somewhere()).value());
  }
  plane_renderer feel = make_plane_renderer(editor, {.reach_m = reach_m}).value();
  std::size_t planes = 0, looked = 0, left_out = 0;
  for (int version = 0; version < 60; ++version) {
    for (int change = 0; change < 4; ++change) {
      const double what = d.between(0.0, 1.0);
      const model_ptr model = d.between(0.0, 1.0) < 0.2 ? of.table : of.cube;
      if (what < 0.4 && there.size() < 40) {
        there.push_back(editor.add(model, of.field_of(model), somewhere()).value());
      } else if (!there.empty()) {
        const std::size_t i = std::min(
            there.size() - 1, static_cast<std::size_t>(d.between(0.0, 1.0) * static_cast<double>(there.size())));
        if (what < 0.6) {
          ASSERT_TRUE(editor.remove(there[i]));
          there.erase(there.begin() + static_cast<std::ptrdiff_t>(i));
        } else if (what < 0.8) {
          ASSERT_TRUE(editor.place(there[i], somewhere()));
        } else {
          ASSERT_TRUE(editor.exchange(there[i], model, of.field_of(model)));
        }
      }
    }
    const std::shared_ptr<const plane_scene> now = editor.prepare();
    const auto before = feel.take(now);
    ASSERT_NE(before, nullptr);
    ASSERT_EQ(feel.placed()->version, editor.version());
    if (there.empty()) continue;
    still_scene expected_of = still(*now);
    tick found, expected;
    // What comes where the probe is stands back; far away nothing does.
    ASSERT_EQ(feel.step({far_away, now->T_wb}, found), status::ok);
    std::vector<pose> T_wb = now->T_wb;
    std::vector<std::uint32_t> moved;
    for (int n = 0; n < 6; ++n) {
      if (n > 2) {
        const body_handle& b = there[static_cast<std::size_t>(n) % there.size()];
        T_wb[b.slot] = somewhere();
        if (std::find(moved.begin(), moved.end(), b.slot) == moved.end()) moved.push_back(b.slot);
        for (std::size_t i = 0; i < expected_of.slots.size(); ++i) expected_of.T_wb[i] = T_wb[expected_of.slots[i]];
      }
      // At the surface of one of them, or anywhere.
      const body_handle& beside = there[static_cast<std::size_t>(d.bits() % there.size())];
      pose T_wa = somewhere();
      if (n != 0) T_wa.position = T_wb[beside.slot] * vec3(d.between(-0.012, 0.012), d.between(-0.012, 0.012), 0.017);
      const double gaps_m = n % 2 == 0 ? std::numeric_limits<double>::infinity() : 0.001;
      const bool by_tree = n % 3 != 1;
      const status s = feel.step({T_wa, T_wb, gaps_m, by_tree ? now->version : 0, moved}, found);
      ASSERT_EQ(s, expected_of.feel.step({T_wa, expected_of.T_wb, gaps_m}, expected));
      EXPECT_EQ(feel.finder().near_bodies(), expected_of.feel.finder().near_bodies());
      EXPECT_EQ(found.known.way_m, expected.known.way_m);
      ASSERT_EQ(found.planes.size(), expected.planes.size());
      for (std::size_t p = 0; p < found.planes.size(); ++p) {
        expect_same(found.planes[p], expected.planes[p], expected_of.slots[expected.planes[p].body]);
      }
      EXPECT_EQ(found.force.on_probe_w.force, expected.force.on_probe_w.force);
      plane_list near, near_expected;
      const vec6 by{d.inside(1e-4), d.inside(0.004)};
      ASSERT_EQ(found.planes_near(by, -1e-4, near), expected.planes_near(by, -1e-4, near_expected));
      ASSERT_EQ(near.size(), near_expected.size());
      for (std::size_t p = 0; p < near.size(); ++p) {
        expect_same(near[p], near_expected[p], expected_of.slots[near_expected[p].body]);
      }
      planes += found.planes.size();
      looked += feel.finder().near_bodies();
      left_out += there.size() - feel.finder().near_bodies();
    }
  }
  std::printf("  %zu planes; bodies looked into %zu, left out %zu\n", planes, looked, left_out);
  EXPECT_GT(planes, 1000U);
  EXPECT_GT(left_out, looked);
}

// How deep the deepest plane is where the probe is this deep in a table at the origin; -1: there is none.
double deepest_told(plane_renderer& feel, double depth_m, tick& t) {
  const pose T_wa{quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, table_half.z + tool_half.z - depth_m)};
  EXPECT_EQ(feel.step({T_wa, feel.placed()->T_wb, 1.0, feel.placed()->version}, t), status::ok);
  double most_m = -1.0;
  for (const support_plane& p : t.planes) most_m = std::max(most_m, p.depth_m);
  return most_m;
}

TEST(ChangingScene, LetsABodyStandBackThatComesWhereTheProbeIs) {
  const box_set& of = boxes();
  scene_editor editor = editor_of(2);
  const body_handle table = editor.add(of.table, of.field_of(of.table), pose{}).value();
  plane_renderer feel = make_plane_renderer(editor, {.reach_m = reach_m}).value();
  tick t;
  const auto told_at = [&](double depth_m) { return deepest_told(feel, depth_m, t); };
  const auto stands_back = [&] { return has(t.flags, tick_flag::stands_back); };
  const auto lift = [&](double by_m) {
    ASSERT_TRUE(editor.place(table, {quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, by_m)}));
    static_cast<void>(feel.take(editor.prepare()));
  };
  constexpr double pressed_m = 5e-5, near_m = 1e-6;
  // What is there from the beginning does not stand back, however deep.
  EXPECT_NEAR(told_at(0.001), 0.001, 1e-5);
  // The same body at the same place, while it is pressed, goes on as it was; so does one that is lifted by a little.
  const double pressed_told_m = told_at(pressed_m);
  EXPECT_NEAR(pressed_told_m, pressed_m, 1e-5);
  ASSERT_TRUE(editor.exchange(table, of.table, of.field_of(of.table)));
  static_cast<void>(feel.take(editor.prepare()));
  EXPECT_EQ(told_at(pressed_m), pressed_told_m);
  EXPECT_FALSE(stands_back());
  lift(0.7 * plane_depth::let_in_m);
  EXPECT_NEAR(told_at(pressed_m), pressed_m + 0.7 * plane_depth::let_in_m, near_m);
  EXPECT_FALSE(stands_back());
  // Lifted by more, it pushes no harder, here and at poses near by.
  const double was_m = told_at(pressed_m);
  lift(0.002);
  plane_list near;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(told_at(pressed_m), was_m, near_m);
    EXPECT_TRUE(stands_back());
    ASSERT_NE(t.planes_near({vec3(0.0, 0.0, -1e-4), vec3(0.0)}, -1e-4, near), status::not_ready);
    double most_m = -1.0;
    for (const support_plane& p : near) most_m = std::max(most_m, p.depth_m);
    EXPECT_NEAR(most_m, was_m + 1e-4, near_m);
    ASSERT_EQ(t.planes_near({vec3(0.0, 0.0, 0.001), vec3(0.0)}, -1e-4, near), status::ok);
    EXPECT_TRUE(near.empty());
  }
  EXPECT_NEAR(told_at(pressed_m + 1e-4), was_m + 1e-4, near_m);
  EXPECT_NEAR(told_at(pressed_m - 2e-4), was_m - 2e-4, near_m);
  // It comes forward behind a probe that leaves it, a reach away.
  const auto go = [&](double from_m, double to_m) {
    constexpr int steps = 20;
    for (int i = 1; i <= steps; ++i) static_cast<void>(told_at(from_m + (to_m - from_m) * i / steps));
  };
  const double left_m = pressed_m - 1.5 * reach_m;
  go(pressed_m, left_m);
  EXPECT_TRUE(stands_back());
  EXPECT_NEAR(told_at(left_m + 1e-4), 1e-4 - reach_m, 1e-5);
  go(left_m, -0.002 - 1.1 * reach_m);
  EXPECT_FALSE(stands_back());
  EXPECT_NEAR(told_at(-0.0019), 0.0001, 1e-5);
  EXPECT_FALSE(stands_back());
  // A body that comes around the probe is not felt, neither here nor at poses near by, until the probe has come out: then it
  // stands back from there.
  const pose above{quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.03)};
  const body_handle cube = editor.add(of.cube, of.field_of(of.cube), above).value();
  static_cast<void>(feel.take(editor.prepare()));
  const double inside_m = -0.03 + table_half.z + tool_half.z - 0.003;  // 3 mm above the cube's middle
  for (const double deeper_m : {0.0, 5e-4, -5e-4}) {
    EXPECT_EQ(told_at(inside_m + deeper_m), -1.0);
    EXPECT_TRUE(stands_back());
    EXPECT_FALSE(has(t.flags, tick_flag::beyond_field) || has(t.flags, tick_flag::passed));
    ASSERT_NE(t.planes_near({vec3(0.0, 0.0, -1e-4), vec3(0.0)}, -1e-3, near), status::not_ready);
    EXPECT_TRUE(near.empty());
  }
  const double at_face_m = inside_m - 0.009 - tool_half.z;  // the tool's lower face on the cube's upper one
  double first_felt_m = 1.0, most_told_m = -1.0;
  for (double deep_m = 0.009 + tool_half.z; deep_m > -1e-4; deep_m -= 5e-5) {
    const double told_m = told_at(at_face_m + deep_m);
    if (told_m > -1.0 && first_felt_m == 1.0) first_felt_m = deep_m;
    most_told_m = std::max(most_told_m, told_m);
  }
  EXPECT_NEAR(first_felt_m, 0.7 * cube_half.z, 1e-4);
  EXPECT_LT(most_told_m, 1e-5);
  static_cast<void>(told_at(inside_m));
  // One that is gone stands back no more.
  ASSERT_TRUE(editor.remove(cube));
  static_cast<void>(feel.take(editor.prepare()));
  static_cast<void>(told_at(inside_m));
  EXPECT_FALSE(stands_back());
}

// A contact is in use until two periods after its pose: so a body that comes upon a probe on its way is judged where the
// probe will be by then.
TEST(ChangingScene, LooksAheadOfAProbeThatMoves) {
  const box_set& of = boxes();
  for (const double step_m : {2e-4, 5e-5, 0.0, -2e-4}) {
    scene_editor editor = editor_of(1);
    plane_renderer feel = make_plane_renderer(editor, {.reach_m = reach_m}).value();
    tick t;
    const auto told_at = [&](double depth_m) { return deepest_told(feel, depth_m, t); };
    constexpr double deep_m = 5e-4;
    static_cast<void>(told_at(deep_m - step_m));
    ASSERT_TRUE(editor.add(of.table, of.field_of(of.table), pose{}));
    static_cast<void>(feel.take(editor.prepare()));
    EXPECT_NEAR(told_at(deep_m), std::min(0.0, -2.0 * step_m), 1e-6);
    EXPECT_NEAR(told_at(deep_m + step_m), std::min(step_m, -step_m), 1e-6);
    EXPECT_LT(told_at(deep_m + 2.0 * step_m), 1e-6);
  }
}

TEST(ChangingScene, LetsAStifferBodyStandBack) {
  const box_set& of = boxes();
  const auto of_stiffness = [&](double n_per_m) {
    textured_model model = *of.table;
    model.surface = material{.stiffness_n_per_m = n_per_m};
    return std::make_shared<const textured_model>(std::move(model));
  };
  const model_ptr soft = of_stiffness(1e4), hard = of_stiffness(4e4);
  for (const bool stiffer : {true, false}) {
    scene_editor editor = editor_of(1);
    const body_handle b = editor.add(stiffer ? soft : hard, of.field_of(of.table), pose{}).value();
    plane_renderer feel = make_plane_renderer(editor, {.reach_m = reach_m}).value();
    tick t;
    const auto deepest = [&] {
      const pose T_wa{quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, table_half.z + tool_half.z - 4e-4)};
      EXPECT_EQ(feel.step({T_wa, feel.placed()->T_wb}, t), status::ok);
      double most_m = -1.0;
      for (const support_plane& p : t.planes) most_m = std::max(most_m, p.depth_m);
      return most_m;
    };
    const double was_m = deepest();
    ASSERT_TRUE(editor.exchange(b, stiffer ? hard : soft, of.field_of(of.table)));
    static_cast<void>(feel.take(editor.prepare()));
    EXPECT_NEAR(deepest(), stiffer ? 0.25 * was_m : was_m, 1e-9);
    EXPECT_EQ(has(t.flags, tick_flag::stands_back), stiffer);
  }
}

// A control: the ratio of what a tick takes with the tree to what it takes with a look at each body.
TEST(ChangingScene, LeavesOutAThousandFarBodies) {
  const box_set& of = boxes();
  drawn d(fresh_seed("ChangingScene.LeavesOutAThousandFarBodies", "1,000 bodies"));
  scene_editor editor = editor_of(1000);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(editor.add(of.cube, of.field_of(of.cube), {drawn_turn(d), d.direction() * d.between(0.3, 3.0)}));
  }
  plane_renderer feel = make_plane_renderer(editor, {.reach_m = reach_m}).value();
  tick t;
  const auto us_of = [&](std::uint64_t version) {
    std::vector<double> took_us;
    for (int n = 0; n < 3000; ++n) {
      const pose T_wa{quat(1.0, 0.0, 0.0, 0.0), vec3(1e-5 * n, 0.0, 0.0)};
      const auto begin = std::chrono::steady_clock::now();
      EXPECT_EQ(feel.step({T_wa, feel.placed()->T_wb, 1.0, version}, t), status::ok);
      took_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
      EXPECT_EQ(feel.finder().near_bodies(), 0U);
    }
    std::nth_element(took_us.begin(), took_us.begin() + 1500, took_us.end());
    return took_us[1500];
  };
  const auto begin = std::chrono::steady_clock::now();
  const auto version = editor.prepare();
  const auto made = std::chrono::steady_clock::now();
  const auto before = feel.take(version);
  const auto taken = std::chrono::steady_clock::now();
  std::printf("  a version of 1,000 bodies is made in %.0f us and taken in %.2f us\n",
              std::chrono::duration<double, std::micro>(made - begin).count(),
              std::chrono::duration<double, std::micro>(taken - made).count());
  const double each_us = us_of(0), tree_us = us_of(feel.placed()->version);
  std::printf(
      "  median of a tick beside 1,000 far bodies: %.2f us by the tree, %.2f us with a look at each: %.1f times\n",
      tree_us, each_us, each_us / tree_us);
}

}  // namespace
}  // namespace asperity
