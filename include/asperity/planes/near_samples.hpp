// What the field finder reports: which samples of one body may touch the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/sample_tree.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// The support plane of the deepest of a few neighbouring samples, and where that sample is.
struct near_plane {
  support_plane plane{.depth_m = -std::numeric_limits<double>::infinity()};  ///< -infinity: there is none
  vec3 point_w{0.0};                                                         ///< the sample, world
};

/// A few neighbouring samples of one body that may touch the other.
struct near_leaf {
  std::uint32_t body = 0;               ///< index of B in scene::fixed
  bool of_probe = false;                ///< whose samples: the probe's, met by B's field; or B's, met by the probe's
  const field_sample* first = nullptr;  ///< in that body's sample_tree
  std::uint32_t count = 0;
  vec3 centre_b{0.0};  ///< of a ball around them, in the same frame
  double radius_m = 0.0;

  [[nodiscard]] std::span<const field_sample> samples() const noexcept { return {first, count}; }
};

/// Fixed size of a near_samples.
struct near_sample_limits {
  std::size_t leaves = 16384;

  /// Most readings that a depth backend makes of a set of this size.
  [[nodiscard]] std::size_t readings() const noexcept { return leaves; }
};

/// The near leaves of one tick, sorted by body. All memory is taken when it is made.
/// A superset of what touches is harmless: what is too far away gives no plane.
class near_samples {
 public:
  using limits_type = near_sample_limits;

  explicit near_samples(near_sample_limits limits = {}) : limits_(limits) {
    detail::reserve_resident(leaves_, limits.leaves);
  }

  /// @rt safe
  void clear() noexcept {
    leaves_.clear();
    dropped_ = 0;
  }
  /// @return false where the limit was hit: the leaf is dropped and counted   @rt safe
  bool add(const near_leaf& leaf) noexcept {
    if (leaves_.size() == limits_.leaves) {
      ++dropped_;
      return false;
    }
    leaves_.push_back(leaf);
    return true;
  }

  [[nodiscard]] std::span<const near_leaf> leaves() const noexcept { return leaves_; }
  /// How many readings a depth backend makes of it: one per leaf.
  [[nodiscard]] std::size_t size() const noexcept { return leaves_.size(); }
  /// Leaves that did not fit since clear(): raise near_sample_limits.
  [[nodiscard]] std::size_t dropped() const noexcept { return dropped_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(leaves_); }

 private:
  near_sample_limits limits_;
  std::vector<near_leaf> leaves_;
  std::size_t dropped_ = 0;
};

}  // namespace asperity
