// Hands that rest on textured bodies by support planes: what they are given hardly trembles.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <utility>

#include "asperity/control/virtual_coupling.hpp"
#include "asperity/device/simulated/simulated_settings.hpp"
#include "law/presses/press_law.hpp"
#include "law/presses/rest_session.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace asperity::presses {
namespace {

using test_support::extent;
using test_support::fresh_seed;

/// Hands at rest on one pair of benchmark models.
template <class Change>
rest_row rest_on(const std::string& name, const press_choice& which, Change&& change,
                 double plane_stiffness_n_per_m = contact_law{}.stiffness_n_per_m) {
  press_shelf shelf(press_bake::simplified);
  for (const press_pair& pair : benchmark_pairs()) {
    if (pair.name() != name) continue;
    const auto probe = shelf.get(pair.probe), fixed = shelf.get(pair.fixed);
    if (!probe || !fixed) {
      ADD_FAILURE() << (probe ? fixed.error() : probe.error()).message;
      return {};
    }
    const auto render = plane_renderer_law().render(**probe, **fixed, session_rules{}.stiffness_n_per_m);
    if (!render) {
      ADD_FAILURE() << render.error().message;
      return {};
    }
    rest_row row = rest_sessions(pair, **probe, **fixed, change(*render), which, plane_stiffness_n_per_m);
    print_row(stdout, row);
    return row;
  }
  ADD_FAILURE() << name << " is no pair of benchmark models";
  return {};
}

render_function as_it_is(const render_function& whole) { return whole; }

// A hundredth of the force, or 5 mN and 0.5 mN m, is what is wanted, and all of 150 rests that were drawn keep to it. A
// day draws others: of the thirty at length one may have more, up to twice as much.
TEST(rests, hardly_tremble) {
  const int touches = 1;
  const std::uint64_t seed = fresh_seed("rests", "a hand on each of 2 of 3 pairs, 30 at length");
  print_rest_heading(stdout);
  int rests = 0, trembling = 0, far_over = 0;
  std::vector<std::string> trembled{"gear on torus", "file on block", "cad_part on gear"};
  trembled.erase(trembled.begin() + static_cast<std::ptrdiff_t>(seed % trembled.size()));
  for (const press_pair& pair : benchmark_pairs()) {
    const bool of_this_run = std::find(trembled.begin(), trembled.end(), pair.name()) != trembled.end();
    if (!test_support::at_length() && !of_this_run) continue;
    const rest_row row = rest_on(pair.name(), {seed, touches, 0, 1e-4}, as_it_is);
    for (const rest_result& r : row.rests) {
      EXPECT_FALSE(r.ended_early) << pair.name();
      if (r.restless()) continue;
      ++rests;
      trembling += r.trembles() ? 1 : 0;
      const vibration_level &force = r.heard.force, &torque = r.heard.torque;
      const bool far = force.worst_rms > std::max(0.02 * force.worst_mean, 0.01) ||
                       torque.worst_rms > std::max(0.03 * torque.worst_mean, 1e-3);
      far_over += far ? 1 : 0;
    }
  }
  std::printf("  %d of %d rests tremble by more than a hundredth\n", trembling, rests);
  EXPECT_LE(trembling, rests / 30);
  EXPECT_EQ(far_over, 0);
  EXPECT_GE(rests, 1);
}

// Two blocks face on face, their stripes in each other, where thousands of samples are nearer than 50 um: more points
// touch than a contact is given. Of 36 that were drawn the worst had 0.8 % of its force. Where the probe takes
// eight substeps on one reading of the planes, one in three of these sessions has 30 to 60.
TEST(rests, a_textured_face_on_its_like_hardly_trembles) {
  constexpr int sessions = 3;
  const std::uint64_t seed = fresh_seed("rests, faces", "3 blocks on a block");
  test_support::drawn d(seed);
  press_shelf shelf(press_bake::simplified);
  const auto block = shelf.get("block");
  ASSERT_TRUE(block);
  const textured_model& model = *(*block)->model;
  const auto render = plane_renderer_law().render(**block, **block, session_rules{}.stiffness_n_per_m);
  ASSERT_TRUE(render);
  for (int i = 0; i < sessions; ++i) {
    press_touch touch;
    touch.index = static_cast<std::uint64_t>(i);
    touch.out_w = {0.0, 0.0, 1.0};
    touch.way_w = -touch.out_w;
    touch.touching_T_wa = {exp_rotation({0.0, 0.0, d.between(-1e-3, 1e-3)}),
                           {d.between(-1e-3, 1e-3), d.between(-1e-3, 1e-3), model.box.high.z - model.box.low.z}};
    touch.point_w = {0.0, 0.0, model.box.high.z};
    rest_rules rules;
    rules.way_m = d.between(4e-3, 0.012);
    rules.ramp_s = 0.3;
    rules.settle_s = 0.2;
    rules.rest_s = 0.8;
    const rest_result r = rest_session(*render, touch, model.mass.centre_of_mass, rules, seed);
    const vibration_level &force = r.heard.force, &torque = r.heard.torque;
    std::printf("  %.1f mm: %.1f mN of %.2f N, %.2f mN m of %.1f above 60 Hz\n", 1e3 * rules.way_m,
                1e3 * force.worst_rms, force.worst_mean, 1e3 * torque.worst_rms, 1e3 * torque.worst_mean);
    EXPECT_FALSE(r.ended_early);
    EXPECT_GT(force.worst_mean, 0.1);
    EXPECT_FALSE(r.trembles());
  }
}

// A hand that presses a file on a block with 10 N, contacts one period late and without the guard. Nothing rubs, and the
// file slides and swings on its way.
TEST(rests, a_file_is_held_on_a_block_with_10_n) {
  const int touches = extent(1, 10);
  const std::uint64_t seed = fresh_seed("rests, 10 N", std::to_string(touches) + " touch(es)");
  const auto without_planes = [](const render_function& whole) -> render_function {
    return [whole](const scene_pose& at, tick& out) {
      const status s = whole(at, out);
      out.planes = {};
      out.planes_near = {};
      return s;
    };
  };
  press_shelf shelf(press_bake::simplified);
  const auto probe = shelf.get("file"), fixed = shelf.get("block");
  ASSERT_TRUE(probe && fixed);
  touch_finder finder("file on block", (*probe)->full, (*fixed)->full, {});
  int deep = 0, deep_at_rest = 0, trembling = 0, pressed = 0, worse = 0;
  for (int i = 0; i < touches; ++i) {
    const auto touch = finder.next(seed);
    ASSERT_TRUE(touch);
    for (const double hz : {1000.0, 200.0}) {
      if (hz < 500.0 && !test_support::at_length()) continue;
      const auto render = plane_renderer_law(1.0 / hz).render(**probe, **fixed, session_rules{}.stiffness_n_per_m);
      ASSERT_TRUE(render);
      rest_rules rules;
      rules.grip = 2;
      rules.way_m = 10.0 * (1.0 / firm_hand().stiffness_n_per_m + 1.0 / coupling_settings{}.stiffness_n_per_m);
      rules.contact_period_ns = static_cast<std::int64_t>(1e9 / hz);
      rules.guard = false;
      const vec3 c_a = (*probe)->model->mass.centre_of_mass;
      const auto session = [&](const char* name, const render_function& by) {
        const rest_result r = rest_session(by, *touch, c_a, rules, seed);
        std::printf(
            "  touch %llu, %.0f Hz, %s: %.2f N, deepest %.3f mm, at rest %.3f mm, %.2f N/ms, slides %.3f mm, %.4f "
            "mJ%s\n",
            static_cast<unsigned long long>(touch->index), hz, name, r.largest_n, 1e3 * r.deepest_m, 1e3 * r.rest_m,
            r.step_n_per_ms, 1e3 * r.slides_m, 1e3 * r.surplus_j, r.ended_early ? ", shut" : "");
        return r;
      };
      const rest_result held = session("planes", *render);
      const bool fast = hz > 500.0;
      EXPECT_FALSE(held.ended_early);
      EXPECT_LE(held.deepest_m, fast ? 3.5e-4 : 5e-4) << hz;
      EXPECT_LE(held.surplus_j, 1e-5) << hz;
      deep += held.deepest_m > (fast ? 1e-4 : 3e-4) ? 1 : 0;
      deep_at_rest += held.rest_m > (fast ? 1e-4 : 3e-4) ? 1 : 0;
      if (held.slides_m < 1e-3) {
        EXPECT_LE(held.step_n_per_ms, fast ? 1.0 : 2.0) << hz;
        trembling += held.step_n_per_ms > (fast ? 0.3 : 1.0) ? 1 : 0;
      }
      if (i >= 3 || !(held.largest_n > 3.0)) continue;  // the control takes a few; some slid off
      const rest_result line = session("a line", without_planes(*render));
      ++pressed;
      worse += line.deepest_m > 2.0 * held.deepest_m || line.step_n_per_ms > 1.0 || line.surplus_j > 1e-3 ? 1 : 0;
    }
  }
  // 0.1 mm and 0.3 N/ms are wanted at 1 kHz, 0.3 mm and 1 N/ms at 200 Hz. Of 200 touches that were drawn seven lie deeper
  // at 1 kHz, 0.22 mm at most, six on their way and one at rest; nine change by more, 0.47 N/ms at most. At 200 Hz one of
  // 195 that stay is over in each: 0.32 mm and 1.05 N/ms. Where the file slides again while it should rest, the force
  // changes as fast as it slides.
  EXPECT_LE(deep, 1 + touches / 4);
  EXPECT_LE(deep_at_rest, 1 + touches / 10);
  EXPECT_LE(trembling, 1 + touches / 4);
  EXPECT_TRUE(pressed == 0 || worse > 0) << "the control: a line instead of planes holds as well";
}

// The control: two rests that buzz where planes are told of the present pose alone and are a quarter as stiff, so that
// several times as many samples press as a contact can tell.
TEST(rests, buzz_on_soft_planes_of_the_present_pose) {
  constexpr double soft_n_per_m = 5e4;
  const auto of_the_present = [](const render_function& whole) -> render_function {
    return [whole](const scene_pose& at, tick& out) {
      const status s = whole(at, out);
      out.planes_near = {};
      return s;
    };
  };
  for (const auto& [name, first] : {std::pair{"gear on torus", 1}, std::pair{"file on block", 0}}) {
    if (first == 0 && !test_support::at_length()) continue;
    const press_choice which{20261123, 1, first, 1e-4};
    const rest_row buzzing = rest_on(name, which, of_the_present, soft_n_per_m), still = rest_on(name, which, as_it_is);
    ASSERT_EQ(buzzing.rests.size(), 1U);
    ASSERT_EQ(still.rests.size(), 1U);
    EXPECT_TRUE(buzzing.rests[0].trembles()) << name;
    EXPECT_LT(still.rests[0].heard.force.worst_rms, 0.5 * buzzing.rests[0].heard.force.worst_rms) << name;
  }
}

}  // namespace
}  // namespace asperity::presses
