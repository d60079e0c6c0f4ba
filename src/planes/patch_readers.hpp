// The readers of a tick's patches, for each thread that shares the tick.
#pragma once

#include <array>
#include <optional>

#include "asperity/core/pose.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/depth_backend.hpp"
#include "planes/leaf_reader.hpp"
#include "planes/plane_materials.hpp"
#include "planes/tick_team.hpp"

namespace asperity {

/// Readers of a pose, one for the patches of a body on either side; patches mostly come in long rows of the same two.
class patch_readers {
 public:
  patch_readers(const field_scene& bodies, const scene_pose& at, const vec3& c_a_w,
                const plane_materials& materials) noexcept
      : bodies_(&bodies), at_(&at), c_a_w_(c_a_w), materials_(&materials) {}

  [[nodiscard]] const leaf_reader& of(const near_patch& patch, double shallow_m) noexcept {
    std::optional<leaf_reader>& out = patch.of_probe ? of_probe_ : of_fixed_;
    if (out && out->reads(patch)) return *out;
    const field_body &A = *bodies_->probe, &B = *bodies_->fixed[patch.body];
    const pose &T_wa = at_->T_wa, &T_wb = at_->T_wb[patch.body];
    const material_places *of_a = materials_->of_probe(), *of_b = materials_->of_body(patch.body);
    return out.emplace(
        leaf_reader::between(A, T_wa, B, T_wb, patch.body, patch.of_probe, c_a_w_, shallow_m, of_a, of_b, work_));
  }
  [[nodiscard]] const depth_work& work() const noexcept { return work_; }

 private:
  const field_scene* bodies_;
  const scene_pose* at_;
  vec3 c_a_w_;
  const plane_materials* materials_;
  depth_work work_;
  std::optional<leaf_reader> of_probe_, of_fixed_;
};

/// Readers of a pose, a pair for each thread of a team. A thread uses its own.
class readers_of_threads {
 public:
  readers_of_threads(const field_scene& bodies, const scene_pose& at, const vec3& c_a_w,
                     const plane_materials& materials) noexcept
      : bodies_(&bodies), at_(&at), c_a_w_(c_a_w), materials_(&materials) {}

  [[nodiscard]] patch_readers& of(unsigned thread) noexcept {
    std::optional<patch_readers>& out = readers_[thread];
    if (!out) out.emplace(*bodies_, *at_, c_a_w_, *materials_);
    return *out;
  }
  [[nodiscard]] depth_work work() const noexcept {
    depth_work sum;
    for (const std::optional<patch_readers>& r : readers_) {
      if (!r) continue;
      sum.bounded += r->work().bounded;
      sum.read += r->work().read;
    }
    return sum;
  }

 private:
  const field_scene* bodies_;
  const scene_pose* at_;
  vec3 c_a_w_;
  const plane_materials* materials_;
  std::array<std::optional<patch_readers>, tick_team::most_threads> readers_;
};

}  // namespace asperity
