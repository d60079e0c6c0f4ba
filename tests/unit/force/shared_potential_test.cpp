// The shared potential on readings made by formula: what it sums, and that its wrench is the gradient.
#include "asperity/force/shared_potential.hpp"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/motion.hpp"
#include "support/random_hulls.hpp"

namespace asperity {
namespace {

using test_support::derivative;
using test_support::largest;

constexpr double tau = 2e-5, lever = 0.01, k = 2000.0;

shared_settings with_tau() {
  shared_settings s;
  s.tau_m = tau;
  s.stiffness_n_per_m = k;
  return s;
}

/// A sample whose depth and weight are linear in a motion q of the probe.
struct sample {
  double depth, area;
  vec6 depth_slope{}, area_slope{};
  vec3 at{0.0};
};

/// Readings as a depth backend would make them of such samples.
struct made_reading {
  vec3 n_ab_w;
  std::vector<sample> samples;
  bool turns = false;  ///< the direction belongs to the probe
  std::uint32_t body = 0;

  [[nodiscard]] cell_reading at(const vec6& q) const {
    cell_reading r;
    r.body = body;
    r.n_ab_w = turns ? exp_rotation(q.angular) * n_ab_w : n_ab_w;
    if (turns) r.turn = -skew(r.n_ab_w);
    r.reference_m = r.depth_m = -1.0;
    for (const sample& s : samples) r.reference_m = std::max(r.reference_m, s.depth + dot(s.depth_slope, q));
    vec3 centre(0.0);
    double square = 0.0;
    for (const sample& s : samples) {
      const double e = s.depth + dot(s.depth_slope, q), w = s.area + dot(s.area_slope, q);
      const double b = std::exp((e - r.reference_m) / tau);
      const vec6 mass_slope = b * s.area_slope + (b * w / tau) * s.depth_slope;
      r.mass += b * w;
      r.moment += b * w * e;
      r.mass_slope += mass_slope;
      r.moment_slope += e * mass_slope + (b * w) * s.depth_slope;
      r.slope_sum += (b * w) * s.depth_slope;
      add_outer(r.slope_product, b * w, s.depth_slope);
      centre += b * w * s.at;
      square += b * w * glm::dot(s.at, s.at);
      ++r.samples;
      if (e > r.depth_m) {
        r.depth_m = e;
        r.witness_w = s.at;
      }
      if (e <= 0.0) continue;
      r.overlap += w * e * e;
      r.overlap_slope += (e * e) * s.area_slope + (2.0 * w * e) * s.depth_slope;
      r.area_m2 += w;
    }
    if (r.mass > 0.0) {
      r.centre_w = centre / r.mass;
      r.spread_m = std::sqrt(std::max(0.0, square / r.mass - glm::dot(r.centre_w, r.centre_w)));
    }
    return r;
  }
};

/// near_cells of as many cells as there are readings.
near_cells found(std::size_t count) {
  near_cells out;
  for (std::uint32_t i = 0; i < count; ++i) {
    EXPECT_TRUE(out.add_cell(0, false, i));
    out.add_tile(0);
  }
  return out;
}

struct felt {
  contact_force force;
  double energy = 0.0;
};

std::vector<cell_reading> readings_of(const std::vector<made_reading>& list, const vec6& q = {}) {
  std::vector<cell_reading> out;
  for (const made_reading& m : list) out.push_back(m.at(q));
  return out;
}

felt feel(const shared_potential& model, const std::vector<made_reading>& list, const vec6& q = {}) {
  felt out;
  EXPECT_EQ(model.accumulate(found(list.size()), readings_of(list, q), out.force), status::ok);
  out.energy = model.energy_j();
  return out;
}

felt feel(const std::vector<made_reading>& list, const vec6& q = {}) {
  return feel(shared_potential(with_tau(), 64), list, q);
}

vec3 down_tilted(double angle) { return {std::sin(angle), 0.0, -std::cos(angle)}; }

/// One sample of `depth` straight along n, on 1 square millimetre.
made_reading pressed(const vec3& n, double depth, std::uint32_t body = 0) {
  return {n, {{depth, 1e-6, {n, vec3(0.0)}, {}, vec3(0.0)}}, false, body};
}

made_reading random_reading(test::uniform_source& random, const vec3& n, double deepest) {
  made_reading out;
  out.n_ab_w = n;
  out.turns = random(0.0, 1.0) < 0.5;
  const int count = 1 + static_cast<int>(random(0.0, 4.0));
  for (int i = 0; i < count; ++i) {
    sample s;
    s.depth = deepest * random(0.5, 1.0) + tau * random(-2.0, 1.0);
    s.area = 1e-7 * random(0.1, 1.0);
    s.at = 0.005 * random.in_box(1.0);
    s.depth_slope = {n + 0.2 * random.in_box(1.0), glm::cross(s.at, n)};
    s.area_slope = {1e-4 * random.in_box(1.0), 1e-6 * random.in_box(1.0)};
    out.samples.push_back(s);
  }
  return out;
}

TEST(SharedPotential, OneFaceIsASpring) {
  for (const double depth : {1e-6, 1e-5, 4e-4}) {
    const felt f = feel({pressed({0, 0, -1}, depth)});
    EXPECT_NEAR(f.energy, 0.5 * k * depth * depth, 1e-12 * f.energy);
    EXPECT_NEAR(f.force.on_probe_w.force.z, k * depth, 1e-12 * k * depth);
    EXPECT_NEAR(f.force.stiffness(2, 2), -k, 1e-9);
  }
}

TEST(SharedPotential, NothingOutsideAndNothingWithoutReadings) {
  for (const auto& list : {std::vector<made_reading>{}, {pressed({0, 0, -1}, -1e-5)}, {made_reading{{0, 0, -1}, {}}}}) {
    const felt f = feel(list);
    EXPECT_EQ(f.energy, 0.0);
    EXPECT_EQ(f.force.on_probe_w.force, vec3(0.0));
    EXPECT_EQ(f.force.on_probe_w.torque, vec3(0.0));
    EXPECT_EQ(f.force.stiffness.m, mat6{}.m);
  }
}

// Beside a direction that half shares its spring, a depth counts in full below the surface's level and by K above it:
// with a corner there the force would jump, by 24 mN where a file slid over a CAD part.
TEST(SharedPotential, AReadingCrossesTheSurfaceWithoutAJump) {
  const vec3 other = down_tilted(0.75);
  const auto force_at = [&](double depth) {
    made_reading crossing = pressed(other, depth);
    crossing.samples.front().area = 1.6e-7;  // its mass is one unit: both of its levels are crossed at once
    return feel({pressed({0, 0, -1}, 0.5 * tau), crossing}).force.on_probe_w.force;
  };
  constexpr double step = 1e-4 * tau;
  double worst = 0.0;
  for (double depth = -0.05 * tau; depth < 0.05 * tau; depth += step) {
    worst = std::max(worst, glm::length(force_at(depth + step) - force_at(depth)));
  }
  EXPECT_GT(worst, 0.0);
  EXPECT_LT(worst, 5.0 * k * step);
}

TEST(SharedPotential, CellsOfOneDirectionShareASpringAndOthersHaveTheirOwn) {
  const double d = 3e-4;
  const double one = feel({pressed(down_tilted(0.0), d)}).energy;
  EXPECT_NEAR(feel({pressed(down_tilted(0.0), d), pressed(down_tilted(0.0), d)}).energy, one, 1e-12 * one);
  EXPECT_NEAR(feel({pressed(down_tilted(0.0), d), pressed(down_tilted(0.4), d)}).energy, one, 1e-12 * one);
  EXPECT_NEAR(feel({pressed(down_tilted(0.0), d), pressed(down_tilted(1.1), d)}).energy, 2.0 * one, 1e-12 * one);
  EXPECT_NEAR(feel({pressed({1, 0, 0}, d), pressed({0, 1, 0}, d), pressed({0, 0, 1}, d)}).energy, 3.0 * one,
              1e-12 * one);
}

TEST(SharedPotential, BodiesDoNotMix) {
  test::uniform_source random(1);
  std::vector<made_reading> a, b, both;
  for (int i = 0; i < 3; ++i) {
    a.push_back(random_reading(random, random.direction(), 2e-4));
    b.push_back(random_reading(random, random.direction(), 2e-4));
    b.back().body = 1;
    both.push_back(a.back());
    both.push_back(b.back());
  }
  const felt fa = feel(a), fb = feel(b), f = feel(both);
  EXPECT_NEAR(f.energy, fa.energy + fb.energy, 1e-14 * f.energy);
  EXPECT_LT(glm::distance(f.force.on_probe_w.force, fa.force.on_probe_w.force + fb.force.on_probe_w.force), 1e-12);
  EXPECT_LT(glm::distance(f.force.on_probe_w.torque, fa.force.on_probe_w.torque + fb.force.on_probe_w.torque), 1e-14);
}

TEST(SharedPotential, TheWrenchIsMinusTheGradientOfTheEnergy) {
  test::uniform_source random(2);
  double worst = 0.0;
  int between = 0, lopsided = 0;
  for (int n = 0; n < 400; ++n) {
    // Two to five directions, each 0 to 90 degrees from the first: those between 25 and 60 degrees mix.
    const vec3 first = random.direction(), across = any_orthogonal(first), other = glm::cross(first, across);
    std::vector<made_reading> list;
    const int count = 2 + n % 4;
    for (int i = 0; i < count; ++i) {
      const double angle = i == 0 ? 0.0 : random(0.0, 1.57), turn = random(0.0, 6.28);
      const vec3 n_i = std::cos(angle) * first + std::sin(angle) * (std::cos(turn) * across + std::sin(turn) * other);
      between += angle > 0.45 && angle < 1.03 ? 1 : 0;
      const double depth = random(0.0, 1.0) < 0.3 ? random(-2.0, 2.0) * tau : random(1.0, 10.0) * tau;
      lopsided += depth < tau ? 1 : 0;
      list.push_back(random_reading(random, n_i, depth));
    }
    const felt f = feel(list);
    const shared_potential model(with_tau(), 8);
    const vec6 expected = derivative([&](const vec6& q) { return -feel(model, list, q).energy; }, 1e-9, lever);
    const double size = std::max(largest(expected, lever), k * tau);
    const double error = largest(to_vec6(f.force.on_probe_w) - expected, lever) / size;
    worst = std::max(worst, error);
    EXPECT_LT(error, 2e-6) << count << " readings";
  }
  std::printf("wrench against differences of the energy: worst %.1g; %d directions between, %d barely touching\n",
              worst, between, lopsided);
  EXPECT_GT(between, 200);
  EXPECT_GT(lopsided, 200);
}

/// Three readings, the last two at these angles from the first, and the same with the first one cut in two.
std::pair<felt, felt> whole_and_cut(test::uniform_source& random, double angle, double other_angle) {
  const vec3 first = random.direction(), across = any_orthogonal(first), other = glm::cross(first, across);
  std::vector<made_reading> whole{
      random_reading(random, first, random(-1.0, 8.0) * tau),
      random_reading(random, std::cos(angle) * first + std::sin(angle) * across, random(-1.0, 8.0) * tau),
      random_reading(random, std::cos(other_angle) * first + std::sin(other_angle) * other, random(-1.0, 8.0) * tau)};
  std::vector<sample>& samples = whole[0].samples;
  samples.push_back(samples.front());
  samples.back().depth -= 0.7 * tau;
  std::vector<made_reading> cut = whole;
  cut.push_back(whole[0]);
  const auto half = static_cast<std::ptrdiff_t>(samples.size() / 2);
  cut.front().samples.assign(samples.begin(), samples.begin() + half);
  cut.back().samples.assign(samples.begin() + half, samples.end());
  return {feel(whole), feel(cut)};
}

TEST(SharedPotential, CuttingAReadingInTwoChangesNothing) {
  test::uniform_source random(3);
  for (int n = 0; n < 200; ++n) {
    const auto [a, b] = whole_and_cut(random, random(0.0, 0.43), random(1.05, 1.57));  // one direction, or another
    EXPECT_NEAR(a.energy, b.energy, 1e-12 * a.energy);
    EXPECT_LT(largest(to_vec6(a.force.on_probe_w) - to_vec6(b.force.on_probe_w), lever),
              1e-11 * largest(to_vec6(a.force.on_probe_w), lever) + 1e-15);
    for (std::size_t i = 0; i < 36; ++i) EXPECT_NEAR(a.force.stiffness.m[i], b.force.stiffness.m[i], 1e-7);
  }
}

// Where a third direction lies between the same and another, its soft maximum raises masses to a power below one.
TEST(SharedPotential, CuttingAReadingInTwoChangesLittleBesideAHalfSharedDirection) {
  test::uniform_source random(4);
  double worst = 0.0;
  for (int n = 0; n < 400; ++n) {
    const auto [a, b] = whole_and_cut(random, random(0.43, 1.05), random(0.43, 1.05));
    const double unit = std::max(a.energy, 0.5 * k * tau * tau);
    worst = std::max(worst, std::fabs(a.energy - b.energy) / unit);
  }
  std::printf("cut beside a direction 25 to 60 degrees away: the energy changes by at most %.2g\n", worst);
  EXPECT_LT(worst, 0.1);
}

TEST(SharedPotential, TheStiffnessIsSymmetricNegativeSemidefinite) {
  test::uniform_source random(4);
  for (int n = 0; n < 100; ++n) {
    std::vector<made_reading> list;
    for (int i = 0; i < 5; ++i) list.push_back(random_reading(random, random.direction(), random(-2.0, 10.0) * tau));
    const mat6 J = feel(list).force.stiffness;
    double trace = 0.0;
    for (std::size_t i = 0; i < 6; ++i) {
      trace -= J(i, i);
      for (std::size_t j = 0; j < i; ++j) EXPECT_EQ(J(i, j), J(j, i));
    }
    EXPECT_GE(trace, 0.0);
    for (int i = 0; i < 50; ++i) {
      const vec6 v{random.in_box(1.0), random.in_box(1.0)};
      EXPECT_LE(dot(v, J * v), 1e-12 * trace);
    }
  }
}

TEST(SharedPotential, TheStiffnessIsTheDerivativeOfTheWrenchWhereOneDirectionPresses) {
  test::uniform_source random(5);
  made_reading reading = random_reading(random, {0, 0, -1}, 5.0 * tau);
  reading.turns = false;
  for (sample& s : reading.samples) s.area_slope = {};  // the stiffness leaves out how weights change
  const mat6 J = feel({reading}).force.stiffness;
  for (std::size_t i = 0; i < 6; ++i) {
    const vec6 row =
        derivative([&](const vec6& q) { return to_vec6(feel({reading}, q).force.on_probe_w)[i]; }, 1e-9, lever);
    for (std::size_t j = 0; j < 6; ++j) {
      const double scale = (i < 3 ? 1.0 : lever) * (j < 3 ? 1.0 : lever);
      EXPECT_NEAR(J(i, j), row[j], 0.02 * std::fabs(J(2, 2)) * scale);
    }
  }
}

TEST(SharedPotential, RefusesWhatItCannotSum) {
  const shared_potential model(with_tau(), 2);
  const std::vector<cell_reading> readings{pressed({0, 0, -1}, 1e-4).at({}), pressed({1, 0, 0}, 1e-4).at({}),
                                           pressed({0, 1, 0}, 1e-4).at({})};
  contact_force out;
  const auto zero = [&] {
    return out.on_probe_w.force == vec3(0.0) && out.stiffness.m == mat6{}.m && model.energy_j() == 0.0;
  };
  EXPECT_EQ(model.accumulate(found(2), readings, out), status::ok);
  EXPECT_FALSE(zero());
  EXPECT_EQ(model.accumulate(found(3), readings, out), status::not_ready);  // more than it was told
  EXPECT_TRUE(zero());
  EXPECT_EQ(model.accumulate(found(2), std::span(readings).first(1), out), status::not_ready);
  EXPECT_TRUE(zero());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  using spoil = std::function<void(cell_reading&)>;
  const std::vector<std::pair<const char*, spoil>> faults{
      {"mass", [](cell_reading& r) { r.mass = nan; }},
      {"moment", [](cell_reading& r) { r.moment = nan; }},
      {"overlap", [](cell_reading& r) { r.overlap = infinity; }},
      {"reference", [](cell_reading& r) { r.reference_m = nan; }},
      {"direction", [](cell_reading& r) { r.n_ab_w.y = nan; }},
      {"slope", [](cell_reading& r) { r.moment_slope[4] = nan; }},
      {"product", [](cell_reading& r) { r.slope_product(1, 2) = nan; }}};
  for (const auto& [name, fault] : faults) {
    auto spoiled = readings;
    fault(spoiled[1]);
    EXPECT_EQ(model.accumulate(found(2), spoiled, out), status::not_finite) << name;
    EXPECT_TRUE(zero()) << name;
    contact_set told({.contacts = 8, .triangles = 0});
    std::vector<penetration> depths(8);
    model.describe(told, depths);
    EXPECT_EQ(told.size(), 0U) << name;
  }
}

// A copy would lose its room and refer to readings of another renderer; it does not compile.
static_assert(!std::is_copy_constructible_v<shared_potential> &&
              std::is_nothrow_move_constructible_v<shared_potential>);

struct description {
  contact_set contacts;
  std::vector<penetration> depths;
};

description describe(const std::vector<made_reading>& list, std::size_t room = 16) {
  const shared_potential model(with_tau(), 64);
  const std::vector<cell_reading> readings = readings_of(list);
  contact_force force;
  EXPECT_EQ(model.accumulate(found(list.size()), readings, force), status::ok);
  description out{contact_set({.contacts = 16, .triangles = 0}), std::vector<penetration>(room)};
  model.describe(out.contacts, out.depths);
  return out;
}

TEST(SharedPotentialContacts, AreOnePerDirectionAndBody) {
  made_reading a = pressed(down_tilted(0.0), 3e-4), b = pressed(down_tilted(0.1), 2e-4), c = pressed({1, 0, 0}, 1e-4),
               d = pressed(down_tilted(0.0), 2e-4, 1);
  a.samples[0].at = {0.01, 0.0, 0.0};
  b.samples[0].at = {-0.01, 0.0, 0.0};
  const description told = describe({c, a, d, b});
  ASSERT_EQ(told.contacts.size(), 3U);
  // The strongest first; readings of nearly one direction are one contact.
  const contact& first = told.contacts.contacts()[0];
  EXPECT_EQ(told.depths[0].samples, 2U);
  EXPECT_NEAR(told.depths[0].depth_m, 3e-4, 1e-15);
  EXPECT_NEAR(told.depths[0].area_m2, 2e-6, 1e-15);
  EXPECT_EQ(told.depths[0].witness_w, vec3(0.01, 0.0, 0.0));
  EXPECT_EQ(first.separation_m, -told.depths[0].depth_m);
  EXPECT_GT(first.window.n_ab_w.x, 0.0);
  EXPECT_LT(first.window.n_ab_w.x, std::sin(0.1));
  // Weights 9 to 4: the shares.
  EXPECT_NEAR(first.window.centre_w.x, 0.01 * (9.0 - 4.0) / 13.0, 1e-6);
  EXPECT_NEAR(first.window.half_size_m, 0.01 * std::sqrt(2.0 * (1.0 - 25.0 / 169.0)), 1e-6);
  EXPECT_NEAR(glm::distance(first.p_a_w, first.p_b_w), told.depths[0].depth_m, 1e-15);
  EXPECT_EQ(told.contacts.contacts()[1].body, 1U);
  EXPECT_EQ(told.contacts.contacts()[2].window.n_ab_w, vec3(1, 0, 0));
}

TEST(SharedPotentialContacts, TellEveryReadingOnceWithUnitAxes) {
  test::uniform_source random(6);
  for (int n = 0; n < 100; ++n) {
    std::vector<made_reading> list;
    std::uint32_t samples = 0;
    double area = 0.0;
    for (int i = 0; i < 8; ++i) {
      list.push_back(random_reading(random, random.direction(), random(-3.0, 8.0) * tau));
      list.back().body = static_cast<std::uint32_t>(i % 2);
      const cell_reading r = list.back().at({});
      samples += r.samples;
      area += r.area_m2;
    }
    const description told = describe(list);
    std::uint32_t told_samples = 0;
    double told_area = 0.0, deepest = -1.0;
    for (std::size_t i = 0; i < told.contacts.size(); ++i) {
      const contact_window& w = told.contacts.contacts()[i].window;
      EXPECT_NEAR(glm::length(w.n_ab_w), 1.0, 1e-12);
      EXPECT_LT(glm::distance(glm::cross(w.u_w, w.v_w), w.n_ab_w), 1e-12);
      EXPECT_TRUE(is_finite(w.centre_w) && std::isfinite(w.half_size_m));
      EXPECT_EQ(told.contacts.contacts()[i].id, i);
      told_samples += told.depths[i].samples;
      told_area += told.depths[i].area_m2;
      deepest = std::max(deepest, told.depths[i].depth_m);
    }
    EXPECT_EQ(told_samples, samples);
    EXPECT_NEAR(told_area, area, 1e-12 * area);
    for (const made_reading& m : list) EXPECT_GE(deepest, m.at({}).depth_m);
  }
}

TEST(SharedPotentialContacts, StopWhereThereIsNoMoreRoom) {
  std::vector<made_reading> list;
  for (std::uint32_t b = 0; b < 20; ++b) list.push_back(pressed({0, 0, -1}, 1e-5 * (b + 1.0), b));
  EXPECT_EQ(describe(list, 3).contacts.size(), 3U);    // of depths
  EXPECT_EQ(describe(list, 64).contacts.size(), 16U);  // of contacts
  EXPECT_EQ(describe(list, 0).contacts.size(), 0U);
  EXPECT_EQ(describe(list, 3).contacts.contacts()[0].body, 19U);  // the deepest are told
}

TEST(SharedPotentialContacts, AGapIsToldAsAGap) {
  const description told = describe({pressed({0, 0, -1}, -3.0 * tau), pressed(down_tilted(0.1), -2.0 * tau)});
  ASSERT_EQ(told.contacts.size(), 1U);
  EXPECT_NEAR(told.contacts.contacts()[0].separation_m, 2.0 * tau, 1e-15);
  EXPECT_LT(told.depths[0].soft_depth_m, 0.0);
}

TEST(SharedSettings, EachSettingOutOfRangeIsNamed) {
  EXPECT_TRUE(check(shared_settings{}));
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const std::function<void(shared_settings&)>& change, const std::string& sentence) {
    shared_settings s;
    change(s);
    const result<void> r = check(s);
    ASSERT_FALSE(r) << sentence;
    EXPECT_EQ(r.error().code, error_code::invalid_argument);
    EXPECT_EQ(r.error().message, "shared settings: " + sentence);
  };
  for (const double v : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    refused([v](shared_settings& s) { s.stiffness_n_per_m = v; },
            "stiffness_n_per_m must be a finite number, 0 or more");
    refused([v](shared_settings& s) { s.tau_m = v; }, "tau_m must be a finite length, or 0 for automatic");
  }
  for (const double v : {0.92, 1.0, -0.1, nan}) {
    refused([v](shared_settings& s) { s.facing_none = v; }, "facing_none must be below facing_full, both cosines");
  }
  for (const double v : {0.5, 1.0, -0.1, nan}) {
    refused([v](shared_settings& s) { s.leaving_full = v; }, "leaving_full must be below leaving_none, both cosines");
  }
  for (const double v : {0.3, 1.0, -0.1, nan}) {
    refused([v](shared_settings& s) { s.crossing_none = v; }, "crossing_none must be below crossing_full, both sines");
  }
  for (const double v : {0.0, 1.1, nan}) {
    refused([v](shared_settings& s) { s.same_direction_rad = v; },
            "same_direction_rad must be above 0 and below other_direction_rad");
  }
  refused([](shared_settings& s) { s.other_direction_rad = 3.2; },
          "same_direction_rad must be above 0 and below other_direction_rad");
}

}  // namespace
}  // namespace asperity
