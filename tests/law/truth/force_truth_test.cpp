// The force for poses alone beside the originals: light touches, and what the distance of samples has to do with it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "law/truth/counted_share.hpp"
#include "law/truth/pair_truth.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity::truth {
namespace {

constexpr double light_m = 0.2e-3;
// The least motion that parts the originals is between this share of the press and the press itself: one contact.
constexpr double alone = 0.97;

/// Pairs of a day: another share of all every day.
std::vector<std::pair<std::string, std::string>> pairs_of(std::uint64_t seed, std::size_t count) {
  std::vector<std::pair<std::string, std::string>> all, out;
  for (const char* a : benchmark_names) {
    for (const char* b : benchmark_names) {
      if (a != b) all.emplace_back(a, b);
    }
  }
  const std::size_t first = test_support::seed_of(seed, "pairs of force") % all.size(), step = all.size() / count;
  for (std::size_t i = 0; i < count; ++i) out.push_back(all[(first + i * step) % all.size()]);
  return out;
}

/// Forces of light touches, as shares of k d.
struct light_touches {
  std::vector<double> wall, edge;
};

light_touches ask(std::uint64_t seed, std::size_t pairs, std::uint64_t approaches, const force_bend& bend) {
  light_touches out;
  for (const auto& [a, b] : pairs_of(seed, pairs)) {
    force_truth pair(get_body(a), get_body(b));
    pair.bend = bend;
    const double k = pair.law().stiffness_n_per_m();
    for (std::uint64_t i = 0; i < approaches; ++i) {
      const auto c = pair.press(seed, i, light_m, alone);
      if (!c) continue;
      const double share = c->along_n() / (k * c->depth_m);
      (c->one_wall ? out.wall : out.edge).push_back(share);
    }
  }
  return out;
}

void print(const light_touches& t) {
  for (const auto& [name, of] : {std::pair{"at one wall", t.wall}, std::pair{"at edges", t.edge}}) {
    const auto n = static_cast<double>(std::max<std::size_t>(of.size(), 1));
    const auto within = std::count_if(of.begin(), of.end(), [](double f) { return std::fabs(f - 1.0) <= 0.05; });
    std::printf(
        "  %-11s %4zu touches: force / (k d) %.3f p01, %.3f p10, %.3f median, %.3f p90, %.3f p99; within 5 %%: %.0f "
        "%%\n",
        name, of.size(), quantile(of, 0.01), quantile(of, 0.1), quantile(of, 0.5), quantile(of, 0.9),
        quantile(of, 0.99), 100.0 * static_cast<double>(within) / n);
  }
}

// Wished for: within 5 % of k d. By closed form that holds (stripes_truth_test.cpp); on baked models 3 of 10 touches
// keep it. What the others lack:
// - 4 % is the bed: under a single sample it gives way by 10 um with the softness of a loop of 1 kHz.
// - bakes cut tips off and samples lie beside them: half of the touching tips lack 8 to 12 um and more, some 140 um, of
// a
//   press of 200 um.
// - at edges the field's shape is the smooth part's, which is round there by a part of its pitch, and the pose law
// keeps
//   no relief beside edges: one touch in ten of edge on edge is not felt at 0.2 mm.
struct bounds_of_force {
  double half_above, most_above, most_below;  ///< of k d: half of the touches, 99 of 100, 99 of 100
};
constexpr bounds_of_force wall_bounds{0.86, 0.3, 1.06}, edge_bounds{0.6, -0.02, 1.4};

std::vector<std::string> complaints(const light_touches& t) {
  std::vector<std::string> out;
  const auto count = [](const std::vector<double>& of, const auto& beyond) {
    return static_cast<std::size_t>(std::count_if(of.begin(), of.end(), beyond));
  };
  const auto hold = [&](const std::string& name, const std::vector<double>& of, const bounds_of_force& b) {
    if (more_than(0.5, count(of, [&](double f) { return f < b.half_above; }), of.size())) {
      out.push_back(name + ": more than half are weaker than " + std::to_string(b.half_above) + " k d");
    }
    if (more_than(0.01, count(of, [&](double f) { return f < b.most_above; }), of.size())) {
      out.push_back(name + ": some are weaker than " + std::to_string(b.most_above) + " k d");
    }
    if (more_than(0.01, count(of, [&](double f) { return f > b.most_below; }), of.size())) {
      out.push_back(name + ": some are stronger than " + std::to_string(b.most_below) + " k d");
    }
  };
  hold("at one wall", t.wall, wall_bounds);
  hold("at edges", t.edge, edge_bounds);
  return out;
}

TEST(force_truth, light_touches_push_by_their_depth) {
  const std::size_t pairs = test_support::extent<std::size_t>(4, 30);
  const std::uint64_t approaches = test_support::extent<std::uint64_t>(10, 30);
  const std::uint64_t seed = test_support::fresh_seed("light touches", "4 pairs x 10 (30 x 30 at length)");
  const light_touches t = ask(seed, pairs, approaches, {});
  print(t);
  EXPECT_GT(t.wall.size() + t.edge.size(), pairs * approaches / 3);
  for (const std::string& what : complaints(t)) ADD_FAILURE() << what;
}

TEST(force_truth, notices_forces_that_are_a_fifth_too_weak_or_turned) {
  const std::uint64_t seed = test_support::fresh_seed("planted forces", "6 pairs x 4, 10 x 10 more at length");
  const auto turned = [](reported_force& f) { f.on_probe_w = -1.0 * f.on_probe_w; };
  EXPECT_FALSE(complaints(ask(seed, 6, 4, turned)).empty());
  if (!test_support::at_length()) return;
  const auto weak = [](reported_force& f) { f.on_probe_w = 0.8 * f.on_probe_w; };
  EXPECT_FALSE(complaints(ask(seed, 10, 12, weak)).empty());
}

/// By how much the force changes where samples lie half as far apart, as shares of k d.
std::vector<double> changes(std::uint64_t seed, std::size_t pairs, std::uint64_t approaches,
                            const std::function<field_body_ptr(const truth_body&)>& other) {
  std::vector<double> out;
  for (const auto& [a, b] : pairs_of(seed, pairs)) {
    const truth_body &probe = get_body(a), &fixed = get_body(b);
    force_truth pair(probe, fixed);
    pose_law law({probe.model, {fixed.model}},
                 std::make_shared<const field_scene>(field_scene{other(probe), {other(fixed)}}));
    for (std::uint64_t i = 0; i < approaches; ++i) {
      const double depth_m = i % 2 == 0 ? 1e-3 : 0.3e-3;
      const auto c = pair.press(seed, i, depth_m, 0.0);
      if (!c || !c->reported.complete) continue;
      const vec3 change = law.at(c->T_wa).on_probe_w.force - c->reported.on_probe_w.force;
      out.push_back(glm::length(change) / (law.stiffness_n_per_m() * depth_m));
    }
  }
  return out;
}

void print(const std::vector<double>& changed) {
  std::printf("  %zu presses: %.2f %% median, %.1f %% p90, %.1f %% p99 of k d\n", changed.size(),
              100.0 * quantile(changed, 0.5), 100.0 * quantile(changed, 0.9), 100.0 * quantile(changed, 0.99));
}

// Wished for: 1 %, which a smooth body keeps (scale_truth_test.cpp) and half of the presses of benchmark models do. They
// meet with their edges, and along an edge that crosses another one the depth is a tent, so one of ten presses still
// changes by 3 to 4 %; with as few samples on edges as on faces it was 7 %.
TEST(force_truth, half_the_distance_of_samples_changes_little) {
  const auto half = [](const truth_body& b) {
    static std::map<std::string, field_body_ptr> made;
    field_body_ptr& at = made[b.name];
    if (!at) at = built_field_body(*b.model, {.sample_pitch_m = 0.5 * b.sample_pitch_m()});
    return at;
  };
  const std::size_t pairs = test_support::extent<std::size_t>(4, 30);
  const std::uint64_t approaches = test_support::extent<std::uint64_t>(6, 16);
  const std::uint64_t seed = test_support::fresh_seed("half the pitch", "4 pairs x 6 (30 x 16 at length)");
  const std::vector<double> changed = changes(seed, pairs, approaches, half);
  print(changed);
  const auto beyond = [](const std::vector<double>& of, double bound) {
    return static_cast<std::size_t>(std::count_if(of.begin(), of.end(), [=](double c) { return c > bound; }));
  };
  EXPECT_FALSE(more_than(0.5, beyond(changed, 0.01), changed.size()));
  EXPECT_FALSE(more_than(0.1, beyond(changed, 0.06), changed.size()));
  EXPECT_FALSE(more_than(0.01, beyond(changed, 0.25), changed.size()));
  // The control: with one sample in sixty-four it does change, whichever pairs the day draws.
  const std::vector<double> poor =
      changes(seed, 2, 18, [](const truth_body& b) { return with_fewer_samples(*b.field, 64); });
  print(poor);
  EXPECT_TRUE(more_than(0.5, beyond(poor, 0.02), poor.size()) || more_than(0.1, beyond(poor, 0.1), poor.size()));
}

}  // namespace
}  // namespace asperity::truth
