// Work over a closed loop in six degrees of freedom: a force that comes from a potential does none.
// Every check has its negative control: the same loop with a known mistake must fail by a wide margin.
#include <array>
#include <functional>
#include <numbers>

#include "law/oracle/closed_forms.hpp"

namespace asperity::oracle {
namespace {

using namespace test_support;
constexpr double pi = std::numbers::pi;

/// Sum of plane waves with fixed directions and phases: rough, smooth at the scale of a texel. Millimetres.
height_function rough(double amplitude, double phase) {
  struct wave {
    double height, K, along_x, along_y, phase;
  };
  std::array<wave, 12> waves;
  for (int i = 0; i < 12; ++i) {
    const double lambda = 1.2 + 0.35 * i, angle = 2.4 * i + phase;
    waves[static_cast<std::size_t>(i)] = {lambda / 5.0, 2.0 * pi / lambda, std::cos(angle), std::sin(angle),
                                          1.7 * i * phase};
  }
  return [=](double x, double y) {
    double z = 0.0;
    for (const wave& w : waves) z += w.height * std::cos(w.K * (w.along_x * x + w.along_y * y) + w.phase);
    return amplitude * z / std::sqrt(12.0);
  };
}

/// Asymmetric loop about a pose: a symmetric one does no work by symmetry and proves nothing.
struct loop {
  vec3 translation_mm;
  vec3 rotation;
  int steps;
};

using gradient_of_pose = std::function<std::pair<double, vec6>(const pose& T_wa, const vec3& centre_w)>;

/// Net work over the loop, as a share of the work that goes to and fro. @param base  pose in the middle of the loop
double relative_work(const loop& path, const pose& base, const vec3& centre_b, const gradient_of_pose& depth) {
  double net = 0.0, total = 0.0;
  vec3 last_centre(0.0);
  quat last_turn{};
  vec6 last_force;
  for (int i = 0; i <= path.steps; ++i) {
    const double t = 2.0 * pi * (i % path.steps) / path.steps;
    const vec3 x = mm * path.translation_mm * vec3(std::sin(t), std::sin(t + 1.57), std::sin(2.0 * t + 0.3));
    const vec3 r = path.rotation * vec3(std::sin(t + 0.9), std::sin(t + 2.0), std::sin(2.0 * t + 0.5));
    const vec3 centre = base * centre_b + x;
    const quat turn = exp_rotation(r) * base.rotation;
    const pose T_wa{turn, centre - turn * centre_b};
    const auto [d, g] = depth(T_wa, centre);
    const vec6 force = -std::max(d, 0.0) * g;
    EXPECT_GT(d, 0.0) << "the loop left the contact";
    if (i > 0) {
      const vec6 step{centre - last_centre, log_rotation(turn * glm::conjugate(last_turn))};
      const double work = 0.5 * dot(force + last_force, step);
      net += work;
      total += std::fabs(work);
    }
    last_centre = centre;
    last_turn = turn;
    last_force = force;
  }
  return std::fabs(net) / total;
}

struct energy_scene {
  scene bodies;
  contact_window window;
  pose base;
  loop path;

  [[nodiscard]] vec3 centre_b() const { return bodies.probe->mass.centre_of_mass; }
  [[nodiscard]] double work(const window_depth_settings& settings, int steps, bool without_transport = false) const {
    cpu_depth backend(bodies, settings);
    loop fine = path;
    fine.steps = steps;
    return relative_work(fine, base, centre_b(), [&](const pose& T_wa, const vec3& centre) {
      const penetration p = measure_whole(backend, bodies, window, T_wa);
      vec6 g = p.gradient;
      // Takes the lever arm from the contact to the centre of mass back out of the torque.
      if (without_transport) g.angular -= glm::cross(window.centre_w - centre, g.linear);
      return std::pair(p.soft_depth_m, g);
    });
  }
};

/// The probe covers the window: no silhouette in it.
energy_scene covered_window(height_function a, height_function b) {
  plate_spec probe = plate_mm(12.5, 2048, std::move(a));
  probe.cells_x = 3;
  probe.cells_y = 2;
  probe.centre_of_mass = mm * vec3(12.0, 5.0, -30.0);
  return {{make_plate(probe), {make_plate(plate_mm(12.5, 2048, std::move(b)))}},
          window_downwards(9.0 * mm),
          {exp_rotation(vec3(0.01, -0.015, 0.03)) * face_down(), mm * vec3(0.3, -0.2, 0.0)},
          {{1.0, 1.0, 0.05}, {0.01, 0.01, 0.05}, 600}};
}

/// The probe's face ends inside the window on all sides.
energy_scene silhouette_in_window(height_function a, height_function b) {
  plate_spec probe = plate_mm(6.0, 2048, std::move(a));
  probe.cells_x = 2;
  probe.cells_y = 3;
  probe.centre_of_mass = mm * vec3(12.0, 5.0, -30.0);
  return {{make_plate(probe), {make_plate(plate_mm(14.0, 2048, std::move(b)))}},
          window_downwards(9.0 * mm),
          {exp_rotation(vec3(0.002, -0.003, 0.2)) * face_down(), mm * vec3(0.3, -0.2, 0.0)},
          {{0.8, 0.7, 0.03}, {0.003, 0.004, 0.05}, 1200}};
}

/// Presses the probe in until the loop's shallowest pose is `margin_mm` deep.
void press(energy_scene& s, double margin_mm) {
  cpu_depth probe(s.bodies, settings_for(gradient_scheme::soft_max, 64, 0.02, 0.0));
  double shallowest = 1e9;
  loop coarse = s.path;
  coarse.steps = 40;
  s.base.position.z -= 10.0 * mm;
  static_cast<void>(relative_work(coarse, s.base, s.centre_b(), [&](const pose& T_wa, const vec3&) {
    const double d = measure_whole(probe, s.bodies, s.window, T_wa).soft_depth_m;
    shallowest = std::min(shallowest, d);
    return std::pair(d, vec6{});
  }));
  s.base.position.z += shallowest - margin_mm * mm;
}

height_function bumps_a() {
  return [](double x, double y) {
    return std::exp(-((x + 2) * (x + 2) + (y - 1) * (y - 1)) / 4.5) +
           0.8 * std::exp(-((x - 3) * (x - 3) + (y + 2) * (y + 2)) / 8);
  };
}
height_function bumps_b() {
  return [](double x, double y) {
    return 1.2 * std::exp(-((x - .5) * (x - .5) + (y - .2) * (y - .2)) / 6.48) +
           .6 * std::exp(-((x + 4) * (x + 4) + (y - 3) * (y - 3)) / 2.88) +
           .9 * std::exp(-((x - 4) * (x - 4) + (y + 3) * (y + 3)) / 4.5);
  };
}

// A texture is bilinear, so the force has a small kink wherever a sample crosses a texel border. The work of a
// trapezoid over such a step is off by the kink times the step: it takes many small steps to see that the sum is zero.
// A coarse grid is as conservative as a fine one and pays for them.
constexpr std::uint32_t soft_grid = 32;
constexpr int soft_steps = 4800;
// Central differences of 0.1 mm ask for samples at most 0.2 mm apart (science, section 3.2).
constexpr std::uint32_t difference_grid = 96;
constexpr int difference_steps = 150;
constexpr int control_steps = 60;

TEST(Energy, LoopWithoutSilhouette) {
  error_table table("A3: work over a closed loop, share of the work to and fro; window inside the patch");
  for (const bool smooth : {true, false}) {
    energy_scene s = smooth ? covered_window(bumps_a(), bumps_b()) : covered_window(rough(0.05, 0.3), rough(0.05, 1.1));
    press(s, 0.15);
    const std::string kind = smooth ? ", smooth bumps" : ", rough";
    window_depth_settings soft = settings_for(gradient_scheme::soft_max, soft_grid, 0.05, 0.1);
    table.add("soft maximum" + kind, s.work(soft, soft_steps), 1e-5);
    EXPECT_GT(s.work(soft, control_steps, true), 0.1) << "without the transport term, soft maximum" << kind;

    // Differences over a finite step are no gradient of any potential. Where many rough peaks compete and the probe
    // turns, that shows; the limit of the acceptance list holds for smooth bodies, and for rough ones that only slide.
    const window_depth_settings differences =
        settings_for(gradient_scheme::central_difference, difference_grid, 0.05, 0.1);
    table.add("central difference 0.1 mm" + kind, s.work(differences, difference_steps), smooth ? 5e-3 : 5e-2);
    EXPECT_GT(s.work(differences, control_steps, true), 0.1)
        << "without the transport term, central difference" << kind;
    if (smooth) continue;

    soft.parallax = parallax_mode::paper_lookup;
    table.add("soft maximum, paper lookup" + kind, s.work(soft, soft_steps), 1e-5);
    s.path.rotation = vec3(0.0);
    table.add("central difference 0.1 mm" + kind + ", no rotation", s.work(differences, difference_steps), 5e-3);
  }
}

TEST(Energy, LoopWithTheProbesSilhouetteInTheWindow) {
  error_table table("A3: work over a closed loop, share of the work to and fro; silhouette in the window");
  energy_scene s = silhouette_in_window(rough(0.05, 0.3), rough(0.05, 1.1));
  press(s, 0.15);
  window_depth_settings soft = settings_for(gradient_scheme::soft_max, soft_grid, 0.02, 0.1);
  soft.taper_m = 1.0 * mm;
  table.add("soft maximum, tapered", s.work(soft, soft_steps), 1e-5);

  window_depth_settings lame = soft;
  lame.taper_gradient = false;
  const double without_gradient = s.work(lame, 1200);
  EXPECT_GT(without_gradient, 1e-4) << "without the gradient of the taper";
  lame.taper_silhouettes = false;
  const double without_taper = s.work(lame, 1200);
  EXPECT_GT(without_taper, 1e-4) << "without the taper";
  std::printf("  without the gradient of the taper %.2g, without the taper %.2g\n", without_gradient, without_taper);
}

}  // namespace
}  // namespace asperity::oracle
