// The closed forms as depths alone, for backends that sample a grid: a scene, a window, a pose and what has to come
// out.
#pragma once

#include <map>
#include <numbers>
#include <tuple>

#include "law/oracle/closed_forms.hpp"
#include "law/oracle/ellipsoid_on_plane.hpp"

namespace asperity::oracle {

/// Samples per side of the windows, and texels per side of the plates.
inline constexpr std::uint32_t case_grid = 64, case_texels = 256;

/// One case. Lengths in millimetres, as in the data.
struct depth_case {
  const char* form;  ///< name of its closed form
  scene bodies;
  contact_window window;
  pose T_wa;
  double depth_mm = 0.0, paper_depth_mm = 0.0;  ///< with the exact and with the paper's lookup
  double limit_mm = 0.0;  ///< what the grid misses of the maximum, and the texture's interpolation
};

/// What samples `pitch` apart and texels `texel` apart miss of a maximum: half of either aside, along two directions in
/// which the difference of the two surfaces bends by no more than so much.
[[nodiscard]] inline double missed_mm(double bend_x, double bend_y, double pitch, double texel) {
  return 0.125 * (bend_x + bend_y) * (pitch * pitch + texel * texel);
}

class depth_cases {
 public:
  depth_cases() {
    ridges();
    crates();
    discs();
    balls_on_sines();
    balls();
    tilted_plates();
    ellipsoids();
    bumps();
    bump_plates();
  }
  [[nodiscard]] const std::vector<depth_case>& all() const noexcept { return all_; }

 private:
  static constexpr double pi = std::numbers::pi;

  void add(depth_case c) {
    // Texels are single precision, some centimetres from the origin of their body at most.
    c.limit_mm += 4e-6;
    all_.push_back(std::move(c));
  }
  [[nodiscard]] static model_ptr plate(double half_mm, test_support::height_function heights_mm) {
    return test_support::make_plate(plate_mm(half_mm, case_texels, std::move(heights_mm)));
  }
  [[nodiscard]] static pose above(double x, double y, double depth) {
    return {test_support::face_down(), mm * vec3(x, y, -depth)};
  }
  [[nodiscard]] static double pitch_of(double half_mm) { return 2.0 * half_mm / case_grid; }
  [[nodiscard]] static double texel_of(double half_mm) { return 2.0 * half_mm / case_texels; }

  void ridges() {
    std::map<std::tuple<double, double, double>, scene> made;
    for (const json& c : cases("O1_sine_ridges_translation")) {
      const double a = c["a"], b = c["b"], lambda = c["lam"], K = 2.0 * pi / lambda;
      scene& s = made[{a, b, lambda}];
      if (s.probe == nullptr) {
        s = {plate(3.2 * lambda, [=](double x, double) { return a * std::cos(K * x); }),
             {plate(2.2 * lambda, [=](double x, double) { return b * std::cos(K * x); })}};
      }
      add({"O1", s, test_support::window_downwards(2.0 * lambda * mm), above(c["s"], 0.0, c["d"]), c["delta"],
           c["delta"], missed_mm((a + b) * K * K, 0.0, pitch_of(2.0 * lambda), texel_of(3.2 * lambda))});
    }
  }
  void crates() {
    for (const json& c : cases("O2_eggcrate")) {
      const double a = c["a"], b = c["b"], lambda = c["lam"], K = 2.0 * pi / lambda;
      const auto crate = [K](double amplitude) {
        return [=](double x, double y) { return amplitude * (std::cos(K * x) + std::cos(K * y)); };
      };
      const double bend = (a + b) * K * K;
      add({"O2",
           {plate(3.2 * lambda, crate(a)), {plate(2.2 * lambda, crate(b))}},
           test_support::window_downwards(2.0 * lambda * mm),
           above(c["sx"], c["sy"], c["d"]),
           c["delta"],
           c["delta"],
           missed_mm(bend, bend, pitch_of(2.0 * lambda), texel_of(3.2 * lambda))});
    }
  }
  void discs() {
    std::map<std::tuple<double, double, double>, scene> made;
    for (const json& c : cases("O3_striped_disc_rotation")) {
      const double a = c["a"], lambda = c["lam"], w = c["w"], theta = c["theta"], K = 2.0 * pi / lambda;
      scene& s = made[{a, lambda, w}];
      if (s.probe == nullptr) {
        test_support::plate_spec disc =
            plate_mm(w, case_texels, [=](double x, double) { return -a * std::cos(K * x); });
        disc.disc = true;
        s = {test_support::make_plate(disc), {plate(1.1 * w, [=](double x, double) { return a * std::cos(K * x); })}};
      }
      pose T_wa = above(0.0, 0.0, c["d"]);
      T_wa.rotation = exp_rotation(vec3(0.0, 0.0, theta)) * T_wa.rotation;
      // The deepest spot lies on the rim, which the samples reach to within a pitch.
      const double pitch = pitch_of(1.02 * w);
      add({"O3", s, test_support::window_downwards(1.02 * w * mm), T_wa, c["delta"], c["delta"],
           missed_mm(2.0 * a * K * K, 0.0, pitch, texel_of(1.1 * w)) + a * K * theta * pitch});
    }
  }
  void balls_on_sines() {
    for (std::size_t i = 0; const json& c : cases("O4_sphere_on_sine")) {
      if (i++ % 3 != 0) continue;  // each has bodies of its own
      const double a = c["a"], lambda = c["lam"], R = c["R"], s = c["s"], K = 2.0 * pi / lambda;
      const double half = std::min(0.65 * R, lambda), depth = 0.1;
      const scene bodies{plate(half, [=](double x, double y) { return std::sqrt(R * R - x * x - y * y) - R; }),
                         {plate(2.2 * lambda, [=](double x, double) { return a * std::cos(K * x); })}};
      // 0.65 R from its axis, a ball's height bends by 1 / R over the third power of the cosine there.
      const double ball = 1.0 / (R * std::pow(1.0 - 0.65 * 0.65, 1.5));
      add({"O4",
           bodies,
           test_support::window_downwards(half * mm, mm * vec3(s, 0.0, 0.0)),
           {test_support::face_down(), mm * vec3(s, 0.0, double(c["offset_height"]) - depth - R)},
           depth,
           depth,
           missed_mm(a * K * K + ball, ball, pitch_of(half), texel_of(std::max(half, 2.2 * lambda)))});
    }
  }
  void balls() {
    for (const json& c : cases("O5_sphere_sphere")) {
      const double R1 = c["R1"], R2 = c["R2"];
      const vec3 c1 = vector_of(c["c1"]), c2 = vector_of(c["c2"]), apex(c1.x, c1.y, c1.z - R1);
      const auto cap = [](double R) {
        return [=](double x, double y) { return std::sqrt(std::max(0.0, R * R - x * x - y * y)) - R; };
      };
      const vec3 touch = c2 + R2 / (R1 + R2) * (c1 - c2);
      test_support::plate_spec fixed = plate_mm(std::min(0.68 * R2, 4.0), case_texels, cap(R2));
      fixed.T_body_plate.position = mm * (c2 + vec3(0.0, 0.0, R2));
      const double half = 0.5 * std::min(R1, R2), slope = glm::length(vec2(c1 - c2)) / (R1 + R2);
      const double bend = (1.0 / R1 + 1.0 / R2) / std::pow(1.0 - slope * slope, 1.5);
      add({"O5",
           {plate(0.68 * R1, cap(R1)), {test_support::make_plate(fixed)}},
           test_support::window_downwards(half * mm, mm * vec3(touch.x, touch.y, touch.z)),
           {test_support::face_down(), mm * apex},
           c["delta"],
           c["delta"],
           missed_mm(bend, bend, pitch_of(half), texel_of(4.0))});
    }
  }
  void tilted_plates() {
    for (const json& c : cases("O6_tilted_plate")) {
      const double half = c["half_width"], theta = c["theta"];
      const scene bodies{plate(half, {}), {plate(2.0 * half, {})}};
      for (const double way : {1.0, -1.0}) {
        pose T_wa = above(0.0, 0.0, c["d0"]);
        T_wa.rotation = exp_rotation(vec3(way * theta, 0.0, 0.0)) * T_wa.rotation;
        // Deepest at the plate's edge, which the samples reach to within a pitch.
        add({"O6", bodies, test_support::window_downwards(1.02 * half * mm), T_wa, c["delta"], c["delta"],
             pitch_of(1.02 * half) * std::tan(theta)});
      }
    }
  }
  void ellipsoids() {
    for (const json& c : cases("O7_ellipsoid_plane")) {
      const ellipsoid_on_plane e = make_ellipsoid_on_plane(c, 1.1, case_texels);
      const vec3& r = e.axes;
      const double smallest = std::min({r.x, r.y, r.z}), bend = std::max({r.x, r.y, r.z}) / (smallest * smallest);
      add({"O7", e.bodies, test_support::window_downwards(mm, mm * vec3(e.lowest.x, e.lowest.y, 0.0)), e.T_wa,
           c["delta"], c["delta"], missed_mm(bend, bend, pitch_of(1.0), texel_of(1.1))});
    }
  }
  void bumps() {
    for (const json& c : cases("O8_equal_gauss_bumps")) {
      const double a = c["a"], sigma = c["sigma"], bend = 2.0 * a / (sigma * sigma);
      const auto bump = [=](double x, double y) { return a * std::exp(-(x * x + y * y) / (2.0 * sigma * sigma)); };
      add({"O8",
           {plate(8.0, bump), {plate(6.0, bump)}},
           test_support::window_downwards(5.0 * mm),
           above(c["s"], 0.0, c["d"]),
           c["delta"],
           c["delta"],
           missed_mm(bend, bend, pitch_of(5.0), texel_of(8.0))});
    }
    for (const json& c : cases("O9_parabolic_bumps")) {
      const double R1 = c["R1"], R2 = c["R2"], bend = 1.0 / R1 + 1.0 / R2;
      const auto bump = [](double R) { return [=](double x, double y) { return -(x * x + y * y) / (2.0 * R); }; };
      add({"O9",
           {plate(3.5, bump(R1)), {plate(2.5, bump(R2))}},
           test_support::window_downwards(2.0 * mm),
           above(c["sx"], c["sy"], c["d"]),
           c["delta"],
           c["delta"],
           missed_mm(bend, bend, pitch_of(2.0), texel_of(3.5))});
    }
  }
  void bump_plates() {
    using list = std::vector<std::array<double, 4>>;
    const list on_probe{{1.0, -2, 1, 1.5}, {0.8, 3, -2, 2}},
        on_fixed{{1.2, .5, .2, 1.8}, {.6, -4, 3, 1.2}, {.9, 4, -3, 1.5}};
    const auto heights = [](const list& all) {
      return [=](double x, double y) {
        double z = 0.0;
        for (const auto& [a, bx, by, s] : all) {
          z += a * std::exp(-((x - bx) * (x - bx) + (y - by) * (y - by)) / (2 * s * s));
        }
        return z;
      };
    };
    const auto bend_of = [](const list& all) {
      double bend = 0.0;  // of all bumps of a plate as if they stood on each other
      for (const auto& b : all) bend += b[0] / (b[3] * b[3]);
      return bend;
    };
    const scene bodies{plate(10.0, heights(on_probe)), {plate(12.0, heights(on_fixed))}};
    const double bend = bend_of(on_probe) + bend_of(on_fixed);
    for (const json& c : cases("R1_bump_plates_6dof")) {
      const vec3 p = vector_of(c["p"]);
      add({"R1",
           bodies,
           test_support::window_downwards(9.0 * mm, mm * vec3(0.0, 0.0, 0.5 * p.z)),
           {exp_rotation(vector_of(c["rotvec_then_RX"])) * test_support::face_down(), mm * p},
           c["delta_exact"],
           c["delta_paper_lookup"],
           missed_mm(bend, bend, pitch_of(9.0), texel_of(12.0))});
    }
  }

  std::vector<depth_case> all_;
};

}  // namespace asperity::oracle
