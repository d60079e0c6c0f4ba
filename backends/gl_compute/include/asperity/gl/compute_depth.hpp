// The depth backend in compute shaders. Component asperity::gl_compute.
//
// What happens where
// - On the host, in double precision: the patches are projected into their windows, and it is decided which coarse
//   triangle each sample sees. A rounding error would show in these decisions (a silhouette runs between two samples),
//   so they are those of the CPU backend to the bit. The host also reduces every pose to numbers relative to the
//   window.
// - On the device, a group of invocations per 512 samples: the textured surface over each sample of both bodies, their
//   difference, its hard maximum and the sums of the soft maximum with gradient and curvature.
// - On the host again: the groups' sums are put together in double precision, in a fixed order.
//
// A tick is one submission for all contacts, and one wait for it. The host's share at 64 x 64 samples was 0.06 to 0.12
// ms of processor time per contact with 2 to 32 triangles, and 0.2 to 0.4 ms with the eleven configurations of the
// central difference (one busy core of a Xeon at 3 GHz). It is the price of coverage that agrees to the sample; where a
// device draws thousands of contacts faster than that, deciding on the device would be the next step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "asperity/gl/arithmetic.hpp"
#include "asperity/gl/context.hpp"
#include "asperity/render/depth_backend.hpp"
#include "asperity/window/window_depth_settings.hpp"

namespace asperity::gl {

/// Capacities and arithmetic of a compute_depth.
struct compute_settings {
  /// Most contacts of one call; 1 to 65535.
  std::size_t contacts = 16;
  /// Most coarse triangles of all patches of one call.
  std::size_t triangles = 16384;
  gl::arithmetic arithmetic = arithmetic::automatic;
  /// How long to wait for the device, ns; longer means that something is broken.
  std::uint64_t timeout_ns = 60'000'000'000;
};

/// Poses of the probe and of the one fixed body that a contact is with.
struct pose_pair {
  pose T_wa;
  pose T_wb;
};

/// Counts of a backend's calls and waits.
struct compute_counters {
  std::uint64_t ticks = 0;        ///< calls that reached the device
  std::uint64_t round_trips = 0;  ///< waits for the device: one per tick
  std::uint64_t contacts = 0;
};

/// Directional penetration depth as cpu_depth defines it, flags, gradients and curvature included.
///
/// Agreement with cpu_depth, asserted and printed over 2080 seeded contacts (tests/hardware/gl); angular components
/// count at the lever arm of the contact:
/// - double precision: hard depth to 1e-11 of the window's width, soft depth to 1e-7, each component of the gradient
///   and of tau times the curvature to 1e-5, a central difference to 1e-10. The soft maximum is less exact, because
///   shaders have the exponential in single precision only.
/// - single precision: depth to 1e-6, gradient to 2e-2, tau times the curvature to 1e-1. A weight of the soft maximum
///   errs by the error of a depth over tau.
/// Which samples a patch covers is the same to the sample, and so are the flags. The same call gives the same bits on
/// the same device. window_depth_settings::refine_maximum is not supported.
///
/// Where texels are NaN at the rim of an overlap, the central difference about the contact takes its angular step from
/// the overlap of the coarse patches, the CPU backend from that of the samples that are left.
class compute_depth {
 public:
  using policy_tag = depth_tag;

  /// Uploads the scene's models, or shares them where another backend of the context has them; compiles the shaders.
  /// The context is current in this thread afterwards only if it was before; the first measure() takes it for its own.
  /// @return what cpu_depth says about settings and scene | invalid_argument | unsupported | limit_exceeded
  [[nodiscard]] static result<compute_depth> make(context_ptr context, const scene& s,
                                                  const window_depth_settings& settings = {},
                                                  const compute_settings& gpu_settings = {});
  compute_depth(compute_depth&&) noexcept;
  compute_depth& operator=(compute_depth&&) noexcept;
  ~compute_depth();

  /// Depth of every contact, as cpu_depth::measure.
  /// @pre the context is current in no other thread
  /// @return ok | not_ready, not_finite (as cpu_depth) | capacity_reached (more contacts or triangles than the settings
  ///         say) | backend_failed (the device did not answer, or is lost); all but ok leave zeros behind
  /// @rt no allocation, lock, throw, print or clock of ours; one wait for the device, and whatever its driver does
  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept;

  /// The same for contacts that have nothing to do with each other: contact i at poses at[i]. One submission as well,
  /// and bit for bit what one call per contact gives. For simulation and learning.
  /// @pre at.size() == contacts.size()
  [[nodiscard]] status measure_each(std::span<const pose_pair> at, const contact_set& contacts,
                                    std::span<penetration> out) noexcept;

  [[nodiscard]] const window_depth_settings& settings() const noexcept;
  [[nodiscard]] const compute_counters& counters() const noexcept;
  [[nodiscard]] const context_ptr& owner() const noexcept;
  /// The arithmetic that is used; never automatic.
  [[nodiscard]] gl::arithmetic arithmetic() const noexcept;
  /// Memory of this backend on the device beyond the models, bytes; context::device_bytes() has everything.
  [[nodiscard]] std::size_t device_bytes() const noexcept;
  /// Without the models, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  struct parts;
  explicit compute_depth(std::unique_ptr<parts> p) noexcept;
  std::unique_ptr<parts> parts_;
};

static_assert(depth_backend<compute_depth>);

}  // namespace asperity::gl
