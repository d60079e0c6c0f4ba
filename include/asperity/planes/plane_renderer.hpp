// The renderer for control loops: depth fields, and support planes that hold the probe at the surface.
#pragma once

#include <memory>

#include "asperity/core/export.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/planes/plane_depth.hpp"
#include "asperity/planes/plane_finder.hpp"
#include "asperity/planes/plane_springs.hpp"
#include "asperity/render/renderer.hpp"

namespace asperity {

/// Reports the support planes of a pose, gaps included: those that a hand can meet in a period, see plane_depth. A
/// control loop that is given them cannot be pressed through a body: its device thread keeps the probe on the near
/// side of every plane.
using plane_renderer = basic_renderer<plane_finder, plane_depth, plane_springs>;

/// Settings of make_plane_renderer().
struct plane_renderer_settings {
  field_body_settings bodies{};
  /// Gaps up to this are reported, m; the probe enters what is not reported in time. 0: reach_for() a contact loop of
  /// 1 kHz, and at most a tenth of the smallest body's diagonal.
  double reach_m = 0.0;
  plane_spring_settings springs{};
  near_sample_limits limits{};
  /// Threads that share the work of a tick, the one that calls step() among them: 1 to 16. What a tick answers is the
  /// same to the bit for any number. The others wait for the next tick's work busily for some tenths of a millisecond,
  /// so they want processors of their own; see docs/how-to/share-a-tick.md.
  unsigned threads = 1;
  /// Called once in each of the other threads, with its number from 1 on: the place to ask for a scheduling class; as
  /// set_up_real_time_helper(). May be null.
  void (*set_up_helper)(unsigned) = nullptr;
};

/// The gaps that a contact loop of this period has to know, m: 3 v T for a hand of v = 0.6 m/s. With 2 v T a fast
/// touch of a loop of 200 Hz, late by a period, was 0.7 mm deep before its plane was known; with 4 v T, 0.1 mm.
[[nodiscard]] constexpr double reach_for(double period_s) noexcept { return 3.0 * 0.6 * period_s; }

/// The same for loops of two periods. A contact is in use for up to two contact periods and a device period after its
/// pose, so a device loop that is slower than the contact loop counts once of three.
[[nodiscard]] constexpr double reach_for(double contact_period_s, double device_period_s) noexcept {
  const bool device_is_slower = device_period_s > contact_period_s;
  return reach_for(device_is_slower ? (2.0 * contact_period_s + device_period_s) / 3.0 : contact_period_s);
}

/// Says whether gaps can be reported up to this, m: finite, and not negative.
[[nodiscard]] ASPERITY_API result<void> check_reach(double reach_m);

/// Says whether so many threads can share a tick.
[[nodiscard]] ASPERITY_API result<void> check_threads(unsigned threads);

/// The plane renderer for bodies that were made before, by make_field_scene(): several renderers can share them.
/// @pre made are of these bodies, in their order
/// @return invalid_argument (no probe, no fixed body, bodies missing, a setting out of range) | bad_texture (a map of
///         materials that does not fit)
[[nodiscard]] ASPERITY_API result<plane_renderer> make_plane_renderer(scene bodies,
                                                                      std::shared_ptr<const field_scene> made,
                                                                      const plane_renderer_settings& settings = {});

/// The plane renderer for a scene. Makes the fields of its models; all memory that its ticks need is taken here.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<plane_renderer> make_plane_renderer(scene bodies,
                                                                      const plane_renderer_settings& settings = {});

}  // namespace asperity
