// Detects presses that support planes do not hold, by depth fields.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/planes/plane_scene.hpp"
#include "asperity/render/support_plane.hpp"
#include "asperity/render/tick_flag.hpp"
#include "planes/passage.hpp"

namespace asperity {

/// Watches probe and fixed bodies from tick to tick. For each fixed body it takes the two surface points, one of each
/// body, that the deepest plane is between, and follows either through the other body's field: see passage. It asks the
/// fields and not the planes, so a plane that is missing hides nothing. A tick that comes with another probe pose than
/// a hand can have moved to (half of the smallest body's diagonal or half a radian away) begins anew, so unrelated
/// poses report no passage.
class plane_watch {
 public:
  explicit plane_watch(const field_scene& bodies, const scene& of) : probe_(field_reach::of(bodies.probe->field)) {
    double smallest_m = of.probe->box.diagonal();
    for (const model_ptr& b : of.fixed) smallest_m = std::min(smallest_m, b->box.diagonal());
    for (const field_body_ptr& b : bodies.fixed) {
      fixed_.push_back({.reach = field_reach::of(b->field), .farthest_m = 0.5 * smallest_m});
    }
    listed_.reserve(fixed_.size());
  }
  /// Of a scene that changes: every body that comes into it is told by forget().
  plane_watch(const body_facts& probe, std::size_t slots) : probe_{probe.half_m}, fixed_(slots) {
    listed_.reserve(slots);
  }

  /// Another body is in a slot: it is watched from now on. @rt safe
  void forget(std::size_t slot, const body_facts& now) noexcept {
    watched& w = fixed_[slot];
    w.of_probe.forget();
    w.of_fixed.forget();
    w.reach = {now.half_m};
    w.farthest_m = 0.5 * now.smallest_m;
  }

  /// @param planes of this tick, with gaps
  /// @param c_a_w  centre of mass that their r_w are from
  /// @pre as many bodies as it was made for   @rt safe
  [[nodiscard]] tick_flag look(const field_scene& bodies, const scene_pose& at, std::span<const support_plane> planes,
                               const vec3& c_a_w) noexcept {
    for (const std::uint32_t b : listed_) fixed_[b].deepest = nullptr;
    for (const support_plane& p : planes) {
      watched& w = fixed_[p.body];
      if (!std::exchange(w.listed, true)) listed_.push_back(p.body);
      if (w.deepest == nullptr || p.depth_m > w.deepest->depth_m) w.deepest = &p;
    }
    tick_flag out = tick_flag::none;
    std::size_t kept = 0;
    for (const std::uint32_t b : listed_) {
      watched& w = fixed_[b];
      // Where nothing is near and no point is followed, there is nothing to say.
      w.listed = w.deepest != nullptr || w.of_probe.active() || w.of_fixed.active();
      if (!w.listed) continue;
      out |= look_at(b, bodies, at, c_a_w);
      listed_[kept++] = b;
    }
    listed_.resize(kept);
    return out;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(fixed_, listed_); }

 private:
  struct watched {
    field_reach reach{};
    passage of_probe{}, of_fixed{};  // a point of the probe in the body's field, and the other way round
    pose T_ba{};
    const support_plane* deepest = nullptr;  // of the planes that look() is given
    double farthest_m = 0.0;                 // that a hand can have moved the probe from it
    bool listed = false;
  };

  [[nodiscard]] tick_flag look_at(std::size_t b, const field_scene& bodies, const scene_pose& at,
                                  const vec3& c_a_w) noexcept {
    const body_field &in_a = bodies.probe->field, &in_b = bodies.fixed[b]->field;
    const pose T_ba = inverse(at.T_wb[b]) * at.T_wa, T_ab = inverse(T_ba);
    watched& w = fixed_[b];
    tick_flag out = tick_flag::none;
    constexpr double least_cosine = 0.97;  // of half the turn: half a radian
    if (glm::distance(T_ba.position, w.T_ba.position) > w.farthest_m ||
        std::fabs(glm::dot(T_ba.rotation, w.T_ba.rotation)) < least_cosine) {
      w.of_probe.forget();
      w.of_fixed.forget();
    }
    w.T_ba = T_ba;
    if (w.of_probe.go(T_ba, in_b, w.reach) || w.of_fixed.go(T_ab, in_a, probe_)) out |= tick_flag::passed;

    if (const support_plane* const deepest = w.deepest; deepest != nullptr) {
      if (deepest->depth_m > deepest_held_m) out |= tick_flag::not_held;
      // The sample lies on one of the surfaces, and the other surface is beside it by the depth.
      const pose to_a = inverse(at.T_wa), to_b = inverse(at.T_wb[b]);
      const vec3 p_w = c_a_w + deepest->r_w, across_w = deepest->depth_m * deepest->n_ab_w;
      const bool on_a = std::fabs(in_a.coarse(to_a * p_w).value_m) < std::fabs(in_b.coarse(to_b * p_w).value_m);
      const vec3 on_a_w = on_a ? p_w : p_w + across_w, on_b_w = on_a ? p_w - across_w : p_w;
      begin_anew(w.of_probe, to_a * on_a_w, to_b * on_a_w, in_b, w.reach);
      begin_anew(w.of_fixed, to_b * on_b_w, to_a * on_b_w, in_a, probe_);
    }
    if ((w.of_probe.active() && w.reach.ends_before(w.of_probe.last())) ||
        (w.of_fixed.active() && probe_.ends_before(w.of_fixed.last()))) {
      out |= tick_flag::beyond_field;
    }
    return out;
  }

  // A point that is deep is followed to its end; a shallow one gives way to what is the deepest now.
  static void begin_anew(passage& p, const vec3& point_x, const vec3& point_y, const body_field& in_y,
                         const field_reach& reach) noexcept {
    if (!p.active() || p.last().value_m < reach.shallow_m()) p.begin(point_x, point_y, in_y);
  }

  field_reach probe_;
  std::vector<watched> fixed_;
  std::vector<std::uint32_t> listed_;  // the bodies that are watched
};

}  // namespace asperity
