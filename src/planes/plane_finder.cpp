#include "asperity/planes/plane_finder.hpp"

#include <cstdint>
#include <span>

#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"
#include "planes/ball_bound.hpp"

namespace asperity {
namespace {

// Samples of X in the field of Y; T_yx takes X's frame to Y's.
void list(const sample_tree& of_x, const body_field& in_y, const pose& T_yx, const near_patch& whose, double reach_m,
          near_samples& out) noexcept {
  using answer = sample_tree::branch_answer;
  near_patch patch = whose;
  of_x.query(
      [&](const sample_ball& ball, bool is_leaf) noexcept {
        if (!(in_y.most_near(T_yx * ball.centre_b, ball.radius_m) > -reach_m)) return answer::away;
        // Over a pitch the smooth part is nearly straight, and one reading serves all leaves of a ball.
        if (!is_leaf && ball.radius_m > in_y.smooth.pitch_m) return answer::open;
        patch.in_other = bound_of_ball(in_y, T_yx, ball);
        if (!(patch.in_other.most_m > -reach_m)) return answer::away;
        patch.ball = ball;
        static_cast<void>(out.begin(patch));
        return answer::taken;
      },
      [&](const sample_ball& ball, std::span<const field_sample> samples) noexcept {
        static_cast<void>(
            out.add({.first = samples.data(), .count = static_cast<std::uint32_t>(samples.size()), .ball = ball}));
      });
}

}  // namespace

status plane_finder::find(const scene_pose& at, near_samples& out) noexcept {
  out.clear();
  for (std::uint32_t b = 0; b < bodies_->fixed.size(); ++b) {
    const field_body &A = *bodies_->probe, &B = *bodies_->fixed[b];
    const pose T_ba = inverse(at.T_wb[b]) * at.T_wa;
    list(A.samples, B.field, T_ba, {.body = b, .of_probe = true}, reach_m_, out);
    list(B.samples, A.field, inverse(T_ba), {.body = b, .of_probe = false}, reach_m_, out);
  }
  return out.dropped() > 0 ? status::capacity_reached : status::ok;
}

}  // namespace asperity
