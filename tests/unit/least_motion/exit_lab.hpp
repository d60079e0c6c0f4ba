// Bodies by formula, and the law of least motion on them; compiled once, optimised.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "least_motion/exit_solver.hpp"

namespace asperity::test_support {

inline constexpr double mm = 1e-3;

/// A depth by formula: metres, positive inside.
using depth_function = std::function<double(const vec3& p_b)>;

/// A body whose field is sampled from a formula, without relief, and whose samples are these points.
[[nodiscard]] field_body_ptr make_formula_body(const std::vector<vec3>& samples, const vec3& low, const vec3& high,
                                               double pitch_m, const depth_function& depth);
/// One that has samples and no inside.
[[nodiscard]] field_body_ptr make_points_body(const std::vector<vec3>& samples);

/// Points spread evenly over a sphere about the origin.
[[nodiscard]] std::vector<vec3> sphere_points(double radius_m, std::size_t count);
/// Points of a grid on the six faces of a box about the origin; those of edges belong to two faces and come twice.
[[nodiscard]] std::vector<vec3> box_points(const vec3& half, std::size_t per_edge);

/// A box about the origin whose faces have waves of this height, its field made as for any model.
[[nodiscard]] field_body_ptr waved_box(const vec3& half, double height_m, double wave_m);

/// A block about the origin, 24 x 16 x 12 mm, with a groove along y: 8 mm wide, 3 mm deep, its bottom at z = 3 mm.
[[nodiscard]] field_body_ptr grooved_block();

/// What a solve told.
struct exit_answer {
  wrench on_probe_w{};
  mat6 stiffness{};
  double energy_j = 0.0, deepest_m = 0.0;
  exits::exit_limits_hit hit{};
  std::size_t readings = 0;
  struct way {
    vec3 z_w{0.0};
    double weight = 0.0;
  };
  std::vector<way> ways;  ///< those with weight
};

/// A probe and fixed bodies, all fixed ones at the origin unless told otherwise.
class exit_lab {
 public:
  exit_lab(field_body_ptr probe, std::vector<field_body_ptr> fixed, const exits::exit_rule& rule = {},
           const vec3& centre_of_mass_a = vec3(0.0));
  [[nodiscard]] exit_answer at(const pose& T_wa);
  [[nodiscard]] exit_answer at(const vec3& position_w) { return at({quat(1.0, 0.0, 0.0, 0.0), position_w}); }
  [[nodiscard]] const exits::exit_rule& rule() const { return rule_; }

  std::vector<pose> T_wb;

 private:
  exits::exit_rule rule_;
  exits::exit_solver solver_;
};

/// Numbers drawn evenly between two.
struct drawing {
  std::mt19937_64 bits;
  [[nodiscard]] double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(bits);
  }
  [[nodiscard]] vec3 vector() { return {between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0)}; }
  [[nodiscard]] quat rotation() {
    std::normal_distribution<double> n;
    return glm::normalize(quat(n(bits), n(bits), n(bits), n(bits)));
  }
};

}  // namespace asperity::test_support
