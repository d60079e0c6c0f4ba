// Whom to ask what has become of a tick's support planes where the probe is now.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>

#include "asperity/core/pose.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// Reads the points again that support planes stand for. A device loop asks it in each of its ticks, so that what is felt
/// between two contacts is the surface and not the plane that the older contact had of it.
///
/// It refers to the bodies of the renderer that has it, and to nothing that a tick changes: any thread may ask, while
/// another one steps the renderer. It lives as long as the renderer.
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

/// A depth backend whose planes can be read again; see plane_depth. Null where its bodies may change.
template <class D>
concept has_plane_reader = requires(const D& depth) {
  { depth.reader() }
  noexcept->std::same_as<const plane_reader*>;
};

}  // namespace asperity
