// What rests stays at rest: a hand that holds still feels nothing move, at a contact loop of 200 Hz.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <asperity/control/virtual_session.hpp>
#include <asperity/device/simulated/simulated_device.hpp>

#include "contact_meter.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/held_force.hpp"

namespace asperity::contacts_test {
namespace {

/// Where the probe rests, and the way the hand pushes it there.
struct resting_place {
  std::string name;
  bool only_at_length = false;  ///< where it rests takes minutes
  contact_scene scene;
  double at = 0.0;  ///< parameter of the scene's path
  vec3 push_w{0.0, 0.0, -1.0};
};

std::vector<resting_place> resting_places() {
  const vec3 onto_edge = -glm::normalize(vec3(1, 0, 1));
  return {{"in a notch", false, v_groove(), 0.0, {0.0, 0.0, -1.0}},
          {"on a ridge", false, edge_on_edge(), 0.5, onto_edge},
          {"in a corner", true, concave_corner(), 0.9, -glm::normalize(vec3(1, 1, 1))},
          {"in a hole", true, peg_in_hole(), 0.5, glm::normalize(vec3(1.0, -0.2, 0.3))}};
}

/// How restless a minute was. Positions of the handle, after three seconds to settle.
struct restlessness {
  double vibration_m = 0.0;  ///< largest distance from the mean of its second
  double drift_m = 0.0;      ///< between the means of the first and the last second
  double force_n = 0.0;      ///< mean force on the hand, last second
};

class watch {
 public:
  void operator()(const session_record& r) noexcept {
    if (r.time_ns < settle_ns) return;  // the approach
    positions_[count_++ % ticks_per_second] = r.T_dh.position;
    forces_ += glm::length(r.on_hand_d.force);
    if (count_ % ticks_per_second != 0) return;
    vec3 mean(0.0);
    for (const vec3& p : positions_) mean += p / static_cast<double>(ticks_per_second);
    for (const vec3& p : positions_) seen_.vibration_m = std::max(seen_.vibration_m, glm::length(p - mean));
    if (count_ == ticks_per_second) first_ = mean;
    seen_.drift_m = glm::length(mean - first_);
    seen_.force_n = forces_ / static_cast<double>(ticks_per_second);
    forces_ = 0.0;
  }
  [[nodiscard]] const restlessness& seen() const noexcept { return seen_; }

 private:
  static constexpr std::int64_t settle_ns = 3'000'000'000;
  static constexpr std::size_t ticks_per_second = 1000;
  std::array<vec3, ticks_per_second> positions_{};
  std::size_t count_ = 0;
  double forces_ = 0.0;
  vec3 first_{0.0};
  restlessness seen_;
};

template <class Renderer>
restlessness rest(Renderer feel, const resting_place& place, const vec3& centre_a, std::int64_t contact_period_ns,
                  double seconds) {
  constexpr double lift_m = 1.0 * mm, press_m = 1.2 * mm;
  pose start = place.scene.path(place.at);
  start.position -= lift_m * place.push_w;

  simulated_settings sim;
  sim.hand = firm_hand();
  sim.hand.tremor_m = 0.0;
  sim.motion.direction_d = place.push_w;
  sim.motion.depth_m = lift_m + press_m;
  simulated_device dev(sim);
  if (!dev.open() || !dev.arm()) throw std::runtime_error("the simulated device did not open");
  control_settings control;
  control.map = {.T_wd = {quat(1.0, 0.0, 0.0, 0.0), start * centre_a},
                 .T_ha = {start.rotation, -(start.rotation * centre_a)}};
  virtual_session session(std::move(feel), {{pose{}}, centre_a}, dev, control,
                          {.contact_period_ns = contact_period_ns, .contact_one_period_late = true}, watch{});
  const auto end_ns = static_cast<std::int64_t>(seconds * 1e9);
  EXPECT_EQ(session.run_until(end_ns), status::ok) << place.name;
  return session.device().observer().seen();
}

// At 200 Hz, where a contact is held five times as long as at 1 kHz, everything that moves moves more.
void rest_at(const resting_place& place, double seconds) {
  constexpr double still_m = 5e-6, moving_m = 30e-6;
  constexpr std::int64_t period_ns = 5'000'000;
  const auto make = [&] { return make_scene_renderer(place.scene, scene_settings()); };
  least_motion_renderer feel = make();
  const vec3 centre = feel.scene().probe->mass.centre_of_mass;
  const restlessness r = rest(std::move(feel), place, centre, period_ns, seconds);
  const restlessness held = rest(test_support::held_force(make()), place, centre, period_ns, 6.0);
  std::printf("%-14s vibration %6.2f um, drift %6.2f um, force %5.2f N; the force held: vibration %8.2f um\n",
              place.name.c_str(), 1e6 * r.vibration_m, 1e6 * r.drift_m, r.force_n, 1e6 * held.vibration_m);
  EXPECT_GT(r.force_n, 0.2) << place.name << ": it does not touch";
  EXPECT_LT(r.vibration_m, still_m) << place.name;
  EXPECT_LT(r.drift_m, still_m) << place.name;
  // Negative control: the same force without its slope, held for a period.
  EXPECT_GT(held.vibration_m, moving_m) << place.name;
}

// One of the quick places a day; at length all of them. The corner and the hole take more than a minute each.
TEST(alive, a_probe_at_rest_stays_at_rest) {
  std::vector<resting_place> places = resting_places();
  if (!test_support::at_length()) std::erase_if(places, [](const resting_place& p) { return p.only_at_length; });
  const std::uint64_t seed = test_support::fresh_seed("resting places", "1 of 2; at length all 4");
  const std::size_t today = test_support::seed_of(seed, "place") % places.size();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (test_support::at_length() || i == today) rest_at(places[i], 6.0);
  }
}

}  // namespace
}  // namespace asperity::contacts_test
