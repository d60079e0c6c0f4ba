// The exact maximum against the closed forms: what is left is the texture's bilinear interpolation, and epsilon.
#include <array>
#include <numbers>

#include "exact/exact_depth.hpp"
#include "law/oracle/closed_forms.hpp"
#include "law/oracle/ellipsoid_on_plane.hpp"

namespace asperity::oracle {
namespace {

using namespace test_support;

/// What a chord of one texel misses of a sine, mm.
double chord(double amplitude, double K, double texel) { return amplitude * K * K * texel * texel / 8.0; }

/// float32 texels some 10 mm from the origin on either body, and the search's epsilon of 1e-8 m: mm.
constexpr double rounding = 2.0 * 1e-6 + 1e-5;

double error_mm(exact_depth& backend, const scene& bodies, const contact_window& window, const pose& T_wa,
                double delta) {
  const double error = std::fabs(measure_whole(backend, bodies, window, T_wa).depth_m / mm - delta);
  EXPECT_FALSE(backend.brackets()[0].capped);
  EXPECT_LE(backend.brackets()[0].upper_m - backend.brackets()[0].lower_m, backend.settings().epsilon_m);
  return error;
}

TEST(ClosedFormsExactly, RidgesOnRidges) {
  error_table table("O1: sine ridges on sine ridges, exact maximum (depths in mm)");
  std::size_t i = 0;
  for (const json& c : cases("O1_sine_ridges_translation")) {
    if (i++ % 9 != 0) continue;
    const double a = c["a"], b = c["b"], lambda = c["lam"], K = 2.0 * std::numbers::pi / lambda;
    const auto ridges = [K](double amplitude) { return [=](double x, double) { return amplitude * std::cos(K * x); }; };
    const scene bodies{make_plate(plate_mm(3.2 * lambda, 512, ridges(a))),
                       {make_plate(plate_mm(2.2 * lambda, 512, ridges(b)))}};
    exact_depth backend(bodies);
    const pose T_wa{face_down(), mm * vec3(double(c["s"]), 0.0, -double(c["d"]))};
    table.add("depth", error_mm(backend, bodies, window_downwards(2.0 * lambda * mm), T_wa, c["delta"]),
              chord(a, K, 6.4 * lambda / 512) + chord(b, K, 4.4 * lambda / 512) + rounding);
  }
}

TEST(ClosedFormsExactly, EggCrates) {
  error_table table("O2: egg crate on egg crate, exact maximum (depths in mm)");
  for (const json& c : cases("O2_eggcrate")) {
    const double a = c["a"], b = c["b"], lambda = c["lam"], K = 2.0 * std::numbers::pi / lambda;
    const auto crate = [K](double amplitude) {
      return [=](double x, double y) { return amplitude * (std::cos(K * x) + std::cos(K * y)); };
    };
    const scene bodies{make_plate(plate_mm(3.2 * lambda, 512, crate(a))),
                       {make_plate(plate_mm(2.2 * lambda, 512, crate(b)))}};
    exact_depth backend(bodies);
    const pose T_wa{face_down(), mm * vec3(double(c["sx"]), double(c["sy"]), -double(c["d"]))};
    table.add("depth", error_mm(backend, bodies, window_downwards(2.0 * lambda * mm), T_wa, c["delta"]),
              2.0 * (chord(a, K, 6.4 * lambda / 512) + chord(b, K, 4.4 * lambda / 512)) + rounding);
  }
}

TEST(ClosedFormsExactly, EllipsoidOnPlane) {
  error_table table("O7: ellipsoid on a plane, exact maximum (depths in mm)");
  std::size_t i = 0;
  for (const json& c : cases("O7_ellipsoid_plane")) {
    if (i++ % 2 != 0) continue;
    const ellipsoid_on_plane e = make_ellipsoid_on_plane(c, 1.1, 512);
    const contact_window window = window_downwards(1.0 * mm, mm * vec3(e.lowest.x, e.lowest.y, 0.0));
    exact_depth backend(e.bodies);
    // The sharpest curvature is that of the ellipsoid's smallest section, along both of the texture's directions.
    const double smallest = std::min({e.axes.x, e.axes.y, e.axes.z}),
                 largest = std::max({e.axes.x, e.axes.y, e.axes.z});
    const double curvature = largest / (smallest * smallest), texel = 2.2 / 512;
    table.add("depth", error_mm(backend, e.bodies, window, e.T_wa, c["delta"]),
              0.25 * curvature * texel * texel + rounding);
    const vec6 expected = gradient_of(vector_of(c["F"]), vector_of(c["T"]), 1.0, c["delta"]);
    // One side's slope at a crest of the interpolation, at the lever arm of the centre of mass.
    table.add("gradient", gradient_error(measure_whole(backend, e.bodies, window, e.T_wa).gradient, expected),
              2.0 * curvature * texel);
  }
}

TEST(ClosedFormsExactly, TiltedPlate) {
  error_table table("O6: flat plate tilted on a plane, exact maximum: at its edge (depths in mm)");
  for (const json& c : cases("O6_tilted_plate")) {
    const double half = c["half_width"], theta = c["theta"];
    plate_spec probe = plate_mm(half, 64, {});
    probe.centre_of_mass = vec3(0.0);
    const scene bodies{make_plate(probe), {make_plate(plate_mm(2.0 * half, 64, {}))}};
    exact_depth backend(bodies);
    for (const double way : {1.0, -1.0}) {
      const pose T_wa{exp_rotation(vec3(way * theta, 0.0, 0.0)) * face_down(), mm * vec3(0.0, 0.0, -double(c["d0"]))};
      table.add("depth", error_mm(backend, bodies, window_downwards(1.02 * half * mm), T_wa, c["delta"]), rounding);
    }
  }
}

TEST(ClosedFormsExactly, BumpPlatesWithBothLookups) {
  error_table table("R1: bump plates in six degrees of freedom, exact maximum (depths in mm)");
  const auto bumps = [](std::vector<std::array<double, 4>> list) {
    return [=](double x, double y) {
      double z = 0.0;
      for (const auto& [a, bx, by, s] : list) {
        z += a * std::exp(-((x - bx) * (x - bx) + (y - by) * (y - by)) / (2 * s * s));
      }
      return z;
    };
  };
  plate_spec probe = plate_mm(10.0, 1024, bumps({{1.0, -2, 1, 1.5}, {0.8, 3, -2, 2}}));
  probe.centre_of_mass = mm * vec3(12.0, 5.0, -30.0);
  const plate_spec fixed = plate_mm(12.0, 1024, bumps({{1.2, .5, .2, 1.8}, {.6, -4, 3, 1.2}, {.9, 4, -3, 1.5}}));
  const scene bodies{make_plate(probe), {make_plate(fixed)}};
  exact_depth exact(bodies), paper(bodies, {.parallax = parallax_mode::paper_lookup});
  // Curvature of a bump: a / sigma^2 at its top, in both directions.
  const double limit =
      0.25 * (1.0 / (1.5 * 1.5) * std::pow(20.0 / 1024, 2) + 0.6 / (1.2 * 1.2) * std::pow(24.0 / 1024, 2));
  for (const json& c : cases("R1_bump_plates_6dof")) {
    const contact_window window = window_downwards(9.0 * mm, mm * vec3(0.0, 0.0, 0.5 * vector_of(c["p"]).z));
    const pose T_wa{exp_rotation(vector_of(c["rotvec_then_RX"])) * face_down(), mm * vector_of(c["p"])};
    table.add("depth, exact parallax", error_mm(exact, bodies, window, T_wa, c["delta_exact"]), limit + rounding);
    table.add("depth, paper's lookup", error_mm(paper, bodies, window, T_wa, c["delta_paper_lookup"]),
              limit + rounding);
    const vec6 expected = gradient_of(vector_of(c["F"]), vector_of(c["T_about_cA"]), 1.0, c["delta_exact"]);
    table.add("gradient, exact parallax", gradient_error(measure_whole(exact, bodies, window, T_wa).gradient, expected),
              2e-2);
  }
}

}  // namespace
}  // namespace asperity::oracle
