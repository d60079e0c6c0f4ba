// The surface near the probe between two contacts: their planes, read again in every device tick.
#pragma once

#include <algorithm>
#include <span>

#include "asperity/control/linear_contact.hpp"
#include "asperity/control/moving_bodies.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/render/plane_reader.hpp"

namespace asperity {

/// Reads a contact's planes again where the probe is.
///
/// A plane is the surface to first order at the pose of its contact. On a texture that is soon wrong: a hand of 0.1 m/s goes
/// half a millimetre in a period of 200 Hz, past a ridge and into the next valley. The points that the planes stand for are
/// few, and to read them is a small part of a contact tick; to find them is the rest. So the contact thread finds them, and
/// the device thread reads them. What a plane is not told of the points beside its own is not known here either.
/// @rt safe
class local_model {
 public:
  /// @param reads false: planes stay as the contact has them
  explicit local_model(bool reads) noexcept : reads_(reads) {}

  /// The contact's planes as they are for a probe at T_wc, linear about the contact's pose like its own. Bodies that move are
  /// where their ways begin; carried_contact takes the planes there.
  /// @return contact.planes where nobody can read them again   @warning until the next call
  [[nodiscard]] const support_planes& planes_of(const linear_contact& contact, std::span<const body_way> ways,
                                                const pose& T_wc) noexcept {
    if (!reads_ || contact.reader == nullptr || contact.planes.empty()) return contact.planes;
    planes_ = contact.planes;
    for (const body_place& then : contact.places) {
      // A depth depends on the bodies' pose to each other: the body stays where it was, and the probe is moved.
      const auto way = std::find_if(ways.begin(), ways.end(), [&](const body_way& w) {
        return w.body == then.body && w.generation == then.generation;
      });
      const pose there_T_wc = way == ways.end() ? T_wc : then.T_wb * inverse(way->after(0.0)) * T_wc;
      const vec6 moved = pose_difference(there_T_wc, contact.T_wc);
      for (support_plane& p : planes_) {
        if (p.body == then.body) p.depth_m += dot(p.gradient, moved);
      }
      contact.reader->read(there_T_wc, then.T_wb, then.body, {planes_.data(), planes_.size()});
      for (support_plane& p : planes_) {
        if (p.body == then.body) p.depth_m -= dot(p.gradient, moved);
      }
    }
    return planes_;
  }

 private:
  bool reads_;
  support_planes planes_{};
};

}  // namespace asperity
