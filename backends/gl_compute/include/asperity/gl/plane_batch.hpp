// Support planes of many poses of a scene in one submission to the device. Component asperity::gl_compute.
//
// For learning and for studies, which want thousands of poses at once and no loop. A control loop is better served by
// make_plane_renderer(): it also tells where else the probe may go, and leaves most samples unread, which a device reads.
//
// What happens where: on the host each pose becomes a rotation and a shift for each pair of bodies, in double precision.
// On the device an invocation looks at a few neighbouring samples at one pose, and a group of them then finds the
// deepest plane of each direction. On the host again, that becomes planes about the probe's centre of mass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/gl/arithmetic.hpp"
#include "asperity/gl/context.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/planes/plane_springs.hpp"

namespace asperity::gl {

/// Capacities and arithmetic of a plane_batch.
struct plane_batch_settings {
  /// Most poses of one call; 1 to 65535.
  std::size_t poses = 1024;
  /// Most leaves (up to 8 neighbouring samples each) of a pose that may lie deeper than above_m. A box of 10 mm with a
  /// face pressed 4 mm into another has about 3000.
  std::size_t leaves = 8192;
  /// Planes are told that are deeper than this, m: 0 those that push, below 0 gaps as well.
  double above_m = 0.0;
  /// As plane_spring_settings has it.
  double same_direction = plane_spring_settings{}.same_direction;
  gl::arithmetic arithmetic = arithmetic::automatic;
  /// How long to wait for the device, ns; longer means that something is broken.
  std::uint64_t timeout_ns = 60'000'000'000;
};

/// What one pose has to tell.
struct pose_planes {
  static constexpr std::size_t most_directions = 16;

  /// The deepest plane of each direction of each body, the deepest of all first.
  fixed_vector<near_plane, most_directions> deepest;
  /// Leaves that did not fit: raise plane_batch_settings::leaves. Where it is not 0, which of them were looked at is
  /// chance, and a plane may be missing.
  std::uint32_t left_out = 0;
};

/// The wrench that springs on these planes put on the probe, about its centre of mass: the force of a tick of
/// make_plane_renderer(), to rounding. @rt safe
[[nodiscard]] wrench push_of(const pose_planes& planes, double stiffness_n_per_m) noexcept;

/// The depths that plane_depth reads, of every sample of a probe and its fixed bodies in each other's fields. It differs
/// from a tick of make_plane_renderer() in that nothing is left out by what lies before it: with gaps (above_m below 0)
/// there can be more planes.
///
/// Agreement with that tick, asserted over poses that are drawn anew in each run (tests/hardware/gl): the same planes,
/// depths to 1e-9 m and the push to 1e-6 of the largest in double precision; depths to 5e-6 m, and the push to 1e-2 at 99
/// of 100 poses, in single precision, where another of two samples may seem the deeper. The same call gives the same bits
/// on the same device, as long as no leaf is left out, and so does a call for each pose.
class plane_batch {
 public:
  /// Copies fields and samples to the device, compiles the shaders. The context is current in this thread afterwards only
  /// if it was before; the first measure() takes it for its own.
  /// @param made of these bodies, in their order: make_field_scene()
  /// @return invalid_argument | limit_exceeded (a buffer of the device, or its memory) | unsupported
  [[nodiscard]] static result<plane_batch> make(context_ptr context, const scene& bodies,
                                                std::shared_ptr<const field_scene> made,
                                                const plane_batch_settings& settings = {});
  plane_batch(plane_batch&&) noexcept;
  plane_batch& operator=(plane_batch&&) noexcept;
  ~plane_batch();

  /// The planes of every pose. scene_pose::gaps_m does not count.
  /// @pre the context is current in no other thread
  /// @return ok | capacity_reached (more poses than the settings say: nothing is told; leaves were left out: see
  ///         pose_planes) | invalid_pose | not_ready (a pose for each fixed body is wanted, and an answer for each pose) |
  ///         not_finite | backend_failed (the device did not answer, or is lost). All but ok and left_out leave empty
  ///         answers behind.
  /// @rt no allocation, lock, throw, print or clock of ours; one wait for the device, and whatever its driver does
  [[nodiscard]] status measure(std::span<const scene_pose> at, std::span<pose_planes> out) noexcept;

  [[nodiscard]] const plane_batch_settings& settings() const noexcept;
  /// The arithmetic that is used; never automatic.
  [[nodiscard]] gl::arithmetic arithmetic() const noexcept;
  /// Memory on the device, bytes, fields included.
  [[nodiscard]] std::size_t device_bytes() const noexcept;

 private:
  struct parts;
  explicit plane_batch(std::unique_ptr<parts> p) noexcept;
  std::unique_ptr<parts> parts_;
};

}  // namespace asperity::gl
