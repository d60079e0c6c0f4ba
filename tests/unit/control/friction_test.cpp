// Friction against closed forms, and its energy step by step.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <asperity/control/friction.hpp>
#include <asperity/control/probe.hpp>

#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace asperity {
namespace {

using test_support::drawn, test_support::extent, test_support::fresh_seed;

constexpr double mass_kg = 0.01, substep_s = 1.25e-4;

support_plane plane_at(const vec3& n_ab_w, const vec3& r_w, double depth_m, std::uint32_t body = 0) {
  return {
      .depth_m = depth_m, .gradient = {n_ab_w, glm::cross(r_w, n_ab_w)}, .n_ab_w = n_ab_w, .r_w = r_w, .body = body};
}

// A floor below the probe, which points at these places press on.
support_planes floor_under(const std::vector<vec3>& points) {
  support_planes out;
  for (const vec3& r : points) static_cast<void>(out.push_back(plane_at({0, 0, -1}, r, 0.0)));
  return out;
}

const std::vector<vec3> feet{
    {0.01, 0.01, -0.002}, {-0.01, 0.01, -0.002}, {0.01, -0.01, -0.002}, {-0.01, -0.01, -0.002}};

// A step that nothing else stops.
contact_solution step(friction& rubbing, mat6 a, const vec6& load, const vec6& v0, const support_planes& planes) {
  const contact_solution s = rubbing.solve(a, load, v0, substep_s, planes, {}, {});
  EXPECT_TRUE(s.solved);
  rubbing.settle(substep_s, s.velocity);
  return s;
}

// A probe on a floor, pushed by a wrench; its coupling is too weak to feel.
struct sledge {
  explicit sledge(const friction_settings& s, const std::vector<vec3>& points = feet)
      : body(probe_settings{mass_kg, mat3(1e-6)}), planes(floor_under(points)), rubbing(s) {
    body.reset({});
  }
  void push(const wrench& w) {
    ASSERT_EQ(body.step_on_planes(substep_s, coupling, {}, {}, planes, {}, law, rubbing, pressed, w), status::ok);
  }
  [[nodiscard]] double normal_n() const { return pressed.on_probe_w.force.z; }

  probe body;
  virtual_coupling coupling{{.stiffness_n_per_m = 1e-9,
                             .stiffness_n_m_per_rad = 1e-9,
                             .damping_n_s_per_m = 1e-9,
                             .damping_n_m_s_per_rad = 1e-9},
                            mass_kg,
                            1e-6};
  support_planes planes;
  contact_law law{};
  friction rubbing;
  contact_solution pressed;
};

double length(const vec3& v) { return std::sqrt(glm::dot(v, v)); }

TEST(Friction, HoldsBelowTheConeAndSlipsAboveIt) {
  drawn d(fresh_seed("Friction.HoldsBelowTheConeAndSlipsAboveIt", "60 pushes"));
  const auto any = [&]() { return d.between(0.0, 1.0); };
  for (int n = 0; n < 60; ++n) {
    const double mu_s = 0.1 + 1.1 * any(), mu_d = mu_s * (0.3 + 0.7 * any());
    const double load_n = std::pow(10.0, -1.0 + 2.3 * any()), angle = 2.0 * std::numbers::pi * any();
    const vec3 along{std::cos(angle), std::sin(angle), 0.0};
    sledge holds({.static_coefficient = mu_s, .dynamic_coefficient = mu_d});
    for (int i = 0; i < 4000; ++i)
      holds.push({-load_n * vec3(0, 0, 1) + 0.97 * mu_s * load_n * std::min(1.0, i / 2000.0) * along, {}});
    EXPECT_LT(length(holds.body.state().velocity_w.linear), 1e-5) << mu_s << ' ' << mu_d << ' ' << load_n;
    sledge slips({.static_coefficient = mu_s, .dynamic_coefficient = mu_d});
    // What friction leaves of the push moves the mass; twice the time that it needs to be fast is given.
    const double fast_m_per_s = 0.2, needs_s = fast_m_per_s * mass_kg / ((1.05 * mu_s - mu_d) * load_n);
    const int most = 4000 + static_cast<int>(2.0 * needs_s / substep_s);
    for (int i = 0; i < most && (i < 4000 || length(slips.body.state().velocity_w.linear) <= fast_m_per_s); ++i)
      slips.push({-load_n * vec3(0, 0, 1) + 1.05 * mu_s * load_n * std::min(1.0, i / 2000.0) * along, {}});
    EXPECT_GT(length(slips.body.state().velocity_w.linear), fast_m_per_s) << mu_s << ' ' << mu_d << ' ' << load_n;
    // Fast by now: the dynamic coefficient, against the motion.
    const vec3 f = slips.rubbing.on_probe_w().force;
    EXPECT_NEAR(-glm::dot(f, along), mu_d * load_n, 0.02 * mu_d * load_n);
    EXPECT_LT(length(f + glm::dot(-f, along) * along), 0.01 * mu_d * load_n);
  }
}

// Four feet on a circle of radius R resist a turn by mu N R.
TEST(Friction, ResistsATurnByHowFarPointsAreApart) {
  drawn d(fresh_seed("Friction.ResistsATurnByHowFarPointsAreApart", "30 turns"));
  const auto any = [&]() { return d.between(0.0, 1.0); };
  for (int n = 0; n < 30; ++n) {
    const double mu = 0.2 + 0.8 * any(), load_n = 0.5 + 10.0 * any(), radius_m = 0.003 + 0.03 * any();
    std::vector<vec3> points;
    for (int k = 0; k < 4; ++k) {
      const double at = std::numbers::pi * (0.5 * k + 0.1);
      points.emplace_back(radius_m * std::cos(at), radius_m * std::sin(at), -0.002);
    }
    const double most_n_m = mu * load_n * radius_m;
    for (const double share : {0.97, 1.2}) {
      sledge turned({.static_coefficient = mu, .dynamic_coefficient = mu}, points);
      // The floor's planes are those of a probe that has hardly turned.
      for (int i = 0; i < 3000 && length(log_rotation(turned.body.state().T_wc.rotation)) < 0.3; ++i) {
        turned.push({{0, 0, -load_n}, {0, 0, share * most_n_m * std::min(1.0, i / 1500.0)}});
      }
      const double turns = turned.body.state().velocity_w.angular.z;
      if (share < 1.0) {
        EXPECT_LT(std::fabs(turns), 1e-3);
      } else {
        EXPECT_GT(turns, 0.1);
        EXPECT_NEAR(-turned.rubbing.on_probe_w().torque.z, most_n_m, 0.02 * most_n_m);
      }
    }
  }
}

TEST(Friction, DoesNotCreep) {
  sledge rests({.static_coefficient = 0.4, .dynamic_coefficient = 0.4});
  const wrench slope{{0.35, 0.1, -1.0}, vec3(0.0)};
  for (int i = 0; i < 4000; ++i) rests.push(slope);
  const vec3 before = rests.body.state().T_wc.position;
  for (int i = 0; i < 40'000; ++i) rests.push(slope);
  EXPECT_LT(length(rests.body.state().T_wc.position - before), 1e-8) << "in 5 s";
}

// A ball that sticks, pulled along y, and rolls along x does not slip, however far it goes. What does not stretch the
// point is not remembered: when the next point presses, on a floor that leans, the pull along y is what it was.
TEST(Friction, ForgetsWhatStretchesNothing) {
  friction rubbing({.static_coefficient = 0.5, .dynamic_coefficient = 0.5});
  mat6 heavy;
  for (std::size_t i = 0; i < 6; ++i) heavy(i, i) = 1e9;  // goes as it is told
  support_planes floor = floor_under({{0.0, 0.0, -0.01}});
  floor[0].depth_m = 1e-5;
  const vec6 along_y{{0.0, 1e-3, 0.0}, vec3(0.0)}, rolls{{0.05, 0.0, 0.0}, {0.0, 5.0, 0.0}};
  for (int i = 0; i < 10; ++i) static_cast<void>(step(rubbing, heavy, {}, along_y, floor));
  const double held_n = -friction_settings{}.stiffness_n_per_m * 10 * 1e-3 * substep_s;
  const double lost_j = rubbing.energy().lost_j;
  for (int i = 0; i < 20'000; ++i) {
    static_cast<void>(step(rubbing, heavy, {}, rolls, floor));
    EXPECT_FALSE(rubbing.slips());
  }
  EXPECT_LT(length(rubbing.on_probe_w().force - vec3(0.0, held_n, 0.0)), 0.01 * -held_n);
  const vec3 leaning = glm::normalize(vec3(0.1, 0.0, -1.0));
  support_planes next;
  static_cast<void>(next.push_back(plane_at(leaning, 0.01 * leaning, 1e-5)));
  static_cast<void>(step(rubbing, heavy, {}, {}, next));
  EXPECT_LT(length(rubbing.on_probe_w().force - vec3(0.0, held_n, 0.0)), 0.05 * -held_n);
  EXPECT_LT(rubbing.energy().lost_j - lost_j, 1e-9);
}

// A tongue between two jaws that press from above and below: each rubs by its own force.
TEST(Friction, EachBodyRubsByWhatItPresses) {
  friction rubbing({.static_coefficient = 0.5, .dynamic_coefficient = 0.5});
  support_planes jaws = floor_under({{0.0, 0.0, -0.002}});
  static_cast<void>(jaws.push_back(plane_at({0, 0, 1}, {0.0, 0.0, 0.002}, 2e-5, 1)));
  jaws[0].depth_m = 1e-5;
  mat6 heavy;
  for (std::size_t i = 0; i < 6; ++i) heavy(i, i) = 1e9;
  contact_solution s;
  for (int i = 0; i < 2000; ++i) s = step(rubbing, heavy, {}, {{0.01, 0.0, 0.0}, vec3(0.0)}, jaws);
  ASSERT_TRUE(s.solved);
  EXPECT_NEAR(s.lambda_n[0], 2.0, 1e-3);
  EXPECT_NEAR(s.lambda_n[1], 4.0, 1e-3);
  EXPECT_NEAR(rubbing.on_probe_w().force.x, -0.5 * 6.0, 0.02 * 3.0);
  // Let go of one: the other goes on.
  jaws[1].depth_m = -1.0;
  s = step(rubbing, heavy, {}, {{0.01, 0.0, 0.0}, vec3(0.0)}, jaws);
  EXPECT_NEAR(rubbing.on_probe_w().force.x, -0.5 * 2.0, 0.02);
}

// The same tongue: each jaw has the coefficient of its own pair, and one of which nothing is known the settings'.
TEST(Friction, EachBodyRubsByItsOwnPair) {
  support_planes jaws = floor_under({{0.0, 0.0, -0.002}});
  EXPECT_TRUE(jaws.push_back(plane_at({0, 0, 1}, {0.0, 0.0, 0.002}, 1e-5, 1)));
  jaws[0].depth_m = 1e-5;
  mat6 heavy;
  for (std::size_t i = 0; i < 6; ++i) heavy(i, i) = 1e9;
  const surface_pair rough{.static_friction = 0.7, .dynamic_friction = 0.7}, smooth{};
  const auto drag_n = [&](surface_pairs pairs, double of_the_others) {
    friction rubbing({.static_coefficient = of_the_others, .dynamic_coefficient = of_the_others});
    const contact_laws laws({}, std::move(pairs));
    for (int i = 0; i < 2000; ++i) {
      mat6 a = heavy;
      const contact_solution s = rubbing.solve(a, {}, {{0.01, 0.0, 0.0}, vec3(0.0)}, substep_s, jaws, {}, laws);
      EXPECT_TRUE(s.solved);
      rubbing.settle(substep_s, s.velocity);
    }
    return -rubbing.on_probe_w().force.x;
  };
  EXPECT_NEAR(drag_n({rough, smooth}, 0.2), 0.7 * 2.0, 0.02);
  EXPECT_NEAR(drag_n({smooth, rough}, 0.2), 0.7 * 2.0, 0.02);
  EXPECT_NEAR(drag_n({std::nullopt, rough}, 0.2), (0.2 + 0.7) * 2.0, 0.03);
  EXPECT_NEAR(drag_n({rough}, 0.2), (0.2 + 0.7) * 2.0, 0.03);
  EXPECT_NEAR(drag_n({smooth, smooth}, 0.2), 0.0, 1e-12);
}

// Bodies that are near and not pressed take no bristle from those that are; one too many that presses is told.
TEST(Friction, IsOfTheBodiesThatPress) {
  const auto among = [](std::size_t near, std::size_t pressed) {
    friction rubbing({.static_coefficient = 0.5, .dynamic_coefficient = 0.5});
    support_planes planes;
    for (std::size_t i = 0; i < near + pressed; ++i) {
      EXPECT_TRUE(planes.push_back(
          plane_at({0, 0, -1}, {0.0, 0.0, -0.002}, i < near ? -1e-3 : 1e-5, static_cast<std::uint32_t>(i))));
    }
    mat6 heavy;
    for (std::size_t i = 0; i < 6; ++i) heavy(i, i) = 1e9;
    for (int i = 0; i < 100; ++i) step(rubbing, heavy, {}, {{0.01, 0.0, 0.0}, vec3(0.0)}, planes);
    return std::pair(rubbing.leaves_out(), -rubbing.on_probe_w().force.x);
  };
  constexpr std::size_t most = friction::most_bodies;
  const auto [left_out, all_n] = among(20, most);
  EXPECT_FALSE(left_out);
  EXPECT_NEAR(all_n, 0.5 * 2.0 * static_cast<double>(most), 0.02 * all_n);
  const auto [one_left_out, most_n] = among(0, most + 1);
  EXPECT_TRUE(one_left_out);
  EXPECT_NEAR(most_n, all_n, 1e-5);
}

// Whatever presses and moves: no step gives back more than it was given.
TEST(Friction, MakesNoEnergy) {
  drawn d(fresh_seed("Friction.MakesNoEnergy", "200 walks of 1000 steps, 2000 at length"));
  const auto any = [&]() { return d.between(-1.0, 1.0); };
  const auto vector = [&]() { return vec3(any(), any(), any()); };
  double least_j = 0.0, lost_j = 0.0, held_j = 0.0;
  long steps = 0, slipped = 0;
  for (int walk = 0; walk < extent(200, 2000); ++walk) {
    const double mu = 0.05 + std::fabs(any());
    friction rubbing({.static_coefficient = mu,
                      .dynamic_coefficient = mu * std::fabs(any()),
                      .stiffness_n_per_m = std::pow(10.0, 4.5 + any())});
    vec6 v;
    support_planes planes;
    for (int i = 0; i < 1000; ++i) {
      if (planes.empty() || any() > 0.8) {
        planes.clear();
        const int count = 1 + static_cast<int>(6.0 * std::fabs(any()));
        for (int k = 0; k < count; ++k) {
          static_cast<void>(planes.push_back(
              plane_at(glm::normalize(vector()), 0.05 * vector(), 3e-5 * any(), static_cast<std::uint32_t>(k % 3))));
          planes[planes.size() - 1].spread_m = any() > 0.5 ? 1e-3 : 0.0;
        }
      }
      mat6 a;
      for (std::size_t k = 0; k < 6; ++k) a(k, k) = k < 3 ? mass_kg / substep_s : 1e-6 / substep_s;
      const friction_energy before = rubbing.energy();
      const vec6 load{3.0 * vector(), 0.05 * vector()};
      const contact_solution s = rubbing.solve(a, load, v, substep_s, planes, {}, {});
      ASSERT_TRUE(s.solved);
      // Something else may stop the probe, or push it on.
      v = any() > 0.9 ? vec6{any() * s.velocity.linear + 0.01 * vector(), any() * s.velocity.angular} : s.velocity;
      rubbing.settle(substep_s, v);
      const double given_j = -substep_s * dot(to_vec6(rubbing.on_probe_w()), v);
      const double kept_j = rubbing.energy().stored_j - before.stored_j;
      least_j = std::min(least_j, given_j - kept_j);
      EXPECT_NEAR(given_j - kept_j, rubbing.energy().lost_j - before.lost_j, 1e-15 + 1e-12 * rubbing.energy().lost_j);
      held_j = std::max(held_j, rubbing.energy().stored_j);
      slipped += rubbing.slips() ? 1 : 0;
      ++steps;
    }
    lost_j += rubbing.energy().lost_j;
  }
  std::printf("  least loss of a step %.3g J, of %.3g J lost; up to %.3g J held; %ld of %ld steps slipped\n", least_j,
              lost_j, held_j, slipped, steps);
  EXPECT_GE(least_j, -1e-18);
  EXPECT_GT(slipped, steps / 20);
  EXPECT_LT(slipped, steps * 19 / 20);
}

// A mass on a belt, held by a spring: it sticks until the spring is stretched by mu_s N / k, and slips back. With a slip
// that is far slower to build up than it lasts, the period is that of the closed form.
TEST(Friction, SticksAndSlipsAtTheRateOfTheClosedForm) {
  drawn d(fresh_seed("Friction.SticksAndSlipsAtTheRateOfTheClosedForm", "8 belts"));
  const auto any = [&]() { return d.between(0.0, 1.0); };
  for (int n = 0; n < 8; ++n) {
    const double mu_s = 0.5 + 0.4 * any(), mu_d = mu_s * (0.4 + 0.3 * any()), load_n = 1.0 + 2.0 * any();
    const double k = 400.0 + 500.0 * any(), belt_m_per_s = 0.01 + 0.02 * any();
    // The belt stands, and the spring's other end goes.
    const friction_settings s{.static_coefficient = mu_s, .dynamic_coefficient = mu_d, .stribeck_m_per_s = 2e-4};
    sledge mass(s);
    const double step_s = 2e-5;
    const virtual_coupling spring({.stiffness_n_per_m = k,
                                   .stiffness_n_m_per_rad = 100.0,
                                   .damping_n_s_per_m = 1e-6,
                                   .damping_n_m_s_per_rad = 0.1},
                                  mass_kg, 1e-6);
    // Slip: half a swing about the pull of dynamic friction. Stick: the belt stretches the spring again by what the slip
    // took, less what passes meanwhile.
    const double swing_m = (mu_s - mu_d) * load_n / k, w = std::sqrt(k / mass_kg);
    const double slip_s = 2.0 * (std::numbers::pi - std::atan(w * swing_m / belt_m_per_s)) / w;
    const double expected_s = slip_s + 2.0 * swing_m / belt_m_per_s;
    const double fastest_m_per_s = belt_m_per_s + std::hypot(belt_m_per_s, w * swing_m);
    std::vector<double> starts;
    bool slipping = false;
    const int most = static_cast<int>((7.0 * expected_s + mu_s * load_n / k / belt_m_per_s) * 1.5 / step_s);
    for (int i = 0; i < most && starts.size() < 7; ++i) {
      const pose target{quat(1, 0, 0, 0), {belt_m_per_s * i * step_s, 0, 0}};
      const wrench down{{0, 0, -load_n}, vec3(0.0)};
      ASSERT_EQ(mass.body.step_on_planes(step_s, spring, target, {}, mass.planes, {}, mass.law, mass.rubbing,
                                         mass.pressed, down),
                status::ok);
      const bool fast = mass.body.state().velocity_w.linear.x > 0.5 * fastest_m_per_s;
      if (fast && !slipping) starts.push_back(i * step_s);
      slipping = fast;
    }
    ASSERT_EQ(starts.size(), 7U);
    const double period_s = (starts.back() - starts[1]) / static_cast<double>(starts.size() - 2);
    EXPECT_NEAR(period_s, expected_s, 0.05 * expected_s) << mu_s << ' ' << mu_d << ' ' << load_n << ' ' << k;
  }
}

// The works on a probe that is pushed about on its floor, friction's among them, are its kinetic energy; and what
// friction took from it, the bristles hold or have lost.
TEST(Friction, IsInTheBooksOfTheProbe) {
  drawn d(fresh_seed("Friction.IsInTheBooksOfTheProbe", "20 sledges"));
  for (int n = 0; n < 20; ++n) {
    sledge rubs({.static_coefficient = 0.6, .dynamic_coefficient = 0.4});
    double kept_within_j = 0.0;
    for (int i = 0; i < 2000; ++i) {
      rubs.push({{d.between(-1.0, 1.0), d.between(-1.0, 1.0), -1.0}, 0.002 * d.direction()});
      const probe_energy& e = rubs.body.energy();
      kept_within_j = std::max(kept_within_j, std::fabs(e.by_friction_j));
      const double gained_j = e.by_coupling_j + e.by_contact_j + e.by_friction_j + e.by_external_j - e.numerical_j;
      ASSERT_NEAR(gained_j, rubs.body.kinetic_j(), 1e-12 + 1e-9 * kept_within_j);
      const friction_energy& f = rubs.rubbing.energy();
      ASSERT_NEAR(-e.by_friction_j, f.stored_j + f.lost_j, 1e-12 + 1e-9 * kept_within_j);
    }
    EXPECT_GT(kept_within_j, 1e-5);
  }
}

TEST(Friction, WithoutACoefficientIsTheContactAlone) {
  drawn d(fresh_seed("Friction.WithoutACoefficientIsTheContactAlone", "200 steps"));
  const auto any = [&]() { return d.between(-1.0, 1.0); };
  for (int n = 0; n < 200; ++n) {
    mat6 a;
    for (std::size_t k = 0; k < 6; ++k) a(k, k) = 1.0 + std::fabs(any());
    const vec6 load{{any(), any(), any()}, {any(), any(), any()}};
    support_planes planes = floor_under({{0.01, 0.0, 0.0}, {0.0, 0.01, 0.0}});
    planes[0].depth_m = 1e-5 * any();
    friction none;
    const contact_solution alone = solve_contact(a, load, {}, substep_s, planes, {}, {});
    const contact_solution with = step(none, a, load, {}, planes);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(alone.velocity[k], with.velocity[k]);
    EXPECT_TRUE(is_zero(none.on_probe_w()));
  }
}

TEST(Friction, SaysWhatIsOutOfRange) {
  EXPECT_TRUE(check(friction_settings{}));
  EXPECT_TRUE(check(friction_settings{.static_coefficient = 1.2, .dynamic_coefficient = 1.2}));
  EXPECT_FALSE(check(friction_settings{.static_coefficient = -0.1}));
  EXPECT_FALSE(check(friction_settings{.static_coefficient = 0.3, .dynamic_coefficient = 0.4}));
  EXPECT_FALSE(check(friction_settings{.static_coefficient = std::nan("")}));
  EXPECT_FALSE(check(friction_settings{.stribeck_m_per_s = 0.0}));
  EXPECT_FALSE(check(friction_settings{.stiffness_n_per_m = 1e9}));
}

}  // namespace
}  // namespace asperity
