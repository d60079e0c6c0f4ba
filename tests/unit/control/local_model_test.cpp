// Planes read again between two contacts: exact where a plane alone is wrong, and a slow contact loop feels like a fast
// one.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "asperity/control/carried_contact.hpp"
#include "asperity/control/probe_motion.hpp"
#include "asperity/control/virtual_session.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"
#include "unit/control/plane_bodies.hpp"
#include "unit/control/plane_session.hpp"
#include "unit/control/wavy_reader.hpp"

namespace asperity {
namespace {

using namespace test_support;

wall wavy(std::uint32_t body) { return {.amplitude_m = 1e-4, .wave_m = 1.5e-3, .body = body}; }

// A probe and a body that moved a little since the contact: at the probe's pose, with the body carried to the end of its
// way, the plane says what the pair has there. The way of a plane that nobody read is off by the wave.
TEST(local_model, is_exact_where_the_probe_is) {
  drawn d(seed_of(fresh_seed("local_model.is_exact_where_the_probe_is", "500 contacts"), "contacts"));
  double unread_off_m = 0.0;
  for (int i = 0; i < 500; ++i) {
    const auto any_pose = [&] { return pose{exp_rotation(d.inside(2.0)), d.inside(0.2)}; };
    const auto nudged = [&](const pose& T) {
      return pose{exp_rotation(d.inside(1e-3)) * T.rotation, T.position + d.inside(3e-5)};
    };
    wavy_reader reader;
    reader.of = wavy(3);
    reader.points_c = {d.inside(0.01)};
    const pose then_T_wb = any_pose();
    linear_contact contact;
    contact.T_wc = {exp_rotation(d.inside(2.0)), then_T_wb * d.inside(2e-3)};
    static_cast<void>(contact.planes.push_back(reader.plane(contact.T_wc, then_T_wb)));
    static_cast<void>(contact.planes.push_back(contact.planes[0]));
    contact.planes[1].body = 4;  // nobody says where it is
    contact.reader = &reader;
    const bool moves = i % 2 == 0;
    const pose now_T_wc = nudged(contact.T_wc), now_T_wb = moves ? nudged(then_T_wb) : then_T_wb;
    static_cast<void>(contact.places.push_back({3, then_T_wb, moves ? 7U : 0U}));
    if (moves) static_cast<void>(contact.bodies.push_back({3, then_T_wb, 7}));
    const std::array<body_way, 1> ways{body_way{3, now_T_wb, {}, 7}};
    const std::span<const body_way> gone = moves ? std::span<const body_way>(ways) : std::span<const body_way>();

    local_model model(true), off(false);
    EXPECT_EQ(&off.planes_of(contact, gone, now_T_wc), &contact.planes);
    const auto depth_of = [&](const support_planes& planes) {
      support_planes carried = planes;
      body_velocities none;
      const carried_contact with(contact, planes, gone);
      if (with.moves()) with.at(now_T_wc, 0.0, 0.0, carried, none);
      return carried[0].depth_m + dot(carried[0].gradient, pose_difference(now_T_wc, contact.T_wc));
    };
    const double truth_m = reader.plane(now_T_wc, now_T_wb).depth_m;
    const support_planes& read = model.planes_of(contact, gone, now_T_wc);
    EXPECT_NEAR(depth_of(read), truth_m, 1e-12) << i;
    EXPECT_EQ(read[1].depth_m, contact.planes[1].depth_m);
    unread_off_m = std::max(unread_off_m, std::fabs(depth_of(contact.planes) - truth_m));
  }
  EXPECT_GT(unread_off_m, 5e-7);
}

// A probe that goes on after a reading: planes that may press say what is true where it has come to, with their body where
// it is then; those with a gap stay as they were read.
TEST(local_model, follows_a_probe_with_the_planes_that_may_press) {
  drawn d(
      seed_of(fresh_seed("local_model.follows_a_probe_with_the_planes_that_may_press", "500 contacts"), "contacts"));
  constexpr double may_press_m = 2e-5;
  int followed = 0, stayed = 0;
  for (int i = 0; i < 500; ++i) {
    wavy_reader reader;
    reader.of = wavy(0);
    for (int p = 1; p < 8; ++p) reader.points_c.push_back(d.inside(1e-3));
    reader.points_c.front() = d.inside(1e-3);
    linear_contact contact = contact_at(reader, {exp_rotation(d.inside(0.02)), {0.0, 0.0, d.between(0.0, 4e-4)}});
    const bool moves = i % 2 == 0;
    if (moves) {
      contact.places[0].generation = 7;
      static_cast<void>(contact.bodies.push_back({0, {}, 7}));
    }
    const pose first_T_wb = moves ? pose{exp_rotation(d.inside(1e-3)), d.inside(1.2e-5)} : pose{};
    const std::array<body_way, 1> ways{body_way{0, first_T_wb, {d.inside(1.2e-5), d.inside(1e-3)}, 7}};
    const std::span<const body_way> gone = moves ? std::span<const body_way>(ways) : std::span<const body_way>();
    const double part = d.between(0.0, 1.0);
    const pose first_T_wc{contact.T_wc.rotation, contact.T_wc.position + d.inside(2.4e-5)};
    const pose then_T_wc{first_T_wc.rotation, first_T_wc.position + d.inside(1.2e-5)};
    const pose then_T_wb = moves ? ways[0].after(part) : pose{};

    local_model model(true);
    model.take_contact();
    const support_planes& planes = model.planes_of(contact, gone, first_T_wc);
    const support_planes before = planes;
    model.follow(contact, gone, then_T_wc, part);
    const pose about_body = inverse(then_T_wb) * then_T_wc;
    const vec6 moved = pose_difference(about_body, contact.T_wc);
    for (std::size_t p = 0; p < planes.size(); ++p) {
      const auto said_m = [&](const support_plane& of) { return of.depth_m + dot(of.gradient, moved); };
      if (said_m(before[p]) >= -may_press_m) {
        ++followed;
        EXPECT_NEAR(said_m(planes[p]), reader.plane(then_T_wc, then_T_wb, p).depth_m, 1e-12) << i << ": " << p;
      } else {
        ++stayed;
        EXPECT_EQ(planes[p].depth_m, before[p].depth_m) << i << ": " << p;
      }
    }
  }
  EXPECT_GT(followed, 500);
  EXPECT_GT(stayed, 500);
}

// How deep the point of a probe at the end of a way is: by the plane that the model uses there, by the contact's plane,
// which is the wall, and in truth.
struct depths {
  double used_m, wall_m, true_m;
};
depths depths_at(local_model& model, const wavy_reader& reader, const linear_contact& contact, const vec3& way_w) {
  const pose T_wc{contact.T_wc.rotation, contact.T_wc.position + way_w};
  const vec6 moved = pose_difference(T_wc, contact.T_wc);
  const support_plane& used = model.planes_of(contact, {}, T_wc)[0];
  const support_plane& wall = contact.planes[0];
  return {used.depth_m + dot(used.gradient, moved), wall.depth_m + dot(wall.gradient, moved),
          reader.plane(T_wc, {}).depth_m};
}

// By how much a reading may let go of a probe whose point has gone this way in the time since its contact came.
double give_after(double way_m, double age_s) {
  constexpr double lets_go_m_per_s = 0.1;
  return std::clamp(std::min(way_m - 1e-4, lets_go_m_per_s * age_s), 5e-6, 2e-4);
}

// A contact of one point with waves, from whose slopes a reading soon lets go.
struct contact_with_waves {
  /// @param depth_m of the point at the contact's pose
  contact_with_waves(drawn& d, double depth_m, const wall& of = {.amplitude_m = 1e-3, .wave_m = 6e-3}) {
    reader.of = of;
    vec3 at_w = d.inside(3e-3);
    at_w.z += reader.of.depth_m(at_w) - depth_m;
    contact = contact_at(reader, {exp_rotation(d.inside(1.0)), at_w});
  }
  contact_with_waves(const contact_with_waves&) = delete;  // the contact refers to the reader
  contact_with_waves& operator=(const contact_with_waves&) = delete;

  [[nodiscard]] depths after(const vec3& way_w) { return depths_at(model, reader, contact, way_w); }

  wavy_reader reader{};
  linear_contact contact{};
  local_model model{true};
};

// High waves, and sharp ones, from whose slopes a plane soon lets go. The depth that is used is the true one as far as it
// lets go by no more than it may; then that of the contact's plane less that. It steps nowhere on the way.
TEST(local_model, lets_go_of_a_probe_by_so_much_and_then_holds_it) {
  drawn d(seed_of(fresh_seed("local_model.lets_go_of_a_probe_by_so_much_and_then_holds_it", "200 ways"), "ways"));
  int held = 0, held_soon = 0, read = 0;
  for (int i = 0; i < 200; ++i) {
    const wall high{.amplitude_m = 1e-3, .wave_m = 6e-3}, sharp{.amplitude_m = 3e-4, .wave_m = 1e-3};
    contact_with_waves waves(d, d.between(-2e-4, 2e-3), i % 2 == 0 ? high : sharp);
    const vec3 along = glm::normalize(d.inside(1.0));
    static_cast<void>(waves.after(vec3(0.0)));
    waves.model.pass(d.between(0.0, 5e-3));
    waves.model.take_contact();  // a new one is of no age
    double before_m = waves.after(vec3(0.0)).used_m;
    const double age_s = d.between(-2e-3, 4e-3);  // a third of the contacts have only come
    if (age_s > 0.0) waves.model.pass(age_s);
    constexpr double step_m = 1e-5, steepest = 3.0;
    for (double way_m = 0.0; way_m < 4e-3; way_m += step_m) {
      const depths now = waves.after(way_m * along);
      const double give_m = give_after(way_m, age_s);
      const bool holds = now.true_m < now.wall_m - give_m;
      (holds ? held : read) += 1;
      held_soon += holds && way_m < 1e-4 ? 1 : 0;
      ASSERT_NEAR(now.used_m, holds ? now.wall_m - give_m : now.true_m, 1e-12) << i << ": " << way_m;
      ASSERT_LT(std::fabs(now.used_m - before_m), steepest * step_m) << i << ": " << way_m;
      before_m = now.used_m;
    }
  }
  EXPECT_GT(held, 4000);
  EXPECT_GT(held_soon, 50);
  EXPECT_GT(read, 4000);
}

// A contact that comes late, when its point is off the surface, does not push the probe out, though its plane would; a
// probe that goes on into the wall is held.
TEST(local_model, is_not_pushed_by_a_plane_whose_point_had_let_go) {
  drawn d(seed_of(fresh_seed("local_model.is_not_pushed_by_a_plane_whose_point_had_let_go", "1,000 contacts"), "late"));
  int let_go = 0;
  for (int i = 0; i < 1000; ++i) {
    contact_with_waves waves(d, d.between(-2e-4, 2e-3));
    static_cast<void>(waves.after(vec3(0.0)));
    const vec3 gone_w = d.inside(5e-3);
    waves.model.take_contact();
    const depths then = waves.after(gone_w);
    EXPECT_LE(then.used_m, std::max(then.true_m, 0.0) + 1e-12) << i;
    constexpr double further_m = 1e-4, slack_m = 1e-6;
    if (!(then.true_m < 0.0 && then.wall_m > 2e-5)) continue;
    ++let_go;
    const vec3 into_w = -waves.reader.of.outward_w;
    const depths now = waves.after(gone_w + further_m * into_w);
    EXPECT_GE(now.used_m, now.wall_m - then.wall_m - slack_m - 1e-12) << i;
    EXPECT_GT(now.used_m, 0.9 * further_m) << i;
  }
  EXPECT_GT(let_go, 20);
}

// A probe that sweeps by a surface is not raised by the wall of its contact, though that lies in its way further on.
TEST(local_model, holds_nothing_that_is_only_swept_by) {
  drawn d(seed_of(fresh_seed("local_model.holds_nothing_that_is_only_swept_by", "300 contacts"), "ways"));
  int walls = 0;
  for (int i = 0; i < 300; ++i) {
    contact_with_waves waves(d, -d.between(3e-4, 1e-3));
    const vec3 along = glm::normalize(d.inside(1.0));
    for (double way_m = 0.0; way_m < 4e-3; way_m += 5e-5) {
      const depths now = waves.after(way_m * along);
      if (now.true_m > -2.5e-4) break;
      EXPECT_NEAR(now.used_m, now.true_m, 1e-12) << i << ": " << way_m;
      walls += now.wall_m > now.true_m + 2e-5 ? 1 : 0;
    }
  }
  EXPECT_GT(walls, 500);
}

// A probe that was in touch and hops is held for a tenth of a second, and no longer. Another body that is touched
// does not count.
TEST(local_model, holds_a_probe_that_hops) {
  drawn d(seed_of(fresh_seed("local_model.holds_a_probe_that_hops", "100 hops"), "hops"));
  for (int i = 0; i < 100; ++i) {
    for (const bool touched : {true, false}) {
      contact_with_waves waves(d, 0.0);
      const wall& of = waves.reader.of;
      const vec3 up_w = d.between(5e-4, 5e-3) * of.outward_w, beside_w = 0.5 * of.wave_m * of.along_w;
      const vec3 crest_w = 0.25 * of.wave_m * of.along_w + (of.amplitude_m - d.between(0.0, 1e-4)) * of.outward_w;
      waves.contact = contact_at(waves.reader, {exp_rotation(d.inside(1.0)), crest_w});
      static_cast<void>(waves.contact.planes.push_back({.depth_m = 1e-3, .body = 1}));
      static_cast<void>(waves.contact.places.push_back({1, {}, 0}));
      static_cast<void>(waves.after(touched ? vec3(0.0) : up_w));
      const std::int64_t period_ns = static_cast<std::int64_t>(d.log_between(2.5e5, 1.2e7));
      for (std::int64_t hop_ns = period_ns; hop_ns < 150'000'000; hop_ns += period_ns) {
        waves.contact.time_ns += period_ns;
        waves.model.take_contact();
        const depths hop = waves.after(up_w);
        EXPECT_NEAR(hop.used_m, hop.true_m, 1e-12) << i;
        const depths valley = waves.after(beside_w);
        EXPECT_LT(valley.true_m, -1e-3) << i;
        const bool holds = touched && hop_ns <= 100'000'000;
        EXPECT_NEAR(valley.used_m, holds ? valley.wall_m - give_after(0.5 * of.wave_m, 0.0) : valley.true_m, 1e-12)
            << i << ": " << hop_ns;
      }
    }
  }
}

// A contact that comes late is no surprise where the old one, read again, pushes as it does.
TEST(local_model, makes_no_surprise_of_a_wave) {
  drawn d(seed_of(fresh_seed("local_model.makes_no_surprise_of_a_wave", "2,000 contacts"), "late"));
  double unread_off_n = 0.0;
  for (int i = 0; i < 2000; ++i) {
    wavy_reader reader;
    reader.of = wavy(0);
    const pose now_T_wc{exp_rotation(d.inside(1.0)), {d.between(-1e-3, 1e-3), 0.0, d.between(-2e-4, 1e-4)}};
    const pose then_T_wc{now_T_wc.rotation, now_T_wc.position + d.inside(4.5e-4)};
    const linear_contact late = contact_at(reader, then_T_wc), now = contact_at(reader, now_T_wc);
    for (const bool reads : {true, false}) {
      probe_motion motion({}, {}, contact_laws{}, 8, {}, reads);
      motion.place(now_T_wc);
      motion.take_contact();
      const wrench before = motion.push_of(late);
      motion.take_contact();
      const double off_n = glm::length(motion.push_of(now).force - before.force);
      if (reads) {
        EXPECT_LT(off_n, 1e-9) << i;
      } else {
        unread_off_n = std::max(unread_off_n, off_n);
      }
    }
  }
  EXPECT_GT(unread_off_n, 0.05);
}

TEST(local_model, leaves_a_contact_alone_that_nobody_can_read) {
  linear_contact contact;
  static_cast<void>(contact.planes.push_back({.depth_m = 1e-4, .sample = 1}));
  local_model model(true);
  EXPECT_EQ(&model.planes_of(contact, {}, {}), &contact.planes);
  wavy_reader reader;
  contact.reader = &reader;  // and nobody says where the body was
  EXPECT_EQ(&model.planes_of(contact, {}, {}), &contact.planes);
  static_cast<void>(contact.places.push_back({}));
  EXPECT_NE(&model.planes_of(contact, {}, {}), &contact.planes);
  contact.places.clear();
  contact.planes.clear();
  EXPECT_EQ(&model.planes_of(contact, {}, {}), &contact.planes);
}

// A renderer of the wavy wall in a scene that changes.
struct versioned_wall {
  using placed_type = placed_scene;
  std::shared_ptr<const placed_scene> now;
  wavy_reader reader{};
  support_plane plane{};

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    plane = reader.plane(at.T_wa, at.T_wb[0]);
    out.planes = {&plane, 1};
    out.reader = &reader;
    return status::ok;
  }
  [[nodiscard]] std::shared_ptr<const placed_scene> take(std::shared_ptr<const placed_scene> next) noexcept {
    return std::exchange(now, std::move(next));
  }
  [[nodiscard]] const placed_scene* placed() const noexcept { return now.get(); }
};

std::shared_ptr<const placed_scene> version_of_a_scene(std::uint64_t version) {
  auto out = std::make_shared<placed_scene>();
  out->version = version;
  out->bodies.fixed.resize(1);
  out->T_wb.resize(1);
  out->generation = {1};
  out->since = {1};
  out->surfaces = surface_pairs(1);
  return out;
}

// The device thread reads the bodies of the contact that it uses, so their scene must not be freed before.
TEST(local_model, keeps_a_scene_that_is_still_read) {
  exchange shared;
  std::weak_ptr<const placed_scene> first;
  contact_loop<versioned_wall> loop = [&] {
    const auto scene = version_of_a_scene(1);
    first = scene;
    return contact_loop<versioned_wall>({scene, {}, {}}, {{pose{}}, vec3(0.0)}, shared);
  }();
  std::int64_t now_ns = 0;
  const auto ticks_with_the_device_at = [&](std::uint64_t version) {
    for (int i = 0; i < 3; ++i) {
      shared.poses.back() = {.time_ns = ++now_ns, .version = version};
      shared.poses.publish();
      EXPECT_EQ(loop.tick(now_ns), status::ok);
    }
    loop.scenes().collect();
  };
  ticks_with_the_device_at(0);  // it has no contact yet
  ASSERT_TRUE(loop.scenes().offer(version_of_a_scene(2)));
  ticks_with_the_device_at(0);
  EXPECT_TRUE(loop.scenes().pending());
  ticks_with_the_device_at(1);
  EXPECT_FALSE(loop.scenes().pending());
  EXPECT_EQ(loop.renderer().now->version, 2U);
  ticks_with_the_device_at(1);
  EXPECT_FALSE(first.expired()) << "freed while the device thread reads it";
  ticks_with_the_device_at(2);
  EXPECT_TRUE(first.expired()) << "kept for nobody";
  // One change after the other goes through.
  for (std::uint64_t v = 3; v < 8; ++v) {
    ASSERT_TRUE(loop.scenes().offer(version_of_a_scene(v))) << v;
    ticks_with_the_device_at(v - 1);
    EXPECT_EQ(loop.renderer().now->version, v);
  }
  // A device thread of somebody else, which reads nothing again and says nothing, keeps nothing.
  ASSERT_TRUE(loop.scenes().offer(version_of_a_scene(8)));
  const std::weak_ptr<const placed_scene> seventh = loop.renderer().now;
  ticks_with_the_device_at(timed_pose{}.version);
  ticks_with_the_device_at(timed_pose{}.version);  // one is freed at a time
  EXPECT_TRUE(seventh.expired());
}

struct forces {
  std::vector<vec3>* out;
  void operator()(const session_record& r) noexcept { out->push_back(r.on_hand_d.force); }
};

// What the hand feels as it scrubs over the wall, once it is there: one value for each millisecond.
std::vector<vec3> scrubbed(const simulated_settings& hand, std::int64_t device_ns, std::int64_t contact_ns, bool reads,
                           double seconds) {
  std::vector<vec3> all, out;
  simulated_device dev(hand);
  EXPECT_TRUE(dev.open() && dev.arm());
  control_settings c;
  c.coupling = coupling_for(dev.capabilities(), 1000.0);
  c.local_model = reads;
  wavy_renderer feel;
  feel.reader.of = wavy(0);
  virtual_session session(std::move(feel), {{pose{}}, vec3(0.0)}, dev, c,
                          {.device_period_ns = device_ns,
                           .contact_period_ns = contact_ns,
                           .contact_one_period_late = contact_ns > device_ns},
                          forces{&all});
  session.run_until(static_cast<std::int64_t>(1e9 * seconds));
  const auto each = static_cast<std::size_t>(1'000'000 / device_ns);
  constexpr std::size_t approach_ms = 500;
  for (std::size_t i = approach_ms * each; i < all.size(); i += each) out.push_back(all[i]);
  return out;
}

TEST(local_model, makes_a_slow_contact_loop_feel_like_a_fast_one) {
  drawn d(seed_of(fresh_seed("local_model.makes_a_slow_contact_loop_feel_like_a_fast_one", "16 hands"), "hands"));
  double unread_n2 = 0.0, read_n2 = 0.0;
  for (int i = 0; i < extent(16, 60); ++i) {
    simulated_settings hand;
    hand.seed = d.bits();
    hand.capabilities = strong_device(10.0);
    hand.motion.kind = motion_kind::scrub;
    hand.motion.T_dh.position = {0.0, 0.0, 1e-3};
    hand.motion.depth_m = d.between(3e-3, 8e-3);
    hand.motion.sideways_d = {1.0, 0.0, 0.0};
    hand.motion.amplitude_m = d.between(2e-3, 6e-3);
    hand.motion.frequency_hz = d.between(0.5, 2.0);
    constexpr double seconds = 1.0;
    const std::vector<vec3> best = scrubbed(hand, 100'000, 100'000, false, seconds);
    for (const std::int64_t contact_ns : {2'500'000, 5'000'000}) {
      const double unread_n = rms_difference(scrubbed(hand, 1'000'000, contact_ns, false, seconds), best);
      const double read_n = rms_difference(scrubbed(hand, 1'000'000, contact_ns, true, seconds), best);
      std::printf("  hand %d, contacts each %.1f ms: off by %.1f mN, %.1f mN without\n", i,
                  1e-6 * static_cast<double>(contact_ns), 1e3 * read_n, 1e3 * unread_n);
      unread_n2 += unread_n * unread_n;
      read_n2 += read_n * read_n;
    }
  }
  const double share = std::sqrt(read_n2 / unread_n2);
  std::printf("  off by %.2f of what it is on planes that nobody reads\n", share);
  // Of all hands together: a slow one may hardly have a difference to make up for. Where a contact's plane lets go of
  // nothing beyond 5 um it is 0.7 and more.
  EXPECT_LT(share, 0.7);
}

// The deepest plane that held the probe in a session, less how deep its point was; and in how many ticks it was off the
// surface.
struct false_depths {
  wavy_reader reader{};
  double most_m = 0.0;
  int falls = 0;
  void operator()(const session_record& r) noexcept {
    if (!(r.planes > 0)) return;
    const double true_m = reader.plane(r.T_wa, {}).depth_m;
    falls += true_m < -2e-4 ? 1 : 0;
    most_m = std::max(most_m, r.overlap_m - std::max(true_m, 0.0));
  }
};

// A quick hand over high waves, whose probe leaves a crest before the contact of the crest comes.
TEST(local_model, late_contacts_do_not_push) {
  drawn d(seed_of(fresh_seed("local_model.late_contacts_do_not_push", "12 hands"), "quick"));
  int falls = 0;
  for (int i = 0; i < 12; ++i) {
    simulated_settings hand;
    hand.seed = d.bits();
    hand.capabilities = strong_device(10.0);
    hand.motion.kind = motion_kind::scrub;
    hand.motion.T_dh.position = {0.0, 0.0, 2e-3};
    hand.motion.depth_m = d.between(4e-3, 8e-3);
    hand.motion.sideways_d = {1.0, 0.0, 0.0};
    hand.motion.amplitude_m = d.between(1e-2, 1.4e-2);
    hand.motion.frequency_hz = d.between(3.0, 5.0);
    simulated_device dev(hand);
    EXPECT_TRUE(dev.open() && dev.arm());
    wavy_renderer feel;
    feel.reader.of = {.amplitude_m = 1e-3, .wave_m = 6e-3};
    false_depths seen;
    seen.reader.of = feel.reader.of;
    virtual_session session(
        std::move(feel), {{pose{}}, vec3(0.0)}, dev, control_settings{},
        {.device_period_ns = 1'000'000, .contact_period_ns = 5'000'000, .contact_one_period_late = true}, seen);
    session.run_until(2'000'000'000);
    const false_depths& o = session.device().observer();
    EXPECT_LT(o.most_m, 5e-4) << i;
    falls += o.falls;
  }
  EXPECT_GT(falls, 1000);
}

}  // namespace
}  // namespace asperity
