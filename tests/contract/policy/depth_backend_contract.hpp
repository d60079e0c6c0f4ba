// What every depth backend owes, whatever it runs on. A backend's test names a factory and instantiates the suite:
//
//     struct my_factory {
//       using backend = my_depth;
//       static backend make(const scene& s, gradient_scheme scheme);
//       static constexpr double depth_tolerance_m = ...;      // against the double-precision CPU backend
//       static constexpr double gradient_tolerance = ...;     // angular parts as at a lever arm of 10 mm
//       static constexpr bool repeatable = true;              // same inputs, same bits
//     };
//
//     INSTANTIATE_TYPED_TEST_SUITE_P(MyDepth, DepthBackendContract, my_factory);
//
// A backend that some machines cannot run adds `static std::string unavailable();`: why not here, or nothing where it
// can. A backend without a soft maximum adds `static constexpr bool soft_maximum = false;`. Its soft depth is the
// depth, it tells no curvature, and it is compared with the central differences alone. One that does not sample a grid
// of the default size adds `static window_depth_settings reference(gradient_scheme)`: what the CPU backend needs to
// come near it.
#pragma once

#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <span>
#include <string>

#include "asperity/window/cpu_depth.hpp"
#include "support/height_models.hpp"

namespace asperity {

template <class Factory>
class DepthBackendContract : public ::testing::Test {
 public:
  static_assert(depth_backend<typename Factory::backend>);

  void SetUp() override {
    if constexpr (requires { Factory::unavailable(); }) {
      if (const std::string why = Factory::unavailable(); !why.empty()) GTEST_SKIP() << why;
    }
  }
  static constexpr bool soft_maximum() {
    if constexpr (requires { Factory::soft_maximum; }) return Factory::soft_maximum;
    return true;
  }
  static std::span<const gradient_scheme> schemes() {
    static constexpr std::array all{gradient_scheme::central_difference, gradient_scheme::soft_max};
    return std::span(all).first(soft_maximum() ? 2 : 1);
  }

  static window_depth_settings reference_settings(gradient_scheme scheme) {
    if constexpr (requires { Factory::reference(scheme); }) return Factory::reference(scheme);
    window_depth_settings settings;
    settings.gradient = scheme;
    return settings;
  }

  /// Textured probe (0) and two textured fixed bodies.
  static scene textured_scene() {
    const auto spec = [](double half, double amplitude, double k) {
      test_support::plate_spec s;
      s.half_x = s.half_y = half;
      s.cells_x = s.cells_y = 2;
      s.texels = 512;
      s.height = [=](double x, double y) {
        return amplitude * (std::cos(k * x) + std::sin(0.8 * k * y + 0.2 * k * x));
      };
      s.centre_of_mass = {0.004, -0.003, -0.012};
      return s;
    };
    auto far = spec(0.010, 1e-4, 1900);
    far.T_body_plate.position = {0.05, 0.0, 0.0};
    return {test_support::make_plate(spec(0.007, 2e-4, 2100)),
            {test_support::make_plate(spec(0.010, 1e-4, 2600)), test_support::make_plate(far)}};
  }
  static scene flat_scene(double probe_half = 0.005) {
    test_support::plate_spec a, b;
    a.half_x = a.half_y = probe_half;
    a.texels = b.texels = 64;
    return {test_support::make_plate(a), {test_support::make_plate(b)}};
  }
  static void expect_zero(const penetration& p) {
    EXPECT_TRUE(has(p.flags, depth_flag::no_overlap));
    EXPECT_EQ(p.depth_m, 0.0);
    EXPECT_EQ(p.soft_depth_m, 0.0);
    EXPECT_EQ(p.samples, 0U);
    EXPECT_EQ(test_support::largest_entry(p), 0.0);
  }
  static double difference(const vec6& a, const vec6& b) {
    const vec6 d = a - b;
    double worst = 0.0;
    for (std::size_t i = 0; i < 6; ++i) worst = std::max(worst, std::fabs(d[i]) / (i < 3 ? 1.0 : 0.01));
    return worst;
  }
  /// Contacts of the probe with each fixed body of `s`, whole patches, the same window.
  static contact_set contacts_of(const scene& s, const contact_window& w) {
    contact_set out;
    for (std::uint32_t b = 0; b < s.fixed.size(); ++b) {
      contact c;
      c.window = w;
      c.body = b;
      EXPECT_TRUE(out.add(c, test_support::all_triangles(*s.probe), test_support::all_triangles(*s.fixed[b])));
    }
    return out;
  }
};

/// First contact of the textured scene, the probe pressed in by `extra_m` more.
template <class Backend>
[[nodiscard]] penetration measure_whole_of_two(Backend& backend, const scene& s, double extra_m = 0.0) {
  const contact_set contacts = test_support::whole_contact(s, test_support::window_downwards(5e-3));
  const std::array<pose, 2> T_wb{};
  penetration out;
  const pose T_wa{exp_rotation(vec3(0.01, -0.02, 0.3)) * test_support::face_down(), {5e-4, -3e-4, -1e-4 - extra_m}};
  EXPECT_EQ(backend.measure({T_wa, T_wb}, contacts, std::span(&out, 1)), status::ok);
  return out;
}

TYPED_TEST_SUITE_P(DepthBackendContract);

TYPED_TEST_P(DepthBackendContract, NoContactIsNoWork) {
  const scene s = this->flat_scene();
  const pose T_wb;
  for (const gradient_scheme g : this->schemes()) {
    auto backend = TypeParam::make(s, g);
    const contact_set none;
    EXPECT_EQ(backend.measure({{}, std::span(&T_wb, 1)}, none, {}), status::ok);
  }
}

TYPED_TEST_P(DepthBackendContract, FlatFacesOverlapByWhatTheyOverlap) {
  const scene s = this->flat_scene();
  const contact_window w = test_support::window_downwards(4e-3);
  for (const gradient_scheme g : this->schemes()) {
    auto backend = TypeParam::make(s, g);
    for (const double depth : {3e-4, 1e-6, -2e-4}) {
      const penetration p = test_support::measure_whole(backend, s, w, {test_support::face_down(), {0.0, 0.0, -depth}});
      EXPECT_NEAR(p.depth_m, depth, TypeParam::depth_tolerance_m + 1e-9);
      EXPECT_NEAR(glm::dot(p.gradient.linear, w.n_ab_w), 1.0, TypeParam::gradient_tolerance + 1e-12);
      // Symmetric: no component points anywhere but along n, and no torque about the middle of the face.
      const vec6 about_face{p.gradient.linear,
                            p.gradient.angular - glm::cross(vec3(0.0, 0.0, -0.005), p.gradient.linear)};
      EXPECT_LT(this->difference(about_face, {w.n_ab_w, vec3(0.0)}), TypeParam::gradient_tolerance + 1e-6);
    }
  }
}

TYPED_TEST_P(DepthBackendContract, WithoutACommonSampleEverythingIsZero) {
  const scene s = this->flat_scene();
  for (const gradient_scheme g : this->schemes()) {
    auto backend = TypeParam::make(s, g);
    const contact_window w = test_support::window_downwards(4e-3);
    this->expect_zero(test_support::measure_whole(backend, s, w, {test_support::face_down(), {0.05, 0.0, -1e-4}}));
    // Turned over, the probe shows the window its back.
    this->expect_zero(test_support::measure_whole(
        backend, s, w, {exp_rotation(vec3(1.5707963, 0.0, 0.0)) * test_support::face_down(), {0.0, 0.1, 0.0}}));
    contact_set bare;
    contact c;
    c.window = w;
    ASSERT_TRUE(bare.add(c, {}, {}));
    penetration out;
    const pose T_wb;
    ASSERT_EQ(backend.measure({{test_support::face_down(), vec3(0.0)}, std::span(&T_wb, 1)}, bare, std::span(&out, 1)),
              status::ok);
    this->expect_zero(out);
  }
}

TYPED_TEST_P(DepthBackendContract, AgreesWithTheCpuReference) {
  const scene s = this->textured_scene();
  std::mt19937_64 bits(21);
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0; };
  double worst_depth = 0.0, worst_gradient = 0.0;
  for (const gradient_scheme g : this->schemes()) {
    auto backend = TypeParam::make(s, g);
    cpu_depth reference(s, this->reference_settings(g));
    for (int i = 0; i < 6; ++i) {
      const pose T{exp_rotation(vec3{0.05 * uniform(), 0.05 * uniform(), uniform()}) * test_support::face_down(),
                   {1e-3 * uniform(), 1e-3 * uniform(), 1e-4 * uniform()}};
      const contact_window w = test_support::window_downwards(6e-3);
      const penetration p = test_support::measure_whole(backend, s, w, T),
                        q = test_support::measure_whole(reference, s, w, T);
      EXPECT_EQ(p.flags, q.flags);
      worst_depth =
          std::max({worst_depth, std::fabs(p.depth_m - q.depth_m), std::fabs(p.soft_depth_m - q.soft_depth_m)});
      worst_gradient = std::max(worst_gradient, this->difference(p.gradient, q.gradient));
    }
  }
  EXPECT_LE(worst_depth, TypeParam::depth_tolerance_m);
  EXPECT_LE(worst_gradient, TypeParam::gradient_tolerance);
}

TYPED_TEST_P(DepthBackendContract, ABatchIsTheSumOfItsContacts) {
  const scene s = this->textured_scene();
  const contact_window w = test_support::window_downwards(5e-3);
  const contact_set all = this->contacts_of(s, w);
  const std::array<pose, 2> T_wb{pose{}, pose{quat(1, 0, 0, 0), vec3(-0.05, 0.0, -1e-4)}};
  const scene_pose at{{test_support::face_down(), {1e-4, 2e-4, 0.0}}, T_wb};
  for (const gradient_scheme g : this->schemes()) {
    auto backend = TypeParam::make(s, g);
    std::array<penetration, 2> together;
    ASSERT_EQ(backend.measure(at, all, together), status::ok);
    EXPECT_GT(together[0].samples, 0U);
    EXPECT_GT(together[1].samples, 0U);
    EXPECT_NE(together[0].depth_m, together[1].depth_m);
    for (std::uint32_t i = 0; i < 2; ++i) {
      contact_set one;
      ASSERT_TRUE(one.add(all.contacts()[i], all.patch_a(all.contacts()[i]), all.patch_b(all.contacts()[i])));
      penetration alone;
      ASSERT_EQ(backend.measure(at, one, std::span(&alone, 1)), status::ok);
      EXPECT_NEAR(alone.depth_m, together[i].depth_m, TypeParam::depth_tolerance_m);
      EXPECT_LE(this->difference(alone.gradient, together[i].gradient), TypeParam::gradient_tolerance);
      if (TypeParam::repeatable) {
        EXPECT_EQ(alone.depth_m, together[i].depth_m);
      }
    }
  }
}

TYPED_TEST_P(DepthBackendContract, MovingEverythingTogetherChangesNothing) {
  const scene s = this->textured_scene();
  const pose T_wa{exp_rotation(vec3(0.03, -0.02, 0.4)) * test_support::face_down(), {5e-4, -3e-4, -1e-4}};
  const contact_window w = test_support::window_downwards(5e-3);
  const pose M{exp_rotation(vec3(0.7, -1.1, 0.5)), {0.3, -0.2, 0.1}};
  contact_window turned = w;
  turned.centre_w = M * w.centre_w;
  turned.u_w = M.rotation * w.u_w;
  turned.v_w = M.rotation * w.v_w;
  turned.n_ab_w = M.rotation * w.n_ab_w;
  for (const gradient_scheme g : this->schemes()) {
    auto backend = TypeParam::make(s, g);
    const std::array<pose, 2> here{}, there{M, M};
    std::array<penetration, 2> p, q;
    ASSERT_EQ(backend.measure({T_wa, here}, this->contacts_of(s, w), p), status::ok);
    ASSERT_EQ(backend.measure({M * T_wa, there}, this->contacts_of(s, turned), q), status::ok);
    EXPECT_NEAR(p[0].depth_m, q[0].depth_m, TypeParam::depth_tolerance_m + 1e-12);
    EXPECT_LT(glm::length(M * p[0].witness_w - q[0].witness_w), 1e-3);
    const vec6 carried{M.rotation * p[0].gradient.linear, M.rotation * p[0].gradient.angular};
    EXPECT_LE(this->difference(carried, q[0].gradient), TypeParam::gradient_tolerance + 1e-7);
  }
}

TYPED_TEST_P(DepthBackendContract, CurvatureIsSymmetricAndPositiveSemidefinite) {
  const scene s = this->textured_scene();
  auto backend = TypeParam::make(s, this->schemes().back());
  const penetration p = measure_whole_of_two(backend, s);
  if (!this->soft_maximum()) {
    EXPECT_EQ(p.soft_depth_m, p.depth_m);
    EXPECT_EQ(test_support::largest_entry({.curvature = p.curvature}), 0.0);
    return;
  }
  std::mt19937_64 bits(4);
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0; };
  double trace = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    trace += p.curvature(i, i);
    for (std::size_t j = 0; j < 6; ++j) EXPECT_EQ(p.curvature(i, j), p.curvature(j, i));
  }
  EXPECT_GT(trace, 0.0);
  for (int i = 0; i < 100; ++i) {
    const vec6 x{{uniform(), uniform(), uniform()}, {uniform(), uniform(), uniform()}};
    EXPECT_GE(dot(x, p.curvature * x), -1e-6 * trace);
  }
}

TYPED_TEST_P(DepthBackendContract, TheSameInputsGiveTheSameBits) {
  if (!TypeParam::repeatable) GTEST_SKIP() << "the backend does not promise repeatable bits";
  const scene s = this->textured_scene();
  for (const gradient_scheme g : this->schemes()) {
    auto backend = TypeParam::make(s, g), other = TypeParam::make(s, g);
    const penetration first = measure_whole_of_two(backend, s);
    static_cast<void>(measure_whole_of_two(backend, s, 3e-4));  // another pose in between leaves nothing behind
    for (const penetration& again : {measure_whole_of_two(backend, s), measure_whole_of_two(other, s)}) {
      EXPECT_EQ(again.depth_m, first.depth_m);
      EXPECT_EQ(again.soft_depth_m, first.soft_depth_m);
      EXPECT_EQ(again.curvature.m, first.curvature.m);
      for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(again.gradient[i], first.gradient[i]);
    }
  }
}

TYPED_TEST_P(DepthBackendContract, SizesThatDoNotFitAreRefused) {
  const scene s = this->flat_scene();
  auto backend = TypeParam::make(s, this->schemes().back());
  const contact_set contacts = test_support::whole_contact(s, test_support::window_downwards(4e-3));
  const pose T_wb;
  EXPECT_NE(backend.measure({{}, std::span(&T_wb, 1)}, contacts, {}), status::ok);
  penetration out;
  EXPECT_NE(backend.measure({{}, {}}, contacts, std::span(&out, 1)), status::ok);
}

REGISTER_TYPED_TEST_SUITE_P(DepthBackendContract, NoContactIsNoWork, FlatFacesOverlapByWhatTheyOverlap,
                            WithoutACommonSampleEverythingIsZero, AgreesWithTheCpuReference,
                            ABatchIsTheSumOfItsContacts, MovingEverythingTogetherChangesNothing,
                            CurvatureIsSymmetricAndPositiveSemidefinite, TheSameInputsGiveTheSameBits,
                            SizesThatDoNotFitAreRefused);

}  // namespace asperity
