// Which materials the planes of a scene are of, and what keeps a change of material from making energy.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/planes/plane_scene.hpp"
#include "model/material_places.hpp"

namespace asperity {

/// Materials of the planes between a probe and its fixed bodies, by the maps of their models. A pair of bodies without a
/// map costs nothing.
///
/// A spring that became stiffer while it is pressed would push harder without anybody's work: 2 N on rubber are 0.7 mm,
/// which on ice are 57 N. So where the deepest point of a leaf comes to lie on a harder material, the leaf is felt
/// further in, by so much that it pushes as hard as before, and stores less; where it comes to a softer one, it comes
/// forward again by what the stored energy allows. As the probe leaves, the surface follows it out, and what is pressed
/// anew is where it is. Leaves that are all of one material never stand back and carry the probe on.
class plane_materials {
 public:
  /// Of a scene that never changes. @param most leaves that are followed at one time
  plane_materials(const scene& of, std::size_t most) : own_pairs_(surfaces_of(of)), pairs_(&own_pairs_) {
    own_.push_back(material_places::of(*of.probe));
    for (std::size_t b = 0; b < of.fixed.size(); ++b) {
      std::size_t same = 0;
      while (of.fixed[same] != of.fixed[b]) ++same;
      own_.push_back(same < b ? own_[same + 1] : material_places::of(*of.fixed[b]));
    }
    places_ = &own_;
    find_any();
    if (any_) reserve(most);
  }
  /// Of a scene that changes. @param first its first version
  plane_materials(const plane_scene& first, std::size_t most) {
    take(first);
    reserve(most);
  }
  plane_materials(const plane_materials&) = delete;
  plane_materials& operator=(const plane_materials&) = delete;

  /// Another version of the scene. @rt safe
  void take(const plane_scene& next) noexcept {
    pairs_ = &next.surfaces;
    places_ = &next.materials;
    find_any();
  }
  /// Another body is in a slot. @rt safe
  void forget(std::uint32_t body) noexcept {
    held_.erase(std::remove_if(held_.begin(), held_.end(), [&](const held_leaf& h) { return h.body == body; }),
                held_.end());
  }

  /// Whether planes of a fixed body and the probe may be of several materials.
  [[nodiscard]] bool has_map(std::uint32_t body) const noexcept {
    return of_probe() != nullptr || of_body(body) != nullptr;
  }
  [[nodiscard]] bool any() const noexcept { return any_; }
  [[nodiscard]] const material_places* of_probe() const noexcept { return any_ ? (*places_)[0].get() : nullptr; }
  [[nodiscard]] const material_places* of_body(std::uint32_t body) const noexcept {
    return any_ ? (*places_)[body + 1].get() : nullptr;
  }

  /// By how much the surface that a leaf presses is felt further in, m, where its plane is so deep. @rt safe
  [[nodiscard]] double back_m(const near_leaf& leaf, bool of_probe, const support_plane& p) const noexcept {
    const held_leaf now = of(leaf, of_probe, p);
    const auto was = std::lower_bound(held_.begin(), held_.end(), now, before);
    if (was == held_.end() || before(now, *was)) return 0.0;
    const double pressed_m = std::max(0.0, p.depth_m - was->back_m);
    double back_m = was->back_m;
    if (now.stiffness_n_per_m > was->stiffness_n_per_m) {
      back_m = p.depth_m - was->stiffness_n_per_m / now.stiffness_n_per_m * pressed_m;
    } else if (now.stiffness_n_per_m < was->stiffness_n_per_m) {
      back_m = p.depth_m - std::sqrt(was->stiffness_n_per_m / now.stiffness_n_per_m) * pressed_m;
    }
    return std::clamp(back_m, 0.0, std::max(0.0, p.depth_m));
  }

  /// Makes what the planes of a tick need to stand back less deep, and remembers it for the next tick. @rt safe
  void hold_back(const near_samples& found, std::span<near_plane> out) noexcept {
    next_.clear();
    for (const near_patch& patch : found.patches()) {
      if (!has_map(patch.body)) continue;
      for (std::size_t i = patch.first_leaf; i < patch.first_leaf + patch.leaf_count; ++i) {
        support_plane& p = out[i].plane;
        if (!(p.depth_m > 0.0)) continue;
        held_leaf now = of(found.leaves()[i], patch.of_probe, p);
        now.back_m = back_m(found.leaves()[i], patch.of_probe, p);
        p.depth_m -= now.back_m;
        p.back_m += now.back_m;
        if (next_.size() < next_.capacity()) next_.push_back(now);
      }
    }
    std::sort(next_.begin(), next_.end(), before);
    std::swap(held_, next_);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = asperity::heap_bytes(own_, own_pairs_, own_pairs_.mapped, held_, next_);
    for (auto m = own_.begin(); m != own_.end(); ++m) {
      if (*m && std::find(own_.begin(), m, *m) == m) bytes += sizeof **m + (*m)->heap_bytes();
    }
    return bytes;
  }

 private:
  // A leaf that was pressed in the last tick.
  struct held_leaf {
    const field_sample* first;
    std::uint32_t body;
    bool of_probe;
    double stiffness_n_per_m;
    double back_m;
  };
  [[nodiscard]] static bool before(const held_leaf& a, const held_leaf& b) noexcept {
    if (a.body != b.body) return a.body < b.body;
    if (a.of_probe != b.of_probe) return a.of_probe < b.of_probe;
    return std::less<>()(a.first, b.first);
  }

  void reserve(std::size_t most) {
    detail::reserve_resident(held_, most);
    detail::reserve_resident(next_, most);
  }
  void find_any() noexcept {
    any_ = std::any_of(places_->begin(), places_->end(), [](const auto& p) { return p != nullptr; });
  }
  [[nodiscard]] held_leaf of(const near_leaf& leaf, bool of_probe, const support_plane& p) const noexcept {
    const surface_pair* const mapped = pairs_->find(p.body, p.of_probe, p.of_body);
    const std::optional<surface_pair>& usual = (*pairs_)[p.body];
    const double k = mapped != nullptr ? mapped->stiffness_n_per_m : (usual ? usual->stiffness_n_per_m : 1.0);
    return {leaf.first, p.body, of_probe, k, 0.0};
  }

  std::vector<std::shared_ptr<const material_places>> own_;  // of the probe, then of each body
  surface_pairs own_pairs_;
  const std::vector<std::shared_ptr<const material_places>>* places_ = nullptr;
  const surface_pairs* pairs_ = nullptr;
  bool any_ = false;
  std::vector<held_leaf> held_, next_;
};

}  // namespace asperity
