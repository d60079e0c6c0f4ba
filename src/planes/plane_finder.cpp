#include "asperity/planes/plane_finder.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/planes/plane_scene.hpp"
#include "model/body_sphere.hpp"
#include "planes/ball_bound.hpp"
#include "planes/body_tree.hpp"
#include "planes/known_branches.hpp"
#include "planes/passage.hpp"
#include "planes/tick_team.hpp"

namespace asperity {
namespace {

// Up to which gap balls are looked into. Within reach all are. Where nothing is, the walk goes on for the clearance: to
// three reaches, so that three times as fast a hand is not held back, and no further than the nearest that it has left.
double looks_to_m(double most_left_m, double reach_m) noexcept {
  constexpr double free_reaches = 3.0;
  return std::clamp(-most_left_m, reach_m, free_reaches * reach_m);
}

// None of these samples is deeper.
double most_near(std::span<const field_sample> of_x, const body_field& in_y, const pose& T_yx) noexcept {
  double most_m = -std::numeric_limits<double>::infinity();
  for (const field_sample& s : of_x) most_m = std::max(most_m, in_y.most_near(T_yx * vec3(s.position_b), 0.0));
  return most_m;
}

// Samples of X in the field of Y; T_yx takes X's frame to Y's. What is known of X's balls spares looks at them.
// @param left_m what other bodies have that is not listed
void list(const sample_tree& of_x, const body_field& in_y, const pose& T_yx, const near_patch& whose, double reach_m,
          double left_m, branch_bounds* known, near_samples& out) noexcept {
  using answer = sample_tree::branch_answer;
  near_patch patch = whose;
  const auto leave = [&](double most_m) noexcept {
    left_m = std::max(left_m, most_m);
    return answer::away;
  };
  of_x.walk(
      [&](const sample_tree::branch& b) noexcept {
        const double enough_m = looks_to_m(left_m, reach_m);
        if (known != nullptr && !(known->most_m(b.number) > -enough_m)) return leave(known->most_m(b.number));
        out.look_at();
        const sample_ball ball = b.ball();
        const double near_m = in_y.most_near(T_yx * ball.centre_b, ball.radius_m);
        // Over a pitch the smooth part is nearly straight, and one reading serves all leaves of a ball.
        const bool whole = b.is_leaf() || !(ball.radius_m > in_y.smooth.pitch_m);
        if (!(near_m > -enough_m) || !whole) {
          if (known != nullptr && near_m < known->most_m(b.number)) known->note(b.number, near_m);
          if (!(near_m > -enough_m)) return leave(near_m);
          if (known != nullptr) known->open(b);
          return answer::open;
        }
        patch.in_other = bound_of_ball(in_y, T_yx, ball);
        double most_m = patch.in_other.most_m;
        // A leaf of a plain face may be a few samples far apart, and its ball reaches where none of them is.
        if (most_m > -enough_m && ball.radius_m > in_y.smooth.pitch_m) {
          most_m = std::min(most_m, most_near(b.samples(), in_y, T_yx));
        }
        if (known != nullptr) known->note(b.number, most_m);
        if (!(most_m > -reach_m)) return leave(most_m);
        left_m = std::max(left_m, -reach_m);
        patch.ball = ball;
        patch.branch = b.number;
        static_cast<void>(out.begin(patch));
        return answer::taken;
      },
      [&](const sample_ball& ball, std::span<const field_sample> samples) noexcept {
        static_cast<void>(
            out.add({.first = samples.data(), .count = static_cast<std::uint32_t>(samples.size()), .ball = ball}));
      });
  out.leave(left_m);
}

// No sample of X is deeper in Y.
double most_near(const sample_tree& of_x, const body_field& in_y, const pose& T_yx) noexcept {
  double most_m = -std::numeric_limits<double>::infinity();
  of_x.walk(
      [&](const sample_tree::branch& all) noexcept {
        const sample_ball ball = all.ball();
        most_m = in_y.most_near(T_yx * ball.centre_b, ball.radius_m);
        return sample_tree::branch_answer::away;
      },
      [](const sample_ball&, std::span<const field_sample>) noexcept {});
  return most_m;
}

// Of the nodes that may be next to a point of the grid's border.
double largest_at_border_m(const detail::coarse_grid& grid) noexcept {
  const auto at_border = [](std::size_t i, std::size_t nodes) { return i < 2 || i + 2 >= nodes; };
  float largest = -std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < grid.nodes[2]; ++k) {
    for (std::size_t j = 0; j < grid.nodes[1]; ++j) {
      const bool whole_row = at_border(k, grid.nodes[2]) || at_border(j, grid.nodes[1]);
      for (std::size_t i = 0; i < grid.nodes[0]; ++i) {
        if (!whole_row && !at_border(i, grid.nodes[0])) i = grid.nodes[0] - 2;
        largest = std::max(largest, grid.value[grid.at(i, j, k)]);
      }
    }
  }
  return static_cast<double>(largest);
}

}  // namespace

plane_finder::plane_finder(std::shared_ptr<const field_scene> bodies, double reach_m,
                           std::shared_ptr<known_branches> known, shared_work with)
    : bodies_(std::move(bodies)),
      known_(std::move(known)),
      with_(std::move(with)),
      probe_(around(*bodies_->probe)),
      reach_m_(reach_m) {
  const std::vector<field_body_ptr>& fixed = bodies_->fixed;
  fixed_.reserve(fixed.size());
  for (std::size_t b = 0; b < fixed.size(); ++b) {
    const auto same = std::find(fixed.begin(), fixed.begin() + static_cast<std::ptrdiff_t>(b), fixed[b]);
    const auto first = static_cast<std::size_t>(same - fixed.begin());
    fixed_.push_back(first < b ? fixed_[first] : around(*fixed[b]));
  }
}

// Where two such spheres are further apart than the reach, list() would find both bodies' largest balls too far away.
// For body_field::most_near() of a ball outside the grid is at most the largest value at the grid's border, a pitch to
// the node next to it, a pitch and a quarter, the relief and twice the ball's radius, less the way from the grid.
plane_finder::sphere plane_finder::around(const field_body& body) noexcept {
  constexpr double pitches = 1.0 + 1.25;
  const detail::coarse_grid& grid = body.field.smooth;
  const vec3 low = grid.clamped(vec3(-1e30)), high = grid.clamped(vec3(1e30)), middle = 0.5 * (low + high);
  const double grid_m = 0.5 * glm::distance(low, high) + std::max(0.0, largest_at_border_m(grid)) +
                        pitches * grid.pitch_m + body.field.highest_relief_m;
  sphere out{middle, grid_m};
  body.samples.walk(
      [&](const sample_tree::branch& b) noexcept {
        const sample_ball all = b.ball();
        out = {all.centre_b, std::max(2.0 * all.radius_m, grid_m + glm::distance(all.centre_b, middle))};
        return sample_tree::branch_answer::away;
      },
      [](const sample_ball&, std::span<const field_sample>) noexcept {});
  return out;
}

body_facts facts_of(const field_body& body, double probe_diagonal_m, double diagonal_m) {
  const plane_finder::sphere s = plane_finder::around(body);
  return {s.centre_b, s.radius_m, field_reach::of(body.field).half_m, std::min(probe_diagonal_m, diagonal_m)};
}

plane_finder::plane_finder(const plane_scene& first, double reach_m, std::shared_ptr<known_branches> known,
                           shared_work with)
    : known_(std::move(known)),
      with_(std::move(with)),
      probe_{first.probe.centre_b, first.probe.radius_m},
      fixed_(first.of.size()),
      reach_m_(reach_m) {
  detail::reserve_resident(near_, first.of.size());
  take(first);
}

void plane_finder::take(const plane_scene& next) noexcept {
  const std::uint64_t before = placed_ != nullptr ? placed_->version : 0;
  for (std::size_t b = 0; b < fixed_.size(); ++b) {
    if (next.since[b] > before) fixed_[b] = {next.of[b].centre_b, next.of[b].radius_m};
  }
  bodies_ = next.fields;
  placed_ = &next;
}

status plane_finder::find(const scene_pose& at, near_samples& out) noexcept {
  out.clear();
  near_bodies_ = 0;
  const double reach_m = std::min(reach_m_, at.gaps_m);
  if (known_) known_->begin(at);
  const vec3 probe_w = at.T_wa * probe_.centre_b;
  if (placed_ == nullptr || at.version == 0 || at.version != placed_->version) {
    // Most bodies of a large scene are left out by this alone.
    for (std::uint32_t b = 0; b < bodies_->fixed.size(); ++b) {
      if (bodies_->fixed[b]) look_into(b, at, probe_w, reach_m, out);
    }
    return out.dropped() > 0 ? status::capacity_reached : status::ok;
  }
  // No clearance makes the look at a body go on beyond this; the order of bodies is that of their slots.
  const double farthest_m = looks_to_m(out.most_left_m(), reach_m);
  near_.clear();
  const auto is_moved = [&](std::uint32_t b) noexcept {
    return std::find(at.moved.begin(), at.moved.end(), b) != at.moved.end();
  };
  out.leave(placed_->tree->find(probe_w, probe_.radius_m, farthest_m, is_moved,
                                [&](std::uint32_t b) noexcept { near_.push_back(b); }));
  for (const std::uint32_t b : at.moved) {
    const bool listed = std::find(near_.begin(), near_.end(), b) != near_.end();
    if (!listed && b < bodies_->fixed.size() && bodies_->fixed[b]) near_.push_back(b);
  }
  std::sort(near_.begin(), near_.end());
  for (const std::uint32_t b : near_) look_into(b, at, probe_w, reach_m, out);
  return out.dropped() > 0 ? status::capacity_reached : status::ok;
}

void plane_finder::look_into(std::uint32_t b, const scene_pose& at, const vec3& probe_w, double reach_m,
                             near_samples& out) noexcept {
  const sphere& body = fixed_[b];
  const vec3 body_w = at.T_wb[b] * body.centre_b;
  const double enough_m = looks_to_m(out.most_left_m(), reach_m);
  if (!may_be_within(enough_m, probe_w, probe_.radius_m, body_w, body.radius_m)) {
    out.leave(probe_.radius_m + body.radius_m - glm::distance(probe_w, body_w));
    return;
  }
  ++near_bodies_;
  const field_body &A = *bodies_->probe, &B = *bodies_->fixed[b];
  const pose T_ba = inverse(at.T_wb[b]) * at.T_wa, T_ab = inverse(T_ba);
  const double most_m = std::max(most_near(A.samples, B.field, T_ba), most_near(B.samples, A.field, T_ab));
  if (!(most_m > -enough_m)) {
    out.leave(most_m);
    return;
  }
  const auto known = known_ ? known_->of(b, at, *bodies_) : known_branches::pair_bounds{};
  const double left_m = out.most_left_m();
  const auto of_probe = [&](near_samples& to) noexcept {
    list(A.samples, B.field, T_ba, {.body = b, .of_probe = true}, reach_m, left_m, known.of_probe, to);
  };
  const auto of_fixed = [&](near_samples& to) noexcept {
    list(B.samples, A.field, T_ab, {.body = b, .of_probe = false}, reach_m, left_m, known.of_fixed, to);
  };
  if (!with_.team) {
    of_probe(out);
    of_fixed(out);
    return;
  }
  // Neither walk knows what the other one finds, with one thread too: what they list does not depend on it.
  near_samples& beside = *with_.beside;
  beside.clear();
  with_.team->run(2, [&](std::size_t task, unsigned) noexcept { task == 0 ? of_probe(out) : of_fixed(beside); });
  out.append(beside);
}

}  // namespace asperity
