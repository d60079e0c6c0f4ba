// What has become of support planes that stand for samples of depth fields.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/render/depth_backend.hpp"
#include "asperity/render/plane_source.hpp"
#include "planes/leaf_reader.hpp"

namespace asperity {

/// Reads samples of a scene, or of one version of it, as plane_depth reads them.
class surface_reader final : public plane_reader {
 public:
  /// @param centre_of_mass_a of the probe
  /// @param shallow_m one per fixed body, so far in samples count by their share; see plane_depth
  surface_reader(std::shared_ptr<const field_scene> bodies, const vec3& centre_of_mass_a,
                 std::vector<double> shallow_m) noexcept
      : bodies_(std::move(bodies)), centre_of_mass_a_(centre_of_mass_a), shallow_m_(std::move(shallow_m)) {}

  void read(const pose& T_wc, const pose& T_wb, std::uint32_t body,
            std::span<support_plane> planes) const noexcept override {
    if (body >= bodies_->fixed.size() || !bodies_->fixed[body]) return;
    const field_body &A = *bodies_->probe, &B = *bodies_->fixed[body];
    const pose T_wa = T_wc * pose{quat(1.0, 0.0, 0.0, 0.0), -centre_of_mass_a_};
    depth_work unused;
    std::optional<leaf_reader> of_probe, of_fixed;
    for (support_plane& p : planes) {
      if (p.body != body || p.sample == 0) continue;
      const sample_number number = sample_number::from(p.sample);
      std::optional<leaf_reader>& reader = number.of_probe ? of_probe : of_fixed;
      if (!reader) {
        reader.emplace(leaf_reader::between(A, T_wa, B, T_wb, body, number.of_probe, T_wc.position, shallow_m_[body],
                                            nullptr, nullptr, unused));
      }
      const support_plane now = reader->plane_of(number.index);
      const bool is_there = now.depth_m > -std::numeric_limits<double>::infinity();
      if (!is_there || (now.depth_m > 0.0 && !(glm::dot(now.n_ab_w, p.n_ab_w) > 0.0))) continue;
      p.depth_m = now.depth_m - p.back_m;
      p.gradient = now.gradient;
      p.n_ab_w = now.n_ab_w;
      p.r_w = now.r_w;
    }
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(shallow_m_); }

 private:
  std::shared_ptr<const field_scene> bodies_;
  vec3 centre_of_mass_a_;
  std::vector<double> shallow_m_;
};

}  // namespace asperity
