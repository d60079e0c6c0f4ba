// The benchmark models with their originals, and seeded poses at which two of them touch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "asperity/asperity.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"

namespace asperity::oracle {

inline const std::filesystem::path models_dir = ASPERITY_TEST_MODELS_DIR;
struct loaded_body {
  triangle_mesh full;
  model_ptr model;
};

inline loaded_body load(const std::string& name) {
  auto full = io::load_mesh(models_dir / (name + ".ply"));
  auto model = io::load_textured_model(models_dir / (name + ".glb"));
  if (!full || !model) {
    ADD_FAILURE() << (full ? model.error().message : full.error().message);
    return {};
  }
  return {std::move(full).value(), std::make_shared<const textured_model>(std::move(model).value())};
}

inline double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
}

inline vec3 random_direction(std::mt19937_64& rng) {
  const double z = uniform(rng, -1.0, 1.0);
  const double a = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}

inline quat random_rotation(std::mt19937_64& rng) {
  const double u = uniform(rng, 0.0, 1.0);
  const double a = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double b = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - u);
  const double s = std::sqrt(u);
  return {s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)};
}

// The bake reports how far its texels lie from the coarse surface, and how far they may be from the original.
inline double reach(const loaded_body& b) { return b.model->report.max_displacement_m + b.model->report.max_error_m; }

// Depth of the deepest contact; minus infinity where nothing touches.
inline double deepest(const tick& t) {
  double d = -std::numeric_limits<double>::infinity();
  for (const penetration& p : t.depths) {
    if (!has(p.flags, depth_flag::no_overlap)) d = std::max(d, p.depth_m);
  }
  return d;
}

// A seeded pose at which the probe, coming from outside along a random direction with a random orientation, overlaps by
// some tenths of a millimetre.
template <contact_renderer Renderer>
bool touching_pose(Renderer& r, std::mt19937_64& rng, pose& T_wa) {
  const textured_model& a = *r.scene().probe;
  const textured_model& b = *r.scene().fixed.front();
  const std::array<pose, 1> fixed{};
  const quat rotation = random_rotation(rng);
  const vec3 from = random_direction(rng);
  const vec3 centre_b = 0.5 * (b.box.low + b.box.high);
  const vec3 aside = glm::cross(from, random_direction(rng));
  const vec3 target = centre_b + 0.3 * uniform(rng, 0.0, 1.0) * b.box.diagonal() * aside;
  const vec3 centre_a = 0.5 * (a.box.low + a.box.high);
  const double wanted = uniform(rng, 0.0, 0.0004);
  const auto at = [&](double distance) { return pose{rotation, target + distance * from - rotation * centre_a}; };

  tick t;
  double outside = 0.5 * (a.box.diagonal() + b.box.diagonal()) + 0.4 * b.box.diagonal();
  const double step = 0.02 * std::min(a.box.diagonal(), b.box.diagonal());
  double inside = outside;
  do {  // march in until the first overlap, so that a thin part is not jumped over
    outside = inside;
    inside -= step;
    if (inside < -outside || r.step({at(inside), fixed}, t) != status::ok) return false;
  } while (!(deepest(t) > wanted));
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (inside + outside);
    if (r.step({at(middle), fixed}, t) != status::ok) return false;
    (deepest(t) > wanted ? inside : outside) = middle;
  }
  T_wa = at(inside);
  return r.step({T_wa, fixed}, t) == status::ok && deepest(t) > 0.0;
}

inline double percentile(std::vector<double> v, double p) {
  if (v.empty()) return 0.0;
  std::sort(v.begin(), v.end());
  return v[std::min(v.size() - 1, static_cast<std::size_t>(p * static_cast<double>(v.size())))];
}

}  // namespace asperity::oracle
