// The deepest support plane beside the originals, at poses that the library had no part in.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "law/truth/counted_share.hpp"
#include "law/truth/pair_truth.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::truth {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// Where a plane stands: all about it is one wall, or an edge is near enough to have a part in the depth.
enum class place : std::uint8_t { wall, edges };
constexpr std::array place_names{"one wall", "edges"};

/// What was found at poses of one band and kind of place. Lengths as shares of the smaller diagonal.
struct findings {
  std::vector<double> off;       ///< |told - true depth at the plane's place|
  std::vector<double> short_of;  ///< true overlap of the bodies less the deepest plane; a gap is a negative overlap
  std::vector<double> tilt_rad;
  std::size_t nowhere = 0;  ///< the originals have no surface there at all
};

struct truth_table {
  std::array<std::array<findings, 2>, 3> of;
  std::size_t poses = 0, untold = 0, missed = 0, felt_apart = 0;
  std::string worst;

  [[nodiscard]] const findings& at(band b, place p) const {
    return of[static_cast<std::size_t>(b)][static_cast<std::size_t>(p)];
  }
};

void add(truth_table& to, const plane_truth& pair, const plane_case& c) {
  constexpr double bound = 5e-4;
  const double scale = 1.0 / pair.diagonal_m(), bound_m = bound * pair.diagonal_m() + pair.bake_error_m();
  ++to.poses;
  // Everything is told up to the reach, and what the bakes lack is not the renderer's.
  if (!c.reported) {
    ++to.untold;
    if (c.overlap_m > bound_m) ++to.missed;
    return;
  }
  if (c.reported->depth_m <= 0.0 && c.overlap_m > bound_m) ++to.missed;
  if (c.reported->depth_m > bound_m && c.overlap_m < 0.0) ++to.felt_apart;
  findings& f =
      to.of[static_cast<std::size_t>(c.of)][static_cast<std::size_t>(c.one_wall ? place::wall : place::edges)];
  f.short_of.push_back((c.overlap_m - c.reported->depth_m) * scale);
  if (!c.truth.found) {
    ++f.nowhere;
    return;
  }
  f.off.push_back(std::fabs(c.error_m()) * scale);
  f.tilt_rad.push_back(c.tilt_rad());
}

void print(const truth_table& t) {
  for (std::size_t b = 0; b < 3; ++b) {
    for (std::size_t p = 0; p < 2; ++p) {
      const findings& f = t.of[b][p];
      std::printf(
          "  %-5s %-8s %4zu poses: depth off by %.4f %% median, %.3f %% p90, %.3f %% p99; deepest plane short by %.4f "
          "%% "
          "median, %.3f %% p99, too deep by %.3f %% p99; direction %.2f deg median, %.1f p90; no surface %zu\n",
          band_names[b], place_names[p], f.short_of.size(), 100.0 * quantile(f.off, 0.5), 100.0 * quantile(f.off, 0.9),
          100.0 * quantile(f.off, 0.99), 100.0 * quantile(f.short_of, 0.5), 100.0 * quantile(f.short_of, 0.99),
          -100.0 * quantile(f.short_of, 0.01), quantile(f.tilt_rad, 0.5) / degree, quantile(f.tilt_rad, 0.9) / degree,
          f.nowhere);
    }
  }
  std::printf("  %zu poses, %zu without planes, %zu missed, %zu felt apart\n", t.poses, t.untold, t.missed,
              t.felt_apart);
}

truth_table ask(plane_truth& pair, std::uint64_t seed, std::uint64_t approaches, truth_table so_far = {}) {
  for (std::uint64_t i = 0; i < approaches; ++i) {
    for (const plane_case& c : pair.approach(seed, i)) add(so_far, pair, c);
  }
  return so_far;
}

/// Every ordered pair of these; of a share of them, as many as are asked for, another share every day.
truth_table ask_all(const std::vector<std::string>& names, std::uint64_t seed, std::size_t pairs,
                    std::uint64_t approaches) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const std::string& a : names) {
    for (const std::string& b : names) {
      if (a != b) all.emplace_back(a, b);
    }
  }
  const std::size_t first = test_support::seed_of(seed, "pairs of the day") % all.size(), step = all.size() / pairs;
  truth_table out;
  for (std::size_t i = 0; i < pairs; ++i) {
    const auto& [a, b] = all[(first + i * step) % all.size()];
    plane_truth pair(get_body(a), get_body(b));
    out = ask(pair, seed, approaches, std::move(out));
  }
  return out;
}

/// What is promised of one band and kind of place: half of all errors are below the first number, 99 of 100 below the
/// second.
struct promise {
  band of;
  place where;
  double half, most;
  double short_half, short_most;  ///< the same of what the deepest plane lacks
};

// Wished for is 1e-4 and 5e-4 everywhere. Off the edges that holds, but for one in a hundred deep places. Where it does
// not hold, what was measured stands here, with room for a day's luck:
// - behind an edge two walls are equally near. The smooth part of the field rounds the ridge between them by a part of
// its
//   pitch, which is 0.7 to 1 % of the diagonal, and its slope lies between the two normals: along it the way out is up
//   to sqrt(2) times the depth. Before an edge a gap is told smaller than it is, by the same rounding.
// - bakes cut the tips off sharp edges, by 0.02 to 0.14 % of the diagonal at most, and samples lie beside them: a third
// and
//   two thirds of what the deepest plane lacks.
// clang-format off
constexpr std::array<promise, 6> promises{{
    {band::gap,   place::wall,  4e-5, 5e-4, 1.2e-4, 3e-3},
    {band::light, place::wall,  4e-5, 5e-4, 1.5e-4, 3e-3},
    {band::deep,  place::wall,  1e-4, 1.2e-3, 2e-4, 4e-3},
    {band::gap,   place::edges, 3e-4, 6e-3, 1e-4, 3e-3},
    {band::light, place::edges, 1.5e-4, 3e-3, 4e-4, 4e-3},
    {band::deep,  place::edges, 1e-3, 1e-2, 1.2e-3, 8e-3},
}};
// clang-format on
constexpr double half_tilt_rad = 1.5 * degree;  // half the directions at one wall are nearer to the wall's mean normal

/// One sentence for each promise that was not kept.
std::vector<std::string> complaints(const truth_table& t) {
  std::vector<std::string> out;
  const auto beyond = [](const std::vector<double>& values, double bound) {
    return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [=](double v) { return v > bound; }));
  };
  const auto hold = [&](const std::string& what, const std::vector<double>& values, double bound, double share) {
    const std::size_t n = beyond(values, bound);
    if (more_than(share, n, values.size())) {
      out.push_back(what + ": " + std::to_string(n) + " of " + std::to_string(values.size()) + " are beyond " +
                    std::to_string(bound));
    }
  };
  for (const promise& p : promises) {
    const findings& f = t.at(p.of, p.where);
    const std::string name =
        std::string(band_names[static_cast<std::size_t>(p.of)]) + ", " + place_names[static_cast<std::size_t>(p.where)];
    hold(name + ": half of the depths", f.off, p.half, 0.5);
    hold(name + ": depths", f.off, p.most, 0.01);
    hold(name + ": half of what the deepest lack", f.short_of, p.short_half, 0.5);
    hold(name + ": what the deepest lack", f.short_of, p.short_most, 0.01);
    if (p.where == place::wall) hold(name + ": directions", f.tilt_rad, half_tilt_rad, 0.5);
  }
  if (t.missed > 0) out.push_back(std::to_string(t.missed) + " touches missed");
  if (t.felt_apart > 0) out.push_back(std::to_string(t.felt_apart) + " touches told where the originals are apart");
  return out;
}

void expect_kept(const truth_table& t) {
  print(t);
  for (const std::string& what : complaints(t)) ADD_FAILURE() << what;
}

TEST(depth_truth, planes_of_benchmark_models_are_where_the_originals_are) {
  const std::uint64_t approaches = test_support::extent<std::uint64_t>(6, 40);
  const std::size_t pairs = test_support::extent<std::size_t>(6, 30);
  const std::uint64_t seed = test_support::fresh_seed("depth truth", "6 pairs x 6 approaches (30 x 40 at length)");
  const truth_table t = ask_all({benchmark_names.begin(), benchmark_names.end()}, seed, pairs, approaches);
  EXPECT_GT(t.poses, 2 * pairs * approaches);
  expect_kept(t);
}

TEST(depth_truth, planes_of_scans_are_where_the_originals_are) {
  if (const std::string why = why_without_scans(); !why.empty()) GTEST_SKIP() << why;
  const std::uint64_t approaches = test_support::extent<std::uint64_t>(4, 60);
  const std::uint64_t seed = test_support::fresh_seed("depth truth of scans", "6 pairs x 4 approaches (60 at length)");
  const truth_table t = ask_all({scan_names.begin(), scan_names.end()}, seed, 6, approaches);
  EXPECT_GT(t.poses, 12 * approaches);
  expect_kept(t);
}

/// A fault put between the library and its judge.
struct planted {
  const char* name;
  std::function<field_body_ptr(const truth_body&)> field;
  plane_bend bend;
};

const planted nothing{"nothing", [](const truth_body& b) { return b.field; }, {}};
const planted shifted{"texture moved aside by a texel",
                      [](const truth_body& b) { return built_field_body(with_shifted_relief(*b.model)); },
                      {}};
const planted fewer{
    "23 of 24 samples left out", [](const truth_body& b) { return with_fewer_samples(*b.field, 24); }, {}};
const planted tilted{
    "directions tilted by 2 degrees", [](const truth_body& b) { return b.field; },
    [](reported_plane& p) { p.n_ab_w = exp_rotation(2.0 * degree * any_orthogonal(p.n_ab_w)) * p.n_ab_w; }};
const planted late{"planes 0.2 % of a diagonal late", [](const truth_body& b) { return b.field; },
                   [](reported_plane& p) { p.depth_m -= 0.35e-3; }};

/// What is told of a fault at two pairs, which have little else to tell of.
std::vector<std::string> reported_with(const planted& fault, const char* one, const char* other, std::uint64_t seed,
                                       std::uint64_t approaches) {
  truth_table t;
  for (const auto& [probe, fixed] : {std::pair{one, other}, std::pair{other, one}}) {
    const truth_body &a = get_body(probe), &b = get_body(fixed);
    truth_pair felt = pair_of(a, b);
    felt.fields = std::make_shared<const field_scene>(field_scene{fault.field(a), {fault.field(b)}});
    plane_truth pair(a, b, felt);
    pair.bend = fault.bend;
    t = ask(pair, seed, approaches, std::move(t));
  }
  const std::vector<std::string> out = complaints(t);
  std::printf("  %s: %s\n", fault.name, out.empty() ? "nothing to tell" : out.front().c_str());
  return out;
}

TEST(depth_truth, notices_planted_faults) {
  const std::uint64_t seed = test_support::fresh_seed("faults", "2 pairs x 35 approaches, more at length");
  EXPECT_FALSE(reported_with(tilted, "gear", "torus", seed, 35).empty());
  EXPECT_FALSE(reported_with(late, "gear", "torus", seed, 10).empty());
  if (!test_support::at_length()) return;
  EXPECT_TRUE(reported_with(nothing, "gear", "torus", seed, 60).empty());
  EXPECT_TRUE(reported_with(nothing, "hammer", "torus", seed, 100).empty());
  EXPECT_FALSE(reported_with(shifted, "hammer", "torus", seed, 100).empty());
  EXPECT_FALSE(reported_with(fewer, "hammer", "torus", seed, 100).empty());
}

}  // namespace
}  // namespace asperity::truth
