// Materials: what is allowed, how two become one, and the presets.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include <asperity/model/material.hpp>
#include <asperity/model/scene.hpp>

#include "support/fresh_seed.hpp"
#include "unit/control/drawn.hpp"

namespace asperity {
namespace {

using test_support::drawn, test_support::fresh_seed;

material any_material(drawn& d) {
  material m;
  m.stiffness_n_per_m = d.log_between(100.0, 1e7);
  m.dissipation_s_per_m = d.between(0.0, 100.0);
  m.static_friction = d.between(0.0, 2.0);
  m.dynamic_friction = m.static_friction * d.between(0.0, 1.0);
  m.combine = static_cast<friction_combine>(d.bits() % 4);
  return m;
}

TEST(Material, SaysWhatIsOutOfRange) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(check(material{}));
  EXPECT_TRUE(check(material{.stiffness_n_per_m = 100.0, .dissipation_s_per_m = 0.0}));
  for (const double bad : {0.0, -1.0, 99.0, 1.1e7, nan, inf}) EXPECT_FALSE(check(material{.stiffness_n_per_m = bad}));
  for (const double bad : {-0.1, 101.0, nan, inf}) EXPECT_FALSE(check(material{.dissipation_s_per_m = bad}));
  for (const double bad : {-0.1, 11.0, nan, inf}) EXPECT_FALSE(check(material{.static_friction = bad}));
  for (const double bad : {-0.1, 0.5, nan}) {
    EXPECT_FALSE(check(material{.static_friction = 0.4, .dynamic_friction = bad}));
  }
  const result<void> named = check(material{.name = "jelly", .stiffness_n_per_m = 1.0});
  EXPECT_NE(named.error().message.find("'jelly'"), std::string::npos);
}

// Springs in series under one force: their depths add up. What both dissipate at the speed of the pair is what it does.
TEST(Material, TwoAreSpringsInSeries) {
  drawn d(fresh_seed("Material.TwoAreSpringsInSeries", "200 pairs"));
  for (int i = 0; i < 200; ++i) {
    const material a = any_material(d), b = any_material(d);
    const surface_pair p = combined(a, b);
    const double force_n = d.between(0.1, 20.0);
    const double depth_m = force_n / a.stiffness_n_per_m + force_n / b.stiffness_n_per_m;
    EXPECT_NEAR(force_n / p.stiffness_n_per_m, depth_m, 1e-12 * depth_m);
    // Slow enough for first order: depths of f = k_i x_i (1 + 1.5 alpha_i v).
    const double v = 1e-6 / (1.0 + a.dissipation_s_per_m + b.dissipation_s_per_m);
    const double moving_m = force_n / (a.stiffness_n_per_m * (1.0 + 1.5 * a.dissipation_s_per_m * v)) +
                            force_n / (b.stiffness_n_per_m * (1.0 + 1.5 * b.dissipation_s_per_m * v));
    const double pair_n = p.stiffness_n_per_m * moving_m * (1.0 + 1.5 * p.dissipation_s_per_m * v);
    EXPECT_NEAR(pair_n, force_n, 1e-11 * force_n);
    const surface_pair other = combined(b, a);
    EXPECT_NEAR(other.stiffness_n_per_m, p.stiffness_n_per_m, 1e-12 * p.stiffness_n_per_m);
    EXPECT_NEAR(other.dissipation_s_per_m, p.dissipation_s_per_m, 1e-12 * (1.0 + p.dissipation_s_per_m));
  }
}

// Two bodies of the defaults make the law of planes, to the bit.
TEST(Material, TheDefaultsAreWhatPlanesDo) {
  const surface_pair p = combined(material{}, material{});
  EXPECT_EQ(p.stiffness_n_per_m, 2e5);
  EXPECT_EQ(p.dissipation_s_per_m, 5.0);
  EXPECT_EQ(p.static_friction, 0.0);
}

// The table of KHR_physics_rigid_bodies: average before minimum before maximum before multiply.
TEST(Material, TheStrongerModeCombinesFriction) {
  const auto of = [](friction_combine mode, double mu_s, double mu_d) {
    return material{.static_friction = mu_s, .dynamic_friction = mu_d, .combine = mode};
  };
  using enum friction_combine;
  struct expected {
    friction_combine a, b;
    double mu_s, mu_d;
  };
  constexpr std::array<expected, 10> table{{{average, average, 0.5, 0.3},
                                            {average, minimum, 0.5, 0.3},
                                            {average, maximum, 0.5, 0.3},
                                            {average, multiply, 0.5, 0.3},
                                            {minimum, minimum, 0.2, 0.1},
                                            {minimum, maximum, 0.2, 0.1},
                                            {minimum, multiply, 0.2, 0.1},
                                            {maximum, maximum, 0.8, 0.5},
                                            {maximum, multiply, 0.8, 0.5},
                                            {multiply, multiply, 0.16, 0.05}}};
  for (const expected& e : table) {
    for (const bool turned : {false, true}) {
      const surface_pair p =
          turned ? combined(of(e.b, 0.2, 0.1), of(e.a, 0.8, 0.5)) : combined(of(e.a, 0.2, 0.1), of(e.b, 0.8, 0.5));
      EXPECT_NEAR(p.static_friction, e.mu_s, 1e-15) << to_string(e.a) << ' ' << to_string(e.b);
      EXPECT_NEAR(p.dynamic_friction, e.mu_d, 1e-15) << to_string(e.a) << ' ' << to_string(e.b);
    }
  }
}

// What two allowed materials make is a law and a friction that are allowed.
TEST(Material, APairIsWithinWhatALawAllows) {
  drawn d(fresh_seed("Material.APairIsWithinWhatALawAllows", "1000 pairs"));
  for (int i = 0; i < 1000; ++i) {
    const material a = any_material(d), b = any_material(d);
    ASSERT_TRUE(check(a) && check(b));
    const surface_pair p = combined(a, b);
    EXPECT_GE(p.stiffness_n_per_m, 50.0);
    EXPECT_LE(p.stiffness_n_per_m, 1e7);
    EXPECT_GE(p.dissipation_s_per_m, std::min(a.dissipation_s_per_m, b.dissipation_s_per_m) * (1.0 - 1e-12));
    EXPECT_LE(p.dissipation_s_per_m, std::max(a.dissipation_s_per_m, b.dissipation_s_per_m) * (1.0 + 1e-12));
    EXPECT_LE(p.dynamic_friction, p.static_friction);
  }
}

TEST(Material, ABodyOfUnknownMaterialTakesOnTheOther) {
  const material rubber = *preset_material("rubber");
  EXPECT_FALSE(combined(std::optional<material>{}, std::optional<material>{}).has_value());
  for (const auto& p : {combined(std::optional(rubber), std::nullopt), combined(std::nullopt, std::optional(rubber))}) {
    ASSERT_TRUE(p.has_value());
    EXPECT_EQ(p->stiffness_n_per_m, rubber.stiffness_n_per_m);
    EXPECT_EQ(p->dissipation_s_per_m, rubber.dissipation_s_per_m);
    EXPECT_EQ(p->static_friction, rubber.static_friction);
    EXPECT_EQ(p->dynamic_friction, rubber.dynamic_friction);
  }
}

TEST(Material, ASceneTellsThePairOfEachFixedBody) {
  const auto body = [](std::optional<material> m) {
    textured_model model;
    model.surface = std::move(m);
    return std::make_shared<const textured_model>(std::move(model));
  };
  const material steel = *preset_material("steel"), rubber = *preset_material("rubber");
  const scene bodies{body(steel), {body(rubber), body(std::nullopt), body(steel)}};
  const surface_pairs pairs = surfaces_of(bodies);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0]->stiffness_n_per_m, combined(steel, rubber).stiffness_n_per_m);
  EXPECT_EQ(pairs[1]->stiffness_n_per_m, steel.stiffness_n_per_m);
  EXPECT_EQ(pairs[2]->stiffness_n_per_m, combined(steel, steel).stiffness_n_per_m);
  const scene plain{body(std::nullopt), {body(std::nullopt)}};
  EXPECT_FALSE(surfaces_of(plain)[0].has_value());
}

TEST(Material, PresetsAreInRangeAndHaveNames) {
  for (const material& m : material_presets()) {
    EXPECT_TRUE(check(m)) << m.name;
    EXPECT_EQ(preset_material(m.name)->stiffness_n_per_m, m.stiffness_n_per_m);
  }
  const double steel = preset_material("steel")->stiffness_n_per_m, wood = preset_material("wood")->stiffness_n_per_m,
               rubber = preset_material("rubber")->stiffness_n_per_m, ice = preset_material("ice")->stiffness_n_per_m;
  EXPECT_GT(steel, wood);
  EXPECT_GT(steel, ice);
  EXPECT_GT(std::min(wood, ice), 10.0 * rubber);
  const result<material> none = preset_material("stell");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("steel, wood, rubber, ice"), std::string::npos);
}

}  // namespace
}  // namespace asperity
