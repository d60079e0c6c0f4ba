// Hands that press with up to 20 N through the plane renderer's support planes: the probe stays on its side, and
// nothing is told. The same hands pass where a part of the planes is withheld, and every passage is told.
#include <algorithm>
#include <array>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "law/presses/press_law.hpp"
#include "law/presses/press_session.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::presses {
namespace {

using test_support::extent;
using test_support::fresh_seed;

constexpr double deepest_allowed_m = 1e-3;  // of the point that touched first, for the models' errors and the springs

/// Whether a session was deep, by what it tells or by what the contacts saw. What was deeper by half must have been told:
/// contacts tell at their own rate and the device thread looks in every tick, so close to the bound they may differ.
bool expect_told(const press_pair& pair, const session_result& s) {
  const double most_m = std::max(s.deepest_m, s.overlap_m);
  const bool told = s.reported == tick_flag::not_held;
  EXPECT_TRUE(told || s.reported == tick_flag::none) << pair.name() << ", flags " << static_cast<int>(s.reported);
  EXPECT_TRUE(told || most_m <= 1.5 * deepest_allowed_m) << pair.name() << ": not told, " << most_m * 1e3 << " mm";
  return told || most_m > deepest_allowed_m;
}

/// The pairs of an ordinary run, a thin plate and the textured bodies of the day; and those of a run at length, all.
std::vector<press_pair> pairs_of_this_run() {
  const std::vector<press_pair> all = press_pairs();
  if (test_support::at_length()) return all;
  const char* const textured = test_support::choose_seed().value % 2 == 0 ? "block on gear" : "hammer on torus";
  std::vector<press_pair> out;
  for (const press_pair& p : all) {
    for (const char* name : {"ball_2 on plate_1", textured}) {
      if (p.name() == name) out.push_back(p);
    }
  }
  return out;
}

/// The loops of a pair's sessions: contacts at a rate that is drawn, each of which comes a whole period late.
virtual_schedule drawn_schedule(std::uint64_t seed, const std::string& pair) {
  constexpr std::array<std::int64_t, 5> periods_ns{5'000'000, 2'500'000, 1'000'000, 500'000, 250'000};
  virtual_schedule out;
  out.contact_period_ns = periods_ns[test_support::seed_of(seed, pair + " rate") % periods_ns.size()];
  out.device_period_ns = std::min(out.device_period_ns, out.contact_period_ns);
  out.contact_one_period_late = true;
  return out;
}

/// Sessions of every pair under a law made of the plane renderer.
/// @param schedule_of the loops of a pair's sessions, from a seed and its name
/// @param judge called with what each pair gave
template <class Schedule, class Change, class Judge>
void press_every_pair(const char* name, const std::vector<press_pair>& pairs, int touches, Schedule&& schedule_of,
                      Change&& change, Judge&& judge) {
  const std::uint64_t seed = fresh_seed(name, std::to_string(touches) + " hands a pair");
  press_shelf shelf(press_bake::simplified);
  print_session_heading(stdout);
  for (const press_pair& pair : pairs) {
    if (const std::string why = why_without_body(pair.probe) + why_without_body(pair.fixed); !why.empty()) {
      std::printf("%s: skipped, %s\n", pair.name().c_str(), why.c_str());
      continue;
    }
    const auto probe = shelf.get(pair.probe), fixed = shelf.get(pair.fixed);
    ASSERT_TRUE(probe) << probe.error().message;
    ASSERT_TRUE(fixed) << fixed.error().message;
    session_rules rules;
    rules.when = schedule_of(seed, pair.name());
    const double period_s = 1e-9 * static_cast<double>(rules.when.contact_period_ns);
    const auto render = plane_renderer_law(period_s).render(**probe, **fixed, rules.stiffness_n_per_m);
    ASSERT_TRUE(render) << render.error().message;
    const session_row row = press_sessions(pair, **probe, **fixed, change(*render), {seed, touches, 0, 1e-4}, rules);
    print_row(stdout, row);
    std::printf("  contacts at %.0f Hz%s\n", 1.0 / period_s,
                rules.when.contact_one_period_late ? ", a period late" : "");
    EXPECT_EQ(row.sessions.size(), static_cast<std::size_t>(touches)) << pair.name();
    judge(pair, row);
  }
}

// A hand may lean a body so far over an edge that the springs of many planes give way by more than a millimetre. That is
// rare, never a passage, and told: one session of 56 on one day's seed, 1.6 mm. Rates are drawn from 200 Hz to 4 kHz.
TEST(held_sessions, no_hand_passes_support_planes) {
  int held = 0, deep = 0;
  press_every_pair(
      "held_sessions", pairs_of_this_run(), extent(1, 2), drawn_schedule,
      [](const render_function& whole) { return whole; },
      [&](const press_pair& pair, const session_row& row) {
        for (const session_result& s : row.sessions) {
          EXPECT_FALSE(s.passed) << pair.name();
          EXPECT_FALSE(s.gave_way) << pair.name();
          EXPECT_FALSE(s.ended_early) << pair.name();
          (expect_told(pair, s) ? deep : held) += 1;
          EXPECT_LE(s.deepest_m, 2.0 * deepest_allowed_m) << pair.name();
        }
      });
  EXPECT_LE(deep, 1 + held / 50);
}

// Where a body slides off an edge, the points that were told leave the surface and others come to press. Planes that were
// read again without a bound let a slab 3.6 mm into a corner; planes that held where their points had let go long before
// pushed it as if it were 4 mm deep.
TEST(held_sessions, a_slab_that_slides_off_a_corner_neither_sinks_nor_is_pushed) {
  std::vector<press_pair> pairs;
  for (const press_pair& p : press_pairs()) {
    if (p.name() == "slab on corner") pairs.push_back(p);
  }
  int sessions = 0, deep = 0;
  for (const std::int64_t period_ns : {5'000'000, 2'500'000}) {
    virtual_schedule late;
    late.contact_period_ns = period_ns;
    late.contact_one_period_late = true;
    press_every_pair(
        "held_sessions, corner", pairs, extent(8, 24), [&](std::uint64_t, const std::string&) { return late; },
        [](const render_function& whole) { return whole; },
        [&](const press_pair& pair, const session_row& row) {
          for (const session_result& s : row.sessions) {
            std::printf("  overlap %.2f mm\n", 1e3 * s.overlap_m);
            EXPECT_FALSE(s.passed);
            EXPECT_LE(s.overlap_m, 2.0 * deepest_allowed_m);
            sessions += 1;
            deep += expect_told(pair, s) ? 1 : 0;
          }
        });
  }
  EXPECT_LE(deep, 1 + sessions / 10);
}

/// Sessions under what is left of the plane renderer's planes; what the renderer knows of them, it tells.
/// @param others_stay false: where one plane is withheld, all are, until nothing is met any more
void expect_reported(const char* name, const std::vector<std::string>& names, bool others_stay, int least_deep,
                     int least_passed) {
  std::vector<press_pair> pairs;
  for (const press_pair& p : press_pairs()) {
    if (std::find(names.begin(), names.end(), p.name()) != names.end()) pairs.push_back(p);
  }
  int passed = 0, deep = 0, reported_passed = 0, reported_deep = 0;
  press_every_pair(
      name, pairs, 2, [](std::uint64_t, const std::string&) { return virtual_schedule{}; },
      [others_stay](const render_function& whole) -> render_function {
        auto kept = std::make_shared<std::vector<support_plane>>();
        auto lost = std::make_shared<bool>(false);
        return [whole, kept, lost, others_stay](const scene_pose& at, tick& out) {
          const status s = whole(at, out);
          kept->clear();
          for (const support_plane& p : out.planes) {
            if (p.depth_m < 5e-6) kept->push_back(p);
          }
          const bool met =
              std::any_of(out.planes.begin(), out.planes.end(), [](const support_plane& p) { return p.depth_m > 0.0; });
          *lost = met && (*lost || kept->size() < out.planes.size());
          if (!others_stay && *lost) {
            kept->clear();
            out.force = {};
          }
          out.planes = *kept;
          out.planes_near = {};
          return s;
        };
      },
      [&](const press_pair&, const session_row& row) {
        for (const session_result& s : row.sessions) {
          std::printf("  passed %d deepest %.2f mm at %.2f N told %d\n", s.passed ? 1 : 0, 1e3 * s.deepest_m,
                      s.passed_at_n, static_cast<int>(s.reported));
          passed += s.passed ? 1 : 0;
          deep += s.passed || s.deepest_m > deepest_allowed_m ? 1 : 0;
          reported_passed += s.passed && has(s.reported, tick_flag::passed) ? 1 : 0;
          reported_deep += (s.passed || s.deepest_m > deepest_allowed_m) && s.reported != tick_flag::none ? 1 : 0;
        }
      });
  std::printf("  %d deep, of which %d passed; reported: %d deep, %d passed\n", deep, passed, reported_deep,
              reported_passed);
  EXPECT_GE(deep, least_deep);
  EXPECT_GE(passed, least_passed);
  // All of them are told; one in five as something else than a passage, where no followed point was shallow before. Of
  // the few of a run that may be half.
  EXPECT_GE(2 * reported_passed, passed);
  EXPECT_EQ(reported_deep, deep);
}

// A law that knows a thin layer only: planes deeper than 5 um are withheld.
TEST(held_sessions, a_layer_of_planes_lets_hands_through_and_it_is_reported) {
  expect_reported("held_sessions, thin", {"block on gear"}, true, 1, 0);
}

// A law that lets go altogether where its layer is left, and so lets hands through bodies.
TEST(held_sessions, every_passage_is_reported) {
  expect_reported("held_sessions, lost", {"ball_10 on plate_5", "block on gear", "hammer on torus"}, false, 3, 2);
}

}  // namespace
}  // namespace asperity::presses
