// Whom to ask for support planes of poses beside that of a tick: where the probe is not yet, and where it has come since.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// The support planes of one pose, as many as a plane_source tells.
using plane_list = fixed_vector<support_plane, 256>;

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

/// Reads the points again that support planes stand for. A device loop asks it in each of its substeps, so that what is felt
/// between two contacts is the surface and not the plane that the older contact had of it.
///
/// It refers to the bodies of the renderer that has it, and to nothing that a tick changes: any thread may ask, while
/// another one steps the renderer. It lives as long as the renderer, or the version of a scene that changes.
class plane_reader {
 public:
  /// Brings the planes of one body to where the probe and that body are: depth, gradient, direction and point. A plane
  /// stays as it is where its number is 0, where its point has no depth there, and where it would press after a turn by a
  /// right angle or more: that is another wall, which a contact has to tell.
  /// @param T_wc   the probe's centre-of-mass frame   @param T_wb the body's
  /// @param planes of any bodies; those of others are left alone
  /// @rt safe: one reading of a depth field for each plane
  virtual void read(const pose& T_wc, const pose& T_wb, std::uint32_t body,
                    std::span<support_plane> planes) const noexcept = 0;

 protected:
  plane_reader() = default;
  plane_reader(const plane_reader&) = default;
  plane_reader& operator=(const plane_reader&) = default;
  ~plane_reader() = default;
};

/// A depth backend whose planes can be read again; see plane_depth.
template <class D>
concept reports_plane_reader = requires(const D& depth) {
  { depth.reader() }
  noexcept->std::same_as<const plane_reader*>;
};

}  // namespace asperity
