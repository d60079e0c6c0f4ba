// The reported gradient and curvature against numerical derivatives of the reported depth.
#include <gtest/gtest.h>
#include <random>

#include "asperity/window/cpu_depth.hpp"
#include "support/height_models.hpp"
#include "window/central_difference.hpp"
#include "window/soft_max.hpp"

namespace asperity {
namespace {

using namespace test_support;

constexpr double lever_m = 0.03;  ///< puts angular components beside linear ones

height_function waves(double amplitude, double a, double b) {
  return
      [=](double x, double y) { return amplitude * (std::cos(a * x + 0.3) + std::sin(b * (0.6 * y + 0.3 * x) + 0.3)); };
}

scene textured_pair(double probe_half, bool seams) {
  plate_spec a;
  a.half_x = a.half_y = probe_half;
  a.cells_x = 3;
  a.cells_y = 2;
  a.texels = 768;
  a.chart_per_cell = seams;
  a.height = waves(2e-4, 2000, 2100);
  a.centre_of_mass = {0.012, 0.005, -0.03};
  a.T_body_plate = {exp_rotation(vec3(0.4, -0.3, 1.0)), {0.01, -0.02, 0.005}};
  plate_spec b;
  b.half_x = b.half_y = 0.012;
  b.cells_x = 2;
  b.cells_y = 3;
  b.texels = 768;
  b.chart_per_cell = seams;
  b.height = waves(1.5e-4, 2700, 2600);
  return {make_plate(a), {make_plate(b)}};
}

/// Random pose with the probe's face down near the origin, and a window tilted against both faces.
struct configuration {
  pose T_wa;
  contact_window window;
};
configuration random_configuration(const scene& s, std::mt19937_64& bits) {
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0; };
  const pose T_body_plate{exp_rotation(vec3(0.4, -0.3, 1.0)), {0.01, -0.02, 0.005}};
  const pose T_w_plate{exp_rotation(vec3{0.1 * uniform(), 0.1 * uniform(), uniform()}) * face_down(),
                       {0.002 * uniform(), 0.002 * uniform(), 0.0}};
  configuration c{T_w_plate * inverse(T_body_plate), window_downwards(0.010)};
  const quat tilt = exp_rotation(vec3{0.05 * uniform(), 0.05 * uniform(), uniform()});
  c.window.u_w = tilt * c.window.u_w;
  c.window.v_w = tilt * c.window.v_w;
  c.window.n_ab_w = tilt * c.window.n_ab_w;
  EXPECT_EQ(s.fixed.size(), 1U);
  return c;
}

/// d(soft depth)/dq by central differences of `step_m`. A nanometre: the slope has a kink at each texel border, and a
/// larger step finds one to step over.
vec6 numerical_gradient(cpu_depth& backend, const scene& s, const configuration& c, double step_m) {
  const vec3 centre = centre_of_mass_w(s, c.T_wa);
  vec6 out;
  for (std::size_t i = 0; i < 6; ++i) {
    vec6 q;
    q[i] = i < 3 ? step_m : step_m / lever_m;
    const double plus = measure_whole(backend, s, c.window, moved(c.T_wa, centre, q)).soft_depth_m;
    const double minus = measure_whole(backend, s, c.window, moved(c.T_wa, centre, -1.0 * q)).soft_depth_m;
    out[i] = (plus - minus) / (2.0 * q[i]);
  }
  return out;
}

double largest(const vec6& g) {
  double worst = 0.0;
  for (std::size_t i = 0; i < 6; ++i) worst = std::max(worst, std::fabs(g[i]) / (i < 3 ? 1.0 : lever_m));
  return worst;
}

/// Probe inside the window (silhouettes in it) and beyond it, one chart and many, both lookups.
TEST(SoftMaxGradient, IsTheDerivativeOfTheSoftDepth) {
  double worst_of_all = 0.0;
  for (const double half : {0.006, 0.012}) {
    for (const bool seams : {false, true}) {
      const scene s = textured_pair(half, seams);
      for (const parallax_mode mode : {parallax_mode::exact, parallax_mode::paper_lookup}) {
        window_depth_settings settings;
        settings.grid = 40;
        settings.tau_m = 1e-5;
        settings.parallax = mode;
        cpu_depth backend(s, settings);
        std::mt19937_64 bits(3);
        for (int i = 0; i < 8; ++i) {
          const configuration c = random_configuration(s, bits);
          const penetration p = measure_whole(backend, s, c.window, c.T_wa);
          ASSERT_GT(p.samples, 200U);
          const double error = largest(p.gradient - numerical_gradient(backend, s, c, 1e-9));
          EXPECT_LE(error, 1e-5 * largest(p.gradient)) << "pose " << i << " half " << half << " seams " << seams;
          EXPECT_NEAR(glm::dot(p.gradient.linear, c.window.n_ab_w), 1.0, 1e-12);
          worst_of_all = std::max(worst_of_all, error);
        }
      }
    }
  }
  std::printf("largest difference between the gradient and the numerical derivative: %.2g\n", worst_of_all);
}

TEST(SoftMaxGradient, WithoutTheTapersPartIsNotTheDerivative) {
  const scene s = textured_pair(0.006, false);
  window_depth_settings settings;
  settings.grid = 40;
  settings.tau_m = 1e-5;
  settings.taper_gradient = false;
  cpu_depth backend(s, settings);
  std::mt19937_64 bits(3);
  double worst = 0.0;
  for (int i = 0; i < 8; ++i) {
    const configuration c = random_configuration(s, bits);
    worst = std::max(
        worst, largest(measure_whole(backend, s, c.window, c.T_wa).gradient - numerical_gradient(backend, s, c, 1e-9)));
  }
  EXPECT_GT(worst, 1e-3);
}

/// Second derivative by differences of the gradient, made symmetric; angular parts as at the lever arm.
/// What the curvature leaves out is the turn of each sample's own gradient, of the order of 1 between translation and
/// rotation; it has no definite sign.
TEST(SoftMaxCurvature, IsCloseToTheSecondDerivative) {
  struct entry {
    const char* name;
    height_function probe, fixed;
    double tau, limit;
  };
  const height_function ridges_a = [](double x, double) { return 2e-4 * std::cos(1570.8 * x); };
  const height_function ridges_b = [](double x, double) { return 2e-4 * std::cos(1570.8 * (x - 1.3e-3)); };
  for (const entry& e :
       {entry{"flat on flat", {}, {}, 2e-5, 3e-2}, entry{"ridges in ridges", ridges_a, ridges_b, 2e-5, 3e-2},
        entry{"rough on rough", waves(2e-5, 2000, 2100), waves(2e-5, 2700, 2600), 2e-5, 3e-2}}) {
    plate_spec a, b;
    a.half_x = a.half_y = 0.014;
    b.half_x = b.half_y = 0.014;
    a.texels = b.texels = 512;
    a.height = e.probe;
    b.height = e.fixed;
    a.centre_of_mass = {0.002, 0.001, -0.005};
    const scene s{make_plate(a), {make_plate(b)}};
    window_depth_settings settings;
    settings.tau_m = e.tau;
    cpu_depth backend(s, settings);
    const configuration c{{exp_rotation(vec3(2e-4, -3e-4, 0.0)) * face_down(), {1e-4, 2e-4, -1e-4}},
                          window_downwards(0.01)};
    const vec3 centre = centre_of_mass_w(s, c.T_wa);
    const penetration p = measure_whole(backend, s, c.window, c.T_wa);
    mat6 numerical;
    double size = 0.0;
    for (std::size_t j = 0; j < 6; ++j) {
      vec6 q;
      q[j] = j < 3 ? 2e-6 : 2e-6 / lever_m;
      const vec6 plus = measure_whole(backend, s, c.window, moved(c.T_wa, centre, q)).gradient;
      const vec6 minus = measure_whole(backend, s, c.window, moved(c.T_wa, centre, -1.0 * q)).gradient;
      for (std::size_t i = 0; i < 6; ++i) numerical(i, j) = (plus[i] - minus[i]) / (2.0 * q[j]);
    }
    const auto arm = [](std::size_t i) { return i < 3 ? 1.0 : lever_m; };
    double worst = 0.0;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        const double scale = arm(i) * arm(j);
        size = std::max(size, std::fabs(p.curvature(i, j)) / scale);
        worst = std::max(worst, std::fabs(p.curvature(i, j) - 0.5 * (numerical(i, j) + numerical(j, i))) / scale);
        EXPECT_EQ(p.curvature(i, j), p.curvature(j, i));
      }
    }
    std::printf("curvature against the second derivative, %s: difference %.2g of the largest entry\n", e.name,
                worst / size);
    EXPECT_LE(worst / size, e.limit) << e.name;
  }
}

TEST(SoftMaxCurvature, IsPositiveSemidefinite) {
  const scene s = textured_pair(0.006, true);
  window_depth_settings settings;
  settings.grid = 32;
  cpu_depth backend(s, settings);
  std::mt19937_64 bits(9);
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0; };
  for (int i = 0; i < 20; ++i) {
    const configuration c = random_configuration(s, bits);
    const mat6 C = measure_whole(backend, s, c.window, c.T_wa).curvature;
    double trace = 0.0;
    for (std::size_t k = 0; k < 6; ++k) trace += C(k, k);
    for (int k = 0; k < 20; ++k) {
      const vec6 x{{uniform(), uniform(), uniform()}, {uniform(), uniform(), uniform()}};
      EXPECT_GE(dot(x, C * x), -1e-12 * trace);
    }
  }
}

TEST(CentralDifference, AgreesWithTheSoftGradientOnASmoothBump) {
  const auto cap = [](double x, double y) { return -(x * x + y * y) / (2.0 * 0.02); };
  plate_spec a, b;
  a.height = b.height = cap;
  a.texels = b.texels = 1024;
  b.half_x = b.half_y = 0.012;
  a.centre_of_mass = {0.012, 0.005, -0.03};
  const scene s{make_plate(a), {make_plate(b)}};
  window_depth_settings settings;
  settings.tau_m = 2e-6;
  settings.grid = 128;
  settings.refine_maximum = true;
  cpu_depth soft(s, settings);
  settings.gradient = gradient_scheme::central_difference;
  cpu_depth differences(s, settings);
  const pose T{exp_rotation(vec3(0.02, -0.03, 0.5)) * face_down(), {1e-3, -7e-4, -2e-4}};
  const contact_window w = window_downwards(4e-3);
  const penetration p = measure_whole(soft, s, w, T), q = measure_whole(differences, s, w, T);
  EXPECT_LT(largest(p.gradient - q.gradient), 2e-3);
  EXPECT_EQ(q.soft_depth_m, q.depth_m);
  EXPECT_EQ(q.curvature.m, mat6{}.m);
  EXPECT_EQ(glm::dot(q.gradient.linear, w.n_ab_w), 1.0);
}

TEST(CentralDifference, TakesOneSideWhereTheOtherIsEmptyAndNothingWhereBothAre) {
  using detail::quotient;
  EXPECT_DOUBLE_EQ(quotient(3.0, 1.0, 1.5, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(quotient(3.0, std::nullopt, 1.5, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(quotient(std::nullopt, 1.0, 1.5, 0.5), 1.0);
  EXPECT_DOUBLE_EQ(quotient(std::nullopt, std::nullopt, 1.5, 0.5), 0.0);
  // Signed depths: a gap on one side counts as it is.
  EXPECT_DOUBLE_EQ(quotient(0.1, -0.3, -0.1, 0.5), 0.4);
}

}  // namespace
}  // namespace asperity
