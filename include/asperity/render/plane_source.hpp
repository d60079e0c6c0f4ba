// Whom to ask for the support planes of a pose where the probe is not yet.
#pragma once

#include <concepts>
#include <span>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// The support planes of one pose, as many as a plane_source tells.
using plane_list = fixed_vector<support_plane, 32>;

/// Tells the support planes of poses near that of a tick. A tick holds one where its renderer can tell them.
/// It refers to the renderer and lives until the renderer's next step; it is for the thread that steps.
class plane_source {
 public:
  /// Knows nothing.
  plane_source() = default;
  /// @param renderer has planes_at(), as basic_renderer
  template <class Renderer>
  explicit plane_source(Renderer& renderer) noexcept
      : renderer_(&renderer), ask_([](void* of, const vec6& moved, double above_m, plane_list& out) noexcept {
          return static_cast<Renderer*>(of)->planes_at(moved, above_m, out);
        }) {}

  [[nodiscard]] explicit operator bool() const noexcept { return ask_ != nullptr; }

  /// The planes deeper than above_m where the probe is moved from the tick's pose, reported at the moved pose. Where
  /// there are more than the list takes, the deepest of them.
  /// @param moved translation of c_A, m, and rotation vector about it, rad; world axes
  /// @return ok | capacity_reached | not_ready (this source knows nothing) | invalid_pose (moved is not finite)
  /// @rt safe
  [[nodiscard]] status operator()(const vec6& moved, double above_m, plane_list& out) const noexcept {
    out.clear();
    return ask_ != nullptr ? ask_(renderer_, moved, above_m, out) : status::not_ready;
  }

 private:
  void* renderer_ = nullptr;
  status (*ask_)(void*, const vec6&, double, plane_list&) noexcept = nullptr;
};

/// A depth backend that can be asked for the planes of a pose near that of its last measure(); see plane_depth.
template <class D>
concept reports_planes_nearby = requires(const D& depth, const scene_pose& at, const typename D::found_type& found,
                                         std::span<const typename D::reading_type> read, const vec6& moved,
                                         double above_m, plane_list& out) {
  { depth.planes_at(at, found, read, moved, above_m, out) }
  noexcept->std::same_as<status>;
};

}  // namespace asperity
