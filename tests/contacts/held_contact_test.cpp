// The paper's contacts beyond their depth limit: the last valid direction is held, and the force goes on without a step.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "contact_meter.hpp"
#include "support/fresh_seed.hpp"
#include "support/random_hulls.hpp"

namespace asperity::contacts_test {
namespace {

/// A probe pressed into a fixed body, along a straight way with a slow turn, from a gap to the middle of that body.
struct press {
  std::string name;
  model_ptr probe, fixed;
  pose start;
  vec3 way_w{0.0};     ///< from the start to the end
  vec3 turn_rad{0.0};  ///< over the whole way

  [[nodiscard]] pose at(double share) const {
    return {glm::normalize(exp_rotation(share * turn_rad) * start.rotation), start.position + share * way_w};
  }
};

/// A press straight down or up to 10 degrees off, that begins anywhere on the middle half of the body's top.
press random_press(test::uniform_source& random, cut_into pieces) {
  model_plan plan;
  plan.pieces = pieces;
  const vec3 half_b = mm * vec3(random(12, 30), random(12, 30), random(8, 20));
  press out;
  if (random(0.0, 1.0) < 0.5) {
    const vec3 half_a = mm * vec3(random(3, 12), random(3, 12), random(6, 12));
    out.name = "box";
    out.probe = make_model(box(-half_a, half_a), plan);
    out.start.position.z = half_a.z;
  } else {
    const double radius = mm * random(6, 12);
    out.name = "roll";
    out.probe = make_model(prism(regular_polygon(24, radius), -mm * random(4, 12), mm * random(4, 12)), plan);
    out.start.position.z = radius;
  }
  out.fixed = make_model(box(-half_b, half_b), plan);
  const double tilt = random(0.0, 0.02);
  out.start.rotation = exp_rotation(tilt * random.direction()) * exp_rotation({0.0, 0.0, random(-3.0, 3.0)});
  out.start.position += vec3(0.5 * random(-half_b.x, half_b.x), 0.5 * random(-half_b.y, half_b.y), half_b.z + 0.5 * mm);
  const double down = half_b.z + 0.5 * mm;
  const double slope = std::tan(random(0.0, 0.17)), heading = random(-3.2, 3.2);
  out.way_w = down * vec3(slope * std::cos(heading), slope * std::sin(heading), -1.0);
  out.turn_rad = random(0.0, 0.05) * random.direction();
  return out;
}

/// What one way through felt like. Forces in N, tick by tick.
struct course {
  std::vector<double> force_n;
  double largest_step_n = 0.0;
  double largest_step_at = 0.0;  ///< share of the way
  std::size_t held_ticks = 0;
  std::size_t held_unflagged = 0, flagged_unheld = 0;
  double held_depth_m = 0.0;  ///< in the last tick
};

/// @param forgets  a new renderer for every pose: what the finder did before directions were held
course feel(const press& p, int ticks, bool forgets = false, bool back = false) {
  const auto fresh = [&] { return value_of(build_paper_renderer({p.probe, {p.fixed}})); };
  built_paper_renderer r = fresh();
  course out;
  vec3 last(0.0);
  for (int i = 0; i <= (back ? 2 : 1) * ticks; ++i) {
    const double share = static_cast<double>(i <= ticks ? i : 2 * ticks - i) / ticks;
    if (forgets) r = fresh();
    const std::array<pose, 1> fixed{};
    tick felt;
    if (r.step({p.at(share), fixed}, felt) != status::ok) throw std::runtime_error("a step of the renderer failed");
    const vec3 force = felt.force.on_probe_w.force;
    bool held = false;
    out.held_depth_m = 0.0;
    for (std::size_t c = 0; c < felt.contacts.size(); ++c) {
      const bool flag = has(felt.depths[c].flags, depth_flag::held_direction);
      held = held || felt.contacts[c].held;
      if (felt.contacts[c].held) out.held_depth_m = std::max(out.held_depth_m, felt.depths[c].depth_m);
      out.held_unflagged += felt.contacts[c].held && !flag ? 1U : 0U;
      out.flagged_unheld += flag && !felt.contacts[c].held ? 1U : 0U;
    }
    if (held) ++out.held_ticks;
    if (i > 0 && glm::length(force - last) > out.largest_step_n) {
      out.largest_step_n = glm::length(force - last);
      out.largest_step_at = share;
    }
    last = force;
    out.force_n.push_back(glm::length(force));
  }
  return out;
}

TEST(held_contact, the_force_does_not_step_from_the_touch_to_the_middle_of_the_body) {
  const std::uint64_t seed = test_support::fresh_seed("held_contact", "24 presses");
  constexpr int ticks = 1500;
  std::size_t held = 0;
  for (std::uint64_t i = 0; i < 24; ++i) {
    test::uniform_source random(test_support::seed_of(seed, "press", i));
    const press p = random_press(random, i % 2 == 0 ? cut_into::whole : cut_into::triangles);
    const course c = feel(p, ticks, false, true);
    const course old = feel(p, ticks / 10, true);
    const double tick_n = stiffness_n_per_m * glm::length(p.way_w) / ticks;
    std::printf("%2d %s %s: step %.3f N at %.3f (a spring's %.3f), held %zu, end %.2f N, depth %.2f mm, old step %.2f\n",
                static_cast<int>(i), p.name.c_str(), i % 2 == 0 ? "whole" : "triangles", c.largest_step_n,
                c.largest_step_at, tick_n, c.held_ticks, c.force_n[ticks], 1e3 * c.held_depth_m, old.largest_step_n);
    held += c.held_ticks > 0 ? 1U : 0U;
  }
  EXPECT_GT(held, 20U);
}

}  // namespace
}  // namespace asperity::contacts_test
