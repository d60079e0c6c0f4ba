// Scenes that change under a hand: nothing is felt of a body that is gone, and a change makes no energy.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/planes/scene_editor.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/box_scene.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

const double touch_m = table_half_m.z + corner_m();  // height of the handle, where the probe touches the table
const pose at_origin{};

struct last_record {
  session_record last;
  void operator()(const session_record& r) noexcept { last = r; }
};
using session = virtual_session<plane_renderer, simulated_device, last_record>;

/// A session on an editor's scene, and what every one of its device ticks has to keep.
struct edited_session {
  scene_editor editor;
  simulated_device dev;
  std::unique_ptr<session> on;
  std::vector<std::shared_ptr<const plane_scene>> versions;  // by number, less 1
  double surplus_j = 0.0, before_j = 0.0;
  std::uint64_t back = 0, not_ok = 0, stale = 0;

  edited_session(scene_editor edited, const simulated_settings& hand, control_settings control,
                 const virtual_schedule& schedule)
      : editor(std::move(edited)), dev(hand) {
    EXPECT_TRUE(dev.open() && dev.arm());
    plane_renderer feel =
        make_plane_renderer(editor, {.reach_m = reach_for(1e-9 * static_cast<double>(schedule.periods().renewal_ns()))})
            .value();
    control.surfaces = editor.surfaces();
    control.map.T_ha.rotation = corner_down();
    on = std::make_unique<session>(std::move(feel), scene_placement{{}, vec3(0.0)}, dev, control, schedule);
  }

  /// The editor's changes, and a note of the version that they make.
  struct noted_way {
    edited_session* of;
    void collect() { of->on->scenes().collect(); }
    [[nodiscard]] bool pending() const { return of->on->scenes().pending(); }
    [[nodiscard]] bool offer(std::shared_ptr<const plane_scene> next) {
      of->versions.resize(next->version);
      of->versions.back() = next;
      return of->on->scenes().offer(std::move(next));
    }
  };
  [[nodiscard]] result<std::uint64_t> commit() {
    noted_way way{this};
    return editor.commit(way);
  }

  // Ticks until the hand feels the version.
  void step_to(std::uint64_t version) {
    for (int i = 0; i < 20 && on->scene_in_use().version < version; ++i) step();
    EXPECT_GE(on->scene_in_use().version, version);
  }
  void run_to(double until_s) {
    while (1e-9 * static_cast<double>(on->now_ns()) < until_s) step();
  }
  void step() {
    if (on->step() != status::ok) ++not_ok;
    const session_record& r = on->device().observer().last;
    if (has(r.flags, tick_flag::stands_back)) ++back;
    const felt_bodies& felt = on->felt();
    if (felt.version > 1) {
      const plane_scene& of = *versions[felt.version - 1];
      for (const body_wrench& w : felt.list) stale += of.bodies.fixed[w.body] ? 0U : 1U;
      EXPECT_EQ(felt.version, on->scene_in_use().version);
    }
    passed.push_back({r.time_ns, r.T_wa});
    if (felt.version != last_version) {
      rise_m = std::max(rise_m, r.overlap_m - last_overlap_m - way_since(r.time_ns - r.contact_age_ns));
    }
    last_version = felt.version;
    last_overlap_m = r.overlap_m;
    const double delivered_j = dev.delivered_j() - r.from_bodies_j;
    surplus_j = std::max(-0.1, surplus_j + delivered_j - before_j);
    most_surplus_j = std::max(most_surplus_j, surplus_j);
    before_j = delivered_j;
  }
  // A version is rendered where the probe was; what it has gone since, it may overlap. At most, of its points.
  [[nodiscard]] double way_since(std::int64_t then_ns) const {
    const double furthest_m = boxes().tool->box.diagonal();
    double way_m = 0.0;
    for (std::size_t i = passed.size() - 1; i > 0 && passed[i].time_ns > then_ns; --i) {
      const quat turn = passed[i].T_wa.rotation * glm::conjugate(passed[i - 1].T_wa.rotation);
      way_m += glm::distance(passed[i].T_wa.position, passed[i - 1].T_wa.position) +
               furthest_m * glm::length(log_rotation(turn));
    }
    return way_m;
  }
  struct passed_pose {
    std::int64_t time_ns;
    pose T_wa;
  };
  std::vector<passed_pose> passed;
  double most_surplus_j = 0.0;
  // By how much an overlap was deeper in the first tick of a version, but for what the probe has gone meanwhile.
  double rise_m = 0.0, last_overlap_m = 0.0;
  std::uint64_t last_version = 0;
  [[nodiscard]] double force_n() const { return glm::length(on->device().observer().last.on_hand_d.force); }
};

scene_editor with_table(const model_ptr& table, body_handle& out) {
  scene_editor editor = scene_editor::make(boxes().tool, {.bodies = 8}, few_samples).value();
  out = editor.add(table, boxes().field_of(table), at_origin).value();
  return editor;
}

constexpr double rounding_j = 2e-5;

TEST(changing_session, feels_nothing_of_a_body_that_was_removed) {
  for (const double newtons : {0.5, 5.0, 20.0}) {
    body_handle table;
    const simulated_settings hand = hand_that_presses(newtons, {0, 0, touch_m}, {0, 0, -1}, 2000.0);
    edited_session s(with_table(boxes().table, table), hand, control_settings{}, {});
    s.run_to(0.6);
    EXPECT_GT(s.force_n(), 0.5 * newtons);
    const double before_j = s.most_surplus_j;
    ASSERT_TRUE(s.editor.remove(table));
    const std::uint64_t version = s.commit().value();
    EXPECT_LT(s.on->scene_in_use().version, version);
    s.step_to(version);
    const scene_use in_use = s.on->scene_in_use();
    EXPECT_EQ(in_use.tick, s.on->device_ticks());
    EXPECT_EQ(in_use.time_ns, s.on->device().observer().last.time_ns);
    for (int i = 0; i < 200; ++i) {
      EXPECT_TRUE(s.on->felt().list.empty());
      EXPECT_EQ(s.on->device().observer().last.planes, 0U);
      s.step();
    }
    EXPECT_LT(s.force_n(), 0.2);
    EXPECT_EQ(s.stale, 0U);
    EXPECT_EQ(s.not_ok, 0U);
    EXPECT_EQ(s.back, 0U);
    EXPECT_LE(s.most_surplus_j, before_j + rounding_j);
    // It comes back where the probe is now, or around it: it stands back, and gives nothing.
    ASSERT_TRUE(s.editor.add(boxes().table, boxes().field_of(boxes().table), at_origin));
    s.step_to(s.commit().value());
    for (int i = 0; i < 100; ++i) s.step();
    EXPECT_EQ(s.back > 0, newtons < 10.0);  // a firmer press has gone right through
    EXPECT_LT(s.force_n(), 0.2);
    EXPECT_LE(s.most_surplus_j, before_j + rounding_j);
  }
}

// A table that is put 3 mm higher under a press holds the hand where it is, and is whole once the hand has lifted.
TEST(changing_session, comes_forward_behind_the_hand) {
  body_handle table;
  simulated_settings hand = hand_that_presses(4.0, {0, 0, touch_m}, {0, 0, -1}, 2000.0);
  hand.motion.kind = motion_kind::tap;
  hand.motion.amplitude_m = 0.02;
  hand.motion.frequency_hz = 2.0;
  edited_session s(with_table(boxes().table, table), hand, control_settings{}, {});
  const auto height_m = [&] { return s.on->device().observer().last.T_wa.position.z - touch_m; };
  while (s.force_n() < 2.0 && s.on->device_ticks() < 2000) s.step();
  ASSERT_GE(s.force_n(), 2.0);
  ASSERT_TRUE(s.editor.place(table, {quat(1, 0, 0, 0), {0, 0, 0.003}}));
  s.step_to(s.commit().value());
  s.step();
  EXPECT_GT(s.back, 0U);
  EXPECT_NEAR(height_m(), 0.0, 1e-4);
  double lowest_m = 1.0, lowest_later_m = 1.0, most_n = 0.0;
  bool lifted = false;
  for (int i = 0; i < 1500; ++i) {
    s.step();
    lifted = lifted || height_m() > 0.006;
    double& lowest = lifted ? lowest_later_m : lowest_m;
    lowest = std::min(lowest, height_m());
    if (lifted) most_n = std::max(most_n, s.force_n());
  }
  EXPECT_TRUE(lifted);
  EXPECT_NEAR(lowest_m, 0.0, 1e-4);
  EXPECT_NEAR(lowest_later_m, 0.003, 1e-4);
  EXPECT_GT(most_n, 2.0);
  EXPECT_FALSE(has(s.on->device().observer().last.flags, tick_flag::stands_back));
  EXPECT_LE(s.most_surplus_j, rounding_j);
  EXPECT_EQ(s.stale, 0U);
}

// Light and firm hands, 200 Hz to 10 kHz, and a change every few hundredths of a second.
TEST(changing_session, makes_no_energy) {
  const std::uint64_t seed = fresh_seed("changing_session.makes_no_energy", "5 sessions, 60 at length");
  double worst_j = 0.0, worst_rise_m = 0.0;
  int giving = 0, rising = 0;
  std::uint64_t changes = 0, touched = 0;
  const int sessions = extent(5, 60);
  for (int k = 0; k < sessions; ++k) {
    drawn d(seed_of(seed, "session", static_cast<std::uint64_t>(k)));
    const double hz[] = {200, 500, 1000, 4000, 10000};
    const auto period_ns = static_cast<std::int64_t>(1e9 / hz[k % 5]);
    const virtual_schedule schedule{0, period_ns, std::max<std::int64_t>(period_ns, 500'000), k % 2 == 1};
    simulated_settings hand = hand_that_presses(d.log_between(0.2, 20.0), {0, 0, touch_m}, {0, 0, -1}, 2000.0);
    hand.hand = k % 3 == 0 ? soft_hand() : (k % 3 == 1 ? firm_hand() : hand.hand);
    hand.motion.kind = k % 2 == 0 ? motion_kind::press : motion_kind::scrub;
    hand.motion.amplitude_m = d.between(0.002, 0.008);
    hand.motion.frequency_hz = d.between(0.5, 3.0);
    hand.motion.sideways_d = {1, 0, 0};
    control_settings control;
    control.friction.static_coefficient = control.friction.dynamic_coefficient = k % 4 == 0 ? 0.0 : 0.5;
    body_handle table;
    edited_session s(with_table(boxes().rough, table), hand, control, schedule);
    std::vector<body_handle> others;
    bool is_there = true;
    for (double until_s = 0.35; until_s < 1.2; until_s += d.between(0.01, 0.05)) {
      s.run_to(until_s);
      touched += s.on->felt().list.empty() ? 0U : 1U;
      const double what = d.between(0.0, 1.0);
      const model_ptr& m = d.between(0.0, 1.0) < 0.5 ? boxes().rough : boxes().table;
      if (!is_there) {
        table = s.editor.add(m, boxes().field_of(m), at_origin).value();
        is_there = true;
      } else if (what < 0.1) {
        ASSERT_TRUE(s.editor.remove(table));
        is_there = false;
      } else if (what < 0.5) {
        ASSERT_TRUE(s.editor.exchange(table, m, boxes().field_of(m)));
      } else if (what < 0.8) {
        ASSERT_TRUE(s.editor.place(table, {quat(1, 0, 0, 0), d.inside(3e-5)}));
      } else if (others.size() < 5) {
        others.push_back(s.editor
                             .add(boxes().cube, boxes().field_of(boxes().cube),
                                  {quat(1, 0, 0, 0), vec3(0, 0, 0.012) + d.inside(0.02)})
                             .value());
      } else {
        for (const body_handle& b : others) ASSERT_TRUE(s.editor.remove(b));
        others.clear();
      }
      if (s.commit()) ++changes;
    }
    EXPECT_EQ(s.stale, 0U) << "session " << k;
    EXPECT_EQ(s.on->device().gate().fault(), gate_fault::none) << "session " << k;
    std::printf(
        "  session %d, %g Hz: surplus %.1f uJ, overlap at a change up by %.1f um, %llu ticks with one that stands "
        "back\n",
        k, hz[k % 5], 1e6 * s.most_surplus_j, 1e6 * s.rise_m, static_cast<unsigned long long>(s.back));
    constexpr double hand_in_a_tick_m = 4e-5;  // of 200 Hz
    giving += s.most_surplus_j > rounding_j ? 1 : 0;
    rising += s.rise_m > plane_depth::let_in_m + hand_in_a_tick_m ? 1 : 0;
    worst_j = std::max(worst_j, s.most_surplus_j);
    worst_rise_m = std::max(worst_rise_m, s.rise_m);
  }
  std::printf(
      "  %llu changes, the hand in touch at %llu; most surplus %.1f uJ; %d session(s) with surplus, %d that rose\n",
      static_cast<unsigned long long>(changes), static_cast<unsigned long long>(touched), 1e6 * worst_j, giving,
      rising);
  EXPECT_EQ(giving, 0);
  // What comes upon a moving probe is judged where the probe will be if it goes on as it does; a hand may do otherwise.
  EXPECT_LE(rising, sessions / 20);
  EXPECT_LE(worst_rise_m, 3e-4);
  EXPECT_GT(touched, changes / 10);
}

// What moves by move_bodies() is the body that it names, and no other one in its slot.
TEST(changing_session, moves_nobody_else_in_its_slot) {
  body_handle table;
  const simulated_settings hand = hand_that_presses(2.0, {0, 0, touch_m}, {0, 0, -1}, 2000.0);
  edited_session s(with_table(boxes().table, table), hand, control_settings{}, {});
  const auto tell = [&](const body_handle& b, double z_m) {
    moving_bodies told;
    told.time_ns = s.on->now_ns();
    ASSERT_TRUE(told.list.push_back(
        {.body = b.slot, .T_wb = {quat(1, 0, 0, 0), {0, 0, z_m}}, .velocity_w = {}, .generation = b.generation}));
    s.on->move_bodies(told);
  };
  const auto place = [&] { return s.on->contact().placement().T_wb[table.slot].position.z; };
  tell(table, 0.001);
  for (int i = 0; i < 5; ++i) s.step();
  EXPECT_EQ(place(), 0.001);
  EXPECT_EQ(s.on->device().bodies().places().size(), 1U);
  ASSERT_TRUE(s.editor.remove(table));
  const body_handle next =
      s.editor.add(boxes().table, boxes().field_of(boxes().table), {quat(1, 0, 0, 0), {0, 0, -0.001}}).value();
  ASSERT_EQ(next.slot, table.slot);
  s.step_to(s.commit().value());
  for (int i = 0; i < 5; ++i) s.step();
  EXPECT_EQ(place(), -0.001);
  EXPECT_EQ(s.on->device().bodies().places().size(), 0U);
  EXPECT_FALSE(has(s.on->device().observer().last.flags, tick_flag::body_lost));
  tell(table, 0.002);
  std::uint64_t lost = 0;
  for (int i = 0; i < 5; ++i) {
    s.step();
    lost += has(s.on->device().observer().last.flags, tick_flag::body_lost) ? 1U : 0U;
    EXPECT_EQ(place(), -0.001);
  }
  EXPECT_GT(lost, 0U);
  tell(next, 0.003);
  for (int i = 0; i < 5; ++i) s.step();
  EXPECT_EQ(place(), 0.003);
  tell(table, 0.002);
  for (int i = 0; i < 5; ++i) s.step();
  EXPECT_EQ(place(), 0.003);
  // One that stood far away and is moved under the probe is found there.
  ASSERT_TRUE(s.editor.remove(next));
  const body_handle far =
      s.editor.add(boxes().table, boxes().field_of(boxes().table), {quat(1, 0, 0, 0), {0, 0, -1.0}}).value();
  s.step_to(s.commit().value());
  for (int i = 0; i < 300; ++i) s.step();
  EXPECT_EQ(s.on->device().observer().last.planes, 0U);
  const double below_m = s.on->device().observer().last.T_wa.position.z - touch_m - 3e-4;
  for (int i = 0; i < 5; ++i) {
    tell(far, below_m);
    s.step();
  }
  EXPECT_GT(s.on->device().observer().last.planes, 0U);
  ASSERT_TRUE(s.editor.remove(far));
  const body_handle again = s.editor.add(boxes().table, boxes().field_of(boxes().table), at_origin).value();
  s.step_to(s.commit().value());
  tell(again, 0.003);
  for (int i = 0; i < 5; ++i) s.step();
  // A version in which it stays leaves it where it was moved to.
  ASSERT_TRUE(s.editor.add(boxes().cube, boxes().field_of(boxes().cube), {quat(1, 0, 0, 0), {0, 0, 1.0}}));
  s.step_to(s.commit().value());
  EXPECT_EQ(place(), 0.003);
}

// The materials of a body that comes are felt.
TEST(changing_session, feels_the_material_of_what_comes) {
  textured_model soft = *boxes().table;
  soft.surface = material{.stiffness_n_per_m = 4000.0};
  const auto pad = std::make_shared<const textured_model>(std::move(soft));
  body_handle table;
  const simulated_settings hand = hand_that_presses(6.0, {0, 0, touch_m}, {0, 0, -1}, 2000.0);
  edited_session s(with_table(boxes().table, table), hand, control_settings{}, {});
  s.run_to(0.6);
  const auto overlap_m = [&] { return s.on->device().observer().last.overlap_m; };
  const double hard_m = overlap_m();
  ASSERT_TRUE(s.editor.exchange(table, pad, boxes().field_of(boxes().table)));
  s.step_to(s.commit().value());
  for (int i = 0; i < 300; ++i) s.step();
  EXPECT_EQ(s.back, 0U);
  EXPECT_GT(overlap_m(), 10.0 * hard_m);
  // The hard one comes back where the probe is deep in the soft one.
  ASSERT_TRUE(s.editor.exchange(table, boxes().table, boxes().field_of(boxes().table)));
  s.step_to(s.commit().value());
  for (int i = 0; i < 300; ++i) s.step();
  EXPECT_GT(s.back, 0U);
  EXPECT_LT(overlap_m(), 2.0 * hard_m);
  EXPECT_LE(s.most_surplus_j, rounding_j);
}

}  // namespace
