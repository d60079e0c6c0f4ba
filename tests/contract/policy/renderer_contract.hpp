// What every renderer owes, whatever its formulation, depth backend and force model. A renderer's test names a factory
// and instantiates the suite:
//
//     struct my_factory {
//       static any_renderer make(const scene& bodies);
//     };
//     INSTANTIATE_TYPED_TEST_SUITE_P(MyRenderer, RendererContract, my_factory);
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/render/any_renderer.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"

namespace asperity {

template <class Factory>
class RendererContract : public ::testing::Test {
 public:
  static constexpr double half_probe_m = 0.01, half_fixed_m = 0.02;

  /// A box with relief, and two larger ones that lie beside each other.
  static const scene& bodies() {
    static const scene made = [] {
      const auto relief = [](const vec3& p, const vec3&) {
        return 1e-4 * std::sin(900.0 * p.x) * std::cos(700.0 * p.y);
      };
      const auto box = [&](double half_m) {
        return std::make_shared<const textured_model>(
            test_support::make_textured_box({half_m, half_m, 0.5 * half_m}, 96, relief));
      };
      const model_ptr fixed = box(half_fixed_m), other = box(0.9 * half_fixed_m);
      return scene{box(half_probe_m), {fixed, other}};
    }();
    return made;
  }
  static std::vector<pose> where_fixed() { return {pose{}, {quat(1, 0, 0, 0), {0.05, 0.0, 0.0}}}; }

  /// Draws poses of the probe near the upper faces: pressed by up to a millimetre, or not quite there.
  class poses {
   public:
    explicit poses(const char* test) : bits_(test_support::fresh_seed(test, "20 poses")) {}
    pose next() {
      const quat turn = exp_rotation(vec3(0.2 * unit(), 0.2 * unit(), 3.0 * unit()));
      const vec3 at(0.01 * unit() + (unit() > 0.3 ? 0.05 : 0.0), 0.01 * unit(), 0.0);
      const double lowest = std::fabs((turn * vec3(half_probe_m, 0, 0)).z) +
                            std::fabs((turn * vec3(0, half_probe_m, 0)).z) +
                            std::fabs((turn * vec3(0, 0, 0.5 * half_probe_m)).z);
      return {turn, {at.x, at.y, 0.5 * half_fixed_m + lowest - 4e-4 + 6e-4 * unit()}};
    }

   private:
    double unit() { return 2.0 * static_cast<double>(bits_() >> 11) * 0x1p-53 - 1.0; }
    std::mt19937_64 bits_;
  };

  static void expect_nothing(const tick& t) {
    EXPECT_EQ(t.force.on_probe_w.force, vec3(0.0));
    EXPECT_EQ(t.force.on_probe_w.torque, vec3(0.0));
    for (const double x : t.force.stiffness.m) EXPECT_EQ(x, 0.0);
    for (const penetration& p : t.depths) EXPECT_LE(p.depth_m, 0.0);
  }
};

TYPED_TEST_SUITE_P(RendererContract);

TYPED_TEST_P(RendererContract, FeelsNothingFarAway) {
  any_renderer feel = TypeParam::make(this->bodies());
  const std::vector<pose> fixed = this->where_fixed();
  tick t;
  ASSERT_EQ(feel.step({{quat(1, 0, 0, 0), {0.0, 0.0, 0.2}}, fixed}, t), status::ok);
  this->expect_nothing(t);
  EXPECT_TRUE(t.contacts.empty());
}

TYPED_TEST_P(RendererContract, PushesBackHarderTheDeeperItIs) {
  any_renderer feel = TypeParam::make(this->bodies());
  const std::vector<pose> fixed = this->where_fixed();
  const double touch_m = 0.5 * (this->half_probe_m + this->half_fixed_m);
  double last_n = 0.0;
  for (const double depth_m : {1e-4, 3e-4, 6e-4, 1e-3}) {
    tick t;
    ASSERT_EQ(feel.step({{quat(1, 0, 0, 0), {0.0, 0.0, touch_m + 1e-4 - depth_m}}, fixed}, t), status::ok);
    EXPECT_GT(t.force.on_probe_w.force.z, last_n) << depth_m;
    last_n = t.force.on_probe_w.force.z;
    ASSERT_EQ(t.contacts.size(), t.depths.size());
    EXPECT_GE(t.contacts.size(), 1U);
    for (const contact& c : t.contacts) EXPECT_NEAR(glm::length(c.window.n_ab_w), 1.0, 1e-9);
  }
}

TYPED_TEST_P(RendererContract, TheSameMotionGivesTheSameBits) {
  typename TestFixture::poses draw("renderer contract, bits");
  any_renderer first = TypeParam::make(this->bodies()), second = TypeParam::make(this->bodies());
  const std::vector<pose> fixed = this->where_fixed();
  int felt = 0;
  for (int i = 0; i < 20; ++i) {
    const pose T_wa = draw.next();
    tick a, b;
    const status s = first.step({T_wa, fixed}, a);
    ASSERT_EQ(second.step({T_wa, fixed}, b), s);
    EXPECT_EQ(a.force.on_probe_w.force, b.force.on_probe_w.force);
    EXPECT_EQ(a.force.on_probe_w.torque, b.force.on_probe_w.torque);
    EXPECT_EQ(a.force.stiffness.m, b.force.stiffness.m);
    EXPECT_EQ(a.contacts.size(), b.contacts.size());
    felt += glm::length(a.force.on_probe_w.force) > 0.0 ? 1 : 0;
  }
  EXPECT_GE(felt, 3);
}

// The bodies feel together what the probe feels, and only what touches feels anything.
TYPED_TEST_P(RendererContract, TellsWhatEachBodyFeels) {
  typename TestFixture::poses draw("renderer contract, bodies");
  any_renderer feel = TypeParam::make(this->bodies());
  std::array<int, 2> felt{};
  int several = 0;
  const auto centre_w = [&](std::size_t b, const pose& T_wb) {
    return T_wb * this->bodies().fixed[b]->mass.centre_of_mass;
  };
  for (int i = 0; i < 20; ++i) {
    pose T_wa = draw.next();
    if (i % 2 == 0) T_wa = {quat(1, 0, 0, 0), {0.021, T_wa.position.y, 0.0148}};  // on both
    tick t;
    const std::vector<pose> fixed{pose{}, {quat(1, 0, 0, 0), {0.04, 0.0, 0.001}}};
    static_cast<void>(feel.step({T_wa, fixed}, t));
    ASSERT_EQ(t.on_body.size(), 2U);
    wrench sum = t.force.on_probe_w;
    for (std::size_t b = 0; b < 2; ++b) sum += transport(t.on_body[b], centre_w(b, fixed[b]), t.centre_of_mass_w);
    const double size_n = glm::length(t.force.on_probe_w.force);
    EXPECT_LE(glm::length(sum.force), 1e-12 * size_n);
    EXPECT_LE(glm::length(sum.torque), 1e-12 * size_n);
    // Its contacts are its parts too, and the parts of a body's contacts are that body's where it says so.
    ASSERT_EQ(t.by_contact.size(), t.contacts.size());
    wrench parts = -1.0 * t.force.on_probe_w;
    double parts_n = 0.0;
    for (const wrench& w : t.by_contact) {
      parts += w;
      parts_n += glm::length(w.force);
    }
    EXPECT_LE(glm::length(parts.force), 1e-12 * parts_n);
    EXPECT_LE(glm::length(parts.torque), 1e-12 * parts_n);
    several += t.contacts.size() > 1 ? 1 : 0;
    // Each alone: the other is out of reach.
    for (std::size_t b = 0; b < 2; ++b) {
      std::vector<pose> apart = fixed;
      apart[1 - b].position.z = -1.0;
      static_cast<void>(feel.step({T_wa, apart}, t));
      const wrench expected = -1.0 * transport(t.force.on_probe_w, t.centre_of_mass_w, centre_w(b, apart[b]));
      EXPECT_LE(glm::length(t.on_body[b].force - expected.force), 1e-12 * glm::length(expected.force));
      EXPECT_LE(glm::length(t.on_body[b].torque - expected.torque), 1e-12 * glm::length(expected.force));
      EXPECT_TRUE(is_zero(t.on_body[1 - b]));
      felt[b] += is_zero(expected) ? 0 : 1;
    }
  }
  EXPECT_GE(felt[0], 3);
  EXPECT_GE(felt[1], 3);
  std::printf("  contacts: several at once in %d of 20 ticks\n", several);
}

TYPED_TEST_P(RendererContract, StiffnessIsSymmetricAndNegativeSemidefinite) {
  typename TestFixture::poses draw("renderer contract, stiffness");
  std::mt19937_64 bits(test_support::fresh_seed("renderer contract, directions", "100 directions"));
  const auto unit = [&] { return 2.0 * static_cast<double>(bits() >> 11) * 0x1p-53 - 1.0; };
  any_renderer feel = TypeParam::make(this->bodies());
  const std::vector<pose> fixed = this->where_fixed();
  for (int i = 0; i < 20; ++i) {
    tick t;
    const status s = feel.step({draw.next(), fixed}, t);
    ASSERT_TRUE(s == status::ok || s == status::capacity_reached);
    const mat6& J = t.force.stiffness;
    double trace = 0.0;
    for (std::size_t r = 0; r < 6; ++r) {
      trace += J(r, r);
      for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(J(r, c), J(c, r), 1e-9 * (1.0 + std::fabs(J(r, c))));
    }
    for (int k = 0; k < 100; ++k) {
      // Turns of a radian move the probe's corners by a centimetre.
      const vec6 x{{unit(), unit(), unit()}, {100.0 * unit(), 100.0 * unit(), 100.0 * unit()}};
      EXPECT_LE(dot(x, J * x), 1e-9 * (1.0 - trace));
    }
  }
}

TYPED_TEST_P(RendererContract, WhatIsNoPoseLeavesAZero) {
  any_renderer feel = TypeParam::make(this->bodies());
  const std::vector<pose> fixed = this->where_fixed();
  const pose pressed{quat(1, 0, 0, 0), {0.0, 0.0, 0.0145}};
  tick t;
  ASSERT_EQ(feel.step({pressed, fixed}, t), status::ok);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const pose& bad :
       {pose{quat(1, 0, 0, 0), {nan, 0, 0}}, pose{quat(2, 0, 0, 0), {0, 0, 0}}, pose{quat(nan, 0, 0, 0), {0, 0, 0}}}) {
    ASSERT_EQ(feel.step({pressed, fixed}, t), status::ok);
    EXPECT_EQ(feel.step({bad, fixed}, t), status::invalid_pose);
    this->expect_nothing(t);
    EXPECT_TRUE(t.contacts.empty());
    EXPECT_EQ(feel.step({pressed, std::vector<pose>{pose{}, bad}}, t), status::invalid_pose);
    this->expect_nothing(t);
  }
  EXPECT_EQ(feel.step({pressed, std::vector<pose>(1)}, t), status::not_ready);
  this->expect_nothing(t);
  // It answers again afterwards.
  ASSERT_EQ(feel.step({pressed, fixed}, t), status::ok);
  EXPECT_GT(t.force.on_probe_w.force.z, 0.0);
}

TYPED_TEST_P(RendererContract, ItsMemoryStaysTheSame) {
  typename TestFixture::poses draw("renderer contract, memory");
  any_renderer feel = TypeParam::make(this->bodies());
  const std::vector<pose> fixed = this->where_fixed();
  const std::size_t before = feel.memory_bytes();
  EXPECT_GT(before, 1000U);
  tick t;
  for (int i = 0; i < 20; ++i) static_cast<void>(feel.step({draw.next(), fixed}, t));
  EXPECT_EQ(feel.memory_bytes(), before);
}

REGISTER_TYPED_TEST_SUITE_P(RendererContract, FeelsNothingFarAway, PushesBackHarderTheDeeperItIs,
                            TheSameMotionGivesTheSameBits, TellsWhatEachBodyFeels,
                            StiffnessIsSymmetricAndNegativeSemidefinite, WhatIsNoPoseLeavesAZero,
                            ItsMemoryStaysTheSame);

}  // namespace asperity
