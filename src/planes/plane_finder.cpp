#include "asperity/planes/plane_finder.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"
#include "planes/ball_bound.hpp"
#include "planes/known_branches.hpp"

namespace asperity {
namespace {

// Samples of X in the field of Y; T_yx takes X's frame to Y's. What is known of X's balls spares looks at them.
void list(const sample_tree& of_x, const body_field& in_y, const pose& T_yx, const near_patch& whose, double reach_m,
          branch_bounds* known, near_samples& out) noexcept {
  using answer = sample_tree::branch_answer;
  near_patch patch = whose;
  of_x.walk(
      [&](const sample_tree::branch& b) noexcept {
        if (known != nullptr && !(known->most_m(b.number) > -reach_m)) return answer::away;
        const sample_ball ball = b.ball();
        const double near_m = in_y.most_near(T_yx * ball.centre_b, ball.radius_m);
        // Over a pitch the smooth part is nearly straight, and one reading serves all leaves of a ball.
        const bool whole = b.is_leaf() || !(ball.radius_m > in_y.smooth.pitch_m);
        if (!(near_m > -reach_m) || !whole) {
          if (known != nullptr && near_m < known->most_m(b.number)) known->note(b.number, near_m);
          if (!(near_m > -reach_m)) return answer::away;
          if (known != nullptr) known->open(b);
          return answer::open;
        }
        patch.in_other = bound_of_ball(in_y, T_yx, ball);
        if (known != nullptr) known->note(b.number, patch.in_other.most_m);
        if (!(patch.in_other.most_m > -reach_m)) return answer::away;
        patch.ball = ball;
        patch.branch = b.number;
        static_cast<void>(out.begin(patch));
        return answer::taken;
      },
      [&](const sample_ball& ball, std::span<const field_sample> samples) noexcept {
        static_cast<void>(
            out.add({.first = samples.data(), .count = static_cast<std::uint32_t>(samples.size()), .ball = ball}));
      });
}

// Whether any sample of X may be near Y.
bool may_be_near(const sample_tree& of_x, const body_field& in_y, const pose& T_yx, double reach_m) noexcept {
  bool near = false;
  of_x.walk(
      [&](const sample_tree::branch& all) noexcept {
        const sample_ball ball = all.ball();
        near = in_y.most_near(T_yx * ball.centre_b, ball.radius_m) > -reach_m;
        return sample_tree::branch_answer::away;
      },
      [](const sample_ball&, std::span<const field_sample>) noexcept {});
  return near;
}

}  // namespace

plane_finder::plane_finder(std::shared_ptr<const field_scene> bodies, double reach_m,
                           std::shared_ptr<known_branches> known) noexcept
    : bodies_(std::move(bodies)), known_(std::move(known)), reach_m_(reach_m) {}

status plane_finder::find(const scene_pose& at, near_samples& out) noexcept {
  out.clear();
  const double reach_m = std::min(reach_m_, at.gaps_m);
  if (known_) known_->begin(at);
  for (std::uint32_t b = 0; b < bodies_->fixed.size(); ++b) {
    const field_body &A = *bodies_->probe, &B = *bodies_->fixed[b];
    const pose T_ba = inverse(at.T_wb[b]) * at.T_wa, T_ab = inverse(T_ba);
    if (!may_be_near(A.samples, B.field, T_ba, reach_m) && !may_be_near(B.samples, A.field, T_ab, reach_m)) continue;
    const auto known = known_ ? known_->of(b, at, *bodies_) : known_branches::pair_bounds{};
    list(A.samples, B.field, T_ba, {.body = b, .of_probe = true}, reach_m, known.of_probe, out);
    list(B.samples, A.field, T_ab, {.body = b, .of_probe = false}, reach_m, known.of_fixed, out);
  }
  return out.dropped() > 0 ? status::capacity_reached : status::ok;
}

}  // namespace asperity
