// The whole chain against the full-resolution meshes: models baked by the command, contacts found by the library, and
// its depth compared with the brute-force depth of the two originals in the same window.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "asperity/asperity.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "oracle/brute_force.hpp"

namespace {

using namespace asperity;

const std::filesystem::path models_dir = ASPERITY_TEST_MODELS_DIR;
constexpr int poses_per_pair = 70;
constexpr int grid = 64;
constexpr int refinement = 5;

struct loaded_body {
  triangle_mesh full;
  model_ptr model;
};

loaded_body load(const std::string& name) {
  auto full = io::load_mesh(models_dir / (name + ".ply"));
  auto model = io::load_textured_model(models_dir / (name + ".glb"));
  if (!full || !model) {
    ADD_FAILURE() << (full ? model.error().message : full.error().message);
    return {};
  }
  return {std::move(full).value(), std::make_shared<const textured_model>(std::move(model).value())};
}

double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
}

vec3 random_direction(std::mt19937_64& rng) {
  const double z = uniform(rng, -1.0, 1.0);
  const double a = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}

quat random_rotation(std::mt19937_64& rng) {
  const double u = uniform(rng, 0.0, 1.0);
  const double a = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double b = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - u);
  const double s = std::sqrt(u);
  return {s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)};
}

// The bake reports how far its texels lie from the coarse surface, and how far they may be from the original.
double reach(const loaded_body& b) { return b.model->report.max_displacement_m + b.model->report.max_error_m; }

// Depth of the deepest contact; minus infinity where nothing touches.
double deepest(const tick& t) {
  double d = -std::numeric_limits<double>::infinity();
  for (const penetration& p : t.depths) {
    if (!has(p.flags, depth_flag::no_overlap)) d = std::max(d, p.depth_m);
  }
  return d;
}

// A seeded pose at which the probe, coming from outside along a random direction with a random orientation, overlaps by
// some tenths of a millimetre.
bool touching_pose(renderer& r, std::mt19937_64& rng, pose& T_wa) {
  const textured_model& a = *r.scene().probe;
  const textured_model& b = *r.scene().fixed.front();
  const std::array<pose, 1> fixed{};
  const quat rotation = random_rotation(rng);
  const vec3 from = random_direction(rng);
  const vec3 centre_b = 0.5 * (b.box.low + b.box.high);
  const vec3 target =
      centre_b + 0.3 * uniform(rng, 0.0, 1.0) * b.box.diagonal() * glm::cross(from, random_direction(rng));
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

struct row {
  int poses = 0, contacts = 0, beyond = 0;
  double worst_share = 0.0;  // of the bound
  std::vector<double> errors_m;
};

double percentile(std::vector<double> v, double p) {
  if (v.empty()) return 0.0;
  std::sort(v.begin(), v.end());
  return v[std::min(v.size() - 1, static_cast<std::size_t>(p * static_cast<double>(v.size())))];
}

row compare(const std::string& probe_name, const std::string& fixed_name, std::uint64_t seed) {
  const loaded_body a = load(probe_name);
  const loaded_body b = load(fixed_name);
  row out;
  if (a.model == nullptr || b.model == nullptr) return out;
  renderer_settings settings;
  settings.depth.grid = grid;
  auto made = make_renderer({a.model, {b.model}}, settings);
  if (!made) {
    ADD_FAILURE() << made.error().message;
    return out;
  }
  const std::array<pose, 1> fixed{};
  std::mt19937_64 rng(seed);
  for (int attempt = 0; out.poses < poses_per_pair && attempt < 4 * poses_per_pair; ++attempt) {
    pose T_wa;
    if (!touching_pose(*made, rng, T_wa)) continue;
    ++out.poses;
    tick t;
    if (made->step({T_wa, fixed}, t) != status::ok) {
      ADD_FAILURE() << "a pose that was found once is not found again";
      continue;
    }
    for (std::size_t i = 0; i < t.contacts.size(); ++i) {
      const contact& c = t.contacts[i];
      const penetration& p = t.depths[i];
      const auto truth = oracle::measure_brute_force(
          {&a.full, &a.model->mesh, made->contacts().patch_a(c), T_wa, reach(a)},
          {&b.full, &b.model->mesh, made->contacts().patch_b(c), {}, reach(b)}, c.window, grid, refinement);
      if (has(p.flags, depth_flag::no_overlap) || truth.samples == 0) {
        EXPECT_EQ(has(p.flags, depth_flag::no_overlap), truth.samples == 0) << probe_name << " pose " << out.poses;
        continue;
      }
      ++out.contacts;
      const double error = std::fabs(p.depth_m - truth.dense_m);
      // What the grid misses of the originals themselves, and the bakes' own largest errors. Those are distances
      // across the surface; along n a slope makes them longer (a wall, where it has no limit, counts as 45 degrees).
      const auto along_n = [](double slope) { return std::hypot(1.0, std::min(slope, 1.0)); };
      const double bound = (truth.dense_m - truth.grid_m) + along_n(truth.slope_a) * a.model->report.max_error_m +
                           along_n(truth.slope_b) * b.model->report.max_error_m;
      out.errors_m.push_back(error);
      out.worst_share = std::max(out.worst_share, error / bound);
      if (error > bound) {
        ++out.beyond;
        std::printf(
            "    beyond: pose %d contact %zu  depth %.6f mm  truth %.6f mm  grid %.6f mm  bound %.6f mm  slopes %.2f "
            "%.2f  window %.2f mm\n",
            out.poses, i, p.depth_m * 1e3, truth.dense_m * 1e3, truth.grid_m * 1e3, bound * 1e3, truth.slope_a,
            truth.slope_b, c.window.half_size_m * 1e3);
      }
    }
  }
  return out;
}

TEST(brute_force_models, depth_agrees_with_the_full_resolution_meshes) {
  struct pair {
    const char *probe, *fixed;
    std::uint64_t seed;
  };
  std::printf("  %-18s %6s %9s   %s\n", "pair", "poses", "contacts",
              "|error| um: median   p95   max   largest share of its bound");
  int poses = 0;
  for (const pair& p : {pair{"block", "gear", 11}, pair{"file", "cad_part", 12}, pair{"hammer", "torus", 13}}) {
    const row r = compare(p.probe, p.fixed, p.seed);
    std::printf("  %-8s on %-8s %5d %9d   %19.3f %6.3f %6.3f   %.2f\n", p.probe, p.fixed, r.poses, r.contacts,
                percentile(r.errors_m, 0.5) * 1e6, percentile(r.errors_m, 0.95) * 1e6,
                percentile(r.errors_m, 1.0) * 1e6, r.worst_share);
    poses += r.poses;
    EXPECT_EQ(r.beyond, 0) << p.probe << " on " << p.fixed << " (seed " << p.seed << ")";
  }
  EXPECT_GE(poses, 200);
}

}  // namespace
