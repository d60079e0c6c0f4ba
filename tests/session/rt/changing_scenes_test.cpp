// A scene is changed from one thread while two others tick, inside the trap: no allocation, no torn scene, and nothing
// of a body that is gone. 1e5 changes at length, 4e3 otherwise.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/control/contact_loop.hpp"
#include "asperity/control/device_loop.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/planes/scene_editor.hpp"
#include "session/rt/tick_trap.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/sanitizers.hpp"
#include "unit/control/box_scene.hpp"
#include "unit/control/drawn.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr std::size_t slots = 16;

/// What a version holds, in a ring that is longer than a version is in use.
struct noted_version {
  std::array<std::uint32_t, slots> generation{};
  std::array<std::uint64_t, slots> since{};
  std::array<pose, slots> T_wb{};
};
constexpr std::size_t ring = 256;
using noted_versions = std::vector<noted_version>;

/// The bodies that were ever told to move, written by the editing thread. Such a body stays where that put it, though
/// nobody tells of it any more, and where its version has it says nothing. One that the editor has removed may be there
/// still: versions come later than changes.
class told_bodies {
 public:
  void add(const body_handle& b) { told_[at(b)].store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool has(const body_handle& b) const { return told_[at(b)].load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t generations = 65'536;
  static std::size_t at(const body_handle& b) { return b.generation % generations * slots + b.slot; }
  std::vector<std::atomic<bool>> told_ = std::vector<std::atomic<bool>>(generations * slots);
};

struct wrong {
  std::uint64_t stale = 0, torn = 0, back_in_time = 0, elsewhere = 0;
};

// The contact that the device thread has in use, against what its version holds.
void look_at(const linear_contact& c, const felt_bodies& felt, const noted_versions& all, const told_bodies& moved,
             std::uint64_t& last, wrong& out) {
  if (c.version < last) ++out.back_in_time;
  last = std::max(last, c.version);
  if (c.version == 0) return;
  const noted_version& v = all[c.version % ring];
  for (const body_wrench& w : felt.list) out.stale += v.generation[w.body] == 0 ? 1U : 0U;
  for (const body_place& b : c.bodies) out.stale += v.generation[b.body] != b.generation ? 1U : 0U;
  for (const contact_body& b : c.of) {
    out.stale += v.generation[b.body] == 0 ? 1U : 0U;
    out.torn += v.since[b.body] != b.since ? 1U : 0U;
  }
  for (const support_plane& p : c.planes) {
    const bool is_told = std::any_of(c.of.begin(), c.of.end(), [&](const contact_body& b) { return b.body == p.body; });
    out.torn += is_told ? 0U : 1U;
    const bool is_moved = moved.has({p.body, v.generation[p.body]});
    // The plane lies in its body, where this version has it.
    const double far_m = glm::distance(c.T_wc.position + p.r_w, v.T_wb[p.body].position);
    if (!is_moved && far_m > glm::length(cube_half_m) + 0.004) ++out.elsewhere;
  }
}

/// A scene that is nothing but one number, many times, and tells which thread freed it.
struct numbered {
  std::array<std::uint64_t, 64> words{};
  std::atomic<std::uint64_t>* freed_elsewhere = nullptr;
  std::thread::id made_by = std::this_thread::get_id();

  numbered() = default;
  numbered(const numbered&) = delete;
  numbered& operator=(const numbered&) = delete;
  ~numbered() {
    if (freed_elsewhere != nullptr && std::this_thread::get_id() != made_by) ++*freed_elsewhere;
  }
};

// The hand-over alone: every scene comes once and whole, and is freed where it was made.
TEST(changing_scenes, each_comes_once_and_goes_back) {
  constexpr std::uint64_t scenes = 100'000;
  std::atomic<std::uint64_t> freed_elsewhere{0};
  scene_hand_over<numbered> way;
  std::shared_ptr<const numbered> used = std::make_shared<const numbered>();
  std::uint64_t torn = 0, out_of_order = 0, taken = 0;
  std::atomic<bool> runs{true};
  std::thread ticks([&] {
    tick_trap trap;
    std::uint64_t last = 0;
    while (runs.load(std::memory_order_relaxed)) {
      trap([&] {
        if (!way.give_back() || !way.take([&](std::shared_ptr<const numbered> next) noexcept {
              return std::exchange(used, std::move(next));
            })) {
          return;
        }
        ++taken;
        out_of_order += used->words[0] == last + 1 ? 0U : 1U;
        last = used->words[0];
        for (const std::uint64_t w : used->words) torn += w == last ? 0U : 1U;
      });
      if (last == scenes) break;
      std::this_thread::yield();
    }
  });
  for (std::uint64_t i = 1; i <= scenes; ++i) {
    const auto next = std::make_shared<numbered>();
    next->words.fill(i);
    next->freed_elsewhere = &freed_elsewhere;
    while (!way.offer(next)) std::this_thread::yield();
  }
  ticks.join();
  used.reset();
  EXPECT_EQ(taken, scenes);
  EXPECT_EQ(out_of_order, 0U);
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(freed_elsewhere.load(), 0U);
}

TEST(changing_scenes, from_another_thread_inside_the_trap) {
  // ThreadSanitizer makes a contact tick forty times as long.
  const int changes = ASPERITY_THREAD_SANITIZER ? extent(80, 4'000) : extent(4'000, 100'000);
  drawn d(fresh_seed("changing_scenes", "4e3 changes, 1e5 at length; under ThreadSanitizer 80 and 4e3"));
  scene_editor editor = scene_editor::make(boxes().tool, {.bodies = slots}, few_samples).value();
  plane_renderer feel = make_plane_renderer(editor, {.reach_m = 0.0018, .limits = {.leaves = 4096}}).value();
  auto shared = std::make_unique<exchange>();
  contact_loop<plane_renderer> contact(std::move(feel), {{}, vec3(0.0)}, *shared);

  simulated_settings hand;
  hand.motion = {
      .kind = motion_kind::scrub, .T_dh = {quat(1, 0, 0, 0), {0, 0, 0.03}}, .depth_m = 0.03, .approach_s = 0.2};
  hand.motion.amplitude_m = 0.02;
  hand.motion.frequency_hz = 2.0;
  simulated_device dev(hand);
  ASSERT_TRUE(dev.open() && dev.arm());
  control_settings control;
  control.friction.static_coefficient = control.friction.dynamic_coefficient = 0.3;
  device_loop device(dev, with_periods(control, {}), vec3(0.0), *shared);

  noted_versions noted(ring);
  told_bodies told_to_move;
  noted[editor.version() % ring] = {};
  std::atomic<bool> runs{true};
  std::atomic<std::int64_t> now_ns{0};
  std::atomic<std::uint64_t> computed{0};
  std::atomic<std::uint64_t> touched{0};
  std::uint64_t contact_ticks = 0, device_ticks = 0, device_version = 0;
  wrong found;
  std::thread contacts([&] {
    tick_trap trap;
    while (runs.load(std::memory_order_relaxed)) {
      const std::int64_t at_ns = now_ns.load(std::memory_order_relaxed);
      trap([&] { static_cast<void>(contact.tick(at_ns)); });
      if (computed.exchange(contact.computed(), std::memory_order_acq_rel) == contact.computed()) {
        std::this_thread::yield();
      }
    }
    contact_ticks = trap.ticks();
  });
  std::thread devices([&] {
    tick_trap trap;
    std::uint64_t seen = 0;
    while (runs.load(std::memory_order_relaxed)) {
      // A device tick for each contact, so that contacts are as old as they are in a session.
      const std::uint64_t now = computed.load(std::memory_order_acquire);
      if (now == seen && trap.ticks() > 4) {
        std::this_thread::yield();
        continue;
      }
      seen = now;
      const std::int64_t at_ns = now_ns.fetch_add(1'000'000, std::memory_order_relaxed);
      trap([&] { static_cast<void>(device.tick(at_ns)); });
      look_at(shared->contacts.front(), device.felt(), noted, told_to_move, device_version, found);
      touched += device.felt().list.empty() ? 0U : 1U;
    }
    device_ticks = trap.ticks();
  });

  std::vector<body_handle> there, gone;
  const auto somewhere = [&] { return pose{exp_rotation(d.inside(3.0)), vec3(0.0, 0.0, -0.005) + d.inside(0.03)}; };
  const auto any_of = [&](const std::vector<body_handle>& of) {
    return of[static_cast<std::size_t>(d.bits() % of.size())];
  };
  int made = 0;
  std::uint64_t busy = 0, told = 0, refused = 0;
  scene_use in_use;
  const auto take_use = [&] {
    if (shared->scene.refresh()) {
      EXPECT_GE(shared->scene.front().version, in_use.version);
      EXPECT_GE(shared->scene.front().tick, in_use.tick);
      in_use = shared->scene.front();
      EXPECT_LE(in_use.version, editor.version());
    }
  };
  // How often the hand is in touch is drawn: it goes on until that was often enough to tell, or says after ten times the
  // changes that it was not.
  constexpr std::uint64_t enough_touches = 10;
  while (made < changes || (touched.load() < enough_touches && made < 10 * changes)) {
    for (int n = 1 + static_cast<int>(d.bits() % 3U); n > 0; --n, ++made) {
      const double what = d.between(0.0, 1.0);
      if (there.empty() || (what < 0.35 && there.size() < slots)) {
        there.push_back(editor.add(boxes().cube, boxes().field_of(boxes().cube), somewhere()).value());
      } else if (what < 0.55) {
        const body_handle b = any_of(there);
        EXPECT_TRUE(editor.remove(b));
        there.erase(std::find(there.begin(), there.end(), b));
        gone.push_back(b);
        EXPECT_FALSE(editor.has(b));
      } else if (what < 0.9) {
        EXPECT_TRUE(editor.place(any_of(there), somewhere()));
      } else if (!gone.empty()) {
        const body_handle b = any_of(gone);
        const bool is_refused = !editor.place(b, pose{}) && !editor.remove(b);
        EXPECT_TRUE(is_refused);
        refused += is_refused ? 1U : 0U;
      }
    }
    if (d.between(0.0, 1.0) < 0.1) {
      // Some are told to move, dead ones among them.
      moving_bodies& to = shared->bodies.back();
      to = {};
      to.time_ns = now_ns.load(std::memory_order_relaxed);
      for (const auto* of : {&there, &gone}) {
        if (of->empty()) continue;
        const body_handle b = any_of(*of);
        told_to_move.add(b);
        static_cast<void>(
            to.list.push_back({.body = b.slot, .T_wb = somewhere(), .velocity_w = {}, .generation = b.generation}));
        ++told;
      }
      shared->bodies.publish();
    }
    // The note is there before the version is.
    noted_version& note = noted[(editor.version() + 1) % ring];
    struct noting_way {
      scene_hand_over<plane_scene>* to;
      noted_version* note;
      void collect() { to->collect(); }
      [[nodiscard]] bool pending() const { return to->pending(); }
      [[nodiscard]] bool offer(std::shared_ptr<const plane_scene> next) {
        for (std::size_t b = 0; b < slots; ++b) {
          note->generation[b] = next->generation[b];
          note->since[b] = next->since[b];
          note->T_wb[b] = next->T_wb[b];
        }
        return to->offer(std::move(next));
      }
    } way{&contact.scenes(), &note};
    for (;;) {
      take_use();
      // Never further ahead than the ring is long.
      const bool is_far_ahead = editor.version() > in_use.version + ring / 2;
      if (!is_far_ahead) {
        if (editor.commit(way)) break;
        ++busy;
      }
      std::this_thread::yield();
    }
    // Some are waited for until the hand feels them, others come as fast as they are taken.
    if (d.between(0.0, 1.0) < 0.2) {
      while (in_use.version < editor.version()) {
        take_use();
        std::this_thread::yield();
      }
    }
  }
  while (!editor.commit(contact.scenes())) std::this_thread::yield();
  for (int i = 0; i < 1'000'000 && in_use.version < editor.version(); ++i) {
    take_use();
    std::this_thread::yield();
  }
  runs.store(false);
  contacts.join();
  devices.join();
  std::printf(
      "  %d changes in %llu versions, %llu times busy; %llu contact ticks and %llu device ticks, %llu in touch; "
      "%llu told to move, %llu refused\n",
      made, static_cast<unsigned long long>(editor.version()), static_cast<unsigned long long>(busy),
      static_cast<unsigned long long>(contact_ticks), static_cast<unsigned long long>(device_ticks),
      static_cast<unsigned long long>(touched.load()), static_cast<unsigned long long>(told),
      static_cast<unsigned long long>(refused));
  EXPECT_EQ(in_use.version, editor.version());
  EXPECT_EQ(found.stale, 0U);
  EXPECT_EQ(found.torn, 0U);
  EXPECT_EQ(found.back_in_time, 0U);
  EXPECT_EQ(found.elsewhere, 0U);
  EXPECT_GE(touched.load(), enough_touches);
  EXPECT_GT(refused, 0U);
}

}  // namespace
