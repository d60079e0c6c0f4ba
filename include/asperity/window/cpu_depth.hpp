// The reference depth backend: double precision, one core.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/render/depth_backend.hpp"
#include "asperity/window/window_depth_settings.hpp"

namespace asperity {

/// Directional penetration depth of textured patches, with its gradient and curvature.
/// Every other backend is measured against this one.
///
/// The patches' coarse triangles are projected along n onto a grid that is fixed in the world; over each sample the
/// haptic texture gives the fine height of either body; their difference has its maximum, hard and soft, over the grid.
/// - depth_m is the hard maximum, whatever the gradient scheme.
/// - soft_depth_m is the potential that gradient is the exact derivative of (soft_max), or depth_m
///   (central_difference).
/// @source paper sections 4.3, 5.1; science, sections 2, 3
class ASPERITY_API cpu_depth {
 public:
  using policy_tag = depth_tag;

  /// Takes all memory that a tick needs.
  /// @pre check(settings) and check_scene(scene) succeed; otherwise measure() answers not_ready. make_cpu_depth() says
  /// why.
  explicit cpu_depth(asperity::scene scene, const window_depth_settings& settings = {});
  cpu_depth(cpu_depth&&) noexcept;
  cpu_depth& operator=(cpu_depth&&) noexcept;
  ~cpu_depth();

  /// Depth of every contact. Where a window has no extent, or the patches share no sample: no_overlap.
  /// @pre out.size() >= contacts.size(); contacts are of this scene at these poses
  /// @return ok | not_ready (set-up, sizes or indices do not fit) | not_finite; the last two leave zeros behind
  /// @rt safe: no allocation, lock, throw, print or clock; cost grows with samples times contacts
  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept;

  [[nodiscard]] const window_depth_settings& settings() const noexcept;
  /// Softness that is used against fixed body `body`, m.
  [[nodiscard]] double tau_m(std::size_t body) const noexcept;
  /// Reference area A0 that is used against fixed body `body`, m^2.
  [[nodiscard]] double reference_area_m2(std::size_t body) const noexcept;
  /// Step of the central differences against fixed body `body` in a window of this half size, m.
  [[nodiscard]] double difference_step_m(std::size_t body, double half_size_m) const noexcept;

  /// Without the models, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

  /// Checks a scene. @return what in it cannot be measured
  [[nodiscard]] static result<void> check_scene(const asperity::scene& scene);

 private:
  class grid_search;
  std::unique_ptr<grid_search> search_;
};

static_assert(depth_backend<cpu_depth>);

/// A cpu_depth, or what is wrong with its settings or scene.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<cpu_depth> make_cpu_depth(const scene& s, const window_depth_settings& settings = {});

}  // namespace asperity
