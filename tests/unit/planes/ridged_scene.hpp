// A ridged box for a probe, a larger one and a small flat one to touch, and poses at which they do.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "asperity/planes/plane_renderer.hpp"
#include "support/small_models.hpp"
#include "unit/planes/scene_with_fields.hpp"

namespace asperity::test_support {

inline const scene_with_fields& ridged() {
  static const scene_with_fields made = [] {
    const auto probe =
        std::make_shared<const textured_model>(make_textured_box({0.012, 0.01, 0.008}, 256, ridges(60e-6, 1.7e-3)));
    const auto fixed =
        std::make_shared<const textured_model>(make_textured_box({0.03, 0.03, 0.01}, 384, ridges(90e-6, 2.3e-3)));
    const auto small = std::make_shared<const textured_model>(make_flat_box({0.006, 0.009, 0.007}, 128));
    return with_fields({probe, {fixed, small}});
  }();
  return made;
}

inline plane_renderer make_ridged(unsigned threads = 1) {
  return make_plane_renderer(ridged().of, ridged().fields, {.threads = threads}).value();
}

struct draws {
  std::mt19937_64 bits;
  double unit() { return std::uniform_real_distribution<double>(-1.0, 1.0)(bits); }
  vec3 vector() { return {unit(), unit(), unit()}; }
  quat rotation() { return glm::normalize(quat(unit(), unit(), unit(), unit())); }
};

inline double deepest_m(const tick& t) {
  double out = -1.0;
  for (const support_plane& p : t.planes) out = std::max(out, p.depth_m);
  return out;
}

// A probe in any orientation that lies on the bodies with about this depth, between them or on one.
inline pose laid_down(draws& draw, plane_renderer& feel, const std::vector<pose>& T_wb, double depth_m) {
  pose T_wa{draw.rotation(), {0.02 * draw.unit(), 0.02 * draw.unit(), 0.03}};
  tick t;
  for (int i = 0; i < 100; ++i) {
    if (feel.step({T_wa, T_wb}, t) != status::ok) break;
    const double off_m = t.planes.empty() ? -1e-3 : deepest_m(t) - depth_m;
    if (std::fabs(off_m) < 1e-6) break;
    T_wa.position.z += std::clamp(off_m, -1e-3, 1e-3);
  }
  return T_wa;
}

}  // namespace asperity::test_support
