// The depth backend of the paper: rendered heights, differences in a depth buffer, and a search for the largest of them
// with occlusion queries. Component asperity::gl_occlusion.
//
// A tick
// 1. Each contact's patches are rendered along n into tiles of a floating-point texture; the fragment stage looks the
//    haptic texture up (Eq. 8). First B, and A where it is.
// 2. One round of occlusion queries: whether and how far the patches share samples. The turns of A follow from that.
// 3. A's other configurations are rendered, and all eleven differences h_A - h_B into tiles of a depth buffer.
// 4. The largest difference of every tile by binary search: in each of 16 (or 24) rounds, one query per tile, all tiles
//    of all contacts side by side, and one wait for the answers.
//
// Levels of the depth buffer mark the special cases: 0 is no sample, 1 lies below the range and the highest level above
// it, so that "no overlap", "far apart" and "too deep" can be distinguished.
// @source paper section 5.2
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "asperity/gl/context.hpp"
#include "asperity/render/depth_backend.hpp"
#include "asperity/window/window_depth_settings.hpp"

namespace asperity::gl {

/// Where the heights of A's moved configurations come from.
enum class moved_heights : std::uint8_t {
  drawn,   ///< each of the ten is rendered: 12 height functions per contact, the CPU backend's depths at any step
  reused,  ///< the paper's 6: translations are shifts by whole samples, so the step is one sample; turns about n are
           ///< resampled from the heights at rest, which makes them smoother than they are
};

/// Capacities of an occlusion_depth, and how it draws.
struct occlusion_settings {
  std::size_t contacts = 16;      ///< most of one call; 1 to 256
  std::size_t triangles = 4096;   ///< most coarse triangles in all windows of one call
  std::uint32_t depth_bits = 16;  ///< 16, as the paper's, or 24
  moved_heights moved = moved_heights::drawn;
  /// The paper's packing: the four quarters of a tile in red, green, blue and alpha of one a quarter of its size. Needs
  /// an even grid; the depths are the same.
  bool packed = false;
  /// Depths from -depth_range_m to depth_range_m can be distinguished, m. 0: per contact what its patches can
  /// reach, at least a tenth of the window's half size in all.
  double depth_range_m = 0.0;
};

/// Counts of a backend's calls and waits.
struct occlusion_counters {
  std::uint64_t ticks = 0;  ///< calls that reached the device
  /// Waits for answers: one per tick that sees both patches of a contact, and one per bit where any of them overlap.
  std::uint64_t round_trips = 0;
  std::uint64_t queries = 0;
  std::uint64_t contacts = 0;
};

/// One tile of the last call, row by row, N x N.
struct occlusion_tile {
  std::string name;              ///< "B", "A", "A +u" ...
  std::vector<double> values_m;  ///< height from the window's centre along n, or difference; NaN: no sample
};

/// The tiles of one contact.
struct occlusion_tiles {
  std::vector<occlusion_tile> heights;      ///< empty where the contact was not drawn; 2 where nothing overlapped
  std::vector<occlusion_tile> differences;  ///< at rest, +u, -u, +v, -v, then the turns in the same order, and about n.
                                            ///< Packed: N/2 x N/2
};

/// The paper's settings as window_depth_settings has them: central differences and the paper's lookup.
[[nodiscard]] inline window_depth_settings paper_depth_settings(std::uint32_t grid = 64) noexcept {
  window_depth_settings s;
  s.gradient = gradient_scheme::central_difference;
  s.parallax = parallax_mode::paper_lookup;
  s.grid = grid;
  return s;
}

/// Directional penetration depth and its eleven-pose gradient, as cpu_depth with the same settings has them.
///
/// Agreement with cpu_depth, measured over 2000 contacts (tests/hardware/gl): the same flags and samples; depth_m
/// within one quantum of the contact's depth buffer (found: 0.50). The gradient is a difference of two depths: within 2
/// quantum_m / step_m across n (found: 1.03) and 2 quantum_m / step_rad about the point of rotation (found: 0.83). With
/// 24 bits single precision is what limits: 3e-7 of the window's half size and the depth range together stand for the
/// quantum where that is more.
/// With moved_heights::reused turns about n differ from the CPU backend's.
///
/// Values that the paper's backend cannot compute are set as follows: soft_depth_m is depth_m and there is no
/// curvature; witness_w is the window's centre, because a query says that a sample is deep but not which. `samples` and
/// `area_m2` need the number of samples that pass, which OpenGL ES does not count: there they are 1 and a sample's
/// area.
class occlusion_depth {
 public:
  using policy_tag = depth_tag;

  /// Uploads the scene's models, or shares them where another backend of the context has them; compiles the shaders.
  /// Leaves the context current in no thread: the first measure() takes it for its own.
  /// @return what cpu_depth says about settings and scene | invalid_argument (settings other than the paper's,
  ///         see paper_depth_settings; gpu_settings) | unsupported | limit_exceeded
  [[nodiscard]] static result<occlusion_depth> make(context_ptr context, const scene& s,
                                                    const window_depth_settings& settings = paper_depth_settings(),
                                                    const occlusion_settings& gpu_settings = {});
  occlusion_depth(occlusion_depth&&) noexcept;
  occlusion_depth& operator=(occlusion_depth&&) noexcept;
  ~occlusion_depth();

  /// Depth of every contact. A depth outside the range is reported as its limit, with depth_flag::saturated.
  /// @pre the context is current in no other thread
  /// @return ok | not_ready, not_finite (as cpu_depth) | capacity_reached (more contacts or triangles than the settings
  ///         say) | backend_failed (the device is lost, or its driver reports an error); all but ok leave zeros behind
  /// @rt no allocation, lock, throw, print or clock of ours; waits for the device as counters() says, and whatever its
  ///     driver does
  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept;

  /// Smallest difference between two depths of contact `i` of the last call, m; 0 where it was not drawn.
  [[nodiscard]] double quantum_m(std::size_t i) const noexcept;
  /// Steps of the central difference of contact `i` of the last call; 0 where nothing overlapped.
  [[nodiscard]] double step_m(std::size_t i) const noexcept;
  [[nodiscard]] double step_rad(std::size_t i) const noexcept;

  /// What the last call drew, a contact's tiles each. For pictures and tests: slow, and it allocates.
  /// @return unsupported (ES, which cannot read a depth buffer; a lost context)
  [[nodiscard]] result<std::vector<occlusion_tiles>> read_tiles();

  [[nodiscard]] const window_depth_settings& settings() const noexcept;
  [[nodiscard]] const occlusion_settings& gpu_settings() const noexcept;
  [[nodiscard]] const occlusion_counters& counters() const noexcept;
  [[nodiscard]] const context_ptr& owner() const noexcept;
  /// Memory of this backend on the device beyond the models, bytes; context::device_bytes() has everything.
  [[nodiscard]] std::size_t device_bytes() const noexcept;
  /// Without the models, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  struct parts;
  explicit occlusion_depth(std::unique_ptr<parts> p) noexcept;
  std::unique_ptr<parts> parts_;
};

static_assert(depth_backend<occlusion_depth>);

}  // namespace asperity::gl
