// What every force model owes. A model's test names a factory and instantiates the suite:
//
//     struct my_factory {
//       using model = my_force;
//       static model make(double stiffness_n_per_m);
//     };
//     INSTANTIATE_TYPED_TEST_SUITE_P(MyForce, ForceModelContract, my_factory);
#pragma once

#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "asperity/render/force_model.hpp"
#include "support/fresh_seed.hpp"

namespace asperity {

template <class Factory>
class ForceModelContract : public ::testing::Test {
 public:
  static_assert(force_model<typename Factory::model>);

  /// A contact that pushes the probe along -n, and a depth to go with it.
  static contact contact_along(const vec3& n, std::uint32_t body = 0) {
    contact c;
    c.window.n_ab_w = n;
    c.window.u_w = any_orthogonal(n);
    c.window.v_w = glm::cross(n, c.window.u_w);
    c.window.half_size_m = 5e-3;
    c.body = body;
    return c;
  }
  static penetration depth_along(const vec3& n, double depth_m) {
    penetration p;
    p.depth_m = p.soft_depth_m = depth_m;
    p.gradient = {n + 0.1 * any_orthogonal(n), {0.002, -0.003, 0.001}};
    add_outer(p.curvature, 200.0, {any_orthogonal(n), {0.003, 0.001, -0.002}});
    p.area_m2 = 1e-5;
    p.samples = 100;
    return p;
  }
  struct input {
    contact_set contacts;
    std::vector<penetration> depths;
    void add(const contact& c, const penetration& p) {
      EXPECT_TRUE(contacts.add(c, {}, {}));
      depths.push_back(p);
    }
  };
  static input three_contacts() {
    input in;
    in.add(contact_along({0, 0, -1}), depth_along({0, 0, -1}, 3e-4));
    in.add(contact_along({0, 0.6, -0.8}), depth_along({0, 0.6, -0.8}, 2e-4));
    in.add(contact_along({1, 0, 0}, 1), depth_along({1, 0, 0}, 1e-4));
    return in;
  }
  /// One call, whose report has to fit together.
  static status feel(typename Factory::model& model, const contact_set& contacts, std::span<const penetration> depths,
                     contact_force& out) {
    force_report report;
    const status s = model.accumulate({}, contacts, depths, report);
    EXPECT_EQ(report.contacts.size(), report.depths.size());
    EXPECT_LE(report.contacts.size(), contacts.size());
    out = report.force;
    return s;
  }
  static void expect_zero(const contact_force& f) {
    EXPECT_EQ(f.on_probe_w.force, vec3(0.0));
    EXPECT_EQ(f.on_probe_w.torque, vec3(0.0));
    for (const double x : f.stiffness.m) EXPECT_EQ(x, 0.0);
  }
};

TYPED_TEST_SUITE_P(ForceModelContract);

TYPED_TEST_P(ForceModelContract, NothingToFeelIsExactlyZero) {
  auto model = TypeParam::make(2000.0);
  contact_force out{{vec3(1.0), vec3(1.0)}, {}};
  EXPECT_EQ(this->feel(model, contact_set{}, {}, out), status::ok);
  this->expect_zero(out);

  typename TestFixture::input in;
  in.add(this->contact_along({0, 0, -1}), this->depth_along({0, 0, -1}, -1e-4));
  in.add(this->contact_along({0, 0, -1}), this->depth_along({0, 0, -1}, 0.0));
  penetration nothing = this->depth_along({0, 0, -1}, 1e-4);
  nothing.flags = depth_flag::no_overlap;
  in.add(this->contact_along({0, 0, -1}), nothing);
  EXPECT_EQ(this->feel(model, in.contacts, in.depths, out), status::ok);
  this->expect_zero(out);
}

TYPED_TEST_P(ForceModelContract, PushesTheProbeAwayAndHarderTheDeeperItIs) {
  auto model = TypeParam::make(2000.0);
  double last = 0.0;
  for (const double depth : {1e-5, 1e-4, 5e-4, 1e-3}) {
    typename TestFixture::input in;
    in.add(this->contact_along({0, 0, -1}), this->depth_along({0, 0, -1}, depth));
    contact_force out;
    ASSERT_EQ(this->feel(model, in.contacts, in.depths, out), status::ok);
    EXPECT_GT(out.on_probe_w.force.z, last);
    last = out.on_probe_w.force.z;
  }
}

TYPED_TEST_P(ForceModelContract, StiffnessIsSymmetricAndNegativeSemidefinite) {
  auto model = TypeParam::make(2000.0);
  auto in = this->three_contacts();
  contact_force out;
  ASSERT_EQ(this->feel(model, in.contacts, in.depths, out), status::ok);
  const std::uint64_t seed = test_support::fresh_seed("force model contract", "100 directions");
  std::mt19937_64 bits(test_support::seed_of(seed, "stiffness"));
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0; };
  double trace = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    trace += out.stiffness(i, i);
    for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(out.stiffness(i, j), out.stiffness(j, i), 1e-9);
  }
  EXPECT_LT(trace, 0.0);
  for (int i = 0; i < 200; ++i) {
    const vec6 x{{uniform(), uniform(), uniform()}, {uniform(), uniform(), uniform()}};
    EXPECT_LE(dot(x, out.stiffness * x), -1e-12 * trace);
  }
}

TYPED_TEST_P(ForceModelContract, TheOrderOfTheContactsDoesNotMatter) {
  auto model = TypeParam::make(2000.0);
  auto in = this->three_contacts();
  typename TestFixture::input back;
  for (std::size_t i = in.depths.size(); i-- > 0;) back.add(in.contacts.contacts()[i], in.depths[i]);
  contact_force a, b;
  ASSERT_EQ(this->feel(model, in.contacts, in.depths, a), status::ok);
  ASSERT_EQ(this->feel(model, back.contacts, back.depths, b), status::ok);
  EXPECT_LT(glm::length(a.on_probe_w.force - b.on_probe_w.force), 1e-12);
  EXPECT_LT(glm::length(a.on_probe_w.torque - b.on_probe_w.torque), 1e-12);
}

TYPED_TEST_P(ForceModelContract, KeepsNothingFromCallToCall) {
  auto model = TypeParam::make(2000.0);
  auto in = this->three_contacts();
  contact_force first, other, again;
  ASSERT_EQ(this->feel(model, in.contacts, in.depths, first), status::ok);
  ASSERT_EQ(this->feel(model, contact_set{}, {}, other), status::ok);
  ASSERT_EQ(this->feel(model, in.contacts, in.depths, again), status::ok);
  EXPECT_EQ(first.on_probe_w.force, again.on_probe_w.force);
  EXPECT_EQ(first.on_probe_w.torque, again.on_probe_w.torque);
  EXPECT_EQ(first.stiffness.m, again.stiffness.m);
}

TYPED_TEST_P(ForceModelContract, AContactAppearsWithoutAJump) {
  auto model = TypeParam::make(2000.0);
  auto in = this->three_contacts();
  contact_force without, with;
  ASSERT_EQ(this->feel(model, in.contacts, in.depths, without), status::ok);
  in.add(this->contact_along({0, 0.2, -0.9797958971132712}), this->depth_along({0, 0.2, -0.9797958971132712}, 1e-10));
  ASSERT_EQ(this->feel(model, in.contacts, in.depths, with), status::ok);
  EXPECT_LT(glm::length(with.on_probe_w.force - without.on_probe_w.force), 1e-6);
}

TYPED_TEST_P(ForceModelContract, NotANumberInIsZeroOut) {
  auto model = TypeParam::make(2000.0);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int where = 0; where < 5; ++where) {
      auto in = this->three_contacts();
      penetration& p = in.depths[1];
      if (where == 0) p.depth_m = p.soft_depth_m = bad;
      if (where == 1) p.gradient.linear.y = bad;
      if (where == 2) p.gradient.angular.x = bad;
      if (where == 3) p.curvature(2, 3) = bad;
      if (where == 4) p.area_m2 = bad;
      contact_force out;
      EXPECT_EQ(this->feel(model, in.contacts, in.depths, out), status::not_finite) << where << ' ' << bad;
      this->expect_zero(out);
    }
  }
}

TYPED_TEST_P(ForceModelContract, MissingDepthsAreRefused) {
  auto model = TypeParam::make(2000.0);
  auto in = this->three_contacts();
  contact_force out;
  EXPECT_NE(this->feel(model, in.contacts, std::span(in.depths).first(2), out), status::ok);
  this->expect_zero(out);
}

REGISTER_TYPED_TEST_SUITE_P(ForceModelContract, NothingToFeelIsExactlyZero, PushesTheProbeAwayAndHarderTheDeeperItIs,
                            StiffnessIsSymmetricAndNegativeSemidefinite, TheOrderOfTheContactsDoesNotMatter,
                            KeepsNothingFromCallToCall, AContactAppearsWithoutAJump, NotANumberInIsZeroOut,
                            MissingDepthsAreRefused);

}  // namespace asperity
