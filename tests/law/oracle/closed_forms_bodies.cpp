// Smooth bodies with a long lever arm to the centre of mass: balls, an ellipsoid, bumps, a tilted plate.
#include <numbers>

#include "law/oracle/closed_forms.hpp"
#include "law/oracle/ellipsoid_on_plane.hpp"

namespace asperity::oracle {
namespace {

using namespace test_support;

/// Limits of A2: error of the gradient by central differences of 0.1 mm about the contact, by grid size.
struct grid_limit {
  std::uint32_t samples;
  double limit;
};
constexpr grid_limit by_grid[] = {{50, 4e-2}, {64, 2.5e-2}, {100, 1e-2}, {200, 3e-3}};

/// A2 for one pose: both schemes at all grid sizes, the refined maximum, and the choice of the point of rotation.
void check_gradient(error_table& table, const scene& bodies, const contact_window& window, const pose& T_wa,
                    const vec6& expected) {
  for (const auto& [n, limit] : by_grid) {
    cpu_depth differences(bodies, settings_for(gradient_scheme::central_difference, n, 0.01, 0.1));
    // The step alone, with the maximum found exactly, costs up to 3.7e-3 on R1: the limit is on the median.
    table.add_typical("gradient, central difference 0.1 mm, N = " + std::to_string(n),
                      gradient_error(measure_whole(differences, bodies, window, T_wa).gradient, expected), limit);
    cpu_depth soft(bodies, settings_for(gradient_scheme::soft_max, n, 0.01, 0.0));
    table.add("gradient, soft maximum tau 0.01 mm, N = " + std::to_string(n),
              gradient_error(measure_whole(soft, bodies, window, T_wa).gradient, expected), 2e-2);
  }
  window_depth_settings sharp = settings_for(gradient_scheme::central_difference, 200, 0.01, 0.02);
  sharp.refine_maximum = true;
  cpu_depth about_contact(bodies, sharp);
  sharp.origin = rotation_origin::centre_of_mass;
  cpu_depth about_centre(bodies, sharp);
  const vec6 g = measure_whole(about_contact, bodies, window, T_wa).gradient;
  table.add("gradient, refined maximum, 0.02 mm, N = 200", gradient_error(g, expected), 5e-4);
  const double size = gradient_error(g, {});
  table.add("rotation about c_A instead of the contact, share of g",
            gradient_error(measure_whole(about_centre, bodies, window, T_wa).gradient, g) / size, 1e-2);
}

TEST(ClosedForms, BallOnBall) {
  error_table table("O5: ball on ball (depths in mm)");
  for (const json& c : cases("O5_sphere_sphere")) {
    const double R1 = c["R1"], R2 = c["R2"], delta = c["delta"];
    const vec3 c1 = vector_of(c["c1"]), c2 = vector_of(c["c2"]), centre = vector_of(c["c_A"]);
    const auto cap = [](double R) {
      return [=](double x, double y) { return std::sqrt(std::max(0.0, R * R - x * x - y * y)) - R; };
    };
    const vec3 touch = c2 + R2 / (R1 + R2) * (c1 - c2);
    const vec3 apex(c1.x, c1.y, c1.z - R1);
    plate_spec probe = plate_mm(0.68 * R1, 2048, cap(R1));
    const quat up = face_down();
    probe.centre_of_mass = glm::conjugate(up) * (mm * (centre - apex));
    plate_spec fixed = plate_mm(std::min(0.68 * R2, 4.0), 2048, cap(R2));
    // A window of its own size over the contact; it stays inside both caps.
    const contact_window window = window_downwards(0.5 * std::min(R1, R2) * mm, mm * vec3(touch.x, touch.y, touch.z));
    fixed.T_body_plate.position = mm * (c2 + vec3(0.0, 0.0, R2));
    const scene bodies{make_plate(probe), {make_plate(fixed)}};
    const pose T_wa{up, mm * apex};
    const vec6 expected = gradient_of(vector_of(c["F"]), vector_of(c["T"]), c["k"], delta);
    cpu_depth fine(bodies, settings_for(gradient_scheme::soft_max, 400, 0.01, 0.0));
    table.add("depth, N = 400", std::fabs(measure_whole(fine, bodies, window, T_wa).depth_m / mm - delta), 1e-3);
    check_gradient(table, bodies, window, T_wa, expected);
  }
}

TEST(ClosedForms, EllipsoidOnPlane) {
  error_table table("O7: ellipsoid on a plane (depths in mm)");
  for (const json& c : cases("O7_ellipsoid_plane")) {
    const ellipsoid_on_plane e = make_ellipsoid_on_plane(c, 2.2, 2048);
    const double delta = c["delta"];
    const contact_window window = window_downwards(2.0 * mm, mm * vec3(e.lowest.x, e.lowest.y, 0.0));
    cpu_depth fine(e.bodies, settings_for(gradient_scheme::soft_max, 400, 0.01, 0.0));
    table.add("depth, N = 400", std::fabs(measure_whole(fine, e.bodies, window, e.T_wa).depth_m / mm - delta), 1e-3);
    check_gradient(table, e.bodies, window, e.T_wa, gradient_of(vector_of(c["F"]), vector_of(c["T"]), 1.0, delta));
  }
}

TEST(ClosedForms, GaussianAndParabolicBumps) {
  error_table table("O8, O9: bump on bump (depths in mm)");
  const auto check = [&](const std::string& name, const scene& bodies, double half_window, const vec3& position,
                         double delta, const vec3& gradient) {
    const pose T_wa{face_down(), mm * position};
    for (const std::uint32_t n : {50U, 400U}) {
      cpu_depth backend(bodies, settings_for(gradient_scheme::soft_max, n, 0.002, 0.0));
      const penetration p = measure_whole(backend, bodies, window_downwards(half_window * mm), T_wa);
      const double pitch = 2.0 * half_window / n;
      // The parabola of the deepest spot over half a pitch both ways: curvature at most 2 a / sigma^2 = 0.8 per mm.
      table.add(name + " depth, N = " + std::to_string(n), std::fabs(p.depth_m / mm - delta),
                n == 400 ? 1e-3 : 0.25 * 0.8 * pitch * pitch);
      if (n == 400) {
        table.add(name + " gradient, soft maximum",
                  std::sqrt(glm::dot(p.gradient.linear - gradient, p.gradient.linear - gradient)), 1e-2);
      }
    }
  };
  kept_scenes made;
  for (const json& c : cases("O8_equal_gauss_bumps")) {
    const double a = c["a"], sigma = c["sigma"];
    const auto bump = [=](double x, double y) { return a * std::exp(-(x * x + y * y) / (2.0 * sigma * sigma)); };
    const scene& bodies = made.of({a, sigma, 0.0}, [&] {
      return scene{make_plate(plate_mm(8.0, 1024, bump)), {make_plate(plate_mm(6.0, 1024, bump))}};
    });
    check("Gaussian", bodies, 5.0, {c["s"], 0.0, -double(c["d"])}, c["delta"], {c["ddelta_ds"], 0.0, -1.0});
  }
  for (const json& c : cases("O9_parabolic_bumps")) {
    const double R1 = c["R1"], R2 = c["R2"];
    const auto bump = [](double R) { return [=](double x, double y) { return -(x * x + y * y) / (2.0 * R); }; };
    const scene bodies{make_plate(plate_mm(3.5, 1024, bump(R1))), {make_plate(plate_mm(2.5, 1024, bump(R2)))}};
    const double delta = c["delta"];
    check("parabolic", bodies, 2.0, {c["sx"], c["sy"], -double(c["d"])}, delta,
          {-double(c["Fx"]) / delta, -double(c["Fy"]) / delta, -1.0});
  }
}

TEST(ClosedForms, TiltedPlate) {
  error_table table("O6 (A4): flat plate tilted on a plane (torques in N mm at k = 1 N/mm)");
  for (const json& c : cases("O6_tilted_plate")) {
    const double half = c["half_width"], d0 = c["d0"], theta = c["theta"], turn = c["Dtheta"];
    plate_spec probe = plate_mm(half, 64, {});
    probe.centre_of_mass = vec3(0.0);  // the pivot is the middle of the face
    const scene bodies{make_plate(probe), {make_plate(plate_mm(2.0 * half, 64, {}))}};
    const contact_window window = window_downwards(1.02 * half * mm);
    for (const double way : {1.0, -1.0}) {
      const pose T_wa{exp_rotation(vec3(way * theta, 0.0, 0.0)) * face_down(), mm * vec3(0.0, 0.0, -d0)};
      window_depth_settings settings = settings_for(gradient_scheme::central_difference, 400, 0.01, turn * half);
      cpu_depth differences(bodies, settings);
      const penetration p = measure_whole(differences, bodies, window, T_wa);
      const double full = p.depth_m / mm * half;  // k delta a
      const double torque = -p.depth_m / mm * p.gradient.angular.x / mm;
      table.add("depth, N = 400", std::fabs(p.depth_m / mm - double(c["delta"])),
                2.04 * half / 400 * std::sin(theta) + 1e-6);
      table.add(theta == 0.0 ? "torque at rest, share of k delta a" : "torque, share of k delta a",
                std::fabs(torque - way * double(c["T_central"])) / full, theta == 0.0 ? 1e-9 : 2e-2);
      if (theta == 0.0) {
        cpu_depth soft(bodies, settings_for(gradient_scheme::soft_max, 64, 0.01, 0.0));
        const penetration q = measure_whole(soft, bodies, window, T_wa);
        table.add("torque at rest, soft maximum, share of k delta a",
                  std::sqrt(glm::dot(q.gradient.angular, q.gradient.angular)) / (half * mm), 1e-9);
      }
    }
  }
}

test_support::height_function bumps(std::vector<std::array<double, 4>> list) {
  return [=](double x, double y) {
    double z = 0.0;
    for (const auto& [a, bx, by, s] : list)
      z += a * std::exp(-((x - bx) * (x - bx) + (y - by) * (y - by)) / (2 * s * s));
    return z;
  };
}

TEST(ClosedForms, BumpPlatesInSixDegreesOfFreedom) {
  error_table table("R1: bump plates, twelve poses in six degrees of freedom (depths in mm)");
  plate_spec probe = plate_mm(10.0, 2048, bumps({{1.0, -2, 1, 1.5}, {0.8, 3, -2, 2}}));
  probe.centre_of_mass = mm * vec3(12.0, 5.0, -30.0);
  const plate_spec fixed = plate_mm(12.0, 2048, bumps({{1.2, .5, .2, 1.8}, {.6, -4, 3, 1.2}, {.9, 4, -3, 1.5}}));
  const scene bodies{make_plate(probe), {make_plate(fixed)}};
  for (const json& c : cases("R1_bump_plates_6dof")) {
    const double delta = c["delta_exact"];
    // Midway between the coarse faces, as a finder places it: rotations are about this point.
    const contact_window window = window_downwards(9.0 * mm, mm * vec3(0.0, 0.0, 0.5 * vector_of(c["p"]).z));
    const pose T_wa{exp_rotation(vector_of(c["rotvec_then_RX"])) * face_down(), mm * vector_of(c["p"])};
    ASSERT_LT(glm::length(centre_of_mass_w(bodies, T_wa) - mm * vector_of(c["c_A"])), 1e-9);
    window_depth_settings settings = settings_for(gradient_scheme::soft_max, 400, 0.01, 0.0);
    cpu_depth exact(bodies, settings);
    table.add("depth, exact, N = 400", std::fabs(measure_whole(exact, bodies, window, T_wa).depth_m / mm - delta),
              1e-3);
    settings.parallax = parallax_mode::paper_lookup;
    cpu_depth paper(bodies, settings);
    table.add("depth, paper lookup, N = 400",
              std::fabs(measure_whole(paper, bodies, window, T_wa).depth_m / mm - double(c["delta_paper_lookup"])),
              1e-3);
    check_gradient(table, bodies, window, T_wa, gradient_of(vector_of(c["F"]), vector_of(c["T_about_cA"]), 1.0, delta));
  }
}

}  // namespace
}  // namespace asperity::oracle
