// Periodic textures: ridges and egg crates on each other, stripes that turn, a ball on a sine.
#include <array>
#include <numbers>

#include "law/oracle/closed_forms.hpp"

namespace asperity::oracle {
namespace {

using namespace test_support;
constexpr double pi = std::numbers::pi;

/// Amplitude of the sum of two sines of amplitudes a and b whose phases differ by K s.
double sum_amplitude(double a, double b, double K, double s) {
  return std::sqrt(std::max(0.0, a * a + b * b + 2.0 * a * b * std::cos(K * s)));
}

/// Bound of what a grid of pitch p misses at the crest of a sine.
double missed(double amplitude, double pitch, double lambda) {
  return amplitude * (1.0 - std::cos(pi * pitch / lambda));
}

/// Probe at (x, y) with its plane d below the fixed body's (all mm).
pose above(double x, double y, double d) { return {face_down(), mm * vec3(x, y, -d)}; }

const scene& ridges_on_ridges(double a, double b, double lambda) {
  static kept_scenes made;
  return made.of({a, b, lambda}, [=] {
    const double K = 2.0 * pi / lambda;
    return scene{make_plate(plate_mm(3.2 * lambda, 1024, [=](double x, double) { return a * std::cos(K * x); })),
                 {make_plate(plate_mm(2.2 * lambda, 1024, [=](double x, double) { return b * std::cos(K * x); }))}};
  });
}

TEST(ClosedForms, RidgesOnRidgesTranslated) {
  error_table table("O1: sine ridges on sine ridges (depths in mm)");
  for (const json& c : cases("O1_sine_ridges_translation")) {
    const double a = c["a"], b = c["b"], lambda = c["lam"], d = c["d"], s = c["s"], K = 2.0 * pi / lambda;
    const scene& bodies = ridges_on_ridges(a, b, lambda);
    const contact_window window = window_downwards(2.0 * lambda * mm);

    cpu_depth fine(bodies, settings_for(gradient_scheme::soft_max, 400, 0.01, 0.0));
    const penetration f = measure_whole(fine, bodies, window, above(s, 0, d));
    table.add("depth, N = 400", std::fabs(f.depth_m / mm - double(c["delta"])), 1e-3);

    cpu_depth coarse(bodies, settings_for(gradient_scheme::central_difference, 50, 0.01, 0.1));
    const penetration p = measure_whole(coarse, bodies, window, above(s, 0, d));
    const double bound = missed(a, 4.0 * lambda / 50, lambda) + missed(b, 4.0 * lambda / 50, lambda);
    table.add("depth, N = 50, against the sampling bound", std::fabs(p.depth_m / mm - double(c["delta"])), bound);

    // The difference quotient is that of the closed form over the same step; what differs is the sampled maximum.
    cpu_depth differences(bodies, settings_for(gradient_scheme::central_difference, 200, 0.01, 0.1));
    const penetration q = measure_whole(differences, bodies, window, above(s, 0, d));
    const auto depth = [&](double at) { return d + sum_amplitude(a, b, K, at); };
    table.add("d(depth)/ds, central difference, N = 200",
              std::fabs(q.gradient.linear.x - (depth(s + 0.1) - depth(s - 0.1)) / 0.2), 1e-2);

    for (const bool finely : {false, true}) {
      const penetration plus = finely ? f : p;
      const penetration minus = measure_whole(finely ? fine : coarse, bodies, window, above(-s, 0, d));
      const double force = std::sqrt(glm::dot(plus.gradient.linear, plus.gradient.linear));
      table.add("force along the ridges, share of |F|", std::fabs(plus.gradient.linear.y) / force, 1e-6);
      table.add("F_x(s) + F_x(-s), share of |F|", std::fabs(plus.gradient.linear.x + minus.gradient.linear.x) / force,
                1e-6);
    }
  }
}

TEST(ClosedForms, SoftMaximumOfRidges) {
  error_table table("O10: soft maximum of sine ridges over whole wavelengths (depths in mm)");
  for (const json& c : cases("O10_lse_ridges")) {
    const double a = c["a"], b = c["b"], lambda = c["lam"];
    const scene& bodies = ridges_on_ridges(a, b, lambda);
    window_depth_settings settings = settings_for(gradient_scheme::soft_max, 400, c["tau"], 0.0);
    settings.taper_window = false;  // the closed form weighs all samples alike
    settings.reference_area_m2 = 16.0 * lambda * lambda * mm * mm;
    cpu_depth backend(bodies, settings);
    const penetration p = measure_whole(backend, bodies, window_downwards(2.0 * lambda * mm), above(c["s"], 0, c["d"]));
    table.add("soft depth", std::fabs(p.soft_depth_m / mm - double(c["delta"])), 1e-3);
    table.add("d(soft depth)/ds", std::fabs(p.gradient.linear.x - double(c["ddelta_ds"])), 1e-2);
  }
}

TEST(ClosedForms, EggCrates) {
  error_table table("O2: egg crate on egg crate (depths in mm)");
  kept_scenes made;
  for (const json& c : cases("O2_eggcrate")) {
    const double a = c["a"], b = c["b"], lambda = c["lam"], d = c["d"], sx = c["sx"], sy = c["sy"];
    const double K = 2.0 * pi / lambda, delta = c["delta"];
    const auto crate = [K](double amplitude) {
      return [=](double x, double y) { return amplitude * (std::cos(K * x) + std::cos(K * y)); };
    };
    const scene& bodies = made.of({a, b, lambda}, [&] {
      return scene{make_plate(plate_mm(3.2 * lambda, 1024, crate(a))),
                   {make_plate(plate_mm(2.2 * lambda, 1024, crate(b)))}};
    });
    const contact_window window = window_downwards(2.0 * lambda * mm);
    for (const std::uint32_t n : {50U, 400U}) {
      const double bound = 2.0 * (missed(a, 4.0 * lambda / n, lambda) + missed(b, 4.0 * lambda / n, lambda));
      cpu_depth backend(bodies, settings_for(gradient_scheme::soft_max, n, 0.01, 0.0));
      const penetration p = measure_whole(backend, bodies, window, above(sx, sy, d));
      table.add("depth, N = " + std::to_string(n), std::fabs(p.depth_m / mm - delta), n == 400 ? 1e-3 : bound);
      if (n == 400 && sx != 1.5) {
        const vec6 g = gradient_of({c["Fx"], c["Fy"], c["Fz"]}, vec3(0.0), 1.0, delta);
        // At half a wavelength, 1.5 mm, four witnesses tie; the closed form gives a slope everywhere else.
        table.add("gradient, soft maximum, N = 400",
                  std::max(std::fabs(p.gradient.linear.x - g.linear.x), std::fabs(p.gradient.linear.y - g.linear.y)),
                  2e-2);
      }
    }
  }
}

TEST(ClosedForms, StripedDiscTurns) {
  error_table table("O3: striped disc turning on stripes (depths in mm)");
  double opposing = 0.0, turned = 0.0;
  kept_scenes made;
  for (const json& c : cases("O3_striped_disc_rotation")) {
    const double a = c["a"], lambda = c["lam"], w = c["w"], d = c["d"], theta = c["theta"], K = 2.0 * pi / lambda;
    const scene& bodies = made.of({a, lambda, w}, [&] {
      plate_spec disc = plate_mm(w, 1024, [=](double x, double) { return -a * std::cos(K * x); });
      disc.disc = true;
      return scene{make_plate(disc),
                   {make_plate(plate_mm(1.1 * w, 1024, [=](double x, double) { return a * std::cos(K * x); }))}};
    });
    const quat turn = exp_rotation(vec3(0.0, 0.0, theta));
    cpu_depth backend(bodies, settings_for(gradient_scheme::central_difference, 200, 0.01, 0.1));
    const double pitch = 2.04 * w / 200;
    const penetration p =
        measure_whole(backend, bodies, window_downwards(1.02 * w * mm), {turn * face_down(), mm * vec3(0.0, 0.0, -d)});
    // Crests missed on both bodies, and a rim that the samples reach to within a pitch.
    const double bound = 2.0 * missed(a, pitch, lambda) + a * K * theta * pitch + 1e-4;
    table.add("depth, N = 200", std::fabs(p.depth_m / mm - double(c["delta"])), bound);
    if (theta > 0.004 && theta < 0.9 * lambda / (2.0 * w)) {
      turned += 1.0;
      opposing += -p.gradient.angular.z * theta < 0.0 ? 1.0 : 0.0;
    }
  }
  EXPECT_GT(turned, 0.0);
  EXPECT_EQ(opposing, turned) << "torque that turns the disc further";
}

TEST(ClosedForms, BallOnSine) {
  error_table table("O4: ball on a sine (depths in mm)");
  kept_scenes made;
  for (const json& c : cases("O4_sphere_on_sine")) {
    const double a = c["a"], lambda = c["lam"], R = c["R"], s = c["s"], K = 2.0 * pi / lambda;
    const double half = std::min(0.65 * R, lambda);
    const scene& bodies = made.of({a, lambda, R}, [&] {
      return scene{
          make_plate(plate_mm(half, 1024, [=](double x, double y) { return std::sqrt(R * R - x * x - y * y) - R; })),
          {make_plate(plate_mm(2.2 * lambda, 1024, [=](double x, double) { return a * std::cos(K * x); }))}};
    });
    const double depth = 0.1, centre_z = double(c["offset_height"]) - depth;
    const contact_window window = window_downwards(half * mm, mm * vec3(s, 0.0, 0.0));
    const pose T_wa{face_down(), mm * vec3(s, 0.0, centre_z - R)};
    const double pitch = 2.0 * half / 400;
    const double curvature = a * K * K + 1.0 / R;  // at most, across the ridges; 1 / R along them
    cpu_depth backend(bodies, settings_for(gradient_scheme::soft_max, 400, 0.002, 0.0));
    const penetration p = measure_whole(backend, bodies, window, T_wa);
    table.add("depth, N = 400", std::fabs(p.depth_m / mm - depth),
              0.125 * (curvature + 1.0 / R) * pitch * pitch + 2e-4);
    table.add("d(depth)/ds, soft maximum", std::fabs(p.gradient.linear.x - double(c["slope"])), 2e-2);
  }
}

}  // namespace
}  // namespace asperity::oracle
